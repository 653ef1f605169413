# SPDX-License-Identifier: BSD-3-Clause
"""Studies that anyone can rerun: `scripts/study NAME`. A module or folder each."""
