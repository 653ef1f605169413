# SPDX-License-Identifier: BSD-3-Clause
"""Standard errors by leaving blocks of a record out and fitting the others with SciPy.

It shares no line with the engine: the models are those of the oracle, the fits are real ones.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from oracle.model import Array, Model, Record


def delete_a_block(
    model: Model, record: Record, readings: Array, start: Array, free: Sequence[int], blocks: int
) -> Array:
    """Standard error of each of the parameters `free`; `readings` is (outputs, N)."""
    rows = np.arange(readings.shape[1])
    chosen = list(free)

    def fit(kept: Array, begin: Array) -> Array:
        part = {name: values[kept] for name, values in record.items()}

        def whole(xi: Array) -> Array:
            values = np.array(start)
            values[chosen] = xi
            return values

        found = least_squares(
            lambda xi: (readings[:, kept] - model.predict(part, whole(xi))).ravel(),
            begin,
            lambda xi: -model.jacobian(part, whole(xi)).reshape(-1, start.size)[:, chosen],
            x_scale="jac",
            xtol=1e-10,
        )
        return np.asarray(found.x)

    everything = fit(rows, start[chosen])
    parts = np.array(
        [fit(np.setdiff1d(rows, block), everything) for block in np.array_split(rows, blocks)]
    )
    steps = parts - parts.mean(axis=0)
    return np.asarray(np.sqrt((blocks - 1) / blocks * np.sum(steps**2, axis=0)))
