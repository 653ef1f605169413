# SPDX-License-Identifier: BSD-3-Clause
"""Files of parameters whose comments have hostile names in them.

pymavlink and a reader of our own find the same names and values as of plain ones, no more.
"""

from __future__ import annotations

import contextlib
import functools
import io
import re
from collections.abc import Hashable
from pathlib import Path

from mutation import check_message, check_printed, input_of, main, words_of
from pymavlink.mavparm import MAVParmDict
from spoilt_calibration import spoilt, with_columns

import sepcal
from hostile import hostile_words

CASES = [(kind, to) for kind in ("tube", "field") for to in ("ardupilot", "px4")]
PLAIN = ["message; second", "flight.csv", "flight", "c1"]
NAME = re.compile(r"[A-Z][A-Z0-9_]{0,15}")  # MAVLink: at most 16 bytes

Parameters = dict[str, str]


def export(kind: str, to: str, words: list[str]) -> str:
    """Raises sepcal.Error for what is refused."""
    message, file, name, column = words
    column = column or "c1"
    flight = with_columns(kind, [column], name)
    written = sepcal.export(spoilt(kind, message, file), "out", to, flight=flight, force=True)
    check_printed(str(written))
    return Path("out").read_bytes().decode("utf-8")


def read_by_hand(text: str, to: str) -> Parameters:
    """ArduPilot's NAME,VALUE or QGroundControl's five columns; every kind of line end ends one."""
    found: Parameters = {}
    for line in re.split("\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]", text):
        if not line or line.startswith("#"):
            continue
        cells = line.split("," if to == "ardupilot" else "\t")
        if to == "px4":
            vehicle, component, *cells, form = cells
            assert (vehicle, component) == ("1", "1")
            assert form in ("6", "9")
        name, value = cells
        assert NAME.fullmatch(name), line
        assert name not in found, line
        float(value)
        found[name] = value
    return found


def read_by_pymavlink(file: str) -> Parameters:
    """Ground stations of ArduPilot read so; what it complains of is a finding."""
    parameters = MAVParmDict()
    with contextlib.redirect_stdout(io.StringIO()) as said:
        assert parameters.load(file, use_excludes=False)  # it leaves out what a vehicle measures
    assert "Invalid" not in said.getvalue(), said.getvalue()
    return {name: str(parameters[name]) for name in list(parameters)}


@functools.cache
def plain(kind: str, to: str) -> Parameters:
    found = read_by_hand(export(kind, to, PLAIN), to)
    assert found
    return found


def target(data: bytes) -> Hashable:
    """Of the export's answer."""
    kind, to = CASES[len(data) % len(CASES)]
    expected = plain(kind, to)
    try:
        text = export(kind, to, words_of(data, len(PLAIN)))
    except sepcal.Error as error:
        return check_message(str(error))
    assert read_by_hand(text, to) == expected
    if to == "ardupilot":
        read = read_by_pymavlink("out")
        assert {name: float(value) for name, value in expected.items()} == {
            name: float(value) for name, value in read.items()
        }
    return kind, to


SEEDS = [input_of(PLAIN), *(input_of(hostile_words(80, seed)[-4:]) for seed in range(12))]

if __name__ == "__main__":
    main(target, SEEDS)
