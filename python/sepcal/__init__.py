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

from sepcal import _core, datasets, reading, rivals, triads
from sepcal._core import (
    Advice,
    Applied,
    Approximation,
    CataloguedEffect,
    ChannelMisfit,
    Collinearity,
    ColumnCheck,
    Combination,
    CorrelatedPair,
    Departure,
    Derived,
    DetectionLimit,
    DiagnosisWork,
    EffectFinding,
    EffectSetting,
    Error,
    ErrorBound,
    FlightFit,
    HistoryEntry,
    Injection,
    Innovation,
    LocalMinimum,
    LogNote,
    Misfit,
    NoiseFit,
    NoiseModel,
    OutputValidation,
    Parameter,
    ParameterInterval,
    ReferenceMisfit,
    ResidualNoise,
    ScreenResults,
    StageOne,
    StepwiseStep,
    Unexplained,
    UnmeasuredCause,
    Window,
    __version__,
)
from sepcal.aircraft import Aero, RigidAircraft
from sepcal.aircraft_fits import AddedRegressor, AircraftFit, TwoSteps, two_step
from sepcal.calibration import Calibration, load
from sepcal.catalogue import effects
from sepcal.certificates import Certificate, CostBound, bound_cost, certify
from sepcal.checking import FlightCheck, check
from sepcal.coefficients import AeroCoefficients, aero_coefficients
from sepcal.comparison import Comparison
from sepcal.concatenation import Concatenation, concatenate
from sepcal.design_trial import DesignTrial
from sepcal.diagnosis import Diagnosis
from sepcal.exporting import Exported, export
from sepcal.filters import Filter, SmoothedPass
from sepcal.fit_options import FitOptions
from sepcal.fitting import fit
from sepcal.fleet import Fleet, FleetComparison, FleetDiagnosis, Monitoring, Population
from sepcal.flight import Flight, read, read_csv, stream_csv
from sepcal.frequency_responses import FrequencyResponse, frequency_response
from sepcal.geomagnetism import EarthField, earth_field
from sepcal.geometry import Aircraft, read_aircraft
from sepcal.input_design import InputDesign, multisines, three_two_one_one
from sepcal.intervals import Intervals, Prediction, predict, profile_intervals
from sepcal.joining import join
from sepcal.joint import fit_jointly
from sepcal.least_squares import LeastSquares, RecursiveLeastSquares, iterate_least_squares
from sepcal.linear_systems import (
    DiscreteInputs,
    Transition,
    discretise,
    discretise_inputs,
    matrix_exponential,
    propagate,
)
from sepcal.logs import LogContents, LoggedFlight, list_log, read_log
from sepcal.many import fit_many
from sepcal.many_results import ManyFit
from sepcal.models import (
    Accelerometer,
    DampedSinusoids,
    FiveHoleProbe,
    Magnetometer,
    Model,
    PitotStatic,
    ScalarExample1,
    ScalarExample2,
    VaneBoom,
)
from sepcal.monte_carlo_results import MonteCarlo, ParameterStudy
from sepcal.noise import fit_noise, simulate_noise, whiten
from sepcal.own_effect import Effect
from sepcal.own_model import OwnModel, SeparableModel
from sepcal.own_state_model import StateModel, Trajectory
from sepcal.reporting import report
from sepcal.results import Fit
from sepcal.running_trials import monte_carlo, stream_trials
from sepcal.simulated_trial import SimulatedTrial
from sepcal.simulation import SimulatedFlight, simulate
from sepcal.smoothing import Smoothed, smooth
from sepcal.stepwise import Stepwise
from sepcal.tracking import Track, track
from sepcal.trajectories import FlightPath, ShortPeriod, TrajectoryModel, TrajectoryOptions
from sepcal.triads import Triad
from sepcal.trial_fits import TrialFits, fit_trials
from sepcal.trials import Estimates, Failure, TrialRecord
from sepcal.validation import Validation, validate

_core.read_foreign_files(reading.read_foreign)

__all__ = [
    "Accelerometer",
    "AddedRegressor",
    "Advice",
    "Aero",
    "AeroCoefficients",
    "Aircraft",
    "AircraftFit",
    "Applied",
    "Approximation",
    "Calibration",
    "CataloguedEffect",
    "Certificate",
    "ChannelMisfit",
    "Collinearity",
    "ColumnCheck",
    "Combination",
    "Comparison",
    "Concatenation",
    "CorrelatedPair",
    "CostBound",
    "DampedSinusoids",
    "Departure",
    "Derived",
    "DesignTrial",
    "DetectionLimit",
    "Diagnosis",
    "DiagnosisWork",
    "DiscreteInputs",
    "EarthField",
    "Effect",
    "EffectFinding",
    "EffectSetting",
    "Error",
    "ErrorBound",
    "Estimates",
    "Exported",
    "Failure",
    "Filter",
    "Fit",
    "FitOptions",
    "FiveHoleProbe",
    "Fleet",
    "FleetComparison",
    "FleetDiagnosis",
    "Flight",
    "FlightCheck",
    "FlightFit",
    "FlightPath",
    "FrequencyResponse",
    "HistoryEntry",
    "Injection",
    "Innovation",
    "InputDesign",
    "Intervals",
    "LeastSquares",
    "LocalMinimum",
    "LogContents",
    "LogNote",
    "LoggedFlight",
    "Magnetometer",
    "ManyFit",
    "Misfit",
    "Model",
    "Monitoring",
    "MonteCarlo",
    "NoiseFit",
    "NoiseModel",
    "OutputValidation",
    "OwnModel",
    "Parameter",
    "ParameterInterval",
    "ParameterStudy",
    "PitotStatic",
    "Population",
    "Prediction",
    "RecursiveLeastSquares",
    "ReferenceMisfit",
    "ResidualNoise",
    "RigidAircraft",
    "ScalarExample1",
    "ScalarExample2",
    "ScreenResults",
    "SeparableModel",
    "ShortPeriod",
    "SimulatedFlight",
    "SimulatedTrial",
    "Smoothed",
    "SmoothedPass",
    "StageOne",
    "StateModel",
    "Stepwise",
    "StepwiseStep",
    "Track",
    "Trajectory",
    "TrajectoryModel",
    "TrajectoryOptions",
    "Transition",
    "Triad",
    "TrialFits",
    "TrialRecord",
    "TwoSteps",
    "Unexplained",
    "UnmeasuredCause",
    "Validation",
    "VaneBoom",
    "Window",
    "__version__",
    "aero_coefficients",
    "bound_cost",
    "certify",
    "check",
    "concatenate",
    "datasets",
    "discretise",
    "discretise_inputs",
    "earth_field",
    "effects",
    "export",
    "fit",
    "fit_jointly",
    "fit_many",
    "fit_noise",
    "fit_trials",
    "frequency_response",
    "iterate_least_squares",
    "join",
    "list_log",
    "load",
    "matrix_exponential",
    "monte_carlo",
    "multisines",
    "predict",
    "profile_intervals",
    "propagate",
    "read",
    "read_aircraft",
    "read_csv",
    "read_log",
    "report",
    "rivals",
    "simulate",
    "simulate_noise",
    "smooth",
    "stream_csv",
    "stream_trials",
    "three_two_one_one",
    "track",
    "triads",
    "two_step",
    "validate",
    "whiten",
]


def __dir__() -> list[str]:
    """The public names, without the modules that they come from."""
    return __all__
