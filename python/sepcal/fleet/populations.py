# SPDX-License-Identifier: BSD-3-Clause
"""How parameters spread over vehicles, and what that says of a new one."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from sepcal import _core
from sepcal.calibration import Calibration, parse
from sepcal.columns import Array
from sepcal.flight import AnyFlight, Flight, kind_of, read
from sepcal.printing import aligned, in_line
from sepcal.reading import reading_for

if TYPE_CHECKING:
    from collections.abc import Mapping


class Population:
    """theta_v = mean + b_v, b_v ~ N(0, spread), by restricted maximum likelihood.

    Example:
        >>> files = sepcal.datasets.write_fleet(folder)
        >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
        >>> population = fleet.population()
        >>> value, error = population.mean["s_va"]
        >>> abs(value - 0.95) < 3 * error
        True
    """

    def __init__(
        self, core: _core.Population, base: Calibration, common: tuple[str, ...] = ()
    ) -> None:
        self.core = core
        self.base = base
        self.common = common  # parameters that have one value for all
        self.parameters: list[str] = list(core.parameters)
        self.vehicles: list[str] = list(core.vehicles)

    @property
    def mean(self) -> dict[str, tuple[float, float]]:
        """Each parameter's mean over vehicles, and its standard error."""
        errors = np.sqrt(np.diag(np.asarray(self.core.mean_covariance)))
        return {
            name: (float(self.core.mean[k]), float(errors[k]))
            for k, name in enumerate(self.parameters)
        }

    @property
    def spread(self) -> dict[str, float]:
        """Each parameter's standard deviation between vehicles."""
        sizes = np.sqrt(np.diag(np.asarray(self.core.spread)))
        return dict(zip(self.parameters, map(float, sizes), strict=True))

    @property
    def covariance(self) -> Array:
        """Between vehicles (p x p), in the order of `parameters`."""
        return np.asarray(self.core.spread)

    def of(self, vehicle: str) -> dict[str, tuple[float, float]]:
        """A vehicle's shrunken estimates and their standard errors. Raises Error for another.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> sorted(fleet.population().of("V02"))
            ['c_va', 's_va']
        """
        if vehicle not in self.vehicles:
            raise _core.Error(f"the fleet has no vehicle '{in_line(vehicle)}'")
        at = self.vehicles.index(vehicle)
        return {
            name: (float(self.core.shrunken[k, at]), float(self.core.shrunken_errors[k, at]))
            for k, name in enumerate(self.parameters)
        }

    @property
    def prior(self) -> Mapping[str, tuple[float, float]]:
        """What the fleet says of a vehicle that it has not seen, as fit() takes it."""
        variances = np.diag(np.asarray(self.core.spread) + np.asarray(self.core.mean_covariance))
        return {
            name: (float(self.core.mean[k]), float(np.sqrt(variances[k])))
            for k, name in enumerate(self.parameters)
            if name in self.base.names  # a rate is the fleet's: at the mean of its attribute
        }

    def calibrate(self, flight: AnyFlight) -> Calibration:
        """A new vehicle's calibration from a short flight, the fleet being its prior.

        Raises Error as fit() does.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> short = sepcal.simulate("pitot-static", rows=200, seed=7).head(60)
            >>> fleet.population().calibrate(short).status
            'converged'
        """
        if not isinstance(flight, Flight):
            with reading_for(kind_of(self.base.core.model)):
                flight = read(flight)
        told = json.loads(self.base.to_json())
        told["options"]["prior"] = {name: list(both) for name, both in self.prior.items()}
        like = parse(json.dumps(told), self.base.own_effects, self.base.own_model)
        core = _core.calibrate_like(like.core, flight._core)
        return Calibration(core, flight, self.base.own_effects, self.base.own_model)

    def to_json(self) -> str:
        """As JSON.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> '"V02"' in fleet.population().to_json()
            True
        """
        told = {
            "parameters": {
                name: {
                    "mean": self.mean[name][0],
                    "standard_error": self.mean[name][1],
                    "spread": self.spread[name],
                }
                for name in self.parameters
            },
            "vehicles": {
                vehicle: {
                    name: {"value": value, "standard_error": error}
                    for name, (value, error) in self.of(vehicle).items()
                }
                for vehicle in self.vehicles
            },
            "log_likelihood": float(self.core.log_likelihood),
            "converged": bool(self.core.converged),
        }
        return json.dumps(told, indent=2) + "\n"

    def spread_in_words(self, name: str) -> str:
        """A parameter's spread as pages show it.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> fleet.add("pressure_offset", common=True).population().spread_in_words(
            ...     "pressure_offset.s"
            ... )
            'the same in all'
        """
        return "the same in all" if name in self.common else f"{self.spread[name]:.3g}"

    def __str__(self) -> str:
        rows = [["parameter", "mean", "std. error", "spread between vehicles"]]
        for name in self.parameters:
            value, error = self.mean[name]
            rows.append([name, f"{value:.6g}", f"{error:.2g}", self.spread_in_words(name)])
        lines = [f"{len(self.vehicles)} vehicles, by restricted maximum likelihood.", ""]
        if not self.core.converged:
            lines.insert(1, "The search did not converge.")
        return "\n".join([*lines, *aligned(rows)])
