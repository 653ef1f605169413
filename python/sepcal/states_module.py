# SPDX-License-Identifier: BSD-3-Clause
"""Loads the compiled module of models with a state and of the aircraft when it is needed."""

from __future__ import annotations

from types import ModuleType

from sepcal.arguments import NotInstalled


def states_module() -> ModuleType:
    """sepcal._states. Raises Error where the build left it out, as one for sensors alone."""
    try:
        from sepcal import _states
    except ImportError as error:
        raise NotInstalled(
            "this sepcal was built for sensors alone, without filters, models with a state and "
            "aircraft; build all of it: cmake --build build"
        ) from error
    return _states
