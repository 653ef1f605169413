# SPDX-License-Identifier: BSD-3-Clause
"""A ULog read message by message with struct alone."""

import re
import struct

TYPES = {
    **{"int8_t": "b", "uint8_t": "B", "int16_t": "h", "uint16_t": "H", "int32_t": "i"},
    **{"uint32_t": "I", "int64_t": "q", "uint64_t": "Q", "float": "f", "double": "d"},
    **{"bool": "?", "char": "c"},
}


def read_log(data):
    """Topics {(name, instance): [{field: value}]}, parameters {name: first value}."""
    assert data[:4] == b"ULog"
    formats, ids, topics, parameters = {}, {}, {}, {}
    at = 16
    while at + 3 <= len(data):
        length, kind = struct.unpack("<HB", data[at : at + 3])
        body = data[at + 3 : at + 3 + length]
        if len(body) < length:
            break
        at += 3 + length
        if kind == ord("F"):
            name, _, fields = body.decode().partition(":")
            formats[name] = [f.split(" ") for f in fields.split(";") if f]
        elif kind == ord("P"):
            size = body[0]
            type_, name = body[1 : 1 + size].decode().split(" ")
            (value,) = struct.unpack("<" + TYPES[type_], body[1 + size :])
            parameters.setdefault(name, value)
        elif kind == ord("A"):
            instance, number = struct.unpack("<BH", body[:3])
            ids[number] = (body[3:].decode(), instance)
        elif kind == ord("D"):
            (number,) = struct.unpack("<H", body[:2])
            fields = flatten(ids[number][0], formats)
            while fields and fields[-1][1].startswith("_padding"):
                fields.pop()
            form = "<" + "".join(TYPES[type_] for type_, _ in fields)
            values = struct.unpack(form, body[2 : 2 + struct.calcsize(form)])
            row = dict(zip([name for _, name in fields], values, strict=True))
            topics.setdefault(ids[number], []).append(row)
    return topics, parameters


def flatten(name, formats, prefix=""):
    """[(type, field)] of a format, arrays and nested ones one by one."""
    flat = []
    for type_, field in formats[name]:
        base, count = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", type_).groups()
        numbers = [""] if count is None else [f"[{i}]" for i in range(int(count))]
        for number in numbers:
            if base in TYPES:
                flat.append((base, prefix + field + number))
            else:
                flat += flatten(base, formats, f"{prefix}{field}{number}.")
    return flat
