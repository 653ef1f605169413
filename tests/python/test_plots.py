# SPDX-License-Identifier: BSD-3-Clause
"""plot() of every result: what is drawn, by both libraries, in both themes, and how it refuses."""

from __future__ import annotations

import json
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sepcal
from cases import but_first_slow
from sepcal.reporting.colours import DARK

pytest.importorskip("plotly", reason="plots need plotly: pip install sepcal[report]")
pytest.importorskip("matplotlib", reason="plots need matplotlib: pip install sepcal[plot]")

PATH_NOISE = {"ax": 0.05, "ay": 0.05, "az": 0.05, "p": 0.001, "q": 0.001, "r": 0.001}
GROUND = "#15191d"  # of a dark figure


def make(kind: str) -> list[tuple[object, tuple[str, ...]]]:
    """Results with the pictures that they have."""
    if kind == "sensors":
        flight = sepcal.simulate("pitot-static", hide={"wind[altitude_m]": (0.05, 0.02)}, rows=600)
        base = sepcal.fit(sepcal.PitotStatic(), flight)
        better = base.add("wind[altitude_m]")
        field = sepcal.simulate("magnetometer", rows=400)
        norm = sepcal.fit(sepcal.Magnetometer(field_strength=53.37), field)
        return [
            (better, ("fit", "channels", "noise", "coverage", "steps", "correlation")),
            (norm, ("fit", "coverage")),
            (sepcal.fit(sepcal.Magnetometer(), field), ("coverage",)),
            (base.compare(), ("where", "residuals")),
            (base.diagnose(simulations=2), ("candidates", "where")),
            (base.diagnose(simulations=2, auto=True), ()),
            (base.intervals(), ()),
            (base.predict(), ()),
            (sepcal.check(sepcal.PitotStatic(), flight), ()),
            (flight, ()),
        ]
    if kind == "aircraft":
        flight = sepcal.simulate("aircraft", rows=400)
        path = sepcal.fit(sepcal.FlightPath(), flight)
        return [
            (path, ("fit", "channels", "correlation")),
            (path.smooth(PATH_NOISE), ("states", "innovations", "process noise")),
            (path.track(start_rows=200), ("estimates", "innovations")),
            (
                sepcal.frequency_response(flight, "elevator_rad", "q_radps", window=2, band=(1, 3)),
                (),
            ),
            (sepcal.multisines({"elevator_rad": 0.05, "rudder_rad": 0.1}, duration=10), ()),
        ]
    trial = sepcal.SimulatedTrial(sepcal.PitotStatic(), simulation={"rows": 100})
    study = sepcal.monte_carlo(trial, 12, progress=False)
    flights = {f"day {i}": sepcal.simulate("pitot-static", rows=200, seed=i) for i in range(3)}
    many = sepcal.fit_many(sepcal.PitotStatic(), flights, own=["w_n"])
    filtered = sepcal.Filter([0.0], [[1.0]], keep_pass=True)
    for y in (0.1, 0.3, 0.2):
        filtered.update([y], H=[[1.0]], R=[[0.1]])
        filtered.predict(Phi=[[1.0]], Q=[[0.01]])
    design = {"v": np.linspace(10.0, 20.0, 40)}
    fits = sepcal.fit_trials(Line(), design, {"z": np.array([design["v"] * k for k in (1.0, 2.0)])})
    return [
        (study, ("errors", "estimates")),
        (many, ("departures", "own")),
        (filtered.smooth(), ()),
        (fits, ()),
    ]


class Line:
    """z = k v."""

    inputs = {"v": "m/s"}  # noqa: RUF012
    outputs = {"z": "m/s"}  # noqa: RUF012
    linear = {"k": "1"}  # noqa: RUF012
    nonlinear: dict[str, tuple[str, float, float]] = {}  # noqa: RUF012

    def at(self, u, xi2):  # noqa: D102
        return u.v[:, None, None], np.zeros((len(u.v), 1))


@pytest.mark.parametrize("kind", but_first_slow(["studies", "sensors", "aircraft"]))
def test_every_result_is_drawn_by_both_libraries_in_both_themes(kind: str) -> None:
    import matplotlib.figure
    import plotly.graph_objects

    for result, pictures in make(kind):
        for what in pictures or (None,):
            words = () if what is None else (what,)
            light = result.plot(*words)  # type: ignore[attr-defined]
            assert isinstance(light, plotly.graph_objects.Figure)
            dark = result.plot(*words, theme="dark")  # type: ignore[attr-defined]
            text = dark.to_json()
            assert not re.search(r"https?://", text)
            # Every colour of the light figure is one that the dark theme knows, and is exchanged.
            spelled = set(re.findall(r'"(#[0-9a-f]{3,6}|rgba\([^"]*\))"', light.to_json()))
            assert spelled <= set(DARK), (kind, what, spelled - set(DARK))
            assert json.loads(text)["layout"]["paper_bgcolor"] == GROUND
            for theme in ("light", "dark"):
                drawn = result.plot(*words, backend="matplotlib", theme=theme)  # type: ignore[attr-defined]
                assert isinstance(drawn, matplotlib.figure.Figure)
                assert drawn._repr_png_().startswith(b"\x89PNG")
                assert inked(drawn) > 0.002, (kind, what)


def inked(drawn: object) -> float:
    """Share of the pixels that are not ground."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(drawn)  # type: ignore[arg-type]
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].astype(int)
    return float(np.mean(np.abs(pixels - pixels[0, 0]).sum(axis=-1) > 60))


def test_both_libraries_draw_the_same_numbers() -> None:
    """The residual of each output, and the noise's lines, are the comparison's own."""
    flight = sepcal.simulate("pitot-static", rows=300)
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    expected = base.compare().residuals
    drawn = base.plot()
    curves = [trace for trace in drawn.data if trace.name == "residual"]
    for i, curve in enumerate(curves):
        np.testing.assert_array_equal(np.asarray(curve.y), expected[:, i])
    axes = base.plot(backend="matplotlib").axes
    assert len(axes) == 2 * len(curves)
    for i in range(len(curves)):
        lines = axes[2 * i + 1].lines
        assert any(
            np.array_equal(line.get_ydata(), expected[:, i])
            for line in lines
            if len(line.get_ydata()) == len(expected)
        )
        levels = sorted(line.get_ydata()[0] for line in lines if len(line.get_ydata()) == 2)
        noise = list(base.noise.values())[i]
        assert levels == pytest.approx([-2 * noise, 2 * noise])


def test_dark_figures_can_be_read() -> None:
    """Ink, lines and words stand out from the dark ground as W3C's contrast asks for."""

    def luminance(colour: str) -> float:
        parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        linear = [p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    ground = luminance(GROUND)
    for light in ("#1c2127", "#5c6670"):  # words: 4.5
        assert (luminance(DARK[light]) + 0.05) / (ground + 0.05) > 4.5, light
    for light in ("#9aa3ab", "#2463a8", "#b83a26", "#d98a2b", "#c4622d", "#2c7a4b", "#7b4fa3"):
        assert (luminance(DARK[light]) + 0.05) / (ground + 0.05) > 3.0, light


def test_a_figure_never_loads_or_uploads_anything() -> None:
    """Plotly by itself comes from a server, and one of its buttons sends the figure to one."""
    drawn = sepcal.fit(sepcal.PitotStatic(), sepcal.simulate("pitot-static", rows=200)).plot(
        "noise"
    )
    assert "sendChartToCloud" in drawn.layout.modebar.remove
    page = drawn._repr_html_()
    assert not re.search(r'<script[^>]+src="http', page)
    assert len(page) > 1e6  # Plotly is in it


def test_what_is_asked_wrongly_is_said_in_a_line() -> None:
    flight = sepcal.simulate("pitot-static", rows=200)
    base = sepcal.fit(sepcal.PitotStatic(), flight)
    with pytest.raises(sepcal.Error, match=r"^what is 'fits'; it is 'fit', 'channels', .* or 's"):
        base.plot("fits")
    with pytest.raises(sepcal.Error, match=r"^backend is 'bokeh'; it is 'plotly' or 'matplotlib'$"):
        base.plot(backend="bokeh")
    with pytest.raises(sepcal.Error, match=r"^theme is 'sepia'; it is 'light' or 'dark'$"):
        base.plot(theme="sepia")
    with pytest.raises(sepcal.Error, match="nothing was added yet"):
        base.plot("steps")
    with pytest.raises(sepcal.Error, match="column 'pt_bar' is missing"):
        flight.plot(["pt_bar"])
    path = sepcal.fit(sepcal.FlightPath(), sepcal.simulate("aircraft", rows=200))
    with pytest.raises(sepcal.Error, match="states needs process noise"):
        path.plot("states")
    assert path.plot("states", process_noise=PATH_NOISE).data


def test_a_pickled_result_is_drawn_or_says_why_not() -> None:
    flight = sepcal.simulate("pitot-static", rows=200)
    probe = sepcal.PitotStatic()
    compared = pickle.loads(pickle.dumps(sepcal.fit(probe, flight).compare()))
    assert compared.plot().layout.height > 0
    with pytest.raises(sepcal.Error, match="pickled has no flight; check it again"):
        pickle.loads(pickle.dumps(sepcal.check(probe, flight))).plot()


@pytest.mark.parametrize(("library", "extra"), [("plotly", "report"), ("matplotlib", "plot")])
def test_a_library_that_is_missing_is_named_with_its_extra(
    library: str, extra: str, tmp_path: Path
) -> None:
    script = (
        f"import sys; sys.modules[{library!r}] = None\n"
        "import sepcal\n"
        "flight = sepcal.simulate('pitot-static', rows=100)\n"
        f"try:\n    flight.plot(backend={library!r})\n"
        "except sepcal.Error as error:\n    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert f"pip install sepcal[{extra}]" in done.stdout
    assert len(done.stdout.splitlines()) == 1


def test_names_can_not_break_a_figure() -> None:
    """What a log calls its columns is text in both libraries: no markup, no mathematics."""
    hostile = "<b>$x_{1}$</b>"
    rows = np.arange(50.0)
    flight = sepcal.Flight({"time_s": rows, hostile: rows})
    assert "<b>" not in flight.plot().to_json().replace("\\u003c", "<").replace("<br>", "")
    drawn = flight.plot(backend="matplotlib")
    assert hostile in [
        text.get_text() for text in drawn.findobj(lambda at: hasattr(at, "get_text"))
    ]
    assert drawn._repr_png_()


LONG = "static_pressure_at_the_left_wing_tip_boom_pa"


def named_long() -> sepcal.Calibration:
    """A line whose input, output and slope have names of forty letters and more."""

    class Boom:
        inputs = {LONG: "Pa"}  # noqa: RUF012
        outputs = {"airspeed_of_the_trailing_cone_behind_the_tail": "m/s", "b": "K"}  # noqa: RUF012
        linear = {"sensitivity_of_the_left_static_port_to_sideslip": "m/s/Pa", "c": "K"}  # noqa: RUF012
        nonlinear: dict[str, tuple[str, float, float]] = {}  # noqa: RUF012

        def at(self, u, xi2):
            x = np.asarray(getattr(u, LONG))
            slopes = np.zeros((x.size, 2, 2))
            slopes[:, 0, 0], slopes[:, 1, 1] = x, 1.0
            return slopes, np.zeros((x.size, 2))

    noise = np.random.default_rng(3).normal(size=(3, 200))
    x = 100.0 + 30.0 * noise[0]
    columns = {
        "time_s": np.arange(200.0), LONG: x,
        "airspeed_of_the_trailing_cone_behind_the_tail": 0.3 * x + noise[1], "b": 290.0 + noise[2],
    }  # fmt: skip
    return sepcal.fit(Boom(), sepcal.Flight(columns))  # type: ignore[return-value]


def texts_of(drawn: object) -> list[object]:
    """Matplotlib's words of a figure that was drawn."""
    from matplotlib.text import Text

    inked(drawn)
    return list(drawn.findobj(Text))  # type: ignore[attr-defined]


@pytest.mark.parametrize("what", ["fit", "channels", "noise", "coverage", "correlation"])
def test_long_names_are_neither_cut_off_nor_over_the_data(what: str) -> None:
    drawn = named_long().plot(what, backend="matplotlib")
    assert not any(LONG in at.get_text() for at in texts_of(drawn))  # type: ignore[attr-defined]
    width, height = drawn.get_size_inches()
    for axes in drawn.axes:
        assert axes.get_position().height * height > 0.1, "nothing is left of the picture"
    box = drawn.get_tightbbox()  # [in], of all that is seen
    assert min(box.x0, box.y0) > -0.01
    assert box.x1 < width + 0.01
    assert box.y1 < height + 0.01


def test_axes_say_their_units() -> None:
    """Residuals, predictions and innovations are in the units of their outputs."""

    def titles(drawn: object) -> set[str]:
        layout = drawn.layout.to_plotly_json()  # type: ignore[attr-defined]
        return {at["title"]["text"] for name, at in layout.items() if name.startswith("yaxis")}

    base = sepcal.fit(sepcal.PitotStatic(), sepcal.simulate("pitot-static", rows=200))
    assert titles(base.plot()) == {"airspeed [m/s]", "residual<br>[m/s]"}
    assert titles(base.predict().plot()) == {"airspeed [m/s]"}
    assert titles(base.compare().plot("residuals")) == {"residual [m/s]"}
    assert titles(base.plot("channels")) == {"residual [m/s]"}
    path = sepcal.fit(sepcal.FlightPath(), sepcal.simulate("aircraft", rows=200))
    assert titles(path.track(start_rows=100).plot("innovations")) == {
        "innovation [m/s]", "innovation [rad]",
    }  # fmt: skip
    assert titles(path.smooth(PATH_NOISE).plot("innovations")) >= {"airspeed [m/s]", "alpha [rad]"}
    spectrum = named_long().plot("noise").layout.yaxis2.title.text
    assert "m/s" not in spectrum, "one output is in kelvin"


def test_a_band_says_what_it_is() -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.simulate("pitot-static", rows=200))
    for drawn, words in (
        (base.predict(level=0.9).plot(), "holds 90 % of new measurements"),
        (base.compare().plot("residuals"), "2 RMSE to either side"),
        (pickle.loads(pickle.dumps(base.predict())).plot(), "holds new measurements"),
    ):
        assert [at.name for at in drawn.data if at.showlegend] == [words]
        assert drawn.layout.showlegend


def test_a_candidate_that_fails_badly_leaves_the_others_room() -> None:
    """A gain of -900 % is written as such; its bar ends where the best one does."""
    from sepcal.plotting.drawings import draw_ranking

    gains = np.array([20.0, -900.0])
    figure = draw_ranking(["good", "bad"], np.array([25.0, 15.0]), gains, [True, False])
    low, high = figure.layout["xaxis"]["range"]
    assert -40 < low < -25
    assert 25 < high < 40
    assert figure.data[1]["text"][1] == "−900 %"
    assert "cut" in figure.layout["xaxis"]["title"]["text"]


def test_numbers_left_of_zero_stand_left_of_their_bars() -> None:
    from sepcal.plotting import as_figure
    from sepcal.plotting.drawings import draw_ranking

    figure = draw_ranking(
        ["a", "b"], np.array([25.0, 15.0]), np.array([20.0, -10.0]), [True, False]
    )
    drawn = as_figure([figure], "matplotlib", "light")
    number = next(at for at in texts_of(drawn) if at.get_text() == "−10 %")  # type: ignore[attr-defined]
    end = drawn.axes[0].transData.transform((-10.0, 0.0))[0]
    assert number.get_window_extent().x1 <= end  # type: ignore[attr-defined]


def test_words_on_bars_can_be_read_in_both_themes() -> None:
    """W3C's contrast of 4.5 between a bar's number and the bar."""
    flight = sepcal.simulate("pitot-static", hide={"wind[altitude_m]": (0.05, 0.02)}, rows=400)
    better = sepcal.fit(sepcal.PitotStatic(), flight).add("wind[altitude_m]")

    def luminance(colour: str) -> float:
        full = colour if len(colour) == 7 else "#" + "".join(2 * at for at in colour[1:])
        parts = [int(full[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        linear = [p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    for theme in ("light", "dark"):
        bars = [at for at in better.plot("steps", theme=theme).data if at.type == "bar"]
        assert len(bars) == 2
        for bar in bars:
            tones = sorted((luminance(bar.marker.color), luminance(bar.insidetextfont.color[0])))
            assert (tones[1] + 0.05) / (tones[0] + 0.05) > 4.5, (theme, bar.name)


def test_a_parameter_that_is_held_has_no_histogram() -> None:
    trial = sepcal.SimulatedTrial(sepcal.PitotStatic(), simulation={"rows": 100})
    study = sepcal.monte_carlo(trial, 5, progress=False)
    assert "w_d" in study.names
    text = study.plot("estimates").to_json()
    assert "w_n" in text
    assert "w_d" not in text


def test_no_correlation_is_minus_nothing() -> None:
    from sepcal.plotting.drawings import draw_correlation

    figure = draw_correlation(["a", "b"], np.array([[1.0, -0.001], [-0.001, 1.0]]))
    assert figure.data[0]["text"] == [["1.00", "0.00"], ["0.00", "1.00"]]


def test_a_heat_strip_says_what_its_numbers_are() -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.simulate("pitot-static", rows=200))
    assert base.compare().plot("where").layout.title.text == "RMSE by stretch of the flight [m/s]"
    assert "each output in its own unit" in named_long().compare().plot("where").layout.title.text


def test_a_compass_is_shown_whole() -> None:
    base = sepcal.fit(sepcal.PitotStatic(), sepcal.simulate("pitot-static", rows=200))
    drawn = base.plot("coverage").layout.xaxis
    assert drawn.title.text == "heading [deg]"
    assert drawn.tickvals == (0, 90, 180, 270, 360)
