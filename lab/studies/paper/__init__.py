# SPDX-License-Identifier: BSD-3-Clause
"""The paper's tables and figures again, its rivals beside it, and where its claims hold."""

from studies.paper.command import STUDY

__all__ = ["STUDY"]
