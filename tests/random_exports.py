# SPDX-License-Identifier: BSD-3-Clause
"""Random calibrations through export, compiled, run, and held against apply.

    PYTHONPATH=build/python:tests .venv/bin/python tests/random_exports.py --exports 1000 --seed 1

Each export is a random probe with random effects, drivers, hostile names and parameters, as a C and
a C++ header in double and in float. Twenty-five at a time are compiled as C99 and C++20, by gcc and
by clang, at -O2 and with sanitizers, and corrected readings are compared with Calibration.apply():
1e-12 of the largest reading in double, 1e-6 in float. What differs is a finding, kept in a folder.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import string
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import headers
import sepcal
from oracle.model import Array

ROWS = 60
BATCH = 25  # exports a program
K_ALPHA, K_BETA = 4.5, 3.8
STRICT = ("-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Werror")
SANITIZED = ("-O0", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
COMPILERS = {
    ("c", "c99"): ("gcc", "clang-16"),
    ("cpp", "c++20"): ("g++", "clang++-16"),
}
TOLERANCE = {False: 1e-12, True: 1e-6}  # by whether it is in float, of the largest reading

HOSTILE = (
    *("*/system(cmd);/*", "NAN", "INFINITY", "HUGE_VAL", "M_PI", "isnan", "isfinite", "linux"),
    *("typeof", "co_await", "main", "at", "k", "a\\", 'x"y', "it's", "<b>", "ünïcode", "%d", "##"),
    *("//", "1x", "_", "double", "float", "sqrtf", "y1", "gamma", "crc", "outside", "size", "int"),
    *("unix_s", "imu_temp_degc", "press_hpa", "is_extrapolated", "range_1", "x_1", "n_1", "near"),
    *("\\u0041", "??/", "__COUNTER__", "pt_less_ps_pa", "origin_k", "k_less_origin", "in", "out"),
)


@dataclass
class Case:
    """A calibration, what is put into its headers, and what apply makes of it."""

    number: int
    probe: str
    effects: list[str]
    calibration: sepcal.Calibration
    flight: sepcal.Flight  # ROWS rows
    channels: list[str]  # of the headers' arguments behind the readings, in double
    expected: Array  # (ROWS, outputs), NaN where there is nothing to correct
    sizes: Array  # (outputs,): what an error is measured by
    outside: Array  # (ROWS,): 1 beyond what the fit saw, 0 within, NaN at its edge


@dataclass
class Found:
    """What was tried, and what differed."""

    exports: int = 0
    refused: int = 0
    compiled: int = 0
    rows: int = 0
    worst: dict[bool, float] = field(default_factory=lambda: {False: 0.0, True: 0.0})
    findings: list[str] = field(default_factory=list)


class Draw:
    """Random parts of a calibration."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)

    def chance(self, p: float) -> bool:
        """True with that probability."""
        return bool(self.rng.random() < p)

    def one(self, of: Any) -> Any:
        """One of a sequence."""
        return of[int(self.rng.integers(len(of)))]

    def size(self, low: float, high: float) -> float:
        """Between two powers of ten, of either sign."""
        return float(self.one((-1.0, 1.0)) * 10.0 ** self.rng.uniform(low, high))

    def name(self) -> str:
        """A column's: hostile, or of any characters that a name of an effect may have."""
        if self.chance(0.6):
            return str(self.one(HOSTILE))
        letters = string.ascii_letters + string.digits + "_-./%#@!?;:<>'\"&|~$éß"
        return "".join(self.one(letters) for _ in range(int(self.rng.integers(1, 12))))

    def column(self, rows: int) -> Array:
        """Values that wander over a range, which may lie far from zero."""
        span = abs(self.size(-3, 4))
        far = self.chance(0.4)
        start = self.size(0.5, 6) * span if far else self.size(-1, 0.5) * span
        start = float(np.clip(start, -2e9, 2e9))
        if self.chance(0.1):
            start, span = 1.764e9, float(self.one((50.0, 3600.0)))
        steps = np.cumsum(self.rng.normal(size=rows))
        return np.asarray(start + span * (steps - steps.min()) / np.ptp(steps))


def far_by(column: Array) -> float:
    """How often a column's range goes into its largest value."""
    return float(np.abs(column).max() / np.ptp(column))


# Ports by probe: their components' number and how much an effect there amounts to.
PORTS = {
    "magnetometer": {"bias": 6.0, "scale": 0.05, "axis_scale": 0.05},
    "norm": {"bias": 6.0, "scale": 0.05, "axis_scale": 0.05},
    "five-hole": {
        "airspeed_scale": 0.05,
        "airspeed_bias": 1.0,
        "alpha_offset": 0.03,
        "beta_offset": 0.03,
        "pressure_offset": 15.0,
    },
    "pitot-static": {"airspeed_scale": 0.05, "airspeed_bias": 1.0, "pressure_offset": 12.0},
}
OWN = {
    "magnetometer": {"cubic_nonlinearity": ()},
    "norm": {},
    "five-hole": {
        "density_error": ("temperature",),
        "compressibility": (),
        "angle_loss": (),
        "upwash": ("q",),
        "sidewash": ("p",),
        "pressure_offset": (),
    },
    "pitot-static": {"density_error": ("temperature",), "pressure_offset": ()},
}
OTHERS = {
    "magnetometer": ("field_declination",),
    "norm": (),
    "five-hole": ("heading_bias", "wind[altitude_m]"),
    "pitot-static": ("wind[altitude_m]",),
}
READINGS = {
    "magnetometer": ("mx", "my", "mz"),
    "norm": ("mx_ut",),
    "five-hole": ("alpha", "beta", "rho", "ps", "pt"),
    "pitot-static": ("rho", "airspeed"),
}
KNOWN = {
    "magnetometer": ("p", "q", "r", "temp_degc", "current_a", "throttle"),
    "norm": ("p", "temp_degc", "current_a", "throttle"),
    "five-hole": ("p", "q", "altitude_m", "throttle"),
    "pitot-static": ("q", "altitude_m", "throttle"),
}
SIZES = {  # of a probe's own parameters
    **dict.fromkeys(("lambda_x", "lambda_y", "lambda_z"), 0.3),
    **dict.fromkeys(("n_x", "n_y", "n_z"), 60.0),
    **dict.fromkeys(("eta_x", "eta_y", "eta_z", "alpha_xy", "alpha_xz", "alpha_yz"), 0.15),
    **dict.fromkeys(("lambda_va", "lambda_alpha", "lambda_beta"), 0.2),
    **dict.fromkeys(("b_alpha", "b_beta"), 0.05),
    **{"b_va": 2.0, "eps_phi": 0.3, "s_va": 0.2, "c_va": 2.0},
}
STATES = {"temperature": "temp_k", "rho": "rho_kgpm3", "ps": "ps_pa", "pt": "pt_pa"}
STATES |= {rate: f"{rate}_radps" for rate in "pqr"}


def make_model(probe: str, draw: Draw) -> sepcal.Model:
    """The probe, a magnetometer turned now and then."""
    if probe == "norm":
        return sepcal.Magnetometer(field_strength=53.2)
    if probe == "five-hole":
        return sepcal.FiveHoleProbe(k_alpha=K_ALPHA, k_beta=K_BETA)
    if probe == "pitot-static":
        return sepcal.PitotStatic()
    turned = draw.chance(0.3)
    mounting = tuple(float(draw.rng.uniform(-180, 180)) for _ in range(3)) if turned else None
    return sepcal.Magnetometer(field=(19.7, -1.4, 49.4), mounting=mounting)


def random_driver(draw: Draw, columns: dict[str, Array], probe: str) -> tuple[str, list[str]]:
    """A driver's text, and the channels that it follows in order."""
    choice = draw.rng.random()
    names = [name for name in columns if not re.search(r"[*^(),\[\]+ ]", name)]
    if choice < 0.15 and READINGS[probe]:
        channel = str(draw.one(READINGS[probe]))
        return (f"{channel}^{draw.rng.integers(1, 3)}" if draw.chance(0.5) else channel), [channel]
    name = str(draw.one(KNOWN[probe])) if choice < 0.4 else str(draw.one(list(columns)))
    if name not in names and name in columns:
        return name, [name]
    far = far_by(columns[name]) if name in columns else 1.0
    shapes = ["power", "spline", "levels"]
    if far < 300:
        shapes += ["square", "cube", "product", "size"]
    if far < 3:
        shapes += ["exponent"]
    shape = draw.one(shapes)
    if shape in ("square", "cube"):
        return f"{name}^{2 if shape == 'square' else 3}", [name]
    if shape == "spline":
        return f"spline({name},{draw.rng.integers(3, 9)})", [name]
    if shape == "levels" and name in columns:
        count = int(draw.rng.integers(1, 4))
        inner = np.quantile(columns[name], np.sort(draw.rng.uniform(0.1, 0.9, count)))
        rising = sorted(set(inner.tolist()))
        return f"levels({name},{','.join(repr(one) for one in rising)})", [name]
    if shape == "exponent":
        return f"{name}^n", [name]
    if shape in ("product", "size"):
        near = [one for one in names if far_by(columns[one]) < 300 and one != name]
        other = str(draw.one(near)) if near and shape == "product" else name
        second = f"abs({other})" if shape == "size" or draw.chance(0.3) else other
        return f"{name}*{second}", [name] if other == name else [name, other]
    return name, [name]


def random_effects(
    draw: Draw, columns: dict[str, Array], probe: str
) -> tuple[list[str], list[list[str]]]:
    """Effects, and the channels that each follows."""
    effects: list[str] = []
    followed: list[list[str]] = []
    for _ in range(int(draw.rng.integers(0, 7))):
        choice = draw.rng.random()
        if choice < 0.2 and OWN[probe]:
            effect = str(draw.one(list(OWN[probe])))
            channels = list(OWN[probe][effect])
        elif choice < 0.27 and OTHERS[probe]:
            effect, channels = str(draw.one(OTHERS[probe])), []
        else:
            driver, channels = random_driver(draw, columns, probe)
            effect = f"{draw.one(list(PORTS[probe]))}[{driver}]"
        if effect not in effects:
            effects.append(effect)
            followed.append(channels)
    return effects, followed


def size_of(
    name: str, draw: Draw, wide: float, document: dict[str, Any], columns: dict[str, Array]
) -> float:
    """A value for a parameter; its effect is `wide` times some percent of the reading."""
    if name in SIZES:
        most = SIZES[name] * (wide if name.startswith("n_") else 1.0)
        value = float(draw.rng.uniform(-1, 1) * most)
        return value + (1.0 if name == "s_va" else 0.0)
    if name.startswith("cubic_nonlinearity.d"):
        return draw.size(-8, -6)
    if name.startswith("cubic_nonlinearity.c"):
        return draw.size(-6, -4.3)
    own = {"density_error.s": 10.0, "compressibility.s": 1.0, "angle_loss.s": 1.0}
    own |= {"upwash.k": 1.0, "sidewash.k": 1.0, "pressure_offset.s": 15.0}
    if name in own:
        return float(draw.rng.uniform(-1, 1) * own[name])
    effect, _, component = name.rpartition(".")
    if component == "exponent":
        return float(draw.rng.uniform(0.4, 2.5))
    port, _, driver = effect.partition("[")
    size = next((ports[port] for ports in PORTS.values() if port in ports), 0.0)
    if "scale" in port:
        wide = min(wide, 1.5)  # a matrix far from singular, as sensors have
    settings = {one["name"]: one for one in document["options"]["effects"]}
    found = settings.get(effect, {})
    if "knots" in found or driver.startswith("levels("):
        return float(draw.rng.uniform(-1, 1) * wide * size)
    return float(draw.rng.uniform(-1, 1) * wide * size / largest_of(driver[:-1], found, columns))


def largest_of(driver: str, setting: dict[str, Any], columns: dict[str, Array]) -> float:
    """The largest that a power, a product or an exponent comes to on the fitted flight."""
    centre, mean = setting.get("centre", 0.0), setting.get("mean", 0.0)
    if driver in columns:
        return float(np.abs(columns[driver] - centre - mean).max())
    total = np.ones_like(next(iter(columns.values())))
    power = 1
    for factor in driver.split("*"):
        name, _, exponent = factor.partition("^")
        inner = re.fullmatch(r"abs\((.*)\)", name)
        column = columns.get(inner[1] if inner else name, np.ones_like(total))
        if exponent == "n":
            return float(max(np.abs(column).max(), 1.0) ** 2.5)
        power = int(exponent or 1)
        shifted = column - centre if "*" not in driver else column
        total = total * shifted**power
    return float(np.abs(total - mean - (centre if "*" in driver else 0.0)).max())


def readings_of(probe: str, draw: Draw) -> dict[str, Array]:
    """Random readings, ROWS of each."""
    rng = draw.rng
    if probe in ("magnetometer", "norm"):
        return {f"m{axis}_ut": rng.uniform(-90, 90, ROWS) for axis in "xyz"}
    rho = rng.uniform(0.9, 1.25, ROWS)
    if probe == "pitot-static":
        return {"airspeed_mps": rng.uniform(14, 40, ROWS), "rho_kgpm3": rho}
    dp = rng.uniform(100, 900, ROWS)
    ps = rng.uniform(80000, 101000, ROWS)
    readings = {"pt_pa": ps + dp, "ps_pa": ps, "rho_kgpm3": rho}
    readings["dpa_pa"] = dp * K_ALPHA * rng.uniform(-0.2, 0.3, ROWS)
    readings["dpb_pa"] = dp * K_BETA * rng.uniform(-0.2, 0.2, ROWS)
    return readings


def turn_of(calibration: sepcal.Calibration) -> Array:
    """From the sensor's axes into the body's: 3-2-1 Euler angles."""
    mounting = calibration.to_dict()["options"].get("mounting", [0.0, 0.0, 0.0])
    roll, pitch, yaw = np.deg2rad(mounting)
    c, s = np.cos, np.sin
    about_x = np.array([[1, 0, 0], [0, c(roll), -s(roll)], [0, s(roll), c(roll)]])
    about_y = np.array([[c(pitch), 0, s(pitch)], [0, 1, 0], [-s(pitch), 0, c(pitch)]])
    about_z = np.array([[c(yaw), -s(yaw), 0], [s(yaw), c(yaw), 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)


def channel_values(channel: str, calibration: sepcal.Calibration, flight: sepcal.Flight) -> Array:
    """What an effect follows, as a fit's record has it."""
    if channel in ("alpha", "beta"):
        k = K_ALPHA if channel == "alpha" else K_BETA
        return flight[f"dp{channel[0]}_pa"] / (k * (flight["pt_pa"] - flight["ps_pa"]))
    if channel in ("mx", "my", "mz") and channel not in list(flight):
        read = np.stack([flight[f"m{axis}_ut"] for axis in "xyz"])
        return np.asarray((turn_of(calibration) @ read)["xyz".index(channel[1])])
    if channel == "airspeed":
        return flight["airspeed_mps"]
    return flight[STATES.get(channel, channel)]


def find_outside(calibration: sepcal.Calibration, flight: sepcal.Flight) -> Array:
    """By row: 1 beyond what the fit saw of a channel, NaN where rounding decides, else 0."""
    outside = np.zeros(ROWS)
    at_hand = {channel for channels in READINGS.values() for channel in channels}
    for channel, (low, high) in calibration.to_dict().get("driver_ranges", {}).items():
        if channel == "rho" and not follows_density(calibration):
            continue  # which upwash reads, and does not follow
        values = channel_values(channel, calibration, flight)
        if low == high:
            continue
        edge = 2e-5 * (high - low)
        if channel in at_hand or channel in STATES:  # what a float makes of one without an origin
            edge += 4e-6 * max(abs(low), abs(high))
        beyond = (values < low) | (values > high)
        close = (np.abs(values - low) < edge) | (np.abs(values - high) < edge)
        outside = np.where(beyond & ~close, 1.0, np.where(close & (outside == 0), np.nan, outside))
    return outside


def follows_density(calibration: sepcal.Calibration) -> bool:
    """Whether an effect is driven by density, or by what is computed of it."""
    names = [one["name"] for one in calibration.to_dict()["options"]["effects"]]
    return any(re.search(r"\brho\b", name) or name == "compressibility" for name in names)


def arguments_in_order(probe: str, followed: list[list[str]], effects: list[str]) -> list[str]:
    """Channels that are arguments of the double header, in the order of first use."""
    at_hand = set(READINGS[probe]) | {"mx_ut", "my_ut", "mz_ut"}
    if probe == "pitot-static":
        at_hand = {"airspeed"}
    found: list[str] = []
    for effect, channels in zip(effects, followed, strict=True):
        if effect in OTHERS[probe]:
            continue
        for channel in channels:
            if channel not in at_hand and channel not in found:
                found.append(channel)
    return found


def make_case(number: int, seed: int) -> Case | None:
    """A random case; None where sepcal refuses what was drawn, in one line."""
    draw = Draw(seed)
    probe = str(draw.one(list(PORTS)))
    model = make_model(probe, draw)
    kind = "magnetometer" if probe == "norm" else probe
    simulated = sepcal.simulate(kind, rows=200, seed=int(draw.rng.integers(1000)))
    base = {name: np.asarray(simulated[name]) for name in simulated}
    columns: dict[str, Array] = {}
    for _ in range(int(draw.rng.integers(1, 6))):
        name = draw.name()
        if name not in base and name not in ("maneuver",):
            columns[name] = draw.column(200)
    effects, followed = random_effects(draw, columns, probe)
    known = columns | {name: base[STATES.get(name, name)] for name in KNOWN[probe]}
    known |= {name: base[f"{name}_ut"] for name in ("mx", "my", "mz") if f"{name}_ut" in base}
    try:
        flight = sepcal.Flight(base | columns)
        samples = None if probe == "norm" else 20  # a strength begins at the ellipsoid
        calibration = sepcal.fit(model, flight, effects=effects, samples=samples)
        document = calibration.to_dict()
        wide = float(
            10.0 ** draw.rng.uniform(-2.0, 0.5 if "pit" in probe or "five" in probe else 1.0)
        )
        if "cubic_nonlinearity" in effects:  # of a large field it is no longer one to one
            wide = min(wide, 1.0)
        for name, parameter in document["parameters"].items():
            parameter["value"] = size_of(name, draw, wide, document, known)
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump(document, file)
            file.flush()
            calibration = sepcal.load(file.name)
    except sepcal.Error as error:
        if "\n" in str(error):
            raise
        return None
    rows = readings_of(probe, draw)
    for name, column in (base | columns).items():
        if name in rows or name == "time_s":
            continue
        span = float(np.ptp(column))
        reach = 0.02 if draw.chance(0.5) else -0.02
        low, high = float(column.min()) - reach * span, float(column.max()) + reach * span
        rows[name] = draw.rng.uniform(low, high, ROWS)
    rows["time_s"] = np.arange(ROWS) * 0.1
    tried = sepcal.Flight(rows)
    applied = calibration.apply(tried)
    applied.pop("outside_fit", None)
    expected = np.column_stack(list(applied.values()))
    return Case(
        number=number,
        probe=probe,
        effects=effects,
        calibration=calibration,
        flight=tried,
        channels=arguments_in_order(probe, followed, effects),
        expected=expected,
        sizes=sizes_of(probe, list(applied), expected, rows),
        outside=find_outside(calibration, tried),
    )


def sizes_of(probe: str, names: list[str], expected: Array, rows: dict[str, Array]) -> Array:
    """The largest reading or output, by output; 1 rad of an angle."""
    if probe in ("magnetometer", "norm"):
        largest = max(float(np.abs(rows[f"m{axis}_ut"]).max()) for axis in "xyz")
        return np.full(3, max(largest, float(np.nanmax(np.abs(expected)))))
    largest_output = np.nanmax(np.abs(expected), axis=0)
    return np.array(
        [
            1.0 if name.endswith("_rad") else size
            for name, size in zip(names, largest_output, strict=True)
        ]
    )


def inputs_of(case: Case, text: str) -> Array:
    """What a header takes, from the case's flight, in double: shape (ROWS, inputs)."""
    origins = headers.origins_of(text)
    single = headers.kind_of(text) == "float"
    remaining = list(case.channels)
    columns = []
    for name in headers.drivers_of(text):
        if re.fullmatch(r"m_ut[012]", name):
            columns.append(case.flight[f"m{'xyz'[int(name[-1])]}_ut"])
        elif single and name == "pt_less_ps_pa" and case.probe == "five-hole":
            columns.append(case.flight["pt_pa"] - case.flight["ps_pa"])
        elif name in ("airspeed_mps", "pt_pa", "dpa_pa", "dpb_pa") or (
            name.removesuffix("_less_origin") in ("rho_kgpm3", "ps_pa")
        ):
            stem = name.removesuffix("_less_origin")
            remaining = [one for one in remaining if STATES.get(one) != stem]
            columns.append(case.flight[stem] - origins.get(name, 0.0))
        else:
            channel = remaining.pop(0)
            values = channel_values(channel, case.calibration, case.flight)
            columns.append(values - origins.get(name, 0.0))
    assert not remaining, f"{remaining} are no arguments of the header"
    return np.column_stack(columns)


RUNNER = """{includes}
#include <stdio.h>
#define LARGEST 64
{functions}
typedef int (*Call)(const double *, double *);
typedef int (*Test)(void);
static const Call calls[] = {{{calls}}};
static const Test tests[] = {{{tests}}};
static const int inputs[] = {{{inputs}}};
static const int outputs[] = {{{outputs}}};
int main(void) {{
  double in[LARGEST];
  double out[LARGEST];
  double count;
  double status;
  int k;
  for (k = 0; k < {number}; ++k) {{
    status = tests[k]();
    if (fwrite(&status, sizeof status, 1, stdout) != 1) return 2;
    if (fread(&count, sizeof count, 1, stdin) != 1) return 2;
    for (; count > 0.0; count -= 1.0) {{
      if (fread(in, sizeof *in, (size_t)inputs[k], stdin) != (size_t)inputs[k]) return 2;
      status = calls[k](in, out);
      if (fwrite(&status, sizeof status, 1, stdout) != 1) return 2;
      if (fwrite(out, sizeof *out, (size_t)outputs[k], stdout) != (size_t)outputs[k]) return 2;
    }}
  }}
  return 0;
}}
"""


@dataclass
class Header:
    """An exported header of a case, and its rows: the case's, then some that are no readings."""

    case: Case
    target: str
    single: bool
    name: str
    text: str
    inputs: Array

    @property
    def prefix(self) -> str:
        """What the names begin with."""
        found = re.findall(r"\b(sepcal_\w+?_\d+)(?:_correct\(| \{$)", self.text, re.MULTILINE)
        return str(found[0]) + ("_" if self.target == "c" else "::")

    def outputs(self) -> int:
        """How many numbers it gives."""
        return sum(size for _, size, output in headers.arguments_of(self.text) if output)


def hostile_rows(inputs: Array) -> Array:
    """The first row with NaN, infinities and huge numbers in each place in turn."""
    values = (np.nan, np.inf, -np.inf, 1e308, -1e308, 1e39, 3e38, 1e-320, 0.0)
    rows = np.repeat(inputs[:1], len(values) * inputs.shape[1], axis=0)
    for column in range(inputs.shape[1]):
        rows[column * len(values) : (column + 1) * len(values), column] = values
    return rows


def call_of(header: Header, number: int) -> str:
    """A function that calls the header's with doubles."""
    kind = "float" if header.single else "double"
    arguments = []
    at = given = 0
    for _, size, output in headers.arguments_of(header.text):
        if output:
            arguments.append(f"&o[{given}]")
            given += size
        else:
            arguments.append(f"{'&' if size > 1 else ''}i[{at}]")
            at += size
    return (
        f"static int call_{number}(const double *in, double *out) {{\n"
        f"  {kind} i[{at}];\n  {kind} o[{given}] = {{0}};\n  int k;\n  int status;\n"
        f"  for (k = 0; k < {at}; ++k) i[k] = ({kind})in[k];\n"
        f"  status = (int){header.prefix}correct({', '.join(arguments)});\n"
        f"  for (k = 0; k < {given}; ++k) out[k] = (double)o[k];\n  return status;\n}}\n"
    )


def write_runner(folder: Path, target: str, batch: list[Header]) -> Path:
    """A program that runs every header of a batch."""
    runner = folder / f"runner.{'c' if target == 'c' else 'cpp'}"
    numbers = range(len(batch))
    runner.write_text(
        RUNNER.format(
            includes="\n".join(f'#include "{header.name}"' for header in batch),
            functions="".join(call_of(header, k) for k, header in enumerate(batch)),
            calls=", ".join(f"call_{k}" for k in numbers),
            tests=", ".join(f"{header.prefix}self_test" for header in batch),
            inputs=", ".join(str(header.inputs.shape[1]) for header in batch),
            outputs=", ".join(str(header.outputs()) for header in batch),
            number=len(batch),
        )
    )
    return runner


def export_all(case: Case, folder: Path) -> list[Header]:
    """The case in both languages and both precisions."""
    made = []
    for target in ("c", "cpp"):
        for single in (False, True):
            number = 2 * case.number + single
            name = f"h{number}.{'h' if target == 'c' else 'hpp'}"
            text = sepcal.export(
                case.calibration, folder / name, target, sensor=number, single=single, force=True
            ).text
            inputs = inputs_of(case, text)
            rows = np.vstack([inputs, hostile_rows(inputs)])
            made.append(Header(case, target, single, name, text, rows))
    return made


def read_answers(batch: list[Header], answer: bytes) -> Iterator[tuple[Header, float, Array]]:
    """Each header with its self-test's result, and its status and outputs by row."""
    numbers = np.frombuffer(answer, dtype="<f8")
    at = 0
    for header in batch:
        width = 1 + header.outputs()
        rows = header.inputs.shape[0]
        table = numbers[at + 1 : at + 1 + rows * width].reshape(rows, width)
        yield header, float(numbers[at]), table
        at += 1 + rows * width
    assert at == numbers.size


def judge(header: Header, self_test: float, table: Array, found: Found) -> list[str]:
    """What is wrong with a header's answers, in words."""
    case = header.case
    wrong: list[str] = []
    if self_test != 0.0:
        wrong.append("its self-test fails")
    status, outputs = table[:ROWS, 0], table[:ROWS, 1:]
    corrected = (status == 0) | (status == 3)
    known = np.isfinite(case.expected).all(axis=1)
    if (corrected != known).any():
        row = int(np.flatnonzero(corrected != known)[0])
        wrong.append(f"row {row}: status {status[row]:.0f} where apply gives {case.expected[row]}")
    both = corrected & known
    if both.any():
        error = np.abs(outputs[both] - case.expected[both]) / case.sizes
        worst = float(error.max())
        found.worst[header.single] = max(found.worst[header.single], worst)
        if not worst <= TOLERANCE[header.single]:
            wrong.append(f"it is {worst:.2g} of the largest reading off")
    said = np.isfinite(case.outside) & both
    if ((status == 3) != (case.outside == 1))[said].any():
        row = int(np.flatnonzero(said & ((status == 3) != (case.outside == 1)))[0])
        wrong.append(f"row {row}: status {status[row]:.0f}, outside {case.outside[row]}")
    hostile, inputs = table[ROWS:], header.inputs[ROWS:]
    with np.errstate(over="ignore"):
        given = inputs.astype(np.float32).astype(float) if header.single else inputs
    no_number = ~np.isfinite(given).all(axis=1)
    if (hostile[no_number, 0] != 1).any():
        wrong.append("an input that is no number is not refused")
    ok = (hostile[:, 0] == 0) | (hostile[:, 0] == 3)
    if not np.isfinite(hostile[ok, 1:]).all():
        wrong.append("an output is no number where the status is ok")
    found.rows += table.shape[0]
    return wrong


def check_batch(
    batch: list[Header], target: str, standard: str, folder: Path, found: Found
) -> None:
    """Compiles a batch by every compiler, plainly and with sanitizers, and compares."""
    runner = write_runner(folder, target, batch)
    told = b"".join(
        np.array([float(header.inputs.shape[0])]).tobytes() + header.inputs.tobytes()
        for header in batch
    )
    compilers = [one for one in COMPILERS[target, standard] if shutil.which(one) is not None]
    jobs = [(one, options) for one in compilers for options in (STRICT, SANITIZED)]

    def run(job: tuple[str, tuple[str, ...]]) -> tuple[str, str, bytes]:
        compiler, options = job
        program = folder / f"{compiler}{'_sanitized' if options is SANITIZED else ''}"
        command = [compiler, f"-std={standard}", *options, runner.name, "-o", program.name, "-lm"]
        built = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if built.returncode != 0:
            return " ".join(command), built.stderr, b""
        done = subprocess.run([program], input=told, capture_output=True, check=False)
        return " ".join(command), done.stderr.decode() if done.returncode else "", done.stdout

    with ThreadPoolExecutor(2) as pool:
        for command, error, answer in pool.map(run, jobs):
            found.compiled += 1
            if error:
                found.findings.append(f"{command}: {error[:2000]}")
                continue
            for header, self_test, table in read_answers(batch, answer):
                for what in judge(header, self_test, table, found):
                    found.findings.append(
                        f"{header.name} of {header.case.probe} with {header.case.effects}, "
                        f"{command.split()[0]}: {what}"
                    )


def run(
    exports: int,
    seed: int,
    folder: Path,
    seconds: float = float("inf"),
    say: Callable[[str], object] = lambda line: None,
) -> Found:
    """Makes and checks so many exports, or as many as fit into the time."""
    found = Found()
    began = time.monotonic()
    number = 0
    while found.exports < exports and time.monotonic() - began < seconds:
        cases: list[Case] = []
        at_once = min(BATCH, exports - found.exports)
        while len(cases) < at_once:
            case = make_case(len(cases) + 1, seed * 1_000_000 + number)
            number += 1
            if case is None:
                found.refused += 1
                continue
            cases.append(case)
            found.exports += 1
        place = folder / f"batch_{found.exports}"
        place.mkdir(parents=True)
        before = len(found.findings)
        made: list[Header] = []
        for case in cases:
            try:
                made += export_all(case, place)
            except (sepcal.Error, AssertionError) as error:
                found.findings.append(f"{case.probe} with {case.effects}: {error}")
        for target, standard in COMPILERS:
            batch = [header for header in made if header.target == target]
            check_batch(batch, target, standard, place, found)
        if len(found.findings) == before:
            shutil.rmtree(place)
        say(f"{found.exports} exports, {found.compiled} programs, {len(found.findings)} findings")
    return found


def main() -> int:
    """Does what the command line says; 1 at a finding."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--exports", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--folder", type=Path, default=Path("build/random_exports"))
    chosen = parser.parse_args()
    shutil.rmtree(chosen.folder, ignore_errors=True)
    began = time.monotonic()
    found = run(
        chosen.exports, chosen.seed, chosen.folder, chosen.seconds, say=partial(print, flush=True)
    )
    for line in found.findings:
        print(line)
    print(
        f"{found.exports} exports ({found.refused} draws refused) of seed {chosen.seed} in "
        f"{(time.monotonic() - began) / 60:.1f} min: {found.compiled} programs, {found.rows} rows; "
        f"furthest from apply: {found.worst[False]:.2g} in double, "
        f"{found.worst[True]:.2g} in float; "
        f"{len(found.findings)} findings"
    )
    return int(bool(found.findings))


if __name__ == "__main__":
    sys.exit(main())
