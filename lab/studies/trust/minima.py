# SPDX-License-Identifier: BSD-3-Clause
"""Tubes against an exhaustive search for their minimum, and problems that are meant to be hard.

The search shares no code with the library: a grid over the wind, then SciPy from its lowest dips.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from scipy.ndimage import minimum_filter
from scipy.optimize import least_squares

import sepcal
from oracle.five_hole_probe import FiveHoleProbe
from oracle.magnetometer import Magnetometer
from oracle.maximum_likelihood import fit_with_noise
from oracle.model import Model
from oracle.simulate import (
    FIVE_HOLE_NOISE,
    FIVE_HOLE_TRUTH,
    MAGNETOMETER_NOISE,
    MAGNETOMETER_TRUTH,
    Columns,
    measure,
    simulate_five_hole,
    simulate_magnetometer,
)
from studies.study import Finding, seed_range
from studies.trust.noises import Array
from studies.trust.part import Key, Part, Row

SPREADS = (0.02, 0.2)  # of the airspeed, a share of it
WINDS = (0.3, 0.8, 1.1)  # over the airspeed
TUBE_ROWS = (60, 150, 400)
HARD = ("wide bounds", "tiny turn", "12 rows")
LEAST_SCALE = 0.05  # a sensor's scale is positive
EXCESS = 0.01  # of the cost: two minima are one
SURE = 8.0  # standard errors

Problem: TypeAlias = tuple[sepcal.Model, Columns, dict[str, float], dict[str, tuple[float, float]]]


def fly_tube(
    seed: int, rows: int, spread: float, wind: float, turn: float | None = None
) -> tuple[Columns, dict[str, float]]:
    """A tube's columns in a turn [rad], 0.6 to 2 full ones if not given, and the truth."""
    rng = np.random.default_rng([seed, rows, round(100 * spread), round(100 * wind)])
    time = np.linspace(0.0, 120.0, rows)
    first = rng.uniform(0, 2 * np.pi)
    full = 2 * np.pi * rng.choice([0.6, 1.0, 2.0])
    heading = first + (full if turn is None else turn) * time / 120.0
    airspeed = 25.0 * (1.0 + spread * np.sin(time / 6.0 + rng.uniform(0, 6)))
    angle = rng.uniform(0, 2 * np.pi)
    truth = {
        "s_va": rng.uniform(0.85, 1.15),
        "c_va": rng.uniform(-2, 2),
        "w_n": wind * 25.0 * np.cos(angle),
        "w_e": wind * 25.0 * np.sin(angle),
    }
    columns = {
        "vn": airspeed * np.cos(heading) + truth["w_n"],
        "ve": airspeed * np.sin(heading) + truth["w_e"],
        "vd": 0.3 * np.sin(time / 5.0),
    }
    read = truth["s_va"] * np.hypot(airspeed, columns["vd"]) + truth["c_va"]
    return columns | {"airspeed": read + 0.3 * rng.standard_normal(rows)}, truth


def search_exhaustively(columns: Columns, truth: Mapping[str, float], widest: float) -> float:
    """The least sum of squares of a tube, each wind component within -+ widest [m/s]."""
    ground = np.stack([columns[name] for name in ("vn", "ve", "vd")])
    z = columns["airspeed"]
    starts = [np.array([truth["w_n"], truth["w_e"]])]
    for reach in {min(widest, 100.0), widest}:
        lattice = np.linspace(-reach, reach, 201)
        squares = _profile(ground, z, lattice, lattice)
        dips = np.argwhere(squares == minimum_filter(squares, size=3, mode="nearest"))
        lowest = dips[np.argsort(squares[tuple(dips.T)])][:25]
        step = lattice[1] - lattice[0]
        for i, j in lowest:
            fine = np.linspace(-step, step, 21)
            near = _profile(ground, z, lattice[i] + fine, lattice[j] + fine)
            k, m = np.unravel_index(np.argmin(near), near.shape)
            starts.append(np.array([lattice[i] + fine[k], lattice[j] + fine[m]]))
    return min(_descend(ground, z, start.clip(-widest, widest), widest) for start in starts)


def _fit_line(speed: Array, z: Array) -> tuple[Array, Array]:
    """Scale, bound below, and the sum of squares that it leaves, of z on speed (..., N)."""
    centred = speed - speed.mean(axis=-1, keepdims=True)
    rest = z - z.mean()
    product, square = centred @ rest, np.sum(centred**2, axis=-1)
    scale = np.maximum(product / np.maximum(square, 1e-300), LEAST_SCALE)
    return scale, rest @ rest - 2.0 * scale * product + scale**2 * square


def _profile(ground: Array, z: Array, north: Array, east: Array) -> Array:
    """The sum of squares on a lattice of winds, its shape (north.size, east.size)."""
    rows = []
    across = (ground[1] - east[:, np.newaxis]) ** 2 + ground[2] ** 2
    for w_n in north:
        rows.append(_fit_line(np.sqrt((ground[0] - w_n) ** 2 + across), z)[1])
    return np.stack(rows)


def _descend(ground: Array, z: Array, wind: Array, widest: float) -> float:
    def speed(w: Array) -> Array:
        return np.asarray(np.hypot(np.hypot(ground[0] - w[0], ground[1] - w[1]), ground[2]))

    def residual(x: Array) -> Array:
        return np.asarray(z - x[2] * speed(x) - x[3])

    def jacobian(x: Array) -> Array:
        v = speed(x)
        along = x[2] * (ground[:2] - x[:2, np.newaxis]) / np.maximum(v, 1e-9)
        return np.stack([*along, -v, -np.ones_like(v)], axis=-1)

    scale = float(_fit_line(speed(wind), z)[0])
    start = np.array([*wind, scale + 1e-9, z.mean() - scale * speed(wind).mean()])
    free = (
        np.array([-widest, -widest, LEAST_SCALE, -np.inf]),
        np.array([widest, widest, np.inf, np.inf]),
    )
    found = least_squares(residual, start, jacobian, free, x_scale="jac", xtol=1e-12, ftol=1e-12)
    return 2.0 * float(found.cost)


def try_tube(case: str, rows: int, seed: int) -> dict[str, Any]:
    """The excess of the fit's cost over the search's."""
    spread, wind = (float(word) for word in case.split(" ")[1::2])
    columns, truth = fly_tube(seed, rows, spread, wind)
    fitted = sepcal.fit(sepcal.PitotStatic(), _to_flight(columns), threads=1)
    return _judge(fitted, truth) | {"excess": _excess(fitted, columns, truth, 100.0)}


def _excess(
    fitted: sepcal.Fit, columns: Columns, truth: Mapping[str, float], widest: float
) -> float:
    rows = columns["vn"].size
    square = rows * fitted.rmse["airspeed"] ** 2
    return float(0.5 * rows * np.log(square / search_exhaustively(columns, truth, widest)))


TUBE_CASES = tuple(f"spread {spread} wind {wind}" for spread in SPREADS for wind in WINDS)
HARD_CASES = tuple(
    f"{probe}: {kind}" for probe in ("pitot-static", "five-hole", "magnetometer") for kind in HARD
)
ORACLES: dict[str, tuple[Model, Array, Array]] = {
    "five-hole": (FiveHoleProbe(4.5, 4.5), FIVE_HOLE_TRUTH, FIVE_HOLE_NOISE),
    "magnetometer": (Magnetometer(), MAGNETOMETER_TRUTH, MAGNETOMETER_NOISE),
}
PROBES = {
    "five-hole": sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5),
    "magnetometer": sepcal.Magnetometer(),
}
WIDE = {"lambda": 3.0, "b": 1.5, "eps": 3.0, "eta": 3.0, "alpha": 3.0}  # by a name's first word


def try_hard(case: str, seed: int) -> dict[str, Any]:
    """Whether a hard problem ends in another minimum or far from the truth, and what is said."""
    probe, kind = case.split(": ")
    rng = np.random.default_rng([seed, HARD_CASES.index(case)])
    rows = 12 if kind == "12 rows" else 150
    turn = float(np.exp(rng.uniform(np.log(0.01), np.log(0.5)))) if kind == "tiny turn" else None
    if probe == "pitot-static":
        columns, truth = fly_tube(seed, rows, 0.1, float(rng.uniform(0.0, 1.1)), turn)
        widest = 1000.0 if kind == "wide bounds" else 100.0
        bounds = dict.fromkeys(("w_n", "w_e"), (-widest, widest))
        fitted = sepcal.fit(sepcal.PitotStatic(), _to_flight(columns), bounds=bounds, threads=1)
        return _judge(fitted, truth) | {"excess": _excess(fitted, columns, truth, widest)}
    model, xi, noise = ORACLES[probe]
    columns = _draw(probe, seed, rows)
    if turn is not None:
        columns = measure(rng, model, _shrink(columns, turn), xi, noise)
    bounds = {}
    if kind == "wide bounds":
        widths = {name: WIDE[name.split("_")[0]] for name in model.nonlinear}
        bounds = {name: (-width, width) for name, width in widths.items()}
    fitted = sepcal.fit(PROBES[probe], _to_flight(columns), bounds=bounds, threads=1)
    truth = dict(zip(model.parameters, xi.tolist(), strict=True))
    return _judge(fitted, truth) | {"excess": _excess_over_oracle(fitted, model, columns, xi)}


def _excess_over_oracle(
    fitted: sepcal.Fit, model: Model, columns: Columns, xi: Array
) -> float | None:
    """Over SciPy's minimum from the truth; None where it finds none, or one beyond the bounds."""
    try:
        found = fit_with_noise(model, columns, xi)
    except RuntimeError:
        return None
    parameters = [fitted[name] for name in model.parameters]
    inside = [one.lower <= x <= one.upper for one, x in zip(parameters, found.values, strict=True)]
    return fitted.cost - found.cost if all(inside) else None


def _draw(probe: str, seed: int, rows: int) -> Columns:
    if probe == "magnetometer":
        return simulate_magnetometer(Magnetometer(), seed=seed, rows=rows)
    return simulate_five_hole(FiveHoleProbe(4.5, 4.5), seed=seed, rows=rows)


def _shrink(columns: Columns, turn: float) -> Columns:
    """Attitudes, flow angles and fields that change as if all were flown within `turn` [rad]."""
    moving = ("roll", "pitch", "yaw", "p", "q", "r", "dpa", "dpb", "hx", "hy", "hz")
    shrunk = dict(columns)
    for name in moving:
        if name in columns:
            values = np.unwrap(columns[name]) if name == "yaw" else columns[name]
            shrunk[name] = values.mean() + turn / np.pi * (values - values.mean())
    return shrunk


UNITS = dict.fromkeys(("roll", "pitch", "yaw"), "rad")
UNITS |= dict.fromkeys(("p", "q", "r"), "radps")
UNITS |= dict.fromkeys(("pt", "ps", "dpa", "dpb"), "pa")
UNITS |= dict.fromkeys(("vn", "ve", "vd", "airspeed"), "mps")
UNITS |= dict.fromkeys(("hx", "hy", "hz", "mx", "my", "mz"), "ut")
UNITS["rho"] = "kgpm3"


def _to_flight(columns: Columns) -> sepcal.Flight:
    headed = {f"{name}_{UNITS[name]}": values for name, values in columns.items()}
    return sepcal.Flight({"time_s": 0.1 * np.arange(headed[next(iter(headed))].size)} | headed)


def _judge(fitted: sepcal.Fit, truth: Mapping[str, float]) -> dict[str, Any]:
    """Status, message, the least scale and how far the estimates lie from the truth."""
    off = [
        abs(fitted[name].value - value) / fitted[name].standard_error
        for name, value in truth.items()
        if fitted[name].standard_error > 0
    ]
    scales = [fitted["s_va"].value] if "s_va" in truth else []
    scales += [
        1.0 + fitted[name].value
        for name in truth
        if name in ("lambda_va", "lambda_x", "lambda_y", "lambda_z")
    ]
    return {
        "status": fitted.status,
        "message": fitted.message,
        "at_bound": fitted.at_bound,
        "scale": min(scales),
        "off": max(off, default=0.0),
    }


def is_wrong(row: Mapping[str, Any]) -> bool:
    """Exit code 0 in another minimum than the lowest."""
    higher = row["excess"] is not None and row["excess"] > EXCESS
    return row["status"] == "converged" and higher


def is_silent(row: Mapping[str, Any]) -> bool:
    """Exit code 0, no message, and another minimum, a scale that is none or far from the truth."""
    failed = is_wrong(row) or row["off"] > SURE or not 0.5 < row["scale"] < 2.0
    said = row["message"] or row["at_bound"]  # which stands in the status too
    return row["status"] == "converged" and not said and failed


def _count(what: str, rows: Sequence[Row], asked: str) -> Finding:
    converged = sum(row["status"] == "converged" for row in rows)
    wrong = sum(is_wrong(row) for row in rows)
    silent = sum(is_silent(row) for row in rows)
    figure = f"of {len(rows)}, {converged} converged, {wrong} wrong, {silent} silent failures"
    return Finding(what, figure, f"0 {asked}", silent == 0 and (wrong == 0 or asked == "silent"))


def _summarise_tubes(rows: Sequence[Row]) -> list[Finding]:
    return [_count("minima, tubes", rows, "wrong")]


def _summarise_hard(rows: Sequence[Row]) -> list[Finding]:
    cases = sorted({row["key"][1] for row in rows})
    return [
        _count(f"minima, {case}", [row for row in rows if row["key"][1] == case], "silent")
        for case in cases
    ]


def _tube_keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for case in TUBE_CASES:
            for rows in TUBE_ROWS:
                yield "minima", case, "white", 0.0, rows, seed


def _hard_keys(arguments: argparse.Namespace) -> Iterator[Key]:
    for seed in seed_range(arguments):
        for case in HARD_CASES:
            yield "hard", case, "white", 0.0, 0, seed


MINIMA = Part(_tube_keys, lambda key: try_tube(key[1], key[4], key[5]), _summarise_tubes)
HARD_PROBLEMS = Part(_hard_keys, lambda key: try_hard(key[1], key[5]), _summarise_hard)
