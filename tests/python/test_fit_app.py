# SPDX-License-Identifier: BSD-3-Clause
"""A fit from the command line: the JSON to the letter, and what each option does to it."""

import hashlib
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from apps import Bench, values_of
from oracle.magnetometer import Magnetometer

DEGREE = np.pi / 180
UNITS = {"lambda": "1", "alpha": "1", "w": "m/s", "eps": "rad", "eta": "rad", "n": "uT"}
KEYS = [
    "schema_version", "model", "inputs", "options", "status", "message", "parameters", "derived",
    "restated", "correlation", "collinearity", "unobservable", "weak", "cost", "rmse", "noise",
    "iterations", "stage_one", "stage_two", "history",
]  # fmt: skip


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def test_every_key(bench: Bench):
    result = bench.base
    model = bench.model
    assert list(result) == KEYS
    assert result["schema_version"] == 3
    assert result["model"] == {"sepcal-pitot": "five-hole", "sepcal-mag": "magnetometer"}[bench.app]
    rows = len(bench.read_log().rows)
    assert result["inputs"] == {
        "file": "flight.csv",
        "sha256": hashlib.sha256(bench.flight.read_bytes()).hexdigest(),
        "rows": rows,
        "rows_used": rows,
    }
    assert result["status"] == "converged"
    assert result["message"] == ""
    assert result["derived"] == {}
    assert result["unobservable"] == result["weak"] == result["history"] == []
    assert is_number(result["cost"])
    assert list(result["rmse"]) == list(result["noise"]) == list(model.outputs)
    assert all(is_number(value) and value > 0 for value in result["rmse"].values())
    assert result["noise"] == pytest.approx(result["rmse"], rel=1e-6)  # R-hat = SSE / N
    assert isinstance(result["iterations"], int)
    assert result["iterations"] > 0


def test_parameters(bench: Bench):
    """Names, order, units, bounds and types of interface.md."""
    parameters = bench.base["parameters"]
    assert tuple(parameters) == bench.model.parameters
    bounds = {
        "lambda_alpha": 0.5, "b_alpha": 10 * DEGREE, "lambda_beta": 0.5, "b_beta": 10 * DEGREE,
        "eps_phi": 0.2618, **dict.fromkeys(Magnetometer.nonlinear, 0.5),
    }  # fmt: skip
    for name, entry in parameters.items():
        assert list(entry) == [
            "value", "standard_error", "standard_error_white", "standard_error_noise_model",
            "standard_error_blocks", "unit", "lower", "upper", "at_bound", "kind",
        ]  # fmt: skip
        unit = "m/s" if name == "b_va" else "rad" if name[:2] == "b_" else None
        assert entry["unit"] == (unit or UNITS[name.split("_")[0]])
        assert is_number(entry["value"])
        assert entry["standard_error_white"] > 0  # the simulated noise is white
        assert entry["standard_error"] == pytest.approx(entry["standard_error_white"], rel=0.1)
        assert entry["at_bound"] is False
        if name in bounds:
            assert [entry["lower"], entry["upper"]] == pytest.approx([-bounds[name], bounds[name]])
        else:
            is_scale = name in ("lambda_va", "lambda_x", "lambda_y", "lambda_z")
            assert entry["lower"] == (pytest.approx(-0.95) if is_scale else None)
            assert entry["upper"] is None


def test_correlation(bench: Bench):
    correlation = bench.base["correlation"]
    assert list(correlation) == ["names", "matrix"]
    assert correlation["names"] == list(bench.base["parameters"])
    matrix = np.array(correlation["matrix"])
    assert_allclose(matrix, matrix.T, atol=1e-12)
    assert_allclose(np.diag(matrix), 1)
    assert np.all(np.linalg.eigvalsh(matrix) > 0)


def test_stages(bench: Bench):
    one, two = bench.base["stage_one"], bench.base["stage_two"]
    assert list(one) == [
        "samples", "best", "trace_r", "minima", "unique_minimum", "flat_directions",
    ]  # fmt: skip
    assert one["samples"] == 500
    assert tuple(one["best"]) == bench.model.nonlinear
    assert len(one["minima"]) == 1
    (minimum,) = one["minima"]
    assert list(minimum) == ["xi2", "trace_r"]
    assert tuple(minimum["xi2"]) == bench.model.nonlinear
    assert 0 < minimum["trace_r"] <= one["trace_r"]  # the sample from which it was reached
    assert one["unique_minimum"] is True
    assert one["flat_directions"] == []
    assert list(two) == ["second_stage", "r_iterations"]
    assert two["second_stage"] == "projected"  # the paper's Step 5, where the minimum is unique
    assert isinstance(two["r_iterations"], int)


def test_estimates_lie_round_the_truth(bench: Bench):
    """Within five standard errors, each of them: a right fit fails with probability 7e-6."""
    bench.run("simulate", "-o", "other.csv", "--rows", "400", "--seed", "5", "--truth", "t.json")
    result = bench.fit(flight="other.csv").result
    truth = bench.run("simulate", "-o", "other.csv", "--truth", "t.json", "--json").result
    for name, entry in result["parameters"].items():
        assert abs(entry["value"] - truth["parameters"][name]) < 5 * entry["standard_error"], name


def test_defaults_are_carried(bench: Bench):
    options = bench.base["options"]
    probe = {"k_alpha": 4.5, "k_beta": 4.5, "lever_arm": [0.35, 0, -0.02]}
    assert options == (probe if bench.app == "sepcal-pitot" else {}) | {
        "effects": [], "stage_one_segments": "", "stage_two_segments": "", "bounds": {},
        "start": {}, "fix": {},
        "free": [], "noise": {}, "samples": 500, "sampling": "uniform",
        "sampling_distribution": {}, "seed": 0, "descents": 8, "second_stage": "auto",
        "noise_tolerance": 1e-10, "noise_iterations": 100, "prior": {}, "search": "sampling",
        "jacobian": "kaufman", "loss": "squares", "loss_width": 0.0, "iterations": 200,
        "coloured_errors": True, "threads": 0, "drop_invalid": False,
    }  # fmt: skip


def test_options_are_carried(pitot: Bench):
    """Each option ends up in the JSON, and later verbs need no more than that."""
    fitted = pitot.fit(
        *(
            "--stage-one-segments",
            "popu,multisine_1",
            "--stage-two-segments",
            "wind_circle_1,40:110",
        ),
        *("--bounds", "eps_phi=-0.2,0.15", "--bounds", "w_n=-9,9", "--fix", "w_d=0.3"),
        *("--free", "w_e", "--samples", "60", "--sampling", "low_discrepancy", "--seed", "7"),
        *("--second-stage", "joint", "--noise", "vn=0.15", "--noise", "ve=0.15"),
        *("--noise", "vd=0.2", "--noise-tolerance", "0.05", "--threads", "1", "-o", "next.json"),
        *("--prior", "b_va=0.1:2", "--loss", "huber", "--loss-width", "1.5"),
        *("--jacobian", "golub_pereyra"),
    )
    assert fitted.code == 0, fitted.err
    assert fitted.result["options"] | {
        "stage_one_segments": "popu,multisine_1", "stage_two_segments": "wind_circle_1,40:110",
        "bounds": {"eps_phi": [-0.2, 0.15], "w_n": [-9, 9]}, "fix": {"w_d": 0.3}, "free": ["w_e"],
        "samples": 60, "sampling": "low_discrepancy", "seed": 7, "second_stage": "joint",
        "noise": {"vd": 0.2, "ve": 0.15, "vn": 0.15}, "noise_tolerance": 0.05, "threads": 1,
        "prior": {"b_va": [0.1, 2]}, "loss": "huber", "loss_width": 1.5,
        "jacobian": "golub_pereyra",
    } == fitted.result["options"]  # fmt: skip
    assert fitted.result["noise"] == {"vn": 0.15, "ve": 0.15, "vd": 0.2}
    assert fitted.result["stage_two"]["second_stage"] == "joint"
    assert pitot.run("compare", "flight.csv", "next.json").code == 0


def test_printed_json_is_the_file(bench: Bench):
    """The same bytes; without --json a table for people with every parameter in it."""
    fitted = bench.fit("-o", "next.json")
    assert (fitted.code, fitted.err) == (0, "")
    assert fitted.out == (bench.folder / "next.json").read_text()
    table = bench.run("fit", "flight.csv", *bench.options)
    assert (table.code, table.err) == (0, "")
    for name in bench.model.parameters:
        assert f"\n{name} " in table.out


@pytest.mark.parametrize("sampling", ["uniform", "low_discrepancy"])
def test_same_seed_same_result(bench: Bench, sampling: str):
    """On one thread and on two: only options.threads tells the results apart."""
    bench.run("simulate", "-o", "long.csv", "--rows", "20000")  # several chunks to share out
    options = ("--samples", "40", "--seed", "3", "--sampling", sampling)
    one, again, two = (
        bench.fit(*options, "--threads", threads, flight="long.csv").out
        for threads in ("1", "1", "2")
    )
    assert one == again
    assert two == one.replace('"threads": 1', '"threads": 2')
    assert '"threads": 2' in two
    other = bench.fit("--samples", "40", "--seed", "4", "--sampling", sampling, flight="long.csv")
    assert other.result["stage_one"]["best"] != bench.fit(*options).result["stage_one"]["best"]


# --- parts of a flight, parameters held


def test_stage_two_uses_the_segments_named(pitot: Bench):
    """By maneuver and by time: the same as a log of these rows."""
    log = pitot.read_log()
    time, labels = log.column("time_s"), [row[log.index("maneuver")] for row in log.rows]
    fitted = pitot.fit("--stage-two-segments", "wind_circle_1, 40:90")
    kept = [
        label == "wind_circle_1" or 40 <= t <= 90 for label, t in zip(labels, time, strict=True)
    ]
    assert fitted.result["inputs"] == pitot.base["inputs"] | {"rows_used": sum(kept)}
    assert 0 < sum(kept) < len(kept)

    log.rows = [row for row, keep in zip(log.rows, kept, strict=True) if keep]
    (pitot.folder / "part.csv").write_text(log.text())
    alone = pitot.fit(flight="part.csv").result
    assert_allclose(values_of(fitted.result), values_of(alone), rtol=1e-6, atol=1e-9)
    assert fitted.result["rmse"] == pytest.approx(alone["rmse"], rel=1e-8)


def test_stage_one_uses_the_segments_named(pitot: Bench):
    """Stage two still takes every row, so only stage one's numbers change."""
    fitted = pitot.fit("--stage-one-segments", "popu,multisine_1").result
    assert fitted["inputs"] == pitot.base["inputs"]
    assert fitted["stage_one"]["trace_r"] != pitot.base["stage_one"]["trace_r"]
    assert_allclose(values_of(fitted), values_of(pitot.base), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("held", ["linear", "nonlinear"])
def test_fix(bench: Bench, held: str):
    """A held parameter keeps its value to the bit, has no standard error and no correlation."""
    name = getattr(bench.model, held)[1]
    fitted = bench.fit("--fix", f"{name}=0.0123")
    assert fitted.code == 0
    entry = fitted.result["parameters"][name]
    assert entry | {"value": 0.0123, "lower": 0.0123, "upper": 0.0123, "at_bound": False} == entry
    assert entry["standard_error"] is entry["standard_error_white"] is None
    free = [other for other in bench.base["parameters"] if other != name]
    assert list(fitted.result["parameters"]) == list(bench.base["parameters"])
    assert fitted.result["correlation"]["names"] == free
    assert np.array(fitted.result["correlation"]["matrix"]).shape == (len(free), len(free))
    assert name not in fitted.result["stage_one"]["best"]
    assert sum(fitted.result["rmse"].values()) > sum(bench.base["rmse"].values())


@pytest.mark.parametrize("held", ["linear", "nonlinear"])
@pytest.mark.parametrize("second_stage", ["joint", "projected"])
def test_active_bounds(bench: Bench, held: str, second_stage: str):
    """A bound that keeps the estimate away is met exactly, reported, and costs rmse."""
    name = getattr(bench.model, held)[1]
    free = bench.base["parameters"][name]
    edge = free["value"] - 10 * free["standard_error"]
    fitted = bench.fit("--bounds", f"{name}={edge - 1!r},{edge!r}", "--second-stage", second_stage)
    assert fitted.code == 0, fitted.err
    entry = fitted.result["parameters"][name]
    assert entry["value"] == pytest.approx(edge, rel=1e-9)
    assert entry["value"] <= edge
    assert (entry["lower"], entry["upper"], entry["at_bound"]) == (edge - 1, edge, True)
    assert entry["standard_error"] is entry["standard_error_white"] is None
    assert fitted.result["options"]["bounds"] == {name: [edge - 1, edge]}
    assert sum(fitted.result["rmse"].values()) > sum(bench.base["rmse"].values())
    others = [e["at_bound"] for other, e in fitted.result["parameters"].items() if other != name]
    assert not any(others)
