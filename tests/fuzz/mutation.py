# SPDX-License-Identifier: BSD-3-Clause
"""A fuzzer without coverage: seeds, mutations of them, and what was new about an answer.

A target takes bytes and returns what kind of answer they got; bytes with an answer of a new kind
are mutated further. What the target raises is a finding, and so are 10 s of work for one input and
more memory than the limit: the input is kept and the exit status is 1.

    FUZZER.py SECONDS KEPT FINDINGS [SEED_FOLDER]...
    FUZZER.py FILE...        those inputs alone
"""

from __future__ import annotations

import collections
import contextlib
import faulthandler
import hashlib
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Hashable, Iterator, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # tests

from hostile import PIECES, find_unprintable

Target = Callable[[bytes], Hashable]

LONGEST = 10  # s for one input
LARGEST = 2 * 2**30  # bytes that the process may take
BETWEEN = b"\xfe\xfe"  # words of an input; no UTF-8 has it
TOKENS = [piece.encode("utf-8", "surrogatepass") for piece in PIECES] + [
    b"\xff", b"\x80", b"\xed\xa0\x80", b"\xc3", b"\xf0\x9f", b"\x00\x00\x00\x00",
    b"\xff\xff\xff\xff", b"\x7f\xff", b"\x00\x80", b"nan", b"inf", b"-1", b"1e308", b"5e-324",
    BETWEEN,
]  # fmt: skip


class TooSlow(Exception):
    """One input took longer than LONGEST."""


def mutate(data: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    """One to five small changes, in the way of bytes that were damaged or forged."""
    changed = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 3, 5))):
        at = draw.randrange(len(changed) + 1)
        end = min(len(changed), at + draw.choice((1, 2, 4, 8, 64)))
        match draw.randrange(8):
            case 0:
                changed[at:at] = draw.choice(TOKENS)
            case 1:
                changed[at:end] = draw.choice(TOKENS)
            case 2:
                del changed[at:end]
            case 3:
                changed[at:at] = changed[at:end] * draw.choice((1, 2, 20))
            case 4:
                changed[at:end] = draw.randbytes(end - at)
            case 5:
                for k in range(at, end):
                    changed[k] ^= 1 << draw.randrange(8)
            case 6:
                other = draw.choice(others)
                start = draw.randrange(len(other) + 1)
                changed[at:end] = other[start : start + draw.choice((4, 16, 256))]
            case _:
                token = draw.choice(TOKENS)  # of as many bytes, so that lengths still hold
                changed[at : at + len(token)] = token[: len(changed) - at]
    return bytes(changed)


def words_of(data: bytes, count: int) -> list[str]:
    """So many words; now and then bytes that are no UTF-8 are as in Python's names of files."""
    errors = "surrogateescape" if len(data) % 8 == 1 else "ignore"
    words = [word.decode("utf-8", errors) for word in data.split(BETWEEN)]
    return [words[k] if k < len(words) else "" for k in range(count)]


def input_of(words: Sequence[str]) -> bytes:
    """The bytes that words_of() takes apart."""
    return BETWEEN.join(word.encode("utf-8", "surrogateescape") for word in words)


def check_printed(page: str) -> None:
    """Nothing in it steers a terminal."""
    assert find_unprintable(page) == [], page


def check_message(message: str) -> str:
    """One line that says something; returns its kind, the message without names and numbers."""
    assert message.strip(), "a message says something"
    assert "\n" not in message, message
    check_printed(message)
    return " ".join(re.findall(r"\b[a-z]{3,12}\b", re.sub("'.*'", "", message))[-4:])


@contextlib.contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raises TooSlow after so many seconds of this process' own work, other processes' aside."""

    def stop(*_: object) -> None:
        raise TooSlow

    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def read_folder(folder: Path) -> list[bytes]:
    return [file.read_bytes() for file in sorted(folder.iterdir())] if folder.is_dir() else []


class Fuzzer:
    """A run of a target."""

    def __init__(self, target: Target, findings: Path) -> None:
        self.target = target
        self.findings = findings
        self.kinds: collections.Counter[Hashable] = collections.Counter()
        self.tried = 0

    def try_(self, data: bytes) -> bool:
        """Whether the answer was of a new kind. Ends the process at a finding."""
        self.tried += 1
        at_work = self.findings / "at_work"
        at_work.write_bytes(data)  # stays where the interpreter itself dies
        try:
            with limited(LONGEST):
                kind = self.target(data)
        except (Exception, SystemExit):
            traceback.print_exc()
            name = self.findings / f"finding-{hashlib.sha256(data).hexdigest()[:16]}"
            at_work.rename(name)
            print(f"a finding after {self.tried} inputs; the input is {name}", file=sys.stderr)
            sys.exit(1)
        is_new = kind not in self.kinds
        self.kinds[kind] += 1
        return is_new

    def run(self, seeds: list[bytes], kept: Path, seconds: float, draw: random.Random) -> None:
        """Seeds, then mutations until the time is up, which a slow target's seeds may take."""
        end = time.monotonic() + seconds
        known = set(seeds)
        for seed in seeds:
            if time.monotonic() < end:
                self.try_(seed)
        while time.monotonic() < end:
            data = mutate(draw.choice(seeds), seeds, draw)
            if self.try_(data) and data not in known:
                seeds.append(data)
                known.add(data)
                (kept / hashlib.sha256(data).hexdigest()[:16]).write_bytes(data)
        (self.findings / "at_work").unlink(missing_ok=True)


def main(target: Target, seeds: Sequence[bytes] = ()) -> None:
    """Runs what the command line asks for. `seeds` join those of the folders."""
    faulthandler.enable()
    resource.setrlimit(resource.RLIMIT_AS, (LARGEST, resource.RLIM_INFINITY))
    first, *rest = sys.argv[1:]
    if not first.isdigit():
        for file in (first, *rest):
            print(f"{file}: {target(Path(file).read_bytes())}")
        return
    kept, findings, *folders = map(Path, rest)
    for folder in (kept, findings):
        folder.mkdir(parents=True, exist_ok=True)
    number = int.from_bytes(os.urandom(4), "little")
    print(f"seed {number}")
    inputs = [*(data for folder in folders for data in read_folder(folder)), *seeds]
    inputs += read_folder(kept)
    fuzzer = Fuzzer(target, findings)
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        fuzzer.run(inputs, kept, int(first), random.Random(number))
        os.chdir("/")
    for kind, count in fuzzer.kinds.most_common():
        print(f"{count:8} {kind}")
    print(f"stat::number_of_executed_units: {fuzzer.tried}")
