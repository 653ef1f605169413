# SPDX-License-Identifier: BSD-3-Clause
"""The report: what a calibration gets right on a flight, what it lacks, and how that was found.

One HTML page that holds all it needs, so that it opens without a network and can be mailed.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from sepcal import _core
from sepcal.calibration import Calibration
from sepcal.diagnosis import Diagnosis
from sepcal.flight import Flight
from sepcal.reporting.gather import gather
from sepcal.reporting.page import build_page, read_plotly, write_whole
from sepcal.reporting.sections import compose

Path = str | os.PathLike[str]


def report(
    calibrations: Calibration | Sequence[Calibration],
    file: Path,
    flight: Flight | None = None,
    *,
    diagnosis: Diagnosis | None = None,
    files: Sequence[Path] = (),
    progress: Callable[[str], None] | None = None,
) -> None:
    """Writes the report of a chain of calibrations to one self-contained HTML page.

    The same input gives the same page to the last byte.

    Args:
        calibrations: One, or several of one model in the order they were made; the verdict and
            all pictures are of the last.
        file: To write; it appears whole or not at all.
        flight: To report on; by default the one that the last was fitted on.
        diagnosis: The last's diagnosis of that flight, where it is at hand; else it is made here,
            which takes most of the time.
        files: The calibrations' files, for the command that makes the page again.
        progress: Is told what is being done, a few words a step.

    Raises:
        Error: No calibration, several models, no flight, bad input as in Calibration.compare(),
            plotly is not installed, a file that can't be written.
    """
    chain = [calibrations] if isinstance(calibrations, Calibration) else list(calibrations)
    if not all(isinstance(one, Calibration) for one in chain):
        raise _core.Error("a report is of calibrations; read their files by sepcal.load(file)")
    if not chain:
        raise _core.Error("a report needs a calibration; give one or several")
    plotly = read_plotly()
    report_progress = progress or (lambda _: None)
    material = gather(chain, flight, diagnosis, [os.fspath(at) for at in files], report_progress)
    report_progress("drawing")
    write_whole(os.fspath(file), build_page(compose(material, os.fspath(file)), plotly))
