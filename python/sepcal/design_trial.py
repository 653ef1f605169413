# SPDX-License-Identifier: BSD-3-Clause
"""A trial ready made: one design, measured again with other noise, and fitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
from numpy.random import Generator

from sepcal._core import Error
from sepcal.arguments import checked
from sepcal.columns import Array, Columns, by_name
from sepcal.fit_options import FitOptions
from sepcal.fitting import fit
from sepcal.options import to_core
from sepcal.own_effect import given_effects, name_effects
from sepcal.own_state_model import AnyModel, as_model
from sepcal.results import Fit
from sepcal.trial_fits import fit_trials
from sepcal.trials import Estimates, in_order


@checked
class DesignTrial:
    """Measures a model at its truth, with normal noise, and fits it, for sepcal.monte_carlo().

        trial = sepcal.DesignTrial(
            sepcal.ScalarExample1(), {"eta": eta}, {"a": 0.3, "c": 1.0, "b": 0.2}, 0.1,
            samples=0, coloured_errors=False,
        )

    With options that fit_trials() takes side by side, as these, monte_carlo() hands it a batch of
    trials at once.

    Args:
        model: As fit() takes it.
        design: The inputs by name, each of shape (N,), as fit() takes them.
        truth: Every parameter's value by name.
        scatter: Standard deviation of each output's noise by name; one number for all of them. (The
            option `noise` is what a fit is told of it.)
        stirred: For a model with a state: noise that drives it, by the names of its table `noise`,
            as roots of spectral densities in the table's unit; those not named are none. (The
            option `process_noise` is what a fit is told of it.)
        **options: Keyword arguments of sepcal.fit(); threads is 1 by default.

    Raises:
        Error: The truth or the scatter lacks a name; as fit() refuses an option or the design.

    Example:
        >>> eta, truth = np.linspace(-3.0, 3.0, 40), {"a": 0.3, "c": 1.0, "b": 0.2}
        >>> trial = sepcal.DesignTrial(sepcal.ScalarExample1(), {"eta": eta}, truth, 0.1, samples=0)
        >>> study = sepcal.monte_carlo(trial, 40, seed=1, progress=False)
        >>> bool(np.all(np.abs(study.estimates.mean(axis=0) - [0.3, 1.0, 0.2]) < 0.05))
        True
    """

    def __init__(
        self,
        model: AnyModel,
        design: Columns,
        truth: Mapping[str, float],
        scatter: Mapping[str, float] | float,
        *,
        stirred: Mapping[str, float] | None = None,
        **options: Unpack[FitOptions],
    ) -> None:
        self.model = as_model(model)
        data = by_name(design)
        self.design = {name: data[name] for name in data}
        self.truth = dict(truth)
        self.scatter = (
            dict(scatter)
            if isinstance(scatter, Mapping)
            else dict.fromkeys(self.model.outputs, float(scatter))
        )
        for what, given, names in (
            ("truth", self.truth, self.model.parameters),
            ("scatter", self.scatter, self.model.outputs),
        ):
            if missing := [name for name in names if name not in given]:
                raise Error(f"the {what} lacks {', '.join(missing)}")
        self.stirred = dict(stirred or {})
        noises = self.model._core.process_noises
        if unknown := [name for name in self.stirred if name not in noises]:
            known = ", ".join(noises) or "none"
            raise Error(f"there is no process noise {', '.join(unknown)}; the model has: {known}")
        self.options: FitOptions = {**options, "threads": options.get("threads") or 1}
        to_core({**self.options, "effects": name_effects(given_effects(self.options))})
        self.exact = self._measure()

    def draw(self, rng: Generator) -> dict[str, Array]:
        """The trial's measurements: each output, (N,).

        Example:
            >>> wave, design = sepcal.ScalarExample1(), {"eta": np.linspace(-3.0, 3.0, 40)}
            >>> truth = {"a": 0.3, "c": 1.0, "b": 0.2}
            >>> trial = sepcal.DesignTrial(wave, design, truth, 0.1, samples=0)
            >>> trial.draw(np.random.default_rng(1))["z"].shape
            (40,)
        """
        if self.stirred:
            return self._stir(rng)
        return {
            name: exact + self.scatter[name] * rng.standard_normal(exact.size)
            for name, exact in self.exact.items()
        }

    def __call__(self, rng: Generator) -> tuple[Fit, dict[str, float]]:
        """The fit, and its truth."""
        return fit(self.model, {**self.design, **self.draw(rng)}, **self.options), self.truth

    def expect(self) -> Fit:
        """The fit of the measurements without noise, weighed by the noise that they would have.

        Its estimates are the truth, its standard errors the bound of Cramer and Rao: what the
        design would tell.

        Example:
            >>> wave, design = sepcal.ScalarExample1(), {"eta": np.linspace(-3.0, 3.0, 40)}
            >>> truth = {"a": 0.3, "c": 1.0, "b": 0.2}
            >>> one = sepcal.DesignTrial(wave, design, truth, 0.1).expect()
            >>> two = sepcal.DesignTrial(wave, design, truth, 0.2).expect()
            >>> round(two["b"].standard_error / one["b"].standard_error, 3)
            2.0
        """
        held = self.options.get("fix") or {}
        start = {name: self.truth[name] for name in self.model.nonlinear if name not in held}
        options: FitOptions = {
            **self.options,
            "noise": self.scatter,
            "start": start,
            "coloured_errors": False,
        }
        if self.stirred:
            options["process_noise"] = self.stirred
        return fit(self.model, {**self.design, **self.exact}, **options)

    @property
    def goes_together(self) -> bool:
        """Whether trials are fitted side by side."""
        options = self.options
        starts = options.get("start") or options.get("samples") == 0 or options.get("descents") == 1
        return (
            options.get("coloured_errors") is False
            and bool(starts)
            and not options.get("effects")
            and options.get("method") != "filter-error"
            and not self.model.runs_in_python
        )

    def together(self, rngs: Sequence[Generator]) -> list[Estimates | None]:
        """The record of each generator's trial that a study keeps; None where it fails.

        Example:
            >>> wave, design = sepcal.ScalarExample1(), {"eta": np.linspace(-3.0, 3.0, 40)}
            >>> truth = {"a": 0.3, "c": 1.0, "b": 0.2}
            >>> trial = sepcal.DesignTrial(wave, design, truth, 0.1, samples=0)
            >>> kept = trial.together([np.random.default_rng(seed) for seed in (1, 2)])
            >>> [one.names for one in kept]
            [('a', 'c', 'b'), ('a', 'c', 'b')]
        """
        drawn = [self.draw(rng) for rng in rngs]
        measurements = {name: np.stack([one[name] for one in drawn]) for name in self.exact}
        fits = fit_trials(self.model, self.design, measurements, **self.options)
        freedom = fits.rows * len(self.exact) - fits.estimated
        truth = in_order(self.truth, fits.names)
        return [
            None
            if trial in fits.failures
            else Estimates(
                fits.names,
                fits.estimates[trial],
                fits.standard_errors[trial],
                freedom,
                fits.statuses[trial],
                fits.messages.get(trial, ""),
                truth,
            )
            for trial in range(len(rngs))
        ]

    def _measure(self) -> dict[str, Array]:
        """Every output without noise, (N,)."""
        A, b = self.model.evaluate(self.design, self._of(self.model.nonlinear))
        z = A @ np.array([self.truth[name] for name in self.model.linear]) + b
        return dict(zip(self.model.outputs, z.T.copy(), strict=True))

    def _stir(self, rng: Generator) -> dict[str, Array]:
        model = self.model
        noises = model._core.process_noises
        sizes = [self.stirred.get(name, 0.0) for name in noises]
        sizes += [self.scatter[name] for name in model.outputs]
        columns = {
            name: np.asarray(self.design[name], float) for name in model._columns_in(self.design)
        }
        rows = next(iter(self.exact.values())).size
        normals = rng.standard_normal(rows * (2 * len(noises) + len(model.outputs)))
        z = model._core.draw(
            columns,
            np.array([self.truth[name] for name in model.parameters]),
            np.array(sizes),
            normals,
        )
        return dict(zip(model.outputs, z.T.copy(), strict=True))

    def _of(self, names: Sequence[str]) -> dict[str, float]:
        return {name: self.truth[name] for name in names}

    def __repr__(self) -> str:
        return f"DesignTrial({self.model!r}, truth={self.truth!r}, scatter={self.scatter!r})"
