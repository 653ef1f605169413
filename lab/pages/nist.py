# SPDX-License-Identifier: BSD-3-Clause
"""docs/nist.md: digits reached on NIST's nonlinear regression sets, beside other programs.

Usage: nist.py [-o FILE], FILE by default docs/nist.md. It needs the build folder, for the module
and for Ceres alone, and SciPy and lmfit.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / part) for part in ("build/python", "tests", "lab")]

import sepcal  # noqa: E402
from measured import measured_line  # noqa: E402
from oracle import nist, nist_peers  # noqa: E402
from oracle.nist_peers import Answer  # noqa: E402

OURS = ("auto", "projected", "joint")
PROGRAMS = (*(f"sepcal {stage}" for stage in OURS), *nist_peers.PEERS)
AIM = {"lower": 8.0, "average": 8.0, "higher": 6.0}  # digits of the parameters
SOLVED = 4.0

TITLE = "# NIST's nonlinear regression sets\n"
ROOMS = ("estimation", "model", "numerics")

HEAD = """
The 27 [Statistical Reference Datasets](https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml)
for nonlinear regression have values certified to 11 digits and two starts each: the first
far off, the second nearer. This page says how many digits sepcal and others reach. It is written
by

    python lab/pages/nist.py

from `tests/oracle/nist_data.json`; `tests/oracle/test_nist.py` asserts its statements about
sepcal.

sepcal gets separable sets as such: xi1 holds the parameters in which the model is affine, and the
start is that of xi2 alone. Chwirut's model has no linear part. `start=` sets the start, and nothing
is sampled. All other options are the defaults except `coloured_errors=False`, because NIST's
standard deviations assume white residuals. R is estimated. `auto` begins projected; joint also
begins with xi1 solved at the start. The models are written in Python with hand-written derivatives,
which SciPy gets as its Jacobian; the digits with differences instead are below.

The others get all parameters and NIST's whole start. SciPy's `least_squares` has exact derivatives
and `x_scale="jac"`, lmfit (`leastsq`) its own differences, and Ceres automatic derivatives, one
residual block per sample and DENSE_QR. They stop at tolerances of 1e-15 (Ceres: 1e-16) or after
20,000 evaluations. Standard deviations of SciPy and Ceres come from the exact Jacobian at their
solution.

Digits are -log10 of the relative error, at most 11; the worst parameter counts. A set counts as
solved if the program says that it converged and all parameters have 4 digits; the aim is 8, and 6
on the higher level.
"""

MEANING = """
Each cell holds the whole digits of the parameters, the standard deviations and the residual sum of
squares. `x`: the same curve with its terms in another order or signs reversed in pairs, counted
after they were put right. `!`: the program says that it did not converge. A dash means not one
digit.
"""

DIFFERENCES = """
## Without derivatives by hand

sepcal differentiates a Python model without derivatives by fourth-order central differences. In
these sets the digits of sepcal auto then change; in all others they stay.
"""

REMARKS = """
## What is left

- *Lanczos1* has residuals of 1e-13, the rounding of its data in double precision. No program gets
  more than 3 digits of their sum of squares or of the standard deviations that follow from it. The
  residuals lie below sepcal's noise floor, 1e-12 of the output; the standard errors still follow
  from the residuals.
- *Lanczos from start 1, jointly*: the three exponentials come out in another order. No order is
  better than another, and which one a far start leads to is chance.
- *MGH10 from start 1, jointly*: in a curved valley xi1 and xi2 have to change together by many
  orders of magnitude. Within the default 200 iterations per descent the fit ends at "b2, b3 and b1
  can't be told apart" with the status `not_identifiable`, so it does not pass off a wrong answer as
  right. `iterations=20000` converges after some 7,000, to the same digits. Projected takes 64.
- *Hahn1 by differences*: b7 is -1e-7 and multiplies x^3 up to 6e8. Without bounds sepcal can't know
  that it is small, and a difference step for a parameter of order one is far too long. From start 1
  the fit does not converge; from start 2 the model check refuses it. With x in hundreds of kelvins
  (b7 is then -0.12) or with hand-written derivatives it has its ten digits.
- Chwirut's model has no linear part: projected and joint are the same.
"""


@dataclass(frozen=True)
class Line:
    """One set from one start."""

    name: str
    level: str
    start: int
    answers: dict[str, Answer]  # by program

    def has(self, program: str, digits: float) -> bool:
        """Whether all parameters have these digits, and the program says that it converged."""
        answer = self.answers[program]
        return bool(answer.converged and answer.digits.parameters >= digits)


def run_all() -> list[Line]:
    """Every set from both starts by every program."""
    lines = []
    for name in nist.NAMES:
        given = nist.state_set(name)
        for start in nist.STARTS:
            answers = {}
            for stage, program in zip(OURS, PROGRAMS, strict=False):
                found = nist.fit(given, start, stage)
                answers[program] = Answer(
                    converged=found.status == "converged", digits=nist.digits_of(given, found)
                )
            for peer in nist_peers.PEERS:
                answers[peer] = nist_peers.ask(peer, given, start)
            lines.append(Line(name, given.level, start, answers))
    return lines


def show(answer: Answer) -> str:
    """A cell."""
    digits = answer.digits
    marks = ("x" if digits.exchanged else "") + ("" if answer.converged else "!")
    if digits.parameters < 1.0:
        return f"-{marks}"
    counts = (digits.parameters, digits.standard_deviations, digits.residual_square)
    return " ".join([*(str(int(count)) for count in counts), *([marks] if marks else [])])


def summarise(lines: list[Line]) -> list[str]:
    """How many sets each program solves, by level and start."""
    text = ["| of 27 sets | " + " | ".join(PROGRAMS) + " |"]
    text.append("|---" * (len(PROGRAMS) + 1) + "|")
    for start in nist.STARTS:
        from_there = [line for line in lines if line.start == start]
        solved = [sum(line.has(program, SOLVED) for line in from_there) for program in PROGRAMS]
        aimed = [
            sum(line.has(program, AIM[line.level]) for line in from_there) for program in PROGRAMS
        ]
        text.append(f"| solved from start {start + 1} | " + " | ".join(map(str, solved)) + " |")
        text.append(f"| the aim from start {start + 1} | " + " | ".join(map(str, aimed)) + " |")
    return text


def tabulate(lines: list[Line]) -> list[str]:
    """All digits, level by level."""
    text: list[str] = []
    for level in AIM:
        text += ["", f"## {level.capitalize()} level", ""]
        text.append("| set | start | " + " | ".join(PROGRAMS) + " |")
        text.append("|---" * (len(PROGRAMS) + 2) + "|")
        text += [
            f"| {line.name} | {line.start + 1} | "
            + " | ".join(show(line.answers[program]) for program in PROGRAMS)
            + " |"
            for line in lines
            if line.level == level
        ]
    return text


def reach_by_differences(lines: list[Line]) -> list[str]:
    """Sets in which sepcal auto reaches other digits without derivatives by hand."""
    text = ["", "| set | start | by hand | by differences |", "|---|---|---|---|"]
    for line in lines:
        given = nist.state_set(line.name)
        try:
            found = nist.fit(given, line.start, derivatives=False)
        except sepcal.Error:
            cell = "refused"
        else:
            cell = show(Answer(found.status == "converged", nist.digits_of(given, found)))
        by_hand = show(line.answers[PROGRAMS[0]])
        if cell != by_hand:
            text.append(f"| {line.name} | {line.start + 1} | {by_hand} | {cell} |")
    return text


def main() -> None:
    """Writes the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", dest="file", type=Path, default=ROOT / "docs" / "nist.md")
    file: Path = parser.parse_args().file
    lines = run_all()
    page = [
        TITLE,
        measured_line(ROOMS),
        HEAD,
        *summarise(lines),
        MEANING.rstrip(),
        *tabulate(lines),
        DIFFERENCES.rstrip(),
    ]
    page += [*reach_by_differences(lines), REMARKS.rstrip()]
    file.write_text("\n".join(page) + "\n")


if __name__ == "__main__":
    main()
