# SPDX-License-Identifier: BSD-3-Clause
"""Hostile names, messages and file names through every writer.

What comes out is held against what plain names give: code, parameters, elements and lines are the
same, whatever a comment, a cell or a sentence says.
"""

from __future__ import annotations

import json
import os
import random
import re
import subprocess
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import headers
import sepcal
from apps import APPS, run

PIECES = [
    "*/", "/*", "*", "/", "\\", "\\\n", "\n", "\r", "\t", "??/", "??/\n", "'", '"', "`", "$(id)",
    "\x1b[31m", "\x1b]0;title\x07", "\x7f", "\x9b", "\u2028", "\u202e", "\u2066", "#", "#if 1",
    "a b", "<b>", "</script>", "<img src=x onerror=alert(1)>", "&lt;", "%s", "{0}",
    "ARMING_CHECK,0", "1\t1\tSYS_AUTOSTART\t4001\t6", "int evil(void){return 1;}",
    "status: converged", "ü", "é", "x",
]  # fmt: skip
COUNT = 2000
AT_ONCE = 10  # of them in one export
CASES = Path(__file__).resolve().parents[2].parent / "shared" / "cases" / "outputs"


def hostile_words(count: int, seed: int) -> list[str]:
    draw = random.Random(seed)
    return ["".join(draw.choices(PIECES, k=draw.randint(1, 6))) for _ in range(count)]


@pytest.fixture(scope="module")
def flown() -> sepcal.SimulatedFlight:
    return sepcal.simulate(sepcal.Magnetometer(), rows=500, seed=3)


@pytest.fixture(scope="module")
def calibrations(flown: sepcal.SimulatedFlight, tmp_path_factory: Any) -> dict[str, dict[str, Any]]:
    """Calibrations as JSON, by target."""
    folder = tmp_path_factory.mktemp("calibrations")
    models = {
        "c": sepcal.Magnetometer(field=(19.7, -1.4, 49.4)),
        "ardupilot": sepcal.Magnetometer(field_strength=53.2),
    }
    read = {}
    for target, model in models.items():
        sepcal.fit(model, flown, effects=["bias[current_a]"]).save(folder / "base.json")
        read[target] = json.loads((folder / "base.json").read_text())
        read[target]["inputs"]["sha256"] = "0" * 64
    return {**read, "cpp": read["c"], "px4": read["ardupilot"]}


def export(folder: Path, target: str, calibration: dict[str, Any], words: list[str]) -> str:
    """What is written of a calibration whose flight and message are named so."""
    calibration["inputs"]["file"] = " ".join(words)
    calibration["message"] = "; ".join(words)
    (folder / "base.json").write_text(json.dumps(calibration))
    done = run(
        "sepcal-mag", "export", "base.json", "--to", target, "-o", "out", "--force", folder=folder
    )
    assert done.code == 0, done.err
    assert_printable(done.out, done.err)
    return (folder / "out").read_text()


def assert_printable(*pages: str) -> None:
    for page in pages:
        assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]", page)


def strip_comments(code: str) -> str:
    """By the C standard: trigraphs, then lines that go on, then comments."""
    whole = code.replace("??/", "\\").replace("\\\n", "")
    return re.sub(r"/\*.*?\*/", " ", whole, flags=re.DOTALL)


@pytest.mark.parametrize("target", ["c", "cpp"])
def test_comments_never_become_code(
    target: str, calibrations: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    plain = strip_comments(export(tmp_path, target, calibrations[target], ["flight.csv"]))
    words = hostile_words(COUNT, seed=1)
    for first in range(0, COUNT, AT_ONCE):
        text = export(tmp_path, target, calibrations[target], words[first : first + AT_ONCE])
        assert strip_comments(text) == plain
        if first % 400 == 0:
            (tmp_path / "header.h").write_text(text)
            for standard in headers.STANDARDS[target]:
                headers.build(tmp_path / "header.h", target, standard)


@pytest.mark.parametrize(("target", "parse"), [
    ("ardupilot", lambda line: line.split(",")), ("px4", lambda line: line.split("\t")),
])  # fmt: skip
def test_comments_never_become_parameters(
    target: str, parse: Any, calibrations: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    def parameters(text: str) -> list[list[str]]:
        lines = re.split(r"[\n\r\x0b\x0c\x85\u2028\u2029]", text)
        return [parse(line) for line in lines if line and not line.startswith("#")]

    plain = parameters(export(tmp_path, target, calibrations[target], ["flight.csv"]))
    words = hostile_words(COUNT, seed=2)
    for first in range(0, COUNT, AT_ONCE):
        text = export(tmp_path, target, calibrations[target], words[first : first + AT_ONCE])
        assert parameters(text) == plain


def test_another_reader_finds_the_same_parameters(
    calibrations: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    reader = pytest.importorskip("pymavlink.mavparm")
    found = []
    for words in (["flight.csv"], hostile_words(40, seed=3)):
        export(tmp_path, "ardupilot", calibrations["ardupilot"], words)
        parameters = reader.MAVParmDict()
        parameters.load(str(tmp_path / "out"))
        found.append({name: parameters[name] for name in list(parameters)})
    assert found[0] == found[1]
    assert found[0]


DRIVERS = [
    "*/system(cmd);/*", "NAN", "INFINITY", "HUGE_VAL", "M_PI", "FP_NAN", "isnan", "isfinite",
    "linux", "typeof", "co_await", "main", "at", "k", "a\\", 'x"y', "it's", "<b>", "ünïcode",
    "%d", "##", "//", "1x", "_",
]  # fmt: skip


def test_a_column_of_any_name_is_an_argument(flown: sepcal.SimulatedFlight, tmp_path: Path) -> None:
    """Its header compiles strictly as C and C++, and its self-test holds."""
    noise = np.random.default_rng(1)
    columns = {header: flown[header] for header in flown}
    columns |= {name: np.cumsum(noise.normal(size=flown.rows)) * 0.05 for name in DRIVERS}
    flight = sepcal.Flight(columns)
    effects = [f"bias[{name}]" for name in DRIVERS]
    for few in (effects[:8], effects[8:16], effects[16:]):
        base = sepcal.fit(sepcal.Magnetometer(field=(19.7, -1.4, 49.4)), flight, effects=few)
        for target, standards in headers.STANDARDS.items():
            sepcal.export(base, tmp_path / "header.h", target, force=True)
            for standard in standards:
                program = headers.build(tmp_path / "header.h", target, standard)
                assert subprocess.run([program], input="", text=True, check=False).returncode == 0


class Elements(HTMLParser):
    """Every element of a page with the names of its attributes, and where links lead."""

    def __init__(self) -> None:
        super().__init__()
        self.found: set[tuple[str, tuple[str, ...]]] = set()
        self.scripts = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keeps them."""
        self.found.add((tag, tuple(name for name, _ in attrs)))
        self.scripts += tag == "script"


def elements_of(page: str) -> Elements:
    elements = Elements()
    elements.feed(page)
    return elements


def write_report(
    flown: sepcal.SimulatedFlight, words: Iterator[str], folder: Path, *, hostile: bool
) -> str:
    """Of a flight with a name, labels, channels and a message of these words."""

    def name(plain: str) -> str:
        return plain + next(words) if hostile else plain

    noise = np.random.default_rng(2)
    columns = {header: flown[header] for header in flown}
    columns |= {name(f"c{i}"): np.cumsum(noise.normal(size=flown.rows)) for i in range(6)}
    labels = [name(f"leg {i}") for i in range(4)]
    maneuvers = [labels[4 * row // flown.rows] for row in range(flown.rows)]
    flight = sepcal.Flight(columns, maneuver=maneuvers, name=name("flight"))
    base = sepcal.fit(sepcal.Magnetometer(field=(19.7, -1.4, 49.4)), flight)
    sepcal.report(base, folder / "report.html", flight)
    return (folder / "report.html").read_text()


def test_no_name_becomes_markup(flown: sepcal.SimulatedFlight, tmp_path: Path) -> None:
    pytest.importorskip("plotly")
    known = elements_of(write_report(flown, iter([]), tmp_path, hostile=False))
    for seed in range(3):
        words = iter([word.replace(",", ".") for word in hostile_words(40, seed=10 + seed)])
        shown = elements_of(write_report(flown, words, tmp_path, hostile=True))
        assert shown.found <= known.found
        assert shown.scripts == known.scripts


def test_no_name_forges_a_line(flown: sepcal.SimulatedFlight, tmp_path: Path) -> None:
    """As many lines on every page, none of which steers a terminal."""

    def pages(label: str, column: str) -> list[str]:
        columns = {header: flown[header] for header in flown}
        columns[column] = np.cumsum(np.random.default_rng(4).normal(size=flown.rows))
        maneuvers = [label if row < 250 else "rest" for row in range(flown.rows)]
        flight = sepcal.Flight(columns, maneuver=maneuvers, name=label)
        model = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
        base = sepcal.fit(model, flight)
        results = (base, base.compare(), base.diagnose(), sepcal.check(model, flight))
        return [str(result) for result in results]

    known = pages("leg", "c1")
    assert not any("\\n" in page for page in known)  # nothing of sepcal's own is escaped
    plain = [page.count("\n") for page in known]
    for word in hostile_words(12, seed=20):
        found = pages(word, "c1" + word.replace("\n", " "))
        assert_printable(*found)
        assert [page.count("\n") for page in found] == plain


def case(name: str) -> Path:
    if not CASES.is_dir():
        pytest.skip("the folder of recorded cases is not on this machine")
    return CASES / name


def test_recorded_cases(tmp_path: Path) -> None:
    headers.compiler_of("c")
    for name in ("c_linesplice", "message_escape"):
        done = run(
            "sepcal-mag", "export", case(f"{name}.json"), "--to", "c", "-o", "h.h", folder=tmp_path
        )
        assert done.code == 0, done.err
        assert_printable(done.out, done.err)
        assert "evil" not in strip_comments((tmp_path / "h.h").read_text())
    done = run(
        "sepcal-mag",
        "export",
        case("param_newline.json"),
        "--to",
        "ardupilot",
        "-o",
        "p",
        folder=tmp_path,
    )
    assert done.code == 0, done.err
    lines = (tmp_path / "p").read_text().splitlines()
    assert not any(line.startswith("ARMING_CHECK") for line in lines)
    done = run(
        "sepcal-mag", "export", case("xss_sha256.json"), "--to", "c", "-o", "x.h", folder=tmp_path
    )
    assert done.code == 2
    assert "sha256" in done.err


@pytest.mark.parametrize(("key", "value", "said"), [
    ("sha256", "x" * 64, "64 digits of a sha256"), ("sha256", "ab", "64 digits of a sha256"),
    ("threads", 10**9, "threads"), ("threads", -1, "threads"),
    ("name\x1b[2J", 1, "can't be printed"), ("model", "magnet\nometer", "can't be printed"),
])  # fmt: skip
def test_what_a_file_says_of_itself_is_checked(
    key: str, value: object, said: str, calibrations: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    calibration = json.loads(json.dumps(calibrations["c"]))
    place = {"sha256": "inputs", "threads": "options"}.get(key)
    (calibration[place] if place else calibration)[key] = value
    (tmp_path / "base.json").write_text(json.dumps(calibration))
    refused = run("sepcal-mag", "export", "base.json", "--to", "c", "-o", "h.h", folder=tmp_path)
    assert refused.code == 2
    assert refused.err.count("\n") == 1
    assert said in refused.err
    assert_printable(refused.err)
    with pytest.raises(sepcal.Error, match=re.escape(said)):
        sepcal.load(tmp_path / "base.json")


@pytest.mark.parametrize(("open_", "close"), [("[", "]"), ('{"a":', "}")])
def test_nesting_ends_at_64(
    open_: str, close: str, calibrations: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    for depth, is_read in ((100_000, False), (70, False), (10, True)):
        deep = open_ * depth + "1" + close * depth
        text = json.dumps(calibrations["c"])[:-1] + f', "more": {deep}}}'
        (tmp_path / "base.json").write_text(text)
        done = run("sepcal-mag", "export", "base.json", "--to", "c", "-o", "h.h", folder=tmp_path)
        assert (done.code == 0) is is_read, done.err
        if not is_read:
            assert "nested more than 64 deep" in done.err
            with pytest.raises(sepcal.Error, match="nested more than 64 deep"):
                sepcal.load(tmp_path / "base.json")


def test_a_closed_standard_error_takes_no_file(
    calibrations: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    """The output would have its number, and notes would go into it."""
    export(tmp_path, "ardupilot", calibrations["ardupilot"], ["flight.csv"])
    expected = (tmp_path / "out").read_text()
    command = [
        APPS / "sepcal-mag",
        "export",
        "base.json",
        "--to",
        "ardupilot",
        "-o",
        "again",
        "--force",
    ]
    shell = " ".join(map(str, command))
    for closed in ("2>&-", "1>&- 2>&-", "0<&- 1>&- 2>&-"):
        (tmp_path / "again").unlink(missing_ok=True)
        subprocess.run(["sh", "-c", f"{shell} {closed}"], cwd=tmp_path, check=False, env=os.environ)
        assert (tmp_path / "again").read_text() == expected
    refused = subprocess.run(
        ["sh", "-c", f"{APPS / 'sepcal-mag'} fit nothing.csv 2>&-"], cwd=tmp_path, check=False
    )
    assert refused.returncode == 2


@pytest.mark.parametrize("header", [3, None, b"x", ("a",)])
def test_a_column_s_name_must_be_a_text(flown: sepcal.SimulatedFlight, header: Any) -> None:
    columns: dict[Any, Any] = {name: flown[name] for name in flown}
    with pytest.raises(sepcal.Error, match="its name must be a text"):
        sepcal.Flight({**columns, header: np.zeros(flown.rows)})


def test_a_file_whose_name_is_no_utf_8(tmp_path: Path) -> None:
    """One line, whichever way it is given."""
    named = os.fsencode(tmp_path) + b"/caf\xe9.csv"
    for file in (named, os.fsdecode(named), Path(os.fsdecode(named))):
        for call in (sepcal.read_csv, sepcal.load):
            with pytest.raises(sepcal.Error, match=r"caf\\xe9.csv: the file's name is no UTF-8"):
                call(file)
