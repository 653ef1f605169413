# SPDX-License-Identifier: BSD-3-Clause
"""The Earth's magnetic field at a place on a day: what --field and --field-strength ask for."""

from sepcal.geomagnetism.models import EarthField, earth_field

__all__ = ["EarthField", "earth_field"]
