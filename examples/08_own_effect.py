# SPDX-License-Identifier: BSD-3-Clause
"""An effect of your own: a motor whose field grows with the square of its current."""

import sepcal

flight = sepcal.simulate("magnetometer", hide={"bias[current_a^2]": (0.02, -0.01, 0.03)}, rate=10)
base = sepcal.fit(sepcal.Magnetometer(field=(19.7, -1.4, 49.4)), flight)

motor = sepcal.Effect("motor", lambda log: log["current_a"] ** 2, port="bias", unit="uT/A^2")
better = base.add(motor)

print(better)
step = better.history[-1]
print(f"{step.effect}: rmse {step.rmse_before:.2f} -> {step.rmse_after:.2f} uT")
print(better.apply(flight)["mx_cal_ut"])
