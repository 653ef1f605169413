# SPDX-License-Identifier: BSD-3-Clause
"""How large a hidden cause is to be: by what it takes of the error on rows held out.

By least squares in the model's slopes at the truth, no engine's. Rows are left out in blocks, dealt
to six folds; an effect is fitted with as many columns as its name stands for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from studies.trust.noises import Array
from studies.trust.simulator.causes import Cause
from studies.trust.simulator.instrument import Columns, Instrument, Truth

FOLDS, BLOCKS = 6, 24
STEP = 1e-5  # of differences, in SI units and uT, pressures in 1e2 Pa


@dataclass(frozen=True)
class Slopes:
    """Columns over the rows of all outputs, output after output."""

    outputs: int
    left: Array  # (N n_z,), what noise leaves at the truth
    parameters: Array  # (N n_z, p), by the model's parameters
    cause: Array  # (N n_z,), by the size of what is hidden
    effect: Array  # (N n_z, q), by the coefficients of the effect that says it

    def beside(self, others: Sequence[Slopes]) -> Slopes:
        """The same where the model has the effects of others too."""
        further = [other.effect for other in others]
        return replace(self, parameters=np.column_stack([self.parameters, *further]))

    @property
    def visibility(self) -> float:
        """The sine of the cause's angle to what the parameters do."""
        inside = np.linalg.qr(self.parameters)[0]
        outside = self.cause - inside @ (inside.T @ self.cause)
        return float(np.linalg.norm(outside) / np.linalg.norm(self.cause))

    @property
    def loudness(self) -> float:
        """The standard deviation of a cause of size one, in the output where it is the largest."""
        return float(np.max(np.std(self.cause.reshape(self.outputs, -1), axis=1)))


def take_slopes(
    instrument: Instrument, log: Columns, truth: Truth, cause: Cause, phi: Array, direction: Array
) -> Slopes:
    """At the truth, of a log in which nothing is hidden; direction is (components,), phi (N,)."""

    def by_parameter(name: str) -> Array:
        up, down = (
            instrument.predict(log, truth | {name: truth[name] + sign * STEP}, {})
            for sign in (1.0, -1.0)
        )
        return np.asarray((up - down) / (2.0 * STEP))

    def by_port(component: int) -> Array:
        size = 100.0 * STEP if cause.port == "pressure_offset" else STEP
        change = np.zeros((direction.size, phi.size))
        change[component] = size
        up, down = (
            instrument.predict(log, truth, {cause.port: sign * change}) for sign in (1.0, -1.0)
        )
        return np.asarray((up - down) / (2.0 * size))

    ports = [by_port(component) for component in range(direction.size)]
    driver = log["time_s"] if cause.driver == "time" else log[cause.driver]
    curves = cause.columns(driver, phi)
    measured = np.stack([log[header] for header in instrument.outputs], axis=-1)
    return Slopes(
        outputs=len(instrument.outputs),
        left=(measured - instrument.predict(log, truth, {})).T.ravel(),
        parameters=np.stack([by_parameter(name).T.ravel() for name in truth], axis=-1),
        cause=sum(
            (port.T * (size * phi)).ravel() for port, size in zip(ports, direction, strict=True)
        ),
        effect=np.stack([(port.T * curve).ravel() for port in ports for curve in curves], axis=-1),
    )


def size_for_share(slopes: Slopes, share: float) -> float:
    """The size at which the effect takes this share of the RMSE on rows held out.

    NaN where its columns follow the cause too badly for any size. Where the noise alone gives it as
    much whatever is hidden, the size that gives it least.
    """
    both = np.stack([slopes.left, slopes.cause], axis=-1)
    noise, hidden = _hold_out(slopes.parameters, both, slopes.outputs).T
    design = np.column_stack([slopes.parameters, slopes.effect])
    noise_after, hidden_after = _hold_out(design, both, slopes.outputs).T
    # (1 - share)^2 |noise + s hidden|^2 = |noise_after + s hidden_after|^2
    kept = (1.0 - share) ** 2
    square = kept * hidden @ hidden - hidden_after @ hidden_after
    half = kept * noise @ hidden - noise_after @ hidden_after
    rest = kept * noise @ noise - noise_after @ noise_after
    if square <= 0.0:
        return float("nan")
    return float((-half + np.sqrt(max(half**2 - square * rest, 0.0))) / square)


def _hold_out(design: Array, values: Array, outputs: int) -> Array:
    """What is left of values (N n_z, k) where each row is predicted from the other folds."""
    rows = len(design) // outputs
    fold = np.tile(np.arange(rows) * BLOCKS // rows % FOLDS, outputs)
    left = np.empty_like(values)
    for held in range(FOLDS):
        out = fold == held
        fitted = np.linalg.lstsq(design[~out], values[~out], rcond=None)[0]
        left[out] = values[out] - design[out] @ fitted
    return left
