# SPDX-License-Identifier: BSD-3-Clause
"""sepcal-aircraft: a simulated flight's truth comes back by every method; errors are one line.

The simulator flies the aircraft by equations of its own, so its truth is an independent one.
"""

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from numpy.typing import NDArray

import apps
from apps import Log, Outcome
from recorded import find_fixture

FLIGHT, GEOMETRY = "flight.csv", "aircraft.json"
FOOT = 0.3048  # m


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a flight, its aircraft and its truth."""
    folder = tmp_path_factory.mktemp("aircraft")
    made = run(
        "simulate", "-o", FLIGHT, "--truth", "truth.json", "--geometry", GEOMETRY, cwd=folder
    )
    assert made.code == 0, made.err
    return folder


def run(*arguments: str, cwd: Path) -> Outcome:
    return apps.run("sepcal-aircraft", *arguments, folder=cwd)


def parameters(folder: Path, file: str, part: str | None = None) -> dict[str, dict[str, float]]:
    root = json.loads((folder / file).read_text())
    found: dict[str, dict[str, float]] = (root[part] if part else root)["parameters"]
    return found


def truth_of(folder: Path) -> dict[str, float]:
    found: dict[str, float] = json.loads((folder / "truth.json").read_text())["parameters"]
    return found


def check_truth(folder: Path, found: dict[str, dict[str, float]], names: Sequence[str]) -> None:
    """Each within four standard errors: one in 16,000 normal ones is not, and the seed is fixed."""
    truth = truth_of(folder)
    assert names
    for name in names:
        entry = found[name]
        assert abs(entry["value"] - truth[name]) < 4.0 * entry["standard_error"], name


def column(file: Path, header: str) -> NDArray[np.float64]:
    return Log(file).column(header)


def test_a_path_finds_the_sensors_errors(flown: Path) -> None:
    fitted = run("fit", FLIGHT, "--model", "path", "-o", "path.json", cwd=flown)
    assert fitted.code == 0, fitted.err
    check_truth(flown, parameters(flown, "path.json"), ["lambda_alpha", "b_p", "b_r", "w_n", "w_e"])
    assert "66 initial states of the segments: all of them with --explain" in fitted.out
    assert "inputs linear between rows" in fitted.out


@pytest.mark.parametrize(
    ("model", "coefficients"),
    [("longitudinal", ("CX", "CZ", "Cm")), ("lateral", ("CY", "Cl", "Cn"))],
)
def test_output_error_finds_the_aerodynamics(
    flown: Path, model: str, coefficients: tuple[str, ...]
) -> None:
    fitted = run("fit", FLIGHT, "--model", model, "--geometry", GEOMETRY, "-o", "b.json", cwd=flown)
    assert fitted.code == 0, fitted.err
    found = parameters(flown, "b.json")
    names = [name for name in truth_of(flown) if name.startswith(coefficients) and name in found]
    check_truth(flown, found, names)
    assert "pitch rate q c/2V" in fitted.out
    assert json.loads((flown / "b.json").read_text())["rate_reference"] == "c/2V"


def test_equation_error_and_two_steps_warn(flown: Path) -> None:
    """Noise of alpha and beta biases them, as the warning says: near the truth is all they are."""
    aero = run("fit", FLIGHT, "--model", "aero", "--geometry", GEOMETRY, "-o", "a.json", cwd=flown)
    steps = run("two-step", FLIGHT, "--geometry", GEOMETRY, "-o", "two.json", cwd=flown)
    truth = truth_of(flown)
    for outcome, found in (
        (aero, parameters(flown, "a.json")),
        (steps, parameters(flown, "two.json", "aero")),
    ):
        assert outcome.code == 0, outcome.err
        assert "warning: errors of the regressors" in outcome.out
        for name in ("CZ_alpha", "Cm_alpha", "Cm_q", "Cm_elevator", "Cl_p", "Cn_r"):
            assert found[name]["value"] == pytest.approx(truth[name], rel=0.06), name
    assert "step one, the flight path" in steps.out
    assert set(parameters(flown, "two.json", "path")) >= {"b_ax", "lambda_v"}


def test_a_regressor_that_is_missing_is_added(flown: Path) -> None:
    """Cm follows alpha^2 where the simulator hid it; the error falls, the estimate is it."""
    hidden = ("--hide", "Cm[alpha^2]=-3.0", "--seed", "2")
    assert run("simulate", "-o", "bent.csv", "--truth", "bent.json", *hidden, cwd=flown).code == 0
    fit = ("--model", "longitudinal", "--geometry", GEOMETRY, "-o", "base.json")
    assert run("fit", "bent.csv", *fit, cwd=flown).code == 0
    added = run("add", "bent.csv", "base.json", "Cm[alpha^2]", "-o", "next.json", cwd=flown)
    assert added.code == 0, added.err
    before, after = (json.loads((flown / f).read_text()) for f in ("base.json", "next.json"))
    assert after["rmse"]["q"] < before["rmse"]["q"]
    (step,) = after["history"]
    assert step["effect"] == "Cm[alpha^2]"
    assert (step["rmse_before"], step["rmse_after"]) == (before["rmse"], after["rmse"])
    assert step["predicted_drop"] == pytest.approx(step["drop"], abs=0.05)
    entry = after["parameters"]["Cm_alpha^2"]
    assert abs(entry["value"] + 3.0) < 4.0 * entry["standard_error"]
    assert entry["standard_error"] < 0.5


def test_compare_is_of_noise_alone_also_on_another_flight(flown: Path) -> None:
    fit = ("--model", "longitudinal", "--geometry", GEOMETRY, "-o", "base.json")
    assert run("fit", FLIGHT, *fit, cwd=flown).code == 0
    assert run("simulate", "-o", "other.csv", "--seed", "5", cwd=flown).code == 0
    for flight in (FLIGHT, "other.csv"):
        compared = run("compare", flight, "base.json", "--json", cwd=flown)
        assert compared.code == 0, compared.err
        rmse = json.loads(compared.out)["rmse"]
        assert rmse["q"] == pytest.approx(0.002, rel=0.1)  # as the simulator's noise is
        assert rmse["alpha"] == pytest.approx(0.003, rel=0.1)
    assert "other.csv is not the flight of the fit: its initial states are" in compared.err


def test_apply_gives_what_was_flown(flown: Path) -> None:
    biased = json.dumps({"parameters": {"b_q": 0.01, "b_az": 0.2, "lambda_alpha": 0.05}})
    (flown / "biased.json").write_text(biased)
    for command in (
        ("simulate", "-o", "biased.csv", "--truth", "biased.json"),
        ("fit", "biased.csv", "--model", "path", "--geometry", GEOMETRY, "-o", "path.json"),
        ("apply", "biased.csv", "path.json", "-o", "flown.csv"),
    ):
        outcome = run(*command, cwd=flown)
        assert outcome.code == 0, outcome.err
    file = flown / "flown.csv"
    clean = flown / FLIGHT  # of the same seed, so with the same noise
    for name, least in (("q_{}radps", 0.0095), ("az_{}mps2", 0.19)):
        raw, right = column(file, name.format("")), column(clean, name.format(""))
        corrected = column(file, name.format("cal_"))
        assert abs(np.mean(raw - right)) > least
        assert abs(np.mean(corrected - right)) < 0.05 * least
    assert np.isfinite(column(file, "CZ")).all()
    assert column(file, "u_mps").mean() == pytest.approx(55.0, abs=1.5)


def test_estimates_run_along_another_flight(flown: Path) -> None:
    """From one flight's calibration: every row of the other, errors smaller at its end."""
    fit = ("fit", FLIGHT, "--model", "longitudinal", "--geometry", GEOMETRY, "-o", "lon.json")
    noise = ("--process-noise", "u=0.01", "--process-noise", "w=0.01", "--process-noise", "q=0.002")
    assert run(*fit, cwd=flown).code == 0
    assert run("simulate", "-o", "second.csv", "--seed", "5", cwd=flown).code == 0
    for method in ("ekf", "iekf", "srif"):
        done = run(
            "track", "second.csv", "lon.json", "--method", method, *noise, "-o", "t.csv", cwd=flown
        )
        assert done.code == 0, done.err
        assert "2001 rows of second.csv tracked, to 40 s" in done.out
        file = flown / "t.csv"
        assert_array_equal(column(file, "time_s"), column(flown / "second.csv", "time_s"))
        truth = truth_of(flown)
        for name in ("CZ_alpha", "Cm_alpha", "Cm_q", "Cm_elevator"):
            estimate, sd = column(file, name)[-1], column(file, f"{name}_sd")
            assert abs(estimate - truth[name]) < 4.0 * sd[-1], name
            assert sd[-1] < sd[0]
        assert np.nanstd(column(file, "alpha_innovation_rad")) < 0.02


def test_estimates_start_from_the_first_rows(flown: Path) -> None:
    assert run("fit", FLIGHT, "--model", "path", "-o", "path.json", cwd=flown).code == 0
    track = ("track", FLIGHT, "path.json", "-o", "t.csv", "--json")
    done = run(*track, "--start-rows", "900", cwd=flown)
    assert done.code == 0, done.err
    last = json.loads(done.out)["last"]
    for name in ("lambda_alpha", "b_p", "b_q", "b_r"):
        found = last[name]
        assert abs(found["value"] - truth_of(flown)[name]) < 4.0 * found["standard_deviation"], name
    for more, said in (
        ((), "the fit is of this flight, whose rows must not count twice"),
        (("--start-rows", "5000"), "the record has 2001 rows: take fewer"),
        (("--start-rows", "40"), "the first 40 rows leave"),
        (("--start-rows", "900", "--method", "rls"), "knows none from 'u_0[11]' on"),
        (("--start-rows", "900", "--process-noise", "u=1"), "no process noise 'u'; it has ax, ay"),
        (("--start-rows", "900", "--initial-state", "x=1"), "no state 'x'; it has u, v, w, phi"),
    ):
        refused = run(*track, *more, cwd=flown)
        assert refused.code == 2
        assert refused.err.count("\n") == 1
        assert said in refused.err, refused.err


def test_process_noise_gives_smoothed_states(flown: Path) -> None:
    """Between the readings and the trajectory; the noise of the inertial unit is what is put in."""
    assert run("fit", FLIGHT, "--model", "path", "-o", "path.json", cwd=flown).code == 0
    noise = [f"--process-noise={name}=0.007" for name in ("ax", "ay", "az")]
    noise += [f"--process-noise={name}=0.0003" for name in ("p", "q", "r")]
    applied = run("apply", FLIGHT, "path.json", "-o", "smooth.csv", *noise, cwd=flown)
    assert applied.code == 0, applied.err
    file = flown / "smooth.csv"
    for state, path in (("u_smooth_mps", "u_mps"), ("theta_smooth_rad", "pitch_cal_rad")):
        sd = column(file, state.replace("smooth", "sd"))
        assert np.all(sd > 0)
        assert np.mean(np.abs(column(file, state) - column(file, path)) < 5.0 * sd) > 0.95
    w, sd = column(file, "w_az_mps2"), column(file, "w_az_sd_mps2")
    assert np.std(w) < np.mean(sd)
    assert abs(np.mean(column(file, "alpha_innovation_rad"))) < 1e-3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fit", FLIGHT, "--model", "foo"), "choose one of path, longitudinal, lateral, six-dof"),
        (("fit", FLIGHT, "--model", "aero"), "give --geometry AIRCRAFT.json"),
        (("fit", FLIGHT, "--model", "path", "--inputs", "spline"), "choose linear or hold"),
        (("fit", FLIGHT, "--model", "path", "--free", "b_q"), "b_v, b_alpha, b_psi"),
        (("fit", FLIGHT, "--model", "path", "--outputs", "foo"), "it has airspeed, beta, alpha"),
        (
            ("fit", FLIGHT, "--model", "path", "--effect", "Cm[alpha]"),
            "there is no effect 'Cm[alpha]'",
        ),
        (
            ("fit", FLIGHT, "--model", "aero", "--geometry", GEOMETRY, "--effect", "Cq[alpha]"),
            "the coefficients here are: CX, CY, CZ, Cl, Cm, Cn",
        ),
        (
            ("fit", FLIGHT, "--model", "aero", "--geometry", GEOMETRY, "--equation", "Cm"),
            "write it as Cm=1,alpha,q_hat,elevator",
        ),
        (
            ("fit", FLIGHT, "--model=longitudinal", "--geometry", GEOMETRY, "--effect=CY[beta]"),
            "the model 'longitudinal' has no CY here; it has CX, CZ, Cm",
        ),
        (
            ("fit", "still.csv", "--model", "aero", "--geometry", GEOMETRY),
            "airspeed is 0 in row 9 (counted from 0)",
        ),
        (("compare", FLIGHT, GEOMETRY), "give the JSON that fit wrote with -o"),
        (("fit", "upside_down.csv", "--model", "path"), "level flight must read az = -9.81"),
        (("fit", "load_factor.csv", "--model", "path"), "log az_g = -an_g"),
        (("fit", "no_q.csv", "--model", "path"), "'q_radps' is missing (q_degps would do as well)"),
    ],
)
def test_what_is_wrong_is_one_line(flown: Path, arguments: tuple[str, ...], said: str) -> None:
    change: dict[str, Callable[[str], str]] = {
        "upside_down.csv": lambda text: text,
        "still.csv": lambda text: text,
        "load_factor.csv": lambda text: text.replace("az_mps2", "an_g", 1),
        "no_q.csv": lambda text: text.replace("q_radps", "qq", 1),
    }
    text = (flown / FLIGHT).read_text()
    if arguments[1] == "upside_down.csv":
        rows = [line.split(",") for line in text.splitlines()]
        place = rows[0].index("az_mps2")
        for row in rows[1:]:
            row[place] = str(-float(row[place]))
        text = "\n".join(",".join(row) for row in rows) + "\n"
    if arguments[1] == "still.csv":
        rows = [line.split(",") for line in text.splitlines()]
        rows[10][rows[0].index("airspeed_mps")] = "0"
        text = "\n".join(",".join(row) for row in rows) + "\n"
    if arguments[1] in change:
        (flown / arguments[1]).write_text(change[arguments[1]](text))
    outcome = run(*arguments, cwd=flown)
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    assert said in outcome.err


def test_a_recorded_flight_is_as_it_was_published(tmp_path: Path) -> None:
    """NASA's HARV against SIDPAC's data compatibility: held inputs, scales about the start."""
    flight = find_fixture("harv_longitudinal.csv")
    start = (313.0304, 3.3777, 114.0908, -0.000161, 0.239107, 0.444179)
    names = ("u_0", "v_0", "w_0", "phi_0", "theta_0", "psi_0")
    free = {"u_0", "w_0", "theta_0"}
    fixed = [
        f"{name}={value * (FOOT if name[0] in 'uvw' else 1.0)}"
        for name, value in zip(names, start, strict=True)
        if name in free
    ]
    fixed += [f"{name}=0" for name in ("b_ay", "b_p", "b_r", "lambda_v", "b_theta")]
    fitted = run(
        *("fit", str(flight), "--model", "path", "--inputs", "hold", "--scale-about-start"),
        *("--measured", "v,phi,psi", "--outputs", "airspeed,alpha,pitch"),
        *("--gravity", str(32.174 * FOOT), "-o", "harv.json"),
        *(word for text in fixed for word in ("--fix", text)),
        cwd=tmp_path,
    )
    assert fitted.code == 0, fitted.err
    found = parameters(tmp_path, "harv.json")
    published = {  # in feet, with the Cramer-Rao bound
        "b_ax": (-0.16654 * FOOT, 0.00595 * FOOT),
        "b_az": (-0.13388 * FOOT, 0.00970 * FOOT),
        "b_q": (0.0017840, 6.35e-6),
        "lambda_alpha": (0.076171, 0.00680),
        "lambda_theta": (0.038720, 0.00118),
    }
    for name, (value, error) in published.items():
        assert abs(found[name]["value"] - value) < 0.1 * error, name
        assert found[name]["standard_error_white"] == pytest.approx(error, rel=0.01), name
