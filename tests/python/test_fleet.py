# SPDX-License-Identifier: BSD-3-Clause
"""Fleets of logs: which logs, on which filesystem, by which workers, again after a kill."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import least_squares

import sepcal
from sepcal import _core
from sepcal.fleet import logs as fleet_logs
from sepcal.fleet.report import fleet_report
from sepcal.interrupts import interrupts_held

SCALES = {"V1": 0.95, "V2": 0.97, "V3": 0.93, "V4": 0.95}
DAYS = ("2026-01-10", "2026-02-10", "2026-03-10")
NAMES = "{vehicle}_{date}.csv"


def fly(vehicle: str, day: int, **hide: float) -> sepcal.Flight:
    """A flight of one of the vehicles in a wind of its own."""
    seed = 100 * int(vehicle[1:]) + day
    rng = np.random.default_rng(seed)
    parameters = {"s_va": SCALES.get(vehicle, 0.95), "w_n": rng.normal(0, 3), "w_e": rng.normal()}
    return sepcal.simulate(
        "pitot-static", rows=240, seed=seed, parameters=parameters, hide=hide or None
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve logs of four vehicles."""
    made = tmp_path_factory.mktemp("logs")
    for vehicle in SCALES:
        for number, day in enumerate(DAYS):
            fly(vehicle, number).to_csv(made / f"{vehicle}_{day}.csv")
    return made


@pytest.fixture(scope="module")
def fleet(folder: Path) -> sepcal.Fleet:
    made = sepcal.Fleet(folder, sepcal.PitotStatic(), names=NAMES)
    assert len(made.flights) == 12
    return made


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Two workers, each a process of one thread, that a nanny starts anew when they die."""
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            processes=True, n_workers=2, threads_per_worker=1, dashboard_address=":0"
        ) as cluster,
        distributed.Client(cluster) as made,
    ):
        yield made


def bits_of(fleet: sepcal.Fleet) -> str:
    """All that is known of it, to the last bit."""
    told = json.loads(fleet.to_json())
    for flight in told["flights"]:
        flight["file"] = ""
    return json.dumps(told)


def test_vehicles_and_what_their_names_say(fleet: sepcal.Fleet) -> None:
    for name, fit in fleet.vehicles.items():
        k = fleet.parameters.index("s_va")
        assert abs(fit.values[k] - SCALES[name]) < 5.0 * np.sqrt(np.asarray(fit.covariance)[k, k])
        assert fit.flights == 3
    assert fleet.own == ("w_n", "w_e", "w_d")
    first = fleet.flights["V1_2026-01-10.csv"]
    assert first.log.labels == {"date": "2026-01-10"}
    assert first.log.attributes == {"age_days": 0.0}
    assert fleet.flights["V1_2026-03-10.csv"].log.attributes == {"age_days": 59.0}
    assert repr(fleet) == "<sepcal.Fleet 12 flights of 4 vehicles>"
    assert "V3" in str(fleet)


def airspeed(columns: sepcal.Flight, x: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
    """The tube's model, z = s_va |v - w| + c_va."""
    north, east = columns["vn_mps"] - x[2], columns["ve_mps"] - x[3]
    return np.asarray(x[0] * np.sqrt(north**2 + east**2 + columns["vd_mps"] ** 2) + x[1])


def stacked(
    x: np.ndarray,  # type: ignore[type-arg]
    columns: list[sepcal.Flight],
    weights: list[float],
) -> np.ndarray:  # type: ignore[type-arg]
    """Weighed residuals of all flights, x = [s_va, c_va, wind of each]."""
    parts = []
    for i, (weight, flight) in enumerate(zip(weights, columns, strict=True)):
        own = np.array([*x[:2], *x[2 + 2 * i : 4 + 2 * i]])
        parts.append(weight * (flight["airspeed_mps"] - airspeed(flight, own)))
    return np.concatenate(parts)


def test_a_vehicle_is_scipys_fit_of_all_its_rows(folder: Path) -> None:
    """Rows weighed by what each flight leaves."""
    fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names=NAMES, candidates=[], tolerance=1e-7)
    for vehicle, fit in fleet.vehicles.items():
        flights = [one for one in fleet.flights.values() if one.log.vehicle == vehicle]
        columns = [sepcal.read(one.log.file) for one in flights]
        weights = []
        for one, flight in zip(flights, columns, strict=True):
            x = np.array([*one.factor.values, one.factor.own["w_n"], one.factor.own["w_e"]])
            steps = 1e-6 * np.eye(4)
            J = np.column_stack(
                [(airspeed(flight, x + d) - airspeed(flight, x - d)) / 2e-6 for d in steps]
            )
            upper = np.linalg.qr(J[:, [2, 3, 0, 1]], mode="r")[2:, 2:]
            gram = np.asarray(one.factor.triangle)[:2, :2]
            ratio = (gram.T @ gram) / (upper.T @ upper)
            assert_allclose(ratio, ratio[0, 0], rtol=1e-5)
            weights.append(np.sqrt(ratio[0, 0]))

        start = [*fit.values]
        for one in flights:
            start += [one.factor.own["w_n"], one.factor.own["w_e"]]
        best = least_squares(
            stacked, start, args=(columns, weights), method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15
        )
        errors = np.sqrt(np.diag(np.asarray(fit.covariance)))
        assert_allclose(np.asarray(fit.values), best.x[:2], rtol=0, atol=1e-5 * errors.min())


@pytest.mark.parametrize("workers", ["one thread", "threads", "processes", "dask"])
def test_the_bits_do_not_depend_on_the_workers(
    folder: Path, fleet: sepcal.Fleet, workers: str, request: pytest.FixtureRequest
) -> None:
    make = {
        "one thread": partial(ThreadPoolExecutor, 1),
        "threads": partial(ThreadPoolExecutor, 3),
        "processes": partial(ProcessPoolExecutor, 2),
    }
    if workers != "dask":
        other = sepcal.Fleet(folder, sepcal.PitotStatic(), names=NAMES, cluster=make[workers])
        assert bits_of(other) == bits_of(fleet)
        return
    client = request.getfixturevalue("client")
    other = sepcal.Fleet(folder, sepcal.PitotStatic(), names=NAMES, cluster=client.get_executor())
    assert bits_of(other) == bits_of(fleet)


@pytest.mark.slow
def test_a_cluster_that_grows_with_the_work(folder: Path, fleet: sepcal.Fleet) -> None:
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=0, threads_per_worker=1, dashboard_address=None, protocol="tcp://"
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        cluster.adapt(minimum=0, maximum=2, interval="200ms")
        grown = sepcal.Fleet(
            folder, sepcal.PitotStatic(), names=NAMES, cluster=client.get_executor()
        )
        assert bits_of(grown) == bits_of(fleet)


def test_a_worker_is_killed_on_the_way(
    folder: Path, fleet: sepcal.Fleet, tmp_path: Path, client: Any
) -> None:
    killed = []

    def kill() -> None:
        """SIGKILL of a worker once a few answers are there."""
        for _ in range(6000):
            if len(list(tmp_path.rglob("*.npz"))) >= 3:
                process = next(iter(client.cluster.workers.values()))
                os.kill(process.pid, signal.SIGKILL)
                killed.append(process.pid)
                return
            time.sleep(0.01)

    killer = threading.Thread(target=kill)
    killer.start()
    other = sepcal.Fleet(
        folder,
        sepcal.PitotStatic(),
        names=NAMES,
        cluster=client.get_executor(),
        store=tmp_path,
    )
    assert bits_of(other) == bits_of(fleet)
    killer.join()
    assert killed


@pytest.fixture
def remote(folder: Path) -> Iterator[str]:
    """The logs on a filesystem of fsspec that fails at one read in five."""
    fsspec = pytest.importorskip("fsspec")
    system = fsspec.filesystem("memory")
    for file in sorted(folder.iterdir()):
        system.pipe_file(f"/fleet/{file.name}", file.read_bytes())
    whole = type(system).get_file
    count = iter(range(10**9))

    def get_file(self: object, *arguments: object, **named: object) -> object:
        if next(count) % 5 == 2:
            raise OSError("the connection was reset")
        return whole(self, *arguments, **named)

    type(system).get_file = get_file
    try:
        yield "memory://fleet/*.csv"
    finally:
        type(system).get_file = whole
        system.rm("/fleet", recursive=True)


def test_a_filesystem_that_fails_now_and_then(remote: str, fleet: sepcal.Fleet) -> None:
    other = sepcal.Fleet(remote, sepcal.PitotStatic(), names=NAMES)
    assert bits_of(other) == bits_of(fleet)
    assert other.left_out == {}


def test_ctrl_c_ends_a_run_in_one_line(folder: Path, tmp_path: Path) -> None:
    """On processes too, whatever they are at; what was done is kept."""
    for log in folder.glob("*.csv"):
        for copy in range(40):
            shutil.copy(log, tmp_path / f"{log.stem.replace('_', f'-{copy}_')}.csv")
    sepcal.fit(sepcal.PitotStatic(), next(folder.glob("*.csv"))).save(tmp_path / "base.json")
    words = ["fleet", "fit", "*.csv", "--like", "base.json", "--names", NAMES, "-o", "kept"]
    run = subprocess.Popen(
        [sys.executable, "-m", "sepcal", *words, "--processes", "2"], cwd=tmp_path, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    while run.poll() is None and not list((tmp_path / "kept").glob("answers/*")):
        time.sleep(0.01)
    os.killpg(run.pid, signal.SIGINT)
    told, error = run.communicate(timeout=60)
    assert (run.returncode, told) == (130, "")
    assert error == (
        "sepcal fleet fit: stopped by Ctrl-C; the same command goes on with what is done\n"
    )


def test_an_interrupt_waits_for_the_end_of_a_block() -> None:
    done = []

    def work() -> None:
        with interrupts_held():
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.05)
            done.append(True)

    with pytest.raises(KeyboardInterrupt):
        work()
    assert done
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_run_is_taken_up_where_it_ended(
    folder: Path, fleet: sepcal.Fleet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copies = tmp_path / "logs"
    shutil.copytree(folder, copies)
    base = sepcal.fit(sepcal.PitotStatic(), copies / f"V1_{DAYS[0]}.csv")
    ask = partial(sepcal.Fleet, copies, base, names=NAMES, store=tmp_path / "store")
    from sepcal.fleet import passes as room

    visit, visited = room.visit, []

    def dies(question):  # type: ignore[no-untyped-def]
        visited.append(question.name)
        if len(visited) > 7:
            raise KeyboardInterrupt
        return visit(question)

    monkeypatch.setattr(room, "visit", dies)
    with pytest.raises(KeyboardInterrupt):
        len(ask(cluster=partial(ThreadPoolExecutor, 1)).flights)
    seen = set(visited[:7])
    assert len(seen) == 7

    def counts(question):  # type: ignore[no-untyped-def]
        visited.append((question.name, bool(question.at)))
        return visit(question)

    monkeypatch.setattr(room, "visit", counts)
    visited.clear()
    again = ask()
    assert bits_of(again) == bits_of(fleet)
    first_pass = {name for name, at in visited if not at}
    assert len(first_pass) >= 5
    assert len(first_pass & seen) <= 2  # that were being kept when it ended
    visited.clear()
    assert bits_of(ask()) == bits_of(fleet)
    assert visited == []
    # A log that has changed is read again, and it alone.
    changed = copies / f"V2_{DAYS[1]}.csv"
    fly("V2", 77).to_csv(changed)
    assert bits_of(ask()) != bits_of(fleet)
    assert {name for name, at in visited if not at} == {changed.name}


def test_a_bad_log_ends_nothing(folder: Path, fleet: sepcal.Fleet, tmp_path: Path) -> None:
    copies = tmp_path / "logs"
    shutil.copytree(folder, copies)
    (copies / "V1_2026-04-10.csv").write_text("time_s,airspeed_mps\n0,1\n")
    (copies / "V9_2026-04-11.csv").write_bytes(os.urandom(4000))
    shutil.copy(copies / f"V1_{DAYS[0]}.csv", copies / "V3_2026-04-13.csv")
    (copies / "V1_2026-04-12.csv").write_bytes(b"\x80\x04cos\nsystem\n(S'touch PWNED'\ntR.")
    other = sepcal.Fleet(copies, sepcal.PitotStatic(), names=NAMES)
    told, expected = json.loads(other.to_json()), json.loads(fleet.to_json())
    assert [one["parameters"] for one in told["vehicles"]] == [
        one["parameters"] for one in expected["vehicles"]
    ]
    assert len(other.left_out) == 4
    assert other.left_out["V3_2026-04-13.csv"] == f"its bytes are those of V1_{DAYS[0]}.csv"
    assert all("\n" not in reason for reason in other.left_out.values())
    assert not (copies / "PWNED").exists()


def test_the_loop(folder: Path, tmp_path: Path) -> None:
    """An effect in all vehicles: compared, found, added, and the error falls."""
    for vehicle in SCALES:
        for number, day in enumerate(DAYS):
            flight = fly(vehicle, number, **{"wind[altitude_m]": 0.05})
            flight.to_csv(tmp_path / f"{vehicle}_{day}.csv")
    fleet = sepcal.Fleet(tmp_path, sepcal.PitotStatic(), names=NAMES)
    assert [group.name for group in fleet.compare("month").groups] == [
        "2026-01", "2026-02", "2026-03"
    ]  # fmt: skip
    found = fleet.diagnose()
    assert found.found[0].effect == "wind[altitude_m]"
    grown = fleet.add(found.found[0].effect)
    (step,) = grown.added
    assert step["rmse_after"] < 0.9 * step["rmse_before"]
    assert step["flights_better"] == 12
    assert "wind[altitude_m].n" in grown.parameters
    assert grown.diagnose().found == []
    with pytest.raises(sepcal.Error, match="altitude"):
        grown.add("wind[altitude_m]")


def test_a_new_vehicle_with_the_fleet_as_its_prior(fleet: sepcal.Fleet) -> None:
    population = fleet.population()
    assert population.spread["s_va"] == pytest.approx(0.016, rel=0.8)
    short = fly("V7", 3).head(60)
    alone = sepcal.fit(sepcal.PitotStatic(), short)
    known = population.calibrate(short)
    assert known["s_va"].standard_error < 0.9 * alone["s_va"].standard_error
    mean, error = population.of("V2")["s_va"]
    assert abs(mean - SCALES["V2"]) < 5.0 * error
    with pytest.raises(sepcal.Error, match="no vehicle 'V77'"):
        population.of("V77")


def test_what_is_saved_is_read_back(fleet: sepcal.Fleet, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    fleet.save(tmp_path)
    flights = parquet.read_table(tmp_path / "flights.parquet").to_pylist()
    assert len(flights) == 12
    assert flights[0]["vehicle"] == "V1"
    vehicles = parquet.read_table(tmp_path / "vehicles.parquet").to_pylist()
    assert [one["vehicle"] for one in vehicles] == list(SCALES)
    assert sepcal.Fleet.load(tmp_path).to_json() == fleet.to_json()
    with pytest.raises(sepcal.Error, match=r"nowhere/setup\.json: No such file"):
        sepcal.Fleet.load("nowhere")
    (tmp_path / "setup.json").write_text("{}")
    with pytest.raises(sepcal.Error, match="no fleet's setup"):
        sepcal.Fleet.load(tmp_path)


def test_names_and_tables(folder: Path, tmp_path: Path) -> None:
    table = tmp_path / "logs.csv"
    table.write_text(
        "file,vehicle,operator,hours\n"
        + "".join(f"{file.name},{file.name[:2]},A,{k}\n" for k, file in enumerate(folder.iterdir()))
    )
    logs, misnamed = fleet_logs.find_logs(folder, None, table)
    assert misnamed == {}
    assert {log.vehicle for log in logs} == set(SCALES)
    assert all(set(log.attributes) == {"hours"} for log in logs)
    assert logs[0].labels == {"operator": "A"}
    logs, misnamed = fleet_logs.find_logs(folder, "V1_{date}.csv")
    assert (len(logs), len(misnamed)) == (3, 9)
    with pytest.raises(sepcal.Error, match="no parameter is called 'w_x'; there are: s_va"):
        len(sepcal.Fleet(folder, sepcal.PitotStatic(), names=NAMES, own=["w_x"]).flights)
    with pytest.raises(sepcal.Error, match="no log is called"):
        fleet_logs.find_logs(str(folder / "*.ulg"))
    with pytest.raises(sepcal.Error, match=r"its name does not fit '\{vehicle\}-x\.csv'"):
        fleet_logs.find_logs(folder, "{vehicle}-x.csv")
    with pytest.raises(sepcal.Error, match=r"has no \{field\}"):
        fleet_logs.find_logs(folder, "*.csv")
    table.write_text("file\nother.csv\n")
    with pytest.raises(sepcal.Error, match="has no row of"):
        fleet_logs.find_logs(folder, None, table)
    table.write_text("name\nother.csv\n")
    with pytest.raises(sepcal.Error, match="a column 'file'"):
        fleet_logs.find_logs(folder, None, table)
    with pytest.raises(sepcal.Error, match="give logs"):
        fleet_logs.find_logs(None)


def test_dates_as_logs_are_called() -> None:
    noon = datetime(2026, 4, 2, 12, 11, 10, tzinfo=UTC)
    for text in ("2026-04-02T12:11:10Z", "2026-04-02_12-11-10", "20260402-121110"):
        assert fleet_logs.read_date(text) == noon
    assert fleet_logs.read_date("2026-04-02") == datetime(2026, 4, 2, tzinfo=UTC)
    for text in ("2026-13-02", "2026-04-02_25-00-00", "flight 3", ""):
        assert fleet_logs.read_date(text) is None


def test_files_beside_the_logs_are_none(folder: Path, tmp_path: Path) -> None:
    """What `sepcal log` says of a flight stands beside it."""
    for log in folder.glob("V1_*.csv"):
        shutil.copy(log, tmp_path)
        (tmp_path / f"{log.name}.json").write_text("{}")
    logs, misnamed = fleet_logs.find_logs(tmp_path, NAMES)
    assert (len(logs), misnamed) == (3, {})


def test_times_of_one_flight_hold_for_no_other(folder: Path) -> None:
    flight = sepcal.read(next(folder.glob("*.csv")))
    part = sepcal.fit(sepcal.PitotStatic(), flight, stage_one_segments="2:40")
    with pytest.raises(sepcal.Error, match="of the rows 2:40 of its flight"):
        sepcal.Fleet(folder, part, names=NAMES)
    moving = sepcal.fit(sepcal.PitotStatic(), flight, where="airspeed_mps > 4")
    assert len(sepcal.Fleet(folder, moving, names=NAMES).logs) == 12


def test_unknown_groups_are_named(fleet: sepcal.Fleet) -> None:
    with pytest.raises(sepcal.Error, match="nothing is called 'colour'; there is: age_days"):
        fleet.compare("colour")
    assert len(fleet.compare("age_days").groups) == 3
    means = sorted(sepcal.read(one.log.file)["vn_mps"].mean() for one in fleet.flights.values())
    by_channel = fleet.compare("vn_mps").groups
    assert [group.flights for group in by_channel] == [3, 2, 2, 2, 3]
    assert by_channel[0].name.startswith(f"{means[0]:.4g} to ")
    assert len(fleet.compare("flight").groups) == 12


def test_a_change_and_a_departure_ring(tmp_path: Path) -> None:
    for number in range(6):
        for vehicle in ("V1", "V2", "V3", "V4", "V5"):
            seed = 10 * number + int(vehicle[1])
            scale = 0.95 + 0.06 * (vehicle == "V5" and number >= 3)
            flown = sepcal.simulate("pitot-static", rows=240, seed=seed, parameters={"s_va": scale})
            flown.to_csv(tmp_path / f"{vehicle}_2026-01-{10 + number}.csv")
    watched = sepcal.Fleet(tmp_path, sepcal.PitotStatic(), names=NAMES).monitor()
    assert [(one.vehicle, one.after) for one in watched.changes] == [("V5", "V5_2026-01-12.csv")]
    assert watched.exit_code == 3
    assert "V5" in str(watched)
    assert json.loads(watched.to_json())["alarm"] is True
    # Too few vehicles to say who departs, and one that changes: the page has it.
    two = [str(tmp_path / f"{vehicle}_*.csv") for vehicle in ("V4", "V5")]
    few = sepcal.Fleet(two, sepcal.PitotStatic(), names=NAMES)
    assert few.monitor().departures == ()
    assert "V5: s_va changes" in fleet_report(few)


def test_a_factor_comes_back_from_its_fields(fleet: sepcal.Fleet) -> None:
    factor = next(iter(fleet.flights.values())).factor
    made = _core.FlightFactor.__new__(_core.FlightFactor)
    made.__setstate__(tuple(getattr(factor, name) for name in factor._fields))
    assert np.array_equal(np.asarray(made.triangle), np.asarray(factor.triangle))
