# SPDX-License-Identifier: BSD-3-Clause
"""Frequency responses: SciPy's averages, NumPy's least squares over windows, a known system."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy import signal

import apps
import sepcal
from refusals import refuse

STEP = 0.02  # s
ROWS = 6000
# The discrete system behind the readings: a short period, sampled.
NUMERATOR, DENOMINATOR = signal.cont2discrete(([-8.0, -9.0], [1.0, 4.0, 12.0]), STEP)[:2]
Array = NDArray[np.float64]


def flown(seed: int, noise: float = 0.0) -> sepcal.Flight:
    """A pitch rate that follows the elevator by the system, another the rudder too, by a gain."""
    rng = np.random.default_rng(seed)
    smooth = signal.butter(2, 4.0, fs=1 / STEP)
    elevator = 0.05 * signal.lfilter(*smooth, rng.standard_normal(ROWS))
    rudder = 0.04 * signal.lfilter(*smooth, rng.standard_normal(ROWS)) + 0.3 * elevator
    q = signal.lfilter(NUMERATOR.ravel(), DENOMINATOR, elevator)
    return sepcal.Flight(
        {
            "time_s": STEP * np.arange(ROWS),
            "elevator_rad": elevator,
            "rudder_rad": rudder,
            "q_radps": q + noise * rng.standard_normal(ROWS),
            "mixed_radps": q + 2.0 * rudder + noise * rng.standard_normal(ROWS),
        }
    )


def truth(frequencies: Array) -> NDArray[np.complex128]:
    response: NDArray[np.complex128] = signal.freqz(
        NUMERATOR.ravel(), DENOMINATOR, frequencies, fs=1 / STEP
    )[1]
    return response


def windows(column: Array, rows: int) -> NDArray[np.complex128]:
    """(windows, rows / 2 + 1): transforms by numpy.fft of what is tapered and has no line."""
    taper = np.sin(np.pi * (np.arange(rows) + 0.5) / rows) ** 2
    firsts = range(0, len(column) - rows + 1, rows // 2)
    pieces = [taper * signal.detrend(column[first : first + rows]) for first in firsts]
    return np.fft.rfft(pieces, axis=1)


def test_it_is_scipys() -> None:
    flight = flown(1, 0.01)
    rows = 500  # 10 s
    found = sepcal.frequency_response(
        flight, "elevator_rad", "q_radps", band=(0.2, 3.0), window=10.0
    )
    taper = np.sin(np.pi * (np.arange(rows) + 0.5) / rows) ** 2
    how = {"fs": 1 / STEP, "window": taper, "noverlap": rows // 2, "detrend": "linear"}
    x, y = flight["elevator_rad"], flight["q_radps"]
    f, Pxy = signal.csd(x, y, **how)
    _, Pxx = signal.welch(x, **how)
    _, C = signal.coherence(x, y, **how)
    chosen = slice(2, 31)
    assert_allclose(found.frequencies, f[chosen], rtol=1e-9)
    assert_allclose(found.response[:, 0], (Pxy / Pxx)[chosen], rtol=1e-8)
    assert_allclose(found.coherence[:, 0], C[chosen], rtol=1e-8)
    assert found.windows == 23
    assert found.averages == pytest.approx(23 / (1 + 2 * 22 / 23 / 36))
    assert_allclose(found.magnitude[:, 0], np.abs((Pxy / Pxx)[chosen]), rtol=1e-8)
    assert_allclose(np.exp(1j * found.phase) * found.magnitude, found.response, rtol=1e-8)


def test_two_inputs_are_least_squares_over_the_windows() -> None:
    flight = flown(2, 0.01)
    found = sepcal.frequency_response(
        flight, ["elevator_rad", "rudder_rad"], "mixed_radps", band=(0.2, 2.0), window=10.0
    )
    E, R, Y = (windows(flight[n], 500) for n in ("elevator_rad", "rudder_rad", "mixed_radps"))
    n = found.averages
    for m, k in enumerate(range(2, 21)):
        X = np.column_stack([E[:, k], R[:, k]])
        H, square, *_ = np.linalg.lstsq(X, Y[:, k], rcond=None)
        assert_allclose(found.response[m], H, rtol=1e-7)
        left = square[0] / len(X)
        inverse = np.diag(np.linalg.inv(X.conj().T @ X / len(X))).real
        deviation = np.sqrt(left * inverse / (n - 2) / 2)
        assert_allclose(found.standard_error[m], deviation, rtol=1e-6)
        share = np.abs(H) ** 2 / (np.abs(H) ** 2 + left * inverse)
        assert_allclose(found.coherence[m], share, rtol=1e-6)
    assert np.all(np.abs(found.response[:, 1] - 2.0) < 3 * found.radius[:, 1])


def test_ranges_hold_the_truth_as_often_as_they_say() -> None:
    inside = []
    for seed in range(60):
        found = sepcal.frequency_response(
            flown(seed, 0.02), "elevator_rad", "q_radps", band=(0.2, 3.0), window=10.0
        )
        off = np.abs(found.response[:, 0] - truth(found.frequencies))
        inside.append(np.mean(off < found.radius[:, 0]))
        low, high = found.magnitude_low[:, 0], found.magnitude_high[:, 0]
        size = np.abs(truth(found.frequencies))
        assert np.mean((low < size) & (size < high)) > 0.8
    assert np.mean(inside) == pytest.approx(0.95, abs=0.02)


def test_gaps_and_bad_cells_cost_their_windows_alone() -> None:
    flight = flown(3)
    q = flight["q_radps"].copy()
    q[100] = np.nan
    holed = sepcal.Flight({**{n: flight[n] for n in flight}, "q_radps": q})
    found = sepcal.frequency_response(
        holed, "elevator_rad", "q_radps", window=10.0, band=(0.2, 2.0)
    )
    assert found.windows == 22  # the first one is left out
    off = np.abs(found.response[:, 0] - truth(found.frequencies))
    assert np.all(off < 0.09 * np.abs(truth(found.frequencies)))


def test_the_program_writes_the_same(tmp_path: Path) -> None:
    flight = flown(4, 0.01)
    flight.to_csv(tmp_path / "f.csv")
    asked = ("f.csv", "--input", "elevator_rad", "--of", "q_radps", "--window", "20")
    done = apps.run("sepcal-aircraft", "response", *asked, "-o", "r.csv", folder=tmp_path)
    assert done.code == 0, done.err
    assert "worth" in done.out
    found = sepcal.frequency_response(flight, "elevator_rad", "q_radps", window=20.0)
    table = apps.Log(tmp_path / "r.csv")
    assert_allclose(table.column("frequency_hz"), found.frequencies)
    for name in ("magnitude", "magnitude_low", "magnitude_high", "coherence"):
        assert_allclose(table.column(f"elevator_rad_{name}"), getattr(found, name)[:, 0])
    for name in ("phase", "phase_low", "phase_high"):
        assert_allclose(table.column(f"elevator_rad_{name}_rad"), getattr(found, name)[:, 0])
    found.save(tmp_path / "same.csv")
    assert (tmp_path / "same.csv").read_text() == (tmp_path / "r.csv").read_text()
    told = apps.run("sepcal-aircraft", "response", *asked, "-o", "r.csv", "-j", folder=tmp_path)
    assert_allclose(told.result["inputs"]["elevator_rad"]["coherence"], found.coherence[:, 0])
    wrong = apps.run("sepcal-aircraft", "response", *asked, "-o", "f.csv", folder=tmp_path)
    assert wrong.code == 2  # the log stays


def test_what_can_not_be_is_refused() -> None:
    flight = flown(5)

    def asked(inputs: object, output: str = "q_radps", **how: object) -> None:
        refuse(
            lambda: sepcal.frequency_response(flight, inputs, output, **how),  # type: ignore[arg-type]
            *words,
        )

    words = ["column 'aileron_rad' is missing", "elevator_rad"]
    asked("aileron_rad")
    words = ["'q_radps' is input and output at once"]
    asked("q_radps")
    words = ["named twice"]
    asked(["elevator_rad", "elevator_rad"])
    words = ["less than two periods of 0.1 Hz", "20 s or more"]
    asked("elevator_rad", window=5.0)
    words = ["no segment is as long"]
    asked("elevator_rad", window=500.0)
    words = ["worth", "take shorter windows"]
    asked(["elevator_rad", "rudder_rad"], window=80.0)
    words = ["level is 1.5"]
    asked("elevator_rad", level=1.5)
    words = ["no input is named"]
    asked([])
    words = ["give (low, high)"]
    asked("elevator_rad", band=3)
