# SPDX-License-Identifier: BSD-3-Clause
"""The numbers and the picture of docs/case-studies.md, from recorded flights.

Usage: case_studies.py FOLDER PICTURE.svg, FOLDER with the recordings that the tests use.
"""

from __future__ import annotations

import sys
from pathlib import Path

from matplotlib.figure import Figure

import sepcal

FIELD = (19.72, -1.41, 49.44)  # [uT] north, east, down, where the octocopter flew
Bar = tuple[str, float, float]


def octocopter(file: Path, effects: tuple[str, ...]) -> tuple[list[Bar], str]:
    """A magnetometer, with each effect added by itself."""
    flight = sepcal.read_csv(file)
    base = sepcal.fit(sepcal.Magnetometer(field=FIELD), flight)
    return print_steps(file.stem, base, effects), "uT"


def tube(
    file: Path, effects: tuple[str, ...], bounds: dict[str, tuple[float, float]] | None = None
) -> tuple[list[Bar], str]:
    """A Pitot-static tube, with each effect added by itself."""
    flight = sepcal.read_csv(file)
    base = sepcal.fit(sepcal.PitotStatic(), flight, bounds=bounds or {})
    return print_steps(file.stem, base, effects), "m/s"


def print_steps(name: str, base: sepcal.Calibration, effects: tuple[str, ...]) -> list[Bar]:
    """Prints the diagnosis and what adding came to; the bars of the picture."""
    print(f"\n{name}: {base.status}")
    print(base.diagnose())
    bars: list[Bar] = []
    for effect in effects:
        better = base.add(effect)
        entry = better.history[-1]
        assert entry.rmse_before
        assert entry.rmse_after
        print(
            f"+ {effect}: {entry.rmse_before:.4g} -> {entry.rmse_after:.4g}, promised "
            f"{100 * (entry.predicted_drop or float('nan')):.1f} %; held out "
            f"{entry.held_out_before:.4g} -> {entry.held_out_after:.4g}; {better.status}"
        )
        bars.append((effect, entry.held_out_before or 0.0, entry.held_out_after or 0.0))
    return bars


def main(folder: Path, picture: Path) -> None:
    """Prints everything and draws the error of rows held out, before and after."""
    studies = {
        "magnetometer beside the wiring": octocopter(
            folder / "octocopter_internal_mag.csv", ("bias[voltage_v]", "bias[current_a]")
        ),
        "magnetometer on a mast": octocopter(
            folder / "octocopter_external_mag.csv", ("bias[voltage_v]", "bias[current_a]")
        ),
        "small aircraft's tube": tube(
            folder / "uav_pitot_static_2022_05_07_11.csv", ("time_offset", "wind[altitude_m]")
        ),
        "airliner": tube(
            folder / "airliner_mode_s.csv",
            ("wind[altitude_m]", "wind[spline(time,6)]", "wind[spline(time,12)]"),
            bounds={"s_va": (0.9, 1.1), "c_va": (-5.0, 5.0)},
        ),
    }
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    for axes, (title, (bars, unit)) in zip(
        figure.subplots(2, 2).ravel(), studies.items(), strict=True
    ):
        places = range(len(bars))
        axes.barh([p + 0.2 for p in places], [b[1] for b in bars], 0.38, color="0.7")
        axes.barh([p - 0.2 for p in places], [b[2] for b in bars], 0.38, color="C0")
        axes.set_yticks(list(places), [bar[0] for bar in bars])
        axes.set(title=title, xlabel=f"RMSE of rows held out [{unit}]: grey before, blue after")
    figure.savefig(picture)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
