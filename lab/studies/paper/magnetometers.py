# SPDX-License-Identifier: BSD-3-Clause
"""Magnetometers of which only the field's strength is known: TWOSTEP and a quadric beside ours.

Readings are m = C h + n + noise with |h| = F. Alonso & Shuster's TWOSTEP (J. Astronaut. Sci. 50,
2002) is told the noise; Haupt and Kasdin's two steps and ours estimate it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.random import Generator, default_rng

import sepcal
from sepcal import rivals
from sepcal.columns import Array
from studies.paper.parts import Options, Part, Result, Table, exact, over, rate, share_of
from studies.study import Finding, Progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = (
    "lambda_x", "lambda_y", "lambda_z", "alpha_xy", "alpha_xz", "alpha_yz", "n_x", "n_y", "n_z",
)  # fmt: skip
SCALES, BIASES = slice(0, 3), slice(6, 9)
TRUTH = np.array([0.04, -0.03, 0.02, 0.02, -0.015, 0.01, 12.0, -7.0, 5.0])  # the simulator's
STRENGTH = float(np.linalg.norm([19.7, -1.4, 49.4]))  # F of the simulator's field [uT]
AXES = ("mx", "my", "mz")
ROWS = 400
RUNS_A_FLIGHT = 5  # 1,000 runs are 200 flights a cell
AXIS = np.full(3, 1.0 / np.sqrt(3.0))  # of the caps: all three axes share what they leave open
ANGLES = (180.0, 90.0, 60.0, 40.0, 30.0)  # half the opening of the cap [deg]
NOISES = (0.1, 0.3, 1.0, 3.0)  # [uT]
NOISE = 0.3  # where nothing else is said [uT]
STEP = 0.15  # of the quantised readings [uT]
DRIFT = 1.0  # of the bias over the record [uT]
OUTLIERS, OUTLIER = 0.02, 20.0  # share of rows, size [uT]
FAR_ERRORS, FAR = 5.0, 5.0  # "far off": standard errors of any parameter, uT of any bias
RECORDED = "bench_tilt_sphere_mag.csv"
BLOCKS = 10  # of the recording, odd and even ones


@dataclass(frozen=True)
class Estimate:
    """What a method says."""

    values: Array  # (9,), NaN of those that it doesn't estimate
    errors: Array  # (9,), standard errors
    vouched: bool  # converged, and it calls nothing open
    warned: bool = False  # it calls parameters hard to tell apart


NOTHING = Estimate(np.full(9, np.nan), np.full(9, np.nan), False)
Method = Callable[[Array, float, float], Estimate]  # of readings (N, 3), F and sigma [uT]


def columns_of(readings: Array) -> dict[str, Array]:
    """By name."""
    return dict(zip(AXES, readings.T.copy(), strict=True))


def fit_ours(
    readings: Array, strength: float, _: float, options: Mapping[str, Any] | None = None
) -> Estimate:
    """Maximum likelihood, with the noise's effect on the mean of |C^-1 (m - n)|."""
    kept = {"coloured_errors": False, **(options or {})}
    model = sepcal.Magnetometer(field_strength=strength)
    try:
        fit: sepcal.Fit = sepcal.fit(model, columns_of(readings), threads=1, **kept)
    except sepcal.Error:
        return NOTHING
    errors = np.array([fit[name].standard_error for name in NAMES])
    values = np.array([fit[name].value for name in NAMES])
    return Estimate(values, errors, fit.status == "converged", bool(fit.weak))


def fit_twostep(
    readings: Array, strength: float, noise: float, options: Mapping[str, Any] | None = None
) -> Estimate:
    """Alonso and Shuster's."""
    try:
        fit = rivals.fit_alonso_shuster(
            columns_of(readings), strength, noise=noise, **(options or {})
        )
    except sepcal.Error:
        return NOTHING
    return in_nine(fit, fit.converged)


def fit_quadric(readings: Array, strength: float, _: float) -> Estimate:
    """Haupt and Kasdin's two steps."""
    problem = rivals.MagnetometerInNineStates(strength)
    try:
        fit = rivals.fit_haupt_kasdin(problem, columns_of(readings))
    except sepcal.Error:
        return NOTHING
    return in_nine(fit, fit.converged)


def in_nine(fit: rivals.AlonsoShusterFit | rivals.HauptKasdinFit, vouched: bool) -> Estimate:
    """In the order of NAMES."""
    values, errors = np.full(9, np.nan), np.full(9, np.nan)
    at = [NAMES.index(name) for name in fit.names]
    values[at], errors[at] = fit.estimates, fit.standard_errors
    return Estimate(values, errors, vouched and bool(np.all(np.isfinite(values[at]))))


OURS, PRINTED, MENDED, BIAS_ALONE, QUADRIC = (
    "ours, white errors",
    "TWOSTEP as printed",
    "TWOSTEP, mean mended",
    "TWOSTEP, bias alone",
    "Haupt/Kasdin, quadric",
)
METHODS: Mapping[str, Method] = {
    OURS: fit_ours,
    PRINTED: fit_twostep,
    MENDED: partial(fit_twostep, options={"mean_as_printed": False}),
    BIAS_ALONE: partial(fit_twostep, options={"bias_alone": True}),
    QUADRIC: fit_quadric,
}
COLOURED = "ours, default errors"
WITH_COLOURED: Mapping[str, Method] = {
    OURS: fit_ours,
    COLOURED: partial(fit_ours, options={"coloured_errors": True}),
    **METHODS,
}
DISTURBED: Mapping[str, Method] = {
    OURS: fit_ours,
    COLOURED: WITH_COLOURED[COLOURED],
    "ours, Huber's loss": partial(fit_ours, options={"loss": "huber"}),
    **METHODS,
}


def matrix_of(values: Array) -> Array:
    """C = C_alpha C_lambda, (3, 3)."""
    xy, xz, yz = values[3:6]
    soft_iron = np.array([[1.0, xy, xz], [xy, 1.0, yz], [xz, yz, 1.0]])
    product: Array = soft_iron @ np.diag(1.0 + values[SCALES])
    return product


def draw_directions(rng: Generator, count: int) -> Array:
    """Uniform on the sphere, (count, 3)."""
    drawn = rng.standard_normal((count, 3))
    directions: Array = drawn / np.linalg.norm(drawn, axis=1, keepdims=True)
    return directions


def read_cap(rng: Generator, angle: float, noise: float) -> Array:
    """Readings (ROWS, 3) of a field that is uniform on a cap about AXIS [uT]."""
    height = rng.uniform(np.cos(np.radians(angle)), 1.0, ROWS)
    across = draw_directions(rng, ROWS)
    across -= np.outer(across @ AXIS, AXIS)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    directions = height[:, None] * AXIS + np.sqrt(1.0 - height**2)[:, None] * across
    clean = STRENGTH * directions @ matrix_of(TRUTH).T + TRUTH[BIASES]
    readings: Array = clean + noise * rng.standard_normal((ROWS, 3))
    return readings


def read_flight(rng: Generator, excitation: str, kind: str = "white") -> Array:
    """Readings (ROWS, 3) of a simulated flight [uT]."""
    flight = sepcal.simulate(
        "magnetometer",
        truth={"noise": dict.fromkeys(AXES, NOISE)},
        parameters={f"eta_{axis}": 0.0 for axis in "xyz"},
        noise=kind,
        excitation=excitation,
        rows=ROWS,
        seed=int(rng.integers(2**31)),
    )
    return np.stack([flight[f"{axis}_ut"] for axis in AXES], axis=-1)


def read_drifting(rng: Generator) -> Array:
    """Quantised, the bias moves on a line through its true value at mid-record."""
    course = np.outer(np.linspace(-0.5, 0.5, ROWS), DRIFT * draw_directions(rng, 1)[0])
    readings: Array = STEP * np.round((read_flight(rng, "rich") + course) / STEP)
    return readings


def read_outliers(rng: Generator) -> Array:
    """A few rows are off in any direction."""
    readings = read_flight(rng, "rich")
    off = rng.random(ROWS) < OUTLIERS
    readings[off] += OUTLIER * draw_directions(rng, int(off.sum()))
    return readings


@dataclass(frozen=True)
class Condition:
    """A line's readings."""

    name: str
    noise: float  # what TWOSTEP is told [uT]
    read: Callable[[Generator], Array]


def on_cap(name: str, angle: float, noise: float) -> Condition:
    """Directions of our own."""
    return Condition(name, noise, partial(read_cap, angle=angle, noise=noise))


COVERAGE = tuple(on_cap(f"{angle:g}", angle, NOISE) for angle in ANGLES)
NOISY = tuple(on_cap(f"{noise:g}", 180.0, noise) for noise in NOISES)
FLIGHTS = tuple(
    Condition(excitation, NOISE, partial(read_flight, excitation=excitation))
    for excitation in ("rich", "third", "poor")
)
DISTURBANCES = (
    Condition(f"{STEP:g} uT steps, bias drifts by {DRIFT:g} uT", NOISE, read_drifting),
    Condition(f"{100 * OUTLIERS:g} % of rows off by {OUTLIER:g} uT", NOISE, read_outliers),
    Condition(
        "noise of first order, 0.9",
        NOISE,
        partial(read_flight, excitation="rich", kind="ar"),
    ),
)


@dataclass(frozen=True)
class Spread:
    """Of some parameters, over what a method vouches for; root mean squares over parameters."""

    bias: float
    spread: float
    error: float  # standard errors, over the records too
    holds: int  # 95 % intervals
    of: int  # finite ones

    @classmethod
    def about_truth(cls, vouched: Sequence[Estimate], which: slice) -> Spread:
        """NaN where there is nothing."""
        values = np.array([one.values[which] for one in vouched]).reshape(-1, 3)
        errors = np.array([one.errors[which] for one in vouched]).reshape(-1, 3)
        finite = np.isfinite(errors)
        if len(values) < 2 or not finite.any():
            return cls(np.nan, np.nan, np.nan, 0, 0)
        off = values - TRUTH[which]
        holds = (np.abs(off) <= 1.96 * errors) & finite
        return cls(
            root_mean_square(off.mean(axis=0)),
            root_mean_square(off.std(axis=0, ddof=1)),
            root_mean_square(errors[finite]),
            int(holds.sum()),
            int(finite.sum()),
        )

    def triple(self, unit: float, digits: int) -> str:
        """Bias, spread, standard error."""
        if not np.isfinite(self.bias):
            return "-"
        of = (self.bias, self.spread, self.error)
        return "; ".join(f"{value / unit:.{digits}f}" for value in of)


def root_mean_square(values: Array) -> float:
    """Of all entries."""
    return float(np.sqrt(np.mean(np.square(values))))


@dataclass(frozen=True)
class Cell:
    """A method in a condition."""

    flights: int
    vouched: int
    warned: int  # of these
    scale: Spread
    bias: Spread  # [uT]
    bias_rms: float  # errors of n over what is vouched for [uT]
    far_in_errors: int
    far: int

    @classmethod
    def of(cls, estimates: Sequence[Estimate]) -> Cell:
        """Of all flights."""
        vouched = [one for one in estimates if one.vouched]
        off = np.array([one.values - TRUTH for one in vouched]).reshape(-1, 9)
        errors = np.array([one.errors for one in vouched]).reshape(-1, 9)
        return cls(
            len(estimates),
            len(vouched),
            sum(one.warned for one in vouched),
            Spread.about_truth(vouched, SCALES),
            Spread.about_truth(vouched, BIASES),
            root_mean_square(off[:, BIASES]) if vouched else np.nan,
            int((np.abs(off) > FAR_ERRORS * errors).any(axis=1).sum()),
            int((np.abs(off[:, BIASES]) > FAR).any(axis=1).sum()),
        )

    def row(self) -> list[str]:
        """As a table has it."""
        return [
            self.scale.triple(0.01, 3),
            rate(self.scale.holds, self.scale.of),
            self.bias.triple(1.0, 3),
            rate(self.bias.holds, self.bias.of),
            rate(self.flights - self.vouched, self.flights),
            rate(self.warned, self.flights),
            rate(self.far_in_errors, self.flights),
            rate(self.far, self.flights),
        ]

    def numbers(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "flights": self.flights,
            "vouched for": self.vouched,
            "with a warning": self.warned,
            "scale": vars(self.scale),
            "bias": vars(self.bias),
            "bias rms": self.bias_rms,
            "5 standard errors off": self.far_in_errors,
            "5 uT off": self.far,
        }


SWEEPS: tuple[tuple[str, tuple[Condition, ...], Mapping[str, Method]], ...] = (
    ("coverage", COVERAGE, METHODS),
    ("noise", NOISY, METHODS),
    ("flights", FLIGHTS, METHODS),
    ("disturbances", DISTURBANCES, DISTURBED),
)
Sweep = dict[str, dict[str, list[Estimate]]]  # by condition and method, a flight each


def flights_of(options: Options) -> int:
    """Of each condition."""
    return max(2, options.runs // RUNS_A_FLIGHT)


def fly(
    conditions: Iterable[Condition],
    methods: Mapping[str, Method],
    key: int,
    options: Options,
    report_progress: Progress,
) -> Sweep:
    """Every method on the same readings."""
    listed = list(conditions)
    flights = flights_of(options)
    work = [(i, flight) for i in range(len(listed)) for flight in range(flights)]

    def fit_all(item: tuple[int, int]) -> dict[str, Estimate]:
        i, flight = item
        readings = listed[i].read(default_rng([options.seed, key, i, flight]))
        return {name: fit(readings, STRENGTH, listed[i].noise) for name, fit in methods.items()}

    found = over(work, fit_all, options, report_progress)
    return {
        condition.name: {
            name: [found[i * flights + flight][name] for flight in range(flights)]
            for name in methods
        }
        for i, condition in enumerate(listed)
    }


def in_cells(sweep: Sweep) -> dict[str, dict[str, Cell]]:
    """Summed up."""
    return {
        condition: {name: Cell.of(estimates) for name, estimates in by_method.items()}
        for condition, by_method in sweep.items()
    }


def table_of(title: str, condition: str, sweep: Sweep, note: str = "") -> Table:
    """A line a condition and method."""
    rows = [
        [name, method, *cell.row()]
        for name, by_method in in_cells(sweep).items()
        for method, cell in by_method.items()
    ]
    head = [
        condition,
        "method",
        "lambda [%]: bias; spread; standard error",
        "lambda: 95 % hold",
        "n [uT]: bias; spread; standard error",
        "n: 95 % hold",
        "fails and says so",
        "vouched for, but called hard to tell apart",
        f"vouched for, over {FAR_ERRORS:g} standard errors off",
        f"vouched for, a bias over {FAR:g} uT off",
    ]
    return Table(title, head, rows, note)


NOTE = (
    "Bias, spread, standard error and intervals are of the records that a method vouches for: "
    "converged, and nothing called open. They are root mean squares over three axes; a method "
    "without a bias would show its spread over the root of the number of records. Limits of "
    "intervals take a record's three axes for independent. Where ours refuses most records, the "
    "few others are a choice of those that are far off. TWOSTEP is told the noise, the others "
    "estimate it. The bias alone takes scale factors for 1, which they are not. At 60 deg and "
    "below TWOSTEP's cost has no minimum near the truth: Levenberg and Marquardt's steps from "
    "there, too, run to c = 0, E = -I, where it vanishes."
)


def run(options: Options, report_progress: Progress) -> Result:
    """Four tables of simulations and the recording."""
    flown = [
        fly(conditions, methods, key, options, share_of(report_progress, key, len(SWEEPS)))
        for key, (_, conditions, methods) in enumerate(SWEEPS)
    ]
    coverage, noisy, _, _ = flown
    return Result(
        [*simulated_tables(flown, flights_of(options)), recorded_table()],
        {name: numbers_of(sweep) for (name, _, _), sweep in zip(SWEEPS, flown, strict=True)},
        {
            "magnetometer-coverage": partial(draw_coverage, coverage),
            "magnetometer-noise": partial(draw_noise, noisy),
        },
        findings_of(noisy, options.seed),
    )


def simulated_tables(flown: Sequence[Sweep], count: int) -> list[Table]:
    """One a sweep."""
    coverage, noisy, flights, disturbed = flown
    alone = f"Field strength alone, {count}"
    noise = f"{NOISE:g} uT of noise"
    return [
        table_of(
            f"{alone} records of {ROWS} rows with {noise} on a cap of the sphere",
            "half angle [deg]",
            coverage,
            NOTE,
        ),
        table_of(f"{alone} records of {ROWS} rows over the whole sphere", "noise [uT]", noisy),
        table_of(f"{alone} simulated flights, {noise}", "excitation", flights),
        table_of(f"{alone} disturbed flights, rich excitation, {noise}", "disturbance", disturbed),
    ]


def numbers_of(sweep: Sweep) -> dict[str, Any]:
    """For JSON."""
    return {
        condition: {name: cell.numbers() for name, cell in by_method.items()}
        for condition, by_method in in_cells(sweep).items()
    }


def findings_of(noisy: Sweep, seed: int) -> list[Finding]:
    """Known answers."""
    return [too_large_as_printed(noisy), agreement(noisy), empty_first_step(seed)]


def too_large_as_printed(noisy: Sweep) -> Finding:
    """TWOSTEP printed over mended, where the noise is largest.

    sqrt((F^2 + 3 sigma^2) / (F^2 - 3 sigma^2)) - 1, which is 3 sigma^2 / F^2 to first order.
    """
    noise = max(NOISES)
    ends = noisy[f"{noise:g}"]
    ratios = np.array(
        [
            np.mean((1.0 + printed.values[SCALES]) / (1.0 + mended.values[SCALES]) - 1.0)
            for printed, mended in zip(ends[PRINTED], ends[MENDED], strict=True)
            if printed.vouched and mended.vouched
        ]
    )
    mean, known = float(np.mean(ratios)), 3.0 * noise**2 / STRENGTH**2
    off = abs(mean / known - 1.0)
    return exact(
        f"magnetometer: TWOSTEP's scale factors at {noise:g} uT, printed over mended, less one",
        off < 0.03,
        f"{mean:.6f}",
        f"3 sigma^2/F^2 = {known:.6f} within 3 %",
    )


def agreement(noisy: Sweep) -> Finding:
    """Where the noise is least, over the whole sphere."""
    ends = noisy[f"{min(NOISES):g}"]
    farthest = max(
        float(np.max(np.abs(other.values - ours.values) / ours.errors))
        for name in (PRINTED, MENDED, QUADRIC)
        for ours, other in zip(ends[OURS], ends[name], strict=True)
    )
    return exact(
        f"magnetometer: methods differ at {min(NOISES):g} uT, whole sphere",
        farthest < 1.0,
        f"{farthest:.2f} standard errors at most",
        "1",
    )


def empty_first_step(seed: int) -> Finding:
    """TWOSTEP's first one: (c, E) = (0, -I) fulfils the centred equations of a constant field."""
    readings = read_cap(default_rng([seed, 9]), 180.0, NOISE)
    fit = rivals.fit_alonso_shuster(columns_of(readings), STRENGTH, noise=NOISE)
    off = float(np.max(np.abs(fit.centred - np.array([0, 0, 0, -1, -1, -1, 0, 0, 0]))))
    return exact(
        "magnetometer: TWOSTEP's first step finds c = 0, E = -I whatever is read",
        off < 1e-6,
        f"off by {off:.0e}",
        "1e-06",
    )


def recorded_table() -> Table:
    """A sensor turned by hand: estimates, and what is left of the field's strength elsewhere."""
    title, head = f"Recorded: {RECORDED}", ["parameter", *WITH_COLOURED]
    readings = load_recording()
    if readings is None:
        note = f"Left out: set SEPCAL_FIXTURES to the folder of {RECORDED}."
        return Table(title, head, [], note)
    strength = mean_radius(readings)
    noise = estimate_noise(readings, strength)
    whole = [fit(readings, strength, noise) for fit in WITH_COLOURED.values()]
    rows = [
        [
            f"{name} [{'uT' if k >= BIASES.start else '1'}]",
            *(with_error(one.values[k], one.errors[k]) for one in whole),
        ]
        for k, name in enumerate(NAMES)
    ]
    for half, names in ((1, "even blocks, fitted to odd ones"), (0, "odd, fitted to even")):
        lefts = [judge(fit, readings, half, strength, noise) for fit in WITH_COLOURED.values()]
        rows.append([f"left of F on {names} [uT]", *lefts])
    note = (
        f"{len(readings)} rows; standard errors in brackets. The field's strength was not "
        f"recorded: F is the radius of the sphere that fits best, {strength:.2f} uT. TWOSTEP is "
        f"told the noise that ours estimates, {noise:.3f} uT. Left of F is the root mean square "
        f"of |C^-1 (m - n)| - F; the record is cut into {BLOCKS} contiguous blocks."
    )
    return Table(title, head, rows, note)


def load_recording() -> Array | None:
    """Readings (N, 3) [uT]; None where the recording isn't."""
    checkout = Path(__file__).resolve().parents[3]
    folder = Path(os.environ.get("SEPCAL_FIXTURES", checkout.parent / "shared" / "data"))
    file = folder / RECORDED
    if not file.is_file():
        return None
    in_gauss: Array = np.loadtxt(file, delimiter=",", skiprows=1, usecols=(1, 2, 3))
    return 100.0 * in_gauss


def estimate_noise(readings: Array, strength: float) -> float:
    """As ours has it [uT]."""
    model = sepcal.Magnetometer(field_strength=strength)
    fit: sepcal.Fit = sepcal.fit(model, columns_of(readings), threads=1)
    return float(fit.noise["field"])


def mean_radius(readings: Array) -> float:
    """Of the sphere that fits best [uT]."""
    rows = np.column_stack([2.0 * readings, np.ones(len(readings))])
    found = np.linalg.lstsq(rows, np.sum(readings**2, axis=1), rcond=None)[0]
    return float(np.sqrt(found[3] + found[:3] @ found[:3]))


def with_error(value: float, error: float) -> str:
    """As "1.2345 (0.0012)"."""
    return f"{value:.4f} ({error:.4f})" if np.isfinite(value) else "-"


def judge(fit: Method, readings: Array, half: int, strength: float, noise: float) -> str:
    """Fitted to every other block, root mean square of |C^-1 (m - n)| - F on the others [uT]."""
    block = np.arange(len(readings)) * BLOCKS // len(readings) + 1
    own = block % 2 == half
    estimate = fit(readings[own], strength, noise)
    values = estimate.values.copy()
    values[: BIASES.start] = np.nan_to_num(values[: BIASES.start])  # of the bias alone
    field = np.linalg.solve(matrix_of(values), (readings[~own] - values[BIASES]).T)
    left = root_mean_square(np.linalg.norm(field, axis=0) - strength)
    return f"{left:.4f}" if estimate.vouched else f"{left:.4f}, not vouched for"


def draw_coverage(coverage: Sweep, figure: Figure) -> None:
    """Errors of the bias against the cap's size."""
    axes = figure.subplots()
    cells = in_cells(coverage)
    for method in METHODS:
        errors = [cells[f"{angle:g}"][method].bias_rms for angle in ANGLES]
        axes.semilogy(ANGLES, errors, marker=".", label=method)
    axes.set_xlabel("half angle of the cap [deg]")
    axes.set_ylabel("error of the bias, root mean square [uT]")
    axes.set_title(f"Field strength alone, {NOISE:g} uT: of fits that the method vouches for")
    axes.legend()


def draw_noise(noisy: Sweep, figure: Figure) -> None:
    """How much larger scale factors are than ours from the same readings."""
    axes = figure.subplots()
    for method in (PRINTED, MENDED, QUADRIC):
        beyond = [beyond_ours(noisy[f"{noise:g}"], method) for noise in NOISES]
        axes.loglog(NOISES, np.abs(beyond), marker=".", label=method)
    known = [3.0 * noise**2 / STRENGTH**2 for noise in NOISES]
    axes.loglog(NOISES, known, "k--", linewidth=0.8, label="3 sigma^2 / F^2")
    axes.set_xlabel("noise [uT]")
    axes.set_ylabel("scale factors, mean difference from ours, size [1]")
    axes.set_title("Field strength alone, whole sphere")
    axes.legend()


def beyond_ours(ends: Mapping[str, Sequence[Estimate]], method: str) -> float:
    """Mean over records and axes; NaN where no record has both."""
    both = [
        other.values[SCALES] - ours.values[SCALES]
        for other, ours in zip(ends[method], ends[OURS], strict=True)
        if other.vouched and ours.vouched
    ]
    return float(np.mean(both)) if both else np.nan


PARTS = (
    Part(
        "magnetometer",
        "TWOSTEP and Haupt/Kasdin's quadric beside ours where the field's strength alone is known",
        run,
    ),
)
