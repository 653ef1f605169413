# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong in a model in Python: its tables, what at() gives, what it raises."""

import _thread
import signal
import traceback
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import sepcal
from own_models import BOX, WindBox, WithDerivatives, simulate_wind_box
from refusals import refuse

# --- tables


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"nonlinear": {"k": ("rad", -0.5, 0.5)}}, ("'k'", "two parameters")),
        ({"inputs": [("v", "m/s"), ("v", "m/s")]}, ("'v'", "two inputs")),
        ({"outputs": {"": "m/s"}}, ("output", "empty name")),
        ({"inputs": {}}, ("Spoiled", "no inputs", "at()")),
        ({"nonlinear": {"delta": ("rad", 0.5, -0.5)}}, ("Spoiled.nonlinear", "'delta'", "0.5")),
        ({"nonlinear": {"delta": ("rad", 0.5)}}, ("Spoiled.nonlinear", "'delta'", "lower, upper")),
        ({"linear": {"k": 1}}, ("Spoiled.linear", "'k'", "unit")),
        ({"linear": ("k", "1")}, ("Spoiled.linear", "'k'", "{name: unit}")),
        ({"linear": 5}, ("Spoiled.linear", "5", "{name: unit}")),
        ({"inputs": {"v": ("m/s", 0, 1)}}, ("Spoiled", "'v'", "bounds")),
    ],
)
def test_tables_that_are_none(tables: dict[str, object], words: tuple[str, ...]) -> None:
    spoiled = type("Spoiled", (WindBox,), tables)()
    refuse(lambda: sepcal.fit(spoiled, BOX), *words)


def test_what_is_no_model() -> None:
    refuse(lambda: sepcal.fit(object(), BOX), "object", "inputs", "at", "SeparableModel")
    refuse(lambda: sepcal.fit(WindBox, BOX), "WindBox", "WindBox()")


def test_nothing_to_estimate_and_nothing_measured() -> None:
    refuse(lambda: sepcal.fit(type("No", (WindBox,), {"linear": {}, "nonlinear": {}})(), BOX), "No")
    refuse(lambda: sepcal.fit(type("No", (WindBox,), {"outputs": {}})(), BOX), "No")


def test_a_missing_column_is_the_models() -> None:
    data = {name: values for name, values in BOX.items() if name != "psi"}
    refuse(lambda: sepcal.fit(WindBox(), data), "WindBox", "'psi'", "ve")


def test_a_flight_without_an_input_is_refused() -> None:
    refuse(lambda: sepcal.fit(WindBox(), sepcal.Flight({"time_s": [0, 1]})), "column 'v_mps'")


# --- what at() gives


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda A, b: (A[:, :, :2], b), ("A", ", 2, 2)", ", 2, 3)", "(N, n_z, n_1)")),
        (lambda A, b: (np.swapaxes(A, 1, 2), b), ("A", ", 3, 2)", ", 2, 3)")),
        (lambda A, b: (A[:-1], b), ("A", "this block")),
        (lambda A, b: (A, b.T), ("b", "(N, n_z)")),
        (lambda A, b: (A, 0.0), ("b", "()")),
        (lambda A, b: (A + 0j, b), ("A", "complex128", "real")),
        (lambda A, b: (A, b.astype(object)), ("b", "object", "real")),
        (lambda A, b: (A, b.astype(str)), ("b", "<U", "real")),
        (lambda A, b: (None, b), ("A", "object")),
        (lambda A, b: ([[1.0], [1.0, 2.0]], b), ("A", "no array")),
        (lambda A, b: A, ("at()", "ndarray", "tuple")),
        (lambda A, b: None, ("at()", "NoneType", "tuple")),
        (lambda A, b: (A, b, b), ("at()", "tuple of two")),
    ],
)
def test_answers_of_another_form(spoil: Callable[..., object], words: tuple[str, ...]) -> None:
    class Spoiled(WindBox):
        def at(self, u, xi2):
            return spoil(*super().at(u, xi2))

    refuse(lambda: sepcal.fit(Spoiled(), BOX), "Spoiled", *words)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda dA, db: (dA[..., 0], db), ("dA", ", 2, 3, 1)", "n_2")),
        (lambda dA, db: (dA, db[..., 0]), ("db", ", 2, 1)", "n_2")),
        (lambda dA, db: dA, ("derivatives()", "ndarray", "tuple")),
    ],
)
def test_derivatives_of_another_form(spoil: Callable[..., object], words: tuple[str, ...]) -> None:
    class Spoiled(WithDerivatives):
        def derivatives(self, u, xi2):
            return spoil(*super().derivatives(u, xi2))

    refuse(lambda: sepcal.fit(Spoiled(), BOX), "Spoiled", *words)


@pytest.mark.parametrize(
    "form",
    [
        lambda A, b: (A.tolist(), b.tolist()),
        lambda A, b: (np.asfortranarray(A), b[::-1][::-1]),
        lambda A, b: (A.astype(">f8"), b.astype(int)),
    ],
    ids=["lists", "strides", "types"],
)
def test_answers_in_every_form_of_real_numbers(form: Callable[..., object]) -> None:
    class Formed(WindBox):
        def at(self, u, xi2):
            return form(*super().at(u, xi2))

    expected = sepcal.OwnModel(WindBox()).evaluate(BOX, [0.1])
    for actual, value in zip(sepcal.OwnModel(Formed()).evaluate(BOX, [0.1]), expected, strict=True):
        assert_array_equal(actual, value)


def test_an_entry_that_is_never_set() -> None:
    class Unset(WindBox):
        def at(self, u, xi2):
            A, b = super().at(u, xi2)
            A[:, 1, 2] = np.nan
            return A, b

    refuse(lambda: sepcal.fit(Unset(), BOX), "A(1, 2)", "'ve'", "'w_e'", "set every entry")


def test_a_model_that_remembers() -> None:
    class Remembers(WindBox):
        calls = 0

        def at(self, u, xi2):
            self.calls += 1
            A, b = super().at(u, xi2)
            return A, b + self.calls

    refuse(lambda: sepcal.fit(Remembers(), BOX), "b[0]", "'vn'", "pure function")


def test_points_without_an_answer_are_avoided() -> None:
    class Partial(WindBox):
        def at(self, u, xi2):
            A, b = super().at(u, xi2)
            return (A, b) if xi2[0] > 0.0 else (A * np.nan, b)

    fit = sepcal.fit(Partial(), BOX, samples=50)
    assert fit.status == "converged"
    assert np.isinf(fit.stage_one.trace_r[fit.stage_one.samples[:, 0] <= 0.0]).all()
    errors = [fit[name].standard_error for name in fit.names]
    expected = sepcal.fit(WindBox(), BOX, samples=50).values
    assert np.all(np.abs(fit.values - expected) < 1e-6 * np.array(errors))


def test_supplied_derivatives_that_are_wrong() -> None:
    class Wrong(WithDerivatives):
        def derivatives(self, u, xi2):
            dA, db = super().derivatives(u, xi2)
            dA[:, 1] *= 1.01
            return dA, db

    refuse(lambda: sepcal.fit(Wrong(), BOX), "derivative", "'ve'", "'delta'")


# --- what at() raises


class Trouble(Exception):
    """An exception of the model's own."""


class Troubled(WindBox):
    """Does `trouble` at its call number `at_call`."""

    def __init__(self, at_call: int, trouble: Callable[[], None]) -> None:
        self.left, self.trouble = at_call, trouble

    def at(self, u, xi2):
        """As a WindBox, but for that call."""
        self.left -= 1
        if self.left == 0:
            self.trouble()
        return super().at(u, xi2)


def raise_trouble() -> None:
    raise Trouble("no probe")


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("at_call", [1, 100, 1000])
def test_exceptions_pass_as_they_are(at_call: int, threads: int) -> None:
    """From the model's check, from samples on any thread, from the second stage."""
    record = simulate_wind_box(9000)
    model = Troubled(at_call, raise_trouble)
    with pytest.raises(Trouble, match="no probe") as caught:
        sepcal.fit(model, record, samples=20, threads=threads)
    assert model.left <= 0
    names = [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert names[-2:] == ["at", "raise_trouble"]
    assert "fit" in names
    assert sepcal.fit(WindBox(), BOX, samples=8).status == "converged"


def test_exceptions_of_derivatives_pass_too() -> None:
    class Derived(WindBox):
        def derivatives(self, u, xi2):
            raise_trouble()

    with pytest.raises(Trouble):
        sepcal.fit(Derived(), BOX)


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Python's own handler, where the shell that began this has interrupts ignored too."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("threads", [1, 2])
def test_a_person_can_interrupt(threads: int) -> None:
    model = Troubled(300, _thread.interrupt_main)
    with pytest.raises(KeyboardInterrupt):
        sepcal.fit(model, simulate_wind_box(9000), samples=2000, threads=threads)
    assert model.left > -20_000  # far from through
