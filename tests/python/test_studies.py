# SPDX-License-Identifier: BSD-3-Clause
"""scripts/study: its list, bad usage, exit codes, and the row that it keeps in docs/studies.md."""

import os
import re
import subprocess
from pathlib import Path

import pytest

import sepcal
from studies import __main__ as command
from studies.study import Finding, Outcome, Study, pooled_limits, seeds

ROOT = Path(__file__).parents[2]


def run(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    package = Path(sepcal.__file__).parent.parent
    return subprocess.run(
        [ROOT / "scripts" / "study", *arguments],
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(package)},
        check=False,
    )


def test_help_lists_the_studies_and_the_page_has_their_figures(tmp_path):
    listed = run("--help", folder=tmp_path)
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    assert listed.returncode == 0
    for study in command.STUDIES:
        assert f" {study.name} " in listed.stdout.replace("\n", " ")
        assert f"| `{study.name}` | `scripts/study {study.name}" in page


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["hidden-effects", "--seeds", "0"], "--seeds"),
        (["hidden-effects", "--null-seeds", "0"], "--null-seeds"),
        (["intervals", "--processes", "0"], "--processes"),
        (["hidden-effects", "-o", "nowhere/study.md"], "nowhere"),
        (["visible-effects"], "visible-effects"),
        ([], "NAME"),
    ],
)
def test_bad_usage_is_one_line(arguments, culprit, tmp_path):
    refused = run(*arguments, folder=tmp_path)
    assert refused.returncode == 2
    assert culprit in refused.stderr
    assert refused.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def tossed(monkeypatch):
    """A study of coins: heads of so many seeds, three at most."""

    def toss(options, report_progress):
        report_progress(1.0)
        finding = Finding("heads", str(options.seeds), "0 to 3", options.seeds <= 3)
        return Outcome(f"{options.seeds} heads", [finding])

    monkeypatch.setattr(command, "STUDIES", (Study("coins", "50 % are", toss, seeds(2, "coins")),))


def test_what_is_outside_its_limits_is_exit_code_1(tossed, capsys):
    assert command.main(["coins"]) == 0
    assert capsys.readouterr().out == ("heads: 2 (limits: 0 to 3)\n2 heads; 1 of 1 within limits\n")
    assert command.main(["coins", "--seeds", "4"]) == 1
    assert "heads: 4 (limits: 0 to 3)   OUTSIDE\n" in capsys.readouterr().out


def test_the_row_of_a_study_is_replaced_and_the_rest_stays(tossed, tmp_path):
    page = tmp_path / "studies.md"
    page.write_text("# Studies\n\n| study |\n|---|\n| `dice` | six |\n\n| rate |\n|---|\n")
    for count in ("2", "3"):
        typed = ["coins", "--processes", "1", "--seeds", count, "--record", str(page)]
        assert command.main(typed) == 0
    lines = page.read_text().splitlines()
    assert lines[:5] == ["# Studies", "", "| study |", "|---|", "| `dice` | six |"]
    assert lines[5].startswith(
        "| `coins` | `scripts/study coins --seeds 3` | 50 % are | 3 heads; 1 of 1 within limits | "
    )
    assert re.search(r" \| `[0-9a-f]{7,40}(-dirty)?` \|$", lines[5])
    assert lines[6:] == ["", "| rate |", "|---|"]
    assert command.main(["coins", "--record", str(tmp_path / "none.md")]) == 2


def test_each_part_of_a_study_has_its_row(monkeypatch, tmp_path):
    def options(parser):
        seeds(2, "coins")(parser)
        parser.add_argument("--part")

    def toss(chosen, _report_progress):
        return Outcome(f"{chosen.part} {chosen.seeds}", [])

    monkeypatch.setattr(command, "STUDIES", (Study("coins", "50 % are", toss, options),))
    page = tmp_path / "studies.md"
    page.write_text("| study |\n|---|\n| `dice` | six |\n")
    for part, count in (("euro", "2"), ("yen", "2"), ("euro", "3"), ("yen", "4")):
        typed = ["coins", "--part", part, "--seeds", count, "--record", str(page)]
        assert command.main(typed) == 0
    rows = [line.split(" | ") for line in page.read_text().splitlines()]
    assert [row[3] for row in rows[3:]] == ["euro 3", "yen 4"]


def test_pooled_limits_are_the_binomials_where_every_flight_has_one_event():
    """Four standard errors of 400 at 95 %: 380 -+ 17.4."""
    assert pooled_limits([(1, 400)], 0.95) == (363, 397)
    # 100 flights of four events that come together: sqrt(4) times as wide, and no more than all.
    assert pooled_limits([(4, 100)], 0.95) == (346, 400)
