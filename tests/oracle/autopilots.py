# SPDX-License-Identifier: BSD-3-Clause
"""How ArduPilot and PX4 correct a compass and an airspeed, from their parameter files.

ArduPilot, as its compass backend corrects a field in mG: the offsets are added, the sum is scaled
by COMPASS_SCALE (where it lies within 1/1.5 to 1.5) and multiplied by the symmetric matrix of
diagonals and off-diagonals, then the motors' field is added, MOT times the throttle (COMPASS_MOTCT
1) or the current in A (2). Its airspeed is the root of the ratio times the pressure less the
offset, an equivalent airspeed; the true one is EAS2TAS = sqrt(1.225 / rho) times that.

PX4, as its sensor calibration corrects a field in G in the sensor's axes: COMP times the throttle
(CAL_MAG_COMP_TYP 1) or the current in kA (2) is added, the offset is taken off, the symmetric
matrix of SCALE and ODIAG multiplies, and the mounting turns the result into body axes. Its airspeed
is sqrt(2 dp / 1.225) with dp less SENS_DPRES_OFF, times ASPD_SCALE_n: the calibrated, at low speed
equivalent, airspeed.
"""

from pathlib import Path

import numpy as np

from oracle.model import Array

SEA_LEVEL_DENSITY = 1.225
FLOAT, WHOLE = "9", "6"


def read_ardupilot(file: Path) -> dict[str, float]:
    """NAME,VALUE lines and comments."""
    parameters = {}
    for line in file.read_text().splitlines():
        if line.startswith("#"):
            continue
        name, value = line.split(",")
        assert name not in parameters
        parameters[name] = float(np.float32(value))
    return parameters


def read_px4(file: Path) -> dict[str, float]:
    """QGroundControl's lines: vehicle, component, name, value, type, by tabs; and comments."""
    parameters = {}
    for line in file.read_text().splitlines():
        if line.startswith("#"):
            continue
        vehicle, component, name, value, kind = line.split("\t")
        assert (vehicle, component) == ("1", "1")
        assert name not in parameters
        assert kind in (FLOAT, WHOLE)
        parameters[name] = int(value) if kind == WHOLE else float(np.float32(value))
    return parameters


def triple(parameters: dict[str, float], names: str) -> Array:
    """Three values: `names` with x, y, z for the question mark."""
    return np.array([parameters[names.replace("?", axis)] for axis in "XYZ"])


def symmetric(diagonal: Array, off: Array) -> Array:
    """Of xx, yy, zz and xy, xz, yz."""
    x, y, z = diagonal
    xy, xz, yz = off
    return np.array([[x, xy, xz], [xy, y, yz], [xz, yz, z]])


def ardupilot_field(
    parameters: dict[str, float], raw_ut: Array, *, sensor: int = 1, motor: Array | float = 0.0
) -> Array:
    """The field in uT of raw readings (N, 3) in uT; `motor`: (N,) the throttle or the current."""
    number = "" if sensor == 1 else str(sensor)
    matrix = symmetric(
        triple(parameters, f"COMPASS_DIA{number}_?"), triple(parameters, f"COMPASS_ODI{number}_?")
    )
    scale = parameters[f"COMPASS_SCALE{number}"]
    assert 1 / 1.5 <= scale <= 1.5
    field = (raw_ut * 10 + triple(parameters, f"COMPASS_OFS{number}_?")) * scale @ matrix.T
    if parameters.get("COMPASS_MOTCT", 0):
        field = field + np.outer(
            np.broadcast_to(motor, len(field)), triple(parameters, f"COMPASS_MOT{number}_?")
        )
    return field / 10


def px4_field(
    parameters: dict[str, float],
    raw_ut: Array,
    *,
    sensor: int = 0,
    motor: Array | float = 0.0,
    mounting: Array | None = None,
) -> Array:
    """The same; `raw_ut` in the sensor's axes, `mounting` turns these into the body's."""
    name = f"CAL_MAG{sensor}_?"
    matrix = symmetric(triple(parameters, name + "SCALE"), triple(parameters, name + "ODIAG"))
    kind = parameters.get("CAL_MAG_COMP_TYP", 0)
    power = np.broadcast_to(motor, len(raw_ut)) * {0: 0.0, 1: 1.0, 2: 1e-3}[int(kind)]
    raw = raw_ut / 100 + np.outer(power, triple(parameters, name + "COMP"))
    field = (raw - triple(parameters, name + "OFF")) @ matrix.T
    return 100 * field @ (np.eye(3) if mounting is None else mounting).T


def ardupilot_airspeed(
    parameters: dict[str, float], pressure: Array, density: Array, *, sensor: int = 1
) -> Array:
    """The true airspeed [m/s] of a differential pressure [Pa]."""
    name = "ARSPD" if sensor == 1 else f"ARSPD{sensor}"
    net = np.maximum(pressure - parameters[name + "_OFFSET"], 0)
    return np.sqrt(net * parameters[name + "_RATIO"]) * np.sqrt(SEA_LEVEL_DENSITY / density)


def px4_airspeed(
    parameters: dict[str, float], pressure: Array, density: Array, *, sensor: int = 1
) -> Array:
    """The same."""
    net = np.maximum(pressure - parameters["SENS_DPRES_OFF"], 0)
    calibrated = parameters[f"ASPD_SCALE_{sensor}"] * np.sqrt(2 * net / SEA_LEVEL_DENSITY)
    return calibrated * np.sqrt(SEA_LEVEL_DENSITY / density)


def flow_of_sdp3x(pressure: Array, density: Array) -> Array:
    """Flow through an SDP31, 32 or 33, as both autopilots have it; never below zero."""
    flow = 300.805 - 300.878 / (0.00344205 * pressure**0.68698 + 1)
    return np.maximum(flow * 1.29 / density, 0.0)


def px4_sdp3x(
    pressure: Array,
    static: Array,
    kelvin: Array,
    *,
    model: int = 0,
    length: float = 0.2,
    diameter_mm: float = 1.5,
) -> Array:
    """PX4's indicated airspeed [m/s] of an SDP3x' pressure [Pa], as calc_IAS_corrected() does."""
    density = static / (287.1 * kelvin)
    if model == 2:
        viscosity = (18.205 + 0.0484 * (kelvin - 293.15)) * 1e-6
        root = np.sqrt(1 + 8 * pressure / 59.3319) - 1
        area = np.pi * (diameter_mm / 1000) ** 4 * density * pressure
        share = -64 * length * viscosity * 4.79e-7 * root / area
        return np.sqrt(2 * pressure / (1 + np.where(np.abs(share) < 1, share, 0)) / 1.225)
    corrected = pressure * 96600 / static
    flow = flow_of_sdp3x(corrected, density)
    pitot = (0.0032 * flow**2 + 0.0123 * flow + 1) * 1.29 / density
    tube = flow * 0.674 / 450 * length * density / 1.29
    total = corrected + tube + (0 if model == 1 else pitot)
    return np.sqrt(2 * total / 1.225) + 0.125 * flow


def ardupilot_sdp3x(pressure: Array, static: Array, kelvin: Array, ratio: float) -> Array:
    """What ArduPilot's driver hands on for an SDP3x' pressure; times the ratio, its root is EAS."""
    density = static / (287.1 * kelvin)
    flow = flow_of_sdp3x(pressure, density)
    pitot = 28557670.0 - 28557670.0 / (1 + (flow / 5027611.0) ** 1.227924)
    uncorrected = (pressure + pitot) / 1.225
    return (np.sqrt(uncorrected * ratio) + 0.0331582 * flow) ** 2 / ratio


def level_heading(field: Array, roll: Array, pitch: Array) -> Array:
    """Magnetic heading [rad] of fields (N, 3) in body axes, turned level by roll and pitch."""
    x, y, z = field.T
    across = np.cos(roll) * y - np.sin(roll) * z
    below = np.sin(roll) * y + np.cos(roll) * z
    return np.arctan2(-across, np.cos(pitch) * x + np.sin(pitch) * below)


def fit_symmetric(field: Array, raw: Array, driver: Array | None = None) -> tuple[Array, ...]:
    """C symmetric, n and kappa of raw = C field + n + kappa driver by weighted least squares.

    Weights are the axes' own residuals, found again until they settle: maximum likelihood.
    """
    x, y, z = field.T
    zero, one = np.zeros_like(x), np.ones_like(x)
    rows = [
        [x, zero, zero, y, z, zero],
        [zero, y, zero, x, zero, z],
        [zero, zero, z, zero, x, y],
    ]
    blocks = []
    for axis in range(3):
        unit = [one if k == axis else zero for k in range(3)]
        driven = [] if driver is None else [driver if k == axis else zero for k in range(3)]
        blocks.append(np.column_stack([*rows[axis], *unit, *driven]))
    noise = np.ones(3)
    for _ in range(200):
        matrix = np.concatenate([b / s for b, s in zip(blocks, noise, strict=True)])
        measured = np.concatenate([raw[:, k] / noise[k] for k in range(3)])
        xi = np.linalg.lstsq(matrix, measured, rcond=None)[0]
        noise = np.array([np.sqrt(np.mean((raw[:, k] - blocks[k] @ xi) ** 2)) for k in range(3)])
    return symmetric(xi[:3], xi[3:6]), xi[6:9], xi[9:] if driver is not None else np.zeros(3)
