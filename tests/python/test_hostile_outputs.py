# SPDX-License-Identifier: BSD-3-Clause
"""Hostile names, messages and file names through every writer.

What comes out is held against what plain names give: code, parameters, elements and lines are the
same, whatever a comment, a cell or a sentence says.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import headers
import sepcal
from apps import APPS, Bench, run
from browser import find_browser, show
from hostile import STRAY, find_unprintable, hostile_words, may_not_be_printed
from sepcal.markup import as_html, html, in_figure
from sepcal.printing import in_line, in_shell

COUNT = 2000
AT_ONCE = 40  # of them in one export
CASES = Path(__file__).resolve().parents[2].parent / "shared" / "cases" / "outputs"


def without_controls(word: str) -> str:
    """What is left of a name that is printed, wherever the rest of it went."""
    return "".join(c for c in word if not may_not_be_printed(c))


def test_a_line_of_a_terminal() -> None:
    for word in [*hostile_words(COUNT, 1), *STRAY, "\U0001f680\ud83d"]:
        line = in_line(word)
        assert_printable(line)
        assert "\n" not in line
        assert in_line(line) == line
        letters = iter(line)
        assert all(c in letters for c in without_controls(word))  # in their order
    assert in_line("\udce9") == "\\xe9"  # a byte of a file's name


def test_a_word_of_a_shell(tmp_path: Path) -> None:
    """Bash reads 2,000 commands; what each prints is the word again, and nothing else was run."""
    if shutil.which("bash") is None:
        pytest.skip("no bash on this machine")
    words = [word.replace("\0", "") for word in hostile_words(COUNT, 2)]  # no word has a NUL
    script = "\n".join(f"printf '%s\\0' {in_shell([word])}" for word in words)
    assert_printable(script)
    done = subprocess.run(
        ["bash"], input=script.encode(), capture_output=True, check=False, cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout.decode().split("\0")[:-1] == words
    assert [*tmp_path.iterdir()] == []


class Texts(HTMLParser):
    """The text of each element, the value of each attribute, and what else there is."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.values: list[str | None] = []
        self.tags: set[str] = set()
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Begins a text."""
        self.tags.add(tag)
        assert [name for name, _ in attrs] == ["title"]
        self.values += [value for _, value in attrs]
        self.texts.append("")

    def handle_data(self, data: str) -> None:
        """Goes on."""
        self.texts[-1] += data


def test_text_and_attributes_of_html() -> None:
    """A parser gives the names back as they are printed."""
    words = hostile_words(COUNT, 3)
    page = "".join(html('<p title="{}">{}</p>', word, word) for word in words)
    assert_printable(page)
    told = ["\n".join(map(in_line, word.split("\n"))) for word in words]
    found = Texts(page)
    assert found.tags == {"p"}
    assert found.texts == told
    assert found.values == told
    single = "".join(html("<p title='{}'>{}</p>", word, word) for word in words)
    assert Texts(single).values == told
    for word in words:
        assert not re.search(r"[<>\"'\n]", in_figure(word))
        assert as_html(as_html(word)) == as_html(word)


def test_labels_of_a_page_and_of_json(flown: sepcal.SimulatedFlight) -> None:
    """2,000 labels of one flight: a line each of the page, and JSON gives them back."""
    words = [f"{word}{at}" for at, word in enumerate(hostile_words(COUNT, 4))]
    model = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
    base = sepcal.fit(model, flown)
    longer = sepcal.simulate(sepcal.Magnetometer(), rows=2 * COUNT, seed=4)
    labels = [words[row // 2] for row in range(2 * COUNT)]
    flight = sepcal.Flight({header: longer[header] for header in longer}, maneuver=labels)
    compared = base.compare(flight)
    page = str(compared)
    assert_printable(page)
    lines = page.splitlines()
    segments = [misfit.segment for misfit in compared.where]
    assert [*dict.fromkeys(segments)] == words
    shown = [line for line in lines if line.startswith(in_line(words[5]))]
    assert len(shown) == segments.count(words[5])
    assert page.count("\n") + 1 == len(lines) < len(segments) + 60
    told = json.loads(compared.to_json())
    assert [misfit["segment"] for misfit in told["where"]] == segments


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
        assert find_unprintable(page) == []


def strip_comments(code: str) -> str:
    """By the C standard: trigraphs, then lines that go on, then comments."""
    whole = code.replace("??/", "\\").replace("\\\n", "")
    whole = re.sub(r'(calibration_id\[65\] = )"[0-9a-f]{64}"', r"\1", whole)  # of the comments too
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
        if first % 400 == 0:  # the others are the same but for comments
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
        lines = re.split(r"[\n\r\x0b\x0c\x1c-\x1e\x85\u2028\u2029]", text)
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
        page = write_report(flown, words, tmp_path, hostile=True)
        assert_printable(page)
        shown = elements_of(page)
        assert shown.found <= known.found
        assert shown.scripts == known.scripts


def test_no_script_of_a_name_runs(flown: sepcal.SimulatedFlight, tmp_path: Path) -> None:
    """In a browser: each of them would set the page's title."""
    pytest.importorskip("plotly")
    find_browser()
    run = "document.title='OWNED'"
    scripts = [
        f"<script>{run}</script>", f"</script><script>{run}</script>", f"<svg/onload={run}>",
        f"</title><script>{run}</script>", f"<img src=x onerror={run}>",
        f'" onmouseover="{run}" autofocus="', f"<a href='javascript:{run}'>x</a>",
        f"<iframe srcdoc='<script>parent.{run}</script>'>", f"--><script>{run}</script>",
        f"]]><script>{run}</script>", f"<details open ontoggle={run}>",
    ]  # fmt: skip
    for first in range(0, len(scripts), 4):
        words = iter([*scripts[first:], *scripts] * 2)
        write_report(flown, words, tmp_path, hostile=True)
        document, root, complaints = show(tmp_path / "report.html", tmp_path / "profile")
        title = re.search(r"<title>(.*?)</title>", document, re.DOTALL)
        assert title
        assert not title[1].startswith("OWNED")
        assert "data-problems" not in root
        assert complaints == []


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


@pytest.mark.parametrize("word", [*STRAY, "a\udce9b"])
def test_a_name_that_no_utf_8_is_of(flown: sepcal.SimulatedFlight, word: str) -> None:
    """Python's texts hold halves of pairs and stray bytes of files' names."""
    columns = {name: flown[name] for name in flown}
    labels = [word] * flown.rows
    for call in (
        lambda: sepcal.Flight(columns, name=word),
        lambda: sepcal.Flight({**columns, word: np.zeros(flown.rows)}),
        lambda: sepcal.Flight(columns, maneuver=labels),
        lambda: sepcal.Flight({**columns, "maneuver": labels}),
    ):
        with pytest.raises(sepcal.Error, match="is no UTF-8; call it otherwise") as refused:
            call()
        assert_printable(str(refused.value))


def test_what_python_refuses_is_one_printable_line(flown: sepcal.SimulatedFlight) -> None:
    """Also where the message quotes a name that is not."""
    assert str(sepcal.Error("a\nb\x1b[2J\ud800")) == r"a\nb\x1b[2J\xed\xa0\x80"
    columns = {name: flown[name] for name in flown}
    with pytest.raises(sepcal.Error) as refused:
        sepcal.Flight({**columns, "c\n": np.zeros((2, 2))}, name="a\nb\u202e")
    assert str(refused.value).startswith(r"a\nb\xe2\x80\xae: column 'c\n' has the shape")


def test_what_repr_says_is_one_printable_line(flown: sepcal.SimulatedFlight) -> None:
    columns = {name: flown[name] for name in flown}
    columns["c\n\x1b[2J"] = np.cumsum(np.random.default_rng(3).normal(size=flown.rows))
    flight = sepcal.Flight(columns, name="f\u202e")
    model = sepcal.Magnetometer(field=(19.7, -1.4, 49.4))
    base = sepcal.fit(model, flight, effects=["bias[c\n\x1b[2J]"])
    for result in (flight, base, base.compare(), sepcal.check(model, flight)):
        assert "\n" not in repr(result)
        assert_printable(repr(result))


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


def test_what_follows_a_nul_is_not_left_unread(
    calibrations: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    text = json.dumps(calibrations["c"])
    (tmp_path / "base.json").write_text(text + '\0{"garbage": 1}')
    refused = run("sepcal-mag", "export", "base.json", "--to", "c", "-o", "h.h", folder=tmp_path)
    assert refused.code == 2
    assert f"base.json: byte {len(text)} is NUL" in refused.err


@pytest.mark.parametrize("mark", ["\u200f", "\u061c", "\u202a", "\u2028", "\x85"])
def test_a_label_with_marks_of_direction_is_read_again(mark: str, magnetometer: Bench) -> None:
    """As a right-to-left script has them: no verb writes what another refuses."""
    log = (magnetometer.folder / "flight.csv").read_text().splitlines()
    at = log[0].split(",").index("maneuver")
    rows = [line.split(",") for line in log[1:]]
    for row in rows:
        row[at] += mark
    marked = "\n".join([log[0], *(",".join(row) for row in rows)]) + "\n"
    (magnetometer.folder / "marked.csv").write_text(marked, encoding="utf-8", newline="\n")
    fitted = magnetometer.run("fit", "marked.csv", "--effect", "bias[maneuver]", "-o", "m.json")
    assert fitted.code in (0, 5), fitted.err
    applied = magnetometer.run("apply", "marked.csv", "m.json", "-o", "out.csv")
    assert applied.code == 0, applied.err
    assert_printable(fitted.out + fitted.err + applied.out + applied.err)


def test_add_does_not_write_over_what_it_reads(bench: Bench) -> None:
    effect = {"sepcal-pitot": "wind[time]", "sepcal-mag": "bias[current_a]"}[bench.app]
    before = (bench.folder / "base.json").read_bytes()
    refused = bench.run("add", "flight.csv", "base.json", effect, "-o", "base.json")
    assert refused.code == 2
    assert "it is an input" in refused.err
    assert (bench.folder / "base.json").read_bytes() == before
