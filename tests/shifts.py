# SPDX-License-Identifier: BSD-3-Clause
"""How far estimates move where nothing should move them."""

from collections.abc import Mapping

import sepcal


def largest_shift(first: sepcal.Fit, second: sepcal.Fit, expected: Mapping[str, float]) -> float:
    """The largest difference of a parameter from what is expected, in standard errors.

    Those that `expected` doesn't name are expected to stay.
    """
    assert first.status == second.status
    return max(
        abs(second[name].value - expected.get(name, parameter.value)) / parameter.standard_error
        for name, parameter in first.parameters.items()
        if parameter.standard_error > 0
    )
