# SPDX-License-Identifier: BSD-3-Clause
"""Calibrates aerospace sensors from flight data.

    flight = sepcal.read_csv("flight.csv")
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    base = sepcal.fit(probe, flight)
    print(base)
    print(base.compare())

The two-stage batch estimator (Sun & Gebre-Egziabher) for models z = A(u, xi2) xi1 + b(u, xi2) + v.
SI units, angles in rad, fields in uT. Body axes are forward-right-down, navigation axes
north-east-down.
"""

from sepcal._core import Error, __version__
from sepcal.calibration import Applied, Calibration, load
from sepcal.comparison import Comparison, Misfit
from sepcal.fitting import fit
from sepcal.flight import Flight, read_csv
from sepcal.models import FiveHoleProbe, Magnetometer, Model, ScalarExample1, ScalarExample2
from sepcal.options import FitOptions
from sepcal.results import Combination, Fit, LocalMinimum, Parameter, StageOne
from sepcal.simulation import SimulatedFlight, simulate

__all__ = [
    "Applied",
    "Calibration",
    "Combination",
    "Comparison",
    "Error",
    "Fit",
    "FitOptions",
    "FiveHoleProbe",
    "Flight",
    "LocalMinimum",
    "Magnetometer",
    "Misfit",
    "Model",
    "Parameter",
    "ScalarExample1",
    "ScalarExample2",
    "SimulatedFlight",
    "StageOne",
    "__version__",
    "fit",
    "load",
    "read_csv",
    "simulate",
]
