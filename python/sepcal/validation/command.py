# SPDX-License-Identifier: BSD-3-Clause
"""`python -m sepcal validate [MODEL ...]`, or `--model FILE.py:CLASS LOG.csv CAL.json`."""

from __future__ import annotations

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from functools import partial

from sepcal import _core
from sepcal.calibration import Calibration, load
from sepcal.flight import read_csv
from sepcal.own_commands import add_model, read_model
from sepcal.printing import show
from sepcal.validation.designs import DESIGNS, Design, make_design
from sepcal.validation.study import Validation, validate

APART = 1e-3  # standard errors: farther is another answer
DIFFERENT = 1


def add_to(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Registers the command."""
    parser = commands.add_parser(
        "validate",
        help="a Monte Carlo of a model beside SciPy's least squares",
        description="Fits simulated records of models that ship, or of one of your own on the "
        "inputs of a log, by sepcal and by SciPy's least_squares, and prints how far the two are "
        "apart. Exit code 1 where they are more than a thousandth of a standard error apart, or "
        "where SciPy's minimum is the lower one.",
    )
    parser.add_argument(
        "what",
        metavar="MODEL",
        nargs="*",
        help=f"of {', '.join(DESIGNS)} [all]; with --model: LOG.csv CAL.json, a calibration "
        "without effects whose estimates are the truth",
    )
    add_model(parser, needed=False)
    parser.add_argument("--trials", type=int, default=100, metavar="N", help="of each model [100]")
    parser.add_argument(
        "--rows", type=int, default=400, metavar="N", help="of a model that ships [400]"
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of the study [0]")
    parser.add_argument("--processes", type=int, default=1, metavar="N", help="[1]")
    parser.add_argument("--json", action="store_true", help="prints JSON in place of the tables")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Prints a table a model. Raises sepcal.Error on bad input."""
    if arguments.trials < 2:
        raise _core.Error(f"--trials {arguments.trials}: give at least 2")
    if arguments.processes < 1:
        raise _core.Error(f"--processes {arguments.processes}: give at least 1")
    designs = (
        [design_of(arguments.model, arguments.what)]
        if arguments.model
        else [make_design(name, arguments.rows) for name in arguments.what or DESIGNS]
    )
    told = []
    for place, design in enumerate(designs):
        found = _validate(design, arguments)
        told.append(found)
        if not arguments.json:
            show(f"{found}\n" if place + 1 < len(designs) else str(found))
    if arguments.json:
        show(json.dumps([found.to_dict() for found in told], indent=2))
    return 0 if all(map(_agree, told)) else DIFFERENT


def design_of(named: str, files: list[str]) -> Design:
    """The inputs of a log, and a calibration's estimates as the truth. Raises Error."""
    if len(files) != 2:
        raise _core.Error("with --model give LOG.csv CAL.json, as fit wrote it")
    model = read_model(named)
    log, file = files
    calibration = load(file, model=model)
    assert isinstance(calibration, Calibration)
    if calibration.effects:
        raise _core.Error(f"{file} has effects; give the calibration without them")
    figures = _core.gather_figures(calibration.core, read_csv(log)._core)
    names = ["time", *model.inputs, *model.optional_inputs]
    columns = {name: figures.channel(name) for name in dict.fromkeys(names)}
    inputs = {name: values for name, values in columns.items() if values is not None}
    truth = {name: one.value for name, one in calibration.parameters.items()}
    return Design(model, inputs, truth, calibration.noise)


def _validate(design: Design, arguments: argparse.Namespace) -> Validation:
    several = arguments.processes > 1
    return validate(
        design.model,
        design.inputs,
        truth=design.truth,
        scatter=design.scatter,
        trials=arguments.trials,
        seed=arguments.seed,
        executor=partial(ProcessPoolExecutor, arguments.processes) if several else None,
    )


def _agree(found: Validation) -> bool:
    return found.largest_difference <= APART and not found.lower[1] and not found.failed
