# SPDX-License-Identifier: BSD-3-Clause
"""Text out of a file that may be damaged, fit to be shown on a line."""

from __future__ import annotations


def one_line(text: object) -> str:
    """The printable characters; a question mark for others."""
    return "".join(c if c.isprintable() else "?" for c in str(text)).strip()
