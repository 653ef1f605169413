# SPDX-License-Identifier: BSD-3-Clause
"""The models, z = A(u, xi2) xi1 + b(u, xi2) + v: names, units and bounds of their tables."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.arguments import checked
from sepcal.columns import Array, Columns, labels_in, take_columns
from sepcal.states_module import states_module

Vector = Sequence[float]  # three of them


class Model:
    """A separable model (Sun & Gebre-Egziabher, Eq. 4); use one of the subclasses.

    Attributes:
        inputs: Names of u that data must have.
        optional_inputs: Those that data may lack, by name, and the value that they then take.
        outputs: Names of z, n_z of them.
        linear: Names of xi1, n_1.
        nonlinear: Names of xi2, n_2.
        units: Unit of every input, output and parameter by name.
        bounds: Default (lower, upper) of every parameter by name, in its unit; infinite where open.

    Example:
        >>> tube = sepcal.PitotStatic()
        >>> isinstance(tube, sepcal.Model), tube.outputs, tube.units["w_n"]
        (True, ('airspeed',), 'm/s')
    """

    runs_in_python = False  # it then lets one thread in at a time

    def __init__(self, core: _core.Model) -> None:
        self._core = core
        tables = (core.inputs, core.outputs, core.linear, core.nonlinear)
        inputs, self.outputs, self.linear, self.nonlinear = (
            tuple(name for name, *_ in table) for table in tables
        )
        self.optional_inputs = {
            name: absent for name, *_, absent in core.inputs if np.isfinite(absent)
        }
        self.inputs = tuple(name for name in inputs if name not in self.optional_inputs)
        self._constant = {name for name, *_, absent in core.outputs if np.isfinite(absent)}
        self.units = {name: unit for table in tables for name, unit, *_ in table}
        self.bounds = {
            name: (lower, upper) for table in tables[2:] for name, _, lower, upper, _ in table
        }

    @property
    def parameters(self) -> tuple[str, ...]:
        """Linear, then nonlinear: the order of every estimate and covariance."""
        return self.linear + self.nonlinear

    def evaluate(
        self,
        record: Columns,
        xi2: Mapping[str, float] | ArrayLike,
        xi1: Mapping[str, float] | ArrayLike | None = None,
    ) -> tuple[Array, ...]:
        """A and b of every sample and, where xi1 is given, D = d(A xi1 + b)/d xi2.

        Args:
            record: The inputs by name, each of shape (N,), in the units of the table; other columns
                are ignored.
            xi2: The n_2 nonlinear parameters, by name or in the table's order.
            xi1: The n_1 linear parameters likewise.

        Returns:
            A (N, n_z, n_1) and b (N, n_z), or A, b and D (N, n_z, n_2): views of one buffer. D is
            exact, by automatic differentiation; of a model in Python, what its derivatives() give,
            or differences of fourth order.

        Raises:
            Error: An input is missing or of another length, a parameter is missing or unknown.

        Example:
            >>> A, b = sepcal.ScalarExample1().evaluate({"eta": [0.0]}, {"b": 0.0})
            >>> A.tolist(), b.tolist()
            ([[[1.0, 1.0]]], [[1.0]])
        """
        columns = take_columns(self._owner, record, self._columns_in(record))
        core = self._core.along(columns, labels_in(record))
        linear, nonlinear = (
            tuple(name for name, *_ in table) for table in (core.linear, core.nonlinear)
        )
        at = _to_point("xi2", xi2, nonlinear)
        along = None if xi1 is None else _to_point("xi1", xi1, linear)
        rows = core.evaluate(columns, at, along)
        n_z, n_1 = len(self.outputs), len(linear)
        rows = rows.reshape((-1, n_z, rows.shape[1]), order="F")  # output after output, by columns
        if along is None:
            return rows[:, :, :n_1], rows[:, :, -1]
        return rows[:, :, :n_1], rows[:, :, -1], rows[:, :, n_1:-1]

    def at_noise(self, noise: Mapping[str, float]) -> "Model":
        """The model where its outputs have these standard deviations: itself, unless it depends.

        Example:
            >>> tube = sepcal.PitotStatic()
            >>> tube.at_noise({"airspeed": 0.3}) is tube
            True
        """
        del noise
        return self

    @property
    def _owner(self) -> str:
        """The model's name in messages."""
        return type(self).__name__

    def _columns_in(self, data: Columns) -> list[str]:
        """The inputs to take from data: those that it must have, and the optional ones there."""
        there = set(data)
        return [*self.inputs, *(name for name in self.optional_inputs if name in there)]

    def _measured_in(self, data: Columns) -> list[str]:
        """The outputs to take from data: all but one that is a constant and not there."""
        there = set(data)
        return [name for name in self.outputs if name in there or name not in self._constant]

    def __reduce__(self) -> tuple[Any, ...]:
        make: Callable[..., Model] = type(self)
        return partial(make, **self._settings()), ()

    def __repr__(self) -> str:
        settings = ", ".join(f"{name}={value!r}" for name, value in self._settings().items())
        return f"{type(self).__name__}({settings})"

    def _settings(self) -> dict[str, float | tuple[float, ...]]:
        """The constructor's arguments by name."""
        return {}


class ScalarExample1(Model):
    """z = (1 + a) cos(eta + b) + c (Eqs. 21, 22); linear a, c, nonlinear b [rad].

    Example:
        >>> sepcal.ScalarExample1().nonlinear
        ('b',)
    """

    def __init__(self) -> None:
        super().__init__(_core.scalar_example_1())


class ScalarExample2(Model):
    """z = (1 + a) cos(eta (1 + b) + c) + d (Eq. 33); linear a, d, nonlinear b, c [rad].

    Example:
        >>> sepcal.ScalarExample2().nonlinear
        ('b', 'c')
    """

    def __init__(self) -> None:
        super().__init__(_core.scalar_example_2())


@checked
class Accelerometer(Model):
    """Three accelerometers against the true specific force in body axes (Eqs. A1 to A4).

    z = C_eta (I + D) f + n: scale errors lambda_x, lambda_y, lambda_z, biases n_x, n_y, n_z
    [m/s^2], small misalignments eta_x, eta_y, eta_z [rad]. triads.Triad puts others together.

    Example:
        >>> sepcal.Accelerometer().outputs
        ('ax', 'ay', 'az')
    """

    def __init__(self) -> None:
        super().__init__(_core.accelerometer())


@checked
class DampedSinusoids(Model):
    """Damped sinusoids out of samples, what Prony's method looks for.

    z = sum_k exp(-damping_k t) (cos_k cos(omega_k t) + sin_k sin(omega_k t)) + offset, times as
    irregular as they may be. The fastest comes first: omega_1 = frequency_1 [rad/s], omega_2 =
    ratio_2 omega_1, omega_3 = ratio_3 omega_2, ratios within 0 and 1. A fit needs bounds of
    frequency_1, which the sampling rate allows (below pi over its interval), and of the dampings.

    Args:
        modes: 1 to 6.

    Raises:
        Error: Another number of modes.

    Example:
        >>> sepcal.DampedSinusoids(1).nonlinear
        ('frequency_1', 'damping_1')
    """

    def __init__(self, modes: int = 1) -> None:
        self.modes = modes
        super().__init__(states_module().damped_sinusoids(modes))

    def _settings(self) -> dict[str, Any]:
        return {"modes": self.modes}


@checked
class FiveHoleProbe(Model):
    """A five-hole Pitot probe against the inertial velocity (Eqs. 36-42).

    V = C_b^n [C(eps) V_s - w x r] + W: the velocity over the ground from the air data, the attitude
    and a steady wind.

    Args:
        k_alpha: Sensitivity of the angle-of-attack ports, dp/(pt - ps) per radian [1/rad].
        k_beta: The same of the sideslip ports [1/rad].
        lever_arm: From the velocity's reference point to the probe, body axes [m].

    Raises:
        Error: A sensitivity is not positive.

    Example:
        >>> probe = sepcal.FiveHoleProbe(k_alpha=4.5, k_beta=4.5, lever_arm=(0.35, 0.0, -0.02))
        >>> probe.outputs
        ('vn', 've', 'vd')
    """

    name = "five-hole"

    def __init__(
        self, *, k_alpha: float, k_beta: float, lever_arm: Vector = (0.0, 0.0, 0.0)
    ) -> None:
        self.k_alpha, self.k_beta = float(k_alpha), float(k_beta)
        self.lever_arm = _to_vector("lever_arm", lever_arm)
        super().__init__(_core.five_hole_probe(self.k_alpha, self.k_beta, self.lever_arm))

    def _settings(self) -> dict[str, float | tuple[float, ...]]:
        return {"k_alpha": self.k_alpha, "k_beta": self.k_beta, "lever_arm": self.lever_arm}


@checked
class VaneBoom(Model):
    """A boom with two vanes and a Pitot tube, against the velocity over the ground.

    V = C_b^n [C(eps) V_s - w x r] + W as of a five-hole probe, but a vane's angle is that in its
    plane: tan alpha = w / u and tan beta = v / u, a flank angle. A flight logs alpha_* and beta_*,
    and dp_pa with the density, or else airspeed_mps.

    Args:
        lever_arm: From the velocity's reference point to the boom's head, body axes [m].

    Raises:
        Error: The lever arm has other than three numbers, or one is not finite.

    Example:
        >>> sepcal.VaneBoom().outputs
        ('vn', 've', 'vd')
    """

    name = "vane-boom"

    def __init__(self, *, lever_arm: Vector = (0.0, 0.0, 0.0)) -> None:
        self.lever_arm = _to_vector("lever_arm", lever_arm)
        super().__init__(_core.vane_boom(self.lever_arm))

    def _settings(self) -> dict[str, float | tuple[float, ...]]:
        return {"lever_arm": self.lever_arm}


@checked
class PitotStatic(Model):
    """A plain Pitot-static tube against the ground velocity: z = s_va |v_ground - W| + c_va.

    The wind W is nonlinear; its component w_d is held at zero unless fit(..., free=["w_d"]) frees
    it. A Calibration's `derived` has lambda_va and b_va, which correct the reading as in the
    five-hole probe. A flight logs airspeed_mps, or dp_pa and the density.

    Example:
        >>> sepcal.PitotStatic().linear
        ('s_va', 'c_va')
    """

    name = "pitot-static"

    def __init__(self) -> None:
        super().__init__(_core.pitot_static())


@checked
class Magnetometer(Model):
    """A three-axis magnetometer against a known field (Eqs. B1-B3), or against its strength.

    m = C_alpha C_eta C_lambda h + n: soft iron, misalignment and scale of the true field h in body
    axes, and hard iron n [uT].

    Args:
        field: The Earth's field, north, east, down [uT]; None where the flight logs it.
        field_strength: Only |h| [uT] is known: no attitude is needed, and a rotation, C_eta, can't
            be seen. Every parameter is nonlinear; the output `field` is zero in every row. "auto":
            nothing is known, and it is taken for the mean radius of the readings' ellipsoid in the
            flight of a fit, in the readings' own unit or counts.
        mounting: Roll, pitch, yaw [deg] by which the sensor is turned against the body, as
            autopilots have it, or a quaternion w, x, y, z from the sensor's axes to the body's: a
            Flight's readings are turned so before anything else. "estimate": as the flight of a
            fit shows it.

    Raises:
        Error: Two of these contradict each other, the strength is not positive, or a quaternion is
            not of length one.

    Example:
        >>> flight = sepcal.datasets.load("magnetometer")
        >>> base = sepcal.fit(sepcal.Magnetometer(), flight)
        >>> round(base["n_x"].value), flight.truth["n_x"]
        (15, 12.0)
    """

    def __init__(
        self,
        field: Vector | None = None,
        *,
        field_strength: float | Literal["auto"] | None = None,
        mounting: Sequence[float] | Literal["estimate"] | None = None,
    ) -> None:
        if field is not None and field_strength is not None:
            raise _core.Error("field and field_strength contradict each other; give one")
        if mounting is not None and field_strength is not None:
            raise _core.Error(
                "mounting is of no use to field_strength: a strength is the same however the "
                "sensor is turned; leave it out"
            )
        if isinstance(mounting, str) and mounting != "estimate":
            raise _core.Error(f'mounting is {mounting!r}; give three angles [deg] or "estimate"')
        strength_alone = ", north, east, down, or the field's strength alone as field_strength"
        self.field = None if field is None else _to_vector("field", field, strength_alone)
        if isinstance(field_strength, str) and field_strength != "auto":
            raise _core.Error(
                f'field_strength is {field_strength!r}; give a number in uT, or "auto"'
            )
        self.field_strength = (
            field_strength
            if field_strength is None or isinstance(field_strength, str)
            else float(field_strength)
        )
        self.mounting = (
            mounting if mounting is None or isinstance(mounting, str) else _to_turn(mounting)
        )
        self.name = "magnetometer" if self.field_strength is None else "magnetometer-norm"
        turned = () if self.mounting == "estimate" else self.mounting
        super().__init__(
            _core.magnetometer(self.field, turned)
            if self.field_strength is None
            else _core.attitude_independent_magnetometer(self._strength())
        )

    def at_noise(self, noise: Mapping[str, float]) -> Model:
        """For a fit by field strength: noise makes readings longer, which the model corrects.

        Example:
            >>> sensor = sepcal.Magnetometer(field_strength=50.0)
            >>> sensor.at_noise({"field": 0.1}).nonlinear == sensor.nonlinear
            True
        """
        if self.field_strength is None:
            return self
        if self._strength() is None:
            raise _core.Error(
                "field_strength='auto' is found in the flight of a fit; give it in uT"
            )
        return Model(_core.attitude_independent_magnetometer(self._strength(), noise["field"]))

    def _strength(self) -> float | None:
        """None where the flight of a fit is to show it."""
        return None if isinstance(self.field_strength, str) else self.field_strength

    def _settings(self) -> dict[str, Any]:
        if self.field_strength is not None:
            return {"field_strength": self.field_strength}
        given = {"field": self.field, "mounting": self.mounting}
        return {name: value for name, value in given.items() if value is not None}


def _to_turn(mounting: Sequence[float]) -> tuple[float, float, float]:
    """Roll, pitch, yaw [deg], of these or of a quaternion."""
    quaternion_parts = 4
    if len(mounting) == quaternion_parts:
        roll, pitch, yaw = _core.angles_of_quaternion([float(part) for part in mounting])
        return roll, pitch, yaw
    return _to_vector("mounting", mounting, ': roll, pitch, yaw [deg], or "estimate"')


def _to_vector(name: str, values: Vector, otherwise: str = "") -> tuple[float, float, float]:
    """Three numbers. Raises Error for any other count; `otherwise` is one more way out."""
    numbers = tuple(np.atleast_1d(np.asarray(values, dtype=np.float64)).tolist())
    if len(numbers) != 3:
        count = "1 number" if len(numbers) == 1 else f"{len(numbers)} numbers"
        raise _core.Error(f"{name} has {count}; give three{otherwise}")
    return numbers


def _to_point(owner: str, values: Mapping[str, float] | ArrayLike, names: tuple[str, ...]) -> Array:
    """Parameters in the table's order, (n,). Raises Error for other names or another count."""
    if isinstance(values, Mapping):
        if set(values) != set(names):
            given = ", ".join(values) or "none"
            raise _core.Error(f"{owner} takes {', '.join(names) or 'none'}; it was given: {given}")
        values = [values[name] for name in names]
    point = np.asarray(values, dtype=np.float64)
    if point.shape != (len(names),):
        raise _core.Error(
            f"{owner} takes {len(names)} numbers, {', '.join(names)}; it was given the shape "
            f"{point.shape}"
        )
    return point
