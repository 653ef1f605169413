# SPDX-License-Identifier: BSD-3-Clause
"""Libraries that single forms need: loaded when such a file is read, and named where missing."""

from __future__ import annotations

import importlib
from typing import Any

from sepcal import _core


def load(module: str, file: str, form: str) -> Any:  # noqa: ANN401  # of libraries without types
    """The module. Raises Error, which names the extra of sepcal that brings it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        library = module.partition(".")[0]
        raise _core.Error(
            f"{file}: {form} needs {library}, which is not installed: pip install sepcal[files]"
        ) from error
