# SPDX-License-Identifier: BSD-3-Clause
"""Holds the target against this machine, for scripts/target.

Usage: python -m target_checks headers FOLDER   exports calibrations as C headers there
       python -m target_checks check FOLDER     runs every check on FOLDER;
                                                1 where something is not as promised
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from target_checks.bad_records import check_bad_records
from target_checks.changing import check_band, check_changing
from target_checks.corrections import check_corrections, check_headers, write_headers
from target_checks.from_c import check_from_c
from target_checks.images import check_images, measure_images
from target_checks.machines import Checks
from target_checks.recursion import check_recursion
from target_checks.streams import check_streams

CHECKS = (
    check_images,
    check_corrections,
    check_headers,
    check_recursion,
    check_streams,
    check_changing,
    check_band,
    check_bad_records,
    check_from_c,
)


def check_all(folder: Path) -> int:
    """Prints what holds, then sizes and counts; 1 where something does not hold."""
    results = [Checks() for _ in CHECKS]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        counts = list(pool.map(lambda check, checks: check(folder, checks), CHECKS, results))
    for checks in results:
        print("\n".join(checks.lines))
    print("\n".join([*measure_images(folder), *(line for lines in counts for line in lines)]))
    return int(any(checks.failed for checks in results))


def main() -> int:
    """Does what the command line says."""
    folder = Path(sys.argv[2]).resolve()
    if sys.argv[1] == "headers":
        write_headers(folder)
        return 0
    return check_all(folder)


if __name__ == "__main__":
    sys.exit(main())
