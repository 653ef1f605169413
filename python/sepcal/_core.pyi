# SPDX-License-Identifier: BSD-3-Clause
# The C++ side as the Python front calls it. Arrays are float64; columns are C-contiguous, (N,).
from typing import TypedDict

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

class StageOneDescription(TypedDict):
    samples: Array
    trace_r: Array
    best: dict[str, float]
    best_trace_r: float
    minima: list[MinimumDescription]
    unique_minimum: bool
    flat_directions: list[str]

class FitDescription(TypedDict):
    status: str
    message: str
    parameters: list[ParameterDescription]
    covariance: Array
    correlation: Array
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

class MisfitDescription(TypedDict):
    segment: str
    output: str
    unit: str
    rows: int
    rmse: float
    mean: float
    lag_one: float

class ComparisonDescription(TypedDict):
    status: str
    message: str
    overall: list[MisfitDescription]
    where: list[MisfitDescription]
    time: Array
    residuals: Array
    notes: list[str]
    json: str

class AppliedDescription(TypedDict):
    rows: int
    rows_left_empty: int
    headers: list[str]
    notes: list[str]

class Options:
    def __setattr__(self, name: str, value: object, /) -> None: ...

class Model:
    @property
    def inputs(self) -> list[tuple[str, str, float, float]]: ...
    @property
    def outputs(self) -> list[tuple[str, str, float, float]]: ...
    @property
    def linear(self) -> list[tuple[str, str, float, float]]: ...
    @property
    def nonlinear(self) -> list[tuple[str, str, float, float]]: ...
    def evaluate(self, columns: dict[str, Array], xi2: Array, xi1: Array | None, /) -> Array: ...

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
    def notes(self) -> list[str]: ...
    @property
    def file(self) -> str: ...
    def compare(self, flight: Flight, /) -> ComparisonDescription: ...
    def apply(self, flight: Flight, /) -> dict[str, Array]: ...
    def apply_to_file(self, file: str, output: str, /) -> AppliedDescription: ...
    def to_json(self) -> str: ...
    def save(self, file: str, /) -> None: ...

def scalar_example_1() -> Model: ...
def scalar_example_2() -> Model: ...
def five_hole_probe(
    k_alpha: float, k_beta: float, lever_arm: tuple[float, float, float], /
) -> Model: ...
def magnetometer(field: tuple[float, float, float] | None, /) -> Model: ...
def fit(
    model: Model, columns: dict[str, Array], labels: list[str], options: Options, /
) -> FitDescription: ...
def calibrate(model: Model, flight: Flight, options: Options, /) -> Calibration: ...
def parse_calibration(json: str, source: str, /) -> Calibration: ...
def read_calibration(file: str, /) -> Calibration: ...
def read_csv(file: str, /) -> Flight: ...
def simulate(
    probe: str, truth: str, rate: float, rows: int, seed: int, /
) -> tuple[Flight, dict[str, float]]: ...
