# SPDX-License-Identifier: BSD-3-Clause
"""Do the standard errors of an airspeed calibration hold where the noise is pink?"""

from concurrent.futures import ThreadPoolExecutor

import sepcal

tube = sepcal.PitotStatic()
trial = sepcal.SimulatedTrial(tube, simulation={"rows": 400, "noise": "pink"}, samples=100)
print(sepcal.monte_carlo(trial, trials=200, executor=ThreadPoolExecutor))
