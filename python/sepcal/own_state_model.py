# SPDX-License-Identifier: BSD-3-Clause
"""A model with a state of your own in Python: tables, rate() and at()."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.answers import Layout
from sepcal.arguments import checked
from sepcal.columns import Array
from sepcal.models import Model
from sepcal.own_model import (
    OwnModel,
    SeparableModel,
    Table,
    check_bounds_of,
    check_parts,
    source_of,
    to_rows,
)
from sepcal.states_module import states_module
from sepcal.trajectories import TrajectoryModel, TrajectoryOptions, complete, to_core_options
from sepcal.walk import Walk

Nested: TypeAlias = ArrayLike | Sequence["Nested"]  # of numbers and of (N,)

TABLES = ("inputs", "states", "outputs", "linear", "nonlinear")


class StateModel(Protocol):
    """The interface of a model with a state of your own, which sepcal.fit() takes.

        >>> class RollMode:
        ...     inputs = {"aileron": "rad"}
        ...     states = {"p": "rad/s"}
        ...     outputs = {"p_m": "rad/s"}
        ...     linear = {"b_p": "rad/s"}
        ...     nonlinear = {"Lp": ("1/s", -20, 0), "La": "1/s^2"}
        ...     linear_dynamic = ["La"]
        ...
        ...     def rate(self, x, u, p):
        ...         Lp, La = p
        ...         return [Lp * x[0] + La * u.aileron]
        ...
        ...     def at(self, x, u, p):
        ...         return [[1.0]], [x[0]]
        ...
        >>> t = np.linspace(0.0, 3.0, 100)
        >>> p = 0.3 * t - 0.15 * (1.0 - np.exp(-2.0 * t))
        >>> data = {"time": t, "aileron": 0.1 * t, "p_m": p}
        >>> fit = sepcal.fit(RollMode(), data, noise={"p_m": 0.01})
        >>> round(fit["Lp"].value, 3), round(fit["La"].value, 3)
        (-2.0, 6.0)


    x' = f(x, u, p) is rate(), z = A(x, u, p) xi1 + b(x, u, p) + v is at(). The tables are those of
    a SeparableModel, and `states`, whose bounds are those of the initial states. The data have
    columns by the names of inputs and outputs, and `time` [s].

    Both functions are asked at N points at once, each with an x, a u and a p of its own, so that
    all trajectories that differences need, and many samples, are walked side by side. The points
    are the last axis: x[0], u.aileron and p[0] have the shape (N,), and an answer is an array or
    nested lists of such and of plain numbers.

    A class may also have:
        linear_dynamic: Names of those in `nonlinear` that enter rate() and at() linearly beside a
            state that does: they and the initial states are linear parameters then. May be empty.
        start(u, z): x(0), n_x numbers, from the first row's inputs and outputs (NaN where missing):
            where initial states begin that are nonlinear. Without it they begin at zero.
        noise: A table of process noises, for smooth(): each of the state whose name it has, or what
            noise_input(x, u, p) says, G (n_x, n_w, N).
        acts_on: {linear parameter: [outputs]}, so that it leaves with them; others act on all.
        scales: Names of those in `linear` that multiply an output, for scales_about_start.
        discrete: True: next(x, u, p) gives x at the next row, in place of rate().
    """

    @property
    def inputs(self) -> Table:
        """u, n_u of them."""

    @property
    def states(self) -> Table:
        """x, n_x > 0."""

    @property
    def outputs(self) -> Table:
        """z, n_z > 0."""

    @property
    def linear(self) -> Table:
        """xi1, n_1."""

    @property
    def nonlinear(self) -> Table:
        """p, n_p, of the dynamics and of the outputs."""

    def at(self, x: Array, u: Any, p: Array, /) -> tuple[Nested, Nested]:  # noqa: ANN401
        """A and b at N points: a function of them alone, that keeps nothing.

        Args:
            x: The states, (n_x, N).
            u: A named tuple of the inputs, each of shape (N,).
            p: The nonlinear parameters, (n_p, N).

        Returns:
            A (n_z, n_1, N) and b (n_z, N). NaN where there is no answer; that point is avoided.
        """


@checked
class Trajectory(TrajectoryModel):
    """A StateModel laid along a record: how it is integrated, and what is measured.

    sepcal.fit() makes it where it is given a StateModel.

    Args:
        model: The model.
        **options: TrajectoryOptions.

    Raises:
        Error: A table, rate() or at() is missing, a table is of another form, empty, or has a name
            twice; an option names what the model doesn't have.

    Example:
        >>> class RollMode:
        ...     inputs, states, outputs = {"aileron": "rad"}, {"p": "rad/s"}, {"p_m": "rad/s"}
        ...     linear, nonlinear = {"b_p": "rad/s"}, {"Lp": ("1/s", -20, 0), "La": "1/s^2"}
        ...     linear_dynamic = ["La"]
        ...     def rate(self, x, u, p):
        ...         return [p[0] * x[0] + p[1] * u.aileron]
        ...     def at(self, x, u, p):
        ...         return [[1.0]], [x[0]]
        ...
        >>> sepcal.Trajectory(RollMode(), substeps=2).options["substeps"]
        2
    """

    runs_in_python = True

    def __init__(self, model: StateModel, **options: Unpack[TrajectoryOptions]) -> None:
        self.definition = model
        step = "next" if getattr(model, "discrete", False) else "rate"
        check_parts(model, (*TABLES, step, "at"), "model with a state", StateModel)
        rows = {table: to_rows(f"{self._owner}.{table}", getattr(model, table)) for table in TABLES}
        rows["noise"] = to_rows(f"{self._owner}.noise", getattr(model, "noise", {}))
        names = {table: tuple(name for name, *_ in rows[table]) for table in rows}
        _check_sizes(self._owner, names)
        check_bounds_of(self._owner, [*rows["inputs"], *rows["outputs"], *rows["noise"]])
        self.states = names["states"]
        whole = complete(options)
        facts = _Facts(self._owner, model, names)
        tables = states_module().StateTables(
            [rows[table] for table in (*TABLES, "noise")],
            facts.linear_dynamic,
            facts.linear_in_state,
            facts.scales,
            facts.acts.T.tolist(),
            facts.discrete,
        )
        walk = Walk(self._owner, model, facts.layout(rows["nonlinear"], whole))
        core = states_module().python_state_model(
            self._owner, tables, to_core_options(whole), walk, source_of(model)
        )
        super().__init__(core, whole)

    @property
    def _owner(self) -> str:
        return type(self.definition).__name__

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.definition, self._settings())

    def __repr__(self) -> str:
        settings = "".join(f", {name}={value!r}" for name, value in self._settings().items())
        return f"Trajectory({self.definition!r}{settings})"


AnyModel: TypeAlias = Model | SeparableModel | StateModel


def as_model(model: AnyModel) -> Model:
    """One of sepcal's own, or what makes one of a user's."""
    if isinstance(model, Model):
        return model
    return Trajectory(model) if hasattr(model, "states") else OwnModel(model)  # type: ignore[arg-type]


def own_among(model: Model) -> Model | None:
    """The model where a calibration's file can't make it again: it is no probe that ships."""
    return None if model._core.ships_a_probe else model


def to_own(model: AnyModel) -> Model:
    """As sepcal takes it. Raises Error for a probe, which a calibration's file names."""
    own = own_among(as_model(model))
    if own is None:
        raise _core.Error(
            f"{type(model).__name__} ships with sepcal; use its own program, or in Python leave "
            "model out"
        )
    return own


def _again(definition: StateModel, settings: TrajectoryOptions) -> Trajectory:
    return Trajectory(definition, **settings)


class _Facts:
    """A model's optional members, as places in its tables."""

    def __init__(self, owner: str, model: Any, names: Mapping[str, tuple[str, ...]]) -> None:  # noqa: ANN401
        self._names = names

        def find(what: str, given: Sequence[str], table: str) -> list[int]:
            if isinstance(given, str):
                raise _core.Error(f"{owner}.{what} is '{given}'; give a list of names")
            for name in given:
                if name not in names[table]:
                    there = ", ".join(names[table]) or "none"
                    raise _core.Error(
                        f"{owner}.{what}: the table {table} has no '{name}'; it has: {there}"
                    )
            return [names[table].index(name) for name in given]

        self.discrete = bool(getattr(model, "discrete", False))
        self.linear_in_state = hasattr(model, "linear_dynamic")
        self.linear_dynamic = find(
            "linear_dynamic", getattr(model, "linear_dynamic", ()), "nonlinear"
        )
        scales = find("scales", getattr(model, "scales", ()), "linear")
        self.scales = [k in scales for k in range(len(names["linear"]))]
        self.acts = np.ones((len(names["outputs"]), len(names["linear"])), dtype=bool)
        for parameter, outputs in getattr(model, "acts_on", {}).items():
            (k,) = find("acts_on", [parameter], "linear")
            self.acts[:, k] = False
            self.acts[find("acts_on", outputs, "outputs"), k] = True
        own = hasattr(model, "noise_input")
        self.noise = None if own else tuple(find("noise", names["noise"], "states"))

    def layout(self, nonlinear: Sequence[tuple[Any, ...]], options: dict[str, Any]) -> Layout:
        """The layout for these options."""
        bounds = np.array([row[2:] for row in nonlinear], dtype=np.float64).reshape(-1, 2)
        scales = [k for k, scale in enumerate(self.scales) if scale]
        return Layout(
            inputs=self._names["inputs"],
            outputs=self._names["outputs"],
            states=len(self._names["states"]),
            linear=len(self._names["linear"]),
            bounds=bounds.T,
            noises=len(self._names["noise"]),
            own_noise=self.noise,
            discrete=self.discrete,
            hold=options["inputs"] == "hold",
            substeps=options["substeps"],
            measured=tuple(
                i for i, name in enumerate(self._names["states"]) if name in options["measured"]
            ),
            acts=self.acts,
            from_start=tuple(scales) if options["scales_about_start"] else (),
            linear_dynamic=tuple(self.linear_dynamic) if options["separable"] else (),
            summed=self.linear_in_state and options["separable"],
        )


def _check_sizes(owner: str, names: Mapping[str, tuple[str, ...]]) -> None:
    """Raises Error where nothing moves or comes out."""
    if not names["states"]:
        raise _core.Error(f"{owner} has no states; a model without one is a sepcal.SeparableModel")
    if not names["outputs"]:
        raise _core.Error(f"{owner} has no outputs; name what is measured")
