# SPDX-License-Identifier: BSD-3-Clause
"""The line of a measured page that names its commit. scripts/parts/page_ages.py reads it."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[1]


def find_commit() -> str:
    """What is measured; "-dirty" where sources differ from it."""

    def ask(*arguments: str) -> str:
        asked = subprocess.run(
            ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False
        )
        return asked.stdout.strip()

    written = (":!docs", ":!lab/benchmarks/results")  # by what is measuring
    changed = ask("status", "--porcelain", "--untracked-files=no", "--", ".", *written)
    return ask("describe", "--always", "--exclude=*") + ("-dirty" if changed else "")


def measured_line(rooms: Iterable[str]) -> str:
    """The line of a page that is measured now: rooms of cpp/rooms.toml, or folders."""
    return f"Measured at commit `{find_commit()}`; rooms: {', '.join(rooms)}."


def renew_line(page: str) -> str:
    """The page with its line renewed. Raises ValueError where it has none or several."""
    renewed, count = re.subn(
        r"^Measured at commit `[\w-]+`;", f"Measured at commit `{find_commit()}`;", page, flags=re.M
    )
    if count != 1:
        raise ValueError(f'the page has {count} lines that begin "Measured at commit", not one')
    return renewed
