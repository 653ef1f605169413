# SPDX-License-Identifier: BSD-3-Clause
"""NIST's Statistical Reference Datasets for nonlinear regression: data, starts, certified values.

https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml; certified to 11 digits by calculations
in 128 bits, two starts a set. NIST's numbers are in the public domain; nist_data.json holds them.
"""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import sepcal
from oracle.model import Array
from oracle.nist_model import NistModel, ValuesAlone
from oracle.nist_models import MODELS

CERTIFIED_DIGITS = 11.0  # no estimate counts for more
NAMES = tuple(MODELS)
STARTS = (0, 1)  # NIST's "Start 1", far off, and "Start 2", nearer


@dataclass(frozen=True)
class NistSet:
    """One set, its parameters in the model's order, xi = (xi1, xi2)."""

    name: str
    level: str  # "lower", "average" or "higher": NIST's level of difficulty
    model: NistModel
    inputs: tuple[Array, ...]  # n_u columns, (N,)
    y: Array  # the response as the model has it, (N,): Nelson's is a logarithm
    starts: tuple[Array, Array]  # (n,) each
    certified: Array  # (n,)
    standard_deviations: Array  # (n,)
    residual_square: float

    @property
    def columns(self) -> dict[str, Array]:
        """The record, for sepcal.fit()."""
        return {**dict(zip(self.model.inputs, self.inputs, strict=True)), "y": self.y}

    @property
    def parameters(self) -> tuple[str, ...]:
        """The n names, linear before nonlinear."""
        return (*self.model.linear, *self.model.nonlinear)


@dataclass(frozen=True)
class Digits:
    """How many digits agree with the certified ones, the least over the parameters."""

    parameters: float
    standard_deviations: float
    residual_square: float
    exchanged: bool = False  # counted with terms exchanged or signs reversed: the same curve


@cache
def state_set(name: str) -> NistSet:
    """The set of that name; KeyError for another."""
    entry = _read_data()[name]
    model = MODELS[name]
    order = [int(b[1:]) - 1 for b in (*model.linear, *model.nonlinear)]
    first, second = (np.array(start)[order] for start in entry["starts"])
    y = np.array(entry["y"])
    return NistSet(
        name=name,
        level=entry["level"],
        model=model,
        inputs=tuple(np.array(entry["inputs"][column]) for column in model.inputs),
        y=np.log(y) if name == "Nelson" else y,
        starts=(first, second),
        certified=np.array(entry["certified"])[order],
        standard_deviations=np.array(entry["standard_deviations"])[order],
        residual_square=entry["residual_square"],
    )


@cache
def _read_data() -> dict:
    return json.loads(Path(__file__).with_name("nist_data.json").read_text())


def fit(
    given: NistSet,
    start: int,
    second_stage: str = "auto",
    *,
    iterations: int | None = None,
    jacobian: str = "kaufman",
    derivatives: bool = True,
) -> sepcal.Fit:
    """A fit from one of the starts: that of xi2 alone, so that nothing is sampled.

    Without `derivatives` the model hides its own, and sepcal takes differences of at().
    """
    n_1 = len(given.model.linear)
    xi2 = dict(zip(given.model.nonlinear, given.starts[start][n_1:].tolist(), strict=True))
    return sepcal.fit(
        given.model if derivatives else ValuesAlone(given.model),
        given.columns,
        start=xi2,
        second_stage=second_stage,
        iterations=iterations,
        jacobian=jacobian,
        coloured_errors=False,
    )


def count_digits(given: NistSet, xi: Array, standard_deviations: Array) -> Digits:
    """The digits of an estimate xi (n,) and its standard deviations (n,).

    Of the ways to write the same curve the one that is nearest to the certified parameters counts.
    """
    residual = given.y - given.model.predict(given.inputs, xi)
    square = _agreement(np.sum(residual**2), np.array(given.residual_square))
    counted = [
        Digits(
            _agreement(xi[order] * sign, given.certified),
            _agreement(standard_deviations[order], given.standard_deviations),
            square,
            exchanged=i > 0,
        )
        for i, (order, sign) in enumerate(given.model.list_equivalents())
    ]
    best = max(counted, key=lambda digits: digits.parameters)
    return best if best.parameters > counted[0].parameters + 1.0 else counted[0]


def digits_of(given: NistSet, found: sepcal.Fit) -> Digits:
    """Those of a fit, with its white standard errors; zero for what is undefined."""
    errors = [parameter.standard_error_white for parameter in found.parameters.values()]
    return count_digits(given, found.values, np.array(errors))


def _agreement(actual: Array, expected: Array) -> float:
    """-log10 |actual / expected - 1|, the least of all; within 0 and 11."""
    with np.errstate(all="ignore"):
        error = np.max(np.abs(actual - expected) / np.abs(expected))
        digits = -np.log10(error)
    return float(np.clip(digits, 0.0, CERTIFIED_DIGITS)) if not np.isnan(digits) else 0.0
