# SPDX-License-Identifier: BSD-3-Clause
"""The magnetometers of a ULog, each by the better of its topics, as the raw sensor in body axes.

sensor_mag is the raw sensor, often logged once a second alone; vehicle_magnetometer is faster and
corrected. Where that is undone, the raw samples that are there tell how well.
"""

from __future__ import annotations

import numpy as np

from sepcal.columns import Array
from sepcal.logs.px4_magnetometer import Correction
from sepcal.logs.recording import MAGNETOMETER, Channel, Sensor, make_channel
from sepcal.logs.time_base import bring
from sepcal.logs.ulog_topics import ULog, name_together

GAUSS = 100.0  # [uT]
FASTER = 2.0  # so many times as fast as the raw topic the corrected one is taken instead
DIFFERS = 1.0  # [uT]: more between raw and undone is said to be much
INVALID = 0x7FFFFFFF  # of a relative time stamp
THROTTLE, CURRENT, SECOND_CURRENT = 1, 2, 3  # CAL_MAG_COMP_TYP
ARMED = 2


def read_magnetometers(log: ULog) -> tuple[list[Sensor], tuple[str, ...]]:
    """The sensors, and notes."""
    raw = _by_device(log, "sensor_mag", ("x", "y", "z"))
    columns = ("magnetometer_ga[0]", "magnetometer_ga[1]", "magnetometer_ga[2]")
    corrected = _by_device(log, "vehicle_magnetometer", columns)
    if not raw and not corrected:
        corrected = _of_sensor_combined(log, columns)
    if raw and 0 in corrected:  # vehicle_magnetometer of old: of the primary device, unsaid
        primary = _selected_device(log)
        primary = primary if primary in raw else next(iter(raw))
        corrected = {primary: corrected[0]}
    devices = list(dict.fromkeys((*raw, *corrected)))
    sensors: list[Sensor] = []
    for device in devices:
        correction = Correction(log.parameters, abs(device))
        sensor = _make_sensor(
            log,
            f"mag{len(sensors)}",
            device,
            correction,
            _turn_raw(raw.get(device), correction),
            _undo(log, corrected.get(device), correction, len(sensors)),
        )
        if sensor is not None:
            sensors.append(sensor)
    return sensors, ()


def _by_device(log: ULog, name: str, columns: tuple[str, ...]) -> dict[int, Channel]:
    """Channels in gauss by device; a topic without devices is numbered 0, -1, ..."""
    found: dict[int, Channel] = {}
    for topic in log.topics(name):
        if not all(column in topic for column in columns):
            continue
        devices = topic.devices()
        if devices is None:
            devices = np.full(len(topic), -topic.instance)
        for device in dict.fromkeys(devices.tolist()):
            kept = (devices == device) & topic.stack(columns).any(axis=1)
            channel = topic.channel(*columns, kept=kept)
            if channel is not None and device not in found:
                found[device] = channel
    return found


def _of_sensor_combined(log: ULog, columns: tuple[str, ...]) -> dict[int, Channel]:
    """Logged faster than the magnetometer reads: the rows in which it has a new reading."""
    for topic in log.topics("sensor_combined"):
        if not all(column in topic for column in columns):
            continue
        times, values = topic.times, topic.stack(columns)
        done: tuple[str, ...] = ()
        if "magnetometer_timestamp_relative" in topic:
            ago = topic["magnetometer_timestamp_relative"]
            times = np.where(ago < INVALID, np.round(times * 1e6 + ago) / 1e6, np.nan)
            done = ("at magnetometer_timestamp_relative",)
        new = np.append(True, (values[1:] != values[:-1]).any(axis=1) & (np.diff(times) > 0))
        if not new.all():
            done += (f"the {new.sum()} rows with a new reading of {len(new)}",)
        source = f"sensor_combined.{name_together(columns)}"
        channel = make_channel(source, times[new], values[new], done)
        if channel is not None and channel.values.any():
            return {_selected_device(log): channel}
    return {}


def _selected_device(log: ULog) -> int:
    for topic in log.topics("sensor_selection"):
        if "mag_device_id" in topic:
            return int(topic["mag_device_id"][-1])
    return int(log.parameters.first("CAL_MAG_PRIME"))


def _turn_raw(channel: Channel | None, correction: Correction) -> Channel | None:
    """sensor_mag in body axes, raw also where a driver of old corrected it."""
    if channel is None:
        return None
    values, done = channel.values, channel.done
    if correction.drivers_correct:
        values, undone = correction.undo(values, channel.times, np.zeros(len(values)))
        done += undone
    else:
        done += ("the raw sensor: nothing to undo",)
    return _in_body(channel, values, correction, done)


def _undo(log: ULog, channel: Channel | None, correction: Correction, index: int) -> Channel | None:
    """vehicle_magnetometer as the raw sensor read, in body axes."""
    if channel is None:
        return None
    bias, learned = _learned_bias(log, channel.times, index)
    power, said = _find_power(log, channel.times, correction)
    sensor_axes = (channel.values + bias) @ correction.rotation
    values, undone = correction.undo(sensor_axes, channel.times, power)
    done = (*channel.done, *learned, *(undone or ("the autopilot corrected nothing",)), *said)
    return _in_body(channel, values, correction, done)


def _in_body(
    channel: Channel, values: Array, correction: Correction, done: tuple[str, ...]
) -> Channel:
    if not np.allclose(correction.rotation, np.eye(3), atol=1e-6):
        done += ("turned into body axes by the mounting in the parameters",)
    done += (*correction.notes, "G to uT")
    return Channel(channel.source, channel.times, values @ correction.rotation.T * GAUSS, done)


def _learned_bias(log: ULog, times: Array, index: int) -> tuple[Array, tuple[str, ...]]:
    """The offset that the autopilot learned on the ground and subtracted too, (n, 3) in gauss."""
    bias = np.zeros((len(times), 3))
    for topic in log.topics("magnetometer_bias_estimate"):
        columns = tuple(f"bias_{axis}[{index}]" for axis in "xyz")
        if not all(column in topic for column in (*columns, f"valid[{index}]")):
            continue
        kept = (topic[f"valid[{index}]"] > 0) & np.isfinite(topic.times)
        if not kept.any():
            continue
        at = np.searchsorted(topic.times[kept], times, side="right") - 1
        bias = np.where(at[:, None] >= 0, topic.stack(columns)[kept][np.clip(at, 0, None)], 0.0)
        if bias.any():
            return bias, ("undone: the bias of magnetometer_bias_estimate",)
    return bias, ()


def _find_power(log: ULog, times: Array, correction: Correction) -> tuple[Array, tuple[str, ...]]:
    """By which COMP was multiplied: the throttle, or kiloamperes; zero where disarmed."""
    kind = int(log.parameters.first("CAL_MAG_COMP_TYP"))
    none = np.zeros(len(times))
    if kind == 0 or correction.place is None:
        return none, ()
    topics = log.topics("battery_status")
    if kind == THROTTLE:
        power = log.first_of(("actuator_controls_0",), "control[3]")
        for topic in log.topics("vehicle_thrust_setpoint") if power is None else ():
            thrust = np.linalg.norm(topic.stack(("xyz[0]", "xyz[1]", "xyz[2]")), axis=1)
            power = make_channel(topic.name, topic.times, thrust)
    else:
        topics = [t for t in topics if t.instance == (kind == SECOND_CURRENT)]
        power = topics[0].channel("current_a") if topics else None
        if power is not None:
            power = Channel(power.source, power.times, power.values / 1e3)
    if power is None:
        return none, ("the compensation CAL_MAG_COMP_TYP is not undone: its power isn't logged",)
    at = np.clip(np.searchsorted(power.times, times, side="right") - 1, 0, None)
    used = power.values[at, 0]
    for status in log.topics("vehicle_status"):
        if "arming_state" in status:
            on = np.searchsorted(np.nan_to_num(status.times, nan=-np.inf), times, side="right") - 1
            used = np.where(status["arming_state"][np.clip(on, 0, None)] == ARMED, used, 0.0)
    return used, (f"the power is {power.source}",)


def _make_sensor(
    log: ULog,
    name: str,
    device: int,
    correction: Correction,
    raw: Channel | None,
    undone: Channel | None,
) -> Sensor | None:
    """Takes the raw sensor, unless the other is much faster; then the raw one is compared."""
    readings = raw or undone
    if readings is None:
        return None
    if raw is not None and undone is not None and undone.rate > FASTER * raw.rate:
        slower = f"taken for its {undone.rate:.3g} Hz; sensor_mag has {raw.rate:.3g} Hz"
        done = (*undone.done, slower, *_compare(raw, undone))
        readings = Channel(undone.source, undone.times, undone.values, done)
    own = {}
    for topic in log.topics("sensor_mag"):
        devices = topic.devices()
        mine = devices is None or bool((devices == device).all())
        if mine and "temperature" in topic and topic["temperature"].any():
            warm = topic.channel("temperature")
            if warm is not None:
                own["temp_degc"] = warm
    title = f"device {device}" if device > 0 else ""
    if correction.place is not None:
        title += f", CAL_MAG{correction.place}"
    return Sensor(name, MAGNETOMETER, readings, own=own, title=title.strip(", "))


def _compare(raw: Channel, undone: Channel) -> tuple[str, ...]:
    """How far the two lie apart on average, which noise doesn't hide."""
    at_raw, _ = bring(undone, raw.times, hold=False)
    both = np.isfinite(at_raw).all(axis=1)
    if both.sum() < 3:
        return ()
    apart = float(np.linalg.norm((at_raw - raw.values)[both].mean(axis=0)))
    said = f"{apart:.2g} uT from sensor_mag in the mean of {both.sum()} samples"
    much = ": more than noise, another correction was at work" if apart > DIFFERS else ""
    return (f"as a check, {said}{much}",)
