# SPDX-License-Identifier: BSD-3-Clause
"""A fleet of eight tubes: what all of them lack, what one of them lacks, and a new vehicle."""

from pathlib import Path

import sepcal

logs = Path("logs")
hidden = {"pressure_offset[throttle]": 8.0}  # [Pa]: too little for one flight
sepcal.datasets.write_fleet(
    logs, vehicles=8, flights=6, hide=hidden, in_last={"wind[altitude_m]": 0.05}
)

fleet = sepcal.Fleet(logs, sepcal.PitotStatic(), names="{vehicle}_{date}.csv", store="fleet")
print(fleet.diagnose())

better = fleet.add("pressure_offset[throttle]", common=True)
print(better)
print(better.diagnose())

population = better.population()
print(population)
short = sepcal.simulate("pitot-static", rows=120, seed=99, hide=hidden)
alone = sepcal.fit(sepcal.PitotStatic(), short)["s_va"].standard_error
known = population.calibrate(short)["s_va"].standard_error
print(f"s_va: error {alone:.4f} alone, {known:.4f} with the fleet")
