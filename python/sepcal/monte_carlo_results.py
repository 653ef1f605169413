# SPDX-License-Identifier: BSD-3-Clause
"""Results of a Monte Carlo study: its records, and how the estimates lie about the truth."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import Any, Literal

import numpy as np

from sepcal._core import Error
from sepcal.arguments import checked, shown
from sepcal.columns import Array
from sepcal.plots import Backend, Theme
from sepcal.printing import aligned, page_of
from sepcal.quantiles import binomial_limits, student_quantile
from sepcal.tables import table_of
from sepcal.trials import Estimates, TrialRecord, in_order, without_bulk

MOST_FAILURES_SHOWN = 3
FAR = 6.0  # standard errors from the truth: not by chance


@dataclass(frozen=True)
class ParameterStudy:
    """How the estimates of one parameter lie about its truth; NaN where that isn't known.

    Example:
        >>> def trial(rng):
        ...     return {"mean": rng.normal(2.0, 0.1, 25).mean()}
        ...
        >>> study = sepcal.monte_carlo(trial, 40, truth={"mean": 2.0}, progress=False)
        >>> mean = study.summary()["mean"]
        >>> mean.trials, mean.truth, round(mean.scatter, 2)  # 0.1 over the root of 25
        (40, 2.0, 0.02)
    """

    name: str
    trials: int  # with an estimate, and with a standard error where there are any
    mean: float
    truth: float  # its mean, where it differs from trial to trial
    bias: float  # mean of estimate - truth
    bias_error: float  # standard error of `bias`
    scatter: float  # standard deviation of estimate - truth; of the estimates without a truth
    rms_error: float
    standard_error: float  # root mean square of those that the fits state
    coverage: float  # share of intervals that hold the truth
    coverage_limits: tuple[float, float]  # of that share, Clopper & Pearson, 95 %


@checked
class MonteCarlo:
    """A study. `print(study)` shows the table.

    Args:
        records: Records of stream_trials(), in any order.
        truth: The parameters' true values by name, where the trials didn't give them.

    Attributes:
        trials: The records in order of their indices.

    Raises:
        Error: An index is there twice; the truth names what no trial estimates. Later: the trials
            gave no estimates, or of other parameters.

    Example:
        >>> study = sepcal.monte_carlo(lambda rng: {"mean": rng.normal(2.0, size=100).mean()}, 50,
        ...                            truth={"mean": 2.0}, progress=False)
        >>> study.summary()["mean"].trials, abs(study.summary()["mean"].bias) < 0.1
        (50, True)
    """

    def __init__(
        self, records: Iterable[TrialRecord], truth: Mapping[str, float] | None = None
    ) -> None:
        self.trials = tuple(sorted(records, key=lambda record: record.index))
        self._truth = truth
        indices = [record.index for record in self.trials]
        if len(set(indices)) < len(indices):
            raise Error("two records have the same index; give each trial once")
        check_truth(truth, self.values)

    @property
    def failed(self) -> list[TrialRecord]:
        """Trials that raised an exception or took their worker with them."""
        return [record for record in self.trials if record.failure is not None]

    @property
    def values(self) -> list[Any]:
        """The results of the T trials that did not fail, a Fit as Estimates, in order."""
        return [record.value for record in self.trials if record.failure is None]

    @cached_property
    def fits(self) -> list[Estimates]:
        """The T trials' estimates. Raises Error where they gave none, or of other parameters."""
        fits = [_to_estimates(value) for value in self.values]
        if fits and any(fit.names != fits[0].names for fit in fits):
            raise Error("the trials estimate different parameters; look at their values one by one")
        return fits

    @property
    def names(self) -> tuple[str, ...]:
        """The n parameters."""
        return self.fits[0].names if self.fits else ()

    @property
    def estimates(self) -> Array:
        """Shape (T, n)."""
        return self._stack([fit.values for fit in self.fits])

    @property
    def standard_errors(self) -> Array:
        """Shape (T, n); NaN where undefined."""
        return self._stack([fit.standard_errors for fit in self.fits])

    @property
    def truth(self) -> Array:
        """Shape (T, n); NaN where it isn't known."""
        given = in_order(self._truth or {}, self.names)
        return self._stack([given if fit.truth is None else fit.truth for fit in self.fits])

    @property
    def statuses(self) -> list[str]:
        """The statuses of the T fits."""
        return [fit.status for fit in self.fits]

    @property
    def far(self) -> list[int]:
        """Indices of the trials with an estimate over six of its standard errors from the truth.

        They ended in another minimum, or their standard errors are too small.
        """
        off = np.abs(self.estimates - self.truth) > FAR * self.standard_errors
        kept = [record.index for record in self.trials if record.failure is None]
        return [kept[row] for row in np.flatnonzero(off.any(axis=1))]

    def __getitem__(self, name: str) -> Array:
        """The T trials' results under a name: (T,) numbers, or (T, ...) of arrays in a mapping.

        Raises:
            Error: There is no such name, or its arrays have different shapes.
        """
        if not isinstance(name, str):
            raise Error(f"{shown(name)} is no name; give a text")
        if self.values and all(isinstance(value, Mapping) for value in self.values):
            columns = [value.get(name) for value in self.values]
            if all(column is not None for column in columns):
                try:
                    return np.stack([np.asarray(column) for column in columns])
                except ValueError as error:
                    raise Error(f"'{name}' has another shape from trial to trial") from error
        elif name in self.names:
            return self.estimates[:, self.names.index(name)]
        raise Error(f"there is no '{name}' in every trial; there are: {', '.join(self.names)}")

    def summary(self, level: float = 0.95) -> dict[str, ParameterStudy]:
        """The statistics of every parameter, over all fits, converged or not.

        Args:
            level: Level of the intervals whose coverage is counted: estimate -+ Student's quantile
                of the fit's degrees of freedom times its standard error.

        Raises:
            Error: level is not between 0 and 1; the trials gave no estimates.

        Example:
            >>> def trial(rng):
            ...     return {"mean": rng.normal(2.0, 0.1, 25).mean()}
            ...
            >>> study = sepcal.monte_carlo(trial, 40, truth={"mean": 2.0}, progress=False)
            >>> list(study.summary())
            ['mean']
        """
        if not 0.0 < level < 1.0:
            raise Error(f"level={level} must be between 0 and 1")
        quantiles = np.array(
            [student_quantile(0.5 + 0.5 * level, fit.degrees_of_freedom) for fit in self.fits]
        )
        estimates, errors, truth = self.estimates, self.standard_errors, self.truth
        return {
            name: _study(name, estimates[:, i], errors[:, i], truth[:, i], quantiles)
            for i, name in enumerate(self.names)
        }

    def plot(
        self,
        what: Literal["errors", "estimates"] | str | None = None,
        *,
        backend: Backend = "plotly",
        theme: Theme = "light",
    ) -> Any:  # noqa: ANN401
        """Draws how the estimates of every parameter lie about the truth.

        Args:
            what: "errors", in standard errors, before the normal distribution; "estimates" as they
                are [the errors where the truth is known].
            backend: "plotly", or "matplotlib".
            theme: "light" or "dark".

        Returns:
            A plotly.graph_objects.Figure, or a matplotlib.figure.Figure.

        Raises:
            Error: Another word for one of these; no estimates, or errors without a truth; the
                library is not installed.

        Example:
            >>> def trial(rng):
            ...     return {"mean": rng.normal(2.0, 0.1, 25).mean()}
            ...
            >>> study = sepcal.monte_carlo(trial, 40, truth={"mean": 2.0}, progress=False)
            >>> drawn = study.plot("estimates", backend="matplotlib")
        """
        from sepcal.plotting import as_figure, choose
        from sepcal.plotting.of_studies import picture_study

        if what is not None:
            choose(what, ("errors", "estimates"))
        return as_figure(picture_study(self, what), backend, theme, columns=3)

    def _stack(self, rows: list[Array]) -> Array:
        return np.array(rows, dtype=np.float64).reshape(len(rows), len(self.names))

    def __len__(self) -> int:
        return len(self.trials)

    def __str__(self) -> str:
        lines = [_headline(self)]
        try:
            if far := self.far:
                lines.append(
                    f"{len(far)} of {len(self.fits)} lie over {FAR:g} standard errors from the "
                    "truth: another minimum, or errors that are too small; `far` lists them"
                )
            lines += _table(self.summary())
        except Error as error:
            lines.append(str(error))
        unsaid = self.failed[1:] if len(self.failed) == len(self) else self.failed
        shown = unsaid[:MOST_FAILURES_SHOWN]
        lines += [f"trial {record.index} failed: {_reason(record)}" for record in shown]
        if more := len(unsaid) - len(shown):
            lines.append(f"and {more} more failed; `failed` has the record of each")
        return page_of(lines)

    def _repr_html_(self) -> str:
        """A small table, for notebooks."""
        columns = ("name", "truth", "bias", "rms_error", "standard_error", "coverage", "trials")
        try:
            rows = [vars(one) for one in self.summary().values()]
        except Error:
            rows = []
        return table_of(_headline(self), columns, rows)

    def __repr__(self) -> str:
        return f"<sepcal.MonteCarlo {_headline(self)}>"


def check_truth(truth: Mapping[str, float] | None, values: Sequence[Any]) -> None:
    """Raises Error for a name in the truth that no trial estimates; passes where none estimates."""
    try:
        known = {name: 0 for value in values for name in _to_estimates(value).names if truth}
    except Error:
        return
    for name in truth or ():
        if known and name not in known:
            there = ", ".join(known)
            raise Error(f"truth: no trial estimates '{name}'; they estimate: {there}")


def _reason(record: TrialRecord) -> str:
    """Why the trial failed, in one line."""
    assert record.failure is not None
    return f"{record.failure.type}: {' '.join(record.failure.message.split())}"


def _to_estimates(value: object) -> Estimates:
    """Estimates of a fit; a number, or the numbers in a mapping, without standard errors."""
    value = without_bulk(value)
    if isinstance(value, Estimates):
        return value
    numbers = value if isinstance(value, Mapping) else {"value": value}
    numbers = {name: one for name, one in numbers.items() if isinstance(one, Real)}
    if not numbers:
        raise Error(
            f"a trial gave {type(value).__name__}, no estimates; `values` has what the trials gave"
        )
    values = np.array(list(numbers.values()), dtype=np.float64)
    return Estimates(tuple(numbers), values, np.full(values.size, np.nan), 0, "", "")


def _study(
    name: str, estimates: Array, standard_errors: Array, truth: Array, quantiles: Array
) -> ParameterStudy:
    """Summarises the T trials; arrays (T,)."""
    has_error = np.isfinite(standard_errors)
    used = np.isfinite(estimates) & (has_error if has_error.any() else True)
    count = int(np.count_nonzero(used))
    estimates, standard_errors, truth = estimates[used], standard_errors[used], truth[used]
    errors = estimates - truth
    is_known = count > 0 and bool(np.isfinite(errors).all())
    spread = errors if is_known else estimates
    scatter = float(np.std(spread, ddof=1)) if count > 1 else np.nan
    inside = np.abs(errors) <= quantiles[used] * standard_errors
    is_covered = is_known and bool(has_error.any())
    hits = int(np.count_nonzero(inside))
    return ParameterStudy(
        name=name,
        trials=count,
        mean=_mean(estimates),
        truth=_mean(truth),
        bias=_mean(errors),
        bias_error=scatter / np.sqrt(count) if is_known else np.nan,
        scatter=scatter,
        rms_error=float(np.sqrt(_mean(errors**2))),
        standard_error=float(np.sqrt(_mean(standard_errors**2))),
        coverage=hits / count if is_covered else np.nan,
        coverage_limits=binomial_limits(hits, count) if is_covered else (np.nan, np.nan),
    )


def _mean(values: Array) -> float:
    return float(np.mean(values)) if values.size else np.nan


def _headline(study: MonteCarlo) -> str:
    if study.failed and len(study.failed) == len(study):
        count = f"all {len(study)} trials" if len(study) != 1 else "the only trial"
        return f"{count} failed; trial {study.failed[0].index}: {_reason(study.failed[0])}"
    words = [f"{len(study)} trials" if len(study) != 1 else "1 trial"]
    kept = [without_bulk(value) for value in study.values]
    statuses = Counter(value.status for value in kept if isinstance(value, Estimates))
    words += [f"{count} {status}" for status, count in statuses.items()]
    if study.failed:
        words.append(f"{len(study.failed)} failed")
    return f"{words[0]}: {', '.join(words[1:])}" if words[1:] else words[0]


def _table(summary: dict[str, ParameterStudy]) -> list[str]:
    """With what the truth allows to say, where it is known of any parameter."""
    if not summary:
        return []
    is_known = any(np.isfinite(one.bias) for one in summary.values())
    columns = _about_the_truth if is_known else _about_the_mean
    rows = [["parameter", *columns(None)], *([one.name, *columns(one)] for one in summary.values())]
    return aligned(rows)


def _about_the_truth(one: ParameterStudy | None) -> list[str]:
    """Cells of a row; the headings of None."""
    if one is None:
        return ["truth", "bias", "+-", "rms error", "std. error", "95 % covers", "limits", "of"]
    low, high = one.coverage_limits
    return [
        _number(one.truth, 6),
        _number(one.bias, 3),
        _number(one.bias_error, 2),
        _number(one.rms_error, 3),
        _number(one.standard_error, 3),
        f"{100 * one.coverage:.1f} %" if np.isfinite(one.coverage) else "-",
        f"{100 * low:.1f}-{100 * high:.1f} %" if np.isfinite(low) else "-",
        str(one.trials),
    ]


def _about_the_mean(one: ParameterStudy | None) -> list[str]:
    """The same where no truth is known."""
    if one is None:
        return ["mean", "scatter", "std. error", "of"]
    return [
        _number(one.mean, 6),
        _number(one.scatter, 3),
        _number(one.standard_error, 3),
        str(one.trials),
    ]


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}g}" if np.isfinite(value) else "-"
