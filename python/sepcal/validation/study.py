# SPDX-License-Identifier: BSD-3-Clause
"""sepcal.validate(): each trial fitted by sepcal and by SciPy, and how far the two are apart."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from sepcal._core import Error
from sepcal.arguments import checked
from sepcal.columns import Array, Columns
from sepcal.design_trial import DesignTrial
from sepcal.executors import Executors
from sepcal.fit_options import FitOptions
from sepcal.fitting import fit
from sepcal.options import open_ends
from sepcal.own_state_model import AnyModel
from sepcal.printing import aligned, page_of
from sepcal.quantiles import binomial_limits
from sepcal.running_trials import Progress, monte_carlo
from sepcal.validation.scipy_fit import fit_by_scipy, least_squares, residuals_of

PLAIN = ("effects", "loss", "prior", "method", "process_noise", "noise", "coloured_errors")
SAME = 1e-4  # of the sum of squares over the noise: a hundredth of a standard error
REACH = 1.959963984540054  # 95 % of a normal number lies within


@dataclass(frozen=True, eq=False)
class Pair:
    """One trial by both."""

    names: tuple[str, ...]
    by_sepcal: tuple[Array, Array]  # estimates and standard errors, (n,)
    by_scipy: tuple[Array, Array]
    squares: tuple[float, float]  # what each leaves, over the noise
    seconds: tuple[float, float]
    converged: bool


@dataclass(frozen=True, eq=False)
class Validation:
    """The result of validate(). `print(validation)` shows the table.

    T trials that both fitted, n parameters, linear, then nonlinear. sepcal begins with its stage
    one, SciPy at the truth.

    Example:
        >>> wave, design = sepcal.ScalarExample1(), {"eta": np.linspace(-3.0, 3.0, 40)}
        >>> truth = {"a": 0.3, "c": 1.0, "b": 0.2}
        >>> found = sepcal.validate(wave, design, truth=truth, scatter=0.01, trials=3)
        >>> found.lower, found.largest_difference < 1e-3
        ((0, 0), True)
    """

    model: str
    rows: int
    seed: int
    names: tuple[str, ...]
    truth: Array  # (n,)
    estimates: Array  # (T, n), sepcal's
    standard_errors: Array  # (T, n), sepcal's, at the known noise; NaN of what is held
    by_scipy: Array  # (T, n)
    by_scipy_errors: Array  # (T, n)
    squares: Array  # (T, 2), what sepcal and SciPy leave, over the noise
    seconds: Array  # (2,), in all
    converged: int  # of sepcal's fits
    failed: list[str]  # one line a trial that was not fitted

    @property
    def same_minimum(self) -> NDArray[np.bool_]:
        """(T,), whether what both leave differs by less than 1e-4."""
        same: NDArray[np.bool_] = np.abs(self.squares[:, 0] - self.squares[:, 1]) < SAME
        return same

    @property
    def lower(self) -> tuple[int, int]:
        """Trials in which sepcal's minimum is the lower one, and in which SciPy's is."""
        gap = self.squares[:, 1] - self.squares[:, 0]
        return int(np.sum(gap >= SAME)), int(np.sum(gap <= -SAME))

    @property
    def differences(self) -> Array:
        """(T', n), |sepcal - SciPy| in SciPy's standard errors, of the same minima."""
        same = self.same_minimum
        away: Array = np.abs(self.estimates - self.by_scipy)[same] / self.by_scipy_errors[same]
        return away

    @property
    def largest_difference(self) -> float:
        """Over all trials and parameters; NaN where no two ended in the same minimum."""
        known = self.differences[np.isfinite(self.differences)]
        return float(known.max()) if known.size else np.nan

    def to_dict(self) -> dict[str, Any]:
        """The table, and what stands about it.

        Example:
            >>> wave, design = sepcal.ScalarExample1(), {"eta": np.linspace(-3.0, 3.0, 40)}
            >>> truth = {"a": 0.3, "c": 1.0, "b": 0.2}
            >>> found = sepcal.validate(wave, design, truth=truth, scatter=0.01, trials=3)
            >>> found.to_dict()["trials"]
            3
        """
        above, below = self.lower
        return {
            "model": self.model,
            "rows": self.rows,
            "seed": self.seed,
            "trials": len(self.estimates),
            "failed": self.failed,
            "converged": self.converged,
            "same_minimum": int(self.same_minimum.sum()),
            "sepcal_lower": above,
            "scipy_lower": below,
            "largest_difference": _or_none(self.largest_difference),
            "seconds": {"sepcal": self.seconds[0], "scipy": self.seconds[1]},
            "parameters": [_or_none(row) for row in self._rows()],
        }

    def to_json(self) -> str:
        """The same as JSON; null where a number is undefined.

        Example:
            >>> wave, design = sepcal.ScalarExample1(), {"eta": np.linspace(-3.0, 3.0, 40)}
            >>> truth = {"a": 0.3, "c": 1.0, "b": 0.2}
            >>> found = sepcal.validate(wave, design, truth=truth, scatter=0.01, trials=3)
            >>> _ = (folder / "validation.json").write_text(found.to_json())
        """
        return json.dumps(self.to_dict(), indent=2)

    def _rows(self) -> list[dict[str, Any]]:
        errors = self.estimates - self.truth
        differences = self.differences
        same = self.same_minimum
        rows = []
        for i, name in enumerate(self.names):
            if not np.isfinite(self.standard_errors[:, i]).any():
                continue  # held
            inside = np.abs(errors[:, i]) <= REACH * self.standard_errors[:, i]
            ratio = self.standard_errors[same, i] / self.by_scipy_errors[same, i]
            rows.append(
                {
                    "name": name,
                    "truth": float(self.truth[i]),
                    "bias": float(errors[:, i].mean()),
                    "bias_error": float(errors[:, i].std(ddof=1) / np.sqrt(len(errors))),
                    "coverage": float(inside.mean()),
                    "coverage_limits": binomial_limits(int(inside.sum()), inside.size),
                    "largest_difference": _largest(differences[:, i]),
                    "largest_error_difference": _largest(np.abs(ratio - 1.0)),
                }
            )
        return rows

    def __str__(self) -> str:
        head = ("parameter", "truth", "bias", "+-", "95 % covers", "limits", "apart", "errors")
        lines = [
            f"{self.model}: {len(self.estimates)} trials of {self.rows} rows, seed {self.seed}",
            *aligned([head, *map(_cells, self._rows())]),
            "apart: the largest |sepcal - SciPy| in standard errors; errors: the largest "
            "difference of the standard errors themselves, a share of them",
            self._verdict(),
        ]
        return page_of([*lines, *(f"not fitted: {reason}" for reason in self.failed[:3])])

    def _verdict(self) -> str:
        above, below = self.lower
        count = len(self.estimates)
        same = int(self.same_minimum.sum())
        told = f"the same minimum in {same} of {count}"
        if same:
            told += f", there {self.largest_difference:.1g} standard errors apart at most"
        if above or below:
            told += f"; sepcal's is lower in {above}, SciPy's in {below}"
        return f"{told}; sepcal {self.seconds[0]:.3g} s, SciPy {self.seconds[1]:.3g} s"

    def __repr__(self) -> str:
        return f"<sepcal.Validation of {self.model}: {self._verdict()}>"


class PairedTrial(DesignTrial):
    """A trial that both fit."""

    def __call__(self, rng: Generator) -> Pair:  # type: ignore[override]
        """Draws the measurements, and fits them."""
        data = {**self.design, **self.draw(rng)}
        begun = time.perf_counter()
        own = fit(self.model, data, **self.options)
        between = time.perf_counter()
        held = {name: one.value for name, one in own.parameters.items() if one.fixed}
        model = self.model.at_noise(self.scatter)
        bounds = {**self.model.bounds, **open_ends(self.options.get("bounds"))}
        other = fit_by_scipy(model, data, self.scatter, self.truth, held, bounds)
        ended = time.perf_counter()
        left = residuals_of(
            model, data, self.scatter, {name: own[name].value for name in own.names}
        )
        errors = np.array([one.standard_error for one in own.parameters.values()])
        return Pair(
            own.names,
            (own.values, errors),
            (other.values, other.standard_errors),
            (float(left @ left), other.squares),
            (between - begun, ended - between),
            own.success,
        )

    @property
    def goes_together(self) -> bool:
        """Each by itself: that is what is timed."""
        return False


@checked
def validate(
    model: AnyModel,
    design: Columns,
    *,
    truth: Mapping[str, float],
    scatter: Mapping[str, float] | float,
    trials: int = 100,
    seed: int = 0,
    executor: Executors = None,
    progress: bool | Progress | None = None,
    options: FitOptions | None = None,
) -> Validation:
    """Fits simulated records of a model by sepcal and by SciPy's least_squares.

    Each trial measures the model at its truth, with white noise of known size, and is fitted by
    both at that noise: sepcal by its two stages, SciPy from the truth, by differences. What differs
    is the solver, not the model. `python -m sepcal validate` does it for the models that ship.

    Args:
        model: As fit() takes it, of sepcal or your own.
        design: The inputs by name, each of shape (N,), and "time" [s] as fit() takes it; of a model
            with a state one segment.
        truth: A value of every parameter.
        scatter: Standard deviation of every output's noise, by name, or one for all.
        trials: How many.
        seed: The study's seed, as monte_carlo() has it.
        executor: The same.
        progress: The same.
        options: FitOptions of sepcal's fits, as bounds, fixed or samples; not those that make it
            another problem, as a loss or a prior.

    Raises:
        Error: SciPy is missing; an option of another problem; as fit() refuses the design; every
            trial failed, with the reason.

    Example:
        >>> wave, design = sepcal.ScalarExample1(), {"eta": np.linspace(-3.0, 3.0, 40)}
        >>> truth = {"a": 0.3, "c": 1.0, "b": 0.2}
        >>> found = sepcal.validate(wave, design, truth=truth, scatter=0.01, trials=3)
        >>> bool(found.same_minimum.all())
        True
    """
    least_squares()
    given: dict[str, Any] = {**(options or {})}
    if refused := [name for name in PLAIN if given.get(name) is not None]:
        raise Error(
            f"validate() compares least squares at a known noise; leave out {', '.join(refused)}"
        )
    trial = PairedTrial(model, design, truth, scatter, **given)
    trial.options |= {"noise": trial.scatter, "coloured_errors": False}
    study = monte_carlo(trial, trials, seed=seed, executor=executor, progress=progress)
    pairs: list[Pair] = study.values
    failed = [
        f"trial {one.index}: {' '.join(one.failure.message.split())}"
        for one in study.failed
        if one.failure is not None
    ]
    if not pairs:
        raise Error(f"no trial was fitted; {failed[0]}")
    names = pairs[0].names
    return Validation(
        model=getattr(trial.model, "name", trial.model._owner),
        rows=next(iter(trial.exact.values())).size,
        seed=seed,
        names=names,
        truth=np.array([trial.truth[name] for name in names]),
        estimates=np.array([pair.by_sepcal[0] for pair in pairs]),
        standard_errors=np.array([pair.by_sepcal[1] for pair in pairs]),
        by_scipy=np.array([pair.by_scipy[0] for pair in pairs]),
        by_scipy_errors=np.array([pair.by_scipy[1] for pair in pairs]),
        squares=np.array([pair.squares for pair in pairs]),
        seconds=np.array([pair.seconds for pair in pairs]).sum(axis=0),
        converged=sum(pair.converged for pair in pairs),
        failed=failed,
    )


def _largest(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else np.nan


def _or_none(value: Any) -> Any:  # noqa: ANN401
    """With None for what is no number, all the way down."""
    if isinstance(value, dict):
        return {name: _or_none(one) for name, one in value.items()}
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    low, high = row["coverage_limits"]
    return (
        row["name"],
        f"{row['truth']:.6g}",
        f"{row['bias']:.3g}",
        f"{row['bias_error']:.2g}",
        f"{100 * row['coverage']:.1f} %",
        f"{100 * low:.1f}-{100 * high:.1f} %",
        _short(row["largest_difference"]),
        _short(row["largest_error_difference"]),
    )


def _short(value: float) -> str:
    return f"{value:.1g}" if np.isfinite(value) else "-"
