# SPDX-License-Identifier: BSD-3-Clause
"""Runs clang-tidy over cpp/ and apps/, one file a core; a file that passed is not looked at again.

Usage: tidy.py BUILD, a build folder with compile_commands.json. A file's stamp is the hash of all
that its verdict depends on: itself, the project's headers it includes, its command, .clang-tidy.
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


def check(entry: dict[str, str], build: Path, version: bytes) -> bool:
    """Runs clang-tidy on one file unless its stamp says that it passed; prints what it finds."""
    source = Path(entry["file"])
    stamp = build / "clang-tidy" / (str(source.relative_to(ROOT)).replace("/", "_") + ".passed")
    hashed = fingerprint(entry, version)
    if stamp.is_file() and stamp.read_text() == hashed:
        return True
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
    stamp.parent.mkdir(exist_ok=True)
    stamp.write_text(hashed)
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
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        passed = list(pool.map(lambda entry: check(entry, build, version), entries))
    if not all(passed):
        print(f"clang-tidy: {passed.count(False)} of {len(passed)} files", file=sys.stderr)
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main())
