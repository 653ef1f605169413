# SPDX-License-Identifier: BSD-3-Clause
"""README's picture: an effect hidden in a flight, the error without it and with it.

Usage: picture.py PICTURE.svg. The flight is that of README's loop.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import sepcal
from sepcal.columns import Array

OUTPUTS = ("vn", "ve", "vd")
NOISE = 0.15  # of each output [m/s]
RATE = 10  # [Hz]
WINDOW = 10 * RATE  # rows that one point of a curve is the RMSE of

# Each reads on a white page and on a dark one.
GREY, BEFORE, AFTER = "#7d858f", "#dd641b", "#2f81f7"


def moving_rmse(fitted: sepcal.Calibration, flight: sepcal.Flight) -> Array:
    """RMSE of the outputs over the window about each row, (N,); about the ends it is shorter."""
    modelled = fitted.predict().value
    measured = np.stack([flight[f"{name}_mps"] for name in OUTPUTS], axis=1)
    squares = np.mean((measured - modelled) ** 2, axis=1)
    window = np.ones(WINDOW)
    sums = np.convolve(squares, window, "same") / np.convolve(np.ones(len(squares)), window, "same")
    rmse: Array = np.sqrt(sums)
    return rmse


def draw_errors(axes: Axes, time: Array, before: Array, after: Array) -> None:
    """Both errors, the noise, and what adding the effect took away between them."""
    axes.fill_between(time, after, before, color=BEFORE, alpha=0.16, linewidth=0)
    axes.plot(time, before, color=BEFORE, linewidth=1.6)
    axes.plot(time, after, color=AFTER, linewidth=1.8)
    axes.axhline(NOISE, color=GREY, linestyle=(0, (5, 4)), linewidth=1.1)
    axes.set_ylabel("RMSE over 10 s [m/s]")
    axes.set_ylim(0, 0.52)


def label_errors(axes: Axes, step: sepcal.HistoryEntry) -> None:
    """The curves' numbers and names, in their colours."""
    assert step.rmse_before
    assert step.predicted_drop
    promised = step.rmse_before * (1 - step.predicted_drop)
    added = f"with {step.effect}; diagnose promised {promised:.3f} m/s"
    labels = [
        (0.92, BEFORE, f"{step.rmse_before:.3f} m/s", "after the fit: something is missing"),
        (0.17, AFTER, f"{step.rmse_after:.3f} m/s", added),
        (0.06, GREY, f"{NOISE:.3f} m/s", "the sensor's noise, dashed"),
    ]
    for height, colour, number, words in labels:
        bold = axes.text(0.012, height, number, weight="bold", transform=axes.transAxes)
        beside = axes.annotate(words, (1, 0), (7, 0), xycoords=bold, textcoords="offset points")
        for text in (bold, beside):
            text.set(color=colour, va="bottom")


def draw_throttle(axes: Axes, time: Array, throttle: Array) -> None:
    """What drives the hidden effect."""
    axes.plot(time, throttle, color=GREY, linewidth=1.2)
    axes.set_ylabel("throttle [1]")
    axes.set_ylim(0, 1)
    axes.set_xlabel("time [s]")


def draw(picture: Path, base: sepcal.Calibration, better: sepcal.Calibration) -> None:
    """The picture of a calibration and the same with an effect, both of one flight."""
    flight, step = better.flight, better.history[-1]
    assert flight
    told = f"RMSE {step.rmse_before:.3f} -> {step.rmse_after:.3f} m/s with {step.effect}"
    print(told)
    with mpl.rc_context():
        mpl.rc("font", size=11.5)
        mpl.rc("axes", labelcolor=GREY, edgecolor=GREY)
        mpl.rc("xtick", color=GREY)
        mpl.rc("ytick", color=GREY)
        mpl.rc("svg", hashsalt="sepcal")  # the same names within the file every time
        figure = Figure(figsize=(9.0, 4.4), layout="constrained")
        errors, throttle = figure.subplots(2, 1, sharex=True, height_ratios=[3.4, 1])
        for axes in (errors, throttle):
            axes.spines[["top", "right"]].set_visible(False)
            axes.margins(x=0)
        some = slice(None, None, 2 * RATE)  # a point in 2 s: enough to see, and a small file
        curves = [moving_rmse(fitted, flight)[some] for fitted in (base, better)]
        draw_errors(errors, flight["time_s"][some], *curves)
        label_errors(errors, step)
        draw_throttle(throttle, flight["time_s"][::RATE], flight["throttle"][::RATE])
        figure.savefig(picture, transparent=True, metadata={"Date": None, "Description": told})


def main(picture: Path) -> None:
    """Flies, fits, diagnoses, adds, draws."""
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    noise = dict.fromkeys(OUTPUTS, NOISE)
    flight = sepcal.simulate(probe, hide={"propwash": 40.0}, noise=noise, rate=RATE, seed=1)
    base = sepcal.fit(probe, flight)
    found = base.diagnose()
    draw(picture, base, base.add(found.effects[0].name))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
