# SPDX-License-Identifier: BSD-3-Clause
"""scripts/parts/page_ages.py on a repository of its own, and the lines of the pages that ship."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import measured

ROOT = Path(__file__).resolve().parents[2]
PARTS = ROOT / "scripts" / "parts"
sys.path.insert(0, str(PARTS))

import page_ages  # noqa: E402

ROOMS = """
[noise]
may_include = []
public = ["noise_model"]
[diagnosis]
may_include = ["noise"]
public = []
"""
needs_history = pytest.mark.skipif(not (ROOT / ".git").exists(), reason="no history to ask")
MEASURED = ("case-studies", "hidden-effects", "nist", "paper", "performance", "studies")


class Repository:
    """A checkout with two rooms and a study."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir()
        self.git("init", "--quiet", "--initial-branch", "main")
        self.git("config", "user.name", "someone")
        self.git("config", "user.email", "someone@example.org")
        self.first = self.change("cpp/rooms.toml", ROOMS)
        for name in ("cpp/src/noise/a.cpp", "cpp/src/diagnosis/b.cpp", "lab/studies/coins.py"):
            self.first = self.change(name, "1")

    def git(self, *arguments: str) -> str:
        """What git prints."""
        done = subprocess.run(
            ["git", *arguments], cwd=self.folder, capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    def change(self, name: str, text: str) -> str:
        """Commits a file's new text and returns the commit."""
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        self.git("add", ".")
        self.git("commit", "--quiet", "-m", name)
        return self.git("rev-parse", "--short", "HEAD")

    def write_page(self, line: str) -> None:
        """docs/page.md with that line."""
        self.change("docs/page.md", f"# A page\n\n{line}\n\nText.\n")

    def ages(self, *options: str) -> subprocess.CompletedProcess[str]:
        """Runs the program."""
        return subprocess.run(
            [sys.executable, PARTS / "page_ages.py", *options, str(self.folder)],
            capture_output=True, text=True, check=False,
        )  # fmt: skip

    def age(self) -> tuple[str, int | None]:
        """Commit and age of the one page."""
        (age,) = page_ages.find_ages(self.folder)
        return age.commit, age.commits


@pytest.fixture
def repository(tmp_path: Path) -> Repository:
    """A new one."""
    return Repository(tmp_path / "project")


def test_a_page_ages_by_commits_to_its_rooms_alone(repository: Repository) -> None:
    repository.write_page(f"Measured at commit `{repository.first}`; rooms: noise.")
    assert repository.age() == (repository.first, 0)
    repository.change("cpp/src/diagnosis/b.cpp", "2")
    assert repository.age() == (repository.first, 0)
    repository.change("cpp/src/noise/a.cpp", "2")
    repository.change("cpp/include/sepcal/noise_model.hpp", "1")
    assert repository.age() == (repository.first, 2)
    repository.write_page(f"Measured at commit `{repository.first}`; rooms: noise, lab/studies.")
    repository.change("lab/studies/coins.py", "2")
    assert repository.age() == (repository.first, 3)


def test_a_merge_is_no_change(repository: Repository) -> None:
    repository.write_page(f"Measured at commit `{repository.first}`; rooms: noise, diagnosis.")
    repository.git("switch", "--quiet", "--create", "branch")
    repository.change("cpp/src/noise/a.cpp", "2")
    repository.git("switch", "--quiet", "main")
    repository.change("cpp/src/diagnosis/b.cpp", "2")
    repository.git("merge", "--quiet", "--no-ff", "--no-edit", "branch")
    assert repository.age() == (repository.first, 2)


def test_a_page_is_as_old_as_the_oldest_of_its_tables(repository: Repository) -> None:
    later = repository.change("cpp/src/noise/a.cpp", "2")
    repository.change("cpp/src/noise/a.cpp", "3")
    repository.write_page(
        f"Measured at the commits below; rooms: noise.\n\n| `{later}` |\n| `{repository.first}` |"
    )
    assert repository.age() == (repository.first, 2)
    repository.write_page(f"Measured at the commits below; rooms: noise.\n\n| `{later}` |")
    assert repository.age() == (later, 1)


def test_a_limit_is_kept(repository: Repository) -> None:
    repository.write_page(f"Measured at commit `{repository.first}`; rooms: noise.")
    assert repository.ages("--most", "0").returncode == 0
    repository.change("cpp/src/noise/a.cpp", "2")
    assert repository.ages().returncode == 0
    assert repository.ages("--most", "1").returncode == 0
    refused = repository.ages("--most", "0")
    assert refused.returncode == 1
    assert refused.stdout.split() == ["docs/page.md", repository.first, "1", "commits"]


@pytest.mark.parametrize("commit", ["0123456789ab", "{first}-dirty"])
def test_an_age_that_can_not_be_known_is_too_old(repository: Repository, commit: str) -> None:
    repository.write_page(
        f"Measured at commit `{commit.format(first=repository.first)}`; rooms: noise."
    )
    refused = repository.ages("--most", "1000")
    assert refused.returncode == 1
    assert "unknown: " in refused.stdout


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("Measured at commit 0123abc; rooms: noise.", "not of the form"),
        ("Measured at commit `0123abc`.", "not of the form"),
        ("Measured at the commits below; rooms: noise.", "no `commit` is below"),
        ("Measured at commit `0123abc`; rooms: noise, attic.", "attic is neither"),
    ],
)
def test_a_line_that_can_not_be_read_is_refused(
    repository: Repository, line: str, complaint: str
) -> None:
    repository.write_page(line)
    refused = repository.ages()
    assert refused.returncode == 2
    assert complaint in refused.stderr
    assert refused.stderr.count("\n") == 1


def test_the_measured_pages_say_what_they_measured() -> None:
    pages = [page_ages.read_page(file) for file in (ROOT / "docs").rglob("*.md")]
    named = {page.file.stem: page for page in pages if page is not None}
    assert set(MEASURED) <= set(named)
    house = page_ages.read_house(ROOT / "cpp")
    for page in named.values():
        assert page_ages.paths_of(page, house, ROOT)


@needs_history
def test_what_writes_a_page_writes_a_line_that_can_be_read(tmp_path: Path) -> None:
    file = tmp_path / "page.md"
    file.write_text(f"# A page\n\n{measured.measured_line(['noise', 'lab/studies'])}\n")
    page = page_ages.read_page(file)
    assert page is not None
    assert page.rooms == ("noise", "lab/studies")
    assert page.commits == (measured.find_commit(),)


@needs_history
def test_a_line_is_renewed_and_the_rest_stays() -> None:
    page = "# A page\n\nMeasured at commit `0123abc`; rooms: noise.\n\nText.\n"
    assert measured.renew_line(page) == page.replace("0123abc", measured.find_commit())
    with pytest.raises(ValueError, match="0 lines"):
        measured.renew_line("# A page\n")
