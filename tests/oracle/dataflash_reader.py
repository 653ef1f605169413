# SPDX-License-Identifier: BSD-3-Clause
"""A DataFlash log read message by message, by its own FMT messages, with struct alone."""

import struct

SIZES = {
    **dict(zip("bBhHiIfdqQM", "bBhHiIfdqQB", strict=True)),
    **{"n": "4s", "N": "16s", "Z": "64s", "a": "64s", "c": "h", "C": "H", "e": "i", "E": "I"},
    **{"L": "i", "g": "e"},
}
FACTORS = {"c": 0.01, "C": 0.01, "e": 0.01, "E": 0.01, "L": 1e-7}


def read_messages(data):
    """[(name, {column: value})] in the log's order; text without its zeros."""
    forms = {128: ("FMT", 89, "BBnNZ", ["Type", "Length", "Name", "Format", "Columns"])}
    messages = []
    at = 0
    while at + 3 <= len(data):
        if data[at : at + 2] != b"\xa3\x95" or data[at + 2] not in forms:
            at += 1
            continue
        name, length, letters, columns = forms[data[at + 2]]
        if at + length > len(data):
            break
        values = struct.unpack("<" + "".join(SIZES[c] for c in letters), data[at + 3 : at + length])
        message = {}
        for column, letter, value in zip(columns, letters, values, strict=True):
            if isinstance(value, bytes):
                message[column] = value.split(b"\0")[0].decode("latin1")
            else:
                message[column] = value * FACTORS.get(letter, 1)
        if name == "FMT":
            forms[message["Type"]] = (
                message["Name"],
                message["Length"],
                message["Format"],
                message["Columns"].split(",") if message["Columns"] else [],
            )
        messages.append((name, message))
        at += length
    return messages
