# SPDX-License-Identifier: BSD-3-Clause
"""What lab/benchmarks/results/ holds: one JSON of all races, and the same as Markdown tables."""

from __future__ import annotations

import json
import platform
from pathlib import Path
from typing import Any

from benchmarks.race import Line, Result
from benchmarks.races import BASELINE, RACES
from measured import find_commit

Json = dict[str, Any]


def describe_machine() -> Json:
    """What times depend on besides the programs."""
    try:
        told = Path("/proc/cpuinfo").read_text()
    except OSError:
        told = ""
    names = [line.split(":")[1].strip() for line in told.splitlines() if "model name" in line]
    flags = next((line.split() for line in told.splitlines() if line.startswith("flags")), [])
    widest = next((name for name in ("avx512f", "avx2", "avx", "sse2") if name in flags), "")
    return {
        "processor": names[0] if names else platform.processor(),
        "instructions": widest,
        "system": platform.platform(terse=True),
    }


def merge(old: Json, new: list[Result], of: Json) -> Json:
    """The races of `new` replace those of their names; others stay as they were measured."""
    raced = {result.race for result in new}
    entries = [entry for entry in old.get("races", []) if entry["race"] not in raced]
    entries += [result.to_json() | of for result in new]
    order = [*RACES, BASELINE]
    return {"races": sorted(entries, key=lambda entry: order.index(entry["race"]))}


def result_of(entry: Json) -> Result:
    """The inverse of Result.to_json()."""
    lines = [Line(**one) for one in entry["competitors"]]
    return Result(
        entry["race"], entry["title"], entry["unit"], lines, entry["notes"], entry["facts"]
    )


def write(folder: Path, new: list[Result]) -> None:
    """latest.json, with what it has of other races, and latest.md."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "latest.json"
    old = json.loads(file.read_text()) if file.exists() else {}
    held = merge(old, new, {"commit": find_commit(), "machine": describe_machine()})
    file.write_text(json.dumps(held, indent=1) + "\n")
    tables = [result_of(entry).table() for entry in held["races"]]
    (folder / "latest.md").write_text("\n\n".join(["# Benchmark results", *tables]) + "\n")
