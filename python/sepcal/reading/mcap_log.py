# SPDX-License-Identifier: BSD-3-Clause
"""MCAP, the recordings of ROS 2 and Foxglove: messages in JSON, and in CDR by ROS 2's definitions.

A topic is a table, its fields are columns, `linear.x`. Some of ROS's own messages say a quantity,
a unit and axes: x forward, y left, z up of the body, east, north, up of the world (REP 103).
"""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np

from sepcal import _core
from sepcal.columns import Array
from sepcal.logs.attitude import smooth_signs
from sepcal.reading.clock import TIME, seconds_of
from sepcal.reading.extras import load
from sepcal.reading.limits import Budget
from sepcal.reading.rates import join_tables
from sepcal.reading.ros import known_columns
from sepcal.reading.table import Table, listed

MAGIC = b"\x89MCAP0\r\n"
MOST_FIELDS = 256  # of a message
DEEPEST = 8
LONGEST = 32  # list that becomes columns
QUATERNION = ("qw", "qx", "qy", "qz")
STAMP = ("header.stamp.sec", "header.stamp.nanosec")
ROWS = 4096  # of a block
RECORD, MESSAGE = struct.Struct("<BQ"), struct.Struct("<HIQQ")  # heads, by MCAP's specification
BOM = "\ufeff"


class Message(NamedTuple):
    """The parts of a message that are used. `log_time`: [ns]."""

    channel_id: int
    log_time: int
    data: bytes


@dataclass
class Topic:
    """Messages of one topic as they come: times [ns], and numbers in blocks of equal fields."""

    name: str
    kind: str
    times: list[int] = field(default_factory=list)
    fields: dict[str, None] = field(default_factory=dict)
    frame: str = ""
    _blocks: list[tuple[tuple[str, ...], Array]] = field(default_factory=list)
    _names: tuple[str, ...] = ()  # of the rows that are in no block yet
    _rows: list[tuple[float, ...]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.what = f"topic {self.name}"  # in messages

    def add(self, time: int, values: Mapping[str, float], budget: Budget) -> None:
        """A message."""
        names = tuple(values)
        if names != self._names or len(self._rows) == ROWS:
            self._close()
            self._names = names
            for name in names:
                if name not in self.fields and len(self.fields) < MOST_FIELDS:
                    budget.take(8 * len(self.times), self.what)
                    self.fields[name] = None
        budget.take(8 * len(self.fields), self.what)
        self.times.append(time)
        self._rows.append(tuple(values.values()))

    def columns(self) -> dict[str, Array]:
        """By field (N,): NaN where a message lacks it."""
        self._close()
        found = {name: np.full(len(self.times), np.nan) for name in self.fields}
        first = 0
        for names, block in self._blocks:
            for name, values in zip(names, block.T, strict=True):
                if name in found:
                    found[name][first : first + len(values)] = values
            first += len(block)
        return found

    def _close(self) -> None:
        if self._rows:
            self._blocks.append((self._names, np.array(self._rows, dtype=np.float64)))
            self._rows = []


def read(file: str, chosen: str | None) -> Table:
    """The table of the topic that is measured, with all others. Raises Error for what can't be."""
    topics, skipped, cut = _read_topics(file)
    if not topics and skipped:
        raise _core.Error(
            f"{file}: no topic can be read: {listed(skipped)}; sepcal reads json and ROS 2's cdr"
        )
    timed = [(topic, *_times_of(topic)) for topic in topics]
    first = min((times.min() for _, times, _ in timed), default=np.datetime64(0, "ns"))
    day = first.astype("datetime64[D]")
    tables = [_to_table(topic, seconds_of(times - day), notes) for topic, times, notes in timed]
    joined = join_tables(file, [table for table in tables if len(table.columns) > 1], chosen)
    joined.notes.insert(0, f"time_s is seconds since {day} 00:00 UTC")
    joined.notes += [f"topic {name} is left out" for name in skipped[:6]]
    if cut:
        joined.notes.append(f"the file is cut off or damaged ({cut}); what is whole is used")
    return joined


def _read_topics(file: str) -> tuple[list[Topic], list[str], str]:
    """Topics, those that can't be read with the reason, and what is wrong with the file's end."""
    records = load("mcap.records", file, "MCAP")
    topics: dict[int, Topic] = {}
    skipped: dict[str, None] = {}
    decoders: dict[int, Any] = {}  # None: the channel is skipped
    schemas: dict[int, Any] = {}
    channels: dict[int, Any] = {}
    cut = ""
    with open(file, "rb") as opened:
        budget = Budget(file)
        every = _records(file, opened, Budget(file))
        while True:
            try:
                record = next(every)
            except StopIteration:
                break
            except (_core.Error, MemoryError):
                raise
            except Exception as error:  # of damage, anything
                cut = " ".join(str(error).split())[:100] or type(error).__name__
                break
            if isinstance(record, records.Schema):
                schemas[record.id] = record
                continue
            if isinstance(record, records.Channel):
                channels[record.id] = record
                continue
            if not isinstance(record, Message) or record.channel_id not in channels:
                continue
            channel_id = record.channel_id
            try:
                if channel_id not in decoders:
                    channel = channels[channel_id]
                    decoders[channel_id] = _decoder(file, channel, schemas.get(channel.schema_id))
                decode = decoders[channel_id]
                if decode is None:
                    continue
                values, frame = decode(record.data)
            except (_core.Error, MemoryError):
                raise
            except Exception:  # of damage, anything
                channel = channels[channel_id]
                skipped[f"{channel.topic} ({channel.message_encoding})"] = None
                decoders[channel_id] = None
                continue
            topic = topics.get(channel_id)
            if topic is None:
                channel = channels[channel_id]
                schema = schemas.get(channel.schema_id)
                kind = schema.name if schema is not None else ""
                topic = topics[channel_id] = Topic(channel.topic, kind)
            topic.frame = topic.frame or frame
            topic.add(record.log_time, values, budget)
    if cut and not any(topic.times for topic in topics.values()):
        raise _core.Error(f"{file}: the MCAP file is damaged or cut off: {cut}")
    return list(topics.values()), list(skipped), cut


def _records(file: str, opened: Any, budget: Budget) -> Iterator[Any]:  # noqa: ANN401
    """Messages, channels and schemas in the file's order, chunks unpacked one at a time.

    Raises ValueError, or what mcap raises, where the file breaks off.
    """
    records = load("mcap.records", file, "MCAP")
    stream = load("mcap.stream_reader", file, "MCAP")
    data_stream = load("mcap.data_stream", file, "MCAP")
    opcode = load("mcap.opcode", file, "MCAP").Opcode
    message, channel, schema = map(int, (opcode.MESSAGE, opcode.CHANNEL, opcode.SCHEMA))
    readers = {channel: records.Channel.read, schema: records.Schema.read}

    def record_of(kind: int, body: bytes) -> Any:  # noqa: ANN401
        if kind in readers:
            return readers[kind](data_stream.ReadDataStream(BytesIO(body)))
        channel_id, _, log_time, _ = MESSAGE.unpack_from(body)
        return Message(channel_id, log_time, body[MESSAGE.size :])

    for kind, body in _bodies(opened, {message, *readers, int(opcode.CHUNK)}, int(opcode.FOOTER)):
        if kind != opcode.CHUNK:
            yield record_of(kind, body)
            continue
        chunk = records.Chunk.read(data_stream.ReadDataStream(BytesIO(body)))
        budget.take(chunk.uncompressed_size, "a chunk")
        unpacked, size = stream.get_chunk_data_stream(chunk)
        whole, at = unpacked.read(size), 0
        while at < size:
            kind, length = RECORD.unpack_from(whole, at)
            start, at = at + RECORD.size, at + RECORD.size + length
            if at > len(whole):
                raise ValueError("a chunk breaks off")
            if kind == message and length >= MESSAGE.size:
                channel_id, _, log_time, _ = MESSAGE.unpack_from(whole, start)
                yield Message(channel_id, log_time, whole[start + MESSAGE.size : at])
            elif kind in readers:
                yield record_of(kind, whole[start:at])


def _bodies(opened: Any, kinds: set[int], last: int) -> Iterator[tuple[int, bytes]]:  # noqa: ANN401
    """The records of these kinds outside of chunks, to the last one."""
    left = os.fstat(opened.fileno()).st_size - len(opened.read(len(MAGIC)))
    while True:
        kind, size = RECORD.unpack(opened.read(RECORD.size))
        left -= RECORD.size + size
        if left < 0:
            raise ValueError("it is cut off")
        if kind == last:
            return
        if kind in kinds:
            yield kind, opened.read(size)
        else:
            opened.seek(size, os.SEEK_CUR)


def _decoder(file: str, channel: Any, schema: Any) -> Any:  # noqa: ANN401
    """Bytes to numbers by field and the frame's name."""
    if channel.message_encoding == "json":
        decode_json = json.JSONDecoder().decode
        return lambda data: _flatten(decode_json(str(data, "utf-8").removeprefix(BOM)))
    if channel.message_encoding == "cdr" and schema is not None and schema.encoding == "ros2msg":
        ros2 = load("mcap_ros2.decoder", file, "MCAP of ROS 2")
        decode = ros2.DecoderFactory().decoder_for("cdr", schema)
        return lambda data: _flatten(decode(data))
    return _refuse


def _refuse(_: bytes) -> tuple[dict[str, float], str]:
    raise ValueError("unknown encoding")


def _flatten(message: Any) -> tuple[Mapping[str, float], str]:  # noqa: ANN401
    is_flat = type(message) is dict and len(message) <= MOST_FIELDS
    if is_flat and set(map(type, message.values())) == {float}:
        return message, ""
    found: dict[str, float] = {}
    frames: list[str] = []
    _walk(message, "", found, frames, 0)
    return found, frames[0] if frames else ""


def _walk(value: Any, name: str, found: dict[str, float], frames: list[str], depth: int) -> None:  # noqa: ANN401
    if depth > DEEPEST or len(found) >= MOST_FIELDS:
        return
    if isinstance(value, bool | int | float):
        found[name] = float(value)
    elif isinstance(value, str):
        if name.endswith("frame_id"):
            frames.append(value)
    elif isinstance(value, Mapping):
        before = f"{name}." if name else ""
        has_room = depth < DEEPEST and len(found) + len(value) <= MOST_FIELDS
        for key, part in value.items():
            if has_room and type(part) is float:  # nearly always, and without a call
                found[f"{before}{key}"] = part
            else:
                _walk(part, f"{before}{key}", found, frames, depth + 1)
    elif isinstance(value, list | tuple | np.ndarray):
        if len(value) <= LONGEST:
            for index, part in enumerate(value):
                _walk(part, f"{name}[{index}]", found, frames, depth + 1)
    elif hasattr(value, "__slots__"):
        for key in value.__slots__:
            if not key.startswith("_") and not key.endswith("covariance"):
                part = getattr(value, key)
                _walk(part, f"{name}.{key}" if name else key, found, frames, depth + 1)


def _times_of(topic: Topic) -> tuple[np.ndarray, list[str]]:
    """The message's own stamps, datetime64[ns], where each has one, else when it was logged."""
    columns = topic.columns()
    seconds, parts = (columns.get(name, np.array([np.nan])) for name in STAMP)
    if np.isfinite(seconds).all() and np.isfinite(parts).all() and (seconds > 0).all():
        stamps = seconds.astype(np.int64) * 1_000_000_000 + parts.astype(np.int64)
        return stamps.view("M8[ns]"), [f"times of {topic.name} are those of header.stamp"]
    return np.array(topic.times, dtype=np.int64).view("M8[ns]"), []


def _to_table(topic: Topic, seconds: Array, notes: list[str]) -> Table:
    """The topic's columns by time, those of known messages by sepcal's headers."""
    columns = {
        name: values for name, values in topic.columns().items() if not name.startswith("header.")
    }
    known, taken, note = known_columns(topic.kind, columns, topic.frame)
    columns = known | {name: v for name, v in columns.items() if name not in taken}
    if note:
        notes = [*notes, f"{topic.name}: {note}"]
    if "qw" in columns:
        q = smooth_signs(np.stack([columns[name] for name in QUATERNION], axis=1))
        columns |= dict(zip(QUATERNION, q.T, strict=True))
    order = np.argsort(seconds, kind="stable")
    by_time = {name: values[order] for name, values in ({TIME: seconds} | columns).items()}
    return Table(by_time, notes=notes, name=topic.name)
