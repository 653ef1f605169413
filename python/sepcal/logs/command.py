# SPDX-License-Identifier: BSD-3-Clause
"""`python -m sepcal log LOG -o flight.csv [--list]`."""

from __future__ import annotations

import argparse
import json

from sepcal._core import Error
from sepcal.geomagnetism.models import warn_of_age
from sepcal.logs.flights import LoggedFlight, convert, sidecar_of, to_json
from sepcal.logs.listing import list_recording
from sepcal.logs.reading import open_log
from sepcal.logs.recording import MAGNETOMETER
from sepcal.printing import in_shell, page_of, show, tell
from sepcal.progress import show_steps
from sepcal.whole_files import refuse_outputs


def add_to(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Registers the command."""
    parser = commands.add_parser(
        "log",
        help="a flight from an autopilot's log: a ULog (PX4) or a DataFlash log (ArduPilot)",
        description="Writes the readings of one sensor, and what goes with them, as FLIGHT.csv, "
        "and beside it FLIGHT.csv.json with what was done to each column. What the autopilot had "
        "corrected is undone from its own parameters. Times are on the log's own clock.",
    )
    parser.add_argument("log", metavar="LOG", help="a .ulg, a .bin, or a .log of text")
    parser.add_argument("-o", "--output", metavar="FLIGHT.csv", help="writes the flight there")
    parser.add_argument(
        "--list",
        action="store_true",
        help="shows sensors, modes, spans and what can be calibrated, and writes nothing",
    )
    parser.add_argument(
        "--sensor", metavar="NAME", help="mag0, mag1, pitot0, ...; default: the first in the list"
    )
    parser.add_argument("--from", dest="start", metavar="S", type=float, help="rows from there on")
    parser.add_argument("--to", dest="end", metavar="S", type=float, help="rows up to there")
    parser.add_argument(
        "--date", metavar="DATE", help="of the Earth's field, where the log has none: 2026-03-01"
    )
    parser.add_argument(
        "--no-field", action="store_true", help="leaves out the columns of the Earth's field"
    )
    parser.add_argument(
        "--cut-off", action="store_true", help="takes what is whole of a log that was cut off"
    )
    parser.add_argument("--json", action="store_true", help="prints the result as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the flight or shows the list; returns 0. Raises sepcal.Error on bad input."""
    output = arguments.output
    if not arguments.list:
        if output is None:
            raise Error("nothing to do: -o FLIGHT.csv writes a flight, --list shows what is there")
        refuse_outputs((output, sidecar_of(output)), (arguments.log,))
    with show_steps("sepcal log") as report_progress:
        log = open_log(arguments.log, arguments.cut_off, report_progress)
    if arguments.list:
        contents = list_recording(log)
        show(json.dumps(contents.to_dict(), indent=2) if arguments.json else contents.text)
        return 0
    flight = convert(
        log,
        arguments.sensor,
        arguments.start,
        arguments.end,
        arguments.date,
        not arguments.no_field,
    )
    flight.save(output)
    if flight.conversion["field"] is not None and (age := warn_of_age()):
        tell(f"sepcal log: {age}")
    if arguments.json:
        show(to_json(flight.conversion))
    else:
        show(describe(flight, output, [sensor.name for sensor in log.sensors]))
    return 0


def describe(flight: LoggedFlight, output: str, sensors: list[str]) -> str:
    """Says what was written and what to do next."""
    told = flight.conversion
    sensor, span, field = told["sensor"], told["span"], told["field"]
    what = ", ".join(text for text in (sensor["kind"], sensor["title"]) if text)
    reading = next(
        told["columns"][header] for header in ("mx_ut", "dp_pa", "airspeed_mps") if header in flight
    )
    lines = [
        f"wrote {output}: {told['rows']} rows of {sensor['name']} ({what}), "
        f"{span['from_s']:.3f} to {span['to_s']:.3f} s",
        f"  readings: {reading['source']}",
    ]
    lines += [f"    {text}" for text in reading["done"]]
    lines += [f"  rows left out: {count}, {reason}" for reason, count in told["left_out"].items()]
    if told["utc"] is not None:
        lines.append(f"  first row {told['utc']['first_row']}: {told['utc']['source']}")
    if field is not None:
        parts = ",".join(f"{field[f'{name}_ut']:.4f}" for name in ("north", "east", "down"))
        lines.append(f"  field by {field['model']}: {parts} uT north, east, down at the start")
    lines += [f"  note: {note}" for note in told["notes"]]
    if others := [name for name in sensors if name != sensor["name"]]:
        lines.append(f"  also in the log: {', '.join(others)} (--sensor)")
    lines.append(f"  {sidecar_of(output)} says what was done to each column")
    return page_of((*lines, *_advise(flight, output)))


def _advise(flight: LoggedFlight, output: str) -> list[str]:
    told, output = flight.conversion, in_shell([output])
    if told["sensor"]["kind"] != MAGNETOMETER:
        return [f"next: sepcal-pitot check {output}, sepcal-pitot fit {output} -o base.json"]
    field = told["field"]
    strength = f"{field['strength_ut']:.4f}" if field is not None else "F"
    option = f"--field-strength {strength}"
    return [
        f"next: sepcal-mag check {output} {option}",
        f"      sepcal-mag fit {output} {option} -o base.json",
    ]
