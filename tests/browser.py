# SPDX-License-Identifier: BSD-3-Clause
"""Headless Chromium, without a network: what becomes of a page."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest


def find_browser() -> str:
    """Chromium; a test is skipped where there is none."""
    names = ("chromium", "chromium-browser", "google-chrome", "chrome")
    found = next((path for name in names if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("no Chromium on this machine (Debian: apt-get install chromium)")
    return found


def show(page: Path, profile: Path, *flags: str) -> tuple[str, str, list[str]]:
    """The document as it is in the end, its <html> element and what the console says.

    `flags` are more of Chromium's own.
    """
    shown = subprocess.run(
        [find_browser(), "--headless=new", "--no-sandbox", "--disable-gpu",
         "--enable-logging=stderr", "--host-resolver-rules=MAP * ~NOTFOUND",
         f"--user-data-dir={profile}", "--virtual-time-budget=60000", "--window-size=1200,900",
         "--dump-dom", *flags, page.as_uri()],
        capture_output=True, text=True, check=False, timeout=240,
    )  # fmt: skip
    root = re.search(r"<html[^>]*>", shown.stdout)
    assert root is not None, shown.stderr[-2000:]
    return shown.stdout, root[0], [at for at in shown.stderr.splitlines() if "CONSOLE" in at]
