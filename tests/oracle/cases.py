# SPDX-License-Identifier: BSD-3-Clause
"""The problems that sepcal and the oracle both solve: model, record, truth, noise, bounds."""

from dataclasses import dataclass, field

from oracle.five_hole_probe import FiveHoleProbe
from oracle.magnetometer import Magnetometer
from oracle.model import Array, Model
from oracle.scalar_examples import ScalarExample1, ScalarExample2
from oracle.simulate import (
    FIVE_HOLE_NOISE,
    FIVE_HOLE_TRUTH,
    MAGNETOMETER_NOISE,
    MAGNETOMETER_TRUTH,
    SCALAR_1_TRUTH,
    SCALAR_2_TRUTH,
    SCALAR_NOISE,
    Columns,
    simulate_five_hole,
    simulate_magnetometer,
    simulate_scalar,
    simulate_vane_boom,
)
from oracle.vane_boom import VaneBoom

K_ALPHA, K_BETA = 4.5, 4.6  # [1/rad]; unequal, so that exchanging them shows
LEVER_ARM = (0.35, -0.1, -0.02)  # [m]
FLOW_BOUNDS = {
    "lambda_alpha": (-0.5, 0.5),
    "b_alpha": (-0.17, 0.17),
    "lambda_beta": (-0.5, 0.5),
    "b_beta": (-0.17, 0.17),
    "eps_phi": (-0.26, 0.26),
}


@dataclass(frozen=True)
class Case:
    """One problem; `bounds` are those of the nonlinear parameters, in the model's order."""

    name: str
    model: Model
    record: Columns
    truth: Array  # xi, shape (n,)
    noise: Array  # standard deviation of each output, shape (n_z,)
    bounds: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def noise_by_output(self) -> dict[str, float]:
        """The noise as a caller of a fit gives it."""
        return dict(zip(self.model.outputs, map(float, self.noise), strict=True))


def state_case(name: str) -> Case:
    """The problem of that name, always the same one."""
    if name == "scalar_1":
        first = ScalarExample1()
        record = simulate_scalar(first, SCALAR_1_TRUTH, seed=1)
        return Case(name, first, record, SCALAR_1_TRUTH, SCALAR_NOISE, {"b": (-1.0, 1.0)})
    if name == "scalar_2":
        second = ScalarExample2()
        record = simulate_scalar(second, SCALAR_2_TRUTH, seed=2)
        bounds = {"b": (-0.3, 0.3), "c": (-1.0, 1.0)}
        return Case(name, second, record, SCALAR_2_TRUTH, SCALAR_NOISE, bounds)
    if name == "five_hole":
        probe = FiveHoleProbe(K_ALPHA, K_BETA, LEVER_ARM)
        record = simulate_five_hole(probe, seed=3, rows=500)
        return Case(name, probe, record, FIVE_HOLE_TRUTH, FIVE_HOLE_NOISE, FLOW_BOUNDS)
    if name == "vane_boom":
        boom = VaneBoom(LEVER_ARM)
        record = simulate_vane_boom(boom, seed=5, rows=500)
        return Case(name, boom, record, FIVE_HOLE_TRUTH, FIVE_HOLE_NOISE, FLOW_BOUNDS)
    if name == "magnetometer":
        sensor = Magnetometer()
        record = simulate_magnetometer(sensor, seed=4, rows=500)
        bounds = dict.fromkeys(sensor.nonlinear, (-0.5, 0.5))
        return Case(name, sensor, record, MAGNETOMETER_TRUTH, MAGNETOMETER_NOISE, bounds)
    raise ValueError(f"no case '{name}'; there are: {', '.join(CASE_NAMES)}")


CASE_NAMES = ("scalar_1", "scalar_2", "five_hole", "vane_boom", "magnetometer")
