# SPDX-License-Identifier: BSD-3-Clause
"""Estimators that the two-stage one is measured against; docs/paper.md has what came of it.

Who wants estimates calls sepcal.fit(): these have the weaknesses that their authors gave them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.arguments import checked
from sepcal.columns import Array, Columns, by_name, labels_in, take_columns
from sepcal.models import Model
from sepcal.options import Bounds, open_ends
from sepcal.own_model import OwnModel, Table, check_parts, to_rows
from sepcal.own_state_model import AnyModel, as_model

__all__ = [
    "AlonsoShusterFit",
    "ExampleInFiveStates",
    "ExampleInThreeStates",
    "HauptKasdinFit",
    "MagnetometerInNineStates",
    "SingleStageFit",
    "TwoStepProblem",
    "fit_alonso_shuster",
    "fit_haupt_kasdin",
    "fit_single_stage",
]


def __dir__() -> list[str]:
    """The public names, without what they are made of."""
    return __all__


Solver = Literal["levenberg_marquardt", "slsqp"]
SOLVERS = ("levenberg_marquardt", "slsqp")


class _Named:
    """Estimates that have names."""

    names: tuple[str, ...]
    estimates: Array

    def by_name(self) -> dict[str, float]:
        """The estimates."""
        return dict(zip(self.names, map(float, self.estimates), strict=True))


class SingleStageFit(_Named, _core.SingleStageFit):
    """All parameters at once by one nonlinear programme, from one start.

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> found = sepcal.rivals.fit_single_stage(
        ...     sepcal.ScalarExample1(), {"eta": eta, "z": z}, noise={"z": 0.1}
        ... )
        >>> round(found.by_name()["b"], 6)
        0.2
    """


class HauptKasdinFit(_Named, _core.HauptKasdinFit):
    """A two-step fit by a change of variables; `first` is its first step.

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> problem = sepcal.rivals.ExampleInThreeStates()
        >>> found = sepcal.rivals.fit_haupt_kasdin(problem, {"eta": eta, "z": z}, noise={"z": 0.1})
        >>> round(found.by_name()["b"], 6)
        0.2
    """


class AlonsoShusterFit(_Named, _core.AlonsoShusterFit):
    """TWOSTEP's magnetometer: the reading is C h + n, `shape` is C C', `bias` is n.

    Example:
        >>> ways = np.random.default_rng(1).normal(size=(60, 3))
        >>> field = 50.0 * ways / np.linalg.norm(ways, axis=1, keepdims=True)
        >>> data = dict(zip(("mx", "my", "mz"), (field + [1.0, 2.0, 3.0]).T, strict=True))
        >>> found = sepcal.rivals.fit_alonso_shuster(data, 50.0, noise=0.01, bias_alone=True)
        >>> np.round(found.bias, 3).tolist()
        [1.0, 2.0, 3.0]
    """


class TwoStepProblem(Protocol):
    """The interface of a two-step problem: states in which the measurements are linear.

        >>> class Tone:  # z = (1 + a) cos(eta + b) + c
        ...     inputs = {"eta": "rad"}
        ...     outputs = {"z": "1"}
        ...     states = {"x": "1", "y": "1", "level": "1"}
        ...     parameters = {"a": "1", "c": "1", "b": ("rad", -1.5, 1.5)}
        ...
        ...     def rows(self, u):
        ...         H = np.stack([np.cos(u.eta), -np.sin(u.eta), np.ones_like(u.eta)], axis=-1)
        ...         return H[:, np.newaxis, :]
        ...
        ...     def at(self, xi):
        ...         a, c, b = xi
        ...         return np.array([(1 + a) * np.cos(b), (1 + a) * np.sin(b), c])
        ...
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> data = {"eta": eta, "z": 1.3 * np.cos(eta + 0.2) + 1.0}
        >>> found = sepcal.rivals.fit_haupt_kasdin(Tone(), data, noise={"z": 0.1})
        >>> round(found.by_name()["b"], 6)
        0.2

    Tables as those of a SeparableModel.
    """

    @property
    def inputs(self) -> Table:
        """u, n_u > 0 of them."""

    @property
    def outputs(self) -> Table:
        """z, n_z > 0."""

    @property
    def states(self) -> Table:
        """y, p."""

    @property
    def parameters(self) -> Table:
        """xi, n, with bounds where they have some."""

    def rows(self, u: Any, /) -> ArrayLike | tuple[ArrayLike, ArrayLike]:  # noqa: ANN401
        """H (N, n_z, p) of z = H y + v, or H and b (N, n_z) of z = H y + b + v."""

    def at(self, xi: Array, /) -> ArrayLike:
        """Y = f(xi), (p,)."""


class BuiltInProblem:
    """A two-step problem that sepcal brings."""

    def __init__(self, core: _core.TwoStepProblem) -> None:
        self._core = core
        self._first = Model(core.first)

    def at(self, xi: ArrayLike) -> Array:
        """Y = f(xi), (p,)."""
        return np.asarray(self._core.at(np.asarray(xi, dtype=np.float64)))


class ExampleInFiveStates(BuiltInProblem):
    """The paper's first example in its five states (Eq. 28): H is of rank three.

    z = (1 + a) cos(eta + b) + c, y = [a cos b, a sin b, cos b, sin b, c]; parameters a, c, b.

    Example:
        >>> problem = sepcal.rivals.ExampleInFiveStates()
        >>> problem.at([0.5, 1.0, 0.0]).tolist()  # a cos b, a sin b, cos b, sin b, c
        [0.5, 0.0, 1.0, 0.0, 1.0]
    """

    def __init__(self) -> None:
        super().__init__(_core.example_in_five_states())


class ExampleInThreeStates(BuiltInProblem):
    """The same in the states that it has, [(1 + a) cos b, (1 + a) sin b, c].

    Example:
        >>> problem = sepcal.rivals.ExampleInThreeStates()
        >>> problem.at([0.5, 1.0, 0.0]).tolist()  # (1 + a) cos b, (1 + a) sin b, c
        [1.5, 0.0, 1.0]
    """

    def __init__(self) -> None:
        super().__init__(_core.example_in_three_states())


class MagnetometerInNineStates(BuiltInProblem):
    """A magnetometer of which only the field's strength is known, by the coefficients of a quadric.

    Parameters lambda, alpha and n, as Magnetometer(field_strength=...) has them. The rows are made
    of readings and have their noise, so that the estimate is not consistent.

    Args:
        field_strength: |h| [uT].

    Example:
        >>> problem = sepcal.rivals.MagnetometerInNineStates(50.0)
        >>> problem.at([0.0] * 9).shape
        (9,)
    """

    def __init__(self, field_strength: float) -> None:
        super().__init__(_core.magnetometer_in_nine_states(field_strength))


@checked
def fit_single_stage(
    model: AnyModel,
    data: Columns,
    start: Mapping[str, float] | None = None,
    *,
    bounds: Bounds | None = None,
    fix: Mapping[str, float] | None = None,
    noise: Mapping[str, float] | None = None,
    segments: str = "",
    solver: Solver = "levenberg_marquardt",
    cost: Literal["mean", "sum"] = "mean",
    noise_tolerance: float = 0.05,
    noise_iterations: int = 100,
    evaluations: int = 1000,
    threads: int = 0,
) -> SingleStageFit:
    """Fit all parameters at once from one start (Sun & Gebre-Egziabher, Sec. III.A).

    Args:
        model: As fit() takes it.
        data: Its inputs and outputs by name, each of shape (N,).
        start: Values of linear and nonlinear parameters by name; those not named begin at zero.
        bounds: (lower, upper) by name, None for an open side [the model's].
        fix: Parameters held at a value.
        noise: Standard deviation of every output; without it R is estimated (Eqs. 24-26).
        segments: Labels or spans of time [all].
        solver: Ceres' Levenberg-Marquardt, after which SLSQP goes on where steps that are clipped
            to the bounds end at no minimum; or NLopt's SLSQP, the nearest to MATLAB's fmincon.
        cost: The cost that SLSQP minimises: J over the number of rows, or J.
        noise_tolerance: R and the parameters alternate until every variance changes by less.
        noise_iterations: At most so many times.
        evaluations: The most evaluations of the cost in one minimisation.
        threads: 0: one a core.

    Raises:
        Error: Bad input or misuse: one line that names the culprit and the way out.

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> found = sepcal.rivals.fit_single_stage(
        ...     sepcal.ScalarExample1(), {"eta": eta, "z": z}, noise={"z": 0.1}
        ... )
        >>> {name: round(value, 6) for name, value in found.by_name().items()}
        {'a': 0.3, 'c': 1.0, 'b': 0.2}
    """
    _check_choice("solver", solver, SOLVERS)
    _check_choice("cost", cost, ("mean", "sum"))
    model = as_model(model)
    data = by_name(data)
    columns = _columns_of(model, data)
    labels = labels_in(data)
    return SingleStageFit(
        _core.fit_single_stage(
            model._core.along(columns, labels),
            columns,
            labels,
            dict(start or {}),
            bounds=open_ends(bounds),
            fix=dict(fix or {}),
            noise=dict(noise or {}),
            segments=segments,
            solver=solver,
            cost=cost,
            noise_tolerance=noise_tolerance,
            noise_iterations=noise_iterations,
            evaluations=evaluations,
            threads=1 if model.runs_in_python else threads,
        )
    )


@checked
def fit_haupt_kasdin(
    problem: TwoStepProblem | BuiltInProblem,
    data: Columns,
    start: Mapping[str, float] | None = None,
    *,
    bounds: Bounds | None = None,
    noise: Mapping[str, float] | None = None,
    segments: str = "",
    solver: Solver = "levenberg_marquardt",
    evaluations: int = 1000,
) -> HauptKasdinFit:
    """Fit in two steps: states linearly, then parameters to them (Eqs. 28-32).

    The second step is weighted by the first one's information H' R^-1 H, which exists where the
    inverse of P_y that Eq. 32 asks for does not.

    Args:
        problem: ExampleInFiveStates(), ..., or a TwoStepProblem of your own.
        data: Its inputs and outputs by name, each of shape (N,).
        start: Start of the second step, by name; parameters not named begin at zero.
        bounds: (lower, upper) of parameters by name, None for an open side [the problem's].
        noise: Standard deviation of every output; without it R is estimated.
        segments: Labels or spans of time [all].
        solver: Solver of the second step, as fit_single_stage() has it.
        evaluations: The most evaluations in the second step.

    Raises:
        Error: Bad input or misuse: one line that names the culprit and the way out.

    Example:
        >>> eta = np.linspace(-3.0, 3.0, 40)
        >>> z = 1.3 * np.cos(eta + 0.2) + 1.0
        >>> problem = sepcal.rivals.ExampleInThreeStates()
        >>> found = sepcal.rivals.fit_haupt_kasdin(problem, {"eta": eta, "z": z}, noise={"z": 0.1})
        >>> {name: round(value, 6) for name, value in found.by_name().items()}
        {'a': 0.3, 'c': 1.0, 'b': 0.2}
    """
    if isinstance(problem, BuiltInProblem):
        core, first = problem._core, problem._first
    else:
        core, first = _to_core(problem)
    _check_choice("solver", solver, SOLVERS)
    data = by_name(data)
    columns = _columns_of(first, data)
    return HauptKasdinFit(
        _core.fit_haupt_kasdin(
            core,
            columns,
            labels_in(data),
            dict(start or {}),
            bounds=open_ends(bounds),
            noise=dict(noise or {}),
            segments=segments,
            solver=solver,
            evaluations=evaluations,
            threads=1,
        )
    )


@checked
def fit_alonso_shuster(
    data: Columns,
    field_strength: float,
    *,
    noise: float,
    bias_alone: bool = False,
    reweightings: int = 1,
    mean_as_printed: bool = True,
    iterations: int = 100,
    segments: str = "",
) -> AlonsoShusterFit:
    """Fit a magnetometer of which only the field's strength is known by TWOSTEP.

    Alonso & Shuster, J. Astronaut. Sci. 50 (2002): pp. 433-451 of the bias alone, pp. 477-490
    complete.

    Args:
        data: mx, my, mz [uT] and, where the field changes along the record, field_change [uT], each
            of shape (N,).
        field_strength: |h| [uT].
        noise: Standard deviation of mx, my and mz [uT].
        bias_alone: Scale factors are 1, and there is no soft iron.
        reweightings: Weights are those of a perfect sensor, then so many times those of the
            estimate before.
        mean_as_printed: The mean of the squared readings' noise is -3 noise^2, as in print; False:
            +3 noise^2, which it is.
        iterations: The most iterations in the second step.
        segments: Labels or spans of time [all].

    Raises:
        Error: Columns that are missing, too few rows, a strength or noise that is not positive.

    Example:
        >>> ways = np.random.default_rng(1).normal(size=(60, 3))
        >>> field = 50.0 * ways / np.linalg.norm(ways, axis=1, keepdims=True)
        >>> data = dict(zip(("mx", "my", "mz"), (field + [1.0, 2.0, 3.0]).T, strict=True))
        >>> found = sepcal.rivals.fit_alonso_shuster(data, 50.0, noise=0.01)
        >>> np.round(found.bias, 3).tolist()
        [1.0, 2.0, 3.0]
    """
    data = by_name(data)
    wanted = ["mx", "my", "mz", *sorted({"field_change", "time"} & set(data))]
    columns = take_columns("fit_alonso_shuster()", data, wanted)
    return AlonsoShusterFit(
        _core.fit_alonso_shuster(
            columns,
            labels_in(data),
            field_strength,
            noise=noise,
            bias_alone=bias_alone,
            reweightings=reweightings,
            mean_as_printed=mean_as_printed,
            iterations=iterations,
            segments=segments,
        )
    )


class _FirstStep:
    """A problem's first step as a model, all of whose parameters are linear."""

    def __init__(self, problem: TwoStepProblem) -> None:
        self.inputs, self.outputs = problem.inputs, problem.outputs
        self.linear, self.nonlinear = problem.states, dict[str, str]()
        self._rows = problem.rows

    def at(self, u: Any, _: Array) -> tuple[ArrayLike, ArrayLike]:  # noqa: ANN401
        rows = self._rows(u)
        if isinstance(rows, tuple):
            return rows
        return rows, np.zeros(np.shape(rows)[:2])


def _to_core(problem: TwoStepProblem) -> tuple[_core.TwoStepProblem, Model]:
    """Raises Error for a table that is missing or of another form."""
    parts = ("inputs", "outputs", "states", "parameters", "rows", "at")
    check_parts(problem, parts, "two-step problem", TwoStepProblem, __name__)
    first = OwnModel(_FirstStep(problem))
    parameters = to_rows(f"{type(problem).__name__}.parameters", problem.parameters)
    return _core.TwoStepProblem(first._core, parameters, problem.at), first


def _columns_of(model: Model, data: Columns) -> dict[str, Array]:
    """Inputs, outputs, and the time where there is one."""
    wanted = [*model._columns_in(data), *model._measured_in(data), *({"time"} & set(data))]
    return take_columns(model._owner, data, dict.fromkeys(wanted))


def _check_choice(option: str, given: str, known: tuple[str, ...]) -> None:
    """Raises Error for another word."""
    if given not in known:
        raise _core.Error(f"{option}: {given!r} is unknown; known: {', '.join(known)}")
