# SPDX-License-Identifier: BSD-3-Clause
"""A table's time in seconds: of dates, of epochs, of a clock whose header has no unit.

Dates become seconds since midnight UTC of the first row's day, so that logs of one day share a
clock and a double keeps their fractions.
"""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array
from sepcal.reading.units import SECONDS, quantity_of

TIME = "time_s"
CLOCKS = (
    *("time", "t", "timestamp", "time_stamp", "stamp", "timeus", "timems", "sample_time"),
    *("elapsed_time", "elapsed", "seconds", "datetime", "date_time", "utc", "epoch", "unix_time"),
)
PARTS = ("time", "stamp", "clock")  # of a header
IN_NAME = {"timeus": "us", "timems": "ms", "seconds": "s"}
EPOCHS = ((8e8, 5e9, "s"), (8e11, 5e12, "ms"), (8e14, 5e15, "us"), (8e17, 5e18, "ns"))
DAY = 86_400
DATENUMS = (7.2e5, 7.8e5)  # MATLAB's, days since the year 0: of 1971 to 2135
DATENUM_OF_1970 = 719_529
STEPS = (2e-4, 60.0)  # [s]: between them the rows of a log follow each other


def is_clock(header: str) -> bool:
    """Whether a column is the time of its rows."""
    return quantity_of(header)[0] in CLOCKS


def seconds_of(spans: np.ndarray) -> Array:
    """Spans of time [s]; NaN where there is none."""
    seconds = spans.astype("timedelta64[ns]").astype(np.int64) / 1e9
    seconds[np.isnat(spans)] = np.nan
    return np.asarray(seconds)


def since_midnight(dates: np.ndarray) -> tuple[Array, str]:
    """Seconds since midnight UTC of the first date's day, (N,), and that day."""
    day = dates[~np.isnat(dates)][0].astype("datetime64[D]")
    return seconds_of(dates.astype("datetime64[ns]") - day.astype("datetime64[ns]")), str(day)


def settle_clock(columns: dict[str, Array], dates: dict[str, np.ndarray], notes: list[str]) -> str:
    """Puts time_s first, of the dates or of a clock without a unit; a clock with one stays.

    Returns the day from whose midnight it counts, or nothing.
    """
    clocks = [header for header in columns if is_clock(header)]
    if any(quantity_of(header) in (("time", u) for u in SECONDS) for header in clocks):
        for header in dates:
            notes.append(f"column '{header}' of dates is left out: the log has a time of its own")
        if clocks[0] == "time_ns":
            _put_first(columns, clocks[0], columns[clocks[0]] * 1e-9)
            notes.append("time_s is column 'time_ns' in seconds")
        return ""
    usable = [header for header, values in dates.items() if _increases(values.astype(np.int64))]
    if usable:
        chosen = next((h for h in usable if is_clock(h)), usable[0])
        seconds, day = since_midnight(dates[chosen])
        _put_first(columns, chosen, seconds)
        notes.append(f"time_s is seconds since {day} 00:00 UTC, of the dates in '{chosen}'")
        for header in dates:
            if header != chosen:
                notes.append(f"column '{header}' of dates is left out: '{chosen}' is the time")
        return day
    for header in clocks:
        if (taken := _take_clock(columns, header, notes)) is not None:
            return taken
    return ""


def _take_clock(columns: dict[str, Array], header: str, notes: list[str]) -> str | None:
    """Makes time_s of a clock, where one reading alone is possible; its day, "", or None."""
    values = columns[header]
    known = values[np.isfinite(values)]
    if known.size < 2 or not _increases(known):
        return None
    quantity, unit = quantity_of(header)
    unit = unit or IN_NAME.get(quantity, "")
    for low, high, epoch in EPOCHS:
        if low <= known[0] <= high and unit in ("", epoch):
            first = np.floor(known[0] * SECONDS[epoch] / DAY) * DAY
            seconds = (values - first / SECONDS[epoch]) * SECONDS[epoch]
            day = np.datetime64(int(first), "s").astype("datetime64[D]")
            _put_first(columns, header, seconds)
            notes.append(
                f"time_s is seconds since {day} 00:00 UTC: '{header}' counts {epoch} since 1970"
            )
            return str(day)
    step = float(np.median(np.diff(known)))
    is_of_days = not unit and DATENUMS[0] <= known[0] <= DATENUMS[1]
    if is_of_days and STEPS[0] <= step * DAY <= STEPS[1]:
        first = np.floor(known[0])
        day = np.datetime64(int(first) - DATENUM_OF_1970, "D")
        _put_first(columns, header, np.round((values - first) * DAY, 5))  # what a double holds
        notes.append(
            f"time_s is seconds since {day} 00:00: '{header}' counts days as MATLAB does (datenum)"
        )
        return str(day)
    if unit:
        _put_first(columns, header, values * SECONDS[unit])
        notes.append(f"time_s is column '{header}' in seconds")
        return ""
    if STEPS[0] <= step <= STEPS[1] and (known != np.round(known)).any():
        _put_first(columns, header, values)
        notes.append(f"time_s is column '{header}', which has no unit: taken for seconds")
        return ""
    return None


def _put_first(columns: dict[str, Array], instead_of: str, seconds: Array) -> None:
    others = {h: values for h, values in columns.items() if h not in (instead_of, TIME)}
    columns.clear()
    columns[TIME] = seconds
    columns.update(others)


def _increases(values: np.ndarray) -> bool:
    """Whether time goes on, but for a repeat or a jump now and then."""
    steps = np.diff(values)
    return bool(values.size > 1 and (steps > 0).mean() > 0.5)
