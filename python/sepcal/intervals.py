# SPDX-License-Identifier: BSD-3-Clause
"""How far parameters may lie, by standard errors and by the likelihood; predictions with bands."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass
from typing import Any, Self, Unpack

from sepcal import _core
from sepcal.columns import Array, Columns, take_columns, take_drivers, to_labels
from sepcal.models import Model
from sepcal.options import FitOptions, spelled_out, to_core, to_names
from sepcal.own_effect import name_effects, to_core_effects
from sepcal.own_model import OwnModel, SeparableModel
from sepcal.pages import Page, Row
from sepcal.results import Fit


@dataclass(frozen=True)
class ParameterInterval:
    """Both intervals of one parameter, (lower, upper) in `unit`."""

    name: str
    value: float
    unit: str
    gaussian: tuple[float, float]  # value -+ quantile * standard_error; NaN where there is none
    profile: tuple[float, float]  # infinite where open, NaN where failed
    ends: tuple[str, str]  # what ends the profile's: "crossed", "bound", "open" or "failed"
    message: str  # one line; empty where there is nothing to say


@dataclass(frozen=True, eq=False, repr=False)
class Intervals(Page):
    """`print(intervals)` shows the table; `intervals["w_n"]` is one parameter's."""

    _shown = (
        "name",
        "value",
        "gaussian_lower",
        "gaussian_upper",
        "profile_lower",
        "profile_upper",
        "unit",
    )

    level: float
    parameters: dict[str, ParameterInterval]
    notes: list[str]  # one line each, for people
    json: str
    text: str  # what print() shows: of a calibration's, the app's page
    explained: str  # the same with the whole message, as by the apps' --explain

    @classmethod
    def _of(cls, described: _core.IntervalsDescription) -> Self:
        fields: dict[str, Any] = {**described}
        fields["parameters"] = {
            name: ParameterInterval(**entry) for name, entry in described["parameters"].items()
        }
        return cls(**fields)

    def __getitem__(self, name: str) -> ParameterInterval:
        """The intervals of one parameter. Raises KeyError listing those that there are."""
        if name not in self.parameters:
            known = ", ".join(self.parameters)
            raise KeyError(f"there is no interval of '{name}'; there are: {known}")
        return self.parameters[name]

    def to_json(self) -> str:
        """The JSON; of a calibration's, what the app's `intervals` prints."""
        return self.json

    def to_dict(self) -> dict[str, Any]:
        """The same as a dictionary; None where a number is undefined or infinite."""
        read: dict[str, Any] = json.loads(self.json)
        return read

    def _summary(self) -> str:
        return f"of {100 * self.level:g} %: {len(self.parameters)} parameters"

    def _rows(self) -> list[Row]:
        return [
            {
                "name": at.name,
                "value": at.value,
                "unit": at.unit,
                "gaussian_lower": at.gaussian[0],
                "gaussian_upper": at.gaussian[1],
                "profile_lower": at.profile[0],
                "profile_upper": at.profile[1],
                "lower_end": at.ends[0],
                "upper_end": at.ends[1],
                "message": at.message,
            }
            for at in self.parameters.values()
        ]


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a fit says of N samples, in the outputs' units and the model's order of outputs."""

    value: Array  # (N, n_z), A xi1 + b
    standard_error: Array  # (N, n_z), of the value, from the parameters' covariance
    measurement_error: Array  # (N, n_z), standard deviation of a new measurement about the value
    quantile: float  # half a band's width in these errors, by the level asked for
    time: Array | None = None  # (N,) [s] of a flight's rows

    @classmethod
    def _of(cls, described: _core.PredictionDescription) -> Self:
        return cls(**described)

    @property
    def band(self) -> tuple[Array, Array]:
        """Lower and upper limits of the value."""
        half = self.quantile * self.standard_error
        return self.value - half, self.value + half

    @property
    def measurement_band(self) -> tuple[Array, Array]:
        """Lower and upper limits of a new measurement, its noise included."""
        half = self.quantile * self.measurement_error
        return self.value - half, self.value + half


@spelled_out()
def profile_intervals(
    model: Model | SeparableModel,
    data: Columns,
    fit: Fit,
    *,
    level: float = 0.95,
    names: Sequence[str] | None = None,
    **options: Unpack[FitOptions],
) -> Intervals:
    """Gaussian and profile-likelihood intervals of a fit on columns; a Calibration has a method.

    The profile-likelihood interval of a parameter is where the cost, with all others fitted again,
    stays below a height that the level gives. It follows a likelihood that is no parabola, and ends
    at a bound where the bound, not the data, ends it.

    Args:
        model: That was fitted.
        data: The inputs and outputs that were fitted.
        fit: The fit.
        level: How often an interval should hold the true value.
        names: Parameters [all that are free].
        **options: Those of the fit.

    Raises:
        Error: The fit is not that of the model, the data and the options; a parameter that there
            isn't or that is fixed; a level outside (0, 1).
    """
    model, columns, labels, core, own = _as_fitted(model, data, fit, options, measured=True)
    described = _core.profile_intervals(
        model._core, columns, labels, core, own, _to_core(fit), _settings(fit), level,
        to_names("names", names or ()),
    )  # fmt: skip
    return Intervals._of(described)


@spelled_out()
def predict(
    model: Model | SeparableModel,
    data: Columns,
    fit: Fit,
    *,
    level: float = 0.95,
    **options: Unpack[FitOptions],
) -> Prediction:
    """What a fit says of samples, with the bands of the value and of a new measurement.

    Args:
        model: That was fitted.
        data: Its inputs, and what drives its effects, each of shape (N,); other columns are
            ignored.
        fit: The fit.
        level: How often a band should hold what it is for.
        **options: Those of the fit: its noise, if it was given, and its effects matter.

    Raises:
        Error: Bad input, a fit of another model, a level outside (0, 1).
    """
    model, columns, labels, core, own = _as_fitted(model, data, fit, options, measured=False)
    described = _core.predict(
        model._core, columns, labels, core, own, _to_core(fit), _settings(fit), level
    )
    return Prediction._of(described)


def _as_fitted(
    model: Model | SeparableModel,
    data: Columns,
    fit: Fit,
    options: FitOptions,
    *,
    measured: bool,
) -> tuple[Model, dict[str, Array], list[str], _core.Options, list[_core.OwnEffect]]:
    """The model, the columns, labels, options and own effects, as C++ takes them."""
    if hasattr(fit, "core"):
        raise _core.Error("a calibration knows its model: call its own intervals() or predict()")
    if not isinstance(model, Model):
        model = OwnModel(model)
    if isinstance(model, OwnModel):
        options["threads"] = options.get("threads") or 1
    own = to_core_effects(options.get("effects") or ())
    options["effects"] = name_effects(options.get("effects") or ())
    names = [setting.name for setting in fit.effects]
    there = set(data)
    needed = [*model._columns_in(data), *({"time"} & there)]
    if measured:
        needed += model._measured_in(data)
    columns = take_columns(model._owner, data, dict.fromkeys(needed))
    if names:
        columns |= take_drivers(model._owner, data, columns, _core.channels(names))
    labels = to_labels(data["maneuver"]) if "maneuver" in there else []  # type: ignore[arg-type]
    return model, columns, labels, to_core(options), own


def _to_core(fit: Fit) -> dict[str, object]:
    return {
        "status": fit.status,
        "parameters": [asdict(parameter) for parameter in fit.parameters.values()],
        "covariance": fit.covariance,
        "noise": fit.noise,
        "cost": fit.cost,
        "rows": fit.rows,
        "method": fit.method,
    }


def _settings(fit: Fit) -> list[_core.Setting]:
    return [astuple(setting) for setting in fit.effects]
