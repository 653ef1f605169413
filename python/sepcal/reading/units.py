# SPDX-License-Identifier: BSD-3-Clause
"""Units as formats and their users write them, in the form of sepcal's headers: "m/s" is mps."""

from __future__ import annotations

import re

WRITTEN = {
    "s": "s sec secs second seconds",
    "ms": "ms msec millisecond milliseconds",
    "us": "us usec microsecond microseconds",
    "rad": "rad rads radian radians",
    "deg": "deg degs degree degrees degrees_north degrees_east degree_north degree_east °",
    "radps": "radps rad/s rads-1 rad/sec radians/s radians/second rads^-1",
    "degps": "degps deg/s degs-1 deg/sec degrees/s degrees/second dps °/s degs^-1",
    "m": "m meter meters metre metres",
    "ft": "ft foot feet",
    "mps": "mps m/s ms-1 m/sec ms^-1 meters/second metres/second",
    "kt": "kt kts knot knots kn",
    "kmh": "kmh km/h kph kmh-1 kmh^-1",
    "ftps": "ftps ft/s fps",
    "fpm": "fpm ft/min ftmin-1 ftmin^-1",
    "mps2": "mps2 m/s2 m/s^2 ms-2 m/s² m/s/s ms^-2",
    "g": "g gee",
    "pa": "pa pascal pascals",
    "hpa": "hpa mbar mb millibar hectopascal",
    "kpa": "kpa",
    "psi": "psi",
    "psf": "psf lb/ft2 lbf/ft2",
    "torr": "torr mmhg",
    "ut": "ut µt μt microtesla microteslas",
    "nt": "nt nanotesla nanoteslas",
    "gauss": "gauss gs ga",
    "mgauss": "mgauss mg milligauss",
    "k": "k kelvin degk",
    "degc": "degc c °c celsius deg_c degreec degreesc degreecelsius degreescelsius degree_celsius",
    "kgpm3": "kgpm3 kg/m3 kg/m^3 kgm-3 kg/m³ kgm^-3",
    "a": "a ampere amperes amp amps",
    "v": "v volt volts",
    "pct": "pct % percent",
}
SUFFIX_OF = {text: suffix for suffix, texts in WRITTEN.items() for text in texts.split()}
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def suffix_of(unit: object) -> str | None:
    """The suffix of a header for a unit as text; None where it is not known."""
    if isinstance(unit, bytes):
        unit = unit.decode("utf-8", "replace")
    return SUFFIX_OF.get(re.sub(r"[\s*·.]", "", str(unit)).lower())


def with_unit(name: str, unit: object) -> str:
    """The name with the unit's suffix, where that is known and the name has none."""
    suffix = suffix_of(unit)
    return name if suffix is None or quantity_of(name)[1] else f"{name}_{suffix}"


def quantity_of(header: str) -> tuple[str, str]:
    """A header without its unit, in small letters, and the unit ("": none)."""
    name = header.strip().lower()
    head, _, tail = name.rpartition("_")
    if head and (tail in WRITTEN or tail == "ns"):
        return head, tail
    return name, ""
