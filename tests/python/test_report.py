# SPDX-License-Identifier: BSD-3-Clause
"""The report: what stands in it, that it needs nothing from outside, and how it refuses."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import sepcal
from apps import small_files
from browser import show
from sepcal.reporting import words
from sepcal.reporting.colours import DARK
from sepcal.reporting.page import read_plotly

pytest.importorskip("plotly", reason="the report draws with plotly: pip install sepcal[report]")

FIVE_HOLE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
KINDS = {
    "five-hole": (FIVE_HOLE, {"wind[altitude_m]": (0.05, 0.02)}),
    "pitot-static": (sepcal.PitotStatic(), {}),
    "magnetometer": (sepcal.Magnetometer(), {"bias[current_a]": (0.2, 0.1, 0.1)}),
    "magnetometer-norm": (sepcal.Magnetometer(field_strength=53.37), {}),
}
TITLES = [
    "The error, step by step", "Measured and modelled", "Where it fails", "Ranked candidates",
    "Residual against the channels", "What the first candidates explain", "Is the rest noise?",
    "Parameters", "What the flight covered", "What to fly or log next", "Where this comes from",
]  # fmt: skip
LARGEST = 6e6  # bytes, Plotly included


class Reader(HTMLParser):
    """Text of a page but for its scripts, and every address it names."""

    def __init__(self) -> None:
        super().__init__()
        self.text: list[str] = []
        self.addresses: list[str] = []
        self.scripts: list[str] = []
        self.tags: set[str] = set()
        self._inside = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keeps the tag and the addresses in it."""
        self._inside = tag
        self.tags.add(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href", "data")]

    def handle_endtag(self, tag: str) -> None:
        """Text that follows is not the tag's."""
        self._inside = ""

    def handle_data(self, data: str) -> None:
        """Keeps text and scripts apart."""
        (self.scripts if self._inside == "script" else self.text).append(data)


@dataclass(frozen=True)
class Written:
    """A page with what it is about."""

    file: Path
    flight: Path
    chain: list[sepcal.Calibration]
    diagnosis: sepcal.Diagnosis

    @property
    def html(self) -> str:
        """The whole file."""
        return self.file.read_text(encoding="utf-8")

    def read(self) -> Reader:
        """The page as its reader meets it."""
        reader = Reader()
        reader.feed(self.html)
        return reader


def write_flight(flight: sepcal.Flight, file: Path) -> None:
    labels = flight.maneuvers
    rows = zip(*(flight[header].tolist() for header in flight), labels, strict=True)
    lines = [",".join([*flight.columns, "maneuver"])]
    lines += [",".join(map(str, row)) for row in rows]
    file.write_text("\n".join(lines) + "\n")


@pytest.fixture(scope="module", params=[*KINDS, "chain"])
def page(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Written:
    """A report of each probe, and of a chain of two calibrations."""
    kind = "five-hole" if request.param == "chain" else request.param
    folder = tmp_path_factory.mktemp(request.param)
    probe, hide = KINDS[kind]
    simulated = kind.removesuffix("-norm") if kind.endswith("-norm") else probe
    write_flight(sepcal.simulate(simulated, rows=1500, seed=4, hide=hide), folder / "flight.csv")
    flight = sepcal.read_csv(folder / "flight.csv")
    chain = [sepcal.fit(probe, flight)]
    if request.param == "chain":
        chain.append(chain[0].add("wind[altitude_m]"))
    diagnosis = chain[-1].diagnose()
    sepcal.report(chain, folder / "report.html", diagnosis=diagnosis)
    return Written(folder / "report.html", folder / "flight.csv", chain, diagnosis)


def test_all_sections(page: Written) -> None:
    reader, last = page.read(), page.chain[-1]
    text = " ".join(reader.text)
    places = [text.index(title, text.index(TITLES[-1]) + 1) for title in TITLES]
    assert places == sorted(places)
    assert text.index(page.diagnosis.sentence) < places[0]
    for effect in page.diagnosis.effects:
        assert effect.name in reader.text
        assert effect.sentence in reader.text
    assert {*last.names} <= set(reader.text)
    for port in page.diagnosis.limits:
        assert port in reader.text
    assert sepcal.read_csv(page.flight).sha256 in text
    assert sepcal.__version__ in text
    assert "can't be drawn" not in text


def test_what_is_found_is_said_first(page: Written) -> None:
    text = " ".join(page.read().text)
    top = text[: text.index(TITLES[0])]
    history = page.chain[-1].history
    nothing_else = history and page.diagnosis.verdict == "adequate"
    assert (words.NOTHING_ELSE if nothing_else else words.VERDICTS[page.diagnosis.verdict]) in top
    if history and history[0].rmse_before > history[-1].rmse_after:
        assert f"With {' and '.join(entry.effect for entry in history)} the error fell" in top
    if page.diagnosis.found:
        name = page.diagnosis.found[0].name
        assert f"less with {name}" in top
        assert f"next: + {name}" in page.html
    steps = page.html.count('"ticktext":["first model"')
    assert steps == (1 if page.chain[-1].history else 0)


def test_nothing_comes_from_outside(page: Written) -> None:
    reader = page.read()
    assert all(address.startswith("#s") for address in reader.addresses)
    assert not reader.tags & {"link", "img", "iframe", "object", "embed", "base"}
    assert "default-src 'none'" in page.html
    own = page.html.replace(read_plotly(), "")
    assert re.search(r"https?://|@import|url\(|\bfetch\(|XMLHttpRequest|import\(", own) is None
    assert 'plotlyServerURL: ""' in own  # Plotly's own button would upload the figure


def test_it_is_small_and_the_same_again(page: Written, tmp_path: Path) -> None:
    assert page.file.stat().st_size < LARGEST
    again = tmp_path / "report.html"
    sepcal.report(page.chain, again, diagnosis=page.diagnosis)
    here, there = (file.read_text().replace(str(file), "") for file in (page.file, again))
    assert here == there


def read_pool(html: str) -> dict[str, list]:
    text = html.split('<script type="application/json" id="pool">')[1].split("</script>")[0]
    return json.loads(text)


def test_figures_are_numbered_as_they_stand(page: Written) -> None:
    pool = read_pool(page.html)
    places = [int(place) for place in re.findall(r'data-figure="(\d+)"', page.html)]
    assert places == list(range(len(pool["figures"])))
    assert len(places) >= 10
    for figure in pool["figures"]:
        assert figure["data"]
        assert figure["layout"]["height"] > 100


def run(*arguments: object, folder: Path) -> subprocess.CompletedProcess[str]:
    package = Path(sepcal.__file__).parent.parent
    return subprocess.run(
        [sys.executable, "-m", "sepcal", *map(str, arguments)],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(package)}, capture_output=True, text=True,
        check=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a flight and two calibrations of it."""
    folder = tmp_path_factory.mktemp("small")
    simulated = sepcal.simulate(sepcal.PitotStatic(), rows=600, seed=2)
    write_flight(simulated, folder / "flight.csv")
    flight = sepcal.read_csv(folder / "flight.csv")
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    base.save(folder / "base.json")
    base.add("airspeed_bias[throttle]").save(folder / "next.json")
    return folder


def test_the_command(small: Path) -> None:
    done = run("report", "flight.csv", "base.json", "next.json", "-o", "r.html", folder=small)
    assert (done.returncode, done.stdout, done.stderr) == (0, "wrote r.html\n", "")
    html = (small / "r.html").read_text()
    assert "python -m sepcal report flight.csv base.json next.json -o r.html" in html
    assert "base.json" in html
    assert "airspeed_bias[throttle]" in html
    assert not list(small.glob(".report-*"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("report", "none.csv", "base.json"), ("sepcal report: ", "none.csv")),
        (("report", "flight.csv", "none.json"), ("sepcal report: ", "none.json")),
        (("report", "flight.csv", "flight.csv"), ("sepcal report: ", "flight.csv")),
        (("report", "flight.csv"), ("sepcal report: ", "CAL.json", "--help")),
        (
            ("report", "flight.csv", "base.json", "-o", "no/r.html"),
            ("no/r.html", "folder 'no' isn't there"),
        ),
        (("report", "flight.csv", "base.json", "-o", "."), ("is a folder",)),
        (("frobnicate",), ("sepcal: ", "frobnicate")),
        ((), ("sepcal: ", "command")),
    ],
)
def test_bad_usage(small: Path, arguments: tuple[str, ...], words: tuple[str, ...]) -> None:
    before = sorted(small.iterdir())
    refused = run(*arguments, folder=small)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr.count("\n") == 1
    for word in words:
        assert word in refused.stderr
    assert sorted(small.iterdir()) == before


def test_bad_calls(small: Path, tmp_path: Path) -> None:
    base = sepcal.load(small / "base.json")
    field = sepcal.simulate("magnetometer", rows=300)
    other = sepcal.fit(sepcal.Magnetometer(), field)
    flight = sepcal.read_csv(small / "flight.csv")
    for chain, given, message in [
        ([], flight, "a report needs a calibration"),
        ([base, other], flight, "several models: magnetometer, pitot-static"),
        (base, None, "a loaded calibration has no flight"),
    ]:
        with pytest.raises(sepcal.Error, match=message):
            sepcal.report(chain, tmp_path / "r.html", given)
    assert list(tmp_path.iterdir()) == []


def test_another_flight_than_the_fitted_one(small: Path, tmp_path: Path) -> None:
    """A parameter that was fitted elsewhere is said to be."""
    other = sepcal.simulate(sepcal.PitotStatic(), rows=500, seed=9)
    base = sepcal.load(small / "base.json")
    sepcal.report(base, tmp_path / "r.html", other)
    assert "fitted on another flight, " in (tmp_path / "r.html").read_text()


def test_a_fit_that_failed_says_so_on_top(tmp_path: Path) -> None:
    """Straight and level: nothing separates the wind from the airspeed's errors."""
    flight = sepcal.simulate(FIVE_HOLE, rows=500, seed=4, excitation="poor")
    base = sepcal.fit(FIVE_HOLE, flight)
    assert base.status == "not_identifiable"
    sepcal.report(base, tmp_path / "r.html")
    html = (tmp_path / "r.html").read_text()
    top = html[: html.index(TITLES[0])]
    assert "not identifiable" in top
    assert escape(base.message) in top
    for at in base.unobservable:
        assert escape(at.text) in html[len(top) :]


def test_without_plotly(small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    base = sepcal.load(small / "base.json")
    flight = sepcal.read_csv(small / "flight.csv")
    with pytest.raises(sepcal.Error, match=r"pip install sepcal\[report\]"):
        sepcal.report(base, tmp_path / "r.html", flight)
    assert list(tmp_path.iterdir()) == []


def test_an_interrupted_report_leaves_the_old_one(page: Written, tmp_path: Path) -> None:
    (tmp_path / "r.html").write_text("old")
    with small_files(4096), pytest.raises(sepcal.Error, match="writing failed: File too large"):
        sepcal.report(page.chain, tmp_path / "r.html", diagnosis=page.diagnosis)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["old"]


def test_names_from_a_file_are_text(tmp_path: Path) -> None:
    """A header and a label that are HTML stay what they are: words."""
    simulated = sepcal.simulate(sepcal.PitotStatic(), rows=600, seed=2)
    evil = "<img src=x onerror=alert(1)>"
    columns = {header: simulated[header] for header in simulated}
    columns[evil] = np.random.default_rng(1).normal(size=simulated.rows)
    labels = ["</script><i>one" if i < 300 else "two" for i in range(simulated.rows)]
    flight = sepcal.Flight(columns, maneuver=labels, name="<b>flight</b>")
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    sepcal.report(base, tmp_path / "r.html", flight)
    html = (tmp_path / "r.html").read_text()
    assert escape(evil) in html
    for raw in (evil, "</script><i>one", "<b>flight</b>"):
        assert raw not in html.replace(read_plotly(), "")


def test_a_browser_draws_every_figure(page: Written, tmp_path: Path) -> None:
    """Headless Chromium, without a network: all figures drawn, no script error, no complaint."""
    _, root, complaints = show(page.file, tmp_path)
    assert "data-problems" not in root
    assert f'data-drawn="{page.html.count("data-figure=")}"' in root
    assert complaints == []


def as_rgb(colour: str) -> str:
    """As a browser writes "#15191d" or "#fff": "rgb(21, 25, 29)"."""
    digits = colour[1:] if len(colour) == 7 else "".join(2 * at for at in colour[1:])
    return f"rgb({', '.join(str(int(digits[i : i + 2], 16)) for i in (0, 2, 4))})"


def test_figures_are_dark_where_the_reader_has_it_so(tmp_path: Path) -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.simulate(sepcal.PitotStatic(), rows=300))
    sepcal.report(base, tmp_path / "r.html")
    for scheme, ground in (("0", DARK["#fff"]), ("1", "#fff")):
        asked = f"--blink-settings=preferredColorScheme={scheme}"
        document, root, complaints = show(tmp_path / "r.html", tmp_path / scheme, asked)
        assert "data-problems" not in root
        assert complaints == []
        grounds = re.findall(r'class="main-svg"[^>]*background: ([^;]*);', document)
        assert {at for at in grounds if at != "transparent"} == {as_rgb(ground)}


def test_every_colour_of_a_page_has_a_dark_one(page: Written) -> None:
    """One that the dark ones don't know would stay as it is on white."""
    pool = next(text for text in page.read().scripts if text.lstrip().startswith('{"arrays"'))
    figures = json.dumps(json.loads(pool)["figures"])
    spelled = set(re.findall(r'"(#[0-9a-f]{3,6}|rgba\([^"]*\))"', figures))
    assert "#fff" in spelled
    assert spelled <= set(DARK), spelled - set(DARK)


def test_a_narrow_page_scrolls_its_tables_and_not_itself(tmp_path: Path) -> None:
    """With names of sixty letters, in a window of 500 px, which is Chromium's least."""
    simulated = sepcal.simulate(sepcal.PitotStatic(), rows=300)
    columns = {header: simulated[header] for header in simulated}
    long = "temperature_of_the_avionics_bay_behind_the_seat_of_the_pilot"
    columns[long] = np.random.default_rng(1).normal(size=simulated.rows)
    flight = sepcal.Flight(columns, maneuver=["a_maneuver_with_a_long_name"] * simulated.rows)
    sepcal.report(sepcal.fit(sepcal.PitotStatic(), flight), tmp_path / "r.html", flight)
    html = (tmp_path / "r.html").read_text()
    assert f"wind[{long}]" in html
    script = (
        "<script>setInterval(() => { const root = document.documentElement;"
        "root.dataset.width = `${root.clientWidth},${root.scrollWidth}`; }, 100)</script>"
    )
    (tmp_path / "r.html").write_text(html.replace("</body>", f"{script}</body>"))
    _, root, _ = show(tmp_path / "r.html", tmp_path / "profile", "--window-size=500,900")
    told = re.search(r'data-width="(\d+),(\d+)"', root)
    assert told is not None, root
    assert int(told[1]) <= 500
    assert told[1] == told[2]
