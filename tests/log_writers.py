# SPDX-License-Identifier: BSD-3-Clause
"""Small autopilots' logs for tests, written by the formats' own rules with struct alone."""

import struct

DATAFLASH = {
    **dict(zip("bBhHiIfdqQ", "bBhHiIfdqQ", strict=True)),
    **{"M": "B", "n": "4s", "N": "16s", "Z": "64s", "c": "h", "C": "H", "e": "i", "E": "I"},
    **{"L": "i"},
}
HUNDREDTHS = "cCeE"


class DataFlashWriter:
    """Messages with their times, written in the order of the times."""

    def __init__(self):
        self._forms = {"FMT": (128, "BBnNZ")}
        self._head = b""
        self._messages = []
        self._describe(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")

    def _describe(self, number, name, letters, columns):
        length = 3 + struct.calcsize("<" + "".join(DATAFLASH[c] for c in letters))
        self._head += self._pack("FMT", number, length, name, letters, columns)

    def form(self, name, letters, columns):
        """Introduces a message."""
        number = 130 + len(self._forms)
        self._forms[name] = (number, letters)
        self._describe(number, name, letters, columns)

    def add(self, time, name, *values):
        """A message; `time` [s] only orders it."""
        self._messages.append((time, len(self._messages), self._pack(name, *values)))

    def _pack(self, name, *values):
        number, letters = self._forms[name]
        packed = []
        for letter, value in zip(letters, values, strict=True):
            if isinstance(value, str):
                packed.append(value.encode())
            elif letter == "L":
                packed.append(round(value * 1e7))
            elif letter in HUNDREDTHS:
                packed.append(round(value * 100))
            else:
                packed.append(value if letter in "fd" else int(value))
        form = "<BBB" + "".join(DATAFLASH[c] for c in letters)
        return struct.pack(form, 0xA3, 0x95, number, *packed)

    def data(self):
        """The file."""
        return self._head + b"".join(message for *_, message in sorted(self._messages))


ULOG = {
    **{"uint8_t": "B", "int32_t": "i", "uint32_t": "I", "uint64_t": "Q", "float": "f"},
    **{"double": "d", "bool": "?"},
}


class ULogWriter:
    """Topics with their times, written in the order of the times."""

    def __init__(self, parameters=(), information=()):
        self._head = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
        self._definitions = b""
        self._added = b""
        self._numbers = {}
        self._forms = {}
        self._messages = []
        for key, value in information:
            text = f"char[{len(value)}] {key}".encode()
            self._definitions += self._wrap("I", bytes([len(text)]) + text + value.encode())
        for name, value in parameters:
            self._definitions += self._parameter(name, value)

    @staticmethod
    def _wrap(kind, body):
        return struct.pack("<HB", len(body), ord(kind)) + body

    def _parameter(self, name, value):
        kind, letter = ("int32_t", "i") if isinstance(value, int) else ("float", "f")
        key = f"{kind} {name}".encode()
        return self._wrap("P", bytes([len(key)]) + key + struct.pack("<" + letter, value))

    def form(self, name, fields):
        """Introduces a topic: "float[3] xyz;uint32_t device_id", its timestamp apart."""
        text = f"{name}:uint64_t timestamp;{fields};"
        self._definitions += self._wrap("F", text.encode())
        form = "<Q"
        for field in fields.split(";"):
            kind, _, count = field.split(" ")[0].partition("[")
            form += ULOG[kind] * (int(count[:-1]) if count else 1)
        self._forms[name] = form

    def add(self, time, name, *values, instance=0):
        """A sample of a topic; time [s]."""
        key = (name, instance)
        if key not in self._numbers:
            number = self._numbers[key] = len(self._numbers)
            self._added += self._wrap("A", struct.pack("<BH", instance, number) + name.encode())
        body = struct.pack(self._forms[name], round(time * 1e6), *values)
        message = self._wrap("D", struct.pack("<H", self._numbers[key]) + body)
        self._messages.append((time, len(self._messages), message))

    def set(self, time, name, value):
        """A parameter that changes on the way."""
        self._messages.append((time, len(self._messages), self._parameter(name, value)))

    def data(self):
        """The file."""
        body = b"".join(message for *_, message in sorted(self._messages))
        return self._head + self._definitions + self._added + body
