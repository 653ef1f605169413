# SPDX-License-Identifier: BSD-3-Clause
"""Logs that say the same in another form: cut into files, every other row, a channel twice."""

import numpy as np
import pytest

import sepcal
from sepcal.columns import Array
from shifts import largest_shift
from studies.hidden_effects.cases import PROBES

HIDDEN = [
    ("five-hole", {"airspeed_bias[throttle]": [4.0]}),
    ("pitot-static", {"wind[time]": [0.06]}),
    ("magnetometer", {"bias[current_a]": [0.6, -0.4, 0.5]}),
    ("magnetometer", None),
]


def log(probe: str, hide: dict[str, list[float]] | None, rows: int = 450) -> dict[str, Array]:
    return dict(sepcal.simulate(probe, hide=hide, rows=rows, seed=11))


@pytest.mark.parametrize("probe", PROBES)
def test_two_files_are_one(probe: str):
    """Cut where a segment ends, and fitted jointly: factors merge exactly."""
    columns = log(probe, None)
    labels = np.repeat(["one", "two", "three"], 150)
    whole = sepcal.fit(PROBES[probe], sepcal.Flight(columns, maneuver=labels))
    parts = [
        sepcal.Flight(
            {name: values[rows] for name, values in columns.items()}, maneuver=labels[rows]
        )
        for rows in (slice(300), slice(300, None))
    ]
    joint = sepcal.fit_many(PROBES[probe], parts)
    assert joint.status == whole.status
    for name, parameter in whole.parameters.items():
        if parameter.standard_error > 0:
            shift = abs(joint[name].value - parameter.value)
            assert shift < 1e-9 * parameter.standard_error_white


@pytest.mark.parametrize("probe", PROBES)
def test_a_log_that_was_written_and_read(probe: str, tmp_path):
    """With the effect in time that asks most of its stamps."""
    columns = log(probe, None)
    file = tmp_path / "flight.csv"
    lines = [",".join(columns)]
    lines += [",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)]
    file.write_text("\n".join(lines) + "\n")
    first, second = (
        sepcal.fit(PROBES[probe], flight, effects=("time_offset",))
        for flight in (sepcal.Flight(columns), sepcal.read_csv(file))
    )
    assert largest_shift(first, second, {}) < 1e-9


@pytest.mark.parametrize(("probe", "hide"), HIDDEN, ids=lambda value: str(value))
def test_rows_thinned_and_a_channel_twice(probe: str, hide: dict[str, list[float]] | None):
    """The same verdict, the same first cause or its twin, its size within the errors."""
    columns = log(probe, hide)
    sizes = [values.size for values in columns.values()]
    assert len(set(sizes)) == 1
    thinned = {name: values[::2] for name, values in columns.items()}
    twin = columns | {f"spare_{name}": columns[name].copy() for name in ("throttle", "current_a")}
    whole = sepcal.fit(PROBES[probe], sepcal.Flight(columns)).diagnose()
    assert whole.verdict == ("effect_missing" if hide else "adequate")
    for other in (thinned, twin):
        diagnosis = sepcal.fit(PROBES[probe], sepcal.Flight(other)).diagnose()
        assert diagnosis.verdict == whole.verdict
        if not hide:
            continue
        name = whole.effects[0].name
        assert name in diagnosis.explanations
        for coefficient, size in whole.effects[0].estimate.items():
            found = diagnosis[name]
            error = max(
                found.standard_error[coefficient], whole.effects[0].standard_error[coefficient]
            )
            assert abs(found.estimate[coefficient] - size) < 4.0 * error
