# SPDX-License-Identifier: BSD-3-Clause
"""A Monte Carlo of any model beside SciPy's least squares."""

from sepcal.validation.study import Validation, validate

__all__ = ["Validation", "validate"]
