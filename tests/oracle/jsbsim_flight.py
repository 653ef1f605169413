# SPDX-License-Identifier: BSD-3-Clause
"""A Cessna 172 flown by JSBSim: 40 s at 50 Hz, 3-2-1-1 by the elevator, doublets by the others.

JSBSim integrates over a turning, round Earth with its own tables of aerodynamics, engine and
propeller: nothing that sepcal assumes but Newton and Euler.
"""

import tempfile
from pathlib import Path

import numpy as np

FOOT = 0.3048  # m
POUND = 4.4482216152605  # N
SLUG = POUND / FOOT  # kg
RATE = 50  # Hz
STEPS = 10  # of JSBSim, a row
DURATION = 40.0  # s

# What is read off JSBSim, in SI: property and factor.
PROPERTIES = {
    "u": ("velocities/u-fps", FOOT),
    "v": ("velocities/v-fps", FOOT),
    "w": ("velocities/w-fps", FOOT),
    "airspeed": ("velocities/vt-fps", FOOT),
    "alpha": ("aero/alpha-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "phi": ("attitude/phi-rad", 1.0),
    "theta": ("attitude/theta-rad", 1.0),
    "psi": ("attitude/psi-rad", 1.0),
    "p": ("velocities/p-rad_sec", 1.0),
    "q": ("velocities/q-rad_sec", 1.0),
    "r": ("velocities/r-rad_sec", 1.0),
    "p_inertial": ("velocities/pi-rad_sec", 1.0),
    "q_inertial": ("velocities/qi-rad_sec", 1.0),
    "r_inertial": ("velocities/ri-rad_sec", 1.0),
    "udot": ("accelerations/udot-ft_sec2", FOOT),
    "vdot": ("accelerations/vdot-ft_sec2", FOOT),
    "wdot": ("accelerations/wdot-ft_sec2", FOOT),
    "pdot": ("accelerations/pdot-rad_sec2", 1.0),
    "qdot": ("accelerations/qdot-rad_sec2", 1.0),
    "rdot": ("accelerations/rdot-rad_sec2", 1.0),
    "fx": ("forces/fbx-total-lbs", POUND),
    "fy": ("forces/fby-total-lbs", POUND),
    "fz": ("forces/fbz-total-lbs", POUND),
    "roll_moment": ("moments/l-total-lbsft", POUND * FOOT),
    "pitch_moment": ("moments/m-total-lbsft", POUND * FOOT),
    "yaw_moment": ("moments/n-total-lbsft", POUND * FOOT),
    "rho": ("atmosphere/rho-slugs_ft3", SLUG / FOOT**3),
    "mass": ("inertia/mass-slugs", SLUG),
    "Ix": ("inertia/ixx-slugs_ft2", SLUG * FOOT**2),
    "Iy": ("inertia/iyy-slugs_ft2", SLUG * FOOT**2),
    "Iz": ("inertia/izz-slugs_ft2", SLUG * FOOT**2),
    "Ixz": ("inertia/ixz-slugs_ft2", -SLUG * FOOT**2),  # JSBSim reports the matrix's element
    "elevator": ("fcs/elevator-pos-rad", 1.0),
    "aileron": ("fcs/right-aileron-pos-rad", 1.0),
    "rudder": ("fcs/rudder-pos-rad", 1.0),
}


def command(t: float) -> dict[str, float]:
    """Of the stick and the pedals beside the trim, each within +-1."""

    def pulse(begin: float, end: float) -> float:
        return float(begin <= t < end)

    def doublet(begin: float, width: float) -> float:
        return pulse(begin, begin + width) - pulse(begin + width, begin + 2 * width)

    steps = pulse(2, 3.5) - pulse(3.5, 4.5) + pulse(4.5, 5) - pulse(5, 5.5)
    return {
        "elevator": 0.25 * steps + 0.2 * doublet(28, 1.2) - 0.2 * doublet(34, 0.8),
        "aileron": 0.25 * doublet(10, 1.0) - 0.25 * doublet(20, 1.0) - 0.2 * doublet(31, 0.7),
        "rudder": 0.4 * doublet(14, 1.2) - 0.4 * doublet(24, 1.2) + 0.3 * doublet(37, 0.8),
    }


def fly() -> dict[str, np.ndarray]:
    """Columns by name, SI, with `time`. Needs jsbsim, which writes a file of its own."""
    with tempfile.TemporaryDirectory() as folder:
        return _fly(folder)


def _fly(folder: str) -> dict[str, np.ndarray]:
    import jsbsim

    jsbsim.FGJSBBase().debug_lvl = 0
    # Its aircraft lie in its package, which it looks for in the environment's own packages alone.
    sim = jsbsim.FGFDMExec(str(Path(jsbsim.__file__).parent))
    sim.set_debug_level(0)
    sim.set_output_path(folder)
    sim.load_model("c172x")
    sim.set_dt(1.0 / (RATE * STEPS))
    start = {"h-sl-ft": 4000, "vc-kts": 95, "gamma-deg": 0, "lat-gc-deg": 40, "psi-true-deg": 30}
    for name, value in start.items():
        sim[f"ic/{name}"] = value
    sim["propulsion/set-running"] = -1
    sim["fcs/mixture-cmd-norm"] = 0.9
    sim["fcs/throttle-cmd-norm"] = 0.7
    for place, weight in enumerate((180, 180, 110, 110, 120, 0)):  # as loaded, Ixy isn't zero
        sim[f"inertia/pointmass-weight-lbs[{place}]"] = weight
    sim.run_ic()
    sim["simulation/do_simple_trim"] = 1
    trim = {name: sim[f"fcs/{name}-cmd-norm"] for name in ("elevator", "aileron", "rudder")}
    columns: dict[str, list[float]] = {name: [] for name in ("time", *PROPERTIES)}
    begin = sim.get_sim_time()
    for k in range(int(DURATION * RATE) * STEPS + 1):
        if k % STEPS == 0:
            columns["time"].append(sim.get_sim_time() - begin)
            for name, (known_as, factor) in PROPERTIES.items():
                columns[name].append(factor * sim[known_as])
        for name, value in command(sim.get_sim_time() - begin).items():
            sim[f"fcs/{name}-cmd-norm"] = trim[name] + value
        sim.run()
    return {name: np.array(values) for name, values in columns.items()}
