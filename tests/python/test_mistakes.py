# SPDX-License-Identifier: BSD-3-Clause
"""Nine mistakes that people make: one line names the mend, and the mend as typed gives the truth.

The flights are made here, with noise, of a simulation that shares nothing with the programs'.
"""

import json
import re
import shlex
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from apps import Outcome, run

Columns = dict[str, np.ndarray]

KNOT = 1852 / 3600
TRUTH = {"s_va": 0.95, "c_va": -0.6, "w_n": -3.8, "w_e": 2.4}
EARTH = np.array([19.7, -1.4, 49.4])
FIELD = ("--field", "19.7,-1.4,49.4")
PORTS = ("--k-alpha", "5", "--k-beta", "5")


def rotation(roll: np.ndarray, pitch: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    """From body to north-east-down axes, rows x 3 x 3."""
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    cy, sy = np.cos(yaw), np.sin(yaw)
    return np.moveaxis(
        np.array(
            [
                [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
                [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
                [-sp, sr * cp, cr * cp],
            ]
        ),
        2,
        0,
    )


@dataclass
class Flight:
    """A flight with turns, climbs and a changing airspeed, of a shape of its own for each seed."""

    seed: int
    wind: tuple[float, float] = (-3.8, 2.4)
    rows: int = 1500
    rate: float = 5.0
    rng: np.random.Generator = field(init=False)

    def __post_init__(self) -> None:
        self.rng = rng = np.random.default_rng(self.seed)
        t = self.t = np.arange(self.rows) / self.rate
        turn = rng.choice([-1, 1]) * rng.uniform(0.03, 0.12)
        if self.seed % 2:  # figures of eight
            turn = turn * np.sign(np.sin(2 * np.pi * t / (4 * np.pi / abs(turn))))
        self.yaw = rng.uniform(-3, 3) + np.cumsum(turn * np.ones_like(t)) / self.rate
        self.speed = rng.uniform(17, 30) + rng.uniform(1, 3) * np.sin(t / rng.uniform(10, 30))
        self.alpha = np.radians(4) + np.radians(2) * np.sin(t / rng.uniform(4, 9))
        self.beta = np.radians(rng.uniform(3, 7)) * np.sin(t / rng.uniform(3, 8))
        self.roll = np.arctan(turn * self.speed / 9.81) * np.ones_like(t)
        self.pitch = self.alpha + np.radians(1.5) * np.sin(t / rng.uniform(15, 40))
        direction = np.stack(
            [
                np.cos(self.alpha) * np.cos(self.beta),
                np.sin(self.beta),
                np.sin(self.alpha) * np.cos(self.beta),
            ],
            axis=1,
        )
        self.turned = rotation(self.roll, self.pitch, self.yaw)
        air = np.einsum("nij,nj->ni", self.turned, direction * self.speed[:, None])
        self.velocity = air + np.array([*self.wind, 0.0])

    def noise(self, size: float) -> np.ndarray:
        """White, of that standard deviation, a value a row."""
        return self.rng.normal(0, size, self.rows)

    def attitude(self) -> Columns:
        """Yaw within a turn."""
        yaw = np.mod(self.yaw + np.pi, 2 * np.pi) - np.pi
        return {"roll_rad": self.roll, "pitch_rad": self.pitch, "yaw_rad": yaw}

    def ground(self) -> Columns:
        """The velocity over the ground, as logged."""
        names = ("vn_mps", "ve_mps", "vd_mps")
        return {n: self.velocity[:, i] + self.noise(0.03) for i, n in enumerate(names)}

    def tube(self) -> Columns:
        """A Pitot-static tube's log."""
        read = TRUTH["s_va"] * self.speed + TRUTH["c_va"] + self.noise(0.1)
        return {"time_s": self.t, **self.ground(), "airspeed_mps": read, **self.attitude()}

    def by_track(self) -> Columns:
        """The tube with speed and track in the place of north and east."""
        columns = self.tube()
        north, east, down = (columns.pop(n) for n in ("vn_mps", "ve_mps", "vd_mps"))
        columns["gs_mps"] = np.hypot(north, east)
        columns["track_deg"] = np.mod(np.degrees(np.arctan2(east, north)), 360)
        columns["vs_mps"] = -down
        return columns

    def five_hole(self) -> Columns:
        """A five-hole probe's log."""
        q = 0.5 * 1.2 * self.speed**2
        ps = np.full(self.rows, 90000.0)
        return {
            "time_s": self.t,
            **self.ground(),
            **self.attitude(),
            "pt_pa": ps + q + self.noise(1.0),
            "ps_pa": ps,
            "dpa_pa": 5 * q * self.alpha + self.noise(1.0),
            "dpb_pa": 5 * q * self.beta + self.noise(1.0),
            "rho_kgpm3": np.full(self.rows, 1.2),
        }

    def magnetometer(self) -> Columns:
        """A magnetometer's log, of its own attitude."""
        wide = Flight(self.seed + 5000, rows=self.rows)
        roll = 1.2 * np.sin(wide.t / 3)
        pitch = 0.9 * np.sin(wide.t / 7)
        h = np.einsum("nji,j->ni", rotation(roll, pitch, self.yaw), EARTH)
        m = h * [1.05, 0.95, 1.1] + [10, -5, 7]
        yaw = np.mod(self.yaw + np.pi, 2 * np.pi) - np.pi
        read = {n: m[:, i] + self.noise(0.2) for i, n in enumerate(("mx_ut", "my_ut", "mz_ut"))}
        return {"time_s": self.t, **read, "roll_rad": roll, "pitch_rad": pitch, "yaw_rad": yaw}


def write(file: Path, columns: Columns) -> None:
    np.savetxt(
        file,
        np.column_stack(list(columns.values())),
        fmt="%.7g",
        delimiter=",",
        header=",".join(columns),
        comments="",
    )


# --- the mistakes


def scaled(columns: Columns, names: tuple[str, ...], factor: float) -> Columns:
    return {n: v * (factor if n in names else 1.0) for n, v in columns.items()}


def renamed(columns: Columns, names: dict[str, str]) -> Columns:
    return {names.get(n, n): v for n, v in columns.items()}


def swapped(columns: Columns) -> Columns:
    return renamed(columns, {"vn_mps": "ve_mps", "ve_mps": "vn_mps"})


def in_radians_as_degrees(columns: Columns) -> Columns:
    return {n: np.radians(v) if n == "track_deg" else v for n, v in columns.items()}


def in_degrees_as_radians(columns: Columns) -> Columns:
    return renamed(columns, {"track_deg": "track_rad"})


@dataclass
class Mistake:
    """How a log is spoilt, and the option that its line must name."""

    make: Callable[[Flight], Columns]
    option: str
    app: str = "sepcal-pitot"
    typed: tuple[str, ...] = ()


SPEEDS = ("vn_mps", "ve_mps", "vd_mps")
READINGS = ("mx_ut", "my_ut", "mz_ut")

MISTAKES = {
    "a missing map": Mistake(
        lambda f: renamed(f.tube(), {"airspeed_mps": "TAS"}), "--map airspeed_mps=TAS"
    ),
    "a wrong unit": Mistake(
        lambda f: scaled(f.tube(), ("airspeed_mps",), 3.6), "--map airspeed_kmh=airspeed_mps"
    ),
    "nT for uT": Mistake(
        lambda f: scaled(f.magnetometer(), READINGS, 1000),
        "--map mx_nt=mx_ut,my_nt=my_ut,mz_nt=mz_ut",
        "sepcal-mag",
        FIELD,
    ),
    "a swapped sign": Mistake(
        lambda f: scaled(f.five_hole(), ("dpb_pa",), -1), "--map dpb_pa=-dpb_pa", typed=PORTS
    ),
    "north and east swapped": Mistake(
        lambda f: swapped(f.tube()), "--map vn_mps=ve_mps,ve_mps=vn_mps"
    ),
    "knots": Mistake(
        lambda f: scaled(f.tube(), SPEEDS, 1 / KNOT), "--map vn_kt=vn_mps,ve_kt=ve_mps,vd_kt=vd_mps"
    ),
    "degrees": Mistake(lambda f: in_degrees_as_radians(f.by_track()), "--map track_deg=track_rad"),
    "radians": Mistake(lambda f: in_radians_as_degrees(f.by_track()), "--map track_rad=track_deg"),
}

OPTION = re.compile(r"--(?:map|k-alpha)\b")


def naming_lines(said: str) -> list[str]:
    """Lines that name an option to type."""
    return [line for line in said.splitlines() if OPTION.search(line)]


def values(done: Outcome) -> dict[str, float]:
    return {name: parameter["value"] for name, parameter in done.result["parameters"].items()}


def check_truth(app: str, done: Outcome, kind: str) -> None:
    found = values(done)
    if kind == "five-hole":
        assert abs(found["lambda_beta"]) < 0.05
        assert abs(found["w_n"] - TRUTH["w_n"]) < 0.1
    elif app == "sepcal-mag":
        assert found["lambda_x"] == pytest.approx(0.05, abs=0.01)
        assert found["n_x"] == pytest.approx(10, abs=0.3)
    else:
        assert found["s_va"] == pytest.approx(TRUTH["s_va"], abs=0.02)
        assert found["c_va"] == pytest.approx(TRUTH["c_va"], abs=0.4)
        assert found["w_n"] == pytest.approx(TRUTH["w_n"], abs=0.1)
        assert found["w_e"] == pytest.approx(TRUTH["w_e"], abs=0.1)


@pytest.mark.parametrize("name", list(MISTAKES))
def test_one_line_names_the_mend_which_mends(tmp_path: Path, name: str) -> None:
    mistake = MISTAKES[name]
    write(tmp_path / "log.csv", mistake.make(Flight(7)))
    given = ("log.csv", *mistake.typed)
    tried = run(mistake.app, "fit", *given, folder=tmp_path)
    lines = naming_lines(tried.err)
    assert len(lines) == 1, tried.err
    assert mistake.option in lines[0]
    mend = shlex.split(mistake.option)
    mended = run(mistake.app, "fit", *given, *mend, "--json", folder=tmp_path)
    assert mended.code == 0, mended.err
    assert naming_lines(mended.err) == []
    check_truth(mistake.app, mended, "five-hole" if mistake.typed == PORTS else "tube")


def test_an_option_that_is_nearly_one(tmp_path: Path) -> None:
    write(tmp_path / "log.csv", Flight(7).five_hole())
    tried = run("sepcal-pitot", "fit", "log.csv", "--k-alfa", "5", "--k-beta", "5", folder=tmp_path)
    assert tried.code == 2
    assert "did you mean --k-alpha?" in tried.err
    assert run("sepcal-pitot", "fit", "log.csv", *PORTS, folder=tmp_path).code == 0
    swapped = run("sepcal-mag", "fit", "log.csv", "--feild", "auto", folder=tmp_path)
    assert swapped.code == 2
    assert "did you mean --field?" in swapped.err


# --- how often


def lines_of_check(folder: Path, seed: int, mistake: Mistake, columns: Columns) -> list[str]:
    write(folder / f"{seed}.csv", columns)
    done = run(mistake.app, "check", f"{seed}.csv", *mistake.typed, folder=folder)
    return naming_lines(done.out + done.err)


@pytest.mark.parametrize("name", [n for n in MISTAKES if n != "a missing map"])
def test_most_flights_of_a_mistake_are_told(tmp_path: Path, name: str) -> None:
    mistake = MISTAKES[name]
    told = sum(
        any(
            mistake.option in line
            for line in lines_of_check(tmp_path, seed, mistake, mistake.make(Flight(seed)))
        )
        for seed in range(100, 150)
    )
    assert told >= 48


KINDS: dict[str, Mistake] = {
    "tube": Mistake(Flight.tube, ""),
    "track": Mistake(Flight.by_track, ""),
    "five-hole": Mistake(Flight.five_hole, "", typed=PORTS),
    "magnetometer": Mistake(Flight.magnetometer, "", "sepcal-mag", FIELD),
}


@pytest.mark.parametrize("kind", list(KINDS))
def test_right_flights_are_told_nothing(tmp_path: Path, kind: str) -> None:
    right = KINDS[kind]
    for seed in range(200, 250):
        rng = np.random.default_rng(seed)
        speed, bearing = rng.uniform(0, 9), rng.uniform(0, 2 * np.pi)
        flight = Flight(
            seed,
            wind=(speed * np.cos(bearing), speed * np.sin(bearing)),
            rate=float(rng.choice([2.0, 5.0, 10.0])),
        )
        assert lines_of_check(tmp_path, seed, right, right.make(flight)) == [], seed


def test_a_fit_that_refutes_a_note_withdraws_it(tmp_path: Path) -> None:
    """A wind stronger than the airspeed looks like knots over the ground until it is fitted."""
    write(tmp_path / "log.csv", Flight(7, wind=(26.0, 14.0)).tube())
    done = run("sepcal-pitot", "fit", "log.csv", "--json", folder=tmp_path)
    assert json.loads(done.out)["status"] == "converged"
    assert naming_lines(done.err) == []
