# SPDX-License-Identifier: BSD-3-Clause
"""Stepwise regression one term at a time, against forward selection by NumPy."""

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import sepcal
from apps import run
from studies import moment_flights as flights

Array = NDArray[np.float64]

ROWS = 800
POOL = ("alpha", "q_hat", "elevator", "alpha^2", "alpha*elevator", "throttle")
ENTERS = 20.0  # the F of SIDPAC's swr


class Entered(NamedTuple):
    """A term, its partial F and R^2 with it."""

    term: str
    partial_f: float
    r_squared: float


def left_by(terms: tuple[str, ...], channels: dict[str, Array], Cm: Array) -> float:
    """Sum of squares beside a constant and these."""
    X = np.column_stack([flights.regressor(name, channels) for name in ("1", *terms)])
    return float(np.sum((Cm - X @ np.linalg.lstsq(X, Cm, rcond=None)[0]) ** 2))


def select(channels: dict[str, Array], Cm: Array) -> list[Entered]:
    """Forward: the largest partial F enters, from ENTERS on."""
    total = float(np.sum((Cm - Cm.mean()) ** 2))
    entered: list[Entered] = []
    while True:
        chosen = tuple(one.term for one in entered)
        before = left_by(chosen, channels, Cm)
        offers = []
        for name in POOL:
            if name in chosen:
                continue
            after = left_by((*chosen, name), channels, Cm)
            freedom = Cm.size - len(chosen) - 2
            offers.append(Entered(name, (before - after) * freedom / after, 1 - after / total))
        best = max(offers, key=lambda offer: offer.partial_f)
        if best.partial_f < ENTERS:
            return entered
        entered.append(best)


def twin(seed: int, noise: str) -> tuple[dict[str, Array], Array]:
    """A Twin Otter's moment: the elevator and alpha work against each other, and q is small."""
    draws = np.random.default_rng(seed)
    channels = flights.maneuver(seed, ROWS)
    elevator = channels["elevator"]
    lagged = np.convolve(elevator - elevator.mean(), np.exp(-np.arange(60) / 20.0))[:ROWS]
    channels["alpha"] = 0.08 - 1.2 * lagged / 20.0 + 0.15 * (channels["alpha"] - 0.08)
    truth = {"1": 0.05, "alpha": -1.6, "q_hat": -26.0, "elevator": -1.7}
    e = draws.standard_normal(ROWS)
    if noise == "coloured":
        for row in range(1, ROWS):
            e[row] = 0.9 * e[row - 1] + np.sqrt(1 - 0.81) * e[row]
    return channels, flights.pitching(channels, truth) + 0.004 * e


def fit_constant(channels: dict[str, Array], Cm: Array) -> sepcal.AircraftFit:
    """Of Cm_0 alone."""
    model = sepcal.Aero(flights.AIRCRAFT, equations={"Cm": ["1"]})
    return sepcal.fit(model, flights.fly(channels, Cm))


ONLY = [f"Cm[{name}]" for name in POOL]


@pytest.mark.parametrize("noise", ["white", "coloured"])
@pytest.mark.parametrize("seed", range(3))
def test_the_order_and_its_figures_are_those_of_forward_selection(seed: int, noise: str) -> None:
    channels, Cm = twin(seed, noise)
    expected = select(channels, Cm)
    assert len(expected) >= 3
    course = fit_constant(channels, Cm).diagnose(auto=True, only=ONLY, rule="partial-f")
    kept = [
        step for step in course.steps if not any(step.effect in s.dropped for s in course.steps)
    ]
    assert len(kept) >= 3
    assert [step.effect for step in course.steps] == [f"Cm[{one.term}]" for one in expected]
    assert_allclose(
        [step.partial_f for step in course.steps], [one.partial_f for one in expected], rtol=1e-6
    )
    assert_allclose(
        [step.r_squared for step in course.steps], [one.r_squared for one in expected], rtol=1e-9
    )


def test_every_candidate_has_its_figures() -> None:
    channels, Cm = twin(0, "white")
    diagnosis = fit_constant(channels, Cm).diagnose(only=ONLY, rule="partial-f")
    assert diagnosis.rule == "partial-f"
    assert {effect.name for effect in diagnosis.effects} == set(ONLY)
    before = left_by((), channels, Cm)
    for effect in diagnosis.effects:
        after = left_by((effect.name[3:-1],), channels, Cm)
        assert effect.partial_f == pytest.approx((before - after) * (ROWS - 2) / after, rel=1e-7)
        assert effect.r_squared == pytest.approx(1 - after / before, rel=1e-9, abs=1e-12)
        assert effect.r_squared_without == pytest.approx(0.0, abs=1e-12)
        assert np.isnan(effect.p_value)
    assert diagnosis.advice.effect == diagnosis.effects[0].name
    assert "partial F" in diagnosis.sentence


@pytest.mark.parametrize("noise", ["white", "coloured"])
def test_what_a_verdict_finds_as_a_pair_is_added_one_at_a_time(noise: str) -> None:
    channels, Cm = twin(1, noise)
    course = fit_constant(channels, Cm).diagnose(auto=True, only=ONLY)
    added = [step.effect for step in course.steps]
    assert not [name for name in added if "+" in name]
    assert {"Cm[alpha]", "Cm[elevator]", "Cm[q_hat]"} <= set(added)
    assert all(step.partial_f >= ENTERS for step in course.steps)
    assert np.all(np.diff([step.r_squared for step in course.steps]) > 0)


def test_the_command_prints_the_steps(tmp_path: Path) -> None:
    channels, Cm = twin(0, "white")
    expected = select(channels, Cm)
    fit_constant(channels, Cm).save(tmp_path / "base.json")
    flown = flights.fly(channels, Cm)
    header = ",".join(flown.columns)
    table = np.column_stack([flown[name] for name in flown.columns])
    np.savetxt(
        tmp_path / "flight.csv", table, delimiter=",", header=header, comments="", fmt="%.17g"
    )
    asked = ["diagnose", "flight.csv", "base.json", "--auto", "--rule", "partial-f"]
    asked += [word for name in ONLY for word in ("--only", name)]
    done = run("sepcal-aircraft", *asked, folder=tmp_path)
    assert done.code in (0, 3), done.err
    rows = [line.split() for line in done.out.splitlines() if line.startswith("+ Cm[")]
    assert [row[1] for row in rows] == [f"Cm[{one.term}]" for one in expected]
    for row, one in zip(rows, expected, strict=True):
        assert float(row[3]) == pytest.approx(one.partial_f, rel=1e-3)
        assert float(row[4]) == pytest.approx(one.r_squared, abs=1e-4)
    written = run("sepcal-aircraft", *asked, "--json", folder=tmp_path)
    steps = json.loads(written.out)["stepwise"]["steps"]
    assert [step["effect"] for step in steps] == [f"Cm[{one.term}]" for one in expected]


def test_an_unknown_rule_is_refused() -> None:
    channels, Cm = twin(0, "white")
    with pytest.raises(sepcal.Error, match="rule 'aic' is unknown; known: 'verdict', 'partial-f'"):
        fit_constant(channels, Cm).diagnose(rule="aic")
