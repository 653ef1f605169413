# SPDX-License-Identifier: BSD-3-Clause
"""A trial ready made: a probe flies a simulated calibration, and is fitted on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

from numpy.random import Generator

from sepcal._core import Error
from sepcal.arguments import checked
from sepcal.calibration import Calibration
from sepcal.fit_options import FitOptions
from sepcal.fitting import fit
from sepcal.models import FiveHoleProbe, Magnetometer, PitotStatic
from sepcal.options import to_core
from sepcal.own_effect import given_effects, name_effects
from sepcal.simulation import SimulatedFlight, simulate

ROTATION = ("eta_x", "eta_y", "eta_z")
ROWS_TO_TRY = 20
SEEDS = 2**63


@checked
class SimulatedTrial:
    """simulate() with a seed of the trial's own, then fit(), for sepcal.monte_carlo().

        trial = sepcal.SimulatedTrial(probe, simulation={"rows": 400, "noise": "pink"}, samples=64)

    Args:
        model: The probe that is flown and fitted.
        simulation: Keyword arguments of sepcal.simulate() but the seed: rows, noise, parameters,
            hide, ...
        **options: Keyword arguments of sepcal.fit(); threads is 1 by default.

    Raises:
        Error: As simulate() and fit() refuse an argument; the model is no probe that can be flown;
            a Magnetometer with a field's strength flies with a rotation, which it can't see, so
            that its truth means other parameters than the fit.

    Example:
        >>> trial = sepcal.SimulatedTrial(sepcal.PitotStatic(), simulation={"rows": 60})
        >>> fit, truth = trial(np.random.default_rng(1))
        >>> fit.rows, truth["w_n"]
        (60, -3.8)
    """

    def __init__(
        self,
        model: FiveHoleProbe | PitotStatic | Magnetometer,
        *,
        simulation: Mapping[str, Any] | None = None,
        **options: Unpack[FitOptions],
    ) -> None:
        if not isinstance(model, FiveHoleProbe | PitotStatic | Magnetometer):
            raise Error(
                f"{model!r} can't be flown; give a FiveHoleProbe, PitotStatic or Magnetometer, or "
                "write a trial of your own: a function of a numpy.random.Generator"
            )
        self.model = model
        self.simulation = dict(simulation or {})
        if "seed" in self.simulation:
            raise Error("simulation has a seed; each trial has one of its own, leave it out")
        self.options: FitOptions = {**options, "threads": options.get("threads") or 1}
        to_core({**self.options, "effects": name_effects(given_effects(self.options))})
        tried = simulate(model, **{**self.simulation, "rows": ROWS_TO_TRY})
        if any(tried.truth.get(name) for name in ROTATION if name not in model.parameters):
            raise Error(
                "the field's strength alone doesn't show a rotation; fly without one: "
                'simulation={"parameters": {"eta_x": 0, "eta_y": 0, "eta_z": 0}}'
            )

    def fly(self, rng: Generator) -> SimulatedFlight:
        """The trial's flight.

        Example:
            >>> trial = sepcal.SimulatedTrial(sepcal.PitotStatic(), simulation={"rows": 60})
            >>> trial.fly(np.random.default_rng(1)).rows
            60
        """
        return simulate(self.model, **self.simulation, seed=int(rng.integers(SEEDS)))

    def __call__(self, rng: Generator) -> tuple[Calibration, dict[str, float]]:
        """The calibration, and the flight's truth."""
        flight = self.fly(rng)
        return fit(self.model, flight, **self.options), flight.truth

    def __repr__(self) -> str:
        return f"SimulatedTrial({self.model!r}, simulation={self.simulation!r})"
