# SPDX-License-Identifier: BSD-3-Clause
"""A state model in Python, walked along a block of rows for many trajectories side by side.

C++ asks, and says what is known of the rows, where trajectories begin and which derivatives it
wants. Sensitivities come from the very step that is taken, as there, but by differences: a step of
P trajectories is a step of P * K, each beside its own, moved in one state or parameter.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sepcal.answers import CheckedModel, Layout
from sepcal.columns import Array
from sepcal.differences import BACKWARD, CENTRAL, FORWARD, LINEAR, STEP, Fan, Seeds, step_sizes

NO_DIGITS_LEFT = 1e10  # that a rounding error at the start has grown by


class Path:
    """Where a pass has come to: P trajectories side by side, with w derivatives each."""

    last: Array | None = None  # what was known of the last row
    x: Array | None = None  # (n_x, P); None: none has begun
    S: Array | None = None  # (P, n_x, w)
    start: tuple[Array, Array] | None = None  # of `from_start`: A (n_z, s, P) and slopes of A xi1


class Walk:
    """Called by C++ with a row's knowns: u, time and the measured states, in this order."""

    def __init__(self, owner: str, definition: Any, layout: Layout) -> None:  # noqa: ANN401
        self._layout, self._model = layout, CheckedModel(owner, definition, layout)
        self.start = self._model.start
        self._measured = list(layout.measured)
        self._free = [i for i in range(layout.states) if i not in layout.measured]

    def new_path(self) -> Path:
        """The path of a pass that begins."""
        return Path()

    def walk(
        self,
        path: Path,
        known: Array,
        begins: list[int],
        x0: list[Array],
        p: Array,
        seeds: list[int] | None,
        xi1: Array,
    ) -> tuple[Array, Array, Array]:
        """Along a block, from where the path has come to.

        Args:
            path: Taken along.
            known: (rows, n), of each row.
            begins: Rows at which a trajectory begins.
            x0: (n_x, P) at each of them.
            p: (n_p, P).
            seeds: Those of p whose derivatives are wanted beside the states'; None: none at all.
            xi1: (n_1, P).

        Returns:
            A (n_z, n_1, rows, P), b (n_z, rows, P), and the derivatives of b + A xi1 with respect
            to x(0) of the running trajectory, but for measured states, and to the seeds:
            (n_z, rows, P, w). NaN where no trajectory has begun.
        """
        with np.errstate(all="ignore"):  # of trial points, which may be anywhere
            plan = self._seeds(p, seeds)
            x, S = self._follow(path, known, dict(zip(begins, x0, strict=True)), plan)
            A, b, slopes, from_start = self._read(x, S, known, plan, xi1)
            if self._layout.from_start:
                self._count_from_start(path, begins, A, slopes, from_start)
        return A, b, slopes

    def step(
        self, known: Array, x: Array, p: Array, seeds: list[int]
    ) -> tuple[Array, Array, Array]:
        """From one row to the next, `known` (2, n) of both.

        Returns:
            x at the later row (f,) of the f states that are integrated, from x (f,) at the former,
            and its derivatives with respect to x and the seeds, places in p, (f, f + seeds); and
            noise_input(), (f, n_w), in continuous time the mean of that at both rows.
        """
        with np.errstate(all="ignore"):
            whole = self._whole(x, known[0])
            end, Phi, G = self._steps(known, whole, p[:, np.newaxis], seeds)
            return end[:, 0], Phi[:, 0], G[..., 0]

    def second_order_step(
        self, known: Array, x: Array, p: Array, seeds: list[int]
    ) -> tuple[Array, Array, Array, Array, Array]:
        """As step(), with second derivatives, by differences of differences.

        Returns:
            What step() does, and the derivatives with respect to x and the seeds of dx+/dx, to
            (f, f, f + seeds), and of noise_input(), (f, n_w, f + seeds).
        """
        with np.errstate(all="ignore"):
            plan, points, steps = self._fan_out(x, known[0], p, seeds)
            end, Phi, G = self._steps(known, points, plan.p[:, 0], seeds)
            f = len(self._free)
            return (
                end[:, 0],
                Phi[:, 0],
                G[..., 0],
                np.einsum("ipk,pw->ikw", Phi[..., :f], plan.fan.weights) / steps,
                G @ plan.fan.weights / steps,
            )

    def read(
        self, known: Array, x: Array, p: Array, xi1: Array, seeds: list[int]
    ) -> tuple[Array, Array, Array]:
        """The expected readings of a row, `known` (1, n), at x (f,).

        Returns:
            b + A xi1 (n_z,), its derivatives by x and the seeds (n_z, f + seeds), and A (n_z, n_1).
        """
        with np.errstate(all="ignore"):
            whole = self._whole(x, known[0])
            z, slopes, A = self._readings(known, whole, p[:, np.newaxis], xi1, seeds)
            return z[:, 0], slopes[:, 0], A[..., 0]

    def second_order_reading(
        self, known: Array, x: Array, p: Array, xi1: Array, seeds: list[int]
    ) -> tuple[Array, Array, Array, Array, Array]:
        """As read(), with second derivatives.

        Returns:
            What read() does, and the derivatives with respect to x and the seeds of that by x,
            (n_z, f, f + seeds), and of A by x, (n_z, n_1, f).
        """
        with np.errstate(all="ignore"):
            plan, points, steps = self._fan_out(x, known[0], p, seeds)
            z, slopes, A = self._readings(known, points, plan.p[:, 0], xi1, seeds)
            f = len(self._free)
            return (
                z[:, 0],
                slopes[:, 0],
                A[..., 0],
                np.einsum("jpk,pw->jkw", slopes[..., :f], plan.fan.weights) / steps,
                (A @ plan.fan.weights / steps)[..., :f],
            )

    # --- many points of one row

    def _fan_out(
        self, x: Array, known: Array, p: Array, seeds: list[int]
    ) -> tuple[Seeds, Array, Array]:
        """The fan about x (f,) and p (n_p,): its points (n_x, K) and its steps (w,)."""
        plan = self._seeds(p[:, np.newaxis], seeds)
        whole = self._whole(x, known)
        delta, steps = self._deltas(whole, plan)
        return plan, whole + delta[:, 0], steps[0]

    def _steps(
        self, known: Array, x: Array, p: Array, seeds: list[int]
    ) -> tuple[Array, Array, Array]:
        """The results of step() at P points x (n_x, P) and p (n_p, P): (f, P, ...), (f, n_w, P)."""
        plan = self._seeds(p, seeds)
        delta, steps = self._deltas(x, plan)
        stages, dt = self._stages(known)
        P, K = x.shape[1], delta.shape[2]
        at = np.broadcast_to(stages[0, ..., np.newaxis], (*stages.shape[1:], P * K))
        points = (x[:, :, np.newaxis] + delta).reshape(len(x), P * K)
        end = self._advance(points, plan.p.reshape(len(p), P * K), at, dt[0])
        end = end.reshape(len(x), P, K)
        if self._measured:
            end[self._measured] = known[1, len(self._layout.inputs) + 1 :, np.newaxis, np.newaxis]
        G = self._noise_input(x, stages[0, 0], p)
        if not self._layout.discrete:
            G = 0.5 * (G + self._noise_input(end[..., 0], stages[0, -1], p))
        end = end[self._free]
        return end[..., 0], end @ plan.fan.weights / steps, G[self._free]

    def _noise_input(self, x: Array, known: Array, p: Array) -> Array:
        """G (n_x, n_w, P) at P points of a row."""
        u = np.broadcast_to(
            known[: len(self._layout.inputs), np.newaxis], (len(self._layout.inputs), x.shape[1])
        )
        return self._model.noise_input(x.copy(), u, p)

    def _readings(
        self, known: Array, x: Array, p: Array, xi1: Array, seeds: list[int]
    ) -> tuple[Array, Array, Array]:
        """The results of read() at P points: (n_z, P), (n_z, P, f + seeds), (n_z, n_1, P)."""
        P = x.shape[1]
        plan = self._seeds(p, seeds)
        S = np.zeros((1, P, self._layout.states, len(self._free) + len(seeds)))
        S[0][:, self._free, range(len(self._free))] = 1.0
        linear = np.repeat(xi1[:, np.newaxis], P, axis=1)
        A, b, slopes, _ = self._read(x[np.newaxis], S, known, plan, linear)
        A, b = A[:, :, 0], b[:, 0]
        return b + np.einsum("jkp,kp->jp", A, linear), slopes[:, 0], A

    # --- differences

    def _seeds(self, p: Array, places: list[int] | None) -> Seeds:
        if places is None:
            return Seeds(Fan([]), 0, p[:, :, np.newaxis], np.empty((0, p.shape[1])))
        lower, upper = self._layout.bounds[:, places, np.newaxis]
        values = p[places]
        half = 2.0 ** np.floor(np.log2(0.5 * STEP * (upper - lower)))
        steps = np.minimum(step_sizes(values), half)
        below = (values - 2 * steps < lower).any(axis=1)
        above = (values + 2 * steps > upper).any(axis=1)
        stencils = [
            LINEAR if place in self._layout.linear_dynamic
            else FORWARD if low else BACKWARD if high else CENTRAL
            for place, low, high in zip(places, below, above, strict=True)
        ]  # fmt: skip
        states = len(self._free)
        fan = Fan([LINEAR if self._layout.summed else CENTRAL] * states + stencils)
        moved = np.repeat(p[:, :, np.newaxis], fan.offsets.shape[1], axis=2)
        moved[places] += steps[:, :, np.newaxis] * fan.offsets[states:, np.newaxis]
        moved.setflags(write=False)
        return Seeds(fan, states, moved, steps)

    def _deltas(self, x: Array, seeds: Seeds) -> tuple[Array, Array]:
        """From points x (n_x, P) to those of their fans, (n_x, P, K), and all steps (P, w)."""
        delta = np.zeros((*x.shape, seeds.fan.offsets.shape[1]))
        if not seeds.states:
            return delta, np.empty((x.shape[1], 0))
        steps = step_sizes(x[self._free])
        delta[self._free] = steps[:, :, np.newaxis] * seeds.fan.offsets[: seeds.states, np.newaxis]
        return delta, np.concatenate([steps, seeds.steps]).T

    # --- along the rows

    def _whole(self, x: Array, known: Array) -> Array:
        """All states (n_x, 1), from those that are integrated."""
        whole = np.empty((self._layout.states, 1))
        whole[self._free, 0] = x
        whole[self._measured, 0] = known[len(self._layout.inputs) + 1 :]
        return whole

    def _stages(self, known: Array) -> tuple[Array, Array]:
        """The knowns at 2 substeps + 1 times from each row to the next, and the durations."""
        n_u = len(self._layout.inputs)
        shares = np.linspace(0.0, 1.0, 2 * self._layout.substeps + 1)[:, np.newaxis]
        begin, change = known[:-1, np.newaxis], np.diff(known, axis=0)[:, np.newaxis]
        between = begin + (0.0 * shares if self._layout.hold else shares) * change
        if "time" in self._layout.inputs:  # goes on where the others are held
            at = self._layout.inputs.index("time")
            between[..., at] = begin[..., n_u] + shares[:, 0] * change[..., n_u]
        return between, change[:, 0, n_u]

    def _advance(self, x: Array, p: Array, known: Array, dt: float) -> Array:
        """X (n_x, N) at the next row, by Runge and Kutta's fourth order.

        `known`, (stages, n, N), is that of _stages() at every point.
        """
        n_u = len(self._layout.inputs)

        def rate(at: Array, stage: int) -> Array:
            u = known[stage, :n_u]
            if self._measured:
                at[self._measured] = known[stage, n_u + 1 :]
            return self._model.rate(at, u, p)

        if self._layout.discrete:
            return rate(x.copy(), 0)
        h = dt / self._layout.substeps
        for first in range(0, 2 * self._layout.substeps, 2):
            k1 = rate(x.copy(), first)
            k2 = rate(x + (0.5 * h) * k1, first + 1)
            k3 = rate(x + (0.5 * h) * k2, first + 1)
            k4 = rate(x + h * k3, first + 2)
            x = x + (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4)
        return x

    def _follow(
        self, path: Path, known: Array, begins: dict[int, Array], seeds: Seeds
    ) -> tuple[Array, Array]:
        """X (rows, n_x, P) and S (rows, P, n_x, w) at every row."""
        n_x, n_u, (n_p, P, K) = self._layout.states, len(self._layout.inputs), seeds.p.shape
        w = seeds.fan.offsets.shape[0]
        x, S = np.full((len(known), n_x, P), np.nan), np.zeros((len(known), P, n_x, w))
        before = known[:1] if path.last is None else path.last[np.newaxis]
        stages, dt = self._stages(np.concatenate([before, known]))
        stages = np.broadcast_to(stages[..., np.newaxis], (*stages.shape, P * K))
        p = seeds.p.reshape(n_p, P * K)
        fan = None  # steps are sized where a block or a trajectory begins
        for row in range(len(known)):
            if row in begins:
                fan, path.x, path.S = None, begins[row].copy(), np.zeros((P, n_x, w))
                if seeds.states:
                    path.S[:, self._free, range(seeds.states)] = 1.0
            elif path.x is not None and path.S is not None and np.isfinite(path.x).any():
                delta, steps = fan = fan or self._deltas(path.x, seeds)
                points = (path.x[:, :, np.newaxis] + delta).reshape(n_x, P * K)
                end = self._advance(points, p, stages[row], dt[row]).reshape(n_x, P, K)
                self._go_on(path, end, seeds, steps)
            if path.x is not None and path.S is not None:
                if self._measured:
                    path.x[self._measured] = known[row, n_u + 1 :, np.newaxis]
                x[row], S[row] = path.x, path.S
        path.last = known[-1]
        return x, S

    def _go_on(self, path: Path, end: Array, seeds: Seeds, steps: Array) -> None:
        """The path where a step ends. What has run away stays no number until the next start."""
        assert path.x is not None
        assert path.S is not None
        lost = path.x + end[:, :, 0]  # not finite where either is not
        path.x = end[:, :, 0].copy()
        if seeds.states:
            D = (end @ seeds.fan.weights / steps).transpose(1, 0, 2)
            if self._measured:
                D[:, self._measured] = 0.0
            path.S = D[:, :, : seeds.states] @ path.S[:, self._free]
            path.S[:, :, seeds.states :] += D[:, :, seeds.states :]
            if self._layout.summed:
                growth = np.abs(path.S[:, :, : seeds.states]).max(axis=(1, 2))
                lost[:, ~(growth < NO_DIGITS_LEFT)] = np.nan
        if not np.isfinite(lost).all():
            path.x[:, ~np.isfinite(lost).all(axis=0)] = np.nan

    # --- the outputs

    def _read(
        self, x: Array, S: Array, known: Array, seeds: Seeds, xi1: Array
    ) -> tuple[Array, Array, Array, Array]:
        """A, b and slopes as of walk(), and the slopes of A xi1 of what is counted from a start."""
        (rows, n_x, P), K = x.shape, seeds.p.shape[2]
        shape = (rows, P, K)
        middle = x.transpose(1, 0, 2).reshape(n_x, -1)
        delta, steps = self._deltas(middle, self._repeated(seeds, rows))
        u = np.repeat(known[:, : len(self._layout.inputs)].T, P * K, axis=1)
        p = np.broadcast_to(seeds.p[:, np.newaxis], (len(seeds.p), *shape)).reshape(
            len(seeds.p), rows * P * K
        )
        A, b = self._model.affine((middle[:, :, np.newaxis] + delta).reshape(n_x, -1), u, p)
        A, b = A.reshape(*A.shape[:2], *shape), b.reshape(len(b), *shape)
        steps = steps.reshape(rows, P, -1)

        def slopes_of(values: Array) -> Array:
            if not seeds.states:
                return np.empty((len(b), rows, P, 0))
            H = values @ seeds.fan.weights / steps
            slopes = np.einsum("jrpi,rpiw->jrpw", H[..., : seeds.states], S[:, :, self._free])
            slopes[..., seeds.states :] += H[..., seeds.states :]
            return np.asarray(slopes)

        scales = list(self._layout.from_start)
        slopes = slopes_of(b + np.einsum("jkrpq,kp->jrpq", A, xi1))
        from_start = slopes_of(np.einsum("jkrpq,kp->jrpq", A[:, scales], xi1[scales]))
        b = b[..., 0].copy()
        b[:, ~np.isfinite(x).all(axis=1)] = np.nan
        return A[..., 0].copy(), b, slopes, from_start

    @staticmethod
    def _repeated(seeds: Seeds, rows: int) -> Seeds:
        """For as many points as there are rows, side by side."""
        return Seeds(seeds.fan, seeds.states, seeds.p, np.tile(seeds.steps, rows))

    def _count_from_start(
        self, path: Path, begins: list[int], A: Array, slopes: Array, from_start: Array
    ) -> None:
        """Takes from the columns of scales, and from the slopes, what they are at the start."""
        scales = list(self._layout.from_start)
        rows = A.shape[2]
        for first, last in zip([0, *begins], [*begins, rows], strict=True):
            if first == last:
                continue
            if first in begins:
                path.start = A[:, scales, first].copy(), from_start[:, first].copy()
            if path.start is None:
                continue
            A[:, scales, first:last] -= path.start[0][:, :, np.newaxis]
            slopes[:, first:last] -= path.start[1][:, np.newaxis]
