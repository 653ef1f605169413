# SPDX-License-Identifier: BSD-3-Clause
"""`python -m sepcal field --lat DEG --lon DEG --altitude M --date 2026-03-01`."""

from __future__ import annotations

import argparse
import dataclasses
import json

from sepcal.geomagnetism.models import EarthField, earth_field, warn_of_age
from sepcal.printing import show, tell


def add_to(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Registers the command."""
    parser = commands.add_parser(
        "field",
        help="the Earth's magnetic field at a place on a day, for --field and --field-strength",
        description="Prints the Earth's magnetic field by the World Magnetic Model (pygeomag) as "
        "sepcal-mag takes it. Models span 2010 to five years after the newest; another day is "
        "refused.",
    )
    parser.add_argument("--lat", metavar="DEG", type=float, required=True, help="north positive")
    parser.add_argument("--lon", metavar="DEG", type=float, required=True, help="east positive")
    parser.add_argument(
        "--altitude", metavar="M", type=float, default=0.0, help="above the sea [m]; default: 0"
    )
    parser.add_argument(
        "--date", metavar="DATE", required=True, help="2026-03-01, or a decimal year"
    )
    parser.add_argument("--json", action="store_true", help="prints the result as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Prints the field; returns 0. Raises sepcal.Error on bad input."""
    field = earth_field(arguments.lat, arguments.lon, arguments.altitude, arguments.date)
    if age := warn_of_age():
        tell(f"sepcal field: {age}")
    show(to_json(field) if arguments.json else describe(field))
    return 0


def describe(field: EarthField) -> str:
    """The page, whose last two lines are to be pasted."""
    place = f"{describe_place(field.latitude, field.longitude)}, {field.altitude:g} m"
    return (
        f"{field.model} at {place}, year {field.year:.3f}\n"
        f"declination {field.declination:.2f} deg, inclination {field.inclination:.2f} deg\n"
        f"--field {paste(field)}\n"
        f"--field-strength {field.strength:.4f}"
    )


def paste(field: EarthField) -> str:
    """N,E,D in uT, to a tenth of a nanotesla."""
    return f"{field.north:.4f},{field.east:.4f},{field.down:.4f}"


def describe_place(latitude: float, longitude: float) -> str:
    """42.8538 N, 2.6450 W."""
    longitude = (longitude + 180) % 360 - 180
    north, east = "NS"[latitude < 0], "EW"[longitude < 0]
    return f"{abs(latitude):.4f} {north}, {abs(longitude):.4f} {east}"


def to_json(field: EarthField) -> str:
    """The same as JSON, with units in the names."""
    units = {"north": "ut", "east": "ut", "down": "ut", "latitude": "deg", "longitude": "deg"}
    units["altitude"] = "m"
    values = {
        f"{name}_{units[name]}" if name in units else name: value
        for name, value in dataclasses.asdict(field).items()
    }
    values |= {
        "strength_ut": field.strength,
        "declination_deg": field.declination,
        "inclination_deg": field.inclination,
    }
    return json.dumps(values, indent=2)
