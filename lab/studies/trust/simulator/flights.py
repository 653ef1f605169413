# SPDX-License-Identifier: BSD-3-Clause
"""A flight of the simulator: of a seed and a row of the table, with what is hidden in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studies.trust.noises import Array
from studies.trust.simulator.causes import Cause
from studies.trust.simulator.channels import log_channels
from studies.trust.simulator.compass import COMPASS, FIELD
from studies.trust.simulator.disturbances import DISTURBANCES, Log, disturb
from studies.trust.simulator.instrument import VELOCITY, Columns, Instrument, Truth
from studies.trust.simulator.manoeuvres import fly
from studies.trust.simulator.probes import INSTRUMENTS
from studies.trust.simulator.sizes import Slopes, size_for_share, take_slopes

LENGTHS = (  # rows and their rate [Hz], from two to ten minutes
    *((600, 2.0), (600, 4.0), (600, 5.0), (900, 2.0), (900, 5.0)),
    *((1200, 2.0), (1200, 5.0), (1200, 10.0), (1800, 5.0), (2400, 10.0)),
)
LEAST_VISIBILITY = 0.15  # of a cause that a flight is asked about
MOST_DRAWS = 50


@dataclass(frozen=True)
class Hidden:
    """A cause in a flight."""

    cause: Cause
    loudness: float  # rms in the output where it is the largest
    visibility: float  # the sine of its angle to what the parameters do
    wander: float  # of the instrument, as stated, in that output's unit; 0 where it has none

    @property
    def can_be_shown(self) -> bool:
        """Whether the flight could show it, and there is a size as was asked for."""
        return self.visibility >= LEAST_VISIBILITY and math.isfinite(self.loudness)


@dataclass(frozen=True)
class Flown:
    """A log and what is true of it."""

    columns: Columns
    truth: Truth
    hidden: tuple[Hidden, ...]


def rows_of(seed: int) -> int:
    """How long the flight of a seed is."""
    return LENGTHS[_draw(seed, 0).integers(len(LENGTHS))][0]


def fly_log(
    probe: str, noise: str, seed: int, causes: Sequence[tuple[Cause, str, float]] = ()
) -> Flown:
    """A log with causes, each by what is asked of its size. One that hides them is drawn anew.

    ("share", s): it takes s of the RMSE on rows held out, the other causes being modelled.
    ("loudness", r): its rms is r, in the output where it is the largest, in that output's unit.
    ("wander", k): its rms is so k times the stated wander.
    """
    for draw in range(MOST_DRAWS):
        flown = _try(probe, noise, seed, draw, causes)
        if all(hidden.can_be_shown for hidden in flown.hidden):
            break
    return flown


def _draw(seed: int, *what: int) -> np.random.Generator:
    return np.random.default_rng([seed, *what])


def _try(
    probe: str, noise: str, seed: int, draw: int, causes: Sequence[tuple[Cause, str, float]]
) -> Flown:
    instrument = INSTRUMENTS[probe]
    rows, rate = LENGTHS[_draw(seed, 0).integers(len(LENGTHS))]
    flying = _draw(seed, 1, draw)
    motion = fly(flying, rows, rate, instrument.lively)
    truth = instrument.draw_truth(flying)
    channels = log_channels(flying, motion)
    kind = DISTURBANCES[noise]
    which = list(DISTURBANCES).index(noise)

    def log_with(change: Columns) -> Log:
        return disturb(
            noise, _draw(seed, 2, draw, which), instrument, motion, truth, change, channels
        )

    quiet = log_with({}).columns | channels
    drawn = _draw(seed, 3, draw)
    cast = [_cast(drawn, instrument, quiet, truth, cause) for cause, _, _ in causes]
    wander = kind.wanders(probe, motion) if kind.wanders else 0.0
    change: Columns = {}
    hidden = []
    for (cause, asked, much), (phi, slopes) in zip(causes, cast, strict=True):
        own = slopes.beside([other for _, other in cast if other is not slopes])
        if asked == "share":
            size = size_for_share(own, much)
        else:
            size = much * (wander if asked == "wander" else 1.0) / own.loudness
        change[cause.port] = change.get(cause.port, 0.0) + size * phi
        hidden.append(Hidden(cause, abs(size) * own.loudness, own.visibility, wander))
    return Flown(_as_logged(log_with(change)), truth, tuple(hidden))


def _cast(
    rng: np.random.Generator, instrument: Instrument, log: Columns, truth: Truth, cause: Cause
) -> tuple[Array, Slopes]:
    """A cause of size one (components, N), and what it would do to the outputs."""
    driver = log["time_s" if cause.driver == "time" else cause.driver]
    phi = cause.draw(rng, driver)
    direction = rng.standard_normal(len(instrument.ports[cause.port]))
    direction /= np.linalg.norm(direction)
    slopes = take_slopes(instrument, log, truth, cause, phi, direction)
    return direction[:, None] * phi, slopes


def _as_logged(log: Log) -> Columns:
    """The columns that an app takes."""
    columns = log.columns | log.channels | log.positions
    if log.positions:
        for header in VELOCITY:
            del columns[header]
    if log.instrument.name == COMPASS.name:
        north_east_down = dict(zip(("bn_ut", "be_ut", "bd_ut"), FIELD, strict=True))
        columns |= {name: np.full(log.motion.time.size, b) for name, b in north_east_down.items()}
    return columns
