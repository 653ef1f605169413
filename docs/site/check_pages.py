# SPDX-License-Identifier: BSD-3-Clause
"""The finished site: every link and anchor leads somewhere, nothing is loaded from elsewhere.

python docs/site/check_pages.py FOLDER prints what doesn't hold and ends with 1 where there is some.
"""

from __future__ import annotations

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADING = {
    ("script", "src"),
    ("img", "src"),
    ("link", "href"),
    ("iframe", "src"),
    ("object", "data"),
}
HINTS = {"canonical", "search", "author"}  # rel of links that load nothing


class Page(HTMLParser):
    """Its anchors, its links and what it loads."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.anchors: set[str] = {"", "top"}
        self.links: list[tuple[str, bool]] = []  # and whether it is loaded with the page
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """One element."""
        named = dict(attributes)
        self.anchors |= {named[key] or "" for key in ("id", "name") if key in named}
        for key in ("href", "src", "data"):
            if named.get(key) and tag != "meta":
                loaded = (tag, key) in LOADING and named.get("rel") not in HINTS
                self.links.append((named[key] or "", loaded))


def find_faults(folder: Path) -> list[str]:
    """One line each."""
    pages = {file.resolve(): Page(file) for file in folder.rglob("*.html")}
    faults = []
    for file, page in pages.items():
        for link, loaded in page.links:
            parts = urlsplit(link)
            name = f"{file.relative_to(folder.resolve())}: {link[:120]}"
            if parts.scheme or parts.netloc:
                if loaded and parts.scheme != "data":
                    faults.append(f"{name} is loaded from elsewhere")
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not target.exists():
                faults.append(f"{name} is not there")
            elif target in pages and unquote(parts.fragment) not in pages[target].anchors:
                faults.append(f"{name} has no such anchor")
    return faults


if __name__ == "__main__":
    found = find_faults(Path(sys.argv[1]))
    print("\n".join(found))
    sys.exit(bool(found))
