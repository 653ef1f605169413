# SPDX-License-Identifier: BSD-3-Clause
"""The three instruments by name."""

from __future__ import annotations

from studies.trust.simulator.compass import COMPASS
from studies.trust.simulator.five_hole import FIVE_HOLE
from studies.trust.simulator.instrument import Instrument
from studies.trust.simulator.tube import TUBE

INSTRUMENTS: dict[str, Instrument] = {
    instrument.name: instrument for instrument in (FIVE_HOLE, TUBE, COMPASS)
}
