# SPDX-License-Identifier: BSD-3-Clause
"""Are two calibrations the same? Estimates within 1e-9 of their standard errors, and the cost.

scripts/parts/same_fit.py ONE.json OTHER.json; exit code 1 where they are not.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

MOST = 1e-9


def main(one: str, other: str) -> int:
    """Prints the largest difference."""
    fits: list[dict[str, Any]] = [json.loads(Path(file).read_text()) for file in (one, other)]
    first, second = (fit["parameters"] for fit in fits)
    if list(first) != list(second):
        print(f"{one} and {other} don't have the same parameters")
        return 1
    off = {
        name: abs(first[name]["value"] - second[name]["value"]) / first[name]["standard_error"]
        for name in first
        if first[name]["standard_error"]
    }
    off["the cost"] = abs(fits[0]["cost"] / fits[1]["cost"] - 1.0)
    worst = max(off, key=lambda name: off[name])
    print(f"{len(off)} numbers agree within {off[worst]:.1e} ({worst}); allowed is {MOST:.0e}")
    return 0 if len(off) > 1 and all(value < MOST for value in off.values()) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
