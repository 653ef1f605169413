# SPDX-License-Identifier: BSD-3-Clause
"""print() of a result is the app's text to the byte; repr, HTML and data frames beside it."""

import inspect
import re
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import sepcal
from apps import Bench, run

EFFECT = {"sepcal-pitot": "wind[altitude_m]", "sepcal-mag": "bias[current_a]"}


def printed(bench: Bench, *arguments: str) -> str:
    """Standard output of a verb that did its work, whatever it found."""
    outcome = bench.run(*arguments)
    assert outcome.code in (0, 3, 4, 5, 6), outcome.err
    return outcome.out


@pytest.fixture
def inside(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> Bench:
    """Python in the app's folder, where files have the same names."""
    monkeypatch.chdir(bench.folder)
    return bench


def assert_same(bench: Bench, page: object, *arguments: str) -> None:
    """print() of the result, and `explained`, against the app."""
    assert f"{page}\n" == printed(bench, *arguments)
    assert f"{page.explained}\n" == printed(bench, *arguments, "--explain")  # type: ignore[attr-defined]


# --- every verb


def test_a_fit(inside: Bench):
    flight = sepcal.read_csv("flight.csv")
    is_pitot = inside.app == "sepcal-pitot"
    probe = (
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0, -0.02))
        if is_pitot
        else sepcal.Magnetometer()
    )
    fitted = sepcal.fit(probe, flight)
    assert fitted.success
    assert_same(inside, fitted, "fit", "flight.csv", *inside.options)
    assert str(sepcal.load("base.json")) == str(fitted)


def test_a_poor_fit(magnetometer: Bench, monkeypatch: pytest.MonkeyPatch):
    """With sentences, of which a brief page hides some, and parameters at bounds."""
    monkeypatch.chdir(magnetometer.folder)
    poor = ("simulate", "-o", "poor.csv", "--rows", "20", "--excitation", "poor")
    assert magnetometer.run(*poor).code == 0
    fitted = sepcal.fit(sepcal.Magnetometer(), sepcal.read_csv("poor.csv"), fix={"eta_x": 0.0})
    assert_same(magnetometer, fitted, "fit", "poor.csv", "--fix", "eta_x=0")


def test_a_tube(pitot: Bench, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(pitot.folder)
    simulated = ("simulate", "--probe", "pitot-static", "-o", "tube.csv", "--rows", "300")
    assert pitot.run(*simulated).code == 0
    fitted = sepcal.fit(
        sepcal.PitotStatic(), sepcal.read_csv("tube.csv"), prior={"w_n": (1.0, 5.0)}
    )
    assert_same(pitot, fitted, "fit", "tube.csv", "--prior", "w_n=1:5")


def test_a_field_of_known_strength(magnetometer: Bench, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(magnetometer.folder)
    fitted = sepcal.fit(sepcal.Magnetometer(field_strength=53.2), sepcal.read_csv("flight.csv"))
    assert_same(magnetometer, fitted, "fit", "flight.csv", "--field-strength", "53.2")


def test_later_verbs(inside: Bench):
    base, flight = sepcal.load("base.json"), sepcal.read_csv("flight.csv")
    files = ("flight.csv", "base.json")
    assert_same(inside, base.compare(flight), "compare", *files)
    assert_same(inside, base.diagnose(flight), "diagnose", *files)
    name = next(iter(base.parameters))
    intervals = base.intervals(flight, names=[name])
    assert_same(inside, intervals, "intervals", *files, "--parameter", name)
    effect = EFFECT[inside.app]
    assert_same(inside, base.add(effect, flight), "add", *files, effect)


def test_the_way_on(pitot: Bench, monkeypatch: pytest.MonkeyPatch):
    """What is missing is added to the calibration's file, or to one to be named."""
    monkeypatch.chdir(pitot.folder)
    hidden = ("simulate", "-o", "sheared.csv", "--rows", "400", "--hide", "wind[altitude_m]=0.3")
    assert pitot.run(*hidden).code == 0
    assert pitot.run("fit", "sheared.csv", *pitot.options, "-o", "s.json").code == 0
    loaded, flight = sepcal.load("s.json"), sepcal.read_csv("sheared.csv")
    found = loaded.diagnose(flight)
    assert_same(pitot, found, "diagnose", "sheared.csv", "s.json")
    best = found.effects[0].name
    assert f"next: sepcal-pitot add sheared.csv s.json '{best}' -o NEXT.json" in str(found)
    fitted = sepcal.fit(
        sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0, -0.02)), flight
    )
    assert f"add sheared.csv BASE.json '{best}'" in str(fitted.diagnose())


# --- a status in sentences


def test_the_worst_first_and_the_rest_behind_explain(tmp_path: Path):
    """A vehicle that hardly turns: more directions are poor than a page begins with."""
    poor = ("simulate", "-o", "poor.csv", "--rows", "20", "--excitation", "poor")
    assert run("sepcal-mag", *poor, folder=tmp_path).code == 0
    fitted = run("sepcal-mag", "fit", "poor.csv", "-o", "base.json", folder=tmp_path)
    message = sepcal.load(tmp_path / "base.json").message
    head = fitted.out.split("\n\n")[0].splitlines()[2:]
    assert 1 < len(head) <= 4
    assert head[-1] == "  ... more with --explain"
    for line in head[:-1]:
        assert line.startswith("  ")
        assert line.strip() in message
    explained = (
        run("sepcal-mag", "fit", "poor.csv", "--explain", folder=tmp_path)
        .out.split("\n\n")[0]
        .splitlines()[2:]
    )
    assert sorted(line.strip() for line in explained) == sorted(message.split("; "))
    worst = [line for line in explained if "can't be" in line]
    assert explained[: len(worst)] == worst


# --- beside print()


@pytest.fixture(scope="module")
def base() -> sepcal.Calibration:
    """A calibration of 300 simulated rows."""
    probe = sepcal.Magnetometer()
    return sepcal.fit(probe, sepcal.simulate(probe, rows=300), samples=50)


def test_one_line(base: sepcal.Calibration):
    total = sum(error**2 for error in base.rmse.values()) ** 0.5 / 3**0.5
    assert repr(base) == (
        f"<sepcal.Calibration magnetometer: converged, rmse {total:.3g} uT, 12 parameters>"
    )
    assert repr(base.fit) == "<sepcal.Fit converged, 12 parameters, 300 rows>"
    assert repr(base.compare()) == (
        f"<sepcal.Comparison magnetometer on simulated flight: rmse {total:.3g} uT>"
    )
    assert repr(base.intervals(names=["n_x"])) == "<sepcal.Intervals of 95 %: 1 parameters>"
    assert "\n" not in repr(base.diagnose())


def test_a_small_table_in_a_notebook(base: sepcal.Calibration):
    html = base._repr_html_()
    assert html.count("<tr>") == 1 + len(base.parameters)
    n_x = base["n_x"]
    cells = ("n_x", f"{n_x.value:.6g}", f"{n_x.standard_error:.6g}", "uT")
    assert f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>" in html
    compared = base.compare()
    assert compared._repr_html_().count("<tr>") == 1 + len(compared.where) + 3


class Frame:
    """As much of a pandas.DataFrame as to_frame() asks for: rows by column, an index."""

    def __init__(self, rows: list[dict[str, object]]) -> None:
        self.columns = list(rows[0])
        self.rows = rows
        self.index: list[object] = []

    def set_index(self, name: str) -> "Frame":
        """The frame with a column as its index."""
        self.index = [row[name] for row in self.rows]
        return self


@pytest.fixture
def frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames in pandas' place, which need not be installed."""
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=Frame))


def test_a_data_frame(frames: None, base: sepcal.Calibration):
    frame = base.to_frame()
    assert frame.index == list(base.names)
    row = frame.rows[base.names.index("n_x")]
    assert row["standard_error"] == base["n_x"].standard_error
    compared = base.compare().to_frame()
    assert [row["segment"] for row in compared.rows[-3:]] == ["all"] * 3
    diagnosed = base.diagnose()
    assert diagnosed.to_frame().index == [effect.name for effect in diagnosed.effects]
    intervals = base.intervals(names=["n_x"])
    (row,) = intervals.to_frame().rows
    assert (row["profile_lower"], row["profile_upper"]) == intervals["n_x"].profile


def test_pandas_takes_the_rows(base: sepcal.Calibration):
    pytest.importorskip("pandas")
    frame = base.to_frame()
    assert list(frame.index) == list(base.names)
    assert frame.loc["n_x", "value"] == base["n_x"].value


def test_without_pandas(base: sepcal.Calibration, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"^to_frame\(\) needs pandas: pip install pandas$"):
        base.to_frame()


# --- the options of a fit


def test_every_option_stands_in_the_signature_with_its_default():
    """Against what options.hpp and choices.hpp say."""
    options = inspect.signature(sepcal.fit).parameters
    assert list(options)[2:] == list(sepcal.FitOptions.__annotations__)
    expected = {
        "samples": 500,
        "sampling": "uniform",
        "search": "sampling",
        "second_stage": "auto",
        "jacobian": "kaufman",
        "method": "output-error",
        "hessian": "fisher",
        "loss": "squares",
        "seed": 0,
        "descents": 8,
        "noise_tolerance": 1e-10,
        "noise_iterations": 100,
        "iterations": 200,
        "coloured_errors": True,
        "threads": 0,
        "drop_invalid": False,
        "loss_width": 0.0,
        "smooth_inputs": False,
    }
    for name in sepcal.FitOptions.__annotations__:
        assert options[name].kind is inspect.Parameter.KEYWORD_ONLY
        assert options[name].default == expected.get(name), name


def test_help_says_what_each_option_is():
    text = inspect.getdoc(sepcal.fit) or ""
    for name in sepcal.FitOptions.__annotations__:
        assert f"\n    {name}: " in text
    assert "FitOptions." not in text
    assert "\nReturns:" in text


def test_the_defaults_that_help_says_are_the_engines():
    entries = (inspect.getdoc(sepcal.FitOptions) or "").partition("Attributes:\n")[2]
    entries = entries.partition("\nExample:")[0]
    said = {
        name: re.findall(r"\[([^\]]*)\]", text)
        for name, text in re.findall(r"^    (\w+): (.*?)(?=^    \w|\Z)", entries, re.M | re.S)
    }
    assert set(said) == set(sepcal.FitOptions.__annotations__)
    engine = sepcal._core.Options()
    for name in said:
        default = getattr(engine, name, None)
        if isinstance(default, str) and default:
            assert said[name][-1] == f'"{default}"', name
        elif isinstance(default, int | float) and name != "loss_width":  # 0: the loss's own
            assert said[name][-1].split(";")[0] == str(default), name


def test_many_flights_take_the_options_they_can():
    options = inspect.signature(sepcal.fit_many).parameters
    assert options["samples"].default == 500
    assert "effects" not in options
