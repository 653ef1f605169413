# SPDX-License-Identifier: BSD-3-Clause
"""Studies that anyone can rerun: `python -m sepcal study hidden-effects`."""

from sepcal.study.experiments import StudyOptions, hidden_effects
from sepcal.study.write_up import write_up

__all__ = ["StudyOptions", "hidden_effects", "write_up"]
