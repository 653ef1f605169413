# SPDX-License-Identifier: BSD-3-Clause
"""Sensors of three axes in canonical form, put together of parts."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from sepcal import _core
from sepcal.columns import Array
from sepcal.matrices import to_matrix
from sepcal.own_model import Row, Table, check_parts, to_rows

__all__ = [
    "CrossCoupling",
    "Factor",
    "FieldInBody",
    "Misalignment",
    "Reference",
    "SpecificForceInBody",
    "Triad",
]


def __dir__() -> list[str]:
    """The public names, without what they are made of."""
    return __all__


class Reference(Protocol):
    """A triad's reference: tables `inputs`, `outputs` (three), `nonlinear` (may be empty).

    Example:
        >>> class Rates:  # of a gyroscope, in body axes
        ...     inputs = {"p": "rad/s", "q": "rad/s", "r": "rad/s"}
        ...     outputs = {"gx": "rad/s", "gy": "rad/s", "gz": "rad/s"}
        ...     nonlinear = {}
        ...     def at(self, u, xi):
        ...         return np.column_stack(u)
        ...
        >>> sepcal.Triad(Rates(), sepcal.triads.Misalignment()).linear[3]
        ('n_x', 'rad/s')
    """

    inputs: Table
    outputs: Table
    nonlinear: Table

    def at(self, u: Any, xi: Array, /) -> ArrayLike:  # noqa: ANN401
        """The vector, (N, 3), from the inputs (a named tuple of (N,)) and its own parameters."""


class Factor(Protocol):
    """A matrix through which it sees; a table `nonlinear` of its own parameters.

    Example:
        >>> class Turned:  # about the vertical axis alone
        ...     nonlinear = {"psi": ("rad", -0.5, 0.5)}
        ...     def matrix(self, xi):
        ...         c, s = np.cos(xi[0]), np.sin(xi[0])
        ...         return [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
        ...
        >>> sepcal.Triad(sepcal.triads.FieldInBody(), Turned()).nonlinear
        [('psi', 'rad', -0.5, 0.5)]
    """

    nonlinear: Table

    def matrix(self, xi: Array, /) -> ArrayLike:
        """(3, 3), of its parameters."""


class _InBody:
    """A reference that is given in body axes and used as it is."""

    nonlinear: Table = ()

    def at(self, u: Any, _xi: Array) -> ArrayLike:  # noqa: ANN401
        """The inputs, (N, 3)."""
        return np.column_stack(u)


class FieldInBody(_InBody):
    """The true field in body axes, as a magnetometer sees it.

    Example:
        >>> compass = sepcal.Triad(sepcal.triads.FieldInBody(), sepcal.triads.CrossCoupling())
        >>> [name for name, _ in compass.outputs]
        ['mx', 'my', 'mz']
    """

    inputs: Table = (("hx", "uT"), ("hy", "uT"), ("hz", "uT"))
    outputs: Table = (("mx", "uT"), ("my", "uT"), ("mz", "uT"))


class SpecificForceInBody(_InBody):
    """The true specific force in body axes; at rest and level fz is -9.81 m/s^2.

    Example:
        >>> unit = sepcal.Triad(sepcal.triads.SpecificForceInBody(), sepcal.triads.Misalignment())
        >>> [name for name, _ in unit.outputs]
        ['ax', 'ay', 'az']
    """

    inputs: Table = (("fx", "m/s^2"), ("fy", "m/s^2"), ("fz", "m/s^2"))
    outputs: Table = (("ax", "m/s^2"), ("ay", "m/s^2"), ("az", "m/s^2"))


class Misalignment:
    """C_eta = I + [eta x]: small angles from the reference's axes to the sensor's (Eq. A2).

    Example:
        >>> [name for name, *_ in sepcal.triads.Misalignment().nonlinear]
        ['eta_x', 'eta_y', 'eta_z']
    """

    nonlinear: Table = tuple((f"eta_{axis}", "rad", -0.5, 0.5) for axis in "xyz")

    def matrix(self, eta: Array) -> Array:
        """I + [eta x].

        Example:
            >>> sepcal.triads.Misalignment().matrix([0.0, 0.0, 0.1])[0].tolist()
            [1.0, -0.1, 0.0]
        """
        x, y, z = eta
        return np.array([[1.0, -z, y], [z, 1.0, -x], [-y, x, 1.0]])


class CrossCoupling:
    """C_alpha, symmetric with a unit diagonal: soft iron, or axes that are not at right angles.

    Example:
        >>> [name for name, *_ in sepcal.triads.CrossCoupling().nonlinear]
        ['alpha_xy', 'alpha_xz', 'alpha_yz']
    """

    nonlinear: Table = tuple((f"alpha_{axes}", "1", -0.5, 0.5) for axes in ("xy", "xz", "yz"))

    def matrix(self, alpha: Array) -> Array:
        """Ones on the diagonal, alpha beside it.

        Example:
            >>> sepcal.triads.CrossCoupling().matrix([0.1, 0.0, 0.0]).tolist()
            [[1.0, 0.1, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.0]]
        """
        xy, xz, yz = alpha
        return np.array([[1.0, xy, xz], [xy, 1.0, yz], [xz, yz, 1.0]])


class Triad:
    """z = N (I + D) f(u, xi') + n, N the factors' product (Sun & Gebre-Egziabher, Eqs. A1 to A4).

        gyro = sepcal.Triad(RatesInBody(), sepcal.triads.Misalignment())
        sepcal.fit(gyro, flight)

    A model as one of yours is. Linear parameters are lambda_x, lambda_y, lambda_z (D) and n_x, n_y,
    n_z in the readings' unit; nonlinear ones the reference's, then each factor's.

    Args:
        reference: The vector that it measures: triads.FieldInBody(), SpecificForceInBody(), or one
            of yours.
        *factors: The one next to the readings first: triads.Misalignment(), CrossCoupling(), yours.

    Raises:
        Error: A part without its tables or function, or not three outputs.

    Example:
        >>> compass = sepcal.Triad(sepcal.triads.FieldInBody(), sepcal.triads.Misalignment())
        >>> list(compass.nonlinear)
        [('eta_x', 'rad', -0.5, 0.5), ('eta_y', 'rad', -0.5, 0.5), ('eta_z', 'rad', -0.5, 0.5)]
    """

    def __init__(self, reference: Reference, *factors: Factor) -> None:
        check_parts(
            reference,
            ("inputs", "outputs", "nonlinear", "at"),
            "reference",
            Reference,
            "sepcal.triads",
        )
        for factor in factors:
            check_parts(factor, ("nonlinear", "matrix"), "factor", Factor, "sepcal.triads")
        self.reference, self.factors = reference, factors
        self.inputs, self.outputs = reference.inputs, reference.outputs
        readings = to_rows("outputs", reference.outputs)
        if len(readings) != 3:
            raise _core.Error(
                f"a triad has three outputs; {type(reference).__name__} has {len(readings)}"
            )
        biases = [(f"n_{axis}", unit) for axis, (_, unit, *_) in zip("xyz", readings, strict=True)]
        self.linear = [*((f"lambda_{axis}", "1", -0.95, None) for axis in "xyz"), *biases]
        nonlinear = [reference.nonlinear, *(factor.nonlinear for factor in factors)]
        tables = [to_rows("nonlinear", table) for table in nonlinear]
        self.nonlinear: list[Row] = [row for table in tables for row in table]
        self._splits = np.cumsum([len(table) for table in tables])[:-1]

    def at(self, u: Any, xi2: Array) -> tuple[Array, Array]:  # noqa: ANN401
        """A (N, 3, 6) and b (N, 3): [N diag(f) | I] and N f.

        Example:
            >>> compass = sepcal.Triad(sepcal.triads.FieldInBody(), sepcal.triads.Misalignment())
            >>> field = {"hx": [20.0], "hy": [0.0], "hz": [40.0]}
            >>> A, b = sepcal.OwnModel(compass).evaluate(field, [0.0] * 3)
            >>> b.tolist()  # a perfect sensor reads the field
            [[20.0, 0.0, 40.0]]
        """
        of_reference, *of_factors = np.split(xi2, self._splits)
        f = to_matrix(f"{type(self.reference).__name__}.at()", self.reference.at(u, of_reference))
        if f.shape[1] != 3:
            raise _core.Error(
                f"{type(self.reference).__name__}.at() gave the shape {f.shape}; it gives (N, 3)"
            )
        N = np.eye(3)
        for factor, xi in zip(self.factors, of_factors, strict=True):
            matrix = to_matrix(f"{type(factor).__name__}.matrix()", factor.matrix(xi))
            if matrix.shape != (3, 3):
                raise _core.Error(
                    f"{type(factor).__name__}.matrix() gave the shape {matrix.shape}; it gives "
                    "(3, 3)"
                )
            N = N @ matrix
        A = np.empty((len(f), 3, 6))
        A[:, :, :3] = N * f[:, None, :]
        A[:, :, 3:] = np.eye(3)
        return A, f @ N.T

    def __repr__(self) -> str:
        parts = ", ".join(f"{type(part).__name__}()" for part in (self.reference, *self.factors))
        return f"Triad({parts})"
