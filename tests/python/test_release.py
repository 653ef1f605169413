# SPDX-License-Identifier: BSD-3-Clause
"""scripts/release in a repository of its own, where tests, wheel and site take no time."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import tarfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NEVER = "the tests ran, and what came before them should have refused the release"
SCRIPTS = {
    "test": f'echo "{NEVER}" >&2; exit 1',
    "wheel": """python3 - "$1" <<'END'
import sys, zipfile
with zipfile.ZipFile(sys.argv[1] + "/sepcal-0.1.0-py3-none-any.whl", "w") as wheel:
    wheel.write("/bin/true", "true")
END""",
    "docs": 'mkdir "$1" && echo "<title>sepcal</title>" >"$1/index.html"',
}

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not (ROOT / ".git").exists(), reason="no list of the sources"),
    pytest.mark.skipif(not (ROOT / ".venv").exists(), reason="scripts/setup makes .venv"),
]


class Checkout:
    """A copy of the sources with a history of two commits, ready to be released."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        for name in names.strip("\0").split("\0"):
            if (ROOT / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, folder / name)
        (folder / ".venv").symlink_to(ROOT / ".venv")
        self.git("init", "--quiet", "--initial-branch", "main")
        self.git("config", "user.name", "someone")
        self.git("config", "user.email", "someone@example.org")
        for name, body in SCRIPTS.items():
            self.write_script(name, body)
        for page in (folder / "docs").rglob("*.md"):
            page.write_text(page.read_text().replace("Measured at ", "Was measured at "))
        changelog = folder / "CHANGELOG.md"
        changelog.write_text(
            changelog.read_text().replace("## 0.1.0, unreleased", "## 0.1.0, 2026-12-24")
        )
        self.commit()

    def write_script(self, name: str, body: str) -> None:
        """One of scripts/."""
        script = self.folder / "scripts" / name
        script.write_text(f"#!/bin/sh\n{body}\n")
        script.chmod(0o755)

    def git(self, *arguments: str) -> str:
        """What git prints."""
        done = subprocess.run(
            ["git", *arguments], cwd=self.folder, capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    def commit(self) -> str:
        """All that there is."""
        self.git("add", ".")
        self.git("commit", "--quiet", "--allow-empty", "-m", "Change something")
        return self.git("rev-parse", "--short", "HEAD")

    def release(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Runs the script."""
        return subprocess.run(
            ["scripts/release", *arguments],
            cwd=self.folder, env=os.environ, capture_output=True, text=True, check=False,
        )  # fmt: skip

    def reset(self) -> None:
        """As it was made."""
        self.git("switch", "--quiet", "main")
        self.git("reset", "--quiet", "--hard", "ready")
        self.git("clean", "--quiet", "--force", "-d")
        for tag in self.git("tag", "--list", "v*").split():
            self.git("tag", "--delete", tag)
        shutil.rmtree(self.folder / "dist", ignore_errors=True)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    """One for all tests."""
    checkout = Checkout(tmp_path_factory.mktemp("release") / "sepcal")
    checkout.git("tag", "ready")
    return checkout


@pytest.fixture
def checkout(made: Checkout) -> Checkout:
    """As it was made."""
    made.reset()
    return made


def spoil_tree(checkout: Checkout) -> None:
    (checkout.folder / "new.txt").write_text("")


def spoil_branch(checkout: Checkout) -> None:
    checkout.git("switch", "--quiet", "--force-create", "feature")


def spoil_date(checkout: Checkout) -> None:
    file = checkout.folder / "CHANGELOG.md"
    file.write_text(file.read_text().replace("0.1.0, 2026-12-24", "0.1.0, unreleased"))
    checkout.commit()


def spoil_tag(checkout: Checkout) -> None:
    checkout.git("tag", "v0.1.0")


def spoil_page(checkout: Checkout) -> None:
    first = checkout.git("rev-list", "--max-parents=0", "HEAD")
    page = checkout.folder / "docs" / "coins.md"
    page.write_text(f"# Coins\n\nMeasured at commit `{first[:8]}`; rooms: noise.\n")
    source = checkout.folder / "cpp" / "src" / "noise" / "new.cpp"
    source.write_text("")
    checkout.commit()


def spoil_wheel(checkout: Checkout) -> None:
    (checkout.folder / "scripts" / "wheel").unlink()
    checkout.commit()


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (spoil_tree, "new.txt"),
        (spoil_branch, "feature, not main"),
        (spoil_date, "no date"),
        (spoil_tag, "a tag v0.1.0 already"),
        (spoil_page, "measured pages are older"),
        (spoil_wheel, "no scripts/wheel"),
    ],
)
def test_a_release_is_refused_before_the_tests(checkout: Checkout, spoil, reason: str) -> None:
    spoil(checkout)
    refused = checkout.release("0.1.0")
    assert refused.returncode == 1
    assert reason in refused.stderr
    assert refused.stderr.count("\n") == 1
    assert NEVER not in refused.stderr
    assert not (checkout.folder / "dist").exists()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "takes a version"),
        (["0.1"], "takes a version"),
        (["0.2.0"], "CMakeLists.txt has version 0.1.0, not 0.2.0"),
        (["0.1.0", "0.2.0"], "takes one version"),
        (["0.1.0", "--dry"], "unknown option --dry"),
        (["0.1.0", "--no-test"], "is for a dry run"),
    ],
)
def test_bad_usage_is_one_line(checkout: Checkout, arguments: list[str], reason: str) -> None:
    refused = checkout.release(*arguments)
    assert refused.returncode == 1
    assert reason in refused.stderr
    assert refused.stderr.count("\n") == 1


def test_a_version_that_the_changelog_lacks_is_refused(checkout: Checkout) -> None:
    file = checkout.folder / "CMakeLists.txt"
    file.write_text(file.read_text().replace("VERSION 0.1.0", "VERSION 0.2.0"))
    checkout.commit()
    refused = checkout.release("0.2.0", "--dry-run", "--no-test")
    assert refused.returncode == 1
    assert "CHANGELOG.md has no heading" in refused.stderr


def test_a_failed_test_leaves_nothing(checkout: Checkout) -> None:
    refused = checkout.release("0.1.0")
    assert refused.returncode == 1
    assert NEVER in refused.stderr
    assert not (checkout.folder / "dist").exists()
    assert checkout.git("tag", "--list", "v*") == ""


def check_sums(dist: Path) -> set[str]:
    """The files of SHA256SUMS, which are right and all that there are."""
    names = set()
    for line in (dist / "SHA256SUMS").read_text().splitlines():
        digest, name = line.split()
        assert hashlib.sha256((dist / name).read_bytes()).hexdigest() == digest
        names.add(name)
    assert {file.name for file in dist.iterdir()} == names | {"SHA256SUMS"}
    return names


@pytest.mark.slow
def test_a_release_is_whole_and_tagged(checkout: Checkout) -> None:
    checkout.write_script("test", "exit 0")
    checkout.commit()
    done = checkout.release("0.1.0")
    assert done.returncode == 0, done.stderr
    dist = checkout.folder / "dist"
    assert check_sums(dist) == {
        "sepcal-0.1.0.tar.gz",
        "sepcal-0.1.0-py3-none-any.whl",
        "sepcal-0.1.0-site.tar.gz",
        "sepcal-0.1.0.spdx.json",
    }
    with tarfile.open(dist / "sepcal-0.1.0.tar.gz") as packed:
        names = {name.partition("/")[2] for name in packed.getnames()}
    assert {"tests/CMakeLists.txt", "docs/paper.md", "lab/measured.py", "PKG-INFO"} <= names
    bill = json.loads((dist / "sepcal-0.1.0.spdx.json").read_text())
    assert [file["fileName"] for file in bill["files"]] == ["./sepcal-0.1.0-py3-none-any/true"]
    assert checkout.git("cat-file", "-t", "v0.1.0") == "tag"
    notes = checkout.git("tag", "--list", "--format=%(contents)", "v0.1.0")
    assert notes.startswith("## 0.1.0, 2026-12-24")
    assert checkout.git("status", "--porcelain") == ""


def test_a_dry_run_says_what_it_leaves_out_and_why_a_release_is_refused(checkout: Checkout) -> None:
    spoil_date(checkout)
    spoil_page(checkout)
    spoil_wheel(checkout)
    spoil_branch(checkout)
    done = checkout.release("0.1.0", "--dry-run", "--no-test")
    assert done.returncode == 0, done.stderr
    assert "sepcal-0.1.0.tar.gz" in check_sums(checkout.folder / "dist")
    last = done.stdout[done.stdout.index("dist/ has:") :]
    for reason in ("no date", "pages are older", "no scripts/wheel", "feature, not main"):
        assert f"{reason}" in last, last
    assert "left out: scripts/test" in last
    assert "left out: wheels" in last
    assert checkout.git("tag", "--list", "v*") == ""


def test_old_pages_can_be_allowed(checkout: Checkout) -> None:
    spoil_page(checkout)
    refused = checkout.release("0.1.0", "--allow-old-pages")
    assert NEVER in refused.stderr  # as far as the tests
    assert "docs/coins.md" in refused.stdout
