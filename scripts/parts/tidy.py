# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy over cpp/ and apps/, one file a core; a file that passed is not looked at again.

Usage: tidy.py BUILD [MOST], a build folder with compile_commands.json. A file's stamp is the hash
of all that its verdict depends on: itself, the project's headers it includes, its command,
.clang-tidy. With MOST it looks at so many files without a stamp, those that changed last by git,
and at others of them for another HEAD, so that in time it comes to all. 0 is no limit.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADER_FOLDERS = [ROOT / "cpp" / "include", ROOT / "cpp" / "src", ROOT / "apps"]
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.MULTILINE)


def project_headers(source: Path, seen: set[Path]) -> set[Path]:
    """Adds to `seen` the project's own headers that `source` includes, directly or not."""
    for name in INCLUDE.findall(source.read_text()):
        for folder in [source.parent, *HEADER_FOLDERS]:
            header = folder / name
            if header.is_file() and header not in seen:
                seen.add(header)
                project_headers(header, seen)
    return seen


def fingerprint(entry: dict[str, str], version: bytes) -> str:
    """Hash of everything that clang-tidy's verdict on one compile command depends on."""
    source = Path(entry["file"])
    digest = hashlib.sha256(version + entry["command"].encode())
    for path in [ROOT / ".clang-tidy", source, *sorted(project_headers(source, set()))]:
        digest.update(path.read_bytes())
    return digest.hexdigest()


def stamp_of(entry: dict[str, str], build: Path) -> Path:
    """Where the hash stands with which a file passed."""
    name = str(Path(entry["file"]).relative_to(ROOT)).replace("/", "_") + ".passed"
    return build / "clang-tidy" / name


def has_passed(entry: dict[str, str], build: Path, version: bytes) -> bool:
    """Whether clang-tidy has passed the file as it stands."""
    stamp = stamp_of(entry, build)
    return stamp.is_file() and stamp.read_text() == fingerprint(entry, version)


def git(*arguments: str) -> list[str]:
    """Lines of what git prints; none outside a repository."""
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True)
    return done.stdout.splitlines()


def newest_first(entries: list[dict[str, str]]) -> list[dict[str, str]]:
    """The files as they last changed: uncommitted ones, then commit by commit.

    What one commit changed, and what a changed header alone concerns, is in an order that every
    HEAD mixes anew.
    """
    changed = dict.fromkeys(git("diff", "--name-only", "HEAD", "--", "cpp", "apps"), -1)
    commit = 0
    for line in git("log", "--format=tformat:commit", "--name-only", "--", "cpp", "apps"):
        commit += line == "commit"
        changed.setdefault(line, commit)
    head = "".join(git("rev-parse", "HEAD"))

    def age(entry: dict[str, str]) -> tuple[int, str]:
        name = str(Path(entry["file"]).relative_to(ROOT))
        return changed.get(name, -1), hashlib.sha256((head + name).encode()).hexdigest()

    return sorted(entries, key=age)


def check(entry: dict[str, str], build: Path, version: bytes) -> bool:
    """Runs clang-tidy on one file and stamps it where it passes; prints what it finds."""
    source = Path(entry["file"])
    # The compiler is g++: its options that clang lacks, and its library's own warnings, are noise.
    extra = ["--extra-arg=-Wno-unknown-warning-option", "--extra-arg=-Wno-deprecated-declarations"]
    result = subprocess.run(
        ["clang-tidy", "-p", str(build), "--quiet", *extra, str(source)],
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode != 0:
        print(result.stdout, result.stderr if not result.stdout else "", sep="", flush=True)
        return False
    stamp = stamp_of(entry, build)
    stamp.parent.mkdir(exist_ok=True)
    stamp.write_text(fingerprint(entry, version))
    return True


def main() -> int:
    """Returns 0 where every file passes, else 1."""
    build = Path(sys.argv[1]).resolve()
    database = build / "compile_commands.json"
    if not database.is_file():
        print(f"{database} is missing; run scripts/setup first", file=sys.stderr)
        return 1
    entries = [
        entry
        for entry in json.loads(database.read_text())
        if Path(entry["file"]).is_relative_to(ROOT / "cpp")
        or Path(entry["file"]).is_relative_to(ROOT / "apps")
    ]
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    waiting = newest_first([one for one in entries if not has_passed(one, build, version)])
    looked_at = waiting[: int(sys.argv[2]) or None] if len(sys.argv) > 2 else waiting
    if len(looked_at) < len(waiting):
        print(f"clang-tidy: {len(looked_at)} of {len(waiting)} files that changed", flush=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        passed = list(pool.map(lambda entry: check(entry, build, version), looked_at))
    if not all(passed):
        print(f"clang-tidy: {passed.count(False)} of {len(passed)} files", file=sys.stderr)
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main())
