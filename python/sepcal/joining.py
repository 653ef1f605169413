# SPDX-License-Identifier: BSD-3-Clause
"""Two logs of one flight as one: sensors of different rates, with clocks of their own."""

from sepcal import _core
from sepcal.arguments import checked
from sepcal.flight import Flight, to_flight
from sepcal.matrices import to_number


@checked
def join(flight: Flight, other: Flight, how: str = "smooth", offset: float = 0.0) -> Flight:
    """Brings the columns of another log to the rows of the measured sensor's.

        both = sepcal.join(sepcal.read_csv("tube.csv"), sepcal.read_csv("gnss.csv"))
        fit = sepcal.fit(sepcal.PitotStatic(), both, effects=["time_offset"])

    Nothing goes beyond the samples of a column or across its gaps, which are longer than five usual
    intervals. Rows outside of the other log are left out; a cell in a gap is NaN. Angles, by
    headers that end in _deg or _rad, go the short way round. Of a column that both have, that of
    `flight` stays. `notes` of the result say all of this.

    Args:
        flight: The log of the sensor that is calibrated: its rows stay.
        other: A log of the same flight, at other times.
        how: The value in a row: "smooth", a parabola fitted to the samples about it; "linear",
            the straight line between two samples; "held", the earlier of them. A line has half the
            noise between two samples that it has at them, which pulls an estimate of the clocks'
            offset; a parabola has the same noise everywhere.
        offset: Seconds to add to the other log's time. The rest of an offset is estimated by
            the effect `time_offset`, whose tau is then added here.

    Raises:
        Error: A log without a time, or one that runs back; clocks that have no time in common;
            another `how`; an offset that is no number.

    Example:
        >>> tube = sepcal.Flight({"time_s": [0.0, 0.4, 0.8], "dp_pa": [150.0, 151.0, 152.0]})
        >>> gnss = sepcal.Flight({"time_s": [0.0, 0.5, 1.0], "vn_mps": [10.0, 20.0, 30.0]})
        >>> sepcal.join(tube, gnss, how="linear")["vn_mps"].tolist()
        [10.0, 18.0, 26.0]
    """
    joined = _core.join_rates(
        to_flight(flight, "sepcal.join(")._core,
        to_flight(other, "sepcal.join(flight, ")._core,
        how,
        to_number("offset", offset),
    )
    return Flight._of(joined)
