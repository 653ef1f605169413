# SPDX-License-Identifier: BSD-3-Clause
"""What of each room's code was run, from clang's counters.

Usage: room_coverage.py table FOLDER       lines and branches a room; 1 where one has under 90 % of
                                           its lines run
       room_coverage.py lines FOLDER ROOM  the lines of a room that nothing ran, file by file

FOLDER holds lines.info (lcov's form) and branches.json, as scripts/coverage writes them. A line
counts where clang maps code to it, a branch is one outcome of a condition; of a template all
instances count as one.
"""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rooms import House, read_house

LEAST = 90.0  # percent of lines
ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Room:
    """Counts of one room's code."""

    lines: dict[str, dict[int, int]] = field(default_factory=dict)  # by file and line
    branches: dict[tuple[str, tuple[int, ...]], list[int]] = field(default_factory=dict)

    @property
    def counted(self) -> list[int]:
        """How often each line ran."""
        return [count for file in self.lines.values() for count in file.values()]

    @property
    def outcomes(self) -> list[int]:
        """How often each outcome of a condition came."""
        return [count for pair in self.branches.values() for count in pair]


def room_of(file: Path, house: House) -> str | None:
    """The room that a source belongs to; None for one that isn't counted."""
    try:
        inside = file.resolve().relative_to(ROOT)
    except ValueError:
        return None
    if inside.parts[0] == "apps":
        return "apps"
    if inside.parts[:3] == ("cpp", "src", "bindings"):
        return "bindings"
    if inside.parts[:2] == ("cpp", "src"):
        return house.room_of(str(inside.relative_to("cpp/src")))
    if inside.parts[:2] == ("cpp", "include"):
        return house.room_of(str(inside.relative_to("cpp/include")))
    return None


def read_lines(text: Iterable[str]) -> dict[str, dict[int, int]]:
    """{file: {line: how often it ran}} of lcov's form."""
    files: dict[str, dict[int, int]] = {}
    lines: dict[int, int] = {}
    for entry in text:
        kind, _, rest = entry.strip().partition(":")
        if kind == "SF":
            lines = files.setdefault(rest, {})
        elif kind == "DA":
            line, count = map(int, rest.split(",")[:2])
            lines[line] = lines.get(line, 0) + count
    return files


def read_branches(counted: dict[str, Any]) -> dict[str, dict[tuple[int, ...], list[int]]]:
    """{file: {where its condition stands: [times true, times false]}} of llvm-cov's JSON."""
    files: dict[str, dict[tuple[int, ...], list[int]]] = {}
    for file in counted["data"][0]["files"]:
        found: dict[tuple[int, ...], list[int]] = defaultdict(lambda: [0, 0])
        for branch in file["branches"]:
            outcome = found[tuple(branch[:4])]
            outcome[0] += branch[4]
            outcome[1] += branch[5]
        files[file["filename"]] = dict(found)
    return files


def read_rooms(folder: Path) -> dict[str, Room]:
    """Each room's counts."""
    house = read_house(ROOT / "cpp")
    rooms: dict[str, Room] = {name: Room() for name in [*house.reach, "bindings", "apps"]}
    with (folder / "lines.info").open() as text:
        for file, lines in read_lines(text).items():
            if (name := room_of(Path(file), house)) is not None:
                rooms[name].lines[file] = lines
    for file, branches in read_branches(json.loads((folder / "branches.json").read_text())).items():
        if (name := room_of(Path(file), house)) is not None:
            rooms[name].branches |= {(file, where): pair for where, pair in branches.items()}
    return {name: room for name, room in rooms.items() if room.lines}


def percent(counts: list[int]) -> float:
    """Of the counts, those that are not nought."""
    return 100.0 * sum(count > 0 for count in counts) / len(counts) if counts else 100.0


def table(rooms: dict[str, Room]) -> str:
    """In Markdown, the room with the least first."""
    rows = [
        f"| {name} | {len(room.counted)} | {percent(room.counted):.1f} | {len(room.outcomes)} "
        f"| {percent(room.outcomes):.1f} |"
        for name, room in sorted(rooms.items(), key=lambda entry: percent(entry[1].counted))
    ]
    lines = [count for room in rooms.values() for count in room.counted]
    outcomes = [count for room in rooms.values() for count in room.outcomes]
    rows.append(
        f"| all | {len(lines)} | {percent(lines):.1f} | {len(outcomes)} | {percent(outcomes):.1f} |"
    )
    head = "| room | lines | run [%] | branches | taken [%] |\n|---|---|---|---|---|"
    return "\n".join([head, *rows])


def spans(numbers: list[int]) -> str:
    """Of rising numbers: 3, 5-7."""
    runs: list[tuple[int, int]] = []
    for number in numbers:
        first = number
        if runs and runs[-1][1] == number - 1:
            first = runs.pop()[0]
        runs.append((first, number))
    return ", ".join(f"{first}-{last}" if last > first else f"{first}" for first, last in runs)


def unrun(room: Room) -> str:
    """The lines that nothing ran, the file with the most first."""
    left = {
        file: sorted(line for line, count in lines.items() if count == 0)
        for file, lines in room.lines.items()
    }
    return "\n".join(
        f"{Path(file).resolve().relative_to(ROOT)}: {spans(lines)}"
        for file, lines in sorted(left.items(), key=lambda entry: -len(entry[1]))
        if lines
    )


def main(arguments: list[str]) -> int:
    """Prints what is asked for."""
    if len(arguments) == 2 and arguments[0] == "table":
        rooms = read_rooms(Path(arguments[1]))
        print(table(rooms))
        low = [name for name, room in rooms.items() if percent(room.counted) < LEAST]
        if low:
            print(f"below {LEAST:.0f} % of lines: {', '.join(low)}", file=sys.stderr)
        return int(bool(low))
    if len(arguments) == 3 and arguments[0] == "lines":
        rooms = read_rooms(Path(arguments[1]))
        if arguments[2] not in rooms:
            sys.exit(f"no room {arguments[2]}; there are {', '.join(rooms)}")
        print(unrun(rooms[arguments[2]]))
        return 0
    sys.exit((__doc__ or "").strip())


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
