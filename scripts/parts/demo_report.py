# SPDX-License-Identifier: BSD-3-Clause
"""Ends the demo: prints estimate beside truth, and draws measured over modelled velocity.

Usage: demo_report.py FOLDER, with truth.json, base.json and corrected.csv in it. The modelled
velocity is the wind triangle of the corrected air data, V = C_b^n [V_air - w x r] + W.
"""

from __future__ import annotations

import csv
import itertools
import json
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt

mpl.use("Agg")  # no screen; must be chosen before pyplot is imported
import matplotlib.pyplot as plt

Array = npt.NDArray[np.float64]
Json = dict[str, Any]
OUTPUTS = ("vn", "ve", "vd")


def read_columns(path: Path) -> dict[str, list[str]]:
    """Columns of a CSV as text, by header."""
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


def modelled_velocity(log: dict[str, list[str]], calibration: Json, lever_arm: Array) -> Array:
    """Ground velocity (N, 3) [m/s], north-east-down, from the corrected air data and the wind."""

    def column(name: str) -> Array:
        return np.array(log[name], dtype=float)

    value = {name: entry["value"] for name, entry in calibration["parameters"].items()}
    airspeed = column("airspeed_cal_mps")
    alpha, beta = column("alpha_cal_rad"), column("beta_cal_rad")
    air = airspeed * np.array(
        [np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)]
    )
    rates = np.stack([column(name) for name in ("p_radps", "q_radps", "r_radps")], axis=-1)
    in_body = air.T - np.cross(rates, lever_arm)
    roll, pitch, yaw = (column(name) for name in ("roll_rad", "pitch_rad", "yaw_rad"))
    to_ned = rotation(2, yaw) @ rotation(1, pitch) @ rotation(0, roll)
    wind = np.array([value["w_n"], value["w_e"], value["w_d"]])
    velocity: Array = (to_ned @ in_body[:, :, None])[:, :, 0] + wind
    return velocity


def rotation(axis: int, angle: Array) -> Array:
    """Right-handed rotations (N, 3, 3) of vectors by angles (N) [rad] about axis 0, 1 or 2."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((len(angle), 3, 3))
    matrix[:, axis, axis] = 1.0
    matrix[:, j, j] = matrix[:, k, k] = np.cos(angle)
    matrix[:, j, k], matrix[:, k, j] = -np.sin(angle), np.sin(angle)
    return matrix


def print_parameters(calibration: Json, truth: Json) -> None:
    """One line a parameter: what was put in, what was found, and how far apart they are."""
    print(f"{'parameter':<14}{'unit':<6}{'truth':>11}{'estimate':>11}{'+-':>10}{'off by':>9}")
    for name, entry in calibration["parameters"].items():
        true, error = truth["parameters"][name], entry["standard_error"]
        off = (entry["value"] - true) / error
        line = f"{name:<14}{entry['unit']:<6}{true:>11.5f}{entry['value']:>11.5f}{error:>10.5f}"
        print(f"{line}{off:>6.1f} se")


def maneuvers(labels: list[str]) -> list[tuple[str, int, int]]:
    """Runs of one label as (label, first row, row after the last)."""
    runs, first = [], 0
    for label, group in itertools.groupby(labels):
        last = first + len(list(group))
        runs.append((label, first, last))
        first = last
    return runs


def draw(log: dict[str, list[str]], modelled: Array, noise: Json, path: Path) -> None:
    """For each output, measured over modelled and, below, their difference beside 2 sigma."""
    time = np.array(log["time_s"], dtype=float)
    figure, axes = plt.subplots(
        6, 1, figsize=(12, 11), sharex=True, height_ratios=[2, 1] * 3, layout="constrained"
    )
    runs = [run for run in maneuvers(log["maneuver"]) if run[0] and run[0] != "cruise"]
    for i, name in enumerate(OUTPUTS):
        measured = np.array(log[f"{name}_mps"], dtype=float)
        upper, lower = axes[2 * i], axes[2 * i + 1]
        upper.plot(time, measured, color="0.55", linewidth=2.5, label="measured")
        upper.plot(time, modelled[:, i], color="C3", linewidth=0.8, label="modelled")
        upper.set_ylabel(f"{name} [m/s]")
        lower.plot(time, measured - modelled[:, i], color="C0", linewidth=0.4)
        for sign in (-2, 2):
            lower.axhline(sign * noise[name], color="black", linestyle="--", linewidth=0.8)
        lower.set_ylabel("difference\n[m/s]")
        for axis in (upper, lower):
            for _, first, last in runs:
                axis.axvspan(time[first], time[last - 1], color="C2", alpha=0.12, linewidth=0)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower right", ncols=2)
    for label, first, last in runs:
        axes[0].annotate(
            label.replace("_", " "),
            (0.5 * (time[first] + time[last - 1]), 1.02),
            xycoords=("data", "axes fraction"),
            rotation=35,
            fontsize=8,
        )
    axes[0].set_xlim(time[0], time[-1])
    axes[-1].set_xlabel(
        "time [s]; manoeuvres are shaded, the dashed lines are 2 standard deviations"
    )
    figure.savefig(path, dpi=110)


def main(folder: Path) -> None:
    """Prints the table and writes residuals.png into `folder`."""
    calibration = json.loads((folder / "base.json").read_text())
    truth = json.loads((folder / "truth.json").read_text())
    log = read_columns(folder / "corrected.csv")
    lever_arm = np.array(truth["options"]["lever_arm"])
    modelled = modelled_velocity(log, calibration, lever_arm)
    print_parameters(calibration, truth)
    for i, name in enumerate(OUTPUTS):
        rmse = np.sqrt(np.mean((np.array(log[f"{name}_mps"], dtype=float) - modelled[:, i]) ** 2))
        if not np.isclose(rmse, calibration["rmse"][name], rtol=1e-3):
            fitted = calibration["rmse"][name]
            sys.exit(f"{name}: corrected.csv gives RMSE {rmse:.4f} m/s, base.json {fitted:.4f}")
    draw(log, modelled, calibration["noise"], folder / "residuals.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
