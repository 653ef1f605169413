#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A header as Doxygen takes it: comments beside members and atop files become its own form.

`double x;  // text` becomes `double x;  ///< text`, with the lines that go on below it; the comment
that opens a file becomes the file's. What Doxygen would take for a command, a tag or emphasis is
escaped; code between backticks and words in quotes are kept, as Doxygen does.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

BESIDE = re.compile(r"^(?P<code>\s*[^\s/#}].*?)\s*// (?P<text>.*)$")
BELOW = re.compile(r"^\s+// (?P<text>.*)$")
WHOLE = re.compile(r"^(?P<mark>\s*///<?)(?P<text> .*)$")
KEPT = re.compile(r'(`[^`]*`|"[^"<>]*")')
SPECIAL = re.compile(r"[\\@<>#%&*]")


def escape(text: str) -> str:
    """The text, set by Doxygen as it stands."""
    parts = KEPT.split(text)
    parts[::2] = [SPECIAL.sub(lambda mark: "\\" + mark[0], part) for part in parts[::2]]
    return "".join(parts)


def filter_lines(lines: list[str]) -> list[str]:
    """The lines of a header, as many as there were."""
    done: list[str] = []
    opening, beside = True, False
    for line in lines:
        opening = opening and line.startswith("//")
        if opening:
            is_licence = "SPDX" in line
            done.append("/// \\file" if is_licence else "///" + escape(line[2:]))
        elif line == "/*" and len(done) == 1:  # atop a header of C
            done.append("/** \\file")
        elif whole := WHOLE.match(line):
            done.append(whole["mark"] + escape(whole["text"]))
            beside = False
        elif found := BESIDE.match(line):
            done.append(f"{found['code']}  ///< {escape(found['text'])}")
            beside = True
        elif beside and (found := BELOW.match(line)):
            done.append(f"  ///< {escape(found['text'])}")
        else:
            done.append(line)
            beside = False
    return done


if __name__ == "__main__":
    header = Path(sys.argv[1]).read_text(encoding="utf-8")
    sys.stdout.write("\n".join(filter_lines(header.splitlines())) + "\n")
