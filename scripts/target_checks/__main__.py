# SPDX-License-Identifier: BSD-3-Clause
"""Runs every check on FOLDER/cortex-m7 and FOLDER/host, as scripts/target built them.

Usage: python -m target_checks FOLDER   1 where something is not as promised
"""

from __future__ import annotations

import sys
from pathlib import Path

from target_checks.bad_records import check_bad_records
from target_checks.corrections import check_corrections
from target_checks.images import check_images, measure_images
from target_checks.machines import Checks
from target_checks.recursion import check_recursion
from target_checks.streams import check_streams


def main() -> int:
    """Prints what holds, then sizes and counts."""
    folder = Path(sys.argv[1]).resolve()
    checks = Checks()
    lines: list[str] = []
    for check in (check_images, check_corrections, check_recursion, check_streams):
        lines += check(folder, checks)
    lines += check_bad_records(folder, checks)
    print("\n".join([*measure_images(folder), *lines]))
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
