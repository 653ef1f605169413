# SPDX-License-Identifier: BSD-3-Clause
"""The models of examples/own_models.py, as a module that pickles."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

FILE = Path(__file__).parents[1] / "examples" / "own_models.py"


def _load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("example_own_models", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["example_own_models"] = module
    spec.loader.exec_module(module)
    return module


models = _load()
