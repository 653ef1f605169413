# SPDX-License-Identifier: BSD-3-Clause
"""A magnetometer of which only the field's strength is known: are its errors honest?

Readings are m = C h + n + noise, made here with NumPy, |h| = 48 uT.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from itertools import product

import numpy as np
from scipy.stats import t as student_t

import sepcal
from sepcal.columns import Array
from studies.study import Finding, Outcome, Progress, Study, binomial_limits, seed_range, seeds

STRENGTH = 48.0
TRUTH = {
    "lambda_x": 0.08, "lambda_y": -0.05, "lambda_z": 0.12,
    "alpha_xy": 0.03, "alpha_xz": -0.02, "alpha_yz": 0.05,
    "n_x": 12.0, "n_y": -8.0, "n_z": 20.0,
}  # fmt: skip
SOFT_IRON = np.array([[1.0, 0.03, -0.02], [0.03, 1.0, 0.05], [-0.02, 0.05, 1.0]])
MATRIX = SOFT_IRON @ np.diag([1.08, 0.95, 1.12])
BIAS = np.array([12.0, -8.0, 20.0])
ROWS = 400
SEEDS = 400
# On either side: with other seeds a correct build fails one of 54 counts in 20 runs at most.
ODDS = 5e-4
WIDE = tuple(product((0.2, 0.5, 1.0), (1.0, 1 / 3)))  # noise [uT], share of the sphere
CAPS = tuple(product((0.05, 0.5, 2.0), (0.2, 0.1, 0.05, 0.02)))
FARTHEST = 5.5  # standard errors
FIRST_HEADING = 1000  # seed of the flights on one heading


def read_field(seed: int, noise: float, covered: float = 1.0) -> dict[str, Array]:
    """ROWS readings [uT], the field evenly spread over a share of its sphere, a cap round +z."""
    rng = np.random.default_rng(seed)
    height = 1 - 2 * covered * rng.random(ROWS)
    heading = 2 * np.pi * rng.random(ROWS)
    level = np.sqrt(1 - height**2)
    field = STRENGTH * np.stack([level * np.cos(heading), level * np.sin(heading), height], axis=-1)
    reading = field @ MATRIX.T + BIAS + noise * rng.standard_normal((ROWS, 3))
    return dict(zip(("mx", "my", "mz"), reading.T.copy(), strict=True))


def fit(columns: dict[str, Array]) -> sepcal.Fit:
    """With the strength alone, on one thread."""
    return sepcal.fit(sepcal.Magnetometer(field_strength=STRENGTH), columns, threads=1)


def scaled_errors(fits: Iterable[sepcal.Fit]) -> Array:
    """(estimate - truth) / standard error, (fits, 9); NaN where there is none."""
    return np.array(
        [
            [(fit[name].value - true) / fit[name].standard_error for name, true in TRUTH.items()]
            for fit in fits
        ]
    )


def cover(noise: float, covered: float, fits: list[sepcal.Fit]) -> tuple[list[Finding], list[int]]:
    """95 % intervals of Student's t hold the truth in 364 to 393 of 400 records; and the counts."""
    where = f"{noise:g} uT, {covered:.2g} of the sphere"
    stopped = sum(fit.status != "converged" for fit in fits)
    findings = [Finding(f"{where}: not converged", str(stopped), "0", stopped == 0)]
    near = np.abs(scaled_errors(fits)) < student_t.ppf(0.975, ROWS - len(TRUTH))
    counts = [int(count) for count in near.sum(axis=0)]
    fewest, most = binomial_limits(len(fits), 0.95, ODDS)
    for name, count in zip(TRUTH, counts, strict=True):
        figure, limits = f"{count} of {len(fits)}", f"{fewest} to {most}"
        holds = fewest <= count <= most
        findings.append(Finding(f"{where}, {name}: 95 % covers", figure, limits, holds))
    return findings, counts


def is_honest(fit: sepcal.Fit) -> bool:
    """Good, with errors that are near what it says, or not called converged.

    By chance one of 9 parameters in 96 fits exceeds five and a half standard errors with
    probability 4e-5 where errors are normal; where they reach half the bounds' width they are not,
    so the limit is generous.
    """
    if fit.status == "converged":
        return fit.at_bound == [] and bool(np.all(np.abs(scaled_errors([fit])) < FARTHEST))
    names_the_open = fit.status == "not_identifiable" and len(fit.unobservable) > 3
    return names_the_open or fit.status == "not_converged"


def collapse(noise: float, covered: float, fits: list[sepcal.Fit]) -> Finding:
    """On a small cap: a collapse is never a result."""
    wrong = sum(not is_honest(fit) for fit in fits)
    good = sum(fit.status == "converged" for fit in fits)
    what = f"{noise:g} uT on a cap of {covered:g}: far from the truth and not said"
    return Finding(what, f"{wrong} of {len(fits)}, {good} converged", "0", wrong == 0)


def is_refused(seed: int) -> bool:
    """A small cap in noise: on one heading at 1 uT intervals no longer hold."""
    flight = sepcal.simulate(
        "magnetometer",
        parameters={f"eta_{axis}": 0.0 for axis in "xyz"},
        noise=dict.fromkeys(("mx", "my", "mz"), 1.0),
        rows=1500,
        seed=seed,
        excitation="poor",
    )
    fit = sepcal.fit(sepcal.Magnetometer(field_strength=53.2), flight, threads=1)
    return fit.status == "not_identifiable"


def one_heading(refused: list[bool]) -> Finding:
    """Exit 4 of the app, whatever converged."""
    missed = len(refused) - sum(refused)
    what = "one heading, 1 uT: called identifiable"
    return Finding(what, f"{missed} of {len(refused)}", "0", missed == 0)


def _run(arguments: argparse.Namespace, report_progress: Progress) -> Outcome:
    some = seed_range(arguments)
    caps = range(some.start, some.start + arguments.caps)
    findings: list[Finding] = []
    counts: list[int] = []
    with ThreadPoolExecutor(arguments.processes) as pool:

        def fits(noise: float, covered: float, drawn: range) -> list[sepcal.Fit]:
            return list(pool.map(lambda seed: fit(read_field(seed, noise, covered)), drawn))

        steps = len(WIDE) + len(CAPS) + 1
        for done, (noise, covered) in enumerate(WIDE, 1):
            found, held = cover(noise, covered, fits(noise, covered, some))
            findings += found
            counts += held
            report_progress(done / steps)
        for done, (noise, covered) in enumerate(CAPS, len(WIDE) + 1):
            findings.append(collapse(noise, covered, fits(noise, covered, caps)))
            report_progress(done / steps)
        refused = list(pool.map(is_refused, range(FIRST_HEADING, FIRST_HEADING + 30)))
        findings.append(one_heading(refused))
        report_progress(1.0)
    return Outcome(
        f"of {len(some)} intervals of a parameter {min(counts)} to {max(counts)} hold; "
        f"{len(CAPS) * len(caps)} small caps and {len(refused)} flights on one heading",
        findings,
    )


def _add_options(parser: argparse.ArgumentParser) -> None:
    seeds(SEEDS, "records of each noise and share of the sphere")(parser)
    parser.add_argument("--caps", type=int, default=8, help="records of each small cap (8)")


STUDY = Study(
    "field-strength",
    "whether a magnetometer's intervals cover where the field's strength alone is known, and "
    "whether small caps of the sphere are called what they are",
    _run,
    _add_options,
)
