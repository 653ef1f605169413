# SPDX-License-Identifier: BSD-3-Clause
"""Several sensors as one model."""

from collections.abc import Sequence
from typing import Any

from sepcal import _core
from sepcal.arguments import checked
from sepcal.models import Model
from sepcal.own_model import SeparableModel
from sepcal.own_state_model import as_model


class Concatenation(Model):
    """Several sensors as one model; concatenate() makes it.

    Args:
        sensors: (label, model) of each; "": its names stay as they are.

    Example:
        >>> both = sepcal.concatenate(mag=sepcal.Magnetometer(), acc=sepcal.Accelerometer())
        >>> [label for label, _ in both.sensors]
        ['mag', 'acc']
    """

    def __init__(self, sensors: Sequence[tuple[str, Model]]) -> None:
        self.sensors = tuple(sensors)
        self.runs_in_python = any(model.runs_in_python for _, model in sensors)
        super().__init__(_core.concatenation([(label, model._core) for label, model in sensors]))

    def __reduce__(self) -> tuple[Any, ...]:
        return Concatenation, (self.sensors,)

    def __repr__(self) -> str:
        parts = (f"{label}={model!r}" if label else repr(model) for label, model in self.sensors)
        return f"concatenate({', '.join(parts)})"


@checked
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

    Example:
        >>> both = sepcal.concatenate(mag=sepcal.Magnetometer(), acc=sepcal.Accelerometer())
        >>> both.outputs
        ('mag.mx', 'mag.my', 'mag.mz', 'acc.ax', 'acc.ay', 'acc.az')
    """
    parts = [*(("", sensor) for sensor in sensors), *labelled.items()]
    return Concatenation([(label, as_model(sensor)) for label, sensor in parts])
