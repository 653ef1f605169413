# SPDX-License-Identifier: BSD-3-Clause
"""Flights from vehicles' own logs, PX4's ULog and ArduPilot's DataFlash."""

from sepcal.logs.flights import LoggedFlight, read_log
from sepcal.logs.listing import LogContents, list_log

__all__ = ["LogContents", "LoggedFlight", "list_log", "read_log"]
