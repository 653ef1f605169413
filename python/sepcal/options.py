# SPDX-License-Identifier: BSD-3-Clause
"""The keyword arguments of fit(). Their defaults are the engine's own and stand nowhere else."""

import inspect
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict, TypeVar

from sepcal import _core
from sepcal.own_effect import Effect

SHAPES = {
    "map": "{header: column}",
    "ignore": "[column, ...]",
    "drop_repeats": "[column, ...]",
    "bounds": "{name: (lower, upper)}",
    "prior": "{name: (mean, standard deviation)}",
    "sampling_distribution": "{name: (mean, standard deviation)}",
}
# Of the apps' --effect, ...
APP_NAMES = {"effect": "effects", "from": "from_time", "to": "to_time"}
# Options that choose of a flight's columns and rows.
LOG_CHOICE = (
    "map",
    "ignore",
    "drop_invalid",
    "drop_repeats",
    "where",
    "from_time",
    "to_time",
)


class FitOptions(TypedDict, total=False):
    """Every choice of a fit; None, like leaving it out, means the default, given in brackets.

    Attributes:
        effects: Physical effects that join the model, by name: `port[driver]`, those that
            sepcal.effects() lists, and Effects of your own [none]. Of a model that is no probe,
            each linear parameter and each input is a port, and its component is called s:
            "k[temp_degc]" adds the parameter k[temp_degc].s.
        bounds: (lower, upper) of parameters by name, in their units, None for an open side, instead
            of the model's [the model's].
        fix: Parameters held at a value and not estimated [none].
        noise: Noise standard deviation of every output; without it R is estimated, Eqs. 24-26.
        prior: (mean, standard deviation) of parameters, linear or nonlinear: a normal prior, which
            counts as one more measurement of each [none].
        search: How stage one looks for minima: among samples, or by NLopt's global search, which
            asks for the profile cost at most `samples` times, "global" ["sampling"].
        sampling_distribution: (mean, standard deviation) of nonlinear parameters: their samples are
            normal, cut at the bounds; it has no part in the fit itself [uniform].
        screens: Evaluates Eqs. 17 and 18 at every sample, and uses only those with ratios of at
            most t_1 and t_2 within l_2, and, with convex, positive second derivatives: any of
            {"t_1", "t_2", "l_2", "convex"} [not evaluated].
        stage_one_segments: What stage one uses, "wind_circle_1,510.9:530": labels, or spans of time
            in s [all].
        stage_two_segments: The same of stage two [all].
        samples: Samples of xi2 in stage one [500]; 0: none.
        sampling: Independent draws or a shifted Halton sequence ["uniform"].
        start: Where stage two starts, by nonlinear parameter; then nothing is sampled. Those not
            named start from the middle of their bounds, or from zero without [sampling finds it].
        seed: The same seed gives the same result, on any number of threads [0].
        second_stage: Over all parameters, over xi2 with xi1 solved inside, or as stage one finds a
            unique minimum or not (Step 5); from a start the latter, and the former if it fails
            ["auto"].
        jacobian: Of a projected stage two: Kaufman's, or Golub and Pereyra's, "golub_pereyra"
            ["kaufman"].
        method: Of a model with a state: "output-error", or "filter-error", where noise drives the
            states too and its size is estimated ["output-error"].
        hessian: Of filter error's standard errors and last steps: "fisher", the expected one, or
            "observed", where that is positive definite ["fisher"].
        loss: What a whitened residual costs: "squares", or "huber" or "cauchy", which forgive
            outliers and make stage two joint ["squares"].
        loss_width: Where the loss begins to forgive, in standard deviations of the noise [1.345 for
            huber, 2.385 for cauchy].
        noise_tolerance: R and the parameters alternate until every relative change of R is below
            this, Eq. 26 [1e-10; the paper's is 0.05].
        noise_iterations: At most so many alternations [100].
        iterations: Of one nonlinear minimisation [200].
        descents: Stage one descends from at most so many samples to tell minima apart [8].
        coloured_errors: Standard errors allow for residuals that are not white; without, they equal
            the white ones [True].
        process_noise: Of a model with a state: noise that drives it, by the names of its table
            `noise`, as roots of spectral densities in the table's unit (in discrete time: standard
            deviations a row). By output error it has no part in the fit, and standard errors allow
            for it [none; of a FlightPath the white noise of the inertial unit's readings]; by
            filter error these are held [all are estimated].
        threads: The caller's included; 0: one a core [0]. The result does not depend on it.
        free: For flights: parameters freed that the probe holds by default [none].
        map: For flights: headers as sepcal reads them, and the log's own for them,
            {"airspeed_kt": "TAS"} [none].
        ignore: For flights: columns that are as if they were not there [none].
        drop_invalid: For flights: drop rows with a bad cell instead of refusing them [False].
        drop_repeats: For flights: slow columns, e.g. ["airspeed"]; rows between their samples,
            which the log holds or interpolates, are dropped; of several the slowest counts
            [none].
        where: For flights: only rows in which this holds, "airspeed > 20 and abs(roll_deg) < 45"
            [all].
        from_time: For flights: only rows from this time on [s]; not on another flight [all].
        to_time: The same up to this time [all].
    """

    effects: Sequence[str | Effect] | None
    bounds: Mapping[str, tuple[float | None, float | None]] | None
    fix: Mapping[str, float] | None
    noise: Mapping[str, float] | None
    prior: Mapping[str, tuple[float, float]] | None
    search: Literal["sampling", "global"] | str | None
    screens: Mapping[str, float | bool] | None
    sampling_distribution: Mapping[str, tuple[float, float]] | None
    stage_one_segments: str | None
    stage_two_segments: str | None
    samples: int | None
    sampling: Literal["uniform", "low_discrepancy"] | None
    start: Mapping[str, float] | None
    seed: int | None
    second_stage: Literal["auto", "joint", "projected"] | str | None
    jacobian: Literal["kaufman", "golub_pereyra"] | str | None
    method: Literal["output-error", "filter-error"] | str | None
    hessian: Literal["fisher", "observed"] | str | None
    loss: Literal["squares", "huber", "cauchy"] | str | None
    loss_width: float | None
    noise_tolerance: float | None
    noise_iterations: int | None
    iterations: int | None
    descents: int | None
    coloured_errors: bool | None
    process_noise: Mapping[str, float] | None
    threads: int | None
    free: Sequence[str] | None
    map: Mapping[str, str] | None
    ignore: Sequence[str] | None
    drop_invalid: bool | None
    drop_repeats: Sequence[str] | None
    where: str | None
    from_time: float | None
    to_time: float | None


Bounds: TypeAlias = Mapping[str, tuple[float | None, float | None]]
Function = TypeVar("Function", bound=Callable[..., Any])


def spelled_out(*, without: Collection[str] = ()) -> Callable[[Function], Function]:
    """A decorator: help() shows every option in the place of **options, with its default.

    Where the docstring's whole entry of **options is FitOptions.__doc__ by name, it becomes what
    FitOptions says of each.
    """

    def spell_out(function: Function) -> Function:
        signature = inspect.signature(function)
        kept = [at for at in signature.parameters.values() if at.kind is not at.VAR_KEYWORD]
        options = [
            inspect.Parameter(
                name, inspect.Parameter.KEYWORD_ONLY, default=default_of(name), annotation=kind
            )
            for name, kind in FitOptions.__annotations__.items()
            if name not in without
        ]
        spelled = signature.replace(parameters=[*kept, *options])
        function.__signature__ = spelled  # type: ignore[attr-defined]
        if function.__doc__ and FitOptions.__doc__:  # none under python -OO
            each = inspect.getdoc(FitOptions).partition("Attributes:\n")[2]  # type: ignore[union-attr]
            text = inspect.cleandoc(function.__doc__)
            function.__doc__ = text.replace("    **options: FitOptions.", each)
        return function

    return spell_out


def default_of(name: str) -> Any:  # noqa: ANN401
    """The engine's own; None where nothing is set."""
    default = getattr(_core.Options(), name, None)
    return None if isinstance(default, str | Mapping | list) and not default else default


def to_core(options: Mapping[str, Any]) -> _core.Options:
    """The options as C++ takes them. Raises TypeError for an unknown name or a wrong kind."""
    core = _core.Options()
    for name, value in options.items():
        if name not in FitOptions.__annotations__:
            known = ", ".join(FitOptions.__annotations__)
            hint = f"--{name} of the apps is {APP_NAMES[name]}; " if name in APP_NAMES else ""
            raise TypeError(f"fit() has no option '{name}'; {hint}it has: {known}")
        if value is None:
            continue
        try:
            setattr(core, name, dict(value) if isinstance(value, Mapping) else value)
        except TypeError:
            shape = f"give {SHAPES[name]}; " if name in SHAPES else ""
            raise TypeError(
                f"fit() can't take {name}={value!r}; {shape}help(sepcal.FitOptions) says what it "
                "takes"
            ) from None
    return core


def open_ends(bounds: Bounds | None) -> dict[str, tuple[float, float]]:
    """(lower, upper) by name, infinite where None."""
    return {
        name: (-math.inf if lower is None else lower, math.inf if upper is None else upper)
        for name, (lower, upper) in (bounds or {}).items()
    }


def refuse_log_choice(options: Mapping[str, Any]) -> None:
    """Raises Error for an option that chooses of a flight, where there is none."""
    nothing: tuple[object, ...] = (None, False, "", [], {}, ())
    for name in LOG_CHOICE:
        value = options.get(name)
        if value not in nothing or isinstance(value, float):
            raise _core.Error(f"{name} is for flights; give the data as a sepcal.Flight")


def to_names(argument: str, names: Sequence[str]) -> list[str]:
    """The names. Raises Error for one alone, which would be taken letter by letter."""
    if isinstance(names, str):
        raise _core.Error(f"{argument} is '{names}'; give a list of names, ['{names}']")
    return list(names)
