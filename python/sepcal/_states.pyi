# SPDX-License-Identifier: BSD-3-Clause
# Made by scripts/lint --fix from cpp/src/bindings.
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import sepcal._core
import typing

__all__: list[str] = [
    "Design",
    "Filter",
    "Fit",
    "Options",
    "RecursiveLeastSquares",
    "Response",
    "StateTables",
    "SteppedFit",
    "Steps",
    "TrajectoryOptions",
    "aero_coefficients",
    "check",
    "damped_sinusoids",
    "discretise",
    "discretise_inputs",
    "fit",
    "flight_path",
    "foreign_reader",
    "frequency_response",
    "iterate_least_squares",
    "join",
    "matrix_exponential",
    "multisines",
    "parse",
    "propagate",
    "python_state_model",
    "read",
    "read_aircraft",
    "read_foreign_files",
    "run_aircraft",
    "short_period",
    "simulate",
    "smooth",
    "standard_regressors",
    "three_two_one_one",
    "track",
    "two_steps",
]

class TrajectoryOptions:
    def __init__(
        self,
        *,
        inputs: str,
        substeps: typing.SupportsInt | typing.SupportsIndex,
        shoot: typing.SupportsFloat | typing.SupportsIndex,
        measured: collections.abc.Sequence[str],
        outputs: collections.abc.Sequence[str],
        separable: bool,
        scales_about_start: bool,
    ) -> None: ...

class StateTables:
    def __init__(
        self,
        tables: typing.Annotated[
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
            "FixedSize(6)",
        ],
        linear_dynamic: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
        linear_in_state: bool,
        scales: collections.abc.Sequence[bool],
        acts_on: collections.abc.Sequence[collections.abc.Sequence[bool]],
        discrete: bool,
    ) -> None: ...

class Filter:
    @staticmethod
    def of_information_root(
        arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    ) -> Filter: ...
    @typing.overload
    def __init__(
        self,
        arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        arg2: str,
    ) -> None: ...
    @typing.overload
    def __init__(self, arg0: Filter) -> None: ...
    def iterated_update(
        self,
        arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg1: collections.abc.Callable[
            [typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]],
            tuple[
                typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
                typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
            ],
        ],
        arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        arg3: sepcal._core.IterationOptions,
    ) -> tuple[sepcal._core.Innovation, bool] | None: ...
    def keep_pass(self) -> None: ...
    def predict(
        self,
        arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        arg3: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    ) -> bool: ...
    def smooth(
        self,
    ) -> tuple[
        list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]],
        list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]],
        list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]],
        list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]],
    ]: ...
    def update(
        self,
        arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        arg3: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    ) -> sepcal._core.Innovation | None: ...
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def information_root(
        self,
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"] | None: ...
    @property
    def keeps_pass(self) -> bool: ...
    @property
    def x(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...

class RecursiveLeastSquares:
    def __init__(
        self,
        arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"] | None,
        arg2: str,
    ) -> None: ...
    def absorb(
        self,
        arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
        arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    ) -> bool: ...
    @property
    def covariance(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def determined(self) -> bool: ...
    @property
    def solution(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...

class Options:
    def __init__(
        self,
        *,
        model: str,
        geometry: str | None,
        equations: collections.abc.Mapping[str, collections.abc.Sequence[str]],
        trajectory: TrajectoryOptions,
        position: bool = False,
        gravity: typing.SupportsFloat | typing.SupportsIndex,
        window: typing.SupportsFloat | typing.SupportsIndex,
        band: typing.Annotated[
            collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
        ]
        | None,
        fit: sepcal._core.Options,
    ) -> None: ...

class Fit:
    def add(self, arg0: sepcal._core.Flight, arg1: str) -> Fit: ...
    def apply(
        self,
        arg0: sepcal._core.Flight,
        arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    ) -> tuple[dict[str, numpy.typing.NDArray[numpy.float64]], list[str]]: ...
    def apply_to_file(
        self,
        arg0: str,
        arg1: str,
        arg2: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    ) -> sepcal._core.Applied: ...
    def compare(
        self, flight: sepcal._core.Flight, references: collections.abc.Sequence[str] = []
    ) -> sepcal._core.Comparison: ...
    def diagnose(
        self,
        arg0: sepcal._core.Flight,
        arg1: tuple[str, collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]]
        | None,
        arg2: sepcal._core.DiagnosisOptions,
    ) -> sepcal._core.Diagnosis: ...
    def diagnose_stepwise(
        self,
        arg0: sepcal._core.Flight,
        arg1: typing.SupportsInt | typing.SupportsIndex | None,
        arg2: sepcal._core.DiagnosisOptions,
    ) -> SteppedFit: ...
    def expect(self, arg0: sepcal._core.Flight, arg1: sepcal._core.Flight) -> sepcal._core.Fit: ...
    def intervals(
        self,
        arg0: sepcal._core.Flight,
        arg1: typing.SupportsFloat | typing.SupportsIndex,
        arg2: collections.abc.Sequence[str],
    ) -> sepcal._core.Intervals: ...
    def residuals(
        self, arg0: sepcal._core.Flight
    ) -> tuple[list[tuple[str, numpy.typing.NDArray[numpy.float64]]], list[str]]: ...
    def save(self, arg0: str) -> None: ...
    def smooth(
        self,
        arg0: sepcal._core.Flight,
        arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    ) -> sepcal._core.SmoothedRecord: ...
    def to_json(self) -> str: ...
    def track(
        self, arg0: sepcal._core.Flight, arg1: sepcal._core.FlightTrackOptions
    ) -> tuple[sepcal._core.Track, list[str]]: ...
    @property
    def equations(self) -> dict[str, list[str]]: ...
    @property
    def file(self) -> str: ...
    @property
    def fit(self) -> sepcal._core.Fit: ...
    @property
    def history(self) -> list[tuple[str, dict[str, float], dict[str, float], float, float]]: ...
    @property
    def initial_states(self) -> list[str]: ...
    @property
    def method(self) -> str: ...
    @property
    def model(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def warning(self) -> str: ...

class SteppedFit:
    @property
    def end(self) -> str: ...
    @property
    def explained(self) -> str: ...
    @property
    def fitted(self) -> Fit: ...
    @property
    def json(self) -> str: ...
    @property
    def last(self) -> sepcal._core.Diagnosis: ...
    @property
    def reason(self) -> str: ...
    @property
    def steps(self) -> list[sepcal._core.StepwiseStep]: ...
    @property
    def text(self) -> str: ...

class Steps:
    def track(
        self, arg0: sepcal._core.Flight, arg1: sepcal._core.FlightTrackOptions
    ) -> tuple[sepcal._core.Track, list[str]]: ...
    @property
    def aero(self) -> Fit: ...
    @property
    def explained(self) -> str: ...
    @property
    def json(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def path(self) -> Fit: ...
    @property
    def text(self) -> str: ...

class Response:
    def polar(self) -> list[typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]]: ...
    def save(self, arg0: str) -> None: ...
    def to_text(self) -> str: ...
    @property
    def averages(self) -> float: ...
    @property
    def coherence(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def coherence_all(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]: ...
    @property
    def frequencies(self) -> list[float]: ...
    @property
    def inputs(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def output(self) -> str: ...
    @property
    def radius(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def response(self) -> typing.Annotated[numpy.typing.NDArray[numpy.complex128], "[m, n]"]: ...
    @property
    def standard_error(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def window(self) -> float: ...
    @property
    def windows(self) -> int: ...

class Design:
    def save(self, arg0: str) -> None: ...
    def to_text(self) -> str: ...
    @property
    def frequencies(self) -> list[list[float]]: ...
    @property
    def inputs(self) -> list[str]: ...
    @property
    def kind(self) -> str: ...
    @property
    def peak_factors(self) -> list[float]: ...
    @property
    def share(self) -> float: ...
    @property
    def signals(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    @property
    def step(self) -> float: ...
    @property
    def time(self) -> list[float]: ...

def aero_coefficients(
    arg0: dict,
    arg1: collections.abc.Sequence[str],
    arg2: str,
    arg3: collections.abc.Sequence[str],
    arg4: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple[dict[str, numpy.typing.NDArray[numpy.float64]], list[str], float, list[str]]: ...
def check(
    arg0: str, arg1: sepcal._core.Flight, arg2: sepcal._core.Options
) -> sepcal._core.FlightCheck: ...
def damped_sinusoids(arg0: typing.SupportsInt | typing.SupportsIndex) -> sepcal._core.Model: ...
def discretise(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    arg2: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple[
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
]: ...
def discretise_inputs(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    arg2: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple[
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
]: ...
def fit(arg0: sepcal._core.Flight, arg1: Options) -> Fit: ...
def flight_path(
    arg0: bool,
    arg1: typing.SupportsFloat | typing.SupportsIndex,
    arg2: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ],
    arg3: TrajectoryOptions,
) -> sepcal._core.Model: ...
def foreign_reader() -> typing.Any: ...
def frequency_response(
    arg0: sepcal._core.Flight,
    arg1: collections.abc.Sequence[str],
    arg2: str,
    arg3: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ],
    arg4: typing.SupportsFloat | typing.SupportsIndex,
    arg5: typing.SupportsFloat | typing.SupportsIndex,
) -> Response: ...
def iterate_least_squares(
    arg0: collections.abc.Callable[
        [int, typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"]],
        tuple[
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
            typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
        ],
    ],
    arg1: typing.SupportsInt | typing.SupportsIndex,
    arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg3: typing.SupportsInt | typing.SupportsIndex,
    arg4: typing.SupportsFloat | typing.SupportsIndex,
    arg5: typing.SupportsInt | typing.SupportsIndex,
) -> tuple[
    str,
    int,
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    int,
    float,
]: ...
def join(
    arg0: collections.abc.Sequence[sepcal._core.Flight],
    arg1: sepcal._core.Options,
    arg2: Fit | None,
) -> sepcal._core.Flight: ...
def matrix_exponential(
    arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
def multisines(
    arg0: collections.abc.Sequence[tuple[str, typing.SupportsFloat | typing.SupportsIndex]],
    arg1: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ],
    arg2: typing.SupportsFloat | typing.SupportsIndex,
    arg3: typing.SupportsFloat | typing.SupportsIndex,
    arg4: bool,
) -> Design: ...
def parse(arg0: str, arg1: str) -> Fit: ...
def propagate(
    arg0: collections.abc.Callable[
        [typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], float],
        typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    ],
    arg1: collections.abc.Callable[
        [typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], float],
        typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    ],
    arg2: collections.abc.Callable[
        [typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"], float],
        typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    ],
    arg3: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, 1]"],
    arg4: typing.Annotated[numpy.typing.ArrayLike, numpy.float64, "[m, n]"],
    arg5: typing.SupportsFloat | typing.SupportsIndex,
    arg6: typing.SupportsFloat | typing.SupportsIndex,
    arg7: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple[
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, 1]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
    typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"],
]: ...
def python_state_model(
    arg0: str, arg1: StateTables, arg2: TrajectoryOptions, arg3: typing.Any, arg4: tuple[str, str]
) -> sepcal._core.Model: ...
def read(arg0: str) -> Fit: ...
def read_aircraft(arg0: str) -> str: ...
def read_foreign_files(arg0: typing.Any) -> None: ...
def run_aircraft(arg0: str, arg1: collections.abc.Sequence[str]) -> int: ...
def short_period(arg0: TrajectoryOptions) -> sepcal._core.Model: ...
def simulate(
    arg0: str,
    arg1: collections.abc.Sequence[
        tuple[str, collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex]]
    ],
    arg2: str,
    arg3: str,
    arg4: typing.SupportsInt | typing.SupportsIndex,
    arg5: typing.SupportsFloat | typing.SupportsIndex,
    arg6: typing.SupportsInt | typing.SupportsIndex,
    arg7: typing.SupportsInt | typing.SupportsIndex,
) -> tuple[sepcal._core.Flight, dict[str, float], list[str]]: ...
def smooth(
    arg0: sepcal._core.Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    arg4: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    arg5: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    arg6: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    arg7: sepcal._core.Fit | None,
) -> sepcal._core.SmoothedRecord: ...
def standard_regressors(arg0: str) -> list[str]: ...
def three_two_one_one(
    arg0: collections.abc.Sequence[tuple[str, typing.SupportsFloat | typing.SupportsIndex]],
    arg1: typing.Annotated[
        collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"
    ],
    arg2: typing.SupportsFloat | typing.SupportsIndex,
    arg3: typing.SupportsFloat | typing.SupportsIndex,
    arg4: typing.SupportsFloat | typing.SupportsIndex,
) -> Design: ...
def track(
    arg0: sepcal._core.Model,
    arg1: dict,
    arg2: collections.abc.Sequence[str],
    arg3: sepcal._core.Fit | None,
    arg4: sepcal._core.Options,
    arg5: sepcal._core.FlightTrackOptions,
) -> sepcal._core.Track: ...
def two_steps(arg0: sepcal._core.Flight, arg1: Options) -> Steps: ...
