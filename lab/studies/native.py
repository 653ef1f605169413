# SPDX-License-Identifier: BSD-3-Clause
"""Studies in C++: the executable sepcal_studies, built on demand from tests/cpp/studies/*.cpp.

Its test cases tell their figures as messages; a check that fails is outside its limits.
"""

from __future__ import annotations

import argparse
import subprocess
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, XMLPullParser

from sepcal import Error
from studies.study import Finding, Outcome, Progress, Study

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build"
EXECUTABLE = BUILD / "tests" / "sepcal_studies"


def run(name: str, _: argparse.Namespace, report_progress: Progress) -> Outcome:
    """Builds the executable and runs the cases of one file, NAME_study.cpp.

    Raises Error where it can't be built or has no such cases.
    """
    del report_progress  # the messages are the progress
    _build()
    told: list[str] = []
    findings: list[Finding] = []
    case = ""
    for event, element in _run(f"*/{name.replace('-', '_')}_study.cpp"):
        if element.tag == "TestCase" and event == "start" and "skipped" not in element.attrib:
            case = element.attrib["name"]
            print(f"- {case}", flush=True)
        elif element.tag == "Text" and event == "end":
            told.append(_in_line(element))
            print(f"  {told[-1]}", flush=True)
        elif element.tag == "Expression" and event == "end":
            print(f"  OUTSIDE: {' | '.join(_in_line(part) for part in element)}", flush=True)
        elif element.tag == "OverallResultsAsserts" and event == "end" and case:
            passed, failed = int(element.attrib["successes"]), int(element.attrib["failures"])
            figure = f"{passed} of {passed + failed} checks pass"
            findings.append(Finding(case, figure, "all", passed > 0 and failed == 0))
            case = ""
    if case or not findings:
        raise Error(
            f"{EXECUTABLE} crashed in '{case}'" if case else f"there are no cases of {name}"
        )
    return Outcome("; ".join(told), findings)


def _build() -> None:
    if not (BUILD / "CMakeCache.txt").is_file():
        raise Error(f"{BUILD} is not configured; run scripts/setup first")
    command = ["cmake", "--build", str(BUILD), "--target", EXECUTABLE.name]
    print(f"building {EXECUTABLE.relative_to(ROOT)} ...", flush=True)
    built = subprocess.run(command, capture_output=True, text=True, check=False)
    if built.returncode != 0:
        raise Error(f"{' '.join(command)} failed:\n{built.stdout[-2000:]}{built.stderr[-2000:]}")


def _run(source: str) -> Iterator[tuple[str, Element]]:
    """The report's elements as they come, ("start" or "end", element)."""
    command = [str(EXECUTABLE), "--reporters=xml", f"--source-file={source}"]
    parser: Any = XMLPullParser(("start", "end"))
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        for line in running.stdout:
            parser.feed(line)
            yield from parser.read_events()


def _in_line(element: Element) -> str:
    return " ".join((element.text or "").split())


STUDIES = tuple(
    Study(name, shows, partial(run, name))
    for name, shows in (
        (
            "aircraft",
            "how far equation error, two steps and output error are off in flights with process"
            " noise, and how often their intervals hold",
        ),
        (
            "coloured-coverage",
            "whether 95 % intervals hold in white, autoregressive and pink noise",
        ),
        ("departure", "whether a flight's departure from its fleet is a right probability"),
        ("noise-calibration", "error rates of what is built on the noise model"),
        ("robust-fit", "whether robust fits cover where a twentieth of the readings is far off"),
        (
            "scores",
            "whether filter error's scores vary over flights as Fisher's information says",
        ),
        ("step-times", "whether the time of a step is found to a row"),
    )
)
