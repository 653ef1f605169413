# SPDX-License-Identifier: BSD-3-Clause
# Made by scripts/lint --fix from cpp/src/bindings.
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing

__all__: list[str] = [
    "Advice",
    "AlonsoShusterFit",
    "Applied",
    "Approximation",
    "Calibration",
    "CataloguedEffect",
    "Certificate",
    "Change",
    "ChannelMisfit",
    "Collinearity",
    "ColumnCheck",
    "Combination",
    "Comparison",
    "CorrelatedPair",
    "CostBound",
    "CostLandscape",
    "Departure",
    "Derived",
    "DetectionLimit",
    "Diagnosis",
    "DiagnosisOptions",
    "DiagnosisWork",
    "Disturbance",
    "EffectFinding",
    "EffectSetting",
    "Error",
    "ErrorBound",
    "Exported",
    "FirstStep",
    "Fit",
    "FleetDiagnosis",
    "FleetFinding",
    "Flight",
    "FlightCheck",
    "FlightDeparture",
    "FlightFactor",
    "FlightFigures",
    "FlightFit",
    "FlightTrackOptions",
    "HauptKasdinFit",
    "HistoryEntry",
    "Injection",
    "Innovation",
    "Intervals",
    "IterationOptions",
    "LEAST_GAIN",
    "LocalMinimum",
    "LogNote",
    "ManyFit",
    "Misfit",
    "Model",
    "NoiseFit",
    "NoiseModel",
    "NoiseSize",
    "OptionRow",
    "Options",
    "OutputValidation",
    "Parameter",
    "ParameterChange",
    "ParameterInterval",
    "Population",
    "Prediction",
    "PreparedFlight",
    "PythonFunctions",
    "ReferenceMisfit",
    "ResidualNoise",
    "SIGNIFICANT_BELOW",
    "ScreenResults",
    "SingleStageFit",
    "SmoothedRecord",
    "StageOne",
    "SteppedCalibration",
    "StepwiseStep",
    "Track",
    "TwoStepProblem",
    "Unexplained",
    "UnmeasuredCause",
    "VISIBLE_FROM",
    "VehicleFit",
    "VehicleSeries",
    "Window",
    "accelerometer",
    "angles_of_quaternion",
    "attitude_independent_magnetometer",
    "autocorrelation",
    "bin_means",
    "bound_cost",
    "calibrate",
    "calibrate_jointly",
    "calibrate_like",
    "certify",
    "channels",
    "check",
    "check_not_input",
    "check_output",
    "concatenation",
    "confidence_ellipse",
    "cost_landscape",
    "diagnose_fleet",
    "effects",
    "effects_of",
    "example_in_five_states",
    "example_in_three_states",
    "export_to_file",
    "find_spread",
    "fit",
    "fit_alonso_shuster",
    "fit_haupt_kasdin",
    "fit_many",
    "fit_noise",
    "fit_population",
    "fit_single_stage",
    "fit_trials",
    "fit_vehicles",
    "five_hole_probe",
    "follow_vehicles",
    "foreign_reader",
    "gather_figures",
    "hear_progress",
    "in_line",
    "in_shell",
    "join_rates",
    "list_fleet_candidates",
    "magnetometer",
    "magnetometer_in_nine_states",
    "option_rows",
    "p_of_distance",
    "parse_calibration",
    "parse_sized_effect",
    "pitot_static",
    "predict",
    "prepare_columns",
    "prepare_flight",
    "profile_intervals",
    "px4_pressure_sensor",
    "python_model",
    "quantiles",
    "read_calibration",
    "read_csv",
    "read_foreign_files",
    "reduce",
    "run_sepcal",
    "scalar_example_1",
    "scalar_example_2",
    "sdp3x_pressure",
    "shipped_probes",
    "simulate",
    "simulate_noise",
    "smooth",
    "spectrum",
    "stream_csv",
    "vane_boom",
    "whiten",
    "with_rate",
    "write_whole",
]

class OptionRow:
    """
    An option of fit().
    """

    _fields: typing.ClassVar[tuple] = (
        "name",
        "sentence",
        "unset",
        "type",
        "choices",
        "flags",
        "form",
        "is_of_log",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def choices(self) -> list[str]:
        """
        Choices of an option that is chosen by name.
        """
    @property
    def flags(self) -> list[str]:
        """
        The programs' flags; empty: code alone has it.
        """
    @property
    def form(self) -> str:
        """
        The form of the flag's value.
        """
    @property
    def is_of_log(self) -> bool:
        """
        Chooses of a flight's columns and rows.
        """
    @property
    def name(self) -> str: ...
    @property
    def sentence(self) -> str: ...
    @property
    def type(self) -> str:
        """
        As type checkers call it.
        """
    @property
    def unset(self) -> str:
        """
        The words for an option that is not given; empty: its default.
        """

class Options:
    coloured_errors: bool
    decimal: str
    delimiter: str
    drop_invalid: bool
    hessian: str
    jacobian: str
    join: str
    loss: str
    method: str
    sampling: str
    search: str
    second_stage: str
    smooth_inputs: bool
    stage_one_segments: str
    stage_two_segments: str
    where: str
    def __init__(self) -> None: ...
    def read_typed(self, name: str, texts: collections.abc.Sequence[str]) -> None: ...
    @property
    def bounds(self) -> dict[str, tuple[float | None, float | None]]: ...
    @bounds.setter
    def bounds(
        self,
        arg1: collections.abc.Mapping[
            str,
            tuple[
                typing.SupportsFloat | typing.SupportsIndex | None,
                typing.SupportsFloat | typing.SupportsIndex | None,
            ],
        ],
    ) -> None: ...
    @property
    def descents(self) -> int: ...
    @descents.setter
    def descents(self, arg1: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    @property
    def drop_repeats(self) -> list[str]: ...
    @drop_repeats.setter
    def drop_repeats(self, arg1: collections.abc.Sequence[str]) -> None: ...
    @property
    def effects(self) -> list[str]: ...
    @effects.setter
    def effects(self, arg1: collections.abc.Sequence[str]) -> None: ...
    @property
    def fix(self) -> dict[str, float]: ...
    @fix.setter
    def fix(
        self, arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex]
    ) -> None: ...
    @property
    def free(self) -> list[str]: ...
    @free.setter
    def free(self, arg1: collections.abc.Sequence[str]) -> None: ...
    @property
    def from_time(self) -> float | None: ...
    @from_time.setter
    def from_time(self, arg1: typing.SupportsFloat | typing.SupportsIndex | None) -> None: ...
    @property
    def ignore(self) -> list[str]: ...
    @ignore.setter
    def ignore(self, arg1: collections.abc.Sequence[str]) -> None: ...
    @property
    def iterations(self) -> int: ...
    @iterations.setter
    def iterations(self, arg1: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    @property
    def loss_width(self) -> float: ...
    @loss_width.setter
    def loss_width(self, arg1: typing.SupportsFloat | typing.SupportsIndex) -> None: ...
    @property
    def map(self) -> dict[str, str]: ...
    @map.setter
    def map(self, arg1: collections.abc.Mapping[str, str]) -> None: ...
    @property
    def noise(self) -> dict[str, float]: ...
    @noise.setter
    def noise(
        self, arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex]
    ) -> None: ...
    @property
    def noise_iterations(self) -> int: ...
    @noise_iterations.setter
    def noise_iterations(self, arg1: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    @property
    def noise_tolerance(self) -> float: ...
    @noise_tolerance.setter
    def noise_tolerance(self, arg1: typing.SupportsFloat | typing.SupportsIndex) -> None: ...
    @property
    def prior(self) -> dict[str, tuple[float, float]]: ...
    @prior.setter
    def prior(
        self,
        arg1: collections.abc.Mapping[
            str,
            tuple[
                typing.SupportsFloat | typing.SupportsIndex,
                typing.SupportsFloat | typing.SupportsIndex,
            ],
        ],
    ) -> None: ...
    @property
    def process_noise(self) -> dict[str, float]: ...
    @process_noise.setter
    def process_noise(
        self, arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex]
    ) -> None: ...
    @property
    def samples(self) -> int: ...
    @samples.setter
    def samples(self, arg1: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    @property
    def sampling_distribution(self) -> dict[str, tuple[float, float]]: ...
    @sampling_distribution.setter
    def sampling_distribution(
        self,
        arg1: collections.abc.Mapping[
            str,
            tuple[
                typing.SupportsFloat | typing.SupportsIndex,
                typing.SupportsFloat | typing.SupportsIndex,
            ],
        ],
    ) -> None: ...
    @property
    def screens(self) -> dict[str, float] | None: ...
    @screens.setter
    def screens(
        self, arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex] | None
    ) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg1: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    @property
    def start(self) -> dict[str, float]: ...
    @start.setter
    def start(
        self, arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex]
    ) -> None: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, arg1: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    @property
    def to_time(self) -> float | None: ...
    @to_time.setter
    def to_time(self, arg1: typing.SupportsFloat | typing.SupportsIndex | None) -> None: ...

class Parameter:
    """
    One estimate, in `unit`.
    """

    _fields: typing.ClassVar[tuple] = (
        "name",
        "value",
        "standard_error",
        "standard_error_white",
        "standard_error_noise_model",
        "standard_error_blocks",
        "unit",
        "lower",
        "upper",
        "at_bound",
        "fixed",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def at_bound(self) -> bool:
        """
        True if a bound stopped it.
        """
    @property
    def fixed(self) -> bool:
        """
        True if the fit held it.
        """
    @property
    def lower(self) -> float:
        """
        Lower bound; infinite if there is none.
        """
    @property
    def name(self) -> str: ...
    @property
    def remark(self) -> str:
        """
        Fixed, at its lower or at its upper bound; else nothing.
        """
    @property
    def standard_error(self) -> float:
        """
        The standard error to use. NaN where undefined: fixed, at a bound, singular.
        """
    @property
    def standard_error_blocks(self) -> float:
        """
        Standard error from leaving out blocks of the record; NaN with too few blocks.
        """
    @property
    def standard_error_noise_model(self) -> float:
        """
        Standard error from a noise model of each output's residual.
        """
    @property
    def standard_error_white(self) -> float:
        """
        Standard error if the residuals were white.
        """
    @property
    def unit(self) -> str: ...
    @property
    def upper(self) -> float:
        """
        Upper bound; infinite if there is none.
        """
    @property
    def value(self) -> float: ...

class NoiseSize:
    """
    A noise's size that filter error estimated, or was given.
    """

    _fields: typing.ClassVar[tuple] = ("name", "value", "unit", "standard_error", "at_floor")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def at_floor(self) -> bool:
        """
        True if only the floor stopped it.
        """
    @property
    def name(self) -> str:
        """
        "q_alpha" of a process noise, "r_alpha_m" of an output.
        """
    @property
    def standard_error(self) -> float:
        """
        NaN if the size was given or is at its floor.
        """
    @property
    def unit(self) -> str: ...
    @property
    def value(self) -> float:
        """
        Root of the spectral density; for an output, the standard deviation.
        """

class Combination:
    """
    A linear combination of parameters that the record leaves open or determines poorly.
    """

    _fields: typing.ClassVar[tuple] = ("text", "parameters", "standard_error")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def parameters(self) -> tuple[str, ...]:
        """
        Those that take part, largest share first.
        """
    @property
    def standard_error(self) -> float:
        """
        Standard error of the combination; infinite where it is singular.
        """
    @property
    def text(self) -> str:
        """
        "0.8 w_n - 0.6 lambda_va", coefficients of unit length.
        """

class EffectSetting:
    """
    An effect of a fit, with what it took from the record; None or empty where it takes none.
    """

    _fields: typing.ClassVar[tuple] = (
        "name",
        "centre",
        "mean",
        "knots",
        "means",
        "labels",
        "span",
        "t0",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def centre(self) -> float | None:
        """
        Centre of a power's driver, in the driver's unit.
        """
    @property
    def knots(self) -> tuple[float, ...]:
        """
        Knots of a spline.
        """
    @property
    def labels(self) -> tuple[str, ...]:
        """
        Labels of the driver `maneuver`; the first has no coefficient.
        """
    @property
    def mean(self) -> float | None:
        """
        Mean of the power over the fitted rows, where it is taken away.
        """
    @property
    def means(self) -> tuple[float, ...]:
        """
        Means of its functions over the fitted rows, where they are taken away.
        """
    @property
    def name(self) -> str:
        """
        Whole, aliases resolved: "wind[altitude_m]".
        """
    @property
    def span(self) -> tuple[float, float] | None:
        """
        The record's first and last time [s].
        """
    @property
    def t0(self) -> float | None:
        """
        t0 of a step [s].
        """

class LocalMinimum:
    """
    A local minimum of Tr[R] within the bounds.
    """

    _fields: typing.ClassVar[tuple] = ("xi2", "trace_r")
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def trace_r(self) -> float:
        """
        Sum over outputs of the mean squared residual, in the outputs' units.
        """
    @property
    def xi2(self) -> dict[str, float]: ...

class ScreenResults:
    """
    Eqs. 17 and 18 at every sample, each (S,); norms are Frobenius', over the whole record.
    """

    _fields: typing.ClassVar[tuple] = (
        "ratio_a",
        "ratio_b",
        "curvature_a",
        "curvature_b",
        "accepted",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def accepted(self) -> typing.Annotated[numpy.typing.NDArray[numpy.bool], "[m, 1]"]:
        """
        False: the sample was not used.
        """
    @property
    def curvature_a(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Smallest eigenvalue of the sum of A's second derivatives.
        """
    @property
    def curvature_b(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The same of b.
        """
    @property
    def ratio_a(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        |dA/dxi2| l_2 / |A|.
        """
    @property
    def ratio_b(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        |db/dxi2| l_2 / |b|; zero where b does not depend on xi2.
        """

class StageOne:
    """
    Samples of xi2 and Tr[R] at each (Eqs. 16, 19, Steps 2-4); of a global search, all it tried.

    Fixed parameters have no part in it. The samples are not kept in a calibration's JSON.
    """

    _fields: typing.ClassVar[tuple] = (
        "samples",
        "trace_r",
        "best",
        "best_trace_r",
        "minima",
        "unique_minimum",
        "flat_directions",
        "screens",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def best(self) -> dict[str, float]:
        """
        The sample with the least Tr[R].
        """
    @property
    def best_trace_r(self) -> float: ...
    @property
    def flat_directions(self) -> list[str]:
        """
        In words: a valley of Tr[R] and no point (Fig. 6).
        """
    @property
    def minima(self) -> list[LocalMinimum]:
        """
        Distinct ones, lowest first.
        """
    @property
    def samples(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (S, n_2), in the model's order.
        """
    @property
    def screens(self) -> ScreenResults | None:
        """
        Where fit() was asked for them.
        """
    @property
    def trace_r(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (S,); infinite where the model is not finite.
        """
    @property
    def unique_minimum(self) -> bool:
        """
        One minimum and no flat direction.
        """

class CorrelatedPair:
    """
    Two estimates that go together.
    """

    _fields: typing.ClassVar[tuple] = ("first", "second", "correlation")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def correlation(self) -> float: ...
    @property
    def first(self) -> str: ...
    @property
    def second(self) -> str: ...

class Collinearity:
    """
    Which estimates a record hardly tells apart (Belsley, Kuh & Welsch).
    """

    _fields: typing.ClassVar[tuple] = (
        "names",
        "pairs",
        "condition_indices",
        "variance_proportions",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def condition_indices(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (k,), from 1 up; above 30 columns hardly differ.
        """
    @property
    def names(self) -> list[str]:
        """
        The k estimates that have a standard error.
        """
    @property
    def pairs(self) -> list[CorrelatedPair]:
        """
        |correlation| above 0.9, strongest first.
        """
    @property
    def variance_proportions(
        self,
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (k, k): the share of an estimate's variance (a column each) by the direction of each condition index (a row each).
        """

class Fit:
    """
    The two-stage batch estimate.
    """

    _fields: typing.ClassVar[tuple] = (
        "status",
        "message",
        "parameters",
        "n_1",
        "covariance",
        "correlation",
        "covariance_white",
        "covariance_noise_model",
        "covariance_blocks",
        "noise",
        "rmse",
        "cost",
        "method",
        "noise_sizes",
        "log_likelihood",
        "log_likelihood_without",
        "rows",
        "unobservable",
        "weak",
        "stage_one",
        "second_stage",
        "iterations",
        "noise_iterations",
        "effects",
        "text",
        "explained",
    )
    def __getitem__(self, arg0: str) -> Parameter: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Fit) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def collinearity(self) -> Collinearity:
        """
        Which estimates the record hardly tells apart.
        """
    @property
    def correlation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n).
        """
    @property
    def cost(self) -> float:
        """
        J of Eq. 6; by filter error V_m, S 5.7.
        """
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n), in that order; NaN where there is no standard error.
        """
    @property
    def covariance_blocks(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n), as it is among blocks of the record; of a loaded one only its diagonal.
        """
    @property
    def covariance_noise_model(
        self,
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n), as each output's noise model has it; of a loaded one only its diagonal.
        """
    @property
    def covariance_white(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n), of white residuals; of a loaded one only its diagonal.
        """
    @property
    def effects(self) -> list[EffectSetting]:
        """
        That joined the model, in order.
        """
    @property
    def explained(self) -> str:
        """
        The same with the whole message, as by the apps' --explain.
        """
    @property
    def iterations(self) -> int:
        """
        Iterations of stage two's minimisations.
        """
    @property
    def log_likelihood(self) -> float:
        """
        By filter error; else NaN.
        """
    @property
    def log_likelihood_without(self) -> float:
        """
        Output error's, from which filter error began; else NaN.
        """
    @property
    def message(self) -> str:
        """
        One line; empty where there is nothing to say.
        """
    @property
    def method(self) -> str:
        """
        "output-error" or "filter-error".
        """
    @property
    def n_1(self) -> int:
        """
        How many of them are linear.
        """
    @property
    def noise(self) -> dict[str, float]:
        """
        By output: standard deviation, given or from R-hat = SSE / N.
        """
    @property
    def noise_iterations(self) -> int:
        """
        Alternations of R with the parameters.
        """
    @property
    def noise_sizes(self) -> dict[str, NoiseSize]:
        """
        By filter error, by name: process noises, then outputs; else empty.
        """
    @property
    def parameters(self) -> dict[str, Parameter]:
        """
        Linear, then nonlinear, in the model's order.
        """
    @property
    def rmse(self) -> dict[str, float]:
        """
        By output, unwhitened, in its unit.
        """
    @property
    def rows(self) -> int:
        """
        That stage two used.
        """
    @property
    def second_stage(self) -> str:
        """
        "joint" or "projected": what stage two used in the end.
        """
    @property
    def stage_one(self) -> StageOne: ...
    @property
    def status(self) -> str:
        """
        "converged", "not_converged" or "not_identifiable".
        """
    @property
    def text(self) -> str:
        """
        The app's page, as print() shows it.
        """
    @property
    def unobservable(self) -> list[Combination]:
        """
        Singular, or uncertain beyond half the width of their bounds.
        """
    @property
    def weak(self) -> list[Combination]:
        """
        Singular value below a fiftieth of the largest.
        """

class CataloguedEffect:
    """
    An effect that fit(..., effects=[name]) adds to a probe's model.
    """

    _fields: typing.ClassVar[tuple] = ("name", "equation", "drivers", "unit")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def drivers(self) -> str:
        """
        The columns that it needs.
        """
    @property
    def equation(self) -> str:
        """
        The equation that joins the model.
        """
    @property
    def name(self) -> str:
        """
        `port[driver]`, or a name of its own; DRIVER stands for any.
        """
    @property
    def unit(self) -> str:
        """
        Unit of its coefficient.
        """

class Model:
    def along(self, arg0: dict, arg1: collections.abc.Sequence[str]) -> Model: ...
    def draw(
        self,
        arg0: dict,
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg3: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def evaluate(
        self,
        arg0: dict,
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"] | None,
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def input_tangent(
        self,
        arg0: dict,
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg3: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def inputs(self) -> list: ...
    @property
    def linear(self) -> list: ...
    @property
    def nonlinear(self) -> list: ...
    @property
    def outputs(self) -> list: ...
    @property
    def process_noises(self) -> list[str]: ...
    @property
    def ships_a_probe(self) -> bool: ...

class PythonFunctions:
    def __init__(
        self, gather: typing.Any, at: typing.Any, try_at: typing.Any, derivatives: typing.Any
    ) -> None: ...

class NoiseModel:
    """
    The noise of one output: phi(B) (1 - B)^d e = sigma w, w white.
    """

    _fields: typing.ClassVar[tuple] = ("d", "phi", "sigma", "free_level")
    def __getstate__(self) -> tuple: ...
    def __init__(
        self,
        *,
        d: typing.SupportsFloat | typing.SupportsIndex = 0.0,
        phi: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"] = ...,
        sigma: typing.SupportsFloat | typing.SupportsIndex = 1.0,
        free_level: bool = False,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def d(self) -> float:
        """
        In [0, 1): 0 white, 0.5 pink, near 1 a slow drift.
        """
    @property
    def free_level(self) -> bool:
        """
        Whether nothing is assumed of the mean of a segment.
        """
    @property
    def phi(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (p,), of a stationary autoregression.
        """
    @property
    def sigma(self) -> float:
        """
        Standard deviation of w, in the unit of e.
        """

class NoiseFit:
    """
    A noise model of most likelihood.
    """

    _fields: typing.ClassVar[tuple] = (
        "model",
        "minus_two_log_likelihood",
        "informative_rows",
        "evaluations",
        "converged",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def converged(self) -> bool:
        """
        Whether another step would gain next to nothing.
        """
    @property
    def evaluations(self) -> int:
        """
        Evaluations of the likelihood.
        """
    @property
    def informative_rows(self) -> int:
        """
        Rows, less one for each segment where the level is free.
        """
    @property
    def minus_two_log_likelihood(self) -> float:
        """
        Comparable between fits of equal free_level and rows; -infinity of zeros.
        """
    @property
    def model(self) -> NoiseModel:
        """
        The NoiseModel.
        """

class ParameterInterval:
    """
    Both intervals of one parameter, (lower, upper) in `unit`.
    """

    _fields: typing.ClassVar[tuple] = (
        "name",
        "value",
        "unit",
        "gaussian",
        "profile",
        "ends",
        "message",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def ends(self) -> tuple[str, str]:
        """
        What ends the profile's: "crossed", "bound", "open" or "failed".
        """
    @property
    def gaussian(self) -> tuple[float, float]:
        """
        value -+ quantile * standard_error; NaN where there is none.
        """
    @property
    def message(self) -> str:
        """
        One line; empty where there is nothing to say.
        """
    @property
    def name(self) -> str: ...
    @property
    def profile(self) -> tuple[float, float]:
        """
        Infinite where open, NaN where failed.
        """
    @property
    def unit(self) -> str: ...
    @property
    def value(self) -> float: ...

class Intervals:
    """
    Both intervals of a fit's parameters.
    """

    _fields: typing.ClassVar[tuple] = ("level", "parameters", "notes", "json", "text", "explained")
    def __getitem__(self, arg0: str) -> ParameterInterval: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Intervals) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def explained(self) -> str:
        """
        The same with the whole message, as by the apps' --explain.
        """
    @property
    def json(self) -> str: ...
    @property
    def level(self) -> float:
        """
        How often an interval should hold the true value.
        """
    @property
    def notes(self) -> list[str]:
        """
        One line each, for people.
        """
    @property
    def parameters(self) -> dict[str, ParameterInterval]: ...
    @property
    def text(self) -> str:
        """
        The text that print() shows: for a calibration's, the app's page.
        """

class Prediction:
    """
    A fit's predictions of N samples, in the outputs' units and the model's order of outputs.
    """

    _fields: typing.ClassVar[tuple] = (
        "value",
        "standard_error",
        "measurement_error",
        "quantile",
        "time",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Prediction) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def measurement_error(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_z), standard deviation of a new measurement about the value.
        """
    @property
    def quantile(self) -> float:
        """
        Half a band's width in these errors, by the level asked for.
        """
    @property
    def standard_error(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_z), of the value, from the parameters' covariance.
        """
    @property
    def time(self) -> numpy.typing.NDArray[numpy.float64] | None:
        """
        (N,) [s] of a flight's rows; None of columns.
        """
    @property
    def value(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_z), A xi1 + b.
        """

class Certificate:
    """
    A proof about a fit's cost in a box.
    """

    _fields: typing.ClassVar[tuple] = (
        "status",
        "cost",
        "lower",
        "region",
        "boxes",
        "better",
        "better_cost",
        "message",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Certificate) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def better(self) -> dict[str, float]:
        """
        {name: value} where the cost is lower; else empty.
        """
    @property
    def better_cost(self) -> float:
        """
        J there, rounded upwards; NaN if nowhere.
        """
    @property
    def boxes(self) -> int:
        """
        How many were bounded.
        """
    @property
    def cost(self) -> float:
        """
        J at the fit, without ln|R|, rounded upwards.
        """
    @property
    def lower(self) -> float:
        """
        Proven: nothing within the bounds has less.
        """
    @property
    def message(self) -> str:
        """
        One line.
        """
    @property
    def region(self) -> dict[str, tuple[float, float]]:
        """
        {name: (lower, upper)} of the nonlinear parameters, where the minimum may be.
        """
    @property
    def status(self) -> str:
        """
        "global": no parameters within the bounds have a cost lower by more than the
        tolerance; "elsewhere": a lower one was found; "not_certified": the boxes ran out.
        """

class CostBound:
    """
    How far the least cost in a box may be below one.
    """

    _fields: typing.ClassVar[tuple] = (
        "cost",
        "paper_error",
        "paper_lower",
        "l_1",
        "l_2",
        "l_a",
        "l_b",
        "joint_error",
        "lower",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: CostBound) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def cost(self) -> float:
        """
        J(xi2p), least over xi1.
        """
    @property
    def joint_error(self) -> float:
        """
        E', of all samples at once. Proven.
        """
    @property
    def l_1(self) -> float:
        """
        Bound of |xi1|.
        """
    @property
    def l_2(self) -> float:
        """
        Bound of |xi2 - xi2p|.
        """
    @property
    def l_a(self) -> float:
        """
        Lipschitz constant of a sample's A, over R^1/2.
        """
    @property
    def l_b(self) -> float:
        """
        The same constant for b.
        """
    @property
    def lower(self) -> float:
        """
        max(0, sqrt J(xi2p) - sqrt E')^2. Proven: nothing in the box has less.
        """
    @property
    def paper_error(self) -> float:
        """
        E of Eq. 13.
        """
    @property
    def paper_lower(self) -> float:
        """
        J(xi2p) - E, which Eq. 7 takes for a bound and which is none.
        """

class SingleStageFit:
    """
    All parameters at once by one nonlinear programme.
    """

    _fields: typing.ClassVar[tuple] = (
        "converged",
        "names",
        "estimates",
        "noise",
        "cost",
        "evaluations",
        "noise_iterations",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: SingleStageFit) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def converged(self) -> bool:
        """
        As the solver says.
        """
    @property
    def cost(self) -> float:
        """
        J of Eq. 6, as a Fit has it.
        """
    @property
    def estimates(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n,)
        """
    @property
    def evaluations(self) -> int:
        """
        Evaluations of the cost; of Levenberg-Marquardt iterations.
        """
    @property
    def names(self) -> tuple[str, ...]:
        """
        n, linear, then nonlinear, fixed ones among them.
        """
    @property
    def noise(self) -> dict[str, float]:
        """
        {output: standard deviation}
        """
    @property
    def noise_iterations(self) -> int:
        """
        Alternations of R with the parameters.
        """

class FirstStep:
    """
    The states of a two-step fit, found linearly.
    """

    _fields: typing.ClassVar[tuple] = (
        "names",
        "states",
        "information",
        "rank",
        "condition",
        "noise",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def condition(self) -> float:
        """
        Condition of H, its columns of unit length.
        """
    @property
    def information(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (p, p), H' R^-1 H.
        """
    @property
    def names(self) -> tuple[str, ...]:
        """
        p
        """
    @property
    def noise(self) -> dict[str, float]:
        """
        {output: standard deviation}
        """
    @property
    def rank(self) -> int:
        """
        Rank of H.
        """
    @property
    def states(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (p,), of least norm where H is singular.
        """

class HauptKasdinFit:
    """
    A two-step fit by a change of variables.
    """

    _fields: typing.ClassVar[tuple] = (
        "first",
        "converged",
        "names",
        "estimates",
        "standard_errors",
        "covariance",
        "cost",
        "evaluations",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: HauptKasdinFit) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def converged(self) -> bool:
        """
        As the second step's solver says.
        """
    @property
    def cost(self) -> float:
        """
        Cost of Eq. 32.
        """
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n)
        """
    @property
    def estimates(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n,)
        """
    @property
    def evaluations(self) -> int:
        """
        Evaluations of the second step.
        """
    @property
    def first(self) -> FirstStep:
        """
        The first step.
        """
    @property
    def names(self) -> tuple[str, ...]:
        """
        n
        """
    @property
    def standard_errors(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n,), NaN where undefined.
        """

class AlonsoShusterFit:
    """
    TWOSTEP's magnetometer.
    """

    _fields: typing.ClassVar[tuple] = (
        "converged",
        "message",
        "names",
        "estimates",
        "standard_errors",
        "covariance",
        "bias",
        "shape",
        "theta",
        "centred",
        "cost",
        "iterations",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: AlonsoShusterFit) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def bias(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 1]"]:
        """
        n of B = C h + n [uT], (3,).
        """
    @property
    def centred(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        The same of the first step.
        """
    @property
    def converged(self) -> bool:
        """
        Whether the second step did.
        """
    @property
    def cost(self) -> float:
        """
        Half the weighted squares of the second step.
        """
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n, n)
        """
    @property
    def estimates(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n,), NaN where there are none.
        """
    @property
    def iterations(self) -> int:
        """
        Iterations of the second step.
        """
    @property
    def message(self) -> str:
        """
        One line; empty: nothing to say.
        """
    @property
    def names(self) -> tuple[str, ...]:
        """
        n: lambda, alpha and n, or n alone.
        """
    @property
    def shape(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[3, 3]"]:
        """
        C C', (3, 3).
        """
    @property
    def standard_errors(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n,)
        """
    @property
    def theta(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (c, E), (9,), or b, (3,).
        """

class TwoStepProblem:
    """
    Both steps of a Haupt/Kasdin fit.
    """
    def __init__(
        self,
        arg0: Model,
        arg1: collections.abc.Sequence[
            tuple[
                str,
                str,
                typing.SupportsFloat | typing.SupportsIndex,
                typing.SupportsFloat | typing.SupportsIndex,
            ]
        ],
        arg2: typing.Any,
    ) -> None: ...
    def at(
        self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def first(self) -> Model: ...

class Misfit:
    """
    One output over one stretch of a flight; NaN where there are too few rows.
    """

    _fields: typing.ClassVar[tuple] = (
        "segment",
        "output",
        "unit",
        "rows",
        "rmse",
        "mean",
        "lag_one",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def is_white(self) -> bool:
        """
        Whether lag_one is within 3 / sqrt(rows), as noise alone is 369 times in 370.
        """
    @property
    def lag_one(self) -> float:
        """
        Correlation of neighbouring residuals, never across a segment's edge.
        """
    @property
    def mean(self) -> float:
        """
        Mean of z - model: a constant offset of this size would remove it.
        """
    @property
    def output(self) -> str: ...
    @property
    def rmse(self) -> float: ...
    @property
    def rows(self) -> int: ...
    @property
    def segment(self) -> str:
        """
        Maneuver, or "120.0:180.5" [s] where there are no labels; empty: the whole.
        """
    @property
    def unit(self) -> str: ...
    @property
    def verdict(self) -> str:
        """
        In words whether the residuals are noise.
        """

class ChannelMisfit:
    """
    One output's residual against one channel of the flight.
    """

    _fields: typing.ClassVar[tuple] = (
        "driver",
        "output",
        "share_line",
        "share_smooth",
        "slope",
        "slope_error",
        "unit",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def driver(self) -> str:
        """
        "altitude_m"; "time", "alpha", "roll" for what the probe knows by itself.
        """
    @property
    def output(self) -> str: ...
    @property
    def share_line(self) -> float:
        """
        Share of the residual's variance that a straight line explains.
        """
    @property
    def share_smooth(self) -> float:
        """
        Share that a natural spline with six even knots explains.
        """
    @property
    def slope(self) -> float:
        """
        Slope of the line.
        """
    @property
    def slope_error(self) -> float:
        """
        Standard error of the slope in the residual's own noise, rather too large.
        """
    @property
    def unit(self) -> str:
        """
        Unit of the slope.
        """

class Window:
    """
    A stretch of about a twentieth of the rows.
    """

    _fields: typing.ClassVar[tuple] = ("first_s", "last_s", "rows", "rmse", "mean")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def first_s(self) -> float:
        """
        Time of its first row.
        """
    @property
    def last_s(self) -> float:
        """
        Time of its last row.
        """
    @property
    def mean(self) -> dict[str, float]:
        """
        {output: mean of z - model}.
        """
    @property
    def rmse(self) -> dict[str, float]:
        """
        {output: RMSE}.
        """
    @property
    def rows(self) -> int: ...

class Disturbance:
    """
    By filter error: a noise that drives a state, in its own standard deviations along the flight.

    Standard normal where the model is right: beyond 3 in 0.27 % of the rows.
    """

    _fields: typing.ClassVar[tuple] = ("noise", "share_beyond", "rows", "first_s", "last_s", "peak")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def first_s(self) -> float: ...
    @property
    def last_s(self) -> float: ...
    @property
    def noise(self) -> NoiseSize:
        """
        Its size, of the fit.
        """
    @property
    def peak(self) -> float:
        """
        The largest in it, with its sign.
        """
    @property
    def rows(self) -> int:
        """
        Length of the longest run beyond 3 sigma, in rows; 0 if none.
        """
    @property
    def share_beyond(self) -> float:
        """
        Share of the rows beyond 3; NaN of a noise that is none or at its floor.
        """

class OutputValidation:
    """
    How well a model follows an output over all rows.
    """

    _fields: typing.ClassVar[tuple] = (
        "output",
        "r_squared",
        "theil",
        "theil_bias",
        "theil_variance",
        "theil_covariance",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def output(self) -> str: ...
    @property
    def r_squared(self) -> float:
        """
        1 - sum (z - model)^2 / sum (z - mean z)^2; may be negative.
        """
    @property
    def theil(self) -> float:
        """
        Theil's inequality coefficient, rms(z - model) / (rms(z) + rms(model)): 0 exact, 1 worst.
        """
    @property
    def theil_bias(self) -> float:
        """
        Share of the mean square error due to different means.
        """
    @property
    def theil_covariance(self) -> float:
        """
        Share left, due to what doesn't correlate: near 1 for a good model.
        """
    @property
    def theil_variance(self) -> float:
        """
        Share due to different standard deviations.
        """

class ReferenceMisfit:
    """
    A calibrated quantity against an independent sensor's column of the same log.
    """

    _fields: typing.ClassVar[tuple] = (
        "quantity",
        "unit",
        "calibrated",
        "reference",
        "rows",
        "bias",
        "bias_error",
        "rms",
        "sd",
        "lag_one",
        "scale",
        "scale_error",
        "offset",
        "offset_error",
        "scale_reversed",
        "time",
        "difference",
        "against",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def against(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (N,) the reference's values.
        """
    @property
    def bias(self) -> float:
        """
        Mean of calibrated - reference.
        """
    @property
    def bias_error(self) -> float:
        """
        Standard error of the bias; allows for a coloured difference.
        """
    @property
    def calibrated(self) -> str:
        """
        Column of the calibrated quantity, as apply writes it: "airspeed_cal_mps".
        """
    @property
    def difference(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (N,) calibrated - reference.
        """
    @property
    def lag_one(self) -> float:
        """
        Correlation of neighbouring differences.
        """
    @property
    def offset(self) -> float:
        """
        The offset in the same line.
        """
    @property
    def offset_error(self) -> float:
        """
        Its standard error.
        """
    @property
    def quantity(self) -> str:
        """
        "airspeed", "alpha", "mx"; "field": the calibrated field's strength.
        """
    @property
    def reference(self) -> str:
        """
        Column of the reference in the log.
        """
    @property
    def rms(self) -> float:
        """
        RMS of the difference.
        """
    @property
    def rows(self) -> int:
        """
        Rows that have both.
        """
    @property
    def scale(self) -> float:
        """
        The scale in calibrated = offset + scale * reference.
        """
    @property
    def scale_error(self) -> float:
        """
        Its standard error.
        """
    @property
    def scale_reversed(self) -> float:
        """
        One over the scale of the reference on the calibrated; noise of either makes them differ.
        """
    @property
    def sd(self) -> float:
        """
        Standard deviation of the difference.
        """
    @property
    def time(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (N,) [s] of the rows in which both are there; row numbers where there is no time.
        """
    @property
    def unit(self) -> str:
        """
        Unit of every number except the scales.
        """

class Comparison:
    """
    A calibration against a flight.
    """

    _fields: typing.ClassVar[tuple] = (
        "model",
        "file",
        "status",
        "message",
        "overall",
        "where",
        "channels",
        "windows",
        "time",
        "residuals",
        "modelled",
        "method",
        "sigma",
        "disturbances",
        "validation",
        "references",
        "notes",
        "json",
        "text",
        "explained",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Comparison) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def channels(self) -> list[ChannelMisfit]:
        """
        By share_smooth, largest first.
        """
    @property
    def disturbances(self) -> list[Disturbance]:
        """
        By filter error, one a process noise.
        """
    @property
    def explained(self) -> str:
        """
        The same with the whole message, as by the apps' --explain.
        """
    @property
    def file(self) -> str:
        """
        File of the flight.
        """
    @property
    def json(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def method(self) -> str:
        """
        "output-error" or "filter-error".
        """
    @property
    def model(self) -> str: ...
    @property
    def modelled(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_z), z less them.
        """
    @property
    def notes(self) -> list[str]:
        """
        One line each, for people.
        """
    @property
    def overall(self) -> list[Misfit]:
        """
        One an output.
        """
    @property
    def references(self) -> list[ReferenceMisfit]:
        """
        One a column that was given as `reference`.
        """
    @property
    def residuals(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_z), z - model; of a fit by filter error innovations.
        """
    @property
    def sigma(self) -> dict[str, float]:
        """
        By filter error and output: rms of innovations in the filter's standard deviations.
        """
    @property
    def status(self) -> str:
        """
        Status of the calibration, repeated.
        """
    @property
    def text(self) -> str:
        """
        The app's page, as print() shows it.
        """
    @property
    def time(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (N,) [s], of every row used.
        """
    @property
    def validation(self) -> list[OutputValidation]:
        """
        One an output.
        """
    @property
    def where(self) -> list[Misfit]:
        """
        Maneuver by maneuver, outputs within, in the flight's order.
        """
    @property
    def windows(self) -> list[Window]:
        """
        The five worst in units of the fit's noise, worst first.
        """

class EffectFinding:
    """
    What a flight says about one candidate; NaN where a number is undefined.
    """

    _fields: typing.ClassVar[tuple] = (
        "name",
        "drivers",
        "shapes",
        "p_value",
        "log10_p",
        "p_adjusted",
        "p_listed",
        "share_after_selection",
        "outputs",
        "partial_f",
        "sse",
        "sse_reduction",
        "pse",
        "pse_without",
        "r_squared",
        "r_squared_without",
        "predicted_drop",
        "held_out_gain",
        "held_out_before",
        "held_out_after",
        "held_out_passed",
        "held_out_interleaved",
        "held_out_refitted",
        "is_fitted",
        "excuse",
        "visibility",
        "absorbed_by",
        "status",
        "beside",
        "sentence",
        "estimate",
        "standard_error",
        "unit",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def absorbed_by(self) -> dict[str, float]:
        """
        Shift of each parameter if the effect is ignored.
        """
    @property
    def beside(self) -> str:
        """
        Next to the first found: "equivalent", "fades", "counts"; "untried" for the others.
        """
    @property
    def beside_in_words(self) -> str:
        """
        What becomes of it beside the first found, as tables show it.
        """
    @property
    def drivers(self) -> list[str]:
        """
        Channels that drive it.
        """
    @property
    def estimate(self) -> dict[str, float]:
        """
        By coefficient, of one step from the fit, or of a fit.
        """
    @property
    def excuse(self) -> float:
        """
        How many times the sensors' usual drift it would take to look like this effect.
        """
    @property
    def held_out_after(self) -> float:
        """
        RMSE of the rows held out, with it.
        """
    @property
    def held_out_before(self) -> float:
        """
        RMSE of the rows held out, without it.
        """
    @property
    def held_out_gain(self) -> float:
        """
        The same drop on rows held out.
        """
    @property
    def held_out_interleaved(self) -> bool:
        """
        True if interleaved blocks were held out, not whole segments.
        """
    @property
    def held_out_passed(self) -> bool:
        """
        True if the mean gain of a block exceeds its standard error.
        """
    @property
    def held_out_refitted(self) -> bool:
        """
        True if the gain comes from fits with it and without it, not from one step.
        """
    @property
    def in_words(self) -> str:
        """
        The status as tables show it; "not held out" and "too small" are sure, yet refused.
        """
    @property
    def is_fitted(self) -> bool:
        """
        True if the estimates come from a fit with it.
        """
    @property
    def log10_p(self) -> float:
        """
        log10 of p_value, which may be too small for a float.
        """
    @property
    def name(self) -> str:
        """
        Name to give to add().
        """
    @property
    def outputs(self) -> list[str]:
        """
        Outputs that it can reach; all if they share parameters.
        """
    @property
    def p_adjusted(self) -> float:
        """
        p after Holm's correction; decides the verdict.
        """
    @property
    def p_listed(self) -> float:
        """
        p after Benjamini and Hochberg's correction; orders the list.
        """
    @property
    def p_value(self) -> float:
        """
        p of this effect alone, corrected for its scan.
        """
    @property
    def partial_f(self) -> float:
        """
        Partial F of stepwise regression, which takes residuals for white; sums of squares over `outputs`, each in units of its RMSE in the fit.
        """
    @property
    def predicted_drop(self) -> float:
        """
        Predicted drop of the RMSE over these outputs, 1 - after / before.
        """
    @property
    def pse(self) -> float:
        """
        Predicted square error, SSE/N + 2 s2max p/N.
        """
    @property
    def pse_without(self) -> float:
        """
        Predicted square error without it.
        """
    @property
    def r_squared(self) -> float:
        """
        Coefficient of determination with it.
        """
    @property
    def r_squared_without(self) -> float:
        """
        Coefficient of determination without it.
        """
    @property
    def sentence(self) -> str:
        """
        In plain words.
        """
    @property
    def shapes(self) -> dict[str, float]:
        """
        Shapes found by a scan: {"bias_step.t0": 41.2}.
        """
    @property
    def share_after_selection(self) -> float:
        """
        Share of the estimates left after allowing for the choice of this effect.
        """
    @property
    def sse(self) -> float:
        """
        Sum of squared errors without it.
        """
    @property
    def sse_reduction(self) -> float:
        """
        Reduction of sse by its orthogonal function.
        """
    @property
    def standard_error(self) -> dict[str, float]:
        """
        In the noise model with the effect, or the fit's.
        """
    @property
    def status(self) -> str:
        """
        "found", "slow_change", "undecided", "not_seen", "cannot_be_seen".
        """
    @property
    def unit(self) -> dict[str, str]:
        """
        By coefficient.
        """
    @property
    def visibility(self) -> float:
        """
        Sine of the angle to the model's own columns; below 0.05 the flight can't show at least a part of it.
        """

class Advice:
    """
    Effects to add, once a fit with them has shown that they can be.
    """

    _fields: typing.ClassVar[tuple] = ("effect", "withheld", "then")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def effect(self) -> str | None:
        """
        None where nothing was found or all was withheld.
        """
    @property
    def then(self) -> str | None:
        """
        Its partner, to be added after it, where two were found that neither does alone.
        """
    @property
    def withheld(self) -> list[str]:
        """
        Why not what was found before it: a sentence each.
        """

class ResidualNoise:
    """
    An output's residual; NaN where a number is undefined.
    """

    _fields: typing.ClassVar[tuple] = (
        "output",
        "unit",
        "rmse",
        "lag_one",
        "ljung_box_p",
        "noise",
        "floor",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def floor(self) -> float:
        """
        RMSE that noise alone would leave: no model of the past predicts better.
        """
    @property
    def lag_one(self) -> float:
        """
        Correlation of neighbouring rows.
        """
    @property
    def ljung_box_p(self) -> float:
        """
        p of the Ljung-Box test over 20 lags; small if the residual is not white.
        """
    @property
    def noise(self) -> NoiseModel:
        """
        NoiseModel of the residual.
        """
    @property
    def output(self) -> str: ...
    @property
    def rmse(self) -> float: ...
    @property
    def unit(self) -> str: ...

class Unexplained:
    """
    Offsets of every output and every port by window of the flight, at once.
    """

    _fields: typing.ClassVar[tuple] = ("p_value", "p_adjusted", "significant", "where", "windows")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def p_adjusted(self) -> float:
        """
        After Holm, with the unmeasured causes.
        """
    @property
    def p_value(self) -> float: ...
    @property
    def significant(self) -> bool: ...
    @property
    def where(self) -> str:
        """
        The port or output whose offsets explain most.
        """
    @property
    def windows(self) -> list[tuple[str, float]]:
        """
        [(window, how far off it is [sigma]), ...].
        """

class UnmeasuredCause:
    """
    A cause that no logged channel follows. Rows and cycles a row where there is no time.
    """

    _fields: typing.ClassVar[tuple] = (
        "kind",
        "sentence",
        "outputs",
        "p_value",
        "p_adjusted",
        "all_along",
        "first_s",
        "last_s",
        "frequency_hz",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def all_along(self) -> bool:
        """
        True if it is strongest over the whole flight.
        """
    @property
    def first_s(self) -> float:
        """
        Time of the first row where it is strongest [s].
        """
    @property
    def frequency_hz(self) -> float:
        """
        NaN if no frequency stands out.
        """
    @property
    def kind(self) -> str:
        """
        "common_cause" or "spectral_line".
        """
    @property
    def last_s(self) -> float:
        """
        Time of the last such row [s].
        """
    @property
    def outputs(self) -> list[str]:
        """
        Outputs that show it.
        """
    @property
    def p_adjusted(self) -> float:
        """
        p after Holm's correction; decides the verdict.
        """
    @property
    def p_value(self) -> float:
        """
        p of this cause alone.
        """
    @property
    def sentence(self) -> str:
        """
        In plain words.
        """

class DetectionLimit:
    """
    The smallest slow effect that the flight would have shown: a straight line in time that is found nine times in ten.
    """

    _fields: typing.ClassVar[tuple] = ("port", "size", "unit")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def port(self) -> str: ...
    @property
    def size(self) -> float:
        """
        Smallest change over the flight that would have shown.
        """
    @property
    def unit(self) -> str: ...

class ErrorBound:
    """
    How far an error was let wander.
    """

    _fields: typing.ClassVar[tuple] = ("name", "size", "unit")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def name(self) -> str:
        """
        Name in `error_budget` of diagnose().
        """
    @property
    def size(self) -> float:
        """
        Largest standard deviation of each component.
        """
    @property
    def unit(self) -> str: ...

class DiagnosisWork:
    """
    The work of a diagnosis.
    """

    _fields: typing.ClassVar[tuple] = (
        "screened",
        "tested",
        "calibrated",
        "drawn",
        "refitted",
        "tried_on_some_rows",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def calibrated(self) -> int:
        """
        Candidates whose p was calibrated by draws of the noise.
        """
    @property
    def drawn(self) -> int:
        """
        Draws of each noise.
        """
    @property
    def refitted(self) -> int:
        """
        Fits of a model with a candidate.
        """
    @property
    def screened(self) -> int:
        """
        Candidates that were screened.
        """
    @property
    def tested(self) -> int:
        """
        Candidates tested by likelihood ratios, each with noise estimated again.
        """
    @property
    def tried_on_some_rows(self) -> int:
        """
        Of these, fits to 400 rows first, where the full fit is far off.
        """

class Injection:
    """
    An effect that was put into the measurements, to see whether it would have been found.
    """

    _fields: typing.ClassVar[tuple] = ("effect", "sizes", "found", "rank", "p_adjusted", "estimate")
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def effect(self) -> str: ...
    @property
    def estimate(self) -> dict[str, float]:
        """
        By coefficient.
        """
    @property
    def found(self) -> bool:
        """
        Itself, or it would do as well as what was.
        """
    @property
    def p_adjusted(self) -> float: ...
    @property
    def rank(self) -> int | None:
        """
        From 1, the first where it would do as well; None: the flight can't show it.
        """
    @property
    def sizes(self) -> list[float]:
        """
        Sizes of its coefficients.
        """

class StepwiseStep:
    """
    An effect that was added: what it promised and what came of it; NaN where undefined.

    The RMSE is over `outputs`, of the rows that are fitted, in their unit; where these have different ones in units of each one's own before. partial_f, pse and pse_without are those of EffectFinding.
    """

    _fields: typing.ClassVar[tuple] = (
        "effect",
        "outputs",
        "p_adjusted",
        "partial_f",
        "pse",
        "pse_without",
        "r_squared",
        "held_out_gain",
        "predicted_drop",
        "found_drop",
        "rmse_before",
        "rmse_after",
        "as_good",
        "dropped",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def as_good(self) -> list[str]:
        """
        Effects that would have done as well in its place.
        """
    @property
    def dropped(self) -> list[str]:
        """
        Effects added before that no longer count beside it.
        """
    @property
    def effect(self) -> str: ...
    @property
    def found_drop(self) -> float: ...
    @property
    def held_out_gain(self) -> float:
        """
        Gain that was promised on rows held out.
        """
    @property
    def outputs(self) -> list[str]:
        """
        Outputs that it can reach.
        """
    @property
    def p_adjusted(self) -> float: ...
    @property
    def partial_f(self) -> float: ...
    @property
    def predicted_drop(self) -> float:
        """
        Drop of the RMSE that was promised, 1 - after / before.
        """
    @property
    def pse(self) -> float: ...
    @property
    def pse_without(self) -> float: ...
    @property
    def r_squared(self) -> float: ...
    @property
    def rmse_after(self) -> float: ...
    @property
    def rmse_before(self) -> float: ...

class Diagnosis:
    """
    A verdict and the ranked candidates; NaN where a number is undefined.
    """

    _fields: typing.ClassVar[tuple] = (
        "model",
        "verdict",
        "sentence",
        "advice",
        "pairs",
        "rmse",
        "noise_floor",
        "correlation_time",
        "error_budget",
        "work",
        "left_undone",
        "pse",
        "rule",
        "effects",
        "residual",
        "where",
        "unexplained",
        "unmeasured",
        "limits",
        "missing_channels",
        "injected",
        "status",
        "message",
        "notes",
        "json",
        "text",
        "explained",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Diagnosis) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def advice(self) -> Advice: ...
    @property
    def correlation_time(self) -> float:
        """
        Over which the residual goes together [s].
        """
    @property
    def effects(self) -> list[EffectFinding]:
        """
        Best first.
        """
    @property
    def error_budget(self) -> dict[str, ErrorBound]:
        """
        By name: how far errors were let wander.
        """
    @property
    def explained(self) -> str:
        """
        The same with the whole message, as by the apps' --explain.
        """
    @property
    def injected(self) -> Injection | None:
        """
        None where nothing was put in.
        """
    @property
    def json(self) -> str: ...
    @property
    def left_undone(self) -> list[str]:
        """
        Steps for which there was no time.
        """
    @property
    def limits(self) -> dict[str, DetectionLimit]:
        """
        By port: the smallest slow effect that would have shown.
        """
    @property
    def message(self) -> str: ...
    @property
    def missing_channels(self) -> list[str]:
        """
        Not logged, and could explain what is left.
        """
    @property
    def model(self) -> str: ...
    @property
    def noise_floor(self) -> float:
        """
        Innovations alone.
        """
    @property
    def notes(self) -> list[str]:
        """
        One line each, for people.
        """
    @property
    def pairs(self) -> list[str]:
        """
        Two causes at once that explain it as well as anything, best first.
        """
    @property
    def pse(self) -> str:
        """
        What bounds the noise of the effects' pse: "sidpac" var(z)/2, "classic" var(z).
        """
    @property
    def residual(self) -> dict[str, ResidualNoise]:
        """
        By output.
        """
    @property
    def rmse(self) -> float:
        """
        Over all outputs, in their unit.
        """
    @property
    def rule(self) -> str:
        """
        What decided: "verdict", or "partial-f", stepwise regression's.
        """
    @property
    def sentence(self) -> str:
        """
        The verdict in one sentence.
        """
    @property
    def status(self) -> str:
        """
        Of the calibration, repeated.
        """
    @property
    def text(self) -> str:
        """
        What print() shows: the app's page.
        """
    @property
    def unexplained(self) -> Unexplained:
        """
        Offsets that no candidate explains.
        """
    @property
    def unmeasured(self) -> list[UnmeasuredCause]:
        """
        Causes that follow no channel, the surest first.
        """
    @property
    def verdict(self) -> str:
        """
        "adequate", "effect_missing", "slow_change", "unexplained".
        """
    @property
    def where(self) -> list[Misfit]:
        """
        By segment and output, as compare() has it.
        """
    @property
    def work(self) -> DiagnosisWork:
        """
        What was done.
        """

class SmoothedRecord:
    """
    States and process noise, given all samples; NaN outside segments.
    """

    _fields: typing.ClassVar[tuple] = (
        "states",
        "noises",
        "outputs",
        "x",
        "covariance",
        "w",
        "w_covariance",
        "innovations",
        "innovation_sd",
        "cost",
        "readings",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: SmoothedRecord) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def cost(self) -> float:
        """
        Sum of (e' Lambda^-1 e + ln det Lambda) / 2.
        """
    @property
    def covariance(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (N, n_x, n_x), P(k|N).
        """
    @property
    def innovation_sd(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_z), expected of them.
        """
    @property
    def innovations(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_z), measured less predicted from the rows before; NaN where missing.
        """
    @property
    def noises(self) -> tuple[str, ...]:
        """
        n_w.
        """
    @property
    def outputs(self) -> tuple[str, ...]:
        """
        n_z.
        """
    @property
    def readings(self) -> int:
        """
        Outputs that were there.
        """
    @property
    def states(self) -> tuple[str, ...]:
        """
        That are integrated, n_x.
        """
    @property
    def w(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_w), w(k|N): its mean from row k to the next.
        """
    @property
    def w_covariance(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (N, n_w, n_w), Q(k|N).
        """
    @property
    def x(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (N, n_x), x(k|N).
        """

class ParameterChange:
    """
    A parameter that jumped on the way.
    """

    _fields: typing.ClassVar[tuple] = ("name", "before", "after", "standard_deviation", "rivals")
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def after(self) -> float:
        """
        Behind it, as estimated when it was found.
        """
    @property
    def before(self) -> float:
        """
        Its estimate before the jump.
        """
    @property
    def name(self) -> str:
        """
        Name of the parameter.
        """
    @property
    def rivals(self) -> tuple[str, ...]:
        """
        Parameters whose jump in its place would explain the innovations nearly as well.
        """
    @property
    def standard_deviation(self) -> float:
        """
        Standard deviation of after - before.
        """

class Change:
    """
    Parameters that jumped at one time.
    """

    _fields: typing.ClassVar[tuple] = (
        "onset",
        "found",
        "onset_time",
        "found_time",
        "statistic",
        "parameters",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def found(self) -> int:
        """
        The row at which it was said.
        """
    @property
    def found_time(self) -> float:
        """
        [s].
        """
    @property
    def onset(self) -> int:
        """
        The row after which they jumped, to half a second or so.
        """
    @property
    def onset_time(self) -> float:
        """
        [s]; NaN where the data have none.
        """
    @property
    def parameters(self) -> tuple[ParameterChange, ...]:
        """
        The ParameterChange of each that jumped.
        """
    @property
    def statistic(self) -> float:
        """
        The chi squared that it explains, of one degree a parameter where nothing jumped.
        """

class Track:
    """
    Estimates against time, one a row.
    """

    _fields: typing.ClassVar[tuple] = (
        "names",
        "outputs",
        "rows",
        "time",
        "estimates",
        "standard_deviations",
        "innovations",
        "changes",
        "refused",
        "not_converged",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Track) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def changes(self) -> tuple[Change, ...]:
        """
        The Change of every jump that was found, in their order.
        """
    @property
    def estimates(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (M, n).
        """
    @property
    def innovations(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (M, n_z), reading less what was expected of it; NaN where missing.
        """
    @property
    def names(self) -> tuple[str, ...]:
        """
        Of the n states that are integrated, then of the parameters, linear ones first.
        """
    @property
    def not_converged(self) -> int:
        """
        Rows at which the cap of iekf's iterations ended them.
        """
    @property
    def outputs(self) -> tuple[str, ...]:
        """
        n_z.
        """
    @property
    def refused(self) -> int:
        """
        Rows that were not finite, left out.
        """
    @property
    def rows(self) -> typing.Annotated[numpy.typing.NDArray[numpy.uint64], "[m, 1]"]:
        """
        (M,) of the data, one an estimate.
        """
    @property
    def standard_deviations(
        self,
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (M, n); 0 for what is held.
        """
    @property
    def time(self) -> numpy.typing.NDArray[numpy.float64]:
        """
        (M,) [s]; empty where the data have none.
        """

class IterationOptions:
    def __init__(
        self,
        iterations: typing.SupportsInt | typing.SupportsIndex,
        tolerance: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...

class FlightTrackOptions:
    def __init__(
        self,
        *,
        method: str,
        noise: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        process_noise: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        walk: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        changes: str,
        initial_states: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        iterations: IterationOptions,
        forgetting: typing.SupportsFloat | typing.SupportsIndex,
        memory: typing.SupportsFloat | typing.SupportsIndex,
        every: typing.SupportsInt | typing.SupportsIndex,
        band: typing.Annotated[
            collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
        ],
        differentiate: bool,
        start_rows: typing.SupportsInt | typing.SupportsIndex,
        own: collections.abc.Sequence[str],
        second: str,
    ) -> None: ...

class Innovation:
    """
    A measurement less its prediction, and its covariance.
    """

    _fields: typing.ClassVar[tuple] = ("count", "e", "w", "root")
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Innovation) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def cost(self) -> float:
        """
        (e' Lambda^-1 e + ln det Lambda) / 2.
        """
    @property
    def count(self) -> int:
        """
        Outputs that were there.
        """
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n_z, n_z); the identity in rows of missing outputs.
        """
    @property
    def e(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n_z,), y - expected; 0 where missing.
        """
    @property
    def root(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        (n_z, n_z), upper triangular root of its covariance.
        """
    @property
    def w(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        (n_z,), e in standard deviations, uncorrelated.
        """

class Flight:
    def __getstate__(
        self,
    ) -> tuple[
        str,
        str,
        list[tuple[str, numpy.typing.NDArray[numpy.float64], tuple[int, str] | None, str]],
        list[str],
        list[str],
    ]: ...
    def __init__(self, name: str, sha256: str = "") -> None: ...
    def __setstate__(
        self,
        arg0: tuple[
            str,
            str,
            collections.abc.Sequence[
                tuple[
                    str,
                    typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
                    tuple[typing.SupportsInt | typing.SupportsIndex, str] | None,
                    str,
                ]
            ],
            collections.abc.Sequence[str],
            collections.abc.Sequence[str],
        ],
    ) -> None: ...
    def column(self, arg0: str) -> numpy.typing.NDArray[numpy.float64] | None: ...
    def label(self, arg0: collections.abc.Sequence[str]) -> None: ...
    def list_columns(self) -> str: ...
    def note(self, arg0: str) -> None: ...
    def view(self, header: str, values: numpy.typing.NDArray[numpy.float64]) -> None: ...
    @property
    def headers(self) -> list[str]: ...
    @property
    def maneuvers(self) -> list[str]: ...
    @property
    def name(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def rows(self) -> int: ...
    @property
    def sha256(self) -> str: ...

class Derived:
    """
    A quantity that follows from the estimates, in `unit`; errors by the delta method.
    """

    _fields: typing.ClassVar[tuple] = (
        "name",
        "value",
        "standard_error",
        "standard_error_white",
        "standard_error_noise_model",
        "standard_error_blocks",
        "unit",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def name(self) -> str: ...
    @property
    def standard_error(self) -> float:
        """
        NaN if a parameter that it depends on has none.
        """
    @property
    def standard_error_blocks(self) -> float:
        """
        Standard error from leaving out blocks of the record; NaN with too few blocks.
        """
    @property
    def standard_error_noise_model(self) -> float:
        """
        Standard error from a noise model of each output's residual.
        """
    @property
    def standard_error_white(self) -> float:
        """
        Standard error if the residuals were white.
        """
    @property
    def unit(self) -> str: ...
    @property
    def value(self) -> float: ...

class HistoryEntry:
    """
    One step of a chain of added effects; NaN where a number is undefined. Errors are RMSE over all outputs together, on the rows of the new fit.
    """

    _fields: typing.ClassVar[tuple] = (
        "effect",
        "rmse_before",
        "rmse_after",
        "held_out_before",
        "held_out_after",
        "predicted_drop",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def effect(self) -> str:
        """
        Several that were added together: "E1+E2".
        """
    @property
    def held_out_after(self) -> float: ...
    @property
    def held_out_before(self) -> float: ...
    @property
    def predicted_drop(self) -> float:
        """
        Predicted drop of the RMSE, 1 - after / before.
        """
    @property
    def rmse_after(self) -> float: ...
    @property
    def rmse_before(self) -> float: ...

class Applied:
    """
    The result of apply_to_file().
    """

    _fields: typing.ClassVar[tuple] = ("rows", "rows_left_empty", "headers", "notes")
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def headers(self) -> list[str]:
        """
        The columns added.
        """
    @property
    def notes(self) -> list[str]:
        """
        One line each, for people.
        """
    @property
    def rows(self) -> int: ...
    @property
    def rows_left_empty(self) -> int:
        """
        Nothing to calibrate: total below static pressure, or dropped.
        """

class FlightDeparture:
    """
    Whether a flight agrees with the others of a joint fit; NaN where nothing can be tested.
    """
    @property
    def difference(self) -> float:
        """
        The flight's own estimate less that of the others.
        """
    @property
    def flight(self) -> str:
        """
        Its label.
        """
    @property
    def p(self) -> float:
        """
        Probability of a larger difference by chance, by Holm for the number of flights.
        """
    @property
    def parameter(self) -> str:
        """
        Shared, the most different in standard errors; may be empty.
        """
    @property
    def standard_error(self) -> float: ...

class DiagnosisOptions:
    def __init__(
        self,
        *,
        simulations: typing.SupportsInt | typing.SupportsIndex,
        seed: typing.SupportsInt | typing.SupportsIndex,
        pse: str,
        rule: str,
        only: collections.abc.Sequence[str],
        error_budget: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        within: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...

class Calibration:
    def add(
        self,
        arg0: Flight,
        arg1: str,
        arg2: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
    ) -> Calibration: ...
    def apply(self, arg0: Flight) -> dict[str, numpy.typing.NDArray[numpy.float64]]: ...
    def apply_to_file(self, arg0: str, arg1: str) -> Applied: ...
    def certify(
        self,
        arg0: Flight,
        arg1: typing.SupportsFloat | typing.SupportsIndex,
        arg2: typing.SupportsInt | typing.SupportsIndex,
    ) -> Certificate: ...
    def command(self, arg0: str) -> str:
        """
        A verb of it, as a shell takes it.
        """
    def compare(
        self,
        flight: Flight,
        effect: str | None = None,
        references: collections.abc.Sequence[str] = [],
    ) -> Comparison: ...
    def diagnose(
        self,
        arg0: Flight,
        arg1: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
        arg2: tuple[str, collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]]
        | None,
        arg3: DiagnosisOptions,
    ) -> Diagnosis: ...
    def diagnose_stepwise(
        self,
        arg0: Flight,
        arg1: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
        arg2: typing.SupportsInt | typing.SupportsIndex | None,
        arg3: DiagnosisOptions,
    ) -> SteppedCalibration: ...
    def intervals(
        self,
        arg0: Flight,
        arg1: typing.SupportsFloat | typing.SupportsIndex,
        arg2: collections.abc.Sequence[str],
    ) -> Intervals: ...
    def on_flight(self, arg0: Flight, arg1: bool) -> Calibration: ...
    def predict(
        self, arg0: Flight, arg1: typing.SupportsFloat | typing.SupportsIndex
    ) -> Prediction: ...
    def rejoin(self, arg0: collections.abc.Sequence[Flight]) -> Flight: ...
    def residuals(
        self, flight: Flight
    ) -> tuple[list[tuple[str, numpy.typing.NDArray[numpy.float64]]], list[str]]: ...
    def save(self, arg0: str) -> None: ...
    def to_json(self) -> str: ...
    def track(self, arg0: Flight, arg1: FlightTrackOptions) -> tuple[Track, list[str]]: ...
    @property
    def departures(self) -> list[FlightDeparture]: ...
    @property
    def derived(self) -> dict[str, Derived]: ...
    @property
    def file(self) -> str: ...
    @property
    def fit(self) -> Fit: ...
    @property
    def flights(self) -> list[str]: ...
    @property
    def history(self) -> list[HistoryEntry]: ...
    @property
    def model(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def restated(self) -> dict: ...
    @property
    def unit(self) -> str: ...

class SteppedCalibration:
    @property
    def end(self) -> str: ...
    @property
    def explained(self) -> str: ...
    @property
    def fitted(self) -> Calibration: ...
    @property
    def json(self) -> str: ...
    @property
    def last(self) -> Diagnosis: ...
    @property
    def reason(self) -> str: ...
    @property
    def steps(self) -> list[StepwiseStep]: ...
    @property
    def text(self) -> str: ...

class ColumnCheck:
    """
    One column of a log, in the header's unit; NaN where there is none.
    """

    _fields: typing.ClassVar[tuple] = (
        "header",
        "quantity",
        "missing",
        "least",
        "median",
        "largest",
        "step",
        "repeated",
        "rate",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def header(self) -> str: ...
    @property
    def largest(self) -> float: ...
    @property
    def least(self) -> float: ...
    @property
    def median(self) -> float: ...
    @property
    def missing(self) -> int:
        """
        Cells that are no finite number.
        """
    @property
    def quantity(self) -> str:
        """
        That the probe reads it as, "airspeed"; empty: a channel.
        """
    @property
    def rate(self) -> float:
        """
        New values a second [Hz].
        """
    @property
    def repeated(self) -> float:
        """
        Share of rows that repeat the one before.
        """
    @property
    def step(self) -> float:
        """
        That its values stand apart by, where they lie on steps.
        """

class LogNote:
    """
    Something about a log.
    """

    _fields: typing.ClassVar[tuple] = (
        "kind",
        "concern",
        "columns",
        "rows",
        "first_s",
        "last_s",
        "found",
        "effect",
        "advice",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def advice(self) -> str:
        """
        How to mend it.
        """
    @property
    def columns(self) -> list[str]: ...
    @property
    def concern(self) -> str:
        """
        "wrong": a result is, or there is none; "matters": estimates or their errors suffer; "slight": good to know.
        """
    @property
    def effect(self) -> str:
        """
        How it changes the result.
        """
    @property
    def first_s(self) -> float:
        """
        Time of the first of these rows; NaN if all rows are concerned.
        """
    @property
    def found(self) -> str:
        """
        What was found.
        """
    @property
    def kind(self) -> str:
        """
        "held", "units", ...
        """
    @property
    def last_s(self) -> float:
        """
        Time of the last.
        """
    @property
    def rows(self) -> int:
        """
        Number of rows concerned.
        """

class FlightCheck:
    """
    A log's description, and what each problem does to a calibration.
    """

    _fields: typing.ClassVar[tuple] = (
        "model",
        "file",
        "refused",
        "duration",
        "rate",
        "columns",
        "notes",
        "json",
        "text",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: FlightCheck) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def columns(self) -> list[ColumnCheck]: ...
    @property
    def duration(self) -> float:
        """
        [s]
        """
    @property
    def file(self) -> str:
        """
        File of the flight.
        """
    @property
    def json(self) -> str: ...
    @property
    def model(self) -> str: ...
    @property
    def notes(self) -> list[LogNote]:
        """
        Worst first.
        """
    @property
    def rate(self) -> float:
        """
        Rows a second [Hz].
        """
    @property
    def refused(self) -> str:
        """
        A fit's refusal of it; empty: it would not refuse.
        """
    @property
    def text(self) -> str:
        """
        The app's page, as print() shows it.
        """

class Approximation:
    """
    What a vehicle's correction lacks of a calibration's, over the fitted rows of a flight; NaN where it isn't known.
    """

    _fields: typing.ClassVar[tuple] = (
        "dropped",
        "flight",
        "rows",
        "rotation_deg",
        "heading_rms_deg",
        "heading_largest_deg",
        "strength_rms_ut",
        "airspeed_rms_mps",
        "airspeed_largest_mps",
        "residual_before",
        "residual_after",
        "residual_unit",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def airspeed_largest_mps(self) -> float:
        """
        By size.
        """
    @property
    def airspeed_rms_mps(self) -> float:
        """
        The true airspeed, likewise.
        """
    @property
    def dropped(self) -> list[str]:
        """
        In words.
        """
    @property
    def flight(self) -> str: ...
    @property
    def heading_largest_deg(self) -> float:
        """
        By size.
        """
    @property
    def heading_rms_deg(self) -> float:
        """
        The vehicle's magnetic heading less the calibration's.
        """
    @property
    def residual_after(self) -> float:
        """
        Residual of what the vehicle holds.
        """
    @property
    def residual_before(self) -> float:
        """
        RMS of measured less modelled, of the calibration.
        """
    @property
    def residual_unit(self) -> str: ...
    @property
    def rotation_deg(self) -> float:
        """
        Between sensor and body, which has no home on the vehicle.
        """
    @property
    def rows(self) -> int:
        """
        That both correct.
        """
    @property
    def strength_rms_ut(self) -> float:
        """
        The field's strength, likewise.
        """

class Exported:
    """
    The result of export().
    """

    _fields: typing.ClassVar[tuple] = (
        "output",
        "text",
        "parameters",
        "approximation",
        "rotation",
        "other_approximation",
        "left_to_others",
        "notes",
        "json",
        "page",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: Exported) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def approximation(self) -> Approximation | None:
        """
        None where nothing was changed.
        """
    @property
    def json(self) -> str:
        """
        As the app's export prints it.
        """
    @property
    def left_to_others(self) -> list[str]:
        """
        Effects that act on the reference or the wind: no part of a correction.
        """
    @property
    def notes(self) -> list[str]:
        """
        Notes on what a person must know or do, one line each.
        """
    @property
    def other_approximation(self) -> Approximation | None:
        """
        The loss of the other one; None where it is not known.
        """
    @property
    def output(self) -> str:
        """
        The file.
        """
    @property
    def page(self) -> str:
        """
        The app's page, as print() shows it.
        """
    @property
    def parameters(self) -> dict[str, float]:
        """
        Parameters of an autopilot, by name.
        """
    @property
    def rotation(self) -> str | None:
        """
        For a magnetometer that the calibration turns: keep or refit, else None.
        """
    @property
    def text(self) -> str:
        """
        All that is in it.
        """

class FlightFigures:
    def channel(
        self, arg0: str
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"] | None: ...
    @property
    def airspeed(self) -> numpy.typing.NDArray[numpy.float64] | None: ...
    @property
    def heading(self) -> numpy.typing.NDArray[numpy.float64] | None: ...
    @property
    def heading_is_track(self) -> bool: ...
    @property
    def interval(self) -> typing.Annotated[list[float], "FixedSize(3)"]: ...
    @property
    def measured(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def modelled(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def rows(self) -> numpy.typing.NDArray[numpy.uint64]: ...
    @property
    def runs(self) -> list[tuple[str, int, int]]: ...
    @property
    def segments(self) -> list[tuple[str, int, int]]: ...
    @property
    def within_95(self) -> list[float]: ...

class CostLandscape:
    @property
    def names(self) -> list[str]: ...
    @property
    def points(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def trace_r(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def units(self) -> list[str]: ...

class Departure:
    """
    Does a flight's own estimate of the shared parameters agree with that of all the others?

    Both to first order at the joint solution, along the combinations that both determine.
    """

    _fields: typing.ClassVar[tuple] = (
        "combinations",
        "statistic",
        "p",
        "p_holm",
        "p_white",
        "p_white_holm",
        "difference",
        "standard_error",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def combinations(self) -> int:
        """
        k of them; 0: nothing can be tested.
        """
    @property
    def difference(self) -> dict[str, float]:
        """
        Own estimate less the others', by shared parameter; of a noise of its logarithm.
        """
    @property
    def largest(self) -> str:
        """
        The shared parameter that differs by most of its standard errors; "" where none does.
        """
    @property
    def p(self) -> float:
        """
        Probability of a larger one where nothing departs: F(k, rows x outputs - n).
        """
    @property
    def p_holm(self) -> float:
        """
        The same, by Holm for the number of flights.
        """
    @property
    def p_white(self) -> float:
        """
        With white residuals of the common R, off the drop in cost.
        """
    @property
    def p_white_holm(self) -> float: ...
    @property
    def standard_error(self) -> dict[str, float]:
        """
        Standard error of the difference.
        """
    @property
    def statistic(self) -> float:
        """
        d' V^-1 d, d the difference, V as the flights' noise models have it.
        """

class FlightFit:
    """
    One flight of a joint fit.
    """

    _fields: typing.ClassVar[tuple] = (
        "name",
        "own",
        "rmse",
        "rows",
        "alone",
        "message",
        "departure",
    )
    def __eq__(self, arg0: typing.Any) -> bool: ...
    def __getitem__(self, arg0: str) -> Parameter: ...
    def __getstate__(self) -> tuple: ...
    def __hash__(self) -> int: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def alone(self) -> str:
        """
        Status of the flight's fit by itself, where the joint one began.
        """
    @property
    def departure(self) -> Departure: ...
    @property
    def message(self) -> str:
        """
        Message of that fit.
        """
    @property
    def name(self) -> str: ...
    @property
    def own(self) -> dict[str, Parameter]:
        """
        In the model's order.
        """
    @property
    def rmse(self) -> dict[str, float]:
        """
        By output, in its unit.
        """
    @property
    def rows(self) -> int: ...

class ManyFit:
    """
    A joint fit of many flights.
    """

    _fields: typing.ClassVar[tuple] = (
        "status",
        "message",
        "shared",
        "covariance",
        "correlation",
        "covariance_white",
        "flights",
        "left_out",
        "noise",
        "rmse",
        "cost",
        "method",
        "noise_sizes",
        "log_likelihood",
        "unobservable",
        "weak",
        "iterations",
        "noise_iterations",
        "passes",
        "rows",
    )
    def __getitem__(self, arg0: str) -> Parameter: ...
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: ManyFit) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def correlation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def cost(self) -> float:
        """
        J of Eq. 6 over all rows; by filter error V_m.
        """
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Covariance of the shared parameters, in that order; NaN without a standard error.
        """
    @property
    def covariance_white(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        As white residuals would have it.
        """
    @property
    def flights(self) -> dict[str, FlightFit]:
        """
        In the order given.
        """
    @property
    def iterations(self) -> int: ...
    @property
    def left_out(self) -> dict[str, str]:
        """
        Flights that can't be used, and why.
        """
    @property
    def log_likelihood(self) -> float:
        """
        By filter error.
        """
    @property
    def message(self) -> str:
        """
        One line; empty where there is nothing to say.
        """
    @property
    def method(self) -> str:
        """
        "output-error" or "filter-error".
        """
    @property
    def noise(self) -> dict[str, float]:
        """
        By output, common to all flights: given, or from R-hat = SSE / N.
        """
    @property
    def noise_iterations(self) -> int: ...
    @property
    def noise_sizes(self) -> dict[str, NoiseSize]:
        """
        By filter error: process noises, then outputs, common to all flights.
        """
    @property
    def passes(self) -> int:
        """
        Over the data, beside each flight's own fit.
        """
    @property
    def rmse(self) -> dict[str, float]:
        """
        Over all flights.
        """
    @property
    def rows(self) -> int:
        """
        Rows of all flights.
        """
    @property
    def shared(self) -> dict[str, Parameter]:
        """
        In the model's order, fixed ones among them.
        """
    @property
    def status(self) -> str:
        """
        "converged", "not_converged" or "not_identifiable".
        """
    @property
    def unobservable(self) -> list[Combination]:
        """
        Unobservable combinations of the shared parameters.
        """
    @property
    def weak(self) -> list[Combination]: ...

class PreparedFlight:
    def innovations(
        self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]
    ) -> tuple[
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        float,
    ]: ...
    def linearise(
        self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def score(
        self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"]
    ) -> tuple[
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"], float, int, int
    ]: ...
    def score_blocks(
        self,
        arg0: tuple[
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
            typing.SupportsInt | typing.SupportsIndex,
        ],
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def score_covariance(
        self,
        arg0: tuple[
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
            collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        ],
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def start(
        self,
    ) -> tuple[
        str | None,
        str,
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        int,
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    ]: ...

class FlightFactor:
    """
    A flight at a point, in units of its own residual, its own parameters projected out.
    """

    _fields: typing.ClassVar[tuple] = (
        "parameters",
        "units",
        "values",
        "columns",
        "triangle",
        "inflation",
        "whitened",
        "readings",
        "own",
        "centres",
        "rmse",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def centres(self) -> dict[str, float]:
        """
        By effect, of what its driver goes about.
        """
    @property
    def columns(self) -> list[tuple[str, str, str, bool]]:
        """
        (effect, coefficient, unit, whether it stands in for another cause) of each, c.
        """
    @property
    def inflation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Of variances, where the flight's noise has a memory (p).
        """
    @property
    def own(self) -> dict[str, float]:
        """
        Estimates of the flight's own parameters.
        """
    @property
    def parameters(self) -> list[str]:
        """
        p names.
        """
    @property
    def readings(self) -> float:
        """
        Behind it, less the flight's own parameters.
        """
    @property
    def rmse(self) -> float:
        """
        Over all outputs, at the point.
        """
    @property
    def triangle(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        [parameters | columns | residual], upper, (p + c + 1) square.
        """
    @property
    def units(self) -> list[str]: ...
    @property
    def values(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Where it was linearised (p).
        """
    @property
    def whitened(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        [parameters | residual], less what a noise with a memory foretells; or empty.
        """

class VehicleFit:
    """
    A vehicle's parameters from all its flights.
    """

    _fields: typing.ClassVar[tuple] = (
        "vehicle",
        "flights",
        "values",
        "inflation",
        "covariance",
        "jackknife",
        "misfit",
        "readings",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        As the noise models have it.
        """
    @property
    def flights(self) -> int:
        """
        How many.
        """
    @property
    def inflation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        Of variances, as its flights' noise models have it (p).
        """
    @property
    def jackknife(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        By leaving out a flight each; NaN for fewer than three.
        """
    @property
    def misfit(self) -> float:
        """
        -2 ln L at the estimates.
        """
    @property
    def readings(self) -> float: ...
    @property
    def values(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        NaN where its flights do not tell.
        """
    @property
    def vehicle(self) -> str: ...

class Population:
    """
    How parameters spread over vehicles.
    """

    _fields: typing.ClassVar[tuple] = (
        "parameters",
        "mean",
        "mean_covariance",
        "spread",
        "inflation",
        "log_likelihood",
        "vehicles",
        "shrunken",
        "shrunken_errors",
        "converged",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def converged(self) -> bool: ...
    @property
    def inflation(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]:
        """
        By what variances exceed those of the noise models (p).
        """
    @property
    def log_likelihood(self) -> float:
        """
        Restricted, up to a constant.
        """
    @property
    def mean(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def mean_covariance(
        self,
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def parameters(self) -> list[str]:
        """
        p names.
        """
    @property
    def shrunken(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Predictions (p x vehicles).
        """
    @property
    def shrunken_errors(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Their standard errors.
        """
    @property
    def spread(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Covariance between vehicles (p x p).
        """
    @property
    def vehicles(self) -> list[str]: ...

class VehicleSeries:
    """
    A vehicle's parameters from flight to flight.
    """

    _fields: typing.ClassVar[tuple] = (
        "vehicle",
        "flights",
        "values",
        "errors",
        "inflation",
        "change",
        "log10_p",
        "p_adjusted",
        "parameter",
        "before",
        "after",
        "standard_error",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def after(self) -> float: ...
    @property
    def before(self) -> float: ...
    @property
    def change(self) -> int:
        """
        So many flights are before the likeliest change.
        """
    @property
    def errors(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Their standard errors (p x n).
        """
    @property
    def flights(self) -> list[str]:
        """
        n names, in their order.
        """
    @property
    def inflation(self) -> float:
        """
        By what flights scatter, in errors of the noise models.
        """
    @property
    def log10_p(self) -> float:
        """
        Of no change, for the places tried.
        """
    @property
    def p_adjusted(self) -> float:
        """
        For the number of vehicles too.
        """
    @property
    def parameter(self) -> str:
        """
        That changes by most of its errors.
        """
    @property
    def standard_error(self) -> float:
        """
        Of the difference.
        """
    @property
    def values(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]:
        """
        Of each flight alone (p x n).
        """
    @property
    def vehicle(self) -> str: ...

class FleetFinding:
    """
    What a fleet says of a candidate.
    """

    _fields: typing.ClassVar[tuple] = (
        "cause",
        "effect",
        "vehicle",
        "coefficients",
        "spread",
        "log10_p",
        "p_adjusted",
        "drop",
        "share",
        "found",
        "as_good",
        "stands_in",
    )
    def __getstate__(self) -> tuple: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def as_good(self) -> list[str]:
        """
        Effects that explain as much in its place.
        """
    @property
    def cause(self) -> str:
        """
        "everywhere", "grows", "one-vehicle" or "differs".
        """
    @property
    def coefficients(self) -> dict[str, tuple[float, float, str]]:
        """
        {coefficient: (estimate, standard error, unit)}; of what differs the mean.
        """
    @property
    def drop(self) -> float:
        """
        Of the misfit (-2 ln L), as the noise models have it.
        """
    @property
    def effect(self) -> str: ...
    @property
    def found(self) -> bool: ...
    @property
    def log10_p(self) -> float:
        """
        For itself.
        """
    @property
    def p_adjusted(self) -> float:
        """
        For the number of tests.
        """
    @property
    def share(self) -> float:
        """
        Of the fleet's misfit, or of its one vehicle's.
        """
    @property
    def spread(self) -> list[float]:
        """
        Of what differs: standard deviations.
        """
    @property
    def stands_in(self) -> bool:
        """
        Its channel can't be the cause there.
        """
    @property
    def vehicle(self) -> str:
        """
        Of one; else empty.
        """

class FleetDiagnosis:
    """
    What a fleet lacks.
    """

    _fields: typing.ClassVar[tuple] = (
        "found",
        "others",
        "vehicles",
        "flights",
        "tests",
        "misfit_before",
        "misfit_after",
        "flights_before",
        "flights_after",
        "notes",
    )
    def __getstate__(self) -> tuple: ...
    def __init__(self, arg0: FleetDiagnosis) -> None: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, arg0: tuple) -> None: ...
    def _asdict(self) -> dict[str, typing.Any]:
        """
        {field: value}, as of a named tuple.
        """
    @property
    def flights(self) -> int: ...
    @property
    def flights_after(self) -> list[float]: ...
    @property
    def flights_before(self) -> list[float]:
        """
        Per reading, of each flight.
        """
    @property
    def found(self) -> list[FleetFinding]:
        """
        In the order in which they were added.
        """
    @property
    def misfit_after(self) -> float:
        """
        With all that was found.
        """
    @property
    def misfit_before(self) -> float:
        """
        Per reading, over all flights.
        """
    @property
    def notes(self) -> list[str]: ...
    @property
    def others(self) -> list[FleetFinding]:
        """
        Beside those, best first.
        """
    @property
    def tests(self) -> int: ...
    @property
    def vehicles(self) -> int: ...

def accelerometer() -> Model: ...
def angles_of_quaternion(
    quaternion: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(4)"
    ],
) -> typing.Annotated[list[float], "FixedSize(3)"]: ...
def attitude_independent_magnetometer(
    field_strength: typing.SupportsFloat | typing.SupportsIndex | None,
    noise: typing.SupportsFloat | typing.SupportsIndex = 0.0,
) -> Model: ...
def autocorrelation(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg1: collections.abc.Sequence[
        tuple[
            str,
            typing.SupportsInt | typing.SupportsIndex,
            typing.SupportsInt | typing.SupportsIndex,
        ]
    ],
) -> tuple[
    numpy.typing.NDArray[numpy.float64],
    numpy.typing.NDArray[numpy.float64],
    numpy.typing.NDArray[numpy.float64],
]: ...
def bin_means(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg2: typing.SupportsInt | typing.SupportsIndex,
) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]: ...
def bound_cost(
    arg0: Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    arg4: collections.abc.Mapping[
        str,
        tuple[
            typing.SupportsFloat | typing.SupportsIndex, typing.SupportsFloat | typing.SupportsIndex
        ],
    ],
    arg5: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
) -> CostBound: ...
def calibrate(
    arg0: Model,
    arg1: Flight,
    arg2: Options,
    arg3: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
) -> Calibration: ...
def calibrate_jointly(
    arg0: Model,
    arg1: collections.abc.Sequence[Flight],
    arg2: collections.abc.Sequence[str],
    arg3: Options,
    arg4: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
) -> tuple[Calibration, Flight]: ...
def calibrate_like(arg0: Calibration, arg1: Flight) -> Calibration: ...
def certify(
    arg0: Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: Options,
    arg4: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
    arg5: Fit,
    arg6: typing.SupportsFloat | typing.SupportsIndex,
    arg7: typing.SupportsInt | typing.SupportsIndex,
) -> Certificate: ...
def channels(arg0: collections.abc.Sequence[str]) -> list[str]: ...
def check(arg0: Model, arg1: Flight, arg2: Options) -> FlightCheck: ...
def check_not_input(arg0: str, arg1: str) -> None: ...
def check_output(arg0: str) -> None: ...
def concatenation(arg0: collections.abc.Sequence[tuple[str, Model]]) -> Model: ...
def confidence_ellipse(
    arg0: Fit,
    arg1: str,
    arg2: str,
    arg3: typing.SupportsFloat | typing.SupportsIndex,
    arg4: typing.SupportsInt | typing.SupportsIndex,
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
def cost_landscape(arg0: Calibration, arg1: Flight) -> CostLandscape: ...
def diagnose_fleet(
    flights: collections.abc.Sequence[
        tuple[
            str,
            str,
            FlightFactor,
            collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        ]
    ],
    significance: typing.SupportsFloat | typing.SupportsIndex,
    most: typing.SupportsInt | typing.SupportsIndex,
    common: collections.abc.Sequence[str] = [],
) -> FleetDiagnosis: ...
def effects(arg0: str) -> list[CataloguedEffect]: ...
def effects_of(arg0: Model) -> list[CataloguedEffect]: ...
def example_in_five_states() -> TwoStepProblem: ...
def example_in_three_states() -> TwoStepProblem: ...
def export_to_file(
    arg0: Calibration,
    arg1: str,
    arg2: str,
    arg3: Flight | None,
    arg4: typing.SupportsInt | typing.SupportsIndex | None,
    arg5: typing.SupportsInt | typing.SupportsIndex | None,
    arg6: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ]
    | None,
    arg7: typing.SupportsFloat | typing.SupportsIndex | None,
    arg8: str,
    arg9: str | None,
    arg10: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ]
    | None,
    arg11: collections.abc.Sequence[str],
    arg12: bool,
    arg13: str | None,
    arg14: bool,
) -> Exported: ...
def find_spread(
    arg0: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex],
    arg1: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex],
) -> tuple[float, float, float]: ...
def fit(
    arg0: Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: Options,
    arg4: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
) -> Fit: ...
def fit_alonso_shuster(
    columns: dict,
    labels: collections.abc.Sequence[str],
    field_strength: typing.SupportsFloat | typing.SupportsIndex,
    *,
    noise: typing.SupportsFloat | typing.SupportsIndex,
    bias_alone: bool,
    reweightings: typing.SupportsInt | typing.SupportsIndex,
    mean_as_printed: bool,
    iterations: typing.SupportsInt | typing.SupportsIndex,
    segments: str,
) -> AlonsoShusterFit: ...
def fit_haupt_kasdin(
    problem: TwoStepProblem,
    columns: dict,
    labels: collections.abc.Sequence[str],
    start: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    *,
    bounds: collections.abc.Mapping[str, tuple[float, float]],
    noise: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    segments: str,
    solver: str,
    evaluations: typing.SupportsInt | typing.SupportsIndex,
    threads: typing.SupportsInt | typing.SupportsIndex,
) -> HauptKasdinFit: ...
def fit_many(
    arg0: Model,
    arg1: collections.abc.Sequence[str],
    arg2: Options,
    arg3: collections.abc.Sequence[str],
    arg4: bool,
    arg5: collections.abc.Callable,
) -> ManyFit: ...
def fit_noise(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg1: collections.abc.Sequence[
        tuple[
            str,
            typing.SupportsInt | typing.SupportsIndex,
            typing.SupportsInt | typing.SupportsIndex,
        ]
    ]
    | None,
    arg2: typing.SupportsInt | typing.SupportsIndex | None,
    arg3: typing.SupportsInt | typing.SupportsIndex,
    arg4: NoiseModel | None,
) -> NoiseFit: ...
def fit_population(
    flights: collections.abc.Sequence[
        tuple[
            str,
            str,
            FlightFactor,
            collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        ]
    ],
    correlated: bool,
    inflation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    common: collections.abc.Sequence[str] = [],
) -> Population: ...
def fit_single_stage(
    model: Model,
    columns: dict,
    labels: collections.abc.Sequence[str],
    start: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    *,
    bounds: collections.abc.Mapping[str, tuple[float, float]],
    fix: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    noise: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    segments: str,
    solver: str = "levenberg_marquardt",
    cost: str = "mean",
    noise_tolerance: typing.SupportsFloat | typing.SupportsIndex = 0.05,
    noise_iterations: typing.SupportsInt | typing.SupportsIndex = 100,
    evaluations: typing.SupportsInt | typing.SupportsIndex = 1000,
    threads: typing.SupportsInt | typing.SupportsIndex = 0,
) -> SingleStageFit: ...
def fit_trials(
    arg0: Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: collections.abc.Sequence[
        tuple[str, typing.Annotated[numpy.typing.ArrayLike, numpy.float64]]
    ],
    arg4: Options,
) -> tuple[
    list[str],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    list[str],
    list[bool],
    int,
    int,
    dict[int, str],
    dict[int, str],
]: ...
def fit_vehicles(
    flights: collections.abc.Sequence[
        tuple[
            str,
            str,
            FlightFactor,
            collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        ]
    ],
    common: collections.abc.Sequence[str] = [],
) -> list[VehicleFit]: ...
def five_hole_probe(
    arg0: typing.SupportsFloat | typing.SupportsIndex,
    arg1: typing.SupportsFloat | typing.SupportsIndex,
    arg2: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ],
) -> Model: ...
def follow_vehicles(
    flights: collections.abc.Sequence[
        tuple[
            str,
            str,
            FlightFactor,
            collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        ]
    ],
    common: collections.abc.Sequence[str] = [],
) -> list[VehicleSeries]: ...
def foreign_reader() -> typing.Any: ...
def gather_figures(arg0: Calibration, arg1: Flight) -> FlightFigures: ...
def hear_progress(arg0: typing.Any) -> None: ...
def in_line(arg0: str) -> str: ...
def in_shell(arg0: str) -> str: ...
def join_rates(
    arg0: Flight, arg1: Flight, arg2: str, arg3: typing.SupportsFloat | typing.SupportsIndex
) -> Flight: ...
def list_fleet_candidates(arg0: Calibration, arg1: Flight) -> list[str]: ...
def magnetometer(
    arg0: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ]
    | None,
    arg1: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex] | None,
) -> Model: ...
def magnetometer_in_nine_states(
    arg0: typing.SupportsFloat | typing.SupportsIndex,
) -> TwoStepProblem: ...
def option_rows() -> list[OptionRow]: ...
def p_of_distance(
    arg0: typing.SupportsFloat | typing.SupportsIndex,
    arg1: typing.SupportsFloat | typing.SupportsIndex,
) -> float: ...
def parse_calibration(
    arg0: str,
    arg1: str,
    arg2: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
    arg3: Model | None,
) -> Calibration: ...
def parse_sized_effect(arg0: str) -> tuple[str, list[float]]: ...
def pitot_static() -> Model: ...
def predict(
    arg0: Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: Options,
    arg4: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
    arg5: Fit,
    arg6: typing.SupportsFloat | typing.SupportsIndex,
) -> Prediction: ...
def prepare_columns(
    arg0: Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: Options,
    arg4: collections.abc.Sequence[str],
) -> PreparedFlight: ...
def prepare_flight(
    arg0: Model, arg1: Flight, arg2: Options, arg3: collections.abc.Sequence[str]
) -> PreparedFlight: ...
def profile_intervals(
    arg0: Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: Options,
    arg4: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
    arg5: Fit,
    arg6: typing.SupportsFloat | typing.SupportsIndex,
    arg7: collections.abc.Sequence[str],
) -> Intervals: ...
def px4_pressure_sensor(
    arg0: typing.SupportsInt | typing.SupportsIndex,
) -> tuple[str, bool] | None: ...
def python_model(
    arg0: str,
    arg1: typing.Annotated[
        collections.abc.Sequence[
            collections.abc.Sequence[
                tuple[
                    str,
                    str,
                    typing.SupportsFloat | typing.SupportsIndex,
                    typing.SupportsFloat | typing.SupportsIndex,
                ]
            ]
        ],
        "FixedSize(4)",
    ],
    arg2: PythonFunctions,
    arg3: tuple[str, str],
) -> Model: ...
def quantiles(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]: ...
def read_calibration(
    arg0: str,
    arg1: collections.abc.Sequence[tuple[str, str | None, str, typing.Any]],
    arg2: Model | None,
) -> Calibration: ...
def read_csv(file: str, delimiter: str = "", decimal: str = "") -> Flight: ...
def read_foreign_files(arg0: typing.Any) -> None: ...
def reduce(
    arg0: Calibration,
    arg1: Flight,
    arg2: collections.abc.Sequence[str],
    arg3: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    arg4: collections.abc.Sequence[str],
    arg5: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
) -> FlightFactor: ...
def run_sepcal(
    words: collections.abc.Sequence[bytes], tables: collections.abc.Sequence[str] = []
) -> int: ...
def scalar_example_1() -> Model: ...
def scalar_example_2() -> Model: ...
def sdp3x_pressure(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    arg3: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> typing.Any: ...
def shipped_probes() -> list[tuple[str, str]]: ...
def simulate(
    arg0: str,
    arg1: str,
    arg2: collections.abc.Sequence[
        tuple[str, collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]]
    ],
    arg3: str,
    arg4: str,
    arg5: typing.SupportsInt | typing.SupportsIndex,
    arg6: typing.SupportsFloat | typing.SupportsIndex,
    arg7: typing.SupportsInt | typing.SupportsIndex,
    arg8: typing.SupportsInt | typing.SupportsIndex,
) -> tuple[Flight, dict[str, float], list[str]]: ...
def simulate_noise(
    arg0: NoiseModel,
    arg1: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
    arg2: typing.SupportsInt | typing.SupportsIndex,
    arg3: typing.SupportsInt | typing.SupportsIndex,
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
def smooth(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
) -> (
    tuple[
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
        typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    ]
    | None
): ...
def spectrum(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg1: collections.abc.Sequence[
        tuple[
            str,
            typing.SupportsInt | typing.SupportsIndex,
            typing.SupportsInt | typing.SupportsIndex,
        ]
    ],
    arg2: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]: ...
def stream_csv(file: str, folder: str = "", delimiter: str = "", decimal: str = "") -> Flight: ...
def vane_boom(
    arg0: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ],
) -> Model: ...
def whiten(
    arg0: NoiseModel,
    arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg2: collections.abc.Sequence[
        tuple[
            str,
            typing.SupportsInt | typing.SupportsIndex,
            typing.SupportsInt | typing.SupportsIndex,
        ]
    ]
    | None,
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
def with_rate(
    arg0: FlightFactor, arg1: str, arg2: str, arg3: typing.SupportsFloat | typing.SupportsIndex
) -> FlightFactor: ...
def write_whole(arg0: collections.abc.Mapping[str, str]) -> None: ...

LEAST_GAIN: float = 0.01
SIGNIFICANT_BELOW: float = 0.05
VISIBLE_FROM: float = 0.05
__version__: str = "0.1.0"

class Error(ValueError): ...
