# SPDX-License-Identifier: BSD-3-Clause
"""An aircraft in Python: its path, its aerodynamics, a regressor that is missing, another flight.

The pitching moment of the simulated aircraft bends with alpha, which the model doesn't know.
"""

import sepcal

aircraft = sepcal.Aircraft(
    area=16.2, chord=1.49, span=10.9, mass=1050, inertia=(1285, 1825, 2667, 60)
)
flight = sepcal.simulate(aircraft, hide={"Cm[alpha^2]": -3}, seed=2)

path = sepcal.fit(sepcal.FlightPath(), flight)
print(f"lambda_alpha {path['lambda_alpha'].value:.3f} +- {path['lambda_alpha'].standard_error:.3f}")

base = sepcal.fit(sepcal.RigidAircraft(aircraft, "longitudinal"), flight)
better = base.add("Cm[alpha^2]")
print(f"rmse of q {base.rmse['q']:.5f} -> {better.rmse['q']:.5f} rad/s")
print(f"Cm_alpha^2 {better['Cm_alpha^2'].value:.2f} +- {better['Cm_alpha^2'].standard_error:.2f}")

smoothed = better.smooth({"u": 0.01, "w": 0.01, "q": 0.002})
print(f"q at 5 s: {smoothed['q'][250]:.4f} +- {smoothed.standard_error[250, 2]:.4f} rad/s")

another = sepcal.simulate(aircraft, hide={"Cm[alpha^2]": -3}, seed=3)
track = better.track(another, method="iekf")
before, after = track.standard_deviation("Cm_q")[[0, -1]]
print(f"along another flight Cm_q is known to {after:.3f}, before it to {before:.3f}")
