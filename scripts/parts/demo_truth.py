# SPDX-License-Identifier: BSD-3-Clause
"""Puts what the simulator put into a flight beside two calibrations of it.

Usage: demo_truth.py FOLDER, with truth.json, base.json and better.json in it.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

Json = dict[str, Any]


def read(file: Path) -> Json:
    """A JSON object."""
    content: Json = json.loads(file.read_text())
    return content


def main(folder: Path) -> None:
    """One line a parameter: the truth, and by how much each calibration is off."""
    truth = read(folder / "truth.json")["parameters"]
    base = read(folder / "base.json")["parameters"]
    better = read(folder / "better.json")["parameters"]
    width = max(len(name) for name in better)
    print(f"{'parameter':<{width}}  {'unit':<9}{'truth':>10}{'before':>11}{'after':>11}  off by")
    for name, entry in better.items():
        before = f"{base[name]['value']:.5f}" if name in base else "-"
        off = abs(entry["value"] - truth[name]) / entry["standard_error"]
        print(
            f"{name:<{width}}  {entry['unit']:<9}{truth[name]:>10.5f}{before:>11}"
            f"{entry['value']:>11.5f}  {off:.1f} standard errors"
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
