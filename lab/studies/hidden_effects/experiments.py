# SPDX-License-Identifier: BSD-3-Clause
"""How often the missing effect is found, and how often one that isn't there."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Any

import numpy as np

from sepcal.calibration import Calibration
from sepcal.diagnosis import Diagnosis
from sepcal.flight import Flight
from sepcal.simulation import simulate
from studies.hidden_effects.cases import (
    CASES,
    INVISIBLE,
    NOISES,
    PAIRS,
    PROBES,
    PROXIED,
    UNLOGGED,
    Case,
    calibrate,
    factor_for,
    fly,
)

Row = dict[str, Any]
ROWS = 400  # of flights in which nothing is hidden
MOST_ADDED = 4  # effects in a chain
SLOW = "wind[time]"


@dataclass(frozen=True)
class StudyOptions:
    """How much is flown."""

    seeds: int = 40  # of each effect and size
    null_seeds: int = 100  # of each probe and noise, with nothing hidden
    sigmas: tuple[float, ...] = (5.0, 10.0, 20.0, 50.0)
    first_seed: int = 0
    processes: int | None = None  # None: one a core


def hidden_effects(
    options: StudyOptions, report_progress: Callable[[float], None] = lambda _: None
) -> dict[str, list[Row]]:
    """Runs the study.

    Returns:
        A list of rows for each experiment, one a flight (a case and seed).
    """
    tasks = list(_tasks(options))
    rows: dict[str, list[Row]] = {}
    with ProcessPoolExecutor(options.processes) as pool:
        running = [pool.submit(_run, *task) for task in tasks]
        for done, future in enumerate(as_completed(running), 1):
            experiment, row = future.result()
            rows.setdefault(experiment, []).append(row)
            report_progress(done / len(tasks))
    for flights in rows.values():
        flights.sort(key=lambda row: tuple(str(value) for value in row.values()))
    return rows


def _tasks(options: StudyOptions) -> Iterable[tuple[str, tuple[Any, ...]]]:
    first = options.first_seed
    seeds = range(first, first + options.seeds)
    for case in CASES:
        for sigmas in options.sigmas:
            factor = factor_for(case, sigmas)
            yield from (("power", (case, sigmas, factor, seed)) for seed in seeds)
    for probe in PROBES:
        for noise in NOISES:
            for seed in range(first, first + options.null_seeds):
                yield "null", (probe, noise, seed)
        yield from (("decoys", (probe, seed)) for seed in seeds)
    for pair in PAIRS:
        factors = tuple(factor_for(case, 30.0) for case in pair)
        yield from (("pairs", (pair, factors, seed)) for seed in seeds)
    for case in INVISIBLE:
        yield from (("invisible", (case, seed)) for seed in seeds)
    factor = factor_for(PROXIED, 10.0)
    yield from (("proxy", (PROXIED, factor, seed)) for seed in seeds)
    for case in UNLOGGED:
        factor = factor_for(case, 20.0)
        yield from (("unmeasured", (case, factor, seed)) for seed in seeds)
    yield from (("slow", (seed,)) for seed in seeds)


def _run(experiment: str, arguments: tuple[Any, ...]) -> tuple[str, Row]:
    return experiment, EXPERIMENTS[experiment](*arguments)


def _stands_first(name: str, diagnosis: Diagnosis) -> bool:
    """The first by name, or one that would do as well instead."""
    return name in [diagnosis.effects[0].name, *diagnosis.explanations]


def _is_found(name: str, diagnosis: Diagnosis) -> bool:
    return name in [effect.name for effect in diagnosis.found] + diagnosis.explanations


def _power(case: Case, sigmas: float, factor: float, seed: int) -> Row:
    flight = fly(case.probe, {case.effect: case.sizes(factor)}, seed, case.rows)
    base = calibrate(case.probe, flight)
    diagnosis = base.diagnose()
    name = flight.effects[0]
    row: Row = {
        "probe": case.probe,
        "effect": name,
        "sigmas": sigmas,
        "seed": seed,
        "first": _stands_first(name, diagnosis),
        "found": _is_found(name, diagnosis),
        "top": diagnosis.effects[0].name,
        "p": diagnosis.effects[0].p_adjusted,
    }
    if sigmas == 10.0 and diagnosis.effects[0].name == name:
        row |= _after_add(base, diagnosis, flight.truth)
    return row


def _after_add(base: Calibration, diagnosis: Diagnosis, truth: dict[str, float]) -> Row:
    """What the promise was worth."""
    best = diagnosis.effects[0]
    better = base.add(best.name)
    entry = better.history[-1]
    if not entry.rmse_before > 0 or math.isnan(entry.rmse_after):
        return {}
    shared = [name for name, parameter in base.parameters.items() if not parameter.fixed]
    error = {
        fitted: np.array(
            [
                (calibration[name].value - truth[name]) / better[name].standard_error
                for name in shared
            ]
        )
        for fitted, calibration in (("before", base), ("after", better))
    }
    return {
        "promised": entry.predicted_drop,
        "achieved": 1.0 - entry.rmse_after / entry.rmse_before,
        "held_out_before": entry.held_out_before,
        "held_out_after": entry.held_out_after,
        "worst_error_before": float(np.nanmax(np.abs(error["before"]))),
        "worst_error_after": float(np.nanmax(np.abs(error["after"]))),
        "lag_one_before": float(np.mean([abs(m.lag_one) for m in base.compare().overall])),
        "lag_one_after": float(np.mean([abs(m.lag_one) for m in better.compare().overall])),
        "status": better.status,
    }


def _null(probe: str, noise: str, seed: int) -> Row:
    flight = fly(probe, {}, seed, ROWS, noise)
    diagnosis = calibrate(probe, flight).diagnose()
    return {
        "probe": probe,
        "noise": noise,
        "seed": seed,
        "verdict": diagnosis.verdict,
        "top": diagnosis.effects[0].name,
    }


def _decoys(probe: str, seed: int) -> Row:
    flight = fly(probe, {}, seed, ROWS, decoys=5)
    diagnosis = calibrate(probe, flight).diagnose()
    chosen = [effect.name for effect in diagnosis.found if "decoy" in effect.name]
    return {"probe": probe, "seed": seed, "verdict": diagnosis.verdict, "decoys": len(chosen)}


def _pairs(pair: tuple[Case, Case], factors: tuple[float, float], seed: int) -> Row:
    probe, rows = pair[0].probe, max(case.rows for case in pair)
    hide = {case.effect: case.sizes(factor) for case, factor in zip(pair, factors, strict=True)}
    flight = fly(probe, hide, seed, rows)
    calibration = calibrate(probe, flight)
    named: list[str] = []
    for _ in range(MOST_ADDED):
        diagnosis = calibration.diagnose()
        if not diagnosis.found:
            break
        best = diagnosis.found[0]
        named += [*diagnosis.explanations, *best.name.split("+")]
        calibration = calibration.add(best.name)
    met = [name in named for name in flight.effects]
    added = sum(len(setting.name.split("+")) for setting in calibration.effects)
    return {
        "probe": probe,
        "effects": " and ".join(flight.effects),
        "seed": seed,
        "both": all(met),
        "third": added > len(pair),
    }


def _invisible(case: Case, seed: int) -> Row:
    flight = fly(case.probe, {case.effect: case.sizes(1.0)}, seed, case.rows)
    diagnosis = calibrate(case.probe, flight).diagnose()
    return {
        "probe": case.probe,
        "effect": case.effect,
        "seed": seed,
        "status": diagnosis[case.effect].status,
        "verdict": diagnosis.verdict,
    }


def _proxy(case: Case, factor: float, seed: int) -> Row:
    """Beside the current, a battery voltage that sags with it."""
    flight = fly(case.probe, {case.effect: case.sizes(factor)}, seed, case.rows)
    rng = np.random.default_rng(seed)
    current = flight["current_a"]
    sag = current + 0.1 * current.std() * rng.standard_normal(flight.rows)
    columns = {**flight, "voltage_v": 16.0 - 0.05 * sag}
    proxied = Flight(columns, maneuver=flight.maneuvers)
    diagnosis = calibrate(case.probe, proxied).diagnose()
    return {
        "probe": case.probe,
        "seed": seed,
        "top": diagnosis.effects[0].name,
        "true_stands_first": _stands_first(case.effect, diagnosis),
        "proxy_found": _is_found("bias[voltage_v]", diagnosis),
        "verdict": diagnosis.verdict,
    }


def _unmeasured(case: Case, factor: float, seed: int) -> Row:
    """The driver is not in the log."""
    flight = fly(case.probe, {case.effect: case.sizes(factor)}, seed, case.rows)
    gone = {"flap", "throttle", "current_a", "panel_current_a"}
    columns = {header: values for header, values in flight.items() if header not in gone}
    bare = Flight(columns, maneuver=flight.maneuvers)
    diagnosis = calibrate(case.probe, bare).diagnose()
    return {
        "probe": case.probe,
        "effect": case.effect,
        "seed": seed,
        "verdict": diagnosis.verdict,
        "top": diagnosis.effects[0].name,
        "missing": " ".join(diagnosis.missing_channels),
    }


def _slow(seed: int) -> Row:
    """A wind that drifts by 2 m/s in 250 s, which noise of its own speed could swallow."""
    seconds = 250.0
    full = simulate("five-hole", hide={SLOW: [2.0 / seconds, 0.0]}, rate=10.0, seed=seed)
    rows = full["time_s"] < full["time_s"][0] + seconds
    columns = {header: values[rows] for header, values in full.items()}
    flight = Flight(columns, maneuver=np.asarray(full.maneuvers)[rows])
    diagnosis = calibrate("five-hole", flight).diagnose()
    return {
        "seed": seed,
        "first": _stands_first(SLOW, diagnosis),
        "found": _is_found(SLOW, diagnosis),
        "top": diagnosis.effects[0].name,
    }


EXPERIMENTS: dict[str, Callable[..., Row]] = {
    "power": _power,
    "null": _null,
    "decoys": _decoys,
    "pairs": _pairs,
    "invisible": _invisible,
    "proxy": _proxy,
    "unmeasured": _unmeasured,
    "slow": _slow,
}
