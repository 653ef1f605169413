# SPDX-License-Identifier: BSD-3-Clause
"""`python -m sepcal report FLIGHT.csv CAL.json [CAL2.json ...] -o report.html`."""

from __future__ import annotations

import argparse

from sepcal._core import Error
from sepcal.calibration import Calibration, load
from sepcal.flight import to_flight, to_flight_of
from sepcal.own_commands import add_model, read_model, read_numbers
from sepcal.printing import in_line, show
from sepcal.reporting import report
from sepcal.whole_files import refuse_outputs


def add_to(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Registers the command."""
    parser = commands.add_parser(
        "report",
        help="one self-contained HTML page: what the calibration gets right, what it lacks, why",
        description="Writes one HTML page that needs no network: the verdict, the error after "
        "every added effect, measured and modelled, where it fails, the ranked causes, the noise, "
        "the parameters, what the flight covered and what to fly next.",
    )
    parser.add_argument(
        "flight",
        metavar="FLIGHT.csv",
        help="the log to report on; of a joint fit all of them, one after the other",
    )
    parser.add_argument(
        "calibrations",
        metavar="CAL.json",
        nargs="+",
        help="a calibration, or a chain of them in the order made; the verdict is of the last",
    )
    parser.add_argument(
        "-o", "--output", metavar="REPORT.html", default="report.html", help="default: report.html"
    )
    parser.add_argument(
        "--process-noise",
        metavar="NAME=SD",
        action="append",
        default=[],
        help="of a flight path or an aircraft: root of the spectral density of a noise that drives "
        "the states; the page then has smoothed states, innovations and noise; may be repeated",
    )
    parser.add_argument(
        "--delimiter",
        metavar="MARK",
        default="",
        help="what parts the file's columns, where it can be read in two ways: ',', ';', '|', tab "
        "or space [as the fit was told]",
    )
    parser.add_argument(
        "--decimal",
        metavar="MARK",
        default="",
        help="the file's decimal mark, where it can be read in two ways: '.' or ',' [as the fit "
        "was told]",
    )
    add_model(parser, needed=False)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the page; returns 0. Raises sepcal.Error on bad input."""
    source = (arguments.model.rpartition(":")[0],) if arguments.model else ()
    refuse_outputs((arguments.output,), (arguments.flight, *arguments.calibrations, *source))
    more = [file for file in arguments.calibrations if file.endswith(".csv")]
    files = [file for file in arguments.calibrations if file not in more]
    if not files:
        raise Error(f"{more[-1]} is a log, not a calibration; give the JSON that fit wrote with -o")
    model = read_model(arguments.model) if arguments.model else None
    chain = [load(file, model=model) for file in files]
    last = chain[-1]
    told = {"delimiter": arguments.delimiter, "decimal": arguments.decimal}
    flights = [
        to_flight(file, "report(", last.core.model, told)
        if any(told.values())
        else to_flight_of(last.core, file, "report(")
        for file in (arguments.flight, *more)
    ]
    flight = flights[0]
    if isinstance(last, Calibration) and (more or last.flights):
        flight = last.join(flights)
    report(
        chain,
        arguments.output,
        flight,
        files=files,
        process_noise=read_numbers("--process-noise", arguments.process_noise, "NAME=SD, az=0.01"),
    )
    show(in_line(f"wrote {arguments.output}"))
    return 0
