# SPDX-License-Identifier: BSD-3-Clause
"""The native programs of an installed sepcal: sepcal-aircraft, sepcal-mag, sepcal-pitot."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import NoReturn

FOLDER = Path(__file__).parent / "bin"


def run() -> NoReturn:
    """Becomes the program that this command is named after, with its arguments."""
    name = Path(sys.argv[0]).stem
    program = FOLDER / name
    try:
        os.execv(program, [name, *sys.argv[1:]])
    except OSError as refusal:
        sys.exit(f"{name}: {program} can't be run ({refusal.strerror}); install sepcal anew")
