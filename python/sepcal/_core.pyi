# SPDX-License-Identifier: BSD-3-Clause
# The C++ side as the Python front calls it. Arrays are float64; columns are C-contiguous, (N,).
from collections.abc import Callable, Sequence
from typing import TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

from sepcal.columns import Array

__version__: str

class Error(ValueError): ...

class ParameterDescription(TypedDict):
    name: str
    value: float
    standard_error: float
    standard_error_white: float
    unit: str
    lower: float
    upper: float
    at_bound: bool
    fixed: bool

class CombinationDescription(TypedDict):
    text: str
    parameters: tuple[str, ...]
    standard_error: float

class MinimumDescription(TypedDict):
    xi2: dict[str, float]
    trace_r: float

class ScreensDescription(TypedDict):
    ratio_a: Array
    ratio_b: Array
    curvature_a: Array
    curvature_b: Array
    accepted: NDArray[np.bool_]

class StageOneDescription(TypedDict):
    samples: Array
    trace_r: Array
    best: dict[str, float]
    best_trace_r: float
    minima: list[MinimumDescription]
    unique_minimum: bool
    flat_directions: list[str]
    screens: ScreensDescription | None

class EffectSettingDescription(TypedDict):
    name: str
    centre: float | None
    knots: tuple[float, ...]
    labels: tuple[str, ...]
    span: tuple[float, float] | None
    t0: float | None

class CataloguedEffectDescription(TypedDict):
    name: str
    equation: str
    drivers: str
    unit: str

class FitDescription(TypedDict):
    status: str
    message: str
    parameters: list[ParameterDescription]
    covariance: Array
    correlation: Array
    covariance_white: Array
    noise: dict[str, float]
    rmse: dict[str, float]
    cost: float
    rows: int
    unobservable: list[CombinationDescription]
    weak: list[CombinationDescription]
    stage_one: StageOneDescription
    method: str
    iterations: int
    noise_iterations: int
    effects: list[EffectSettingDescription]
    text: str
    explained: str

class PagesDescription(TypedDict):
    text: str
    explained: str

class HistoryDescription(TypedDict):
    effect: str
    rmse_before: float | None
    rmse_after: float | None
    held_out_before: float | None
    held_out_after: float | None
    predicted_drop: float | None

class DerivedDescription(TypedDict):
    name: str
    value: float
    standard_error: float
    standard_error_white: float
    unit: str

class MisfitDescription(TypedDict):
    segment: str
    output: str
    unit: str
    rows: int
    rmse: float
    mean: float
    lag_one: float
    verdict: str

class ChannelDescription(TypedDict):
    driver: str
    output: str
    share_line: float
    share_smooth: float
    slope: float
    slope_error: float
    unit: str

class WindowDescription(TypedDict):
    first_s: float
    last_s: float
    rows: int
    rmse: dict[str, float]
    mean: dict[str, float]

class ComparisonDescription(TypedDict):
    model: str
    file: str
    status: str
    message: str
    overall: list[MisfitDescription]
    where: list[MisfitDescription]
    channels: list[ChannelDescription]
    windows: list[WindowDescription]
    time: Array
    residuals: Array
    notes: list[str]
    json: str
    text: str
    explained: str

class IntervalDescription(TypedDict):
    name: str
    value: float
    unit: str
    gaussian: tuple[float, float]
    profile: tuple[float, float]
    ends: tuple[str, str]
    message: str

class IntervalsDescription(TypedDict):
    level: float
    parameters: dict[str, IntervalDescription]
    notes: list[str]
    json: str
    text: str
    explained: str

class PredictionDescription(TypedDict, total=False):
    value: Array
    standard_error: Array
    measurement_error: Array
    quantile: float
    time: Array  # of a flight

class AppliedDescription(TypedDict):
    rows: int
    rows_left_empty: int
    headers: list[str]
    notes: list[str]

class DepartureDescription(TypedDict):
    combinations: int
    statistic: float
    p: float
    p_holm: float
    p_white: float
    p_white_holm: float
    difference: dict[str, float]
    standard_error: dict[str, float]

class FlightFitDescription(TypedDict):
    name: str
    own: list[ParameterDescription]
    rmse: dict[str, float]
    rows: int
    alone: str
    message: str
    departure: DepartureDescription

class ManyFitDescription(TypedDict):
    status: str
    message: str
    shared: list[ParameterDescription]
    covariance: Array
    correlation: Array
    covariance_white: Array
    flights: list[FlightFitDescription]
    left_out: dict[str, str]
    noise: dict[str, float]
    rmse: dict[str, float]
    cost: float
    unobservable: list[CombinationDescription]
    weak: list[CombinationDescription]
    iterations: int
    noise_iterations: int
    passes: int
    rows: int

# The fields of sepcal.EffectSetting.
Setting: TypeAlias = tuple[
    str,
    float | None,
    Sequence[float],
    Sequence[str],
    tuple[float, float] | None,
    float | None,
]

# Name, port, unit, and the function of the columns (N,) and n_z.
OwnEffect: TypeAlias = tuple[
    str, str | None, str, Callable[[dict[str, Array], int], Array | list[tuple[str, Array]]]
]

class Options:
    def __setattr__(self, name: str, value: object, /) -> None: ...

class Model:
    @property
    def inputs(self) -> list[tuple[str, str, float, float, float]]: ...
    @property
    def outputs(self) -> list[tuple[str, str, float, float, float]]: ...
    @property
    def linear(self) -> list[tuple[str, str, float, float, float]]: ...
    @property
    def nonlinear(self) -> list[tuple[str, str, float, float, float]]: ...
    def evaluate(self, columns: dict[str, Array], xi2: Array, xi1: Array | None, /) -> Array: ...
    def input_tangent(
        self, columns: dict[str, Array], xi2: Array, xi1: Array, inputs: list[int], /
    ) -> Array: ...

class PythonFunctions:
    def __init__(self, gather: object, at: object, try_at: object, derivatives: object) -> None: ...

class Flight:
    def __init__(self, name: str, /) -> None: ...
    def view(self, header: str, values: Array) -> None: ...
    def label(self, labels: list[str], /) -> None: ...
    def column(self, header: str, /) -> Array | None: ...
    def list_columns(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def sha256(self) -> str: ...
    @property
    def rows(self) -> int: ...
    @property
    def headers(self) -> list[str]: ...
    @property
    def maneuvers(self) -> list[str]: ...

class Calibration:
    @property
    def fit(self) -> FitDescription: ...
    @property
    def derived(self) -> dict[str, DerivedDescription]: ...
    @property
    def history(self) -> list[HistoryDescription]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def file(self) -> str: ...
    @property
    def model(self) -> str: ...
    @property
    def unit(self) -> str: ...
    def pages(self) -> PagesDescription: ...
    def compare(self, flight: Flight, /) -> ComparisonDescription: ...
    def diagnose(
        self,
        flight: Flight,
        own: Sequence[OwnEffect],
        injected: tuple[str, list[float]] | None,
        simulations: int,
        seed: int,
        /,
    ) -> dict[str, object]: ...
    def intervals(
        self, flight: Flight, level: float, names: Sequence[str], /
    ) -> IntervalsDescription: ...
    def predict(self, flight: Flight, level: float, /) -> PredictionDescription: ...
    def add(self, flight: Flight, effect: str, own: Sequence[OwnEffect], /) -> Calibration: ...
    def apply(self, flight: Flight, /) -> dict[str, Array]: ...
    def apply_to_file(self, file: str, output: str, /) -> AppliedDescription: ...
    def to_json(self) -> str: ...
    def save(self, file: str, /) -> None: ...

def scalar_example_1() -> Model: ...
def scalar_example_2() -> Model: ...
def five_hole_probe(
    k_alpha: float, k_beta: float, lever_arm: tuple[float, float, float], /
) -> Model: ...
def pitot_static() -> Model: ...
def attitude_independent_magnetometer(field_strength: float, /) -> Model: ...
def magnetometer(field: tuple[float, float, float] | None, /) -> Model: ...
def python_model(
    name: str, tables: list[list[tuple[str, str, float, float]]], functions: PythonFunctions, /
) -> Model: ...
def fit(
    model: Model,
    columns: dict[str, Array],
    labels: list[str],
    options: Options,
    own: Sequence[OwnEffect],
    /,
) -> FitDescription: ...
def calibrate(
    model: Model, flight: Flight, options: Options, own: Sequence[OwnEffect], /
) -> Calibration: ...
def profile_intervals(
    model: Model,
    columns: dict[str, Array],
    labels: list[str],
    options: Options,
    own: Sequence[OwnEffect],
    fit: dict[str, object],
    settings: Sequence[Setting],
    level: float,
    names: Sequence[str],
    /,
) -> IntervalsDescription: ...
def predict(
    model: Model,
    columns: dict[str, Array],
    labels: list[str],
    options: Options,
    own: Sequence[OwnEffect],
    fit: dict[str, object],
    settings: Sequence[Setting],
    level: float,
    /,
) -> PredictionDescription: ...
def parse_calibration(json: str, source: str, own: Sequence[OwnEffect], /) -> Calibration: ...
def read_calibration(file: str, own: Sequence[OwnEffect], /) -> Calibration: ...
def effects(probe: str, /) -> list[CataloguedEffectDescription]: ...
def channels(effects: list[str], /) -> list[str]: ...
def read_csv(file: str, /) -> Flight: ...
def simulate(
    probe: str,
    truth: str,
    hidden: list[tuple[str, list[float]]],
    excitation: str,
    noise: str,
    decoys: int,
    rate: float,
    rows: int,
    seed: int,
    /,
) -> tuple[Flight, dict[str, float], list[str]]: ...

# A flight's (status or None, message, x, noise, stacked factors, sums of z^2, rows).
Start: TypeAlias = tuple[str | None, str, Array, Array, Array, Array, int]

class PreparedFlight:
    def start(self) -> Start: ...
    def linearise(self, x: Array, /) -> Array: ...
    def score_covariance(
        self, question: tuple[Array, Array, Array, list[int], Array], /
    ) -> Array: ...

def prepare_flight(
    model: Model, flight: Flight, options: Options, own: list[str], /
) -> PreparedFlight: ...
def prepare_columns(
    model: Model,
    columns: dict[str, Array],
    labels: list[str],
    options: Options,
    own: list[str],
    /,
) -> PreparedFlight: ...
def fit_many(
    model: Model,
    names: list[str],
    options: Options,
    own: list[str],
    leave_out: bool,
    visit: Callable[[str, list[tuple[int, object]]], list[object]],
    /,
) -> ManyFitDescription: ...

# What the report draws. Rows: label, first row, row after the last. Smooth: x, mean, half width.
Rows: TypeAlias = tuple[str, int, int]
Smooth: TypeAlias = tuple[Array, Array, Array]

class FlightFigures:
    @property
    def rows(self) -> NDArray[np.uint64]: ...
    @property
    def segments(self) -> list[Rows]: ...
    @property
    def runs(self) -> list[Rows]: ...
    @property
    def interval(self) -> list[float]: ...
    @property
    def measured(self) -> Array: ...
    @property
    def modelled(self) -> Array: ...
    @property
    def within_95(self) -> list[float]: ...
    @property
    def airspeed(self) -> Array | None: ...
    @property
    def heading(self) -> Array | None: ...
    @property
    def heading_is_track(self) -> bool: ...
    def channel(self, name: str, /) -> Array | None: ...

def gather_figures(calibration: Calibration, flight: Flight, /) -> FlightFigures: ...
def autocorrelation(residual: Array, runs: Sequence[Rows], /) -> tuple[Array, Array, Array]: ...
def spectrum(residual: Array, runs: Sequence[Rows], interval: float, /) -> tuple[Array, Array]: ...
def quantiles(residual: Array, /) -> tuple[Array, Array]: ...
def smooth(x: Array, residual: Array, /) -> Smooth | None: ...
def bin_means(x: Array, y: Array, bins: int, /) -> tuple[Array, Array]: ...
