# SPDX-License-Identifier: BSD-3-Clause
"""Arrays in and out: what is copied, who keeps it alive, and that Python runs on meanwhile."""

import gc
import sys
import threading
import weakref
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import sepcal
from sepcal.columns import to_column

PROBE = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))


def test_float64_goes_in_and_out_uncopied() -> None:
    pressure = np.linspace(100.0, 200.0, 50)
    flight = sepcal.Flight({"pt_pa": pressure})
    assert np.shares_memory(flight["pt_pa"], pressure)
    assert flight["pt_pa"].ctypes.data == pressure.ctypes.data
    pressure[7] = -1.0
    assert flight["pt_pa"][7] == -1.0


def test_what_comes_out_is_read_only() -> None:
    flight = sepcal.Flight({"pt_pa": np.ones(3)})
    with pytest.raises(ValueError, match="read-only"):
        flight["pt_pa"][0] = 2.0


@pytest.mark.parametrize(
    "values",
    [
        [1, 2, 3, 4],
        (1.0, 2.0, 3.0, 4.0),
        range(1, 5),
        np.array([1, 2, 3, 4], dtype=np.float32),
        np.array([1, 2, 3, 4], dtype=np.uint8),
        np.array([1.0, 2.0, 3.0, 4.0]).astype(">f8"),
        np.array([1.0, 9.0, 2.0, 9.0, 3.0, 9.0, 4.0])[::2],
        np.array([4.0, 3.0, 2.0, 1.0])[::-1],
        np.array([[1.0, 9.0], [2.0, 9.0], [3.0, 9.0], [4.0, 9.0]])[:, 0],
    ],
    ids=[
        "list",
        "tuple",
        "range",
        "float32",
        "uint8",
        "big-endian",
        "stride",
        "reversed",
        "column",
    ],
)
def test_everything_else_is_converted(values: object) -> None:
    flight = sepcal.Flight({"pt_pa": values})
    np.testing.assert_array_equal(flight["pt_pa"], np.array([1.0, 2.0, 3.0, 4.0]), strict=True)


def test_masked_values_are_nan() -> None:
    masked = np.ma.masked_array([1, 2, 3], mask=[False, True, False])
    np.testing.assert_array_equal(sepcal.Flight({"x_pa": masked})["x_pa"], [1.0, np.nan, 3.0])


def test_a_flight_keeps_its_arrays_alive_and_no_longer() -> None:
    values = np.arange(1000.0)
    alive = weakref.ref(values)
    flight = sepcal.Flight({"pt_pa": values})
    del values
    gc.collect()
    assert alive() is not None
    np.testing.assert_array_equal(flight["pt_pa"], np.arange(1000.0))
    del flight
    gc.collect()
    assert alive() is None


def test_a_column_outlives_its_flight() -> None:
    column = sepcal.simulate("five-hole", rows=300)["pt_pa"]
    expected = sepcal.simulate("five-hole", rows=300)["pt_pa"]
    gc.collect()
    assert column.size == 300
    np.testing.assert_array_equal(column, expected)


def test_a_fit_lets_its_arrays_go() -> None:
    eta = np.linspace(1.0, 10.0, 100)
    z = np.cos(eta)
    alive = weakref.ref(eta)
    fit = sepcal.fit(sepcal.ScalarExample1(), {"eta": eta, "z": z})
    del eta
    gc.collect()
    assert alive() is None
    assert fit.status == "converged"


def test_columns_pass_as_they_are() -> None:
    values = np.ones(3)
    assert to_column("flight", "x", values) is values


def test_evaluate_gives_views_of_one_buffer() -> None:
    A, b, D = sepcal.ScalarExample2().evaluate({"eta": np.arange(5.0)}, [0.1, 0.2], [1.0, 2.0])
    assert A.shape == (5, 1, 2)
    assert b.shape == (5, 1)
    assert D.shape == (5, 1, 2)
    assert A.base is not None
    assert A.base is b.base is D.base


@pytest.fixture
def patient_interpreter() -> Iterator[None]:
    """No thread is asked to give the GIL up: others run only when it is released on purpose."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    yield
    sys.setswitchinterval(interval)


def lets_others_run(work: Callable[[], object]) -> bool:
    """Whether a thread that waits for the GIL gets it while `work` is done, in fifty turns."""
    go, ran = threading.Event(), []

    def wait() -> None:
        go.wait()
        ran.append(True)

    thread = threading.Thread(target=wait)
    thread.start()
    go.set()
    for _ in range(50):
        work()
        if ran:
            break
    seen = bool(ran)
    thread.join()
    return seen


def test_python_runs_on_meanwhile(patient_interpreter: None, tmp_path: Path) -> None:
    """The GIL is released in everything that takes long."""
    flight = sepcal.simulate(PROBE, rows=20_000)
    calibration = sepcal.fit(PROBE, flight, samples=8)
    log = tmp_path / "flight.csv"
    headers = ",".join(flight)
    np.savetxt(
        log, np.column_stack(list(flight.values())), delimiter=",", header=headers, comments=""
    )
    record = {"eta": np.linspace(1.0, 10.0, 200_000)}
    record["z"] = np.cos(record["eta"])
    scalar = sepcal.ScalarExample1()

    assert not lets_others_run(lambda: sorted(range(1000)))  # or this test could not fail
    assert lets_others_run(lambda: sepcal.fit(scalar, record, samples=8))
    assert lets_others_run(lambda: sepcal.fit(PROBE, flight, samples=8))
    assert lets_others_run(lambda: sepcal.read_csv(log))
    assert lets_others_run(lambda: calibration.compare())
    assert lets_others_run(lambda: calibration.apply(flight))
    assert lets_others_run(lambda: calibration.apply_to_file(log, tmp_path / "corrected.csv"))
    assert lets_others_run(lambda: sepcal.simulate(PROBE, rows=20_000))
    assert lets_others_run(lambda: scalar.evaluate(record, [0.1]))


def test_fits_in_two_threads_do_not_meet() -> None:
    """Each gives what it gives alone."""
    flights = [sepcal.simulate(PROBE, rows=300, seed=seed) for seed in range(4)]
    alone = [sepcal.fit(PROBE, flight, samples=16).values for flight in flights]
    together: dict[int, np.ndarray] = {}

    def work(indices: list[int]) -> None:
        for i in indices:
            together[i] = sepcal.fit(PROBE, flights[i], samples=16).values

    threads = [threading.Thread(target=work, args=(part,)) for part in ([0, 1], [2, 3])]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for i, values in enumerate(alone):
        np.testing.assert_array_equal(together[i], values)
