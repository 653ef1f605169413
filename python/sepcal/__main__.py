# SPDX-License-Identifier: BSD-3-Clause
"""python -m sepcal COMMAND: what the package does from a terminal beside the two apps.

A command is a module with add_to(commands), which registers a parser whose default `run` takes the
arguments and returns an exit code. Bad input is one line on standard error and exit code 2, Ctrl-C
one and 130.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from sepcal import _core
from sepcal.geomagnetism import command as field
from sepcal.logs import command as log
from sepcal.printing import in_line, tell
from sepcal.reporting import command as report

COMMANDS = (report, log, field)
BAD_INPUT = 2
INTERRUPTED = 130


class Parser(argparse.ArgumentParser):
    """Says in one line what is wrong."""

    def error(self, message: str) -> NoReturn:
        """Exits with 2."""
        self.exit(BAD_INPUT, in_line(f"{self.prog}: {message}; --help shows how") + "\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command and returns its exit code."""
    parser = Parser(prog="sepcal", description="Beside sepcal-pitot and sepcal-mag.")
    parser.add_argument("--version", action="version", version=f"sepcal {_core.__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, dest="command")
    for command in COMMANDS:
        command.add_to(commands)
    chosen = parser.parse_args(arguments)
    try:
        code = int(chosen.run(chosen))
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # as of "| head": who reads has enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except _core.Error as error:
        tell(f"sepcal {chosen.command}: {error}")
        return BAD_INPUT
    except KeyboardInterrupt:
        tell(f"sepcal {chosen.command}: stopped by Ctrl-C; no file was written")
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
