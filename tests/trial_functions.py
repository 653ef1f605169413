# SPDX-License-Identifier: BSD-3-Clause
"""Functions for workers, which import them: trials, and items that kill or fail."""

import os
import signal
import time
from pathlib import Path

import numpy as np

import sepcal

TRUTH = {"a": 1.0, "b": 0.1, "c": 1.0}


def draw_record(rng, rows=60):
    """Scalar example 1 (Eq. 21), noise of 0.3."""
    eta = np.linspace(1.0, 10.0, rows)
    clean = (1.0 + TRUTH["a"]) * np.cos(eta + TRUTH["b"]) + TRUTH["c"]
    return {"eta": eta, "z": clean + 0.3 * rng.standard_normal(rows)}


def fit_scalar(rng, samples=20):
    return sepcal.fit(sepcal.ScalarExample1(), draw_record(rng), samples=samples, threads=1)


def fail_on_seventh(rng, index):
    if index == 7:
        raise ValueError("seven is not for trying")
    return {"draw": rng.standard_normal(), "index": index, "row": np.arange(3) + index}


class Stay:
    """Can't be pickled."""

    def __reduce__(self):
        """Refuses."""
        raise RuntimeError("this one stays")


class Gone:
    """Pickles, and can't be read again."""

    def __reduce__(self):
        """A number that is none."""
        return int, ("gone",)


def give_what_stays(rng, index):
    return {2: Stay(), 4: Gone()}.get(index, rng.standard_normal())


def square(number):
    return number * number


def wait_and_square(number):
    time.sleep(0.02)
    return number * number


class Unpicklable(Exception):
    """Pickles, and can't be read again."""

    def __init__(self, first, second):
        super().__init__(f"{first} and {second}")


def refuse(number):
    if number == 5:
        raise Unpicklable("this", "that")
    return number


def refuse_in_words(number):
    if number == 3:
        raise ZeroDivisionError("three")
    return number


def die_on_third(number):
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


class DieOnce:
    """Kills its worker at one item, the first time alone, which a file remembers."""

    def __init__(self, folder, number):
        self.mark, self.number = Path(folder) / "died", number

    def __call__(self, number):
        """The square, where it lives."""
        if number == self.number and not self.mark.exists():
            self.mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return number * number


class SlowTrial:
    """A trial that takes its time, and tells by a file in which process it runs."""

    def __init__(self, folder):
        self.folder = Path(folder)

    def __call__(self, rng, index):
        """A fit and its truth."""
        (self.folder / f"{index}-{os.getpid()}").touch()
        time.sleep(0.05)
        return fit_scalar(rng), TRUTH
