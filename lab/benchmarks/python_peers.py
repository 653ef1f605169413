# SPDX-License-Identifier: BSD-3-Clause
"""Python's other least-squares solvers on stage two of the five-hole probe, R known.

All use the hoisted probe. Compilation and the building of expressions happen once, outside what is
timed, as who fits many flights has them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.five_hole import NOISE, FiveHoleFlight
from benchmarks.numpy_five_hole import HoistedProbe
from benchmarks.race import Competitor, timed

Array = np.ndarray
Solve = Callable[[], Array]
PARAMETERS = 10


def whiten(flight: FiveHoleFlight) -> HoistedProbe:
    """Hoisted, with the known R."""
    probe = flight.hoist()
    probe.set_noise(np.array(NOISE))
    return probe


def use_lmfit(flight: FiveHoleFlight) -> Solve:
    """MINPACK by lmfit, derivatives by hand."""
    import lmfit

    parameters = lmfit.Parameters()
    for k, value in enumerate(flight.start):
        parameters.add(f"x{k}", value=float(value))

    def values(given: Any) -> Array:  # noqa: ANN401
        return np.array([given[name].value for name in given])

    def solve() -> Array:
        probe = whiten(flight)
        minimizer = lmfit.Minimizer(lambda given: probe.residuals(values(given)), parameters)
        found = minimizer.leastsq(Dfun=lambda given: probe.jacobian(values(given)), ftol=1e-10)
        return values(found.params)

    return solve


def use_pyceres(flight: FiveHoleFlight) -> Solve:
    """Ceres from Python: one residual block, evaluated by NumPy, derivatives by hand."""
    import pyceres

    class Cost(pyceres.CostFunction):  # type: ignore[misc]
        def __init__(self, probe: HoistedProbe) -> None:
            pyceres.CostFunction.__init__(self)
            self.set_num_residuals(3 * probe.rows)
            self.set_parameter_block_sizes([PARAMETERS])
            self.probe = probe

        def Evaluate(
            self, blocks: list[Array], residuals: Array, jacobians: list[Array] | None
        ) -> bool:
            """As Ceres asks."""
            residuals[:] = self.probe.residuals(blocks[0])
            if jacobians is not None and jacobians[0] is not None:
                jacobians[0][:] = self.probe.jacobian(blocks[0]).ravel()
            return True

    def solve() -> Array:
        x = flight.start.copy()
        problem = pyceres.Problem()
        problem.add_residual_block(Cost(whiten(flight)), None, [x])
        options = pyceres.SolverOptions()
        options.linear_solver_type = pyceres.LinearSolverType.DENSE_NORMAL_CHOLESKY
        options.num_threads = 1
        options.function_tolerance = 1e-10
        options.logging_type = pyceres.LoggingType.SILENT
        pyceres.solve(options, problem, pyceres.SolverSummary())
        return x

    return solve


def constants_of(probe: HoistedProbe) -> list[Array]:
    """C (9 N, by rows), C (w x r) (3 N), v, alpha, beta (N each) and z (3 N)."""
    return [probe.C.reshape(9, -1), probe.rotation, probe.v, probe.alpha, probe.beta, probe.z]


def residual_rows(x: Any, constants: Any, cos: Any, sin: Any) -> list[Any]:  # noqa: ANN401
    """The three outputs' residuals over their noise, in whatever algebra x has."""
    C, rotation, v, alpha, beta, z = constants
    a = (1.0 + x[5]) * alpha + x[6]
    b = (1.0 + x[7]) * beta + x[8]
    cb, sb, ce, se = cos(b), sin(b), cos(x[9]), sin(x[9])
    up = sin(a) * cb
    d0, d1, d2 = cos(a) * cb, ce * sb + se * up, ce * up - se * sb
    V = (1.0 + x[0]) * v + x[1]
    return [
        (
            z[j]
            - (C[3 * j] * d0 + C[3 * j + 1] * d1 + C[3 * j + 2] * d2) * V
            + rotation[j]
            - x[2 + j]
        )
        / NOISE[j]
        for j in range(3)
    ]


def use_jax(flight: FiveHoleFlight) -> Solve:
    """Levenberg-Marquardt of optimistix on residuals in JAX, compiled."""
    import jax
    import optimistix

    jax.config.update("jax_enable_x64", True)
    solver = optimistix.LevenbergMarquardt(rtol=1e-10, atol=1e-10)

    def residuals(x: Any, constants: Any) -> Any:  # noqa: ANN401
        return jax.numpy.concatenate(residual_rows(x, constants, jax.numpy.cos, jax.numpy.sin))

    def fit(x: Any, constants: Any) -> Any:  # noqa: ANN401
        return optimistix.least_squares(residuals, solver, x, args=constants, max_steps=100).value

    compiled = jax.jit(fit)

    def solve() -> Array:
        constants = [jax.numpy.asarray(one) for one in constants_of(flight.hoist())]
        return np.asarray(compiled(jax.numpy.asarray(flight.start), constants))

    solve()  # compiles
    return solve


def use_casadi(flight: FiveHoleFlight) -> Solve:
    """IPOPT by CasADi, exact second derivatives, all rows in one vectorised expression."""
    import casadi

    x = casadi.MX.sym("x", PARAMETERS)
    stacked = np.vstack([np.atleast_2d(one) for one in constants_of(flight.hoist())])  # (18, N)
    p = casadi.MX.sym("p", flight.rows, len(stacked))
    columns = casadi.horzsplit(p)
    constants = [columns[:9], columns[9:12], columns[12], columns[13], columns[14], columns[15:]]
    rows = residual_rows(x, constants, casadi.cos, casadi.sin)
    cost = 0.5 * sum(casadi.sumsqr(row) for row in rows)
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-8}
    solver = casadi.nlpsol("fit", "ipopt", {"x": x, "f": cost, "p": p}, quiet)

    def solve() -> Array:
        given = np.vstack([np.atleast_2d(one) for one in constants_of(flight.hoist())]).T
        found = solver(x0=flight.start, p=given)
        return np.asarray(found["x"]).ravel()

    return solve


SOLVERS = {
    "lmfit leastsq, derivatives by hand": use_lmfit,
    "pyceres, one block, derivatives by hand": use_pyceres,
    "JAX with optimistix": use_jax,
    "CasADi with IPOPT": use_casadi,
}


def python_peers(flight: FiveHoleFlight) -> list[Competitor]:
    """Those that are installed; of another one a line says that it is left out."""
    competitors = []
    for name, use in SOLVERS.items():
        try:
            competitors.append(Competitor(name, timed(use(flight))))
        except ImportError as error:
            print(f"{name} is left out: {error}")
    return competitors
