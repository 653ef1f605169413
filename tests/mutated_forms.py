# SPDX-License-Identifier: BSD-3-Clause
"""One flight of a Pitot tube, written in the forms of the world: a form is drawn from a seed."""

from __future__ import annotations

import datetime
import gzip
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TRUTH = {"s_va": 0.95, "c_va": -0.6, "w_n": -3.8, "w_e": 2.4}
START = datetime.datetime(2024, 5, 3, 23, 58, 30)  # the flight crosses midnight
ROWS = 600
STEP = 0.2  # s

Rng = np.random.Generator
Table = dict[str, np.ndarray]


def fly() -> Table:
    """Circles at two speeds in a wind, as the tube's model has it; noise of 0.1 m/s."""
    rng = np.random.default_rng(7)
    time = STEP * np.arange(ROWS)
    heading = 0.12 * time
    speed = np.where(time < time[-1] / 2, 18.0, 26.0)
    read = TRUTH["s_va"] * speed + TRUTH["c_va"] + 0.1 * rng.standard_normal(ROWS)
    return {
        "time_s": time,
        "vn_mps": speed * np.cos(heading) + TRUTH["w_n"],
        "ve_mps": speed * np.sin(heading) + TRUTH["w_e"],
        "vd_mps": np.zeros(ROWS),
        "airspeed_mps": read,
        "altitude_m": 1200.0 + 0.2 * time,
    }


@dataclass
class Form:
    """How a table is written."""

    delimiter: str = ","
    decimal: str = "."
    group: str = ""  # between thousands
    quotes: str = "where needed"
    head: str = "sepcal"
    time: str = "seconds"
    above: tuple[str, ...] = ()
    units_row: str = ""
    index: str = ""
    trailing: bool = False
    end: str = ""
    between: str = ""
    encoding: str = "utf-8"
    line_end: str = "\n"
    packed: str = ""
    text_column: bool = False
    suffixes: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether the reader has nothing to decide."""
        left = Form(text_column=self.text_column, packed=self.packed, line_end=self.line_end)
        left.encoding = self.encoding if self.encoding in ("utf-8", "utf-8-sig") else ""
        left.quotes = self.quotes
        return self == left and self.line_end != "\r"


HEADS: dict[str, tuple[str, ...]] = {
    "sepcal": ("time_s", "vn_mps", "ve_mps", "vd_mps", "airspeed_mps", "altitude_m"),
    "capitals": ("Time_s", "Vn_mps", "Ve_mps", "Vd_mps", "Airspeed_mps", "Altitude_m"),
    "brackets": ("Time (s)", "VN (m/s)", "VE (m/s)", "VD (m/s)", "Airspeed (m/s)", "Altitude (m)"),
    "square": ("time [s]", "vn [m/s]", "ve [m/s]", "vd [m/s]", "airspeed [m/s]", "altitude [m]"),
    "bare": ("time", "vn", "ve", "vd", "airspeed", "altitude"),
    "long": ("Time_s", "Vel N (m/s)", "Vel E (m/s)", "Vel D (m/s)", "TAS (m/s)", "Altitude (m)"),
}
UNITS = ("s", "m/s", "m/s", "m/s", "m/s", "m")


def stamp(t: float, pattern: str) -> str:
    """The moment, to the millisecond where the pattern ends in %f."""
    text = (START + datetime.timedelta(seconds=t)).strftime(pattern)
    return text[:-3] if pattern.endswith("%f") else text


def since_1970(t: float) -> float:
    """[s]."""
    return (START - datetime.datetime(1970, 1, 1)).total_seconds() + t


TIMES: dict[str, Callable[[float], str]] = {
    "milliseconds": lambda t: f"{1000 * t:.0f}",
    "iso": lambda t: stamp(t, "%Y-%m-%dT%H:%M:%S.%f") + "Z",
    "stamp": lambda t: stamp(t, "%d.%m.%Y %H:%M:%S.%f"),
    "american": lambda t: stamp(t, "%m/%d/%Y %I:%M:%S.%f") + stamp(t, " %p"),
    "clock": lambda t: stamp(t, "%H:%M:%S.%f"),
    "epoch": lambda t: f"{since_1970(t):.2f}",
    "epoch ms": lambda t: f"{1000 * since_1970(t):.0f}",
    "whole seconds": lambda t: f"{np.floor(t + 1e-9):.0f}",
    "date and clock": lambda t: stamp(t, "%Y-%m-%d|%H:%M:%S.%f"),
}


def draw_form(seed: int) -> Form:
    """One to five departures from a plain CSV."""
    rng = np.random.default_rng([42, seed])

    def pick(values: Sequence[str]) -> str:
        return str(rng.choice(np.array(values, dtype=object)))

    form = Form()

    def delimit() -> None:
        form.delimiter = pick([";", "\t", "|", " ", ";", "\t"])
        if form.delimiter in ";\t" and rng.random() < 0.6:
            form.decimal = ","
            form.group = pick(["", "", ".", " "]) if form.delimiter == ";" else ""

    def quote() -> None:
        form.quotes = pick(["all", "numbers"])
        if form.delimiter == "," and rng.random() < 0.5:
            form.decimal = ","

    def name() -> None:
        form.head = pick(["capitals", "brackets", "square", "long", "bare"])
        if form.head == "bare":
            form.units_row = "after"

    def clock() -> None:
        form.time = pick(list(TIMES))

    def precede() -> None:
        lines = [
            "# Logger v1.2",
            "Device: ADC-7",
            "Flight 12, crew of 2",
            "",
            "Start;2024-05-03",
            "%",
        ]
        form.above = tuple(pick(lines) for _ in range(rng.integers(1, 5)))

    def number() -> None:
        form.index = pick(["unnamed", "named", "absent"])

    def trail() -> None:
        form.trailing = True

    def finish() -> None:
        form.end = pick(["no line end", "cut", "nuls", "blank lines", "total", "end of log"])

    def interrupt() -> None:
        form.between = pick(["blank", "comment", "header"])

    def encode() -> None:
        form.encoding = pick(["utf-8-sig", "utf-16", "utf-16-le", "latin-1", "utf-16-be"])

    def end_lines() -> None:
        form.line_end = pick(["\r\n", "\r", "\r\r\n"])

    def pack() -> None:
        form.packed = "gzip"

    def describe() -> None:
        form.text_column = True

    def unit() -> None:
        form.suffixes = True

    def units() -> None:
        form.units_row = pick(["after", "before", "toa5"])

    changes = [
        delimit,
        quote,
        name,
        clock,
        precede,
        number,
        trail,
        finish,
        interrupt,
        encode,
        end_lines,
        pack,
        describe,
        unit,
        units,
    ]
    chosen = rng.choice(len(changes), size=int(rng.integers(1, 6)), replace=False)
    for change in sorted(int(i) for i in chosen):
        changes[change]()
    return reconcile(form)


def reconcile(form: Form) -> Form:
    """Without what no writer would write together."""
    if form.delimiter == " ":
        form.time = "seconds" if form.time in ("stamp", "american", "date and clock") else form.time
        form.head = form.head if form.head in ("sepcal", "capitals", "bare") else "sepcal"
        form.trailing = form.suffixes = False
        form.index = "" if form.index == "absent" else form.index
        form.group = ""
    if form.decimal == "," and form.delimiter == "," and form.quotes == "where needed":
        form.decimal = "."
    if form.suffixes:
        form.head = "bare"
        form.units_row = ""
    if form.units_row and form.head in ("brackets", "square", "long"):
        form.units_row = ""
    if form.units_row == "toa5" and form.head != "bare":
        form.units_row = "after"
    if form.head == "bare" and not form.units_row and not form.suffixes:
        form.units_row = "after"
    if form.trailing and form.index == "absent":
        form.index = ""
    if form.time == "milliseconds" and form.head != "sepcal":
        form.time = "seconds"
    if form.encoding == "latin-1" and form.delimiter == " ":
        form.encoding = "utf-8"
    return form


def write_number(value: float, digits: int, form: Form) -> str:
    """The number with the form's marks."""
    text = f"{value:.{digits}f}"
    whole, _, fraction = text.partition(".")
    if form.group and len(whole.lstrip("-")) > 3:
        whole = f"{int(whole):,}".replace(",", form.group)
    return whole + (form.decimal + fraction if fraction else "")


def write_cells(table: Table, form: Form) -> tuple[list[str], list[list[str]], list[str]]:
    """Names, rows and units."""
    names = list(HEADS[form.head])
    units = list(UNITS)
    digits = (3, 4, 4, 1, 4, 2)
    columns = []
    for k, values in enumerate(table.values()):
        cells = [write_number(float(v), digits[k], form) for v in values]
        if form.suffixes and k > 0:
            cells = [f"{cell} {units[k]}" for cell in cells]
        columns.append(cells)
    if form.suffixes:
        names[0] = "time_s"
    if form.time != "seconds":
        columns[0] = [TIMES[form.time](float(t)) for t in table["time_s"]]
        if form.decimal == "," and form.time in ("epoch",):
            columns[0] = [cell.replace(".", ",") for cell in columns[0]]
        named = {"milliseconds": "time_ms", "whole seconds": names[0], "epoch": "timestamp"}
        names[0] = named.get(form.time, "Timestamp" if form.time != "clock" else "UTC time")
        units[0] = {"milliseconds": "ms", "whole seconds": "s"}.get(form.time, "")
        if form.time == "date and clock":
            names[:1] = ["Date", "Time"]
            units[:1] = ["yyyy-mm-dd", "hh:mm:ss"]
            both = [cell.split("|") for cell in columns[0]]
            columns[:1] = [[b[0] for b in both], [b[1] for b in both]]
    if form.text_column:
        names.append("mode")
        units.append("")
        columns.append(["AUTO" if i % 90 < 60 else "RTL" for i in range(ROWS)])
    if form.encoding == "latin-1":
        names.append("Kurs \xb0")
        units.append("")
        columns.append(["0"] * ROWS)
    rows = [list(row) for row in zip(*columns, strict=True)]
    if form.index:
        rows = [[str(i), *row] for i, row in enumerate(rows)]
        if form.index != "absent":
            names.insert(0, "" if form.index == "unnamed" else "record")
            units.insert(0, "")
    return names, rows, units


def write_bytes(table: Table, form: Form) -> bytes:
    """The file."""
    names, rows, units = write_cells(table, form)

    def line(cells: Sequence[str], are_names: bool = False) -> str:
        written = []
        for cell in cells:
            needed = form.delimiter in cell or (form.delimiter == " " and not cell)
            every = form.quotes == "all" or (form.quotes == "numbers" and not are_names)
            written.append(f'"{cell}"' if needed or every else cell)
        return form.delimiter.join(written) + (form.delimiter if form.trailing else "")

    lines = list(form.above)
    if form.units_row == "toa5":
        lines = ['"TOA5","CR1000"'.replace(",", form.delimiter)]
    if form.units_row == "before":
        lines.append("#" + line(units, True))
    lines.append(line(names, True))
    header = lines[-1]
    if form.units_row in ("after", "toa5"):
        lines.append(line(units, True))
    if form.units_row == "toa5":
        lines.append(line(["Smp" for _ in units], True))
    body = [line(row) for row in rows]
    extra = {"blank": "", "comment": "# pause", "header": header}
    if form.between:
        for at in (450, 300):
            body.insert(at, extra[form.between])
    lines += body
    if form.end == "cut":
        lines[-1] = lines[-1][: len(lines[-1]) // 2]
    if form.end == "blank lines":
        lines += ["", ""]
    if form.end in ("total", "end of log"):
        lines.append("# 600 rows" if form.end == "total" else "End of log")
    text = form.line_end.join(lines)
    text += "" if form.end in ("no line end", "cut") else form.line_end
    data = text.encode(form.encoding)
    if form.end == "nuls":
        data += b"\0" * 512
    return gzip.compress(data) if form.packed else data


def write(folder: Path, form: Form) -> Path:
    """The flight in that form."""
    file = folder / ("flight.csv.gz" if form.packed else "flight.csv")
    file.write_bytes(write_bytes(fly(), form))
    return file
