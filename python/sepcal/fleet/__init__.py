# SPDX-License-Identifier: BSD-3-Clause
"""Fleets: many flights of many vehicles."""

from sepcal.fleet.comparison import FleetComparison
from sepcal.fleet.findings import FleetDiagnosis
from sepcal.fleet.fleet import Fleet
from sepcal.fleet.monitoring import Monitoring
from sepcal.fleet.populations import Population

__all__ = ["Fleet", "FleetComparison", "FleetDiagnosis", "Monitoring", "Population"]
