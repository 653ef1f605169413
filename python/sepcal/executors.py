# SPDX-License-Identifier: BSD-3-Clause
"""A function of many items through any concurrent.futures.Executor: threads, processes, Dask, MPI.

stream() yields results as they complete, gather() gives them in order. Only so many tasks are
pending at a time, and work that a dying worker took with it is submitted again.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
)
from dataclasses import dataclass
from itertools import count, islice
from multiprocessing.reduction import ForkingPickler
from queue import SimpleQueue
from typing import Generic, TypeAlias, TypeVar

from sepcal._core import Error
from sepcal.arguments import shown
from sepcal.dask_executor import with_sure_futures
from sepcal.remote_call import Answer, call_all, call_pickled, raise_again

Item = TypeVar("Item")
Result = TypeVar("Result")
Executors: TypeAlias = Executor | Callable[[], Executor] | None
Lost: TypeAlias = Callable[[Item, BaseException], Result]

MOST_BREAKS = 10  # of executors in a row, without one result between
TICKETS = count()  # one a task: Dask takes equal calls for the same call


def stream(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    executor: Executors = None,
    *,
    batch: int = 1,
    pending: int = 256,
    attempts: int = 3,
    lost: Lost[Item, Result] | None = None,
) -> Generator[tuple[int, Result], None, None]:
    """Yields (index, function(item)) as the results complete; items are drawn as they are needed.

    Work is lost where a worker dies with it (Dask's KilledWorker, a pool that broke, a task that
    was cancelled). It is submitted again, a batch item by item, and the last attempt is made when
    nothing else runs: an item that kills its worker takes no other with it. Where the iterator is
    closed or an exception leaves it, what is pending is cancelled, and what runs is waited for; on
    Ctrl-C processes of a ProcessPoolExecutor made here end at once.

    Args:
        function: On processes and clusters it must pickle, as must its items and results: define it
            with def at the top of a module. It is sent with every task. Where it has a method
            together(items), which raises nothing, a task is one call of that.
        items: Finite or not, N of them.
        executor: None: here, one task after the other. A function that makes an executor, as
            ProcessPoolExecutor does, is called for one, and again where a dying worker broke it;
            what it made is shut down at the end. An Executor is left open.
        batch: Items a task.
        pending: Tasks that are submitted and not done, at most.
        attempts: To run an item, in all.
        lost: Makes the result for an item that was lost in every attempt, given the last exception.

    Raises:
        Error: An argument is none of these; an item was lost in every attempt and there is no
            `lost`; the executor broke or was shut down and only its maker could replace it;
            something can't be sent.
        Exception: The function's own, as it is, with the worker's traceback as a note.
    """
    for name, value in (("batch", batch), ("pending", pending), ("attempts", attempts)):
        if value < 1:
            raise Error(f"{name}={value} must be at least 1")
    if not (executor is None or isinstance(executor, Executor) or callable(executor)):
        raise Error(
            f"executor is a {type(executor).__name__}; give a concurrent.futures.Executor, a "
            "function that makes one, or None (Dask: client.get_executor())"
        )
    if executor is None:
        return _here(function, items, batch)
    work = _Work(items, batch, attempts)
    return _stream(function, work, _Pool(executor), pending, lost)


def _here(
    function: Callable[[Item], Result], items: Iterable[Item], batch: int
) -> Generator[tuple[int, Result], None, None]:
    if (together := getattr(function, "together", None)) is None:
        yield from ((index, function(item)) for index, item in enumerate(items))
        return
    numbered = enumerate(items)
    while task := list(islice(numbered, batch)):
        results = together([item for _, item in task])
        yield from zip((index for index, _ in task), results, strict=True)


def gather(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    executor: Executors = None,
    *,
    batch: int = 1,
    pending: int = 256,
    attempts: int = 3,
) -> list[Result]:
    """[function(item) for item in items]; arguments and exceptions are those of stream()."""
    results = dict(
        stream(function, items, executor, batch=batch, pending=pending, attempts=attempts)
    )
    return [results[index] for index in range(len(results))]


@dataclass(frozen=True)
class _Task(Generic[Item]):
    items: list[tuple[int, Item]]  # with their indices
    attempt: int  # counted from 1


class _Work(Generic[Item]):
    """Items to run: first those that were lost, then new ones, last suspect ones, each alone."""

    def __init__(self, items: Iterable[Item], batch: int, attempts: int) -> None:
        self.attempts = attempts
        self._batch = batch
        self._items = enumerate(items)
        self._lost: deque[_Task[Item]] = deque()
        self._suspects: deque[_Task[Item]] = deque()

    def draw(self, is_idle: bool) -> _Task[Item] | None:
        """The next task; None where there is nothing to do until those that run are done."""
        if self._lost:
            return self._lost.popleft()
        if items := list(islice(self._items, self._batch)):
            return _Task(items, 1)
        return self._suspects.popleft() if self._suspects and is_idle else None

    def put_back(self, task: _Task[Item]) -> None:
        """A task that never ran."""
        self._lost.appendleft(task)

    def lose(self, task: _Task[Item]) -> None:
        """A task that died with its worker and has attempts left."""
        attempt = task.attempt + 1
        queue = self._suspects if attempt == self.attempts else self._lost
        queue.extend(_Task([item], attempt) for item in task.items)


class _Pool:
    """An executor; where its maker is known, another one in place of one that broke."""

    def __init__(self, executor: Executor | Callable[[], Executor]) -> None:
        self._make = None if isinstance(executor, Executor) else executor
        self._breaks = 0
        made = executor if isinstance(executor, Executor) else executor()
        if not hasattr(made, "submit"):
            raise Error(f"executor gives {shown(made)}; give a function that makes an executor")
        self.executor = with_sure_futures(made)

    def is_well(self) -> None:
        """It gave a result."""
        self._breaks = 0

    def replace(self, broken: Executor, error: BaseException) -> None:
        """Raises Error where the executor can't be replaced, or broke too often."""
        if broken is not self.executor:
            return  # it has been
        self._breaks += 1
        if self._make is None and _is_shut_down(error):
            raise Error(
                f"the executor was shut down before the work was done ({describe(error)}); use it "
                "inside its with block, or give a function that makes an executor, "
                "ProcessPoolExecutor itself (Dask: client.get_executor() of an open client)"
            ) from error
        if self._make is None:
            raise Error(
                f"the executor broke and takes no more work ({describe(error)}): a worker was "
                "killed, ran out of memory, crashed or could not import the function; give a "
                "function that makes an executor, ProcessPoolExecutor itself, and it is replaced"
            ) from error
        if self._breaks == MOST_BREAKS:
            raise Error(
                f"the executor broke {MOST_BREAKS} times in a row without a result between "
                f"({describe(error)}); try the function without an executor"
            ) from error
        broken.shutdown(wait=False)
        self.executor = with_sure_futures(self._make())

    def close(self) -> None:
        """Shuts down what it made."""
        if self._make is not None:
            self.executor.shutdown(wait=True)

    def interrupt(self) -> None:
        """Ends the worker processes of what it made, whatever they are at."""
        if self._make is not None and isinstance(self.executor, ProcessPoolExecutor):
            for process in list((self.executor._processes or {}).values()):
                process.terminate()
            self.executor.shutdown(
                wait=True
            )  # its thread fails on work that is cancelled meanwhile


def _stream(
    function: Callable[[Item], Result],
    work: _Work[Item],
    pool: _Pool,
    pending: int,
    lost: Lost[Item, Result] | None,
) -> Generator[tuple[int, Result], None, None]:
    running: dict[Future[Answer[Result]], tuple[_Task[Item], Executor]] = {}
    done: SimpleQueue[Future[Answer[Result]]] = SimpleQueue()

    def submit(task: _Task[Item]) -> None:
        executor = pool.executor
        items = [item for _, item in task.items]
        try:
            if isinstance(executor, ProcessPoolExecutor):
                # Left to the pool, what doesn't pickle may hang its shutdown (CPython 3.11).
                call = bytes(ForkingPickler.dumps((function, items)))
                future = executor.submit(call_pickled, call, next(TICKETS))
            else:
                future = executor.submit(call_all, function, items, next(TICKETS))
        except Exception as error:
            if not isinstance(error, RuntimeError) and not _is_lost(error):
                raise _not_sent(error) from error
            work.put_back(task)  # the executor broke or was shut down
            pool.replace(executor, error)
            return
        running[future] = task, executor
        future.add_done_callback(done.put)

    try:
        while True:
            while len(running) < pending and (task := work.draw(not running)) is not None:
                submit(task)
            if not running:
                return
            future = done.get()
            task, executor = running.pop(future)
            error = CancelledError() if future.cancelled() else future.exception()
            if error is None:
                pool.is_well()
                answer = future.result()
                yield from zip((index for index, _ in task.items), answer.results, strict=False)
                raise_again(answer)
                continue
            if isinstance(error, BrokenExecutor):
                pool.replace(executor, error)
            yield from _take_loss(task, error, work, lost)
    except KeyboardInterrupt:
        pool.interrupt()
        raise
    finally:
        for future in running:
            future.cancel()
        pool.close()


def _take_loss(
    task: _Task[Item], error: BaseException, work: _Work[Item], lost: Lost[Item, Result] | None
) -> Iterator[tuple[int, Result]]:
    """Puts the task's items back, or yields what stands for them after the last attempt."""
    if isinstance(error, KeyboardInterrupt | SystemExit):
        raise error
    if not _is_lost(error):
        raise _not_sent(error) from error
    if task.attempt < work.attempts:
        work.lose(task)
        return
    for index, item in task.items:
        if lost is None:
            raise Error(
                f"item {index} was lost in {_times(work.attempts)} ({describe(error)}): its "
                "worker dies of it, or is killed; try it without an executor"
            ) from error
        yield index, lost(item, error)


def _is_lost(error: BaseException) -> bool:
    """Did the work go with its worker? The function's own exceptions come as answers."""
    is_common = isinstance(error, BrokenExecutor | CancelledError | OSError | EOFError)
    return is_common or type(error).__module__.startswith("distributed")


def _is_shut_down(error: BaseException) -> bool:
    """Did its owner close the executor? It then refuses work, where a broken one has lost some."""
    is_refusal = isinstance(error, RuntimeError) and not isinstance(error, BrokenExecutor)
    return is_refusal and any(word in str(error) for word in ("shutdown", "shut down", "closed"))


def _not_sent(error: BaseException) -> Error:
    return Error(
        f"work can't be sent to or from the executor ({describe(error)}); the function, its items "
        "and results must pickle: define the function with def at the top of a module"
    )


def _times(attempts: int) -> str:
    return "1 attempt" if attempts == 1 else f"{attempts} attempts"


def describe(error: BaseException) -> str:
    """An exception in one line: its type and text."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
