# SPDX-License-Identifier: BSD-3-Clause
"""Several sensors as one model."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from sepcal import _core
from sepcal.models import Model
from sepcal.own_model import SeparableModel
from sepcal.own_state_model import as_model


class Concatenation(Model):
    """Several sensors as one model; concatenate() makes it.

    Args:
        sensors: By label; "": names as they are.
    """

    def __init__(self, sensors: Mapping[str, Model], unlabelled: tuple[Model, ...] = ()) -> None:
        self.sensors = dict(sensors)
        self.unlabelled = unlabelled
        self.runs_in_python = any(
            sensor.runs_in_python for sensor in (*unlabelled, *self.sensors.values())
        )
        parts = [("", sensor) for sensor in unlabelled] + list(self.sensors.items())
        super().__init__(_core.concatenation([(label, part._core) for label, part in parts]))

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(Concatenation, self.sensors, self.unlabelled), ()

    def __repr__(self) -> str:
        parts = [repr(sensor) for sensor in self.unlabelled]
        parts += [f"{label}={sensor!r}" for label, sensor in self.sensors.items()]
        return f"concatenate({', '.join(parts)})"


def concatenate(
    *sensors: Model | SeparableModel, **labelled: Model | SeparableModel
) -> Concatenation:
    """Sensors side by side as one model (Sun & Gebre-Egziabher, Eq. A5).

        both = sepcal.concatenate(mag=sepcal.Magnetometer(), acc=sepcal.Accelerometer())
        both.parameters  # mag.lambda_x, ..., acc.lambda_x, ...

    Inputs of one name are one input; outputs and parameters stand one sensor after another.

    Args:
        *sensors: Models, of sepcal or of yours, whose names stay as they are.
        **labelled: Models whose outputs and parameters are called "label.name".

    Raises:
        Error: No model, one with a state, a name that belongs to two, an input in two units.
    """
    return Concatenation(
        {label: as_model(sensor) for label, sensor in labelled.items()},
        tuple(as_model(sensor) for sensor in sensors),
    )
