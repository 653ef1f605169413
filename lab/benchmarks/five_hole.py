# SPDX-License-Identifier: BSD-3-Clause
"""The flight that five-hole races share, as a file for programs and as arrays for Python."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

import sepcal
from benchmarks.limits import instruction_sets
from benchmarks.numpy_five_hole import HoistedProbe
from benchmarks.race import Competitor, ask, program

K_ALPHA, K_BETA, ARM = 4.5, 4.5, (0.35, 0.0, -0.02)
NOISE = (0.15, 0.15, 0.15)  # of vn, ve, vd [m/s]
SAMPLES = 500
COLUMNS = {
    "roll": "roll_rad", "pitch": "pitch_rad", "yaw": "yaw_rad", "p": "p_radps", "q": "q_radps",
    "r": "r_radps", "pt": "pt_pa", "ps": "ps_pa", "dpa": "dpa_pa", "dpb": "dpb_pa",
    "rho": "rho_kgpm3", "vn": "vn_mps", "ve": "ve_mps", "vd": "vd_mps", "time": "time_s",
    "throttle": "throttle",
}  # fmt: skip
HEADER = 26  # doubles, as lab/benchmarks/engine/five_hole_file.hpp has them


@dataclass
class FiveHoleFlight:
    """A simulated flight of `rows` rows, with the start and the samples that all peers share."""

    folder: Path
    rows: int
    noise: str = "white"
    hide: dict[str, float] = field(default_factory=dict)

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        """By the model's names."""
        flight = sepcal.simulate(
            "five-hole", rows=self.rows, noise=self.noise, hide=self.hide, seed=1
        )
        return {name: np.asarray(flight[header]) for name, header in COLUMNS.items()}

    @cached_property
    def found(self) -> np.ndarray:
        """Stage one's best sample (10), its noise (3), how many descents, then all samples."""
        return ask("sepcal", "five-hole", "start", self.bare, 1)[1]

    @cached_property
    def bare(self) -> Path:
        """A file without what is found first."""
        return self.write(np.zeros(16), np.empty(0))

    @property
    def start(self) -> np.ndarray:
        """Where stage two starts (10,)."""
        return self.found[:10]

    @property
    def start_noise(self) -> np.ndarray:
        """Root mean square residuals there (3,)."""
        return self.found[10:13]

    @property
    def descents(self) -> int:
        """How many of the first points stage one descends from."""
        return int(self.found[13])

    @property
    def points(self) -> np.ndarray:
        """Stage one's samples of xi2, (S, 5)."""
        return self.found[14:].reshape(-1, 5)

    @cached_property
    def file(self) -> Path:
        """The whole file."""
        centres = ask("sepcal", "five-hole", "centres", self.bare, 1)[1]
        return self.write(np.concatenate([self.found[:14], centres]), self.found[14:])

    def write(self, start: np.ndarray, points: np.ndarray) -> Path:
        """The flight for the programs."""
        name = f"{self.noise}_{len(self.hide)}_{self.rows}_{len(points)}.bin"
        header = np.zeros(HEADER)
        header[:10] = [self.rows, len(points) // 5, K_ALPHA, K_BETA, *ARM, *NOISE]
        header[10:26] = start
        with (self.folder / name).open("wb") as file:
            for part in (header, points, *self.columns.values()):
                np.asarray(part, dtype=float).tofile(file)
        return self.folder / name

    def hoist(self) -> HoistedProbe:
        """For NumPy and SciPy; part of what is timed."""
        return HoistedProbe(self.columns, K_ALPHA, K_BETA, ARM)

    @cached_property
    def standard_errors(self) -> np.ndarray:
        """White ones at the start's neighbour, the truth's noise: what agreement is measured in."""
        probe = self.hoist()
        probe.set_noise(np.array(NOISE))
        J = probe.jacobian(self.start)
        errors: np.ndarray = np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
        return errors

    def in_errors(self, off: np.ndarray) -> float:
        """The largest difference of the ten parameters, effects' left out, in standard errors."""
        return float(np.abs(off[:10] / self.standard_errors).max())


def by_sepcal(method: str, flight: FiveHoleFlight, repeats: int) -> list[Competitor]:
    """Sepcal by the widest instruction set that there is, then by each narrower one."""
    return [
        Competitor(
            "sepcal" if k == 0 else f"sepcal, {isa}",
            program("five-hole", method, flight.file, repeats, isa),
        )
        for k, isa in enumerate(instruction_sets())
    ]
