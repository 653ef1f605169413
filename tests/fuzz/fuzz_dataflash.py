# SPDX-License-Identifier: BSD-3-Clause
"""DataFlash logs, binary and as text, damaged and with hostile names of what they hold."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping

from log_target import check_log
from mutation import main

from hostile import hostile_words
from log_writers import DataFlashWriter
from oracle.dataflash_reader import read_messages

TIMES = [20 + 0.1 * k for k in range(12)]
PARAMETERS = {"COMPASS_DEV_ID": 97539.0, "COMPASS_OFS_X": -118.4, "COMPASS_SCALE": 1.06}


def small_log(
    parameters: Mapping[str, float] = PARAMETERS, said: str = "ArduPlane V4.5", name: str = "XTRA"
) -> bytes:
    """A second of a compass, a tube and what goes with them."""
    log = DataFlashWriter()
    log.form("PARM", "QNf", "TimeUS,Name,Value")
    log.form("MSG", "QZ", "TimeUS,Message")
    log.form("MAG", "QBhhhhhhhhhBI", "TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ,Health,S")
    log.form("ATT", "Qccc", "TimeUS,Roll,Pitch,Yaw")
    log.form("ARSP", "QBffc", "TimeUS,I,Airspeed,DiffPress,Temp")
    log.form("BARO", "QBffc", "TimeUS,I,Alt,Press,Temp")
    log.form("GPS", "QBLLefff", "TimeUS,Status,Lat,Lng,Alt,Spd,GCrs,VZ")
    log.form("MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn")
    log.form(name[:4] or "XTRA", "Qf", f"TimeUS,{name}")
    for at, (key, value) in enumerate(parameters.items()):
        log.add(at, "PARM", at, key, value)
    log.add(1, "MSG", 1000, said)
    for k, t in enumerate(TIMES):
        us, turn = round(t * 1e6), 0.3 * k
        field = [round(300 * math.cos(turn)), round(300 * math.sin(turn)), 400]
        log.add(t, "MAG", us, 0, *field, *(0,) * 6, 1, us)
        log.add(t, "ATT", us, 1.0, 2.0, math.degrees(turn))
        log.add(t, "ARSP", us, 0, 20.0, 250.0 + k, 18.5)
        log.add(t, "BARO", us, 0, 500.0, 95000.0, 25.0)
        log.add(t, "GPS", us, 3, 47.4, 8.5, 500.0, 20.0, 90.0, 0.1)
        log.add(t, "MODE", us, 10 + k // 6, 10 + k // 6, 1)
    return log.data()


def as_text(log: bytes, mode: str = "AUTO") -> bytes:
    """As ground stations wrote it."""
    lines = []
    for kind, message in read_messages(log):
        values = dict(message)
        if kind == "MODE":
            values["Mode"] = mode
        cells = (f"{v:.9g}" if isinstance(v, float) else str(v) for v in values.values())
        lines.append(", ".join((kind, *cells)))
    return ("\n".join(lines) + "\n").encode("utf-8", "surrogateescape")


def hostile_log(seed: int) -> bytes:
    """Binary, with names that are hostile."""
    words = [w for w in hostile_words(200, seed) if len(w.encode()) < 16][-4:]
    return small_log({**PARAMETERS, words[0]: 1.0, words[1]: 2.0}, words[2], words[3])


def target(data: bytes) -> Hashable:
    """Of the command's answers."""
    return check_log("log.bin", data)


if __name__ == "__main__":
    texts = [as_text(small_log()), *(as_text(small_log(), w) for w in hostile_words(64, 7)[-3:])]
    main(target, [small_log(), *map(hostile_log, range(4)), *texts])
