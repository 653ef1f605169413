# SPDX-License-Identifier: BSD-3-Clause
"""stream() and gather(): order, laziness, exceptions, workers that die, executors that break."""

import threading
import traceback
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from itertools import count, islice

import pytest

import sepcal
from sepcal.executors import gather, stream
from trial_functions import (
    DieOnce,
    Unpicklable,
    die_on_third,
    refuse,
    refuse_in_words,
    square,
    wait_and_square,
)

SQUARES = [number * number for number in range(30)]


class Unreliable(ThreadPoolExecutor):
    """Loses the first so many of the tasks that hold a number, as a cancelled future."""

    def __init__(self, number, losses):
        super().__init__(2)
        self.number, self.losses = number, losses
        self.submitted = []

    def submit(self, function, /, *arguments):
        """Runs it, or loses it."""
        items = arguments[1]
        self.submitted.append(list(items))
        if self.number in items and self.losses > 0:
            self.losses -= 1
            future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future
        return super().submit(function, *arguments)


@pytest.mark.parametrize("batch", [1, 4, 100])
@pytest.mark.parametrize("make", [None, partial(ThreadPoolExecutor, 3)])
def test_gather_is_in_order(make, batch):
    assert gather(square, range(30), make, batch=batch) == SQUARES
    assert gather(square, [], make, batch=batch) == []


def test_an_executor_is_left_open_and_one_that_was_made_is_shut_down():
    with ThreadPoolExecutor(2) as pool:
        assert gather(square, range(30), pool) == SQUARES
        assert pool.submit(square, 3).result() == 9
    made = []

    def make():
        made.append(ThreadPoolExecutor(2))
        return made[-1]

    assert gather(square, range(30), make) == SQUARES
    assert len(made) == 1
    with pytest.raises(RuntimeError):
        made[0].submit(square, 3)


def test_processes():
    with ProcessPoolExecutor(2) as pool:
        assert gather(square, range(30), pool, batch=3) == SQUARES


def test_results_come_as_they_complete():
    first_may_end = threading.Event()

    def work(number):
        if number == 0:
            assert first_may_end.wait(10)
        return number

    with ThreadPoolExecutor(2) as pool:
        results = stream(work, range(4), pool)
        early = list(islice(results, 3))
        first_may_end.set()
        assert sorted(early) == [(1, 1), (2, 2), (3, 3)]
        assert list(results) == [(0, 0)]


@pytest.mark.parametrize("batch", [1, 5])
def test_items_are_drawn_as_they_are_needed(batch):
    drawn = []

    def items():
        for number in count():
            drawn.append(number)
            yield number

    with ThreadPoolExecutor(2) as pool:
        results = stream(square, items(), pool, pending=4, batch=batch)
        assert len(list(islice(results, 100))) == 100
        assert len(drawn) <= 100 + 6 * batch
        results.close()


def test_closing_cancels_what_is_pending():
    ran = []

    def work(number):
        ran.append(number)
        return wait_and_square(number)

    with ThreadPoolExecutor(1) as pool:
        results = stream(work, range(200), pool)
        next(results)
        results.close()
    assert len(ran) < 10


def test_the_functions_exception_comes_through():
    for executor in (None, partial(ThreadPoolExecutor, 2)):
        with pytest.raises(ZeroDivisionError, match="three"):
            gather(refuse_in_words, range(10), executor)
    with pytest.raises(ZeroDivisionError, match="three") as raised:
        gather(refuse_in_words, range(10), partial(ProcessPoolExecutor, 1))
    assert "in refuse_in_words" in "".join(traceback.format_exception(raised.value))
    # An exception that can't be read again breaks a process pool, were it sent as it is.
    # Where distributed is imported, tblib makes it readable.
    with pytest.raises((sepcal.Error, Unpicklable), match="this and that"):
        gather(refuse, range(10), partial(ProcessPoolExecutor, 1))


def test_results_before_the_exception_are_there():
    with ThreadPoolExecutor(1) as pool:
        results = stream(refuse_in_words, range(10), pool, batch=10)
        assert [next(results)[1] for _ in range(3)] == [0, 1, 2]
        with pytest.raises(ZeroDivisionError):
            next(results)


@pytest.mark.parametrize("losses", [1, 2])
def test_lost_work_is_submitted_again_item_by_item(losses):
    with Unreliable(5, losses) as pool:
        assert gather(square, range(30), pool, batch=4) == SQUARES
    assert pool.submitted.count([5]) == losses
    assert [4, 5, 6, 7] in pool.submitted


def test_the_last_attempt_is_made_alone_at_the_end():
    with Unreliable(5, 2) as pool:
        gather(square, range(30), pool)
    assert pool.submitted[-1] == [5]


def test_an_item_that_is_always_lost():
    with Unreliable(5, 99) as pool:
        with pytest.raises(sepcal.Error, match=r"item 5 was lost in 3 attempts \(CancelledError"):
            gather(square, range(30), pool)
        assert pool.submitted.count([5]) == 3
        results = dict(stream(square, range(30), pool, attempts=1, lost=lambda item, _: -item))
    assert [results[number] for number in range(30)] == [*SQUARES[:5], -5, *SQUARES[6:]]


def test_a_pool_that_breaks_is_replaced_by_its_maker(tmp_path):
    make = partial(ProcessPoolExecutor, 2)
    assert gather(DieOnce(tmp_path, 11), range(30), make) == SQUARES
    assert (tmp_path / "died").exists()


def test_an_item_that_kills_every_worker_takes_no_other_with_it():
    make = partial(ProcessPoolExecutor, 2)
    results = dict(stream(die_on_third, range(12), make, lost=lambda item, error: (item, error)))
    item, error = results.pop(3)
    assert item == 3
    assert "BrokenProcessPool" in type(error).__name__
    assert results == {number: number for number in range(12) if number != 3}


def test_a_pool_that_breaks_and_has_no_maker_is_an_error():
    with (
        ProcessPoolExecutor(1) as pool,
        pytest.raises(sepcal.Error, match=r"broke and takes no more work \(BrokenProcessPool"),
    ):
        gather(die_on_third, range(12), pool)


@pytest.mark.parametrize("kind", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_a_pool_that_its_owner_shut_down(kind):
    with kind(1) as pool:
        pass
    words = r"was shut down before the work was done \(RuntimeError.*inside its with block"
    with pytest.raises(sepcal.Error, match=words):
        gather(square, range(12), pool)


def test_a_pool_that_its_owner_shuts_down_on_the_way():
    pool = ThreadPoolExecutor(1)
    results = stream(square, range(12), pool, pending=2)
    next(results)
    pool.shutdown()
    with pytest.raises(sepcal.Error, match="was shut down before the work was done"):
        list(results)


def test_pools_that_never_work_are_given_up():
    def make():
        pool = ThreadPoolExecutor(1)
        pool.shutdown()
        return pool

    with pytest.raises(sepcal.Error, match="broke 10 times in a row"):
        gather(square, range(12), make)


def test_what_cannot_be_sent():
    with pytest.raises(sepcal.Error, match=r"can't be sent.*def at the top of a module"):
        gather(lambda number: number, range(3), partial(ProcessPoolExecutor, 1))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"batch": 0}, "batch=0 must be at least 1"),
        ({"pending": -1}, "pending=-1 must be at least 1"),
        ({"attempts": 0}, "attempts=0 must be at least 1"),
        ({"executor": 4}, "executor is a int.*concurrent.futures.Executor"),
    ],
)
def test_refusals_come_at_once(arguments, words):
    with pytest.raises(sepcal.Error, match=words):
        stream(square, range(3), **arguments)
