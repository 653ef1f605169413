# SPDX-License-Identifier: BSD-3-Clause
"""Autopilots' logs, PX4's ULog and ArduPilot's DataFlash, as `sepcal log` converts them.

Where a log has a magnetometer and a tube and nobody said which is meant, rows of both stand in it,
each with all that goes with it.
"""

from __future__ import annotations

from sepcal import _core
from sepcal.logs.flights import LoggedFlight, convert
from sepcal.logs.reading import find_lacking, open_log
from sepcal.logs.recording import MAGNETOMETER, TUBE, Recording
from sepcal.reading.rates import one_below_the_other
from sepcal.reading.table import Table, listed
from sepcal.reading.wanted import AIR, MAGNETIC, wanted

KINDS = {MAGNETIC: MAGNETOMETER, AIR: TUBE}


def read(file: str, chosen: str | None) -> Table:
    """The table of the chosen sensor, of the first of the kind that is wanted, or of both kinds.

    Raises:
        Error: As read_log() does.
    """
    log = open_log(file, cut_off=True)  # and its notes say so
    names = [chosen] if chosen is not None else _choose(log)
    tables = [_to_table(log, name) for name in names]
    others = [sensor.name for sensor in log.sensors if sensor.name not in names]
    table = one_below_the_other(tables)
    if others:
        table.notes.append(f"also in the log: {listed(others)}, as '{file}::{others[0]}'")
    return table


def _choose(log: Recording) -> list[str | None]:
    """The first sensor of each kind in question that can be calibrated; None: of none, say why."""
    kinds = [KINDS[wanted()]] if wanted() else [MAGNETOMETER, TUBE]
    found: list[str | None] = []
    for kind in kinds:
        able = [s for s in log.sensors if s.kind == kind and not find_lacking(log, s)]
        found += [sensor.name for sensor in able[:1]]
    if not found and wanted():
        of_kind = [sensor.name for sensor in log.sensors if sensor.kind == kinds[0]]
        if not of_kind and log.sensors:
            raise _core.Error(
                f"{log.file}: no {kinds[0]} is in the log; it has "
                f"{listed(s.name for s in log.sensors)}"
            )
        found += of_kind[:1]
    return found or [None]


def _to_table(log: Recording, name: str | None) -> Table:
    """The table of one sensor; without the Earth's field if only that fails: fit takes it too."""
    try:
        return _of_flight(convert(log, name, None, None, None, field=True))
    except _core.Error as error:
        table = _of_flight(convert(log, name, None, None, None, field=False))
        table.notes.append(f"the Earth's field is not filled in: {error}")
        return table


def _of_flight(flight: LoggedFlight) -> Table:
    told = flight.conversion
    notes = [f"rows are the readings of {flight.sensor} of the {told['log']['format']} log"]
    for header in ("mx_ut", "dp_pa", "airspeed_mps"):
        if header in flight and told["columns"][header]["done"]:
            notes += [f"{header}: {text}" for text in told["columns"][header]["done"]]
    notes += [f"{count} rows are left out: {why}" for why, count in told["left_out"].items()]
    if told["field"] is not None:
        notes.append(f"the Earth's field is by {told['field']['model']}")
    notes += told["notes"]
    return Table(dict(flight), labels=flight.maneuvers, notes=notes, name=flight.sensor)
