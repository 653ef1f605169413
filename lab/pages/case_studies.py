# SPDX-License-Identifier: BSD-3-Clause
"""The numbers and the picture of docs/case-studies.md, from recorded flights.

Usage: case_studies.py FOLDER PICTURE.svg, FOLDER with the recordings that the tests use.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from case_steps import Step, Study, Told, examine
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from picture import AFTER, BEFORE, GREY

import sepcal

OCTOCOPTER = sepcal.Magnetometer(field=(19.72, -1.41, 49.44))  # where it flew [uT]
TUBE = sepcal.PitotStatic()

STUDIES = (
    Study(
        "magnetometer beside the wiring",
        "octocopter_internal_mag.csv",
        OCTOCOPTER,
        "uT",
        extra=["bias[current_a]"],
    ),
    Study(
        "magnetometer on a mast",
        "octocopter_external_mag.csv",
        OCTOCOPTER,
        "uT",
        extra=["bias[voltage_v]", "bias[motor5_us]", "field_declination"],
    ),
    Study(
        "magnetometer turned by hand",
        "bench_tilt_sphere_mag.csv",
        sepcal.Magnetometer(field_strength=48.0),
        "uT",
        extra=["bias[spline(time,6)]"],
    ),
    Study(
        "small aircraft's tube",
        "uav_pitot_static_2022_05_07_11.csv",
        TUBE,
        "m/s",
        extra=["wind[altitude_m]"],
    ),
    Study("tube on the way to the stall", "rv_deceleration_stall.csv", TUBE, "m/s"),
    Study("airliner", "airliner_mode_s.csv", TUBE, "m/s", extra=["wind[spline(time,6)]"]),
    Study(
        "airliner, its sensor held",
        "airliner_mode_s.csv",
        TUBE,
        "m/s",
        {"fix": {"s_va": 1.0, "c_va": 0.0}},
    ),
    Study("wind tunnel, five probes", "aeroprobe_wind_tunnel.csv", TUBE),
    Study("wind tunnel, 5 psf", "airball_wind_tunnel_5psf.csv", TUBE),
    Study("wind tunnel, 20 psf", "airball_wind_tunnel_20psf.csv", TUBE),
    Study("jet, longitudinal", "harv_longitudinal.csv", TUBE),
    Study("ULog", "px4_log.ulg", OCTOCOPTER),
    Study("DataFlash", "arducopter_log.bin", OCTOCOPTER),
)


def count_advice(told: Sequence[Told]) -> None:
    """How often something was advised and withheld, and what following it did."""
    followed = [step for one in told for step in one.steps if step.advised]
    harmed = [step.effect for step in followed if step.harmed]
    print(
        f"\nadvice: {sum(one.diagnoses for one in told)} diagnoses, {len(followed)} times next, "
        f"{sum(one.withheld for one in told)} candidates withheld; "
        f"held-out rows or the other half got worse after {len(harmed)}: {', '.join(harmed) or '-'}"
    )


def draw(axes: Axes, study: Study, steps: Sequence[Step], most: int) -> None:
    """Bars of the error of rows held out, before and after, with room for `most` steps."""
    for place, step in enumerate(steps):
        for offset, value, colour in zip((-0.2, 0.2), step.held_out, (BEFORE, AFTER), strict=True):
            axes.barh(place + offset, value, 0.36, color=colour)
    names = [f"{'next: ' * step.advised}{step.effect}" for step in steps]
    axes.set_yticks(range(len(steps)), names)
    axes.set_ylim(most - 0.4, -0.6)
    axes.set_title(f"{study.title} [{study.unit}]", color=GREY, fontsize=11)
    axes.spines[["top", "right"]].set_visible(False)


def draw_all(told: Sequence[Told], picture: Path) -> None:
    """A panel for each recording to which something was added."""
    drawn = [(study, one.steps) for study, one in zip(STUDIES, told, strict=True) if one.steps]
    with mpl.rc_context():
        for part in ("axes.edgecolor", "xtick.color", "ytick.color"):
            mpl.rcParams[part] = GREY
        mpl.rcParams["svg.hashsalt"] = "sepcal"  # the same names within the file every time
        figure = Figure(figsize=(11.0, 7.0), layout="constrained")
        pairs = [drawn[at : at + 2] for at in range(0, len(drawn), 2)]
        most = [max(len(steps) for _, steps in pair) for pair in pairs]  # so all bars are as thick
        places = figure.subplots(len(pairs), 2, height_ratios=most).ravel()
        for at, (axes, (study, steps)) in enumerate(zip(places, drawn, strict=False)):
            draw(axes, study, steps, most[at // 2])
        for empty in places[len(drawn) :]:
            empty.set_axis_off()
        figure.savefig(picture, transparent=True, metadata={"Date": None})


def main(folder: Path, picture: Path) -> None:
    """Prints everything and draws the error of rows held out, before and after."""
    told = [examine(study, folder) for study in STUDIES]
    count_advice(told)
    draw_all(told, picture)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
