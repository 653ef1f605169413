# SPDX-License-Identifier: BSD-3-Clause
"""`sepcal COMMAND`, also as `python -m sepcal COMMAND`: all that sepcal does from a terminal.

Instruments (mag, pitot, aircraft) and files are the native programs' code, run in this process, so
that Python's readers of logs serve them too. The other commands are modules with
add_to(commands), which registers a parser whose default `run` takes the arguments and returns an
exit code. Bad input is one line on standard error and exit code 2, Ctrl-C one and 130.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from sepcal import _core
from sepcal import own_commands as own
from sepcal.command_tables import table_of
from sepcal.fleet import command as fleet
from sepcal.geomagnetism import command as field
from sepcal.logs import command as log
from sepcal.printing import in_line, tell
from sepcal.reading import AIR, MAGNETIC, reading_for
from sepcal.reporting import command as report
from sepcal.validation import command as validation

COMMANDS = (own, report, fleet, log, field, validation)
SUBJECTS = {"mag": MAGNETIC, "pitot": AIR}  # what a file with several sensors is read for
NAMES = ("model", "report", "fleet", "log", "field", "validate")
BAD_INPUT = 2
INTERRUPTED = 130


class Parser(argparse.ArgumentParser):
    """Says in one line what is wrong."""

    def error(self, message: str) -> NoReturn:
        """Exits with 2."""
        self.exit(BAD_INPUT, in_line(f"{self.prog}: {message}; --help shows how") + "\n")


def open_streams() -> None:
    """Opens nothing in a closed stream's place: a file would take its number, and what is said.

    Python itself gives such a stream as None, and then to argparse.
    """
    for stream, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(stream)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest free number, which is the stream's own
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "r+", encoding="utf-8"))  # noqa: SIM115


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command and returns its exit code."""
    open_streams()
    words = list(sys.argv[1:] if arguments is None else arguments)
    if is_of_own_model(words):
        words.insert(0, "model")
    return run_here(words) if words and words[0] in NAMES else run_native(words)


def is_of_own_model(words: Sequence[str]) -> bool:
    """Whether `model` is left out before the verb, as it may be beside --model."""
    if not words or words[0] not in own.VERBS:
        return False
    asks_for_help = "--help" in words or "-h" in words
    names_model = any(word.partition("=")[0] == "--model" for word in words)
    return names_model or (asks_for_help and words[0] != "check")


def run_native(words: Sequence[str]) -> int:
    """Commands that need no Python beside the readers of logs."""
    sys.stdout.flush()
    tables = []
    if words and words[0] in ("completion", "manual"):
        choices = make_parser()[1].choices
        tables = [table_of(name, choices[name]) for name in NAMES]
    try:
        with reading_for(SUBJECTS.get(words[0], "") if words else ""):
            return _core.run_sepcal([os.fsencode(word) for word in words], tables)
    except ImportError as error:  # the aircraft's module was not built
        return refuse(f"sepcal: {error}")


def make_parser() -> tuple[argparse.ArgumentParser, own.Commands[argparse.ArgumentParser]]:
    """The parser of the package's own commands, and these by name."""
    parser: argparse.ArgumentParser = Parser(prog="sepcal")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, dest="command")
    for command in COMMANDS:
        command.add_to(commands)
    return parser, commands


def run_here(words: Sequence[str]) -> int:
    """A command of the package alone."""
    parser, _ = make_parser()
    asked = "sepcal"
    kept = "no file was written"
    try:
        try:
            chosen = parser.parse_args(words)
            kept = getattr(chosen, "kept", kept)
            asked += " " + " ".join(filter(None, (chosen.command, getattr(chosen, "verb", None))))
            return int(chosen.run(chosen))
        finally:
            sys.stdout.flush()
    except BrokenPipeError:  # as of "| head": who reads has enough
        drop_output()
        return 0
    except OSError as error:
        drop_output()
        culprit = error.filename or "standard output can't be written"
        return refuse(f"{asked}: {culprit}: {error.strerror}")
    except MemoryError:
        return refuse(f"{asked}: memory ran out")
    except _core.Error as error:
        return refuse(f"{asked}: {getattr(error, 'as_typed', error)}")
    except KeyboardInterrupt:
        tell(f"{asked}: stopped by Ctrl-C; {kept}")
        return INTERRUPTED


def drop_output() -> None:
    """Lets what waits for standard output go, where Python would fail once more as it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def refuse(what: str) -> int:
    """Says so in one line."""
    tell(what)
    return BAD_INPUT


if __name__ == "__main__":
    sys.exit(main())
