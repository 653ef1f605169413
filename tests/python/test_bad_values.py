# SPDX-License-Identifier: BSD-3-Clause
"""Only sepcal.Error crosses the front: of a wrong value one line that names the argument."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import sepcal

NOT_NUMBERS = ["x", None, [1.0, 2.0], {"a": 1.0}, object(), 1j]
NOT_WORDS = [3, None, [], {"a": 1}, object(), np.zeros(2)]
NOT_LISTS = [3, "x", object(), np.zeros((2, 2))]
NOT_MAPPINGS = [3, "x", [1.0], object(), {"w_n": "x"}, {"w_n": None}]


class Subject:
    """A flight of each kind, and what came of it; made once."""

    def __init__(self) -> None:
        self.flight = sepcal.datasets.load("pitot")
        self.probe = sepcal.PitotStatic()
        self.base = sepcal.fit(self.probe, self.flight)
        self.field = sepcal.fit(sepcal.Magnetometer(), sepcal.datasets.load("magnetometer"))
        self.path = sepcal.fit(sepcal.FlightPath(), sepcal.datasets.load("aircraft"))


@pytest.fixture(scope="module")
def subject() -> Subject:
    return Subject()


Call = Callable[[Subject, Any], object]
# name of the argument, the call with it, values that it can't be
TABLE: list[tuple[str, Call, list[Any]]] = [
    ("level", lambda s, v: s.base.intervals(level=v), NOT_NUMBERS),
    ("names", lambda s, v: s.base.intervals(names=v), [3, "x", object()]),
    ("level", lambda s, v: s.base.predict(level=v), NOT_NUMBERS),
    ("effect", lambda s, v: s.base.add(v), NOT_WORDS),
    ("only", lambda s, v: s.base.diagnose(only=v), NOT_LISTS),
    ("simulations", lambda s, v: s.base.diagnose(simulations=v), ["x", [], 1j]),
    ("inject", lambda s, v: s.base.diagnose(inject=v), [3, "x", {"wind[altitude_m]": "x"}]),
    ("error_budget", lambda s, v: s.base.diagnose(error_budget=v), [3, "x", {"gyro": "x"}]),
    ("within", lambda s, v: s.base.diagnose(within=v), ["x", [], object()]),
    ("what", lambda s, v: s.base.plot(v), [*NOT_WORDS, "x"]),
    ("theme", lambda s, v: s.base.plot(theme=v), [*NOT_WORDS, "x"]),
    ("file", lambda s, v: s.base.save(v), [None, 3, [], object()]),
    ("file", lambda s, v: sepcal.load(v), [None, 3, True, [], object()]),
    ("file", lambda s, v: sepcal.read_csv(v), [None, 3, True, [], object()]),
    ("bounds", lambda s, v: sepcal.fit(s.probe, s.flight, bounds=v), NOT_MAPPINGS),
    ("start", lambda s, v: sepcal.fit(s.probe, s.flight, start=v), NOT_MAPPINGS),
    ("fix", lambda s, v: sepcal.fit(s.probe, s.flight, fix=v), NOT_MAPPINGS),
    ("noise", lambda s, v: sepcal.fit(s.probe, s.flight, noise=v), NOT_MAPPINGS),
    ("samples", lambda s, v: sepcal.fit(s.probe, s.flight, samples=v), ["x", 1.5, [], object()]),
    ("effects", lambda s, v: sepcal.fit(s.probe, s.flight, effects=v), [3, "x", object(), [3]]),
    ("", lambda s, v: sepcal.fit(v, s.flight), [3, "x", None, object()]),
    ("", lambda s, v: sepcal.fit(sepcal.ShortPeriod(), v), [3, None, [1.0], object()]),
    ("", lambda s, v: sepcal.check(s.probe, v), [3, None, object()]),
    ("rows", lambda s, v: sepcal.simulate("pitot-static", rows=v), ["x", None, [], 1.5]),
    ("hide", lambda s, v: sepcal.simulate("pitot-static", hide=v), [3, "x", {"wind[time]": "x"}]),
    ("parameters", lambda s, v: sepcal.simulate("pitot-static", parameters=v), NOT_MAPPINGS[:4]),
    ("", lambda s, v: sepcal.simulate(v), [None, 3, [], object()]),
    ("k_alpha", lambda s, v: sepcal.FiveHoleProbe(k_alpha=v, k_beta=4.0), ["x", [], object()]),
    ("field_strength", lambda s, v: sepcal.Magnetometer(field_strength=v), ["x", object()]),
    ("process_noise", lambda s, v: s.path.smooth(v), [3, "x", {"ax": "x"}]),
    ("start_rows", lambda s, v: s.path.track(start_rows=v), ["x", None, 1.5]),
    ("to", lambda s, v: s.field.export("a.h", v), [None, 3, [], object()]),
    ("calibrations", lambda s, v: sepcal.report(v, "a.html"), [None, 3, object()]),
    ("data set", lambda s, v: sepcal.datasets.load(v), [None, 3, [], object()]),
    ("", lambda s, v: sepcal.Flight(v), [None, 3, "x", [1.0], object()]),
    ("maneuver", lambda s, v: sepcal.Flight({"time_s": [0.0]}, maneuver=v), [3, "x"]),
    ("", lambda s, v: s.base[v], [None, 3, [], "x", np.zeros(2)]),
    ("", lambda s, v: s.flight[v], [None, 3, [], "x"]),
    ("own", lambda s, v: sepcal.fit_many(s.probe, [s.flight], own=v), [3, "x", object()]),
    ("flights", lambda s, v: sepcal.fit_many(s.probe, v), [3, None, "x", object()]),
    ("trials", lambda s, v: sepcal.monte_carlo(lambda rng: 1.0, v), ["x", None, 1.5, object()]),
]


@pytest.mark.parametrize("row", range(len(TABLE)))
def test_a_value_of_the_wrong_kind_is_refused_in_a_line(row: int, subject: Subject) -> None:
    named, call, values = TABLE[row]
    for value in values:
        with pytest.raises(sepcal.Error) as refused:
            call(subject, value)
        said = str(refused.value)
        assert len(said.splitlines()) == 1, said
        assert "incompatible" not in said
        if named:
            assert named in said, (value, said)


def test_pandas_objects_are_taken_or_refused(subject: Subject) -> None:
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    base = subject.base
    named = base.intervals(names=pandas.Series(["s_va"]))
    assert list(named.parameters) == ["s_va"]
    for call in (
        lambda: base.intervals(level=pandas.Series([0.9, 0.95])),
        lambda: base.intervals(names=pandas.DataFrame({"a": ["s_va"]})),
        lambda: base.add(pandas.Series(["wind[altitude_m]"])),
        lambda: sepcal.fit(subject.probe, subject.flight, samples=pandas.NA),
        lambda: sepcal.fit(subject.probe, subject.flight, effects=pandas.NA),
    ):
        with pytest.raises(sepcal.Error):
            call()


def test_an_argument_that_there_is_not_is_an_error_and_a_type_error(subject: Subject) -> None:
    for call in (
        lambda: subject.base.intervals(levle=0.9),
        lambda: sepcal.fit(subject.probe, subject.flight, nosie={}),
        lambda: sepcal.simulate(),
    ):
        with pytest.raises(sepcal.Error) as refused:
            call()
        assert isinstance(refused.value, TypeError)


def test_a_name_in_brackets_keeps_what_mappings_promise(subject: Subject) -> None:
    assert "pt_bar" not in subject.flight
    assert subject.flight.get("pt_bar") is None
    with pytest.raises(KeyError, match=r"^there is no parameter|^'?s_v") as refused:
        subject.base["s_v"]
    assert isinstance(refused.value, sepcal.Error)


def test_what_a_function_of_the_caller_raises_is_left_as_it_is(subject: Subject) -> None:
    class Broken:
        inputs, outputs = {"v": "m/s"}, {"z": "m/s"}
        linear, nonlinear = {"k": "1"}, {}

        def at(self, u, xi2):
            raise TypeError("mine")

    with pytest.raises(TypeError, match=r"^mine$") as raised:
        sepcal.fit(Broken(), {"v": [1.0, 2.0], "z": [1.0, 2.0]})
    assert not isinstance(raised.value, sepcal.Error)
    effect = sepcal.Effect("mine", lambda log: log["no such column"], port="wind")
    with pytest.raises(KeyError):
        subject.base.add(effect)


def test_an_aircrafts_effects_are_listed_elsewhere() -> None:
    for model in ("aircraft", sepcal.FlightPath()):
        with pytest.raises(sepcal.Error, match="sepcal-aircraft effects"):
            sepcal.effects(model)


BRACKETS: list[Call] = [
    lambda s, v: s.path.track(start_rows=200)[v],
    lambda s, v: s.path.smooth({"ax": 0.1})[v],
    lambda s, v: sepcal.monte_carlo(lambda rng: {"a": rng.normal()}, 2, progress=False)[v],
    lambda s, v: s.base.intervals(names=["s_va"])[v],
    lambda s, v: s.base.diagnose(simulations=2)[v],
]


@pytest.mark.parametrize("call", BRACKETS)
def test_what_is_no_name_is_refused_in_brackets(call: Call, subject: Subject) -> None:
    for value in (None, 3, np.zeros((2, 2)), "no such name"):
        with pytest.raises(sepcal.Error):
            call(subject, value)


@pytest.mark.parametrize(
    ("named", "options"),
    [
        ("inputs", {"inputs": None}),
        ("substeps", {"substeps": "x"}),
        ("shoot", {"shoot": "x"}),
        ("measured", {"measured": None}),
        ("outputs", {"outputs": "airspeed"}),
        ("gravity", {"gravity": "x"}),
        ("vane", {"vane": 3}),
        ("nope", {"nope": 1}),
    ],
)
def test_a_trajectory_names_the_option(named: str, options: dict[str, Any]) -> None:
    with pytest.raises(sepcal.Error, match=named):
        sepcal.FlightPath(**options)
