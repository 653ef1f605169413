# SPDX-License-Identifier: BSD-3-Clause
"""What a log's numbers are disturbed by, as recorded ones are: a row of the table each.

Sizes are those of bounds.py; a wander is half its bound or more, never beyond it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from studies.trust.noises import OUTPUT_NOISES, Array, first_order
from studies.trust.simulator import bounds
from studies.trust.simulator.compass import FIELD
from studies.trust.simulator.five_hole import SENSITIVITY
from studies.trust.simulator.ground_track import fly_path
from studies.trust.simulator.instrument import (
    AIR_DATA,
    ATTITUDE,
    RATES,
    READINGS,
    VELOCITY,
    Change,
    Columns,
    Instrument,
    Truth,
)
from studies.trust.simulator.manoeuvres import Motion

AIR = ("five-hole", "pitot-static")
WITH_ATTITUDE = ("five-hole", "magnetometer")
EVERY = ("five-hole", "pitot-static", "magnetometer")
EARTH = 6371000.0  # [m]


@dataclass
class Log:
    """A log that is being disturbed."""

    rng: np.random.Generator
    instrument: Instrument
    motion: Motion
    columns: Columns
    channels: Columns
    positions: Columns = field(default_factory=dict)  # logged in place of the velocity

    @property
    def white(self) -> float:
        """The noise from row to row, in the outputs' unit."""
        return bounds.WHITE[self.instrument.name]


Disturb = Callable[[Log], None]


@dataclass(frozen=True)
class Disturbance:
    """`outputs` takes the place of white noise; what is left to do is `further`."""

    probes: tuple[str, ...] = EVERY
    outputs: str = "white"
    further: Disturb | None = None
    gusty: bool = False
    wanders: Callable[[str, Motion], float] | None = None  # the stated bound, in an output's unit


def _wander(rng: np.random.Generator, time: Array, seconds: float) -> Array:
    """Gauss-Markov, of unit size."""
    return first_order(float(np.exp(-(time[1] - time[0]) / seconds)))(rng, time)


def _share(rng: np.random.Generator) -> float:
    return float(rng.uniform(0.5, 1.0))


def _gauss_markov(seconds: float) -> Disturb:
    def disturb(log: Log) -> None:
        for header in log.instrument.outputs:
            size = bounds.OF_OUTPUTS[log.instrument.name] * _share(log.rng)
            log.columns[header] += size * _wander(log.rng, log.motion.time, seconds)

    return disturb


def _random_walk(log: Log) -> None:
    for header in log.instrument.outputs:
        walk = np.cumsum(log.rng.standard_normal(log.motion.time.size))
        size = bounds.OF_OUTPUTS[log.instrument.name] * _share(log.rng)
        log.columns[header] += size * (walk - walk.mean()) / walk.std()


def _attitude(log: Log) -> None:
    """About its mean: an attitude that is off throughout is an effect, as heading_bias is."""
    seconds = float(np.exp(log.rng.uniform(np.log(20.0), np.log(300.0))))
    limits = (bounds.TILT, bounds.TILT, bounds.HEADING)
    for header, limit in zip(ATTITUDE, limits, strict=True):
        size = limit * _share(log.rng)
        error = _wander(log.rng, log.motion.time, seconds)
        log.columns[header] += size * (error - error.mean())


def _steps(log: Log) -> dict[str, float]:
    """By column, what moves an output by about its white noise."""
    white = log.white
    speed = float(np.mean(log.motion.airspeed))
    density = float(np.mean(log.columns.get("rho_kgpm3", np.array([1.0]))))
    pressure = density * speed * white
    angle = white / (float(np.linalg.norm(FIELD)) if "mx_ut" in log.columns else speed)
    port = SENSITIVITY * 0.5 * density * speed**2 * angle
    return {
        **dict.fromkeys(log.instrument.outputs, white),
        **dict.fromkeys((header for header in VELOCITY if header in log.columns), white),
        **dict.fromkeys(ATTITUDE, angle),
        **dict.fromkeys(RATES, angle),
        **dict.fromkeys(("pt_pa", "ps_pa"), pressure),
        **dict.fromkeys(("dpa_pa", "dpb_pa"), port),
    }


def _quantised(times: float) -> Disturb:
    """Inputs and outputs, in steps of so many times what the noise does."""

    def disturb(log: Log) -> None:
        for header, step in _steps(log).items():
            if header in log.columns:
                log.columns[header] = np.round(log.columns[header] / (times * step)) * times * step

    return disturb


def _noisy_inputs(log: Log) -> None:
    """White noise of each input, which does up to one and a half times what the outputs' own does.

    Louder noise bends the fit itself: errors in variables, which no test of what is left can mend.
    """
    for header, size in _steps(log).items():
        if header in log.columns and header not in log.instrument.outputs:
            loud = size * log.rng.uniform(0.3, 1.5)
            log.columns[header] += loud * log.rng.standard_normal(log.motion.time.size)


def _rows_an_answer(log: Log) -> int:
    """Of a sensor that answers in one row of so many, once a second or oftener."""
    step = float(log.motion.time[1] - log.motion.time[0])
    return int(log.rng.integers(2, max(2, min(5, round(1.0 / step))) + 1))


def _held(log: Log) -> None:
    """The columns of which the catalogue can say that they are late: the air's, or the outputs.

    A tube's velocity is held: its airspeed is early beside it.
    """
    rows = _rows_an_answer(log)
    late = {"five-hole": AIR_DATA, "pitot-static": VELOCITY, "magnetometer": READINGS}
    for header in late[log.instrument.name]:
        log.columns[header] = np.repeat(log.columns[header][::rows], rows)[: log.motion.time.size]


def _interpolated(log: Log) -> None:
    """A receiver's velocity or a compass's readings: their straight lines cut turns."""
    rows, time = _rows_an_answer(log), log.motion.time
    for header in READINGS if log.instrument.name == "magnetometer" else VELOCITY:
        log.columns[header] = np.interp(time, time[::rows], log.columns[header][::rows])


def _outliers(log: Log) -> None:
    """One cell of a hundred, by ten to thirty times the noise."""
    for header in log.instrument.outputs:
        hit = log.rng.random(log.motion.time.size) < 0.01
        far = log.rng.uniform(10.0, 30.0, int(hit.sum())) * log.rng.choice([-1.0, 1.0], hit.sum())
        log.columns[header][hit] += log.white * far


def _sentinels(log: Log) -> None:
    """Twenty cells of each channel: no driver was read there."""
    for header, values in log.channels.items():
        cells = log.rng.choice(values.size, 20, replace=False)
        log.channels[header] = values.copy()
        log.channels[header][cells] = log.rng.choice([-9999.0, 0.0])


def _positions(log: Log) -> None:
    """Fixes that are 0.1 m off from one to the next, and wander by 1 m.

    The velocity that the study's own model reads is off by what a straight line through a second of
    fixes makes of that.
    """
    time = log.motion.time
    step = float(time[1] - time[0])
    window = max(5, 2 * round(1.0 / step) + 1)
    velocity = [log.columns[header] for header in VELOCITY]
    fixes = fly_path(velocity, time, (0.82, 0.2, float(log.motion.altitude[0])))
    per_metre = (1.0 / EARTH, 1.0 / (EARTH * np.cos(0.82)), 1.0)
    for header, fix, scale, sign in zip(VELOCITY, fixes, per_metre, (1, 1, -1), strict=True):
        off = 0.1 * log.rng.standard_normal(time.size) + _wander(log.rng, time, 60.0)
        fix += off * scale
        log.columns[header] = log.columns[header] + sign * _slope(off, window) / step
    log.positions = {"lat_deg": np.degrees(fixes[0]), "lon_deg": np.degrees(fixes[1])}
    log.channels["altitude_m"] = fixes[2]


def _slope(values: Array, window: int) -> Array:
    """Of the straight line through so many values about each."""
    half = window // 2
    offsets = np.arange(-half, half + 1)
    padded = np.pad(values, half, mode="reflect", reflect_type="odd")
    return np.convolve(padded, offsets[::-1] / np.sum(offsets**2), mode="valid")


def _of_outputs(probe: str, _: Motion) -> float:
    return bounds.OF_OUTPUTS[probe]


def _of_gusts(_: str, __: Motion) -> float:
    return bounds.GUST


HELD, NOISE_HELD = "columns held", "noise held"
DISTURBANCES: Mapping[str, Disturbance] = {
    "white": Disturbance(),
    "AR(0.9)": Disturbance(outputs="AR(0.9)"),
    "AR(0.99)": Disturbance(outputs="AR(0.99)", wanders=_of_outputs),
    "Gauss-Markov 10 s": Disturbance(further=_gauss_markov(10.0), wanders=_of_outputs),
    "Gauss-Markov 60 s": Disturbance(further=_gauss_markov(60.0), wanders=_of_outputs),
    "Gauss-Markov 300 s": Disturbance(further=_gauss_markov(300.0), wanders=_of_outputs),
    "random walk": Disturbance(further=_random_walk, wanders=_of_outputs),
    "pink": Disturbance(outputs="pink", wanders=_of_outputs),
    "bursty": Disturbance(outputs="bursty"),
    "gusts": Disturbance(probes=AIR, gusty=True, wanders=_of_gusts),
    "attitude": Disturbance(probes=WITH_ATTITUDE, further=_attitude, wanders=bounds.of_attitude),
    "noise of inputs": Disturbance(further=_noisy_inputs),
    "inputs noisier than outputs": Disturbance(outputs="filtered", further=_noisy_inputs),
    "quantised at 1 noise": Disturbance(further=_quantised(1.0)),
    "quantised at 3 noises": Disturbance(further=_quantised(3.0)),
    NOISE_HELD: Disturbance(outputs="held fivefold"),
    HELD: Disturbance(further=_held),
    "columns interpolated": Disturbance(further=_interpolated),
    "outliers": Disturbance(further=_outliers),
    "sentinels": Disturbance(further=_sentinels),
    "velocity from positions": Disturbance(probes=AIR, further=_positions),
}
WANDERING = tuple(name for name, kind in DISTURBANCES.items() if kind.wanders)


def disturb(
    noise: str,
    rng: np.random.Generator,
    instrument: Instrument,
    motion: Motion,
    truth: Truth,
    change: Change,
    channels: Columns,
) -> Log:
    """The log of a motion in a row's noise, whose draws do not depend on what is hidden."""
    kind = DISTURBANCES[noise]
    gust = np.zeros((motion.time.size, 3))
    if kind.gusty:
        seconds = float(np.exp(rng.uniform(0.0, np.log(bounds.LONGEST_GUST))))
        for component in gust.T:
            component += bounds.GUST * _share(rng) * _wander(rng, motion.time, seconds)
    measured = instrument.measure(motion, truth, change, gust)
    log = Log(rng, instrument, motion, measured, dict(channels))
    for header in instrument.outputs:
        noise_there = OUTPUT_NOISES[kind.outputs](rng, motion.time)
        log.columns[header] = log.columns[header] + log.white * noise_there
    if kind.further is not None:
        kind.further(log)
    return log
