# SPDX-License-Identifier: BSD-3-Clause
"""Flights of another simulator: its physics and its noise are its own, in NumPy."""
