# SPDX-License-Identifier: BSD-3-Clause
"""Intervals of a calibration with a parameter at its bound, and the band of what it predicts."""

import sepcal

tube = sepcal.PitotStatic()
flight = sepcal.simulate(tube, rows=300)
base = sepcal.fit(tube, flight, bounds={"c_va": (-0.6, 5)})

intervals = base.intervals()
print(intervals)
print(intervals["c_va"].ends)

prediction = base.predict(level=0.9)
lower, upper = prediction.band
print(f"airspeed {prediction.value[0, 0]:.2f} m/s, {lower[0, 0]:.2f} to {upper[0, 0]:.2f}")
lower, upper = prediction.measurement_band
print(f"as measured: {lower[0, 0]:.2f} to {upper[0, 0]:.2f}")
