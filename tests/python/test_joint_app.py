# SPDX-License-Identifier: BSD-3-Clause
"""Several flights fitted together by the app: against fit_many(), and through every verb."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sepcal
from apps import Bench, Log, assert_one_line, assert_refused, parse_json

PROBE = ("--k-alpha", "4.5", "--k-beta", "4.5", "--lever-arm", "0.35,0,-0.02")
WIND = ("w_n", "w_e", "w_d")
WINDS = {"mon": (-3.8, 2.4, 0.3), "tue": (6.0, -1.0, 0.0), "wed": (0.5, 9.0, -0.4)}
FILES = tuple(f"{name}.csv" for name in WINDS)


def fly(bench: Bench, name: str, seed: int, *options: str, **changed: float) -> None:
    """A short flight of the same probe in a wind of its own."""
    made = bench.run("simulate", "-o", "any.csv", "--truth", f"{name}.json", "--rows", "600")
    assert made.code == 0, made.err
    truth = parse_json((bench.folder / f"{name}.json").read_text())
    truth["parameters"] |= dict(zip(WIND, WINDS.get(name, (2.0, 2.0, 0.0)), strict=True)) | changed
    (bench.folder / f"{name}.json").write_text(json.dumps(truth))
    command = ("simulate", "-o", f"{name}.csv", "--truth", f"{name}.json", "--rows", "1500")
    made = bench.run(*command, "--seed", str(seed), *options)
    assert made.code == 0, made.err


@pytest.fixture(scope="module")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """Three flights, fitted jointly to joint.json; and a fourth."""
    bench = Bench("sepcal-pitot", tmp_path_factory.mktemp("joint"), PROBE, None)
    for seed, name in enumerate(WINDS):
        fly(bench, name, 30 + seed)
    fly(bench, "thu", 40)
    fitted = bench.run("fit", *FILES, "--own", "wind", "-o", "joint.json", *PROBE)
    assert fitted.code == 0, fitted.err
    return bench


def read(bench: Bench, name: str = "joint.json") -> dict:
    return parse_json((bench.folder / name).read_text())


def test_it_is_fit_many(fleet: Bench) -> None:
    """Estimates to 1e-6 standard errors, departures to three digits."""
    probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
    many = sepcal.fit_many(probe, [str(fleet.folder / file) for file in FILES], own=WIND)
    joint = read(fleet)
    for name, parameter in many.shared.items():
        ours = joint["parameters"][name]
        assert abs(ours["value"] - parameter.value) < 1e-6 * parameter.standard_error_white
        assert ours["standard_error_white"] == pytest.approx(
            parameter.standard_error_white, rel=1e-6
        )
    for label, flight in zip(WINDS, many.flights.values(), strict=True):
        for name in WIND:
            ours = joint["parameters"][f"{name}@{label}"]
            assert (
                abs(ours["value"] - flight[name].value) < 1e-6 * flight[name].standard_error_white
            )
    departures = {entry["flight"]: entry["p"] for entry in joint["joint"]["departures"]}
    for label, flight in zip(WINDS, many.flights.values(), strict=True):
        assert departures[label] == pytest.approx(flight.departure.p_holm, rel=1e-3)


def test_logs_may_differ_in_units_clocks_and_names(fleet: Bench, tmp_path: Path) -> None:
    """Fitted as the clean ones: to what rounding leaves of nine digits."""
    spoilt = Bench("sepcal-pitot", tmp_path, PROBE, None)
    monday, tuesday, wednesday = (Log(fleet.folder / file) for file in FILES)
    tuesday.replace("roll_rad", np.degrees(tuesday.column("roll_rad")), to="roll_deg")
    tuesday.replace("vn_mps", tuesday.column("vn_mps") * 3600 / 1852, to="vn_kt")
    tuesday.replace("pt_pa", tuesday.column("pt_pa") / 100, to="pt_hpa")
    tuesday.replace("time_s", 1000 * (tuesday.column("time_s") + 1.772e9), to="time_ms")
    wednesday.replace("ps_pa", wednesday.column("ps_pa"), to="Static")
    for file, log in zip(FILES, (monday, tuesday, wednesday), strict=True):
        (tmp_path / file).write_text(log.text())
    command = (*FILES, "--own", "wind", "--map", "ps_pa=Static", "--json", *PROBE)
    fitted = spoilt.run("fit", *command, "-o", "joint.json")
    assert fitted.code == 0, fitted.err
    for name, expected in read(fleet)["parameters"].items():
        found = fitted.result["parameters"][name]["value"]
        assert abs(found - expected["value"]) < 1e-3 * (expected["standard_error"] or 1)
    compared = spoilt.run("compare", *FILES, "joint.json", "--json")
    assert compared.code == 0, compared.err
    assert compared.result["rmse"]["vn"] == pytest.approx(fitted.result["rmse"]["vn"], rel=1e-9)


def test_what_is_fixed_holds_in_every_flight(fleet: Bench) -> None:
    fitted = fleet.run("fit", *FILES, "--own", "wind", "--fix", "w_d=0", "--json", *PROBE)
    assert fitted.code == 0, fitted.err
    for label in WINDS:
        assert fitted.result["parameters"][f"w_d@{label}"]["value"] == 0
        assert fitted.result["parameters"][f"w_d@{label}"]["standard_error"] is None
    assert "flights are not tested for their departure" in fitted.err


def test_each_wind_is_its_flights_own(fleet: Bench) -> None:
    parameters = read(fleet)["parameters"]
    for label, winds in WINDS.items():
        for name, truth in zip(WIND, winds, strict=True):
            found = parameters[f"{name}@{label}"]
            assert abs(found["value"] - truth) < 5 * found["standard_error"]
    restated = read(fleet)["restated"]
    assert sorted(restated) == [f"wind@{label}" for label in sorted(WINDS)]


@pytest.mark.parametrize("verb", ["compare", "intervals", "diagnose"])
def test_every_verb_takes_the_flights_in_any_order(fleet: Bench, verb: str) -> None:
    once = fleet.run(verb, *FILES, "joint.json", "--json")
    again = fleet.run(verb, *reversed(FILES), "joint.json", "--json")
    assert once.code in (0, 3, 6), once.err
    assert once.result == again.result


def test_an_effect_is_shared_by_all_flights(fleet: Bench, tmp_path: Path) -> None:
    """Centred over all flights together, whose temperatures differ; the coefficient is one."""
    bench = Bench("sepcal-pitot", tmp_path, PROBE, None)
    for seed, name in enumerate(WINDS):
        fly(bench, name, 50 + seed, "--hide", "airspeed_bias[temp_k]=0.15")
    assert bench.run("fit", *FILES, "--own", "wind", "-o", "joint.json", *PROBE).code in (0, 3)
    added = bench.run(
        "add", *FILES, "joint.json", "airspeed_bias[temp_k]", "-o", "next.json", "--json"
    )
    assert added.code == 0, added.err
    temperatures = np.concatenate([Log(bench.folder / file).column("temp_k") for file in FILES])
    effect = added.result["options"]["effects"][0]
    assert effect["centre"] == pytest.approx(temperatures.mean(), rel=0.02)
    parameters = added.result["parameters"]
    coefficient = next(parameters[name] for name in parameters if "temp_k" in name)
    assert abs(coefficient["value"] - 0.15) < 5 * coefficient["standard_error"]
    assert added.result["joint"]["own"] == list(WIND)


def test_a_flight_that_departs_is_named(fleet: Bench, tmp_path: Path) -> None:
    bench = Bench("sepcal-pitot", tmp_path, PROBE, None)
    for seed, name in enumerate(WINDS):
        fly(bench, name, 60 + seed, **({"lambda_va": 0.09} if name == "tue" else {}))
    fitted = bench.run("fit", *FILES, "--own", "wind", *PROBE)
    assert "tue departs from the other flights (p " in fitted.out
    assert ": lambda_va by 0.04" in fitted.out or ": lambda_va by 0.03" in fitted.out


def test_a_fourth_flight_is_corrected(fleet: Bench) -> None:
    """As by a calibration of one flight that has the shared estimates."""
    applied = fleet.run("apply", "thu.csv", "joint.json", "-o", "thu_joint.csv")
    assert applied.code == 0, applied.err
    joint = read(fleet)["parameters"]
    shared = [name for name in joint if "@" not in name and name not in WIND]
    fixed = [word for name in shared for word in ("--fix", f"{name}={joint[name]['value']!r}")]
    alone = fleet.run("fit", "thu.csv", "-o", "thu.json", *PROBE, *fixed)
    assert alone.code == 0, alone.err
    assert fleet.run("apply", "thu.csv", "thu.json", "-o", "thu_alone.csv").code == 0
    ours, theirs = Log(fleet.folder / "thu_joint.csv"), Log(fleet.folder / "thu_alone.csv")
    assert ours.headers == theirs.headers
    for header in ("airspeed_cal_mps", "alpha_cal_rad", "beta_cal_rad"):
        np.testing.assert_allclose(ours.column(header), theirs.column(header), rtol=1e-12)


def test_one_of_the_flights_is_compared_by_itself(fleet: Bench) -> None:
    """Its wind is its own: the error is that of a fit, not of a prediction."""
    one = fleet.run("compare", "tue.csv", "joint.json", "--json")
    assert one.code == 0, one.err
    assert one.result["rmse"]["vn"] == pytest.approx(0.15, rel=0.1)


def test_python_reads_what_the_app_wrote(fleet: Bench) -> None:
    calibration = sepcal.load(fleet.folder / "joint.json")
    assert calibration.to_json() == (fleet.folder / "joint.json").read_text()


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (("fit", "mon.csv", "--own", "wind", *PROBE), ("--own is of several flights",)),
        (("fit", *FILES, "--own", "gusts", *PROBE), ("own gusts: there is no such parameter",)),
        (("fit", "mon.csv", "mon.csv", *PROBE), ("mon.csv is given twice",)),
        (
            ("fit", *FILES, "--own", "wind", "--from", "20", *PROBE),
            ("--from-time is of one clock", "each flight has its own", "--where"),
        ),
        (("fit", "mon.csv", "./mon.csv", *PROBE), ("mon.csv and ./mon.csv are the same file",)),
        (
            ("fit", *FILES, "--map", "pt_pa=TotalP", *PROBE),
            ("--map pt_pa=TotalP: no flight has a column 'TotalP'",),
        ),
        (("diagnose", "mon.csv", "joint.json"), ("joint.json is of 3 flights; give them all",)),
        (("intervals", *FILES[:2], "joint.json"), ("wed.csv is missing, or changed since",)),
    ],
)
def test_bad_input_is_named(fleet: Bench, command: tuple[str, ...], words: tuple[str, ...]) -> None:
    assert_refused(fleet, *command, words=words)


def test_a_fourth_flight_has_no_wind_to_compare_with(fleet: Bench) -> None:
    outcome = fleet.run("compare", "thu.csv", "joint.json")
    assert_one_line(
        fleet, outcome, "thu.csv: none of the flights that were fitted", "w_n, w_e, w_d"
    )


def test_a_report_is_of_all_flights(fleet: Bench) -> None:
    """With their winds in words, whether each agrees with the others, and how to make it again."""
    pytest.importorskip("plotly", reason="the report draws with plotly: pip install sepcal[report]")
    command = [sys.executable, "-m", "sepcal", "report", *FILES, "joint.json", "-o", "joint.html"]
    subprocess.run(command, cwd=fleet.folder, check=True, capture_output=True)
    page = (fleet.folder / "joint.html").read_text()
    for label in WINDS:
        assert f"<b>wind@{label}</b>: from " in page
        assert f"wind, north, of {label}" in page
    assert "Does a flight depart from the others?" in page
    assert f"sepcal report {' '.join(FILES)} joint.json -o joint.html" in page
    assert len(page) < 3_000_000


def test_a_column_that_one_flight_lacks_is_named_with_those_that_have_it(
    fleet: Bench, tmp_path: Path
) -> None:
    spoilt = Bench("sepcal-pitot", tmp_path, PROBE, None)
    for file in FILES:
        log = Log(fleet.folder / file)
        if file == "tue.csv":
            log.drop("vn_mps")
        (tmp_path / file).write_text(log.text())
    outcome = spoilt.run("fit", *FILES, "--own", "wind", *PROBE)
    words = ("column 'vn_mps' is missing", "left out: vn_mps (mon.csv), vn_mps (wed.csv)")
    assert_one_line(spoilt, outcome, *words)
