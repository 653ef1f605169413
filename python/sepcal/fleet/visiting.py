# SPDX-License-Identifier: BSD-3-Clause
"""Work on a worker: one log of a fleet, read where it lies, calibrated and reduced.

A log is data: nothing in it is run. What fails is told in the answer, so that one bad log ends no
fleet; reading is tried again where a filesystem fails.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from sepcal import _core
from sepcal.calibration import Calibration, parse
from sepcal.fleet.logs import filesystem_of, is_url
from sepcal.flight import Flight, read
from sepcal.printing import in_line
from sepcal.reading import reading_for

ATTEMPTS = 4  # to read a file
PAUSE = 0.1  # s before the second attempt, twice that before the third, ...
BLOCK = 1 << 20


@dataclass(frozen=True)
class Question:
    """What one log is asked."""

    base: Calibration  # every flight is calibrated as this one was
    kind: str  # of instrument, by which a log's sensor is chosen
    own: tuple[str, ...]  # parameters of each flight alone
    name: str
    file: str
    candidates: tuple[str, ...] | None  # None: those that the flight can show
    at: Mapping[str, float] = field(default_factory=dict)  # where it is reduced
    centres: Mapping[str, float] = field(default_factory=dict)
    calibration: str = ""  # of the flight alone, JSON; empty: to be found


@dataclass(frozen=True)
class Visit:
    """A log's answer."""

    name: str
    sha256: str = ""
    error: str = ""  # why the log can't be used; the rest is then empty
    calibration: str = ""
    factor: _core.FlightFactor | None = None
    rows: int = 0
    seconds: float = 0.0  # of CPU
    bytes_read: int = 0
    means: Mapping[str, float] = field(default_factory=dict)  # of the log's channels


@contextmanager
def local_copy(file: str) -> Iterator[str]:
    """A path of the file on this machine: itself, or a copy that is removed again.

    Raises OSError where reading fails again and again.
    """
    if not is_url(file):
        yield file
        return
    system, path = filesystem_of(file)
    folder = tempfile.mkdtemp(prefix="sepcal-")
    try:
        copy = os.path.join(folder, path.rpartition("/")[2] or "log")
        system.get_file(path, copy)
        yield copy
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def digest_of(path: str) -> str:
    """SHA-256 of a file's bytes."""
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(BLOCK):
            digest.update(block)
    return digest.hexdigest()


def visit(question: Question) -> Visit:
    """Reads the log, calibrates it if that was not done, and reduces it."""
    begun = time.thread_time()
    try:
        flight, sha256, size = read_log(question.file, question.kind)
        answer = _reduce(question, flight)
    except (_core.Error, OSError, MemoryError) as error:
        reason = "memory ran out" if isinstance(error, MemoryError) else in_line(str(error))
        return Visit(question.name, error=reason, seconds=time.thread_time() - begun)
    calibration, factor = answer
    return Visit(
        question.name,
        sha256,
        "",
        calibration,
        factor,
        flight.rows,
        time.thread_time() - begun,
        size,
        channel_means(flight),
    )


def channel_means(flight: Flight) -> dict[str, float]:
    """Of each column but time, over the rows that have a number."""
    means = {}
    for header in flight:
        values = flight[header]
        known = values[np.isfinite(values)]
        if known.size and header != "time_s":
            means[header] = float(known.mean())
    return means


def read_log(file: str, kind: str) -> tuple[Flight, str, int]:
    """A log with its SHA-256 and its bytes, tried again where its filesystem fails.

    Raises Error for what is no log, OSError where reading fails again and again.
    """
    for attempt in range(ATTEMPTS):
        try:
            with local_copy(file) as path, reading_for(kind):
                return read(path), digest_of(path), os.path.getsize(path)
        except OSError:
            if attempt == ATTEMPTS - 1:
                raise
        except _core.Error as error:
            # A file that can't be opened may be there the next time; a damaged one is not tried.
            if attempt == ATTEMPTS - 1 or not isinstance(error.__cause__, OSError):
                raise
        time.sleep(PAUSE * 2**attempt)
    raise AssertionError


def _reduce(question: Question, flight: Flight) -> tuple[str, _core.FlightFactor]:
    base = question.base
    if question.calibration:
        core = parse(question.calibration, base.own_effects, base.own_model).core
    else:
        core = _core.calibrate_like(base.core, flight._core)
    candidates = question.candidates
    if candidates is None:
        candidates = tuple(_core.list_fleet_candidates(core, flight._core))
    factor = _core.reduce(
        core,
        flight._core,
        list(question.own),
        dict(question.at),
        list(candidates),
        dict(question.centres),
    )
    return core.to_json(), factor
