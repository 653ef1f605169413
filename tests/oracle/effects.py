# SPDX-License-Identifier: BSD-3-Clause
"""Models with effects: every effect adds coefficient times phi(driver) to a port of a model.

A port is a name for a place in a model's equations where there is nothing until an effect comes.
The models are written out with all their ports, and differentiated by a complex step.
"""

from abc import abstractmethod
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from oracle.attitude_independent_magnetometer import AttitudeIndependentMagnetometer
from oracle.drivers import Driver, constant, interpolate, lag
from oracle.five_hole_probe import (
    FiveHoleProbe,
    direction,
    misalign,
    rotate_to_navigation,
    turn,
)
from oracle.magnetometer import Magnetometer, compose
from oracle.model import Array, Model, Record
from oracle.pitot_static import PitotStatic, find_air
from oracle.vane_boom import VaneBoom, flank_direction

Ports = Mapping[str, Any]  # arrays (N,) or numbers by port, zero where nothing drives it
AIR_DATA = ("pt", "ps", "dpa", "dpb")
HEAT_RATIO = 1.4  # of air


@dataclass(frozen=True)
class Effect:
    """Coefficients name.component + suffix, then the driver's shape, name.tau."""

    name: str
    ports: Mapping[str, str]  # the port of each component
    driver: Driver = field(default_factory=constant)

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Component by component, the driver's functions within."""
        return tuple(
            f"{self.name}.{component}{suffix}"
            for component in self.ports
            for suffix in self.driver.suffixes
        )

    @property
    def parameters(self) -> tuple[str, ...]:
        """The coefficients and the shape."""
        return self.coefficients + tuple(f"{self.name}.{shape}" for shape in self.driver.shape)

    def add_to(self, ports: defaultdict[str, Any], record: Record, values: Array) -> None:
        """Adds what it does to the ports, for values in the order of `parameters`."""
        phi = self.driver.function(record, values[len(self.coefficients) :])
        coefficients = values[: len(self.coefficients)].reshape(len(self.ports), -1)
        for port, of_component in zip(self.ports.values(), coefficients, strict=True):
            ports[port] = ports[port] + of_component @ phi


class WithEffects(Model):
    """A model and its effects; their parameters follow the model's, whatever their kind.

    `reach` [s]: rows nearer than that to an end of the record are not used.
    """

    def __init__(self, model: Model, effects: tuple[Effect, ...], reach: float = 0.0) -> None:
        self.base = model
        self.effects = effects
        self.reach = reach

    @property
    def outputs(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those of the model."""
        return self.base.outputs

    @property
    def parameters(self) -> tuple[str, ...]:
        """The model's, then each effect's."""
        return self.base.parameters + tuple(
            name for effect in self.effects for name in effect.parameters
        )

    def predict(self, record: Record, xi: Array) -> Array:
        """The outputs without noise, shape (n_z, rows in use)."""
        return self.respond(record, xi)[:, self.rows_used(record)]

    def respond(self, record: Record, xi: Array) -> Array:
        """The same in every row, shape (n_z, N)."""
        n = len(self.base.parameters)
        ports: defaultdict[str, Any] = defaultdict(float)
        first = n
        for effect in self.effects:
            last = first + len(effect.parameters)
            effect.add_to(ports, record, xi[first:last])
            first = last
        return self.compute(record, xi[:n], ports)

    @abstractmethod
    def compute(self, record: Record, xi: Array, ports: Ports) -> Array:
        """The outputs in every row, the model's own xi and its ports given."""

    def jacobian(self, record: Record, xi: Array) -> Array:
        """The derivative of predict by a complex step: exact to rounding."""
        steps = 1e-30j * np.eye(xi.size)
        return np.stack([self.predict(record, xi + step).imag / 1e-30 for step in steps], axis=-1)

    def measured(self, record: Record) -> Array:
        """The outputs as measured in the rows in use."""
        return self.base.measured(record)[:, self.rows_used(record)]

    def rows_used(self, record: Record) -> Array:
        """Boolean, shape (N,)."""
        time = record["time"]
        margin = self.reach - 1e-9
        return np.asarray((time - time[0] >= margin) & (time[-1] - time >= margin))


class FiveHoleWithEffects(WithEffects):
    """V = C_b^n [R_z(yaw) R_y(pitch) C(eps) V_s - w x (r + dr)] + W; v, alpha, beta as read."""

    base: FiveHoleProbe

    def compute(self, record: Record, xi: Array, ports: Ports) -> Array:
        """Vn, ve, vd [m/s], shape (3, N)."""
        lambda_va, b_va, *_, lambda_alpha, b_alpha, lambda_beta, b_beta, eps = xi
        air = self._find_air_data(record, ports)
        as_read = self.base.read(air)
        dynamic = air["pt"] - air["ps"]
        speed = np.sqrt(2 * (dynamic + ports["pressure_offset"]) / air["rho"])
        if "temperature_error" in ports:
            speed = speed * (1 + ports["temperature_error"] / (2 * record["temperature"]))
        mach_square = 5 * ((dynamic / air["ps"] + 1) ** (2 / 7) - 1)
        compressible = np.sqrt(HEAT_RATIO * air["ps"] / air["rho"] * mach_square)
        true_speed = (
            (
                1
                + lambda_va
                + ports["airspeed_scale"]
                + ports["angle_loss"] * (1 - (np.cos(as_read.alpha) * np.cos(as_read.beta)) ** 2)
            )
            * speed
            + b_va
            + ports["airspeed_bias"]
            + ports["compressibility"] * (compressible - as_read.speed)
        )
        alpha = (
            as_read.alpha + ports["alpha_offset"] + ports["upwash"] * record["q"] / as_read.speed
        )
        beta = as_read.beta + ports["beta_offset"] + ports["sidewash"] * record["p"] / as_read.speed
        in_vehicle = misalign(eps) @ (
            true_speed
            * direction((1 + lambda_alpha) * alpha + b_alpha, (1 + lambda_beta) * beta + b_beta)
        )
        return _over_ground(in_vehicle, self.base.lever_arm, record, xi, ports)

    def _find_air_data(self, record: Record, ports: Ports) -> dict[str, Array]:
        """Pressures and density at the time of the row, undelayed: u(t + tau), p + tau dp/dt."""
        air = {name: record[name] for name in (*AIR_DATA, "rho")}
        if "air_delay" in ports:
            shift = ports["air_delay"][0]
            air = {name: interpolate(record["time"], column, shift) for name, column in air.items()}
        if "air_lag" in ports:
            for name in AIR_DATA:
                slope = interpolate(record["time"], record[name], 0.0, derivative=1)
                air[name] = air[name] + ports["air_lag"] * slope
        return air


class VaneBoomWithEffects(WithEffects):
    """The same of a boom: v of rho v^2 / 2 and its offset, two vanes with a time of their own."""

    base: VaneBoom

    def compute(self, record: Record, xi: Array, ports: Ports) -> Array:
        """Vn, ve, vd [m/s], shape (3, N)."""
        lambda_va, b_va, *_, lambda_alpha, b_alpha, lambda_beta, b_beta, eps = xi
        read = {name: record[name] for name in ("airspeed", "alpha", "beta", "rho")}
        for port, names in (("air_delay", tuple(read)), ("vane_delay", ("alpha", "beta"))):
            if port in ports:
                shift = ports[port][0]
                for name in names:
                    read[name] = interpolate(record["time"], read[name], shift)
        for port, names in (("air_lag", ("airspeed",)), ("vane_lag", ("alpha", "beta"))):
            if port in ports:
                for name in names:
                    slope = interpolate(record["time"], record[name], 0.0, derivative=1)
                    read[name] = read[name] + ports[port] * slope
        impact = read["rho"] * read["airspeed"] ** 2 / 2
        speed = np.sqrt(2 * (impact + ports["pressure_offset"]) / read["rho"])
        scale = lambda_va + ports["airspeed_scale"]
        if "temperature_error" in ports:
            scale = scale + ports["temperature_error"] / (2 * record["temperature"])
        if "angle_loss" in ports:
            flow = flank_direction(record["alpha"], record["beta"])
            scale = scale + ports["angle_loss"] * (flow[1] ** 2 + flow[2] ** 2)
        if "compressibility" in ports:
            own = record["rho"] * record["airspeed"] ** 2 / 2
            mach_square = 5 * ((own / record["ps"] + 1) ** (2 / 7) - 1)
            sound = np.sqrt(HEAT_RATIO * record["ps"] / record["rho"])
            share = sound * np.sqrt(mach_square) / record["airspeed"] - 1
            scale = scale + ports["compressibility"] * share
        true_speed = (1 + scale) * speed + b_va + ports["airspeed_bias"]
        v = record["airspeed"]
        alpha = read["alpha"] + ports["alpha_offset"] + ports["upwash"] * record["q"] / v
        beta = read["beta"] + ports["beta_offset"] + ports["sidewash"] * record["p"] / v
        along = flank_direction(
            (1 + lambda_alpha) * alpha + b_alpha, (1 + lambda_beta) * beta + b_beta
        )
        in_vehicle = misalign(eps) @ (true_speed * along)
        return _over_ground(in_vehicle, self.base.lever_arm, record, xi, ports)


class MagnetometerWithEffects(WithEffects):
    """m = C h + n and what its ports add; h turned and delayed first, m lagging last."""

    base: Magnetometer

    def compute(self, record: Record, xi: Array, ports: Ports) -> Array:
        """Mx, my, mz [uT], shape (3, N)."""
        h = np.stack([record[name] for name in ("hx", "hy", "hz")])
        if "delay" in ports:
            shift = -ports["delay"][0]
            h = np.stack([interpolate(record["time"], axis, shift) for axis in h])
        if "declination" in ports:
            to_navigation = rotate_to_navigation(record)
            turned = _turn_about_down(turn(to_navigation, h), ports["declination"])
            h = turn(to_navigation.transpose(0, 2, 1), turned)
        tilt_x, tilt_y = ports["tilt_x"], ports["tilt_y"]
        h = h + np.stack([-h[2] * tilt_y, h[2] * tilt_x, h[0] * tilt_y - h[1] * tilt_x])
        reading = compose(xi) @ h + xi[3:6, np.newaxis]
        own = [
            ports[f"bias_{axis}"]
            + (ports["scale"] + ports[f"axis_scale_{axis}"]) * h[i]
            + ports[f"cubic_{axis}"] * h[i] ** 3
            + ports[f"square_{axis}"] * h[i] ** 2
            + sum(ports[f"eddy_{axis}{other}"] * self._rate(record, other) for other in "xyz")
            for i, axis in enumerate("xyz")
        ]
        reading = reading + np.stack(own)
        if "lag" in ports:
            tau = ports["lag"][0]
            reading = np.stack([lag(record["time"], axis, tau) for axis in reading])
        return reading

    def _rate(self, record: Record, axis: str) -> Array:
        """One component of dh/dt = -w x h."""
        rates = np.stack([record[name] for name in "pqr"])
        h = np.stack([record[name] for name in ("hx", "hy", "hz")])
        return np.asarray(-np.cross(rates, h, axis=0)["xyz".index(axis)])


class PitotStaticWithEffects(WithEffects):
    """z = s_va V_met + c_va with what drives the tube, the wind and the time axis."""

    base: PitotStatic

    def compute(self, record: Record, xi: Array, ports: Ports) -> Array:
        """The reading [m/s], shape (1, N)."""
        columns = dict(record)
        if "delay" in ports:
            for name in ("vn", "ve", "vd"):
                columns[name] = interpolate(record["time"], record[name], -ports["delay"][0])
        columns["airspeed_scale"] = ports["airspeed_scale"] + self._known_scale(record, ports)
        columns["airspeed_bias"] = ports["airspeed_bias"]
        columns["pressure_offset"] = ports["pressure_offset"]
        zero = np.zeros_like(record["vn"])
        wind = xi[2:5, np.newaxis] + np.stack(
            [ports[name] + zero for name in ("wind_n", "wind_e", "wind_d")]
        )
        reading = xi[0] * find_air(columns, wind).met + xi[1]
        if "lag" in ports:
            reading = lag(record["time"], reading, ports["lag"][0])
        return np.asarray(reading)[np.newaxis]

    def _known_scale(self, record: Record, ports: Ports) -> Any:
        """Scales whose driver is physics: 1 / 2T, and v_c / v - 1 of the impact pressure dp."""
        scale: Any = 0.0
        if "temperature_error" in ports:
            scale = scale + ports["temperature_error"] / (2 * record["temperature"])
        if "compressibility" in ports:
            mach_square = 5 * ((record["dp"] / record["ps"] + 1) ** (2 / 7) - 1)
            compressible = np.sqrt(HEAT_RATIO * record["ps"] / record["rho"] * mach_square)
            as_read = np.sqrt(2 * record["dp"] / record["rho"])
            scale = scale + ports["compressibility"] * (compressible / as_read - 1)
        return scale


class NormWithEffects(WithEffects):
    """The magnetometer of known strength: bias acts on the reading, scales on the diagonal of C."""

    base: AttitudeIndependentMagnetometer

    def compute(self, record: Record, xi: Array, ports: Ports) -> Array:
        """Minus the whitened misfit of the strength [uT], shape (1, N)."""
        columns = dict(record)
        for axis in "xyz":
            columns[f"m{axis}"] = record[f"m{axis}"] - ports[f"bias_{axis}"]
            columns[f"axis_scale_{axis}"] = (
                ports["scale"] + ports[f"axis_scale_{axis}"] + np.zeros_like(record["mx"])
            )
        return self.base.predict(columns, xi)


def _over_ground(
    in_vehicle: Array,
    lever_arm: tuple[float, float, float],
    record: Record,
    xi: Array,
    ports: Ports,
) -> Array:
    """The velocity of a vehicle whose probe meets that air, in the vehicle's axes, (3, N) each."""
    arm = np.stack(
        [
            r + ports[f"lever_{axis}"] * np.ones_like(record["p"])
            for r, axis in zip(lever_arm, "xyz", strict=True)
        ]
    )
    rates = np.stack([record[name] for name in "pqr"])
    in_vehicle = in_vehicle - np.cross(rates, arm, axis=0)
    in_vehicle = _turn_about_down(
        _turn_about_right(in_vehicle, ports["mount_pitch"]), ports["mount_yaw"]
    )
    attitude = {
        "roll": record["roll"],
        "pitch": record["pitch"],
        "yaw": record["yaw"] - ports["heading_error"],
    }
    wind = xi[2:5, np.newaxis] + np.stack(
        [ports[name] * np.ones_like(record["p"]) for name in ("wind_n", "wind_e", "wind_d")]
    )
    return turn(rotate_to_navigation(attitude), in_vehicle) + wind


def _turn_about_right(vectors: Array, angle: Any) -> Array:
    """R_y(angle) times each column of (3, N): nose up where positive."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = vectors
    return np.stack([cos * x + sin * z, y, cos * z - sin * x])


def _turn_about_down(vectors: Array, angle: Any) -> Array:
    """R_z(angle) times each column of (3, N): from north towards east where positive."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = vectors
    return np.stack([cos * x - sin * y, sin * x + cos * y, z])
