# SPDX-License-Identifier: BSD-3-Clause
"""Strings that no name should be: pieces that some language minds, drawn and joined by a seed.

A language here is what a string enters when it leaves sepcal: C, a file of parameters, HTML, JSON,
a shell, a terminal.
"""

import random
import unicodedata

PIECES = [
    # C and C++
    "*/", "/*", "*", "/", "//", "\\", "\\\n", "\\ \n", "??/", "??/\n", "#if 1", '";', "int x;",
    "system(cmd);", "NAN", "%s", "{0}", "0x1p-3",
    # ends of lines, of every kind
    "\n", "\r", "\r\n", "\v", "\f", "\x1c", "\x1d", "\x1e", "\x85", "\u2028", "\u2029", "\t", "\0",
    # terminals
    "\x1b[31m", "\x1b]0;title\x07", "\x1bP1$r\x1b\\", "\x9b2J", "\x9d0;title\x9c", "\x7f", "\b",
    # directions of writing
    "\u061c", "\u200e", "\u200f", "\u202a", "\u202b", "\u202c", "\u202d", "\u202e", "\u2066",
    "\u2067", "\u2068", "\u2069",
    # files of parameters
    "#", "ARMING_CHECK,0", "\nARMING_CHECK,0\n", "1\t1\tSYS_AUTOSTART\t4001\t6", ",", "=",
    # HTML
    "<b>", "</script>", "</title>", "<!--", "-->", "]]>", "<img src=x onerror=alert(1)>",
    "&lt;", "&", "&#x0a;", '" onmouseover="alert(1)', "javascript:alert(1)",
    "<svg/onload=alert(1)>",
    # shells
    "'", '"', "`id`", "$(id)", "${IFS}", "!", ";", "|", "-o", "~", "a b", " ",
    # letters that are no more than letters, some of which join the one before
    "x", "ü", "é", "e\u0301", "\u0300" * 40, "名", "\U0001f680", "\ufeff", "\u200b", "\u200d",
    # long
    "a" * 400,
]  # fmt: skip
STRAY = ["\udc80", "\udcff", "\ud800", "\udfff"]  # bytes that are no UTF-8, and halves of pairs
TURNING = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")  # UAX 9, table 4
MARKS = "\u061c\u200e\u200f"  # of directions too


def hostile_words(count: int, seed: int, pieces: list[str] = PIECES) -> list[str]:
    """Each of one to six pieces; of so many that all have room, each piece alone comes first."""
    draw = random.Random(seed)
    drawn = ["".join(draw.choices(pieces, k=draw.randint(1, 6))) for _ in range(count)]
    return [*pieces, *drawn][:count] if count > 2 * len(pieces) else drawn


def may_not_be_printed(character: str) -> bool:
    """By Unicode's own tables: controls, separators of lines, halves of pairs, directions."""
    return (
        unicodedata.category(character) in ("Cc", "Zl", "Zp", "Cs")
        or unicodedata.bidirectional(character) in TURNING
        or character in MARKS
    )


def find_unprintable(page: str) -> list[str]:
    """What of a page, but for its line ends, should have been escaped."""
    return sorted({hex(ord(c)) for c in page if c != "\n" and may_not_be_printed(c)})
