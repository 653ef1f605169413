# SPDX-License-Identifier: BSD-3-Clause
"""What a fleet lacks."""

from __future__ import annotations

import json

from sepcal import _core
from sepcal.printing import in_line

FOUND = 3  # an exit code, as of a flight's diagnosis
NOTHING = 0
SMALL = 0.02  # share of the misfit: gusts make effects of 1.4 % (docs/fleets.md, Limits)


class FleetDiagnosis(_core.FleetDiagnosis):
    """What is missing from a fleet's model, where; `print` shows the page.

    Example:
        >>> files = sepcal.datasets.write_fleet(folder, hide={"wind[altitude_m]": 0.05})
        >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
        >>> found = fleet.diagnose()
        >>> found.named_vehicles, found.exit_code
        ([], 3)
    """

    @property
    def named_vehicles(self) -> list[str]:
        """Vehicles that have an effect of their own, in the order in which they were found."""
        return list(dict.fromkeys(one.vehicle for one in self.found if one.vehicle))

    @property
    def exit_code(self) -> int:
        """3 where an effect is missing, else 0."""
        return FOUND if self.found else NOTHING

    def doubt(self, finding: _core.FleetFinding) -> str:
        """What a small effect of the whole fleet may be, where an input is noisy; else nothing.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder, hide={"wind[altitude_m]": 0.05})
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> found = fleet.diagnose()
            >>> found.doubt(found.found[0])
            ''
        """
        is_small = finding.cause in ("everywhere", "grows") and finding.share < SMALL
        if not (is_small and any("noise in an input" in note for note in self.notes)):
            return ""
        return "; IN DOUBT: it may stand in for the noise of an input, see below"

    def to_json(self) -> str:
        """As JSON.

        Example:
            >>> files = sepcal.datasets.write_fleet(folder)
            >>> fleet = sepcal.Fleet(folder, sepcal.PitotStatic(), names="{vehicle}_{date}.csv")
            >>> '"found": []' in fleet.diagnose().to_json()
            True
        """
        told = {
            "vehicles": self.vehicles,
            "flights": self.flights,
            "tests": self.tests,
            "misfit_before": self.misfit_before,
            "misfit_after": self.misfit_after,
            "found": [_told(one) | {"doubt": self.doubt(one)} for one in self.found],
            "others": [_told(one) for one in self.others],
            "notes": list(self.notes),
        }
        return json.dumps(told, indent=2) + "\n"

    def __str__(self) -> str:
        lines = []
        if not self.found:
            lines.append(
                f"Nothing was found: none of {self.tests} tests over {self.flights} flights of "
                f"{self.vehicles} vehicles is significant."
            )
        for number, one in enumerate(self.found, 1):
            lines.append(f"{number}. {sentence_of(one)}{self.doubt(one)}")
        if self.found:
            lines += [
                "",
                f"Misfit per reading, of noise alone 1: {self.misfit_before:.4g} before, "
                f"{self.misfit_after:.4g} with all of these "
                f"({self.tests} tests, {self.flights} flights, {self.vehicles} vehicles).",
            ]
        near = [one for one in self.others if one.p_adjusted < 1.0][:5]
        if near:
            lines += ["", "Beside these, the surest of the others:"]
            lines += [f"  {sentence_of(one)}" for one in near]
        return "\n".join([*lines, *(f"\n{note}" for note in self.notes)])


def sentence_of(finding: _core.FleetFinding) -> str:
    """A finding in a sentence."""
    where = {
        "everywhere": "in the whole fleet",
        "grows": "in the whole fleet",
        "one-vehicle": f"in {in_line(finding.vehicle)} alone",
        "differs": "with a size of its own in each vehicle",
    }[finding.cause]
    sizes = []
    for place, (name, told) in enumerate(finding.coefficients.items()):
        estimate, error, unit = told
        per = unit.removeprefix("1 ") if unit.startswith("1 per ") else unit
        size = f"{name} = {estimate:.4g} +- {error:.2g}" + (f" {per}" if unit != "1" else "")
        if finding.spread:
            size += f", spread {finding.spread[place]:.2g}"
        sizes.append(in_line(size))
    sentence = (
        f"{in_line(finding.effect)}, {where} (p {in_short(finding.p_adjusted)}, "
        f"{100 * finding.share:.2g} % of the misfit): " + "; ".join(sizes)
    )
    if finding.as_good:
        sentence += f"; as good: {', '.join(map(in_line, finding.as_good[:3]))}"
    return sentence


def in_short(p: float) -> str:
    """A probability as pages show it."""
    return "below 1e-15" if p < 1e-15 else f"{p:.2g}"


def _told(finding: _core.FleetFinding) -> dict[str, object]:
    fields = dict(finding._asdict())
    fields["coefficients"] = {
        name: {"estimate": estimate, "standard_error": error, "unit": unit}
        for name, (estimate, error, unit) in finding.coefficients.items()
    }
    return fields
