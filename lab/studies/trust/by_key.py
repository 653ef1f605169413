# SPDX-License-Identifier: BSD-3-Clause
"""A key says which flight of the simulator it is, so that one can be flown again and looked at.

Its case is `probe`, `probe: cause` or `probe: cause and cause`; its size is what is asked of each.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from studies.trust.part import Key
from studies.trust.simulator.bounds import OF_OUTPUTS
from studies.trust.simulator.causes import Cause
from studies.trust.simulator.flights import Flown, fly_log

NOTHING, HIDDEN, WANDER = "nothing", "hidden", "wander"
SCREENS, SIMPLE, TWO = "screens", "simplest", "two"
AND = " and "
MORE = 0.08  # is asked of the simulator, so that most flights take their share by a real fit


def make_case(probe: str, *causes: Cause) -> str:
    """Of a key."""
    return f"{probe}: {AND.join(cause.label for cause in causes)}"


def parse_case(case: str) -> tuple[str, list[Cause]]:
    """The probe, and what is hidden."""
    probe, _, labels = case.partition(": ")
    return probe, [Cause.of(label) for label in labels.split(AND)] if labels else []


def fly_key(key: Key) -> tuple[str, Flown]:
    """The probe and its flight."""
    part, case, noise, size, _, seed = key
    probe, causes = parse_case(case)
    asked, much = "share", size + MORE if part in (HIDDEN, SIMPLE) else size
    if part == WANDER:
        asked = "wander"
    elif part == TWO:
        asked, much = "loudness", size * OF_OUTPUTS[probe]
    hidden = [(cause, asked, much) for cause in causes] if size else []
    return probe, fly_log(probe, noise, seed, hidden)


def write_log(key: Key, folder: Path) -> Path:
    """As the programs read it, under the key's name."""
    _, flown = fly_key(key)
    name = re.sub(r"[^\w.]+", "_", " ".join(str(part) for part in key))
    file = folder / f"{name}.csv"
    values = np.column_stack(list(flown.columns.values()))
    header = ",".join(flown.columns)
    np.savetxt(file, values, delimiter=",", header=header, comments="", fmt="%.12g")
    return file
