# SPDX-License-Identifier: BSD-3-Clause
# Made by scripts/lint --fix from cpp/src/bindings.
from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import sepcal._core
import typing

__all__: list[str] = [
    "Fit",
    "Options",
    "Steps",
    "fit",
    "parse",
    "read",
    "read_aircraft",
    "simulate",
    "standard_regressors",
    "two_steps",
]

class Options:
    def __init__(
        self,
        *,
        model: str,
        geometry: str | None,
        equations: collections.abc.Mapping[str, collections.abc.Sequence[str]],
        trajectory: sepcal._core.TrajectoryOptions,
        gravity: typing.SupportsFloat | typing.SupportsIndex,
        window: typing.SupportsFloat | typing.SupportsIndex,
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
    def compare(self, arg0: sepcal._core.Flight) -> sepcal._core.Comparison: ...
    def save(self, arg0: str) -> None: ...
    def smooth(
        self,
        arg0: sepcal._core.Flight,
        arg1: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
    ) -> sepcal._core.SmoothedRecord: ...
    def to_json(self) -> str: ...
    def track(
        self,
        arg0: sepcal._core.Flight,
        arg1: str,
        arg2: typing.SupportsInt | typing.SupportsIndex,
        arg3: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        arg4: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        arg5: collections.abc.Mapping[str, typing.SupportsFloat | typing.SupportsIndex],
        arg6: sepcal._core.IterationOptions,
    ) -> tuple[sepcal._core.Track, list[str]]: ...
    @property
    def equations(self) -> dict[str, list[str]]: ...
    @property
    def file(self) -> str: ...
    @property
    def fit(self) -> sepcal._core.Fit: ...
    @property
    def history(self) -> list[tuple[str, dict[str, float], dict[str, float]]]: ...
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

class Steps:
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

def fit(arg0: sepcal._core.Flight, arg1: Options) -> Fit: ...
def parse(arg0: str, arg1: str) -> Fit: ...
def read(arg0: str) -> Fit: ...
def read_aircraft(arg0: str) -> str: ...
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
def standard_regressors(arg0: str) -> list[str]: ...
def two_steps(arg0: sepcal._core.Flight, arg1: Options) -> Steps: ...
