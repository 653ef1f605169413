# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong with an effect of one's own: answers, names, exceptions, threads."""

import copy
import threading
import traceback
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import sepcal
from motor_effect import MAGNETOMETER, MOTOR, Columns, current, simulate_motor
from refusals import refuse


@pytest.fixture(scope="module")
def flight() -> sepcal.Flight:
    """A motor's current bends the field."""
    return simulate_motor(rows=500, seed=1)


@pytest.fixture(scope="module")
def other() -> sepcal.Flight:
    """Another flight of the same sensor."""
    return simulate_motor(rows=300, seed=2)


@pytest.mark.parametrize(
    ("function", "port", "words"),
    [
        (lambda log: log["current_a"][:-1], "bias", ("(499,)", "(500,)", "one value a row")),
        (lambda log: 0.0, "bias", ("()", "(500,)")),
        (lambda log: log["current_a"] + 0j, "bias", ("complex128", "not numbers")),
        (lambda log: ["x"] * 500, "bias", ("not numbers",)),
        (lambda log: None, "bias", ("NoneType", "not numbers")),
        (lambda log: np.where(log["time"] > 20, np.nan, 1.0), "bias", ("nan", "row", "finite")),
        (lambda log: {"s": log["current_a"]}, "bias", ("dict", "not numbers")),
        (lambda log: log["current_a"], "boas", ("'boas'", "bias", "axis_scale")),
        (lambda log: log["current_a"], None, ("ndarray", "{component:", "without a port")),
        (lambda log: {}, None, ("dict", "{component:")),
        (lambda log: {"s": log["current_a"]}, None, ("'s'", "(500,)", "(500, 3)", "by outputs")),
        (lambda log: {"s": np.zeros((3, 500))}, None, ("'s'", "(3, 500)", "(500, 3)")),
        (lambda log: {"s": np.full((500, 3), np.inf)}, None, ("'s'", "finite")),
        (lambda log: {"s": np.array([[None] * 3] * 500)}, None, ("'s'", "ndarray")),
        (lambda log: {"": np.zeros((500, 3))}, None, ("''", "can't name a component")),
        (lambda log: {1: np.zeros((500, 3))}, None, ("1", "can't name a component")),
    ],
)
def test_answers_that_are_refused(
    flight: sepcal.Flight,
    function: Callable[[Columns], object],
    port: str | None,
    words: tuple[str, ...],
) -> None:
    effect = sepcal.Effect("mine", function, port=port)
    refuse(lambda: sepcal.fit(MAGNETOMETER, flight, effects=[effect]), "mine", *words)


@pytest.mark.parametrize("name", ["bias", "bias_step", "bias_drift", "current_a"])
def test_names_that_are_taken(flight: sepcal.Flight, name: str) -> None:
    """A port's, an effect's, an alias's, a column's."""
    effect = sepcal.Effect(name, current, port="bias")
    refuse(lambda: sepcal.fit(MAGNETOMETER, flight, effects=[effect]), name, "name", "another")


def test_a_name_twice(flight: sepcal.Flight) -> None:
    effects = [MOTOR, sepcal.Effect("motor", current, port="scale")]
    refuse(lambda: sepcal.fit(MAGNETOMETER, flight, effects=effects), "motor", "twice")


@pytest.mark.parametrize("name", ["", "two words", "bias[time]", "a+b", "1st", None])
def test_names_that_are_none(name: str) -> None:
    refuse(lambda: sepcal.Effect(name, current), repr(name), "letters")


def test_what_is_no_function() -> None:
    refuse(lambda: sepcal.Effect("motor", np.zeros(3)), "motor", "no function")


class Backfired(Exception):
    """Of a user's own."""


def backfire(log: Columns) -> np.ndarray:
    """Fails on a flight without 300 rows."""
    if len(log["time"]) != 300:
        raise Backfired(len(log["time"]))
    return log["current_a"]


@pytest.mark.parametrize("port", ["bias", None])
def test_exceptions_pass_as_they_are(flight: sepcal.Flight, port: str | None) -> None:
    with pytest.raises(Backfired) as caught:
        sepcal.fit(MAGNETOMETER, flight, effects=[sepcal.Effect("motor", backfire, port=port)])
    assert caught.value.args == (500,)
    assert any(frame.name == "backfire" for frame in traceback.extract_tb(caught.tb))


def test_exceptions_pass_through_every_verb(
    flight: sepcal.Flight, other: sepcal.Flight, tmp_path: Path
) -> None:
    effect = sepcal.Effect("motor", backfire, port="bias")
    calibration = sepcal.fit(MAGNETOMETER, other, effects=[effect])
    for work in (
        lambda: calibration.compare(flight),
        lambda: calibration.apply(flight),
        lambda: calibration.add("bias[time]", flight),
        lambda: sepcal.fit(MAGNETOMETER, flight).add(effect),
    ):
        with pytest.raises(Backfired):
            work()
    assert_array_equal(calibration.values, copy.deepcopy(calibration).values)


def test_a_function_of_a_missing_column(flight: sepcal.Flight) -> None:
    effect = sepcal.Effect("motor", lambda log: log["amps"], port="bias")
    with pytest.raises(KeyError, match=r"'amps' is missing; the record has: .*current_a"):
        sepcal.fit(MAGNETOMETER, flight, effects=[effect])


def test_it_may_wait_for_another_thread(flight: sepcal.Flight) -> None:
    """The GIL is there for others while a function waits."""

    def wait(log: Columns) -> np.ndarray:
        thread = threading.Thread(target=lambda: sum(range(1000)))
        thread.start()
        thread.join(timeout=30)
        assert not thread.is_alive()
        return log["current_a"]

    effect = sepcal.Effect("motor", wait, port="bias")
    assert sepcal.fit(MAGNETOMETER, flight, effects=[effect]).status == "converged"
