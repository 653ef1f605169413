# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark's own arithmetic: turns, medians, ratios, results on disc. No time is asserted."""

import json
import sys

import numpy as np
import pytest

from benchmarks import baseline, filter_error, pages, races, results
from benchmarks.numpy_five_hole import HoistedProbe
from benchmarks.race import Competitor, Line, Result, judge, lengths_within, race, show_time
from benchmarks.small_fits import by_least_squares, by_leastsq, draw, fit_each


def scripted(*seconds, answer=(1.0,)):
    """A competitor's run that takes these times, turn by turn."""
    left = iter(seconds)
    return lambda: (next(left), np.array(answer))


def test_competitors_run_in_turns():
    order = []
    competitors = [
        Competitor(name, lambda name=name: (order.append(name) or 1.0, np.zeros(1)))
        for name in ("a", "b")
    ]
    race(competitors, 2)
    assert order == ["a", "b", "a", "b"]


def test_who_has_used_the_budget_rests():
    competitor = Competitor("slow", scripted(1.0, 1.0, 1.0))
    race([competitor], 3, budget=-1.0)
    assert competitor.seconds == [1.0]


def test_a_ratio_is_the_median_of_those_within_a_turn():
    ours = Competitor("ours", scripted(1.0, 2.0, 10.0))
    theirs = Competitor("theirs", scripted(3.0, 2.0, 20.0, answer=(1.5,)))
    race([ours, theirs], 3)
    result = judge("r", "title", [ours, theirs], lambda off: float(abs(off[0])), "m")
    assert result.lines[0] == Line("ours", 1.0, 2.0, 3, 1.0, 0.0)
    assert result.lines[1] == Line("theirs", 2.0, 3.0, 3, 2.0, 0.5)


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [(12.34, "12.3 s"), (0.0123, "12.3 ms"), (1.5e-6, "1.5 us"), (2e-9, "2 ns")],
)
def test_times_have_three_digits_and_a_unit(seconds, shown):
    assert show_time(seconds) == shown


def result(name, title="t"):
    """A result of one line."""
    lines = [Line("ours", 0.5, 1.0, 3, 1.0, 0.0)]
    return Result(name, title, "m", lines, ["a note."], {"fact": 2.0})


def test_a_result_is_read_back_from_json():
    entry = json.loads(json.dumps(result("r").to_json() | {"commit": "abc"}))
    assert results.result_of(entry) == result("r")


def test_a_table_ends_with_its_notes():
    assert result("r").table().splitlines()[-1] == "a note."


def test_answers_that_are_not_compared_have_no_column():
    compared = result("r")
    assert "| answer differs by, m |" in compared.table()
    assert "| ours | 500 ms | 1 s | 3 | 1 | 0 |" in compared.table()
    compared.unit = ""
    assert "| ours | 500 ms | 1 s | 3 | 1 |\n" in compared.table()


def test_races_that_were_not_run_keep_their_results(tmp_path):
    results.write(tmp_path, [result("fit")])
    results.write(tmp_path, [result("smoother"), result("stage-two")])
    results.write(tmp_path, [result("stage-two", "again")])
    held = json.loads((tmp_path / "latest.json").read_text())["races"]
    shown = [(entry["race"], entry["title"]) for entry in held]
    assert shown == [("stage-two", "again"), ("fit", "t"), ("smoother", "t")]
    assert "**again**" in (tmp_path / "latest.md").read_text()


def make_probe(rows=7):
    """A probe at random inputs, with a noise an output."""
    rng = np.random.default_rng(1)
    angles = {name: rng.uniform(-1.0, 1.0, rows) for name in ("roll", "pitch", "yaw", *"pqr")}
    pressures = {"pt": rng.uniform(101_500.0, 101_700.0, rows), "ps": np.full(rows, 101_325.0)}
    others = {name: rng.uniform(-60.0, 60.0, rows) for name in ("dpa", "dpb")}
    readings = {name: rng.uniform(-20.0, 20.0, rows) for name in ("vn", "ve", "vd")}
    columns = angles | pressures | others | readings | {"rho": np.full(rows, 1.2)}
    probe = HoistedProbe(columns, 4.5, 4.5, (0.35, 0.0, -0.02))
    probe.set_noise(np.array([0.1, 0.2, 0.3]))
    return probe


X = np.array([0.05, 0.6, -3.8, 2.4, 0.3, 0.08, -0.035, -0.06, 0.02, 0.05])


def test_the_jacobian_by_hand_is_that_of_the_residuals():
    probe = make_probe()
    J = probe.jacobian(X)
    for k in range(len(X)):
        step = 1e-6 * np.eye(len(X))[k]
        slope = (probe.residuals(X + step) - probe.residuals(X - step)) / 2e-6
        np.testing.assert_allclose(J[:, k], slope, rtol=1e-6, atol=1e-5)


def test_the_linear_fit_leaves_the_least_sum_of_squares():
    probe = make_probe()
    probe.set_noise(np.ones(3))
    xi1, square = probe.linear_fit(X[5:])
    best = np.concatenate([xi1, X[5:]])
    assert square == pytest.approx(np.sum(probe.residuals(best) ** 2))
    slope = probe.jacobian(best)[:, :5].T @ probe.residuals(best)
    np.testing.assert_allclose(slope, 0.0, atol=1e-7)


@pytest.mark.parametrize("solve", [by_least_squares, by_leastsq])
def test_small_fits_find_the_truth(solve):
    found = fit_each(*draw(3, 1), solve).reshape(3, 3)
    np.testing.assert_allclose(found, np.tile([0.3, 1.0, 0.2], (3, 1)), atol=0.08)


def test_statsmodels_information_is_its_own():
    _, u, z = filter_error.fly(1)
    model = filter_error.Model(u, z)
    gradient, information = filter_error.information_by_statsmodels(model)
    sd = np.sqrt(np.diag(information))
    np.testing.assert_allclose(gradient / sd, -model.score(filter_error.AT) / sd, atol=1e-10)
    theirs = model.observed_information_matrix(filter_error.AT).real * len(u)
    np.testing.assert_allclose(
        information / np.outer(sd, sd), theirs / np.outer(sd, sd), atol=1e-10
    )


def test_the_joint_filter_of_filterpy_has_the_slopes_of_its_step():
    def step(s):
        joint = filter_error.JointFilter()
        joint.x, joint.between = s, (0.05, -0.02)
        joint.predict_x()
        return joint

    start = filter_error.JointFilter().x
    F = step(start.copy()).F
    for k in range(10):
        h = 1e-6 * np.eye(10)[k]
        slope = (step(start + h).x - step(start - h).x) / 2e-6
        np.testing.assert_allclose(F[:, k], slope, atol=1e-8)


@pytest.mark.parametrize("name", races.RACES)
def test_every_race_is_there(name):
    assert callable(races.find_run(name))


PAGE = "Before.\n\n<!-- results -->\n\nold\n\n<!-- end of results -->\n\nAfter.\n"


def test_tables_go_between_the_marks_of_a_page():
    page = pages.put_between(PAGE, "new")
    assert page == PAGE.replace("old", "new")
    with pytest.raises(ValueError, match="lacks the marks"):
        pages.put_between("nothing", "new")


def grown(title, facts):
    """An entry of latest.json."""
    machine = {"processor": "P", "instructions": "avx2"}
    grown = Result("growth", title, "", [Line("x", 1.0, 1.0, 1, 1.0, 0.0)], [], facts)
    return grown.to_json() | {"commit": "abc", "machine": machine}


def test_a_picture_is_drawn_of_what_was_measured(tmp_path):
    held = {
        "races": [
            grown("Growth with rows, 500 samples", {"1000": 0.05, "10000": 0.1}),
            grown("Growth with samples, 5,000 rows", {"100": 0.05, "500": 0.1}),
            grown("Wall time by threads, 100,000 rows", {"1": 1.0, "2": 0.6}),
        ]
    }
    assert pages.series(held, "Growth with rows") == ([1000.0, 10000.0], [0.05, 0.1])
    pages.draw(held, tmp_path / "p.svg")
    assert "<svg" in (tmp_path / "p.svg").read_text()
    assert pages.tables(held).startswith("Measured: `abc` on P (avx2).")


def test_a_child_is_charged_for_its_processor_time():
    spent = baseline.spend([sys.executable, "-c", "sum(range(10**6))"])
    assert spent.seconds > 0
    assert spent.kilobytes > 0
    with pytest.raises(RuntimeError, match="no such"):
        baseline.spend([sys.executable, "-c", "import sys; sys.exit('no such')"])


def test_answers_of_apps_are_in_standard_errors():
    parameter = {"value": 3.0, "standard_error": 1.5}
    effects = [
        {"name": "b", "estimate": {"b.s": 4.0}, "standard_error": {"b.s": 2.0}},
        {"name": "a", "estimate": {"a.s": 1.0}, "standard_error": {"a.s": 4.0}},
        {"name": "c", "estimate": {"c.s": None}, "standard_error": {"c.s": None}},
    ]
    assert list(baseline.of_parameters({"parameters": {"x": parameter}})) == [2.0]
    found = baseline.of_effects({"effects": effects})
    np.testing.assert_array_equal(found, [0.25, 2.0, np.nan])


def test_records_that_are_too_long_are_left_out():
    assert lengths_within(10_000, (5_000, 100_000)) == [5_000]
    assert lengths_within(10, (5_000, 100_000)) == [500]
