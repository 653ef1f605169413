# SPDX-License-Identifier: BSD-3-Clause
"""A five-hole probe calibrated from a log: 03_five_hole.py FLIGHT.csv BASE.json CORRECTED.csv."""

import sys

import sepcal

log, base_json, corrected_csv = sys.argv[1:]

flight = sepcal.read_csv(log)
probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
base = sepcal.fit(probe, flight)
base.save(base_json)
base.apply_to_file(log, corrected_csv)

print(base)
