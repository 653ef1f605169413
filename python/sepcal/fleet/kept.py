# SPDX-License-Identifier: BSD-3-Clause
"""A fleet's files: what is known of flights and vehicles, and what it takes to go on."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from typing import TYPE_CHECKING

from sepcal.fleet.logs import as_json
from sepcal.fleet.parquet import or_none, table_bytes
from sepcal.fleet.passes import vehicle_error
from sepcal.whole_files import write_bytes

if TYPE_CHECKING:
    from sepcal.fleet.fleet import Fleet

SCHEMA = 1


def fleet_json(fleet: Fleet) -> str:
    """What is known of each flight and vehicle."""
    vehicles = fleet.vehicles
    parameters = fleet.parameters
    told = {
        "schema": SCHEMA,
        "kind": "fleet",
        "model": fleet.base.core.model,
        "own": list(fleet.own),
        "added": fleet.added,
        "common": list(fleet.common),
        "flights": [
            {
                **as_json(flight.log),
                "sha256": flight.sha256,
                "rows": flight.rows,
                "rmse": or_none(flight.factor.rmse),
                "misfit_per_reading": flight.misfit,
                "own": dict(flight.factor.own),
            }
            for flight in fleet.flights.values()
        ],
        "left_out": [{"name": name, "reason": reason} for name, reason in fleet.left_out.items()],
        "vehicles": [
            {
                "vehicle": name,
                "flights": fit.flights,
                "parameters": {
                    parameter: {
                        "value": or_none(fit.values[k]),
                        "standard_error": or_none(vehicle_error(fit, k)),
                    }
                    for k, parameter in enumerate(parameters)
                },
            }
            for name, fit in vehicles.items()
        ],
    }
    return json.dumps(told, indent=2, allow_nan=False) + "\n"


def write_files(fleet: Fleet, folder: str | os.PathLike[str]) -> None:
    """Writes fleet.json, flights.parquet, vehicles.parquet and setup.json. Raises Error."""
    text = fleet_json(fleet)
    told = json.loads(text)
    place = os.fspath(folder)
    setup = {
        "schema": SCHEMA,
        "kind": "fleet",
        "logs": [as_json(log) for log in fleet.logs],
        "misnamed": fleet._misnamed,
        "base": json.loads(fleet.base.to_json()),
        "own": list(fleet.own),
        "candidates": None if fleet._candidates is None else list(fleet._candidates),
        "tolerance": fleet._way.tolerance,
        "added": fleet.added,
        "common": list(fleet._sharing.parameters),
        "growths": [asdict(growth) for growth in fleet._sharing.growths],
    }
    write_bytes(os.path.join(place, "setup.json"), json.dumps(setup, indent=1).encode())
    write_bytes(os.path.join(place, "fleet.json"), text.encode())
    flights = [
        {
            "name": one["name"],
            "file": one["file"],
            "vehicle": one["vehicle"],
            **one["labels"],
            **one["attributes"],
            "rows": one["rows"],
            "rmse": one["rmse"],
            "misfit_per_reading": one["misfit_per_reading"],
            **one["own"],
        }
        for one in told["flights"]
    ]
    vehicles = []
    for one in told["vehicles"]:
        row = {"vehicle": one["vehicle"], "flights": one["flights"]}
        for name, value in one["parameters"].items():
            row[name] = value["value"]
            row[f"{name}_error"] = value["standard_error"]
        vehicles.append(row)
    write_bytes(os.path.join(place, "flights.parquet"), table_bytes(flights))
    write_bytes(os.path.join(place, "vehicles.parquet"), table_bytes(vehicles))
