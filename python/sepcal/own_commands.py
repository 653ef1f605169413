# SPDX-License-Identifier: BSD-3-Clause
"""`sepcal model VERB --model FILE.py:CLASS ...`: every verb of the apps, of your own model.

The file is run where it is named, and nowhere else.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import inspect
import json
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

from sepcal import _core
from sepcal.calibration import Calibration, load
from sepcal.catalogue import effects
from sepcal.checking import check
from sepcal.fitting import fit
from sepcal.flight import Flight, read_csv
from sepcal.joint import fit_jointly
from sepcal.models import Model
from sepcal.options import ROWS
from sepcal.own_state_model import to_own
from sepcal.pages import Page
from sepcal.printing import in_line, page_of, show, tell
from sepcal.progress import show_engine
from sepcal.whole_files import name_of, refuse_outputs, write_whole

Commands = argparse._SubParsersAction
EXIT_CODES = {
    "converged": 0, "not_identifiable": 4, "not_converged": 5,
    "adequate": 0, "effect_missing": 3, "slow_change": 6, "unexplained": 6,
}  # fmt: skip
FORM = "FILE.py:CLASS"
VERBS = ("check", "fit", "effects", "compare", "diagnose", "add", "intervals", "apply")
SCALARS = {"int": int, "float": float}


def add_to(commands: Commands[argparse.ArgumentParser]) -> None:
    """Registers the command and its verbs."""
    what = "calibrates by a model of your own, a class of Python"
    model = commands.add_parser("model", help=what, description=what)
    verbs = model.add_subparsers(metavar="VERB", required=True, dest="verb")
    verb = _add(verbs, "check", _check, "what a log is, and what that does to a fit")
    _add_flights(verb)
    verb = _add(verbs, "fit", _fit, "a calibration of one flight, or of several together")
    _add_flights(verb, several=True)
    _add_output(verb, "BASE.json")
    _add_options(verb)
    _add(verbs, "effects", _effects, "the effects that the model may lack")
    verb = _add(verbs, "compare", _compare, "the residual by output, maneuver and channel")
    _add_subject(verb)
    verb.add_argument(
        "--reference", action="append", default=[], metavar="COLUMN",
        help="an independent sensor's column, to set the model's output against",
    )  # fmt: skip
    verb = _add(verbs, "diagnose", _diagnose, "which physical effect is missing?")
    _add_subject(verb)
    _add_output(verb, "FOUND.json", needed=False)
    verb.add_argument("--auto", action="store_true", help="adds what is advised, and asks again")
    verb.add_argument("--most", type=int, metavar="N", help="with --auto: at most so many effects")
    verb.add_argument("--only", action="append", default=[], metavar="EFFECT", help="a candidate")
    verb.add_argument("--inject", metavar="EFFECT=SIZE", help="would it have been found?")
    verb.add_argument("--within", type=float, metavar="SECONDS", help="answers within that time")
    verb = _add(verbs, "add", _add_effect, "the calibration with one more effect")
    _add_subject(verb)
    verb.add_argument("effect", metavar="EFFECT", help="as diagnose names it: A[temp_degc]")
    _add_output(verb, "BETTER.json")
    verb = _add(verbs, "intervals", _intervals, "profile likelihood intervals")
    _add_subject(verb)
    verb.add_argument("--level", type=float, default=0.95, help="default: 0.95")
    verb = _add(verbs, "apply", _apply, "the log with what the calibrated model makes of it")
    _add_subject(verb)
    _add_output(verb, "LOG.csv")


def _add(
    commands: Commands[argparse.ArgumentParser],
    name: str,
    run: Callable[[argparse.Namespace], int],
    what: str,
) -> argparse.ArgumentParser:
    verb = commands.add_parser(name, help=f"{what}, with a model of your own", description=what)
    add_model(verb, needed=True)
    verb.add_argument("--json", action="store_true", help="prints JSON in place of the page")
    verb.add_argument("--explain", action="store_true", help="prints all that there is to say")
    verb.set_defaults(run=lambda given: _run_or_name_line(run, given))
    return verb


def _run_or_name_line(run: Callable[[argparse.Namespace], int], given: argparse.Namespace) -> int:
    """Raises Error with the line of the model's file where the model itself fails."""
    try:
        with show_engine(f"sepcal model {given.verb}"):
            return run(given)
    except (_core.Error, OSError, MemoryError):
        raise
    except Exception as error:
        file = os.path.abspath(given.model.rpartition(":")[0])
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if os.path.abspath(frame.filename) == file]
        if not lines:
            raise
        what = f"{type(error).__name__}: {error}"
        raise _core.Error(f"--model {given.model}: line {lines[-1]}: {in_line(what)}") from error


def add_model(verb: argparse.ArgumentParser, *, needed: bool) -> None:
    """The option that names a model."""
    verb.add_argument(
        "--model", metavar=FORM, required=needed, help="your model: a class in a file, which is run"
    )


def _add_flights(verb: argparse.ArgumentParser, *, several: bool = False) -> None:
    verb.add_argument("flights", metavar="LOG.csv", nargs="+" if several else 1)
    if several:
        of_each = "with several flights: a parameter estimated per flight"
        verb.add_argument("--own", action="append", default=[], metavar="NAME", help=of_each)


def _add_subject(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "flights", metavar="LOG.csv", nargs="+", help="a log, or those of a joint fit"
    )
    verb.add_argument("calibration", metavar="CAL.json", help="what fit or add wrote")


def _add_output(verb: argparse.ArgumentParser, metavar: str, *, needed: bool = True) -> None:
    verb.add_argument("-o", "--output", metavar=metavar, required=needed, default="")


def _add_options(verb: argparse.ArgumentParser) -> None:
    """Those of sepcal.fit() that the programs have."""
    log = verb.add_argument_group("columns and rows of the log")
    for row in ROWS.values():
        if not row.flags:
            continue
        how: dict[str, Any] = {"metavar": row.form or None, "choices": row.choices or None}
        if row.type == "bool":
            how = {"action": "store_true"}
        elif row.type in SCALARS:
            how["type"] = SCALARS[row.type]
        elif not row.choices and row.type != "str":
            how |= {"action": "append", "default": []}
        told = row.sentence.replace("%", "%%")
        group = log if row.is_of_log else verb
        group.add_argument(*row.flags, dest=row.name, help=told, **how)


def read_numbers(option: str, texts: Sequence[str], form: str) -> dict[str, float]:
    """{name: number} of NAME=NUMBER. Raises Error, which shows the form, for another one."""
    numbers = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            numbers[name] = float(value)
        except ValueError:
            equals = ""
        if not name or not equals:
            raise _core.Error(f"{option} {text}: write it as {form}")
    return numbers


def _options(given: argparse.Namespace) -> dict[str, Any]:
    """The options that were typed."""
    options = {}
    for row in ROWS.values():
        value = getattr(given, row.name, None)
        if value is None or value is False or value == []:
            continue
        if isinstance(value, list):
            texts = value
            if row.form.endswith("[,...]"):
                texts = [text for each in value for text in each.split(",")]
            core = _core.Options()
            core.read_typed(row.name, texts)
            value = getattr(core, row.name)
        options[row.name] = value
    return options


def read_model(named: str) -> Model:
    """Runs the file and makes an object of the class; an object there is taken as it is.

    In the file's place may stand a module that Python finds: sepcal:Accelerometer.

    Raises:
        Error: Another form, no such file or class, a file that does not run, no model.
    """
    file, colon, name = named.rpartition(":")
    if not colon or not file or not name:
        raise _core.Error(f"--model {named}: write it as {FORM}, my_models.py:HotWire")
    try:
        module = _run(file, named)
        if not hasattr(module, name):
            raise _core.Error(f"--model {named}: {file} has no class {name}")
        found = getattr(module, name)
        made = found() if isinstance(found, type) or inspect.isroutine(found) else found
    except _core.Error:
        raise
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        raise _core.Error(f"--model {named}: it does not run: {in_line(what)}") from error
    return to_own(made)


def _run(file: str, named: str) -> ModuleType:
    """The module that a file is, or that has the name.

    A file's has a name of its own, so that it is pickled and found by nobody else's.
    """
    if not os.path.isfile(file):
        is_name = all(part.isidentifier() for part in file.split(".")) and not file.endswith(".py")
        if is_name and importlib.util.find_spec(file.partition(".")[0]) is not None:
            return importlib.import_module(file)
        raise _core.Error(f"--model {named}: there is no file {file}")
    spec = importlib.util.spec_from_file_location("sepcal_own_model", file)
    if spec is None or spec.loader is None:
        raise _core.Error(f"--model {named}: {file} is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    sys.path.insert(0, os.path.dirname(os.path.abspath(file)))  # as of a script that is run
    spec.loader.exec_module(module)
    return module


def _read_flight(given: argparse.Namespace) -> Flight:
    return read_csv(given.flights[0])


def _read_subject(
    given: argparse.Namespace, *, whole: bool = True
) -> tuple[Calibration, Flight | list[Flight]]:
    """The calibration and its flight, or flights; `whole`: all those of a joint fit."""
    calibration = load(given.calibration, model=read_model(given.model))
    assert isinstance(calibration, Calibration)
    _tell_notes(calibration.notes)
    flights = [read_csv(file) for file in given.flights]
    if whole and calibration.flights and len(flights) == 1:
        number = len(calibration.flights)
        raise _core.Error(f"{given.calibration} is of {number} flights; give them all")
    return calibration, flights[0] if len(flights) == 1 else flights


def _tell_notes(notes: Sequence[str]) -> None:
    for note in notes:
        tell(f"note: {note}")


def _deliver(given: argparse.Namespace, page: Page, told: str) -> None:
    """Prints one and writes the other."""
    output = getattr(given, "output", "")
    if output:
        write_whole({name_of(output): told})
    explained: str = page.explained  # type: ignore[attr-defined]
    show(told if given.json else explained if given.explain else str(page))
    if output and not given.json:
        show(in_line(f"wrote {output}"))


def _inputs(given: argparse.Namespace) -> tuple[str, ...]:
    files = (*given.flights, given.model.rpartition(":")[0])
    return (*files, given.calibration) if hasattr(given, "calibration") else files


def _check(given: argparse.Namespace) -> int:
    found = check(read_model(given.model), _read_flight(given))
    _deliver(given, found, found.to_json())
    return 0


def _effects(given: argparse.Namespace) -> int:
    known = effects(read_model(given.model))
    lines = [f"{each.name:<24} {each.equation:<36} [{each.unit}]" for each in known]
    show(json.dumps([each._asdict() for each in known]) if given.json else page_of(lines))
    return 0


def _fit(given: argparse.Namespace) -> int:
    refuse_outputs((given.output,), _inputs(given))
    model, options = read_model(given.model), _options(given)
    flights = [read_csv(file) for file in given.flights]
    if len(flights) == 1:
        if given.own:
            raise _core.Error("--own is of several flights; give them, or leave it out")
        calibration = fit(model, flights[0], **options)
    else:
        calibration = fit_jointly(model, flights, own=given.own, **options)
    _tell_notes(calibration.notes)
    _deliver(given, calibration, calibration.to_json())
    return EXIT_CODES[calibration.status]


def _compare(given: argparse.Namespace) -> int:
    calibration, flight = _read_subject(given, whole=False)
    compared = calibration.compare(flight, reference=given.reference)
    _tell_notes(compared.notes)
    _deliver(given, compared, compared.to_json())
    return 0


def _diagnose(given: argparse.Namespace) -> int:
    if given.output:
        refuse_outputs((given.output,), _inputs(given))
    calibration, flight = _read_subject(given)
    if given.auto:
        if given.inject:
            raise _core.Error(
                "--inject and --auto exclude each other: what is injected is not in the log"
            )
        stepped = calibration.diagnose(
            flight, auto=True, most=given.most, only=given.only, within=given.within
        )
        _tell_notes(stepped.fitted.notes)
        _deliver(given, stepped, stepped.to_json())
        return EXIT_CODES[stepped.fitted.status] or EXIT_CODES[stepped.diagnosis.verdict]
    if given.most is not None:
        raise _core.Error("--most is of --auto; add that, or leave it out")
    inject = None if given.inject is None else dict([_core.parse_sized_effect(given.inject)])
    found = calibration.diagnose(flight, inject=inject, only=given.only, within=given.within)
    _tell_notes(found.notes)
    _deliver(given, found, found.to_json())
    return EXIT_CODES[found.verdict]


def _add_effect(given: argparse.Namespace) -> int:
    refuse_outputs((given.output,), _inputs(given))
    calibration, flight = _read_subject(given)
    better = calibration.add(given.effect, flight)
    _tell_notes(better.notes)
    _deliver(given, better, better.to_json())
    return EXIT_CODES[better.status]


def _intervals(given: argparse.Namespace) -> int:
    calibration, flight = _read_subject(given)
    found = calibration.intervals(flight, level=given.level)
    _tell_notes(found.notes)
    _deliver(given, found, found.to_json())
    return EXIT_CODES[json.loads(found.to_json())["status"]]


def _apply(given: argparse.Namespace) -> int:
    refuse_outputs((given.output,), _inputs(given))
    calibration = load(given.calibration, model=read_model(given.model))
    assert isinstance(calibration, Calibration)
    _tell_notes(calibration.notes)
    if len(given.flights) > 1:
        raise _core.Error("apply takes one log at a time")
    applied = calibration.apply_to_file(given.flights[0], given.output)
    _tell_notes(applied.notes)
    show(in_line(f"wrote {given.output}: {applied.rows} rows with {', '.join(applied.headers)}"))
    if applied.rows_left_empty:
        show(f"{applied.rows_left_empty} rows are left empty there: no reading of what it takes")
    return 0
