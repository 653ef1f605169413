# SPDX-License-Identifier: BSD-3-Clause
"""The rooms of the C++ sources: who may include whom, and how large they are.

Usage: rooms.py check [FOLDER]   every include against FOLDER/rooms.toml (cpp); 1 where one is wrong
       rooms.py count [FOLDER]   files, lines and includes of every room; the longest functions
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)
FUNCTION = re.compile(
    r"^(  )?(?!namespace|class|struct|enum|union|using|if|for|while|switch)[\w~:].*\("
)
UMBRELLA = "sepcal"  # includes every public header, in reading order


@dataclass(frozen=True)
class House:
    """The table of rooms, and where they are."""

    folder: Path
    granted: dict[str, list[str]]  # what a room's own entry names
    reach: dict[str, set[str]]  # what a room may include, itself among it
    of_public: dict[str, str]  # the room of a public header, by its name below include/sepcal

    def room_of(self, include: str) -> str | None:
        """The room of a header as it is included; None for one that isn't ours."""
        name = include.removesuffix(".hpp").removesuffix(".h")
        if name.startswith("sepcal/"):
            return self.of_public.get(name.removeprefix("sepcal/"))
        room = str(Path(name).parent)
        return room if room in self.reach else None

    def files(self) -> Iterator[tuple[Path, str | None]]:
        """Every source and header with its room; None for one that has no room."""
        public = self.folder / "include/sepcal"
        for file in sorted(public.rglob("*.hpp")):
            name = str(file.relative_to(public).with_suffix(""))
            if name != UMBRELLA:
                yield file, self.of_public.get(name)
        source = self.folder / "src"
        for file in sorted(source.rglob("*.?pp")):
            room = str(file.relative_to(source).parent)
            if room != "bindings":
                yield file, room if room in self.reach else None


def read_house(folder: Path) -> House:
    """Reads FOLDER/rooms.toml. Raises ValueError where a room may include one that isn't there."""
    table = tomllib.loads((folder / "rooms.toml").read_text())
    granted = {room: list(entry["may_include"]) for room, entry in table.items()}
    reach: dict[str, set[str]] = {}
    for room, entry in table.items():  # a room stands below those that it may include
        reach[room] = {room}
        for name in entry["may_include"]:
            if name not in reach:
                raise ValueError(
                    f"rooms.toml: {room} may include {name}, which stands not above it"
                )
            reach[room] |= reach[name]
    of_public = {name: room for room, entry in table.items() for name in entry["public"]}
    return House(folder, granted, reach, of_public)


def includes(file: Path, house: House) -> list[str]:
    """What a file includes in quotes, and of ours in angle brackets."""
    return [
        name
        for mark, name in INCLUDE.findall(file.read_text())
        if mark == '"' or name.startswith("sepcal/") or house.room_of(name)
    ]


def find_faults(house: House) -> list[str]:
    """One line for each include that goes the wrong way and each file without a room."""
    faults = []
    used: set[tuple[str, str]] = set()
    for name, room in house.of_public.items():
        if not (house.folder / "include/sepcal" / f"{name}.hpp").is_file():
            faults.append(f"rooms.toml: {room}'s public header sepcal/{name}.hpp is not there")
    for file, found in house.files():
        if found is None:
            faults.append(f"{file}: it has no room in rooms.toml")
            continue
        for include in includes(file, house):
            target = house.room_of(include)
            used.add((found, target or ""))
            if target is None:
                faults.append(f'{file}: "{include}" is in no room of rooms.toml')
            elif target not in house.reach[found]:
                faults.append(f'{file}: {found} may not include {target} ("{include}")')
    faults += [
        f"rooms.toml: {room} may include {name} and doesn't"
        for room, names in house.granted.items()
        for name in names
        if (room, name) not in used
    ]
    return faults


def count(house: House) -> str:
    """A table of the rooms in Markdown."""
    files: Counter[str] = Counter()
    lines: Counter[str] = Counter()
    crossing: Counter[str] = Counter()
    for file, found in house.files():
        name = found or "-"
        files[name] += 1
        lines[name] += len(file.read_text().splitlines())
        rooms = [house.room_of(include) for include in includes(file, house)]
        crossing[name] += sum(target != found for target in rooms)
    public = Counter(house.of_public.values())
    rows = [
        f"| {room} | {files[room]} | {lines[room]} | {crossing[room]} | {public[room]} |"
        for room in [*house.reach, *(files.keys() - house.reach.keys())]
    ]
    total = f"| all | {files.total()} | {lines.total()} | {crossing.total()} | {public.total()} |"
    head = (
        "| room | files | lines | includes of other rooms | public headers |\n|---|---|---|---|---|"
    )
    return "\n".join([head, *rows, total])


def functions(file: Path) -> Iterator[tuple[int, str]]:
    """The functions of a formatted source: how many lines each has, and its first line."""
    lines = file.read_text().splitlines()
    for indent in ("", "  "):  # of a file, and of a class
        first = None
        for at, line in enumerate(lines):
            if first is None and FUNCTION.match(line) and not line.startswith(indent + " "):
                first = at
            elif first is not None and line == f"{indent}}}":
                yield at - first + 1, lines[first].strip()
                first = None
            if first is not None and line.endswith(";") and not line.startswith(indent + " "):
                first = None  # a declaration


def longest_functions(house: House, most: int = 5) -> str:
    """A list in Markdown."""
    found = [(*entry, file) for file, _ in house.files() for entry in functions(file)]
    found.sort(key=lambda entry: -entry[0])
    return "\n".join(f"- {length} lines, {file}: `{line}`" for length, line, file in found[:most])


def main(verb: str, folder: Path) -> int:
    """Prints what the verb asks for."""
    house = read_house(folder)
    if verb == "count":
        print(count(house))
        print(f"\nThe longest functions:\n\n{longest_functions(house)}")
        return 0
    faults = find_faults(house)
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or sys.argv[1] not in ("check", "count"):
        sys.exit((__doc__ or "").strip())
    sys.exit(main(sys.argv[1], Path(sys.argv[2] if len(sys.argv) == 3 else "cpp")))
