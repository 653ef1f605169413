# SPDX-License-Identifier: BSD-3-Clause
"""Calibrations of schema version 1 are read, and mean what they meant: tests/schema_1 has them.

Their flights are simulated anew. Texts are those of the release that wrote them, but for the words
that have changed since, and numbers are its to 1e-9 standard errors, but for these themselves.
"""

import hashlib
import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import sepcal
from apps import parse_json, run
from schema_1.recorder import CASES, DRAWN, HERE, ask, simulate

NEW_WORDS = {" known ": " prior ", "far from what is known of it": "far from its prior"}


SCALE_BOUNDS = re.compile(r" +\[(?:-0\.95|0\.05), inf\]$", re.MULTILINE)  # there were none


# RMSE by output; of the noise, which was always told, only what is another is told now.
OUTPUTS = re.compile(r"^output +rmse.*(?:\n\S.*)+", re.MULTILINE)


# Estimates in other forms: there were none.
RESTATED = re.compile(r"(?:\n(?:wind|airspeed_ratio|correction): .*)+\n", re.MULTILINE)


# Three standard errors, once two: those recorded are beyond either or within both.
NOISE_LIMIT = re.compile(r"noise alone within [\d.]+")
# How well outputs are followed, and estimates that go together: nothing was said of them.
FOLLOWED = re.compile(r"\noutput +R\^2.*\n(?:\S.*\n)*?Theil U: .*\n")
TOGETHER = re.compile(r"\ncorrelation above 0\.9: .*\n")


STATUS = re.compile(r"^(status: \w+)((?:\n  \S.*)+)", re.MULTILINE)


# By one step from the fit with the effect since, where a fit to each fold was made.
HELD_OUT = re.compile(r"on rows held out ([\d.]+) -> ([\d.]+)")


def in_one_line(page: str) -> str:
    """The status as the release before printed it: its sentences behind it, not below."""
    return STATUS.sub(
        lambda at: f"{at[1]}: " + "; ".join(line.strip() for line in at[2].splitlines() if line),
        page,
    )


def without_errors(page: str) -> str:
    """The page but for standard errors, by a better noise model since, and what is said of them.

    R settles in fewer turns since, at the same numbers, which are compared beside the page.
    """
    page = re.sub(
        r"\d+ iterations?, (?:R settled|noise covariance converged) in \d+", "R settled", page
    )
    page = RESTATED.sub("", page)
    page = TOGETHER.sub("", page)
    page = OUTPUTS.sub(lambda at: re.sub(r"^(\S+ +\S+).*$", r"\1", at[0], flags=re.M), page)
    lines = re.sub(r"^(status: \w+):.*$", r"\1", page, flags=re.MULTILINE).splitlines()
    header = next(at for at, line in enumerate(lines) if line.startswith("parameter"))
    error = slice(lines[header].index("value") + 5, lines[header].index("white") - 4)
    end = lines.index("", header)
    rows = [line[: error.start] + line[error.stop :] for line in lines[header:end]]
    return "\n".join([*lines[:header], *rows, *lines[end:]])


def run_in(folder: Path):
    """A verb in `folder`, whose standard output comes back."""

    def run_here(app: str, *arguments: str) -> str:
        outcome = run(app, *arguments, folder=folder)
        assert outcome.code == 0, outcome.err
        return outcome.out

    return run_here


@pytest.fixture(params=list(CASES))
def name(request: pytest.FixtureRequest) -> str:
    """Each case in turn."""
    return request.param


@pytest.fixture
def before(name: str) -> dict[str, Any]:
    """The calibration as it was written, with its key names of then."""
    return parse_json((HERE / f"{name}.json").read_text())


@pytest.fixture
def folder(name: str, before: dict[str, Any], tmp_path: Path) -> Path:
    """The calibration, base.json, beside its flight."""
    simulate(CASES[name], run_in(tmp_path))
    digest = hashlib.sha256((tmp_path / "flight.csv").read_bytes()).hexdigest()
    assert digest == before["inputs"]["sha256"]  # else the simulator has changed
    shutil.copy(HERE / f"{name}.json", tmp_path / "base.json")
    return tmp_path


def test_every_verb_gives_what_it_gave(name: str, folder: Path) -> None:
    recorded = parse_json((HERE / "recorded.json").read_text())[name]
    now = ask(CASES[name], run_in(folder), folder)
    for verb in ("compare", "apply"):
        texts = in_one_line(FOLLOWED.sub("", now["texts"][verb])), recorded["texts"][verb]
        assert NOISE_LIMIT.sub("", texts[0]) == NOISE_LIMIT.sub("", texts[1])
    added = recorded["texts"]["add"]
    for old, new in NEW_WORDS.items():
        added = added.replace(old, new)
    without_bounds = SCALE_BOUNDS.sub("", now["texts"]["add"])
    now_added = without_errors(in_one_line(without_bounds))
    assert HELD_OUT.sub("", now_added) == HELD_OUT.sub("", without_errors(added))
    held_out = [np.array(HELD_OUT.findall(page)[0], float) for page in (now_added, added)]
    assert_allclose(*held_out, rtol=5e-3)

    assert_allclose(list(now["rmse"].values()), list(recorded["rmse"].values()), rtol=1e-12)
    assert now["corrected"].keys() == recorded["corrected"].keys()
    for column, values in recorded["corrected"].items():
        assert_allclose(now["corrected"][column], values, rtol=1e-12)
    assert now["added"].keys() == recorded["added"].keys()
    for parameter, (value, standard_error) in recorded["added"].items():
        got, got_error = now["added"][parameter]
        if standard_error is None:  # held
            assert (got, got_error) == (value, None)
            continue
        assert abs(got - value) <= 1e-9 * standard_error
        assert 0.25 < got_error / standard_error < 4.0  # by a better noise model since


def test_options_go_on_in_their_new_words(name: str, before: dict[str, Any], folder: Path) -> None:
    """What was knowledge is the prior, and what was priors is what samples are drawn from."""
    run_in(folder)(
        CASES[name].app, "add", "flight.csv", "base.json", CASES[name].effect, "-o", "next.json"
    )
    now = parse_json((folder / "next.json").read_text())
    assert now["schema_version"] == 3
    assert now["options"]["prior"] == before["options"]["knowledge"]
    assert now["options"]["sampling_distribution"] == before["options"]["priors"]
    assert not {"knowledge", "priors"} & now["options"].keys()


def test_python_reads_both_kinds_of_normals() -> None:
    """Both filled, with other numbers for one parameter: neither stands for the other."""
    options = sepcal.load(HERE / "drawn_samples.json").to_dict()["options"]
    as_lists = json.loads(json.dumps(DRAWN))
    assert options["prior"] == as_lists["knowledge"]
    assert options["sampling_distribution"] == as_lists["priors"]
    assert options["prior"]["eps_phi"] != options["sampling_distribution"]["eps_phi"]
