# SPDX-License-Identifier: BSD-3-Clause
"""What goes to workers and comes back is what it was: models, flights, fits, calibrations."""

import copy
import pickle
from pathlib import Path

import pytest
from numpy.testing import assert_array_equal

import sepcal
from own_models import WindBox, simulate_wind_box

MODELS = [
    sepcal.ScalarExample1(),
    sepcal.ScalarExample2(),
    sepcal.FiveHoleProbe(k_alpha=4.0, k_beta=5.0, lever_arm=(0.1, 0.2, 0.3)),
    sepcal.PitotStatic(),
    sepcal.Magnetometer(),
    sepcal.Magnetometer((19.0, -1.0, 49.0)),
    sepcal.Magnetometer(field_strength=50.0),
]


@pytest.mark.parametrize("again", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy])
@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_models(model, again):
    twin = again(model)
    assert type(twin) is type(model)
    assert repr(twin) == repr(model)
    assert (twin.parameters, twin.inputs, twin.bounds) == (
        model.parameters,
        model.inputs,
        model.bounds,
    )


def test_a_model_of_ones_own():
    model = sepcal.OwnModel(WindBox())
    twin = pickle.loads(pickle.dumps(model))
    record = simulate_wind_box(5)
    pairs = zip(model.evaluate(record, [0.1]), twin.evaluate(record, [0.1]), strict=True)
    for mine, other in pairs:
        assert_array_equal(mine, other)


def check_same(twin, flight):
    assert type(twin) is type(flight)
    assert (twin.name, twin.sha256, twin.columns, twin.rows, twin.maneuvers) == (
        flight.name,
        flight.sha256,
        flight.columns,
        flight.rows,
        flight.maneuvers,
    )
    for header in flight:
        assert_array_equal(twin[header], flight[header])
        assert not twin[header].flags.writeable


def test_a_flight_of_arrays():
    flight = sepcal.Flight({"time_s": [0.0, 1.0, 2.0]}, maneuver=["a", "a", "b"], name="mine")
    check_same(pickle.loads(pickle.dumps(flight)), flight)
    check_same(copy.deepcopy(flight), flight)
    unlabelled = sepcal.Flight({"time_s": [0.0, 1.0]})
    check_same(pickle.loads(pickle.dumps(unlabelled)), unlabelled)


def test_a_simulated_flight_keeps_its_truth():
    flight = sepcal.simulate("magnetometer", hide={"bias[current_a]": 0.5}, rows=30)
    twin = pickle.loads(pickle.dumps(flight))
    check_same(twin, flight)
    assert (twin.truth, twin.effects) == (flight.truth, flight.effects)


def test_a_file_is_still_known_and_its_bad_cell_named(tmp_path: Path):
    flight = sepcal.simulate("pitot-static", rows=40)
    rows = [",".join(flight.columns)]
    rows += [",".join(map(repr, map(float, row))) for row in zip(*flight.values(), strict=True)]
    file = tmp_path / "flight.csv"
    file.write_text("\n".join(rows) + "\n")
    read = sepcal.read_csv(file)
    twin = pickle.loads(pickle.dumps(read))
    check_same(twin, read)
    fits = [sepcal.fit(sepcal.PitotStatic(), one, samples=20).to_json() for one in (read, twin)]
    assert fits[0] == fits[1]

    cells = rows[5].split(",")
    cells[flight.columns.index("vn_mps")] = "n/a"
    file.write_text("\n".join([*rows[:5], ",".join(cells), *rows[6:]]) + "\n")
    messages = []
    for one in (sepcal.read_csv(file), pickle.loads(pickle.dumps(sepcal.read_csv(file)))):
        with pytest.raises(sepcal.Error) as refused:
            sepcal.fit(sepcal.PitotStatic(), one)
        messages.append(str(refused.value))
    assert messages[0] == messages[1]
    assert "n/a" in messages[0]
    assert "line 6" in messages[0]


def test_results_of_a_calibration():
    flight = sepcal.simulate("pitot-static", rows=200, excitation="rich")
    base = sepcal.fit(sepcal.PitotStatic(), flight, samples=20)
    twin = pickle.loads(pickle.dumps(base))
    assert twin.to_json() == base.to_json()
    compared = base.compare()
    assert str(pickle.loads(pickle.dumps(compared))) == str(compared)
    assert str(pickle.loads(pickle.dumps(base.fit))) == str(base.fit)


def test_errors():
    error = pickle.loads(pickle.dumps(sepcal.Error("a, b; c")))
    assert type(error) is sepcal.Error
    assert str(error) == "a, b; c"
