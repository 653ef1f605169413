# SPDX-License-Identifier: BSD-3-Clause
"""Outputs that a log has in some rows alone: filter error takes the readings that are there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import apps
import sepcal
from refusals import refuse

EVERY = 5
NOISE = {"airspeed": 0.2, "alpha": 0.003, "pitch": 0.002, "ax": 0.05, "az": 0.05, "q": 0.002}
CALM = {"u": 0.0, "w": 0.0, "q": 0.0}
HEADERS = {
    "airspeed": "airspeed_mps", "alpha": "alpha_rad", "pitch": "pitch_rad", "ax": "ax_mps2",
    "az": "az_mps2", "q": "q_radps",
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("aircraft")
    made = apps.run(
        "sepcal-aircraft", "simulate", "-o", "all.csv", "--geometry", "aircraft.json", "--rows",
        "600", folder=folder,
    )  # fmt: skip
    assert made.code == 0, made.err
    lines = (folder / "all.csv").read_text().splitlines()
    at = lines[0].split(",").index("alpha_rad")
    thinned = [lines[0]]
    for row, line in enumerate(lines[1:]):
        cells = line.split(",")
        if row % EVERY:
            cells[at] = ""
        thinned.append(",".join(cells))
    (folder / "gaps.csv").write_text("\n".join(thinned) + "\n")
    return folder


@pytest.fixture(scope="module")
def whole(folder: Path) -> sepcal.Flight:
    return sepcal.read_csv(folder / "all.csv")


@pytest.fixture(scope="module")
def gapped(folder: Path) -> sepcal.Flight:
    return sepcal.read_csv(folder / "gaps.csv")


@pytest.fixture(scope="module")
def model(folder: Path) -> sepcal.RigidAircraft:
    return sepcal.RigidAircraft(sepcal.read_aircraft(folder / "aircraft.json"), "longitudinal")


@pytest.fixture(scope="module")
def calm(model: sepcal.RigidAircraft, gapped: sepcal.Flight) -> sepcal.AircraftFit:
    return sepcal.fit(model, gapped, method="filter-error", process_noise=CALM, noise=NOISE)


def residuals(fit: sepcal.AircraftFit, flight: sepcal.Flight) -> dict[str, NDArray[np.float64]]:
    made = fit.apply(flight)
    found = {}
    for output, header in HEADERS.items():
        stem, _, unit = header.rpartition("_")
        found[output] = flight[header] - made[f"{stem}_model_{unit}"]
    return found


def test_likelihood_is_that_of_the_readings_there(
    calm: sepcal.AircraftFit, gapped: sepcal.Flight
) -> None:
    """Without process noise readings are independent: normal densities, summed in NumPy."""
    total, count = 0.0, 0
    for output, r in residuals(calm, gapped).items():
        there = r[np.isfinite(r)]
        assert there.size == (gapped.rows / EVERY if output == "alpha" else gapped.rows)
        s = NOISE[output]
        total -= 0.5 * np.sum((there / s) ** 2 + np.log(2 * np.pi * s**2))
        count += there.size
    assert count == gapped.rows * (5 + 1 / EVERY)
    assert_allclose(calm.log_likelihood, total, rtol=1e-8)
    assert any("there are readings of alpha in 120" in note for note in calm.notes)


def test_gaps_cost_information_and_no_more(
    model: sepcal.RigidAircraft,
    calm: sepcal.AircraftFit,
    whole: sepcal.Flight,
) -> None:
    """Estimates are those of every reading as far as the readings that are missing allow."""
    every = sepcal.fit(model, whole, method="filter-error", process_noise=CALM, noise=NOISE)
    for name in ("CZ_alpha", "Cm_alpha"):
        errors = [fit[name].standard_error_white for fit in (every, calm)]
        assert errors[0] <= errors[1] * (1 + 1e-6)
        off = abs(every[name].value - calm[name].value)
        assert off < 4 * np.sqrt(errors[1] ** 2 - errors[0] ** 2) + 1e-3 * errors[0]


def test_comparison_is_of_the_readings_there(
    calm: sepcal.AircraftFit, gapped: sepcal.Flight
) -> None:
    compared = calm.compare()
    left = residuals(calm, gapped)
    for at in compared.overall:
        r = left[at.output]
        there = r[np.isfinite(r)]
        assert at.rows == there.size
        assert_allclose(at.rmse, np.sqrt(np.mean(there**2)), rtol=1e-6)
        assert_allclose(at.mean, there.mean(), atol=1e-6 * at.rmse)
        assert np.isfinite(at.lag_one)
    for at in compared.validation:
        assert np.isfinite(at.theil)
    assert [one.noise.name for one in compared.disturbances][:1] == ["q_u"]
    assert {at.output for at in compared.channels} == set(HEADERS)
    assert all(np.isfinite(list(window.rmse.values())).all() for window in compared.windows)


def test_verbs_take_it_or_say_why_not(calm: sepcal.AircraftFit, gapped: sepcal.Flight) -> None:
    left = calm.residuals()
    assert np.isnan(left["alpha_residual_rad"]).sum() == gapped.rows * (1 - 1 / EVERY)
    smoothed = calm.smooth({"u": 0.01, "w": 0.01, "q": 0.002})
    assert np.isfinite(smoothed["q"]).all()
    track = calm.track(method="ekf", start_rows=200)
    assert np.isfinite(track["Cm_alpha"][-1])
    refuse(calm.diagnose, "diagnose takes a reading of every output in every row", "alpha")


def test_output_error_says_what_it_did(model: sepcal.RigidAircraft, gapped: sepcal.Flight) -> None:
    refuse(
        lambda: sepcal.fit(model, gapped),
        "alpha_rad",
        "drop_invalid",
        "filter error takes the readings that are there",
    )


def test_app_estimates_the_noise_too(folder: Path) -> None:
    fitted = apps.run(
        "sepcal-aircraft", "fit", "gaps.csv", "--model", "longitudinal", "--geometry",
        "aircraft.json", "--method", "filter-error", "-o", "base.json", folder=folder,
    )  # fmt: skip
    assert fitted.code in (0, 5), fitted.err
    assert "alpha in 120" in fitted.err
    compared = apps.run(
        "sepcal-aircraft", "compare", "gaps.csv", "base.json", "--json", folder=folder
    )
    assert compared.code == 0, compared.err
    rows = {at["output"]: at["rows"] for at in compared.result["where"]}
    assert rows["alpha"] < rows["q"]
    applied = apps.run(
        "sepcal-aircraft", "apply", "gaps.csv", "base.json", "-o", "out.csv", folder=folder
    )
    assert applied.code == 0, applied.err
