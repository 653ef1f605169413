# SPDX-License-Identifier: BSD-3-Clause
"""Topics of a ULog as columns, and its parameters, by pyulog."""

from __future__ import annotations

import builtins
import contextlib
import io
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs.parameters import Parameters
from sepcal.logs.recording import Channel, make_channel
from sepcal.logs.words import one_line

MAGIC = b"\x55\x4c\x6f\x67\x01\x12\x35"
HEADER = 16  # bytes
KNOWN = b"FDIMPQARSOLCB"  # types of messages
FIRST_OF_DATA = b"ALC"
READ = (
    "actuator_armed",
    "actuator_controls_0",
    "airspeed",
    "battery_status",
    "differential_pressure",
    "magnetometer_bias_estimate",
    "sensor_baro",
    "sensor_combined",
    "sensor_gps",
    "sensor_mag",
    "sensor_selection",
    "vehicle_air_data",
    "vehicle_angular_velocity",
    "vehicle_attitude",
    "vehicle_attitude_setpoint",
    "vehicle_global_position",
    "vehicle_gps_position",
    "vehicle_local_position",
    "vehicle_magnetometer",
    "vehicle_status",
    "vehicle_thrust_setpoint",
)


class Topic:
    """One topic of one instance; `topic["q[0]"]` is a column, shape (n,).

    Attributes:
        name, instance: "sensor_mag", 0.
        times: When each was sampled, where the log tells, else published [s], shape (n,).
        said: How the times were found, in a sentence, or nothing.
    """

    def __init__(self, name: str, instance: int, columns: dict[str, np.ndarray]) -> None:
        self.name, self.instance, self._columns = name, instance, columns
        published = columns["timestamp"].astype(np.int64)
        sampled = columns.get("timestamp_sample")
        self.said: tuple[str, ...] = ()
        stamps = published
        if sampled is not None:
            late = published - sampled.astype(np.int64)
            if ((late >= 0) & (late < 1_000_000)).mean() > 0.9:
                stamps = sampled.astype(np.int64)
                if late.any():
                    mean = late.mean() / 1e3
                    self.said = (f"at timestamp_sample, {mean:.3g} ms before publication",)
        self.times: Array = np.where(stamps > 0, stamps / 1e6, np.nan)

    def __contains__(self, column: str) -> bool:
        return column in self._columns

    def __getitem__(self, column: str) -> Array:
        return self._columns[column].astype(float)

    def __len__(self) -> int:
        return len(self.times)

    def first(self, *columns: str) -> str | None:
        """The first of these columns that is there."""
        return next((column for column in columns if column in self._columns), None)

    def stack(self, columns: tuple[str, ...]) -> Array:
        """Side by side, (n, count)."""
        return np.stack([self[column] for column in columns], axis=-1)

    def devices(self) -> np.ndarray | None:
        """The device of each sample, if it is logged."""
        found = self._columns.get("device_id")
        return None if found is None or not found.any() else found.astype(np.int64)

    def channel(
        self, *columns: str, kept: np.ndarray | None = None, done: tuple[str, ...] = ()
    ) -> Channel | None:
        """Some columns, of the samples of a mask; None where there are fewer than two."""
        if not all(column in self._columns for column in columns):
            return None
        values = self.stack(columns)
        times = self.times
        if kept is not None:
            times, values = times[kept], values[kept]
        number = f"[{self.instance}]" if self.instance else ""
        source = f"{self.name}{number}.{name_together(columns)}"
        return make_channel(source, times, values, (*self.said, *done))


_here = threading.local()  # `reads`, where this thread does


def _print(*words: object, **options: Any) -> None:  # noqa: ANN401
    """In place of pyulog's, which tells what it finds damaged; of threads that read for us nothing.

    The streams are left alone: they are the whole process', and other threads print.
    """
    if not getattr(_here, "reads", False):
        builtins.print(*words, **options)


@contextlib.contextmanager
def _silent_reading() -> Iterator[None]:
    _here.reads = True
    try:
        yield
    finally:
        _here.reads = False


class ULog:
    """A ULog's topics, parameters and information.

    Attributes:
        span: From the first to the last stamp [s].
        vehicle: "PX4 1.15.0", as far as the log tells.
    """

    def __init__(self, file: str, cut_off: bool, progress: Callable[[str], None]) -> None:
        """Reads the file.

        Raises:
            Error: No pyulog, or a file that ends inside a message, unless `cut_off` allows it.
        """
        try:
            import pyulog.core
        except ImportError as error:
            raise _core.Error(
                f"{file}: a ULog needs pyulog, which is not installed: pip install sepcal[logs]"
            ) from error
        progress(f"reading {file}")
        with open(file, "rb") as opened:
            data = opened.read()
        _check_definitions(file, data)
        pyulog.core.print = _print
        try:
            with _silent_reading():
                log = pyulog.ULog(io.BytesIO(data), message_name_filter_list=list(READ))
        except Exception as error:  # of a damaged file pyulog raises what it meets
            raise _core.Error(
                f"{file}: pyulog can't read it as a ULog: {one_line(error)}"
            ) from error
        self._topics: dict[str, list[Topic]] = {}
        for one in sorted(log.data_list, key=lambda d: (d.name, d.multi_id)):
            if "timestamp" in one.data and len(one.data["timestamp"]):
                topic = Topic(one.name, one.multi_id, one.data)
                self._topics.setdefault(one.name, []).append(topic)
        self.damaged = bool(log.file_corruption)
        self.dropouts = sum(d.duration for d in log.dropouts) / 1e3
        self.torn = "" if self.damaged else _find_torn_end(data, log)
        if self.torn and not cut_off:
            raise _core.Error(
                f"{file}: the log is cut off inside {self.torn}; "
                "--cut-off takes what is whole (in Python cut_off=True)"
            )
        initial = [(-np.inf, name, value) for name, value in log.initial_parameters.items()]
        changed = [(time / 1e6, name, value) for time, name, value in log.changed_parameters]
        self.parameters = Parameters(
            setting for setting in (*initial, *changed) if isinstance(setting[2], int | float)
        )
        self.vehicle = _describe(log.msg_info_dict)
        seen = [t.times[np.isfinite(t.times)] for ts in self._topics.values() for t in ts]
        ends = [(t.min(), t.max()) for t in seen if t.size]
        self.span = (min(e[0] for e in ends), max(e[1] for e in ends)) if ends else (0.0, 0.0)

    def topics(self, *names: str) -> list[Topic]:
        """All instances of these topics, in this order."""
        return [topic for name in names for topic in self._topics.get(name, [])]

    def first_of(self, names: tuple[str, ...], *columns: str) -> Channel | None:
        """Columns of the first of these topics that has them all, not all of them zero."""
        for topic in self.topics(*names):
            if all(column in topic for column in columns):
                if not topic.stack(columns).any():
                    continue
                channel = topic.channel(*columns)
                if channel is not None:
                    return channel
        return None


def name_together(columns: tuple[str, ...]) -> str:
    """q[0], q[1], q[2] as q[0..2]; others one by one."""
    stem, _, last = columns[-1].partition("[")
    if columns == tuple(f"{stem}[{i}]" for i in range(len(columns))) and len(columns) > 1:
        return f"{stem}[0..{last}"
    return ", ".join(columns)


def _describe(info: dict[str, Any]) -> str:
    """As "PX4 1.15.0", of what is told."""
    release = info.get("ver_sw_release")
    release = release if isinstance(release, int) else 0
    numbers = [release >> shift & 0xFF for shift in (24, 16, 8)]
    version = " " + ".".join(map(str, numbers)) if any(numbers) else ""
    return one_line(f"{info.get('sys_name', '')}{version}")


def _check_definitions(file: str, data: bytes) -> None:
    """Raises Error where the messages before the first subscription are no chain of known ones.

    Formats and parameters stand there; and pyulog may look for its way in such a file for ever.
    """
    at = HEADER
    while at + 3 <= len(data):
        length, kind = int.from_bytes(data[at : at + 2], "little"), data[at + 2]
        if kind not in KNOWN:
            raise _core.Error(f"{file}: damaged among its definitions, at byte {at}: unreadable")
        if kind in FIRST_OF_DATA:
            return
        at += 3 + length
    raise _core.Error(f"{file}: the log is cut off inside its definitions; nothing is in it")


def _find_torn_end(data: bytes, log: Any) -> str:  # noqa: ANN401, pyulog has no types
    """Where a file ends inside a message: the bytes there; else nothing."""
    at = log._appended_offsets[-1] if log.has_data_appended and log._appended_offsets else HEADER
    while at + 3 <= len(data):
        length, kind = int.from_bytes(data[at : at + 2], "little"), data[at + 2]
        if kind not in KNOWN:
            return ""
        if at + 3 + length > len(data):
            return f"the message at byte {at}"
        at += 3 + length
    return f"the message at byte {at}" if at < len(data) else ""
