# SPDX-License-Identifier: BSD-3-Clause
"""The report of flight paths and aircraft: its numbers are the flight's and the smoother's."""

import argparse
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import apps
import sepcal
from refusals import refuse
from sepcal.__main__ import main
from sepcal.reporting import command
from sepcal.reporting.page import Figure, Grid, Section
from sepcal.reporting.trajectory import compose_flown, gather_flown

pytest.importorskip("plotly", reason="the report draws with plotly: pip install sepcal[report]")

NOISE = {"ax": 0.01, "ay": 0.01, "az": 0.01, "p": 1e-3, "q": 1e-3, "r": 1e-3}
TITLES = [
    "The error, step by step", "Measured and modelled", "Where it fails",
    "Residual against the channels", "States", "Innovations", "Process noise", "Parameters",
    "Where this comes from",
]  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A flight, its aircraft, the path and the longitudinal motion of it."""
    folder = tmp_path_factory.mktemp("report")
    for arguments in (
        ("simulate", "-o", "flight.csv", "--geometry", "aircraft.json", "--rows", "1000"),
        ("fit", "flight.csv", "--model", "path", "-o", "path.json"),
        ("fit", "flight.csv", "--model", "longitudinal", "--geometry", "aircraft.json",
         "-o", "lon.json"),
        ("add", "flight.csv", "lon.json", "Cm[alpha^2]", "-o", "next.json"),
    ):  # fmt: skip
        done = apps.run("sepcal-aircraft", *arguments, folder=folder)
        assert done.code == 0, done.err
    return folder


def pictures(section: Section) -> list[Figure]:
    found: list[Figure] = []
    for block in section.blocks:
        found += block.figures if isinstance(block, Grid) else []
        found += [block] if isinstance(block, Figure) else []
    return found


def test_what_is_drawn_is_what_was_measured_and_smoothed(folder: Path) -> None:
    flight = sepcal.read_csv(folder / "flight.csv")
    path = sepcal.load(folder / "path.json")
    flown = gather_flown([path], flight, ["path.json"], NOISE, lambda _: None)
    page = compose_flown(flown, "report.html")
    assert [section.title for section in page.sections] == TITLES
    overlay = pictures(page.sections[1])[0]
    measured = [trace for trace in overlay.data if trace.get("name") == "measured"]
    for trace, header in zip(measured, ("airspeed_mps", "beta_rad", "alpha_rad"), strict=False):
        assert_allclose(trace["y"], flight[header], atol=1e-9)
    smoothed = path.smooth(NOISE, flight)
    states = pictures(page.sections[4])
    assert len(states) == 6
    for figure, state in zip(states, smoothed.states, strict=True):
        drawn = figure.data[1]
        assert_allclose(drawn["y"], np.interp(drawn["x"], flight["time_s"], smoothed[state]))
    assert states[0].layout["yaxis"]["title"]["text"] == "u [m/s]"
    assert len(pictures(page.sections[5])) == len(smoothed.outputs)
    noises = pictures(page.sections[6])
    assert [figure.layout["yaxis"]["title"]["text"] for figure in noises[2:4]] == [
        "az [m/s^2]", "p [rad/s]",
    ]  # fmt: skip


def test_the_command_writes_one_page_twice_the_same(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    noise = [f"--process-noise={name}={sd}" for name, sd in NOISE.items()]
    for file in ("one.html", "two.html"):
        assert main(["report", "flight.csv", "path.json", *noise, "-o", file]) == 0
    one, two = (Path(file).read_text() for file in ("one.html", "two.html"))
    assert one.replace("one.html", "two.html") == two
    assert "Residuals" in one or "The residuals are noise" in one
    assert re.search(r"report flight.csv path.json --process-noise=ax=0.01", one)
    assert main(["report", "flight.csv", "lon.json", "next.json", "-o", "chain.html"]) == 0
    chain = Path("chain.html").read_text()
    assert "<code>Cm[alpha^2]</code>" in chain
    assert "Give process noise to have the states" in chain
    assert "errors of the states that were read" in chain


def test_bad_input_is_one_line(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    flight = sepcal.read_csv("flight.csv")
    path, lon = sepcal.load("path.json"), sepcal.load("lon.json")
    refuse(lambda: sepcal.report([path, lon], "r.html", flight), "of several models")
    refuse(lambda: sepcal.report(path, "r.html"), "a loaded fit has no flight")
    refuse(
        lambda: sepcal.report(path, "r.html", flight, process_noise={"u": 1.0}),
        "no process noise 'u'; the model has: ax, ay, az, p, q, r",
    )
    for text in ("ax", "ax=", "=1"):
        code = main(["report", "flight.csv", "path.json", "--process-noise", text])
        assert code == 2
        assert f"--process-noise {text}: write it as NAME=SD" in capsys.readouterr().err
    assert not Path("r.html").exists()


def test_what_was_read_is_not_written_over(folder: Path) -> None:
    log, path = folder / "flight.csv", folder / "path.json"
    for read in (log, path):
        before = read.read_bytes()
        wishes = argparse.Namespace(
            flight=str(log),
            calibrations=[str(path)],
            output=str(read),
            process_noise=[],
            model=None,
        )
        refuse(
            lambda wishes=wishes: command.run(wishes),
            f"{read}: it is an input, and writing there would lose it; name another file",
        )
        assert read.read_bytes() == before
