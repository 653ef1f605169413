# SPDX-License-Identifier: BSD-3-Clause
"""Records whose truth is known, for the coverage of intervals: each is drawn by its seed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from sepcal.columns import Array
from sepcal.fit_options import FitOptions
from sepcal.fitting import fit
from sepcal.flight import Flight
from sepcal.intervals import Intervals, profile_intervals
from sepcal.models import FiveHoleProbe, Model, PitotStatic, ScalarExample1
from sepcal.own_model import SeparableModel
from sepcal.simulation import simulate

Draw = Callable[[int], Intervals]


@dataclass(frozen=True)
class CoverageCase:
    """Intervals by seed, and the values that they should hold."""

    title: str
    draw: Draw
    truth: Mapping[str, float]
    share: float = 1.0  # of the seeds: fewer for what takes long


class Saturation:
    """z = s u / (K + u): where u stays small against K only s / K is seen."""

    inputs: ClassVar = {"u": "1"}
    outputs: ClassVar = {"z": "1"}
    linear: ClassVar = {"s": "1"}
    nonlinear: ClassVar = {"K": ("1", 0.01, 100.0)}

    def at(self, u: Any, xi2: Array) -> tuple[Array, Array]:  # noqa: ANN401
        """A (N, 1, 1) and b (N, 1)."""
        return (u.u / (xi2[0] + u.u))[:, None, None], np.zeros((len(u.u), 1))

    def derivatives(self, u: Any, xi2: Array) -> tuple[Array, Array]:  # noqa: ANN401
        """Derivatives of A (N, 1, 1, 1) and b (N, 1, 1)."""
        slope = -u.u / (xi2[0] + u.u) ** 2
        return slope[:, None, None, None], np.zeros((len(u.u), 1, 1))


@dataclass(frozen=True)
class Columns:
    """A model on columns: the same inputs for every seed, noise of its own for each."""

    model: Model | SeparableModel
    inputs: Mapping[str, Array]
    clean: Array  # (N,), of the only output, z
    sigma: float
    memory: float = 0.0  # of the noise, an autoregression of the first order
    options: FitOptions = field(default_factory=FitOptions)

    def __call__(self, seed: int) -> Intervals:
        """Both intervals of all parameters, R unknown."""
        rng = np.random.default_rng(seed)
        noise = rng.standard_normal(self.clean.size)
        for i in range(1, noise.size):
            noise[i] = self.memory * noise[i - 1] + np.sqrt(1 - self.memory**2) * noise[i]
        data = {**self.inputs, "z": self.clean + self.sigma * noise}
        options: FitOptions = {**self.options, "threads": 1}
        fitted = fit(self.model, data, **options)
        return profile_intervals(self.model, data, fitted, **options)


WAVE = {"a": 0.3, "c": -0.5, "b": 0.2}


def _wave(rows: int, sigma: float, memory: float = 0.0, **options: Any) -> Columns:  # noqa: ANN401
    """The first scalar example over one turn."""
    eta = np.linspace(0.0, 2.0 * np.pi, rows, endpoint=False)
    clean = (1.0 + WAVE["a"]) * np.cos(eta + WAVE["b"]) + WAVE["c"]
    wide = {"b": (-1.5, 1.5)}
    chosen: FitOptions = {"samples": 32, "bounds": wide, **options}  # type: ignore[typeddict-item]
    return Columns(ScalarExample1(), {"eta": eta}, clean, sigma, memory, chosen)


def _bounded(rows: int, sigma: float, errors_inside: float) -> Columns:
    """The wave with b's lower bound so many of its standard errors below the truth."""
    error = sigma / ((1.0 + WAVE["a"]) * np.sqrt(rows / 2.0))  # sines and cosines are orthogonal
    return _wave(rows, sigma, bounds={"b": (WAVE["b"] - errors_inside * error, 1.0)})


SATURATED = {"s": 2.0, "K": 3.0}


def _saturation() -> Columns:
    u = np.linspace(0.5, 4.0, 8)
    clean = SATURATED["s"] * u / (SATURATED["K"] + u)
    return Columns(Saturation(), {"u": u}, clean, 0.12, options={"samples": 32})


TUBE = ("s_va", "c_va", "w_n", "w_e")
FIVE_HOLE = FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))


def _tube(seed: int) -> Intervals:
    """A tube that was flown over 30 degrees of track instead of all round."""
    flown = simulate("pitot-static", rows=600, seed=seed)
    track = np.arctan2(flown["ve_mps"], flown["vn_mps"])
    rows = np.abs(track) < np.pi / 12.0
    part = Flight({header: values[rows] for header, values in flown.items()})
    return fit(PitotStatic(), part, threads=1, samples=100).intervals()


def _five_hole(seed: int) -> Intervals:
    flown = simulate(FIVE_HOLE, rows=400, seed=seed)
    return fit(FIVE_HOLE, flown, threads=1, samples=32).intervals()


def coverage_cases() -> dict[str, CoverageCase]:
    """All cases by name; the truths of flights are the simulator's own."""
    tube = simulate("pitot-static", rows=10).truth
    five_hole = simulate(FIVE_HOLE, rows=10).truth
    return {
        "short": CoverageCase("a wave, 12 rows", _wave(12, 0.3), WAVE),
        "at_bound": CoverageCase("truth on b's bound, 50 rows", _bounded(50, 0.3, 0.0), WAVE),
        "near_bound": CoverageCase(
            "b's bound one standard error from the truth, 50 rows", _bounded(50, 0.3, 1.0), WAVE
        ),
        "curved": CoverageCase("s u / (K + u), 8 rows", _saturation(), SATURATED),
        "weak": CoverageCase(
            "Pitot-static tube on 30 degrees of track",
            _tube,
            {name: tube[name] for name in TUBE},
            0.5,
        ),
        "coloured": CoverageCase(
            "a wave, 300 rows, noise AR(0.9)", _wave(300, 0.3, memory=0.9), WAVE
        ),
        "five_hole": CoverageCase(
            "five-hole probe, 400 rows",
            _five_hole,
            {name: five_hole[name] for name in FIVE_HOLE.parameters},
            0.25,
        ),
    }
