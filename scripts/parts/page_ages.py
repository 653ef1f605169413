# SPDX-License-Identifier: BSD-3-Clause
"""How old the measured pages of docs/ are: commits to what they measured, since they measured it.

Usage: page_ages.py [--most N] [CHECKOUT]

A measured page has a line of one of these two forms. Of the second the page is as old as the
oldest of the commits that stand in backquotes anywhere in it.

    Measured at commit `0123abc`; rooms: diagnosis, effects, lab/studies/hidden_effects.
    Measured at the commits below; rooms: estimation, lab/benchmarks.

A room is one of cpp/rooms.toml, with its public headers, or else a file or folder. Merges don't
count. With --most: exit code 1 where a page is older than N commits, or its age can't be known.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from rooms import House, read_house

LINE = re.compile(
    r"^Measured at (?:commit `(?P<commit>[^`]+)`|the commits below); rooms: (?P<rooms>.+)\.$", re.M
)
BEGINNING = re.compile(r"^Measured at (commit|the commits)\b", re.M)
COMMIT = re.compile(r"`([0-9a-f]{7,40}(?:-dirty)?)`")


class PageError(Exception):
    """A page whose line can't be read."""


@dataclass(frozen=True)
class Page:
    """A measured page."""

    file: Path
    commits: tuple[str, ...]
    rooms: tuple[str, ...]


@dataclass(frozen=True)
class Age:
    """How old a page is, and by which commit; `commits` is None where that can't be known."""

    page: Page
    commit: str
    commits: int | None
    why: str = ""

    def exceeds(self, most: int) -> bool:
        """Whether the page is too old."""
        return self.commits is None or self.commits > most


def read_page(file: Path) -> Page | None:
    """None for a page that isn't measured."""
    text = file.read_text(encoding="utf-8")
    found = LINE.search(text)
    if found is None:
        if BEGINNING.search(text):
            raise PageError(f'{file}: the line "Measured at ..." is not of the form that is asked')
        return None
    commits = (found["commit"],) if found["commit"] else tuple(dict.fromkeys(COMMIT.findall(text)))
    if not commits:
        raise PageError(f'{file}: "Measured at the commits below", and no `commit` is below')
    return Page(file, commits, tuple(room.strip(" `") for room in found["rooms"].split(",")))


def paths_of(page: Page, house: House, root: Path) -> list[str]:
    """Files and folders of the page's rooms."""
    paths = []
    for room in page.rooms:
        if room in house.reach:
            paths.append(f"cpp/src/{room}")
            headers = (name for name, owner in house.of_public.items() if owner == room)
            paths += [f"cpp/include/sepcal/{name}.hpp" for name in headers]
        elif (root / room).exists():
            paths.append(room)
        else:
            raise PageError(f"{page.file}: {room} is neither a room nor a folder")
    return paths


def ask_git(root: Path, *arguments: str) -> str | None:
    """What git prints; None where it fails."""
    asked = subprocess.run(
        ["git", *arguments], cwd=root, capture_output=True, text=True, check=False
    )
    return asked.stdout.strip() if asked.returncode == 0 else None


def find_age(page: Page, house: House, root: Path) -> Age:
    """Of the oldest of its commits; what can't be known is older than all."""
    paths = paths_of(page, house, root)
    oldest = Age(page, page.commits[0], 0)
    for commit in page.commits:
        if commit.endswith("-dirty"):
            return Age(page, commit, None, "the sources differed from their commit")
        if ask_git(root, "merge-base", "--is-ancestor", commit, "HEAD") is None:
            return Age(page, commit, None, "this history has no such commit")
        since = ("rev-list", "--count", "--no-merges", f"{commit}..HEAD", "--", *paths)
        count = int(ask_git(root, *since) or 0)
        if count >= (oldest.commits or 0):
            oldest = Age(page, commit, count)
    return oldest


def find_ages(root: Path) -> list[Age]:
    """Of all measured pages below docs/, by name."""
    house = read_house(root / "cpp")
    pages = [read_page(file) for file in sorted((root / "docs").rglob("*.md"))]
    return [find_age(page, house, root) for page in pages if page is not None]


def describe(age: Age, root: Path) -> str:
    """A line."""
    name = str(age.page.file.relative_to(root))
    told = f"unknown: {age.why}" if age.commits is None else f"{age.commits} commits"
    return f"{name:<26} {age.commit:<10} {told}"


def main() -> int:
    """Prints a line a page."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--most", type=int, metavar="N", help="commits that a page may be old")
    root_of_this = Path(__file__).resolve().parents[2]
    parser.add_argument("checkout", metavar="CHECKOUT", nargs="?", type=Path, default=root_of_this)
    chosen = parser.parse_args()
    try:
        ages = find_ages(chosen.checkout)
    except PageError as error:
        print(f"page_ages.py: {error}", file=sys.stderr)
        return 2
    for age in ages:
        print(describe(age, chosen.checkout))
    return int(chosen.most is not None and any(age.exceeds(chosen.most) for age in ages))


if __name__ == "__main__":
    sys.exit(main())
