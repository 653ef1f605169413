# SPDX-License-Identifier: BSD-3-Clause
"""Many trials of a method, each with random numbers of its own: here, in processes, on a cluster.

probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5)
trial = sepcal.SimulatedTrial(probe, simulation={"rows": 400})
print(sepcal.monte_carlo(trial, trials=1000, executor=ProcessPoolExecutor))
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from numbers import Integral
from typing import Literal

from sepcal._core import Error
from sepcal.arguments import checked
from sepcal.executors import Executors, stream
from sepcal.monte_carlo_results import MonteCarlo, check_truth
from sepcal.progress import show_progress
from sepcal.trials import (
    TogetherRun,
    TrialFunction,
    TrialRecord,
    TrialRun,
    TrialTogether,
    takes_index,
    unseal,
)

Progress = Callable[[int, int], None]

TOGETHER = 512  # trials that fill the lanes, and are done at once


@checked
def monte_carlo(
    trial: TrialFunction,
    trials: int | Iterable[int] = 1000,
    *,
    seed: int = 0,
    truth: Mapping[str, float] | None = None,
    executor: Executors = None,
    progress: bool | Literal["tqdm"] | Progress | None = None,
    batch: int | None = None,
    keep_fits: bool = False,
) -> MonteCarlo:
    """Runs a trial many times and gathers what came of it.

    Trial i has the generator default_rng(SeedSequence(seed, spawn_key=(i,))): the same numbers on
    any executor, with any number of workers and of trials. What a trial raises is kept as the
    `failure` of its record, and so is the death of its worker, in three attempts, and a result that
    can't be pickled where it has to be: from processes and clusters.

    Args:
        trial: trial(rng) or trial(rng, index), two arguments without defaults, with a
            numpy.random.Generator. It gives a Fit or Calibration; (fit, truth), the truth by
            parameter; a mapping of numbers and arrays by name; or anything else. Fits in it take
            threads=1: the executor's workers are the threads. On processes and clusters it must
            pickle, as must what it gives: define it with def at the top of a module.
        trials: How many, or their indices: range(1000, 2000) goes on where 1,000 ended.
        seed: The study's seed, not negative.
        truth: The parameters' true values by name, where the trials don't give them.
        executor: A concurrent.futures.Executor, left open; a function that makes one, as
            ProcessPoolExecutor does, which is also replaced where a dying worker breaks it; None:
            one trial after the other, here.
        progress: A bar on standard error, None: where that is a terminal, and in a notebook;
            "tqdm": that of tqdm.auto; or a function of the numbers of trials done and in all.
        batch: Trials a task; more than one where a trial takes less than some ten milliseconds.
            None: one, or 512 of a DesignTrial whose trials are fitted side by side.
        keep_fits: The records hold whole fits, with covariance and samples, instead of Estimates.

    Returns:
        A MonteCarlo, its records in order of their indices.

    Raises:
        Error: An argument is out of range; the truth names what the first trial that succeeds does
            not estimate; the executor broke or was shut down and can't be replaced; the trial
            can't be sent to it.
        KeyboardInterrupt: As ever; pending trials are cancelled, those that threads or an executor
            left open are at are waited for. stream_trials() lets one keep what was done.

    Example:
        >>> trial = sepcal.SimulatedTrial(sepcal.PitotStatic(), simulation={"rows": 100})
        >>> study = sepcal.monte_carlo(trial, 40, seed=1, progress=False)
        >>> study
        <sepcal.MonteCarlo 40 trials: 40 converged>
        >>> low, high = study.summary()["w_n"].coverage_limits
        >>> low < 0.95 < high
        True
    """
    indices = _to_indices(trials)
    records: list[TrialRecord] = []
    streamed = stream_trials(
        trial, indices, seed=seed, executor=executor, batch=batch, keep_fits=keep_fits
    )
    unchecked = truth
    with closing(streamed), _progress_of(progress) as report_progress:
        for record in streamed:
            if record.failure is None:
                check_truth(unchecked, [record.value])
                unchecked = None
            records.append(record)
            report_progress(len(records), len(indices))
    return MonteCarlo(records, truth)


@checked
def stream_trials(
    trial: TrialFunction,
    trials: int | Iterable[int] = 1000,
    *,
    seed: int = 0,
    executor: Executors = None,
    batch: int | None = None,
    keep_fits: bool = False,
) -> Generator[TrialRecord, None, None]:
    """Yields the records of monte_carlo() as the trials complete, in any order.

    MonteCarlo(records) makes a study of them, of those there are. Close it, or leave the loop, and
    pending trials are cancelled. Arguments and errors are those of monte_carlo().

    Example:
        >>> def trial(rng):
        ...     return {"mean": rng.normal(size=100).mean()}
        ...
        >>> means = [record.value["mean"] for record in sepcal.stream_trials(trial, 50)]
        >>> len(means), round(float(np.mean(means)), 1) + 0.0
        (50, 0.0)
    """
    indices = _to_indices(trials)
    if not isinstance(seed, Integral):
        raise Error(f"seed={seed!r} must be an integer")
    if seed < 0:
        raise Error(f"seed={seed} must not be negative")
    if not callable(trial):
        raise Error(f"the trial is a {type(trial).__name__}; give a function, trial(rng)")
    run = TrialRun(trial, takes_index(trial), seed, keep_fits)
    if isinstance(trial, TrialTogether) and trial.goes_together and not keep_fits:
        run = TogetherRun(trial, False, seed, keep_fits)
        batch = TOGETHER if batch is None else batch
    batch = 1 if batch is None else batch
    return _records(stream(run, indices, executor, batch=batch, lost=run.lost))


def _records(
    streamed: Generator[tuple[int, TrialRecord], None, None],
) -> Generator[TrialRecord, None, None]:
    try:
        for _, record in streamed:
            yield unseal(record)
    finally:
        streamed.close()


def _to_indices(trials: int | Iterable[int]) -> range | list[int]:
    """Raises Error for no trials, no integers, an index twice or a negative one."""
    if isinstance(trials, Integral):
        if trials < 1:
            raise Error(f"trials={trials} must be at least 1")
        return range(int(trials))
    rule = "a whole number or indices, 0 and above, each once: range(1000, 2000)"
    if not isinstance(trials, Iterable):
        raise Error(f"trials={trials!r} must be {rule}")
    indices = trials if isinstance(trials, range) else list(trials)
    is_whole = isinstance(indices, range) or all(isinstance(one, Integral) for one in indices)
    if not is_whole or not indices or min(indices) < 0 or len(set(indices)) < len(indices):
        raise Error(f"trials must be {rule}")
    return indices


@contextmanager
def _progress_of(progress: bool | Literal["tqdm"] | Progress | None) -> Iterator[Progress]:
    """The function to call after each trial."""
    if callable(progress):
        yield progress
        return
    with show_progress(shown=progress) as report_progress:
        yield lambda done, total: report_progress("", done / total)
