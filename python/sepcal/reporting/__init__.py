# SPDX-License-Identifier: BSD-3-Clause
"""The report: what a calibration gets right on a flight, what it lacks, and how that was found.

One HTML page that holds all it needs, so that it opens without a network and can be mailed.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

from sepcal import _core
from sepcal.aircraft_fits import AircraftFit
from sepcal.arguments import checked
from sepcal.calibration import Calibration
from sepcal.diagnosis import Diagnosis
from sepcal.flight import AnyFlight, to_flight_of
from sepcal.progress import show_steps
from sepcal.reporting.gather import gather
from sepcal.reporting.page import build_page, read_plotly
from sepcal.reporting.sections import compose
from sepcal.reporting.trajectory import compose_flown, gather_flown
from sepcal.whole_files import name_of, write_whole

Path = str | os.PathLike[str]


@checked
def report(
    calibrations: Calibration | AircraftFit | Sequence[Calibration | AircraftFit],
    file: Path,
    flight: AnyFlight | None = None,
    *,
    diagnosis: Diagnosis | None = None,
    files: Sequence[Path] = (),
    process_noise: Mapping[str, float] | None = None,
    progress: bool | Literal["tqdm"] | Callable[[str], None] | None = None,
) -> None:
    """Writes the report of a chain of calibrations, or of fits of an aircraft, to one HTML page.

    The same input gives the same page to the last byte.

    Args:
        calibrations: One, or several of one model in the order they were made; the verdict and
            all pictures are of the last.
        file: To write; it appears whole or not at all.
        flight: To report on; by default the one that the last was fitted on.
        diagnosis: The last's diagnosis of that flight, where it is at hand; else it is made here,
            which takes most of the time.
        files: The calibrations' files, for the command that makes the page again.
        process_noise: For a flight path or an aircraft, as of AircraftFit.smooth(): with it the
            page has the states with their bands, the innovations and the smoothed noise.
        progress: A line on standard error that says what is being done, None: where that is a
            terminal, and in a notebook; "tqdm": that of tqdm.auto; or a function of a few words.

    Raises:
        Error: No calibration, several models, no flight, bad input as in Calibration.compare(),
            plotly is not installed, a file that can't be written.

    Example:
        >>> flight = sepcal.datasets.load("pitot")
        >>> base = sepcal.fit(sepcal.PitotStatic(), flight)
        >>> sepcal.report([base, base.add("wind[altitude_m]")], folder / "report.html")
        >>> (folder / "report.html").stat().st_size > 1_000_000  # Plotly is in it
        True
    """
    chain: list[Any] = (
        [calibrations] if isinstance(calibrations, Calibration | AircraftFit) else [*calibrations]
    )
    kinds = {type(each) for each in chain}
    if not kinds <= {Calibration, AircraftFit}:
        raise _core.Error("a report is of calibrations; read their files by sepcal.load(file)")
    if not chain:
        raise _core.Error("a report needs a calibration; give one or several")
    if len(kinds) > 1:
        raise _core.Error("a report is of sensors or of an aircraft; give calibrations of one kind")
    if process_noise and kinds == {Calibration}:
        raise _core.Error("process_noise is for models with a state: a flight path, an aircraft")
    plotly = read_plotly()
    if flight is not None:
        flight = to_flight_of(chain[-1].core, flight, "report(..., flight=")
    target, names = name_of(file), [name_of(at) for at in files]
    with show_steps("sepcal report", progress) as told:
        if kinds == {AircraftFit}:
            flown = gather_flown(chain, flight, names, process_noise or {}, told)
            page = compose_flown(flown, target)
        else:
            page = compose(gather(chain, flight, diagnosis, names, told), target)
        told("drawing")
        write_whole({target: build_page(page, plotly)})
