# SPDX-License-Identifier: BSD-3-Clause
"""The options of Python's commands, as apps/tables.hpp has those of the native ones."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from typing import Any

VERBS = argparse._SubParsersAction


def table_of(name: str, parser: argparse.ArgumentParser) -> str:
    """The JSON of a command; one without verbs has a single verb without a name."""
    verbs = dict(_verbs_of(parser)) or {"": parser}
    return json.dumps(
        {
            "name": name,
            "sentence": parser.description or "",
            "verbs": [_verb(verb, each) for verb, each in verbs.items()],
        }
    )


def _verbs_of(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    for action in parser._actions:
        if isinstance(action, VERBS):
            yield from action.choices.items()


def _verb(name: str, parser: argparse.ArgumentParser) -> dict[str, Any]:
    groups = []
    for group in parser._action_groups:
        options = [_option(action) for action in group._group_actions if action.option_strings]
        if options:
            groups.append({"name": group.title or "", "options": options})
    return {
        "name": name,
        "sentence": parser.description or "",
        "usage": " ".join(parser.format_usage().split()) + "\n",
        "arguments": [
            {"name": str(action.metavar or action.dest), "sentence": action.help or ""}
            for action in parser._actions
            if not action.option_strings and not isinstance(action, VERBS)
        ],
        "groups": groups,
        "examples": [],
    }


def _option(action: argparse.Action) -> dict[str, Any]:
    value = "" if action.nargs == 0 else str(action.metavar or action.dest.upper())
    return {
        "names": list(action.option_strings),
        "value": value,
        "sentence": (action.help or "").replace("%%", "%"),
        "choices": [str(choice) for choice in action.choices or ()],
    }
