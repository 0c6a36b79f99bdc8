"""Sensors that measure on read are recorded with the values and messages that they have when they are read."""

from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import numpy as np
from hypothesis import given, settings
from recorded import read_by_rosbags

import morse
from morse.builder import ATRV, GPS, Environment, Hokuyo, MotionVW, Pose
from morse.core.rows.columns import euler_rows
from morse.helpers.transformation import euler_angles
from morse.mathutils.rotations import rotation_from_euler
from morse.recording.fields.blocks import RecordedFields
from morse.recording.recording import Recording
from tests.kit.effort import examples

TICKS = 90
SENSORS = ("pose", "gps", "scan")


def _scene() -> None:
    for index in range(6):
        robot = ATRV(f"r{index}")
        robot.translate(3.0 * index, 0.0, 0.3)
        motion, pose, gps, scan = MotionVW("motion"), Pose("pose"), GPS("gps"), Hokuyo("scan")
        if index > 1:  # in place, moved, and turned over
            pose.translate(0.1 * index, 0.2, 0.3)
            gps.translate(z=1.0)
        if index > 3:
            pose.rotate(0.7 * index, 0.3, -1.2)
        scan.translate(z=0.4)
        scan.properties(resolution=5.0)
        for part in (motion, pose, gps, scan):
            robot.append(part)
    Environment("empty")


def _truth(sim: Any) -> dict[str, dict[str, Any]]:
    """The timestamp and the other fields of each sensor, except those that follow."""
    return {
        name: {key: np.array(sensor.local_data[key]) for key in sensor.local_data if key != "point_list"}
        for name in _names()
        for sensor in [sim.context.components[name]]
    }


def _run(path: Path, *, watch: bool) -> list[dict[str, dict[str, Any]]]:
    """Record a run in which one sensor leaves its group, one is moved, and a script changes the data of another."""
    truth: list[dict[str, dict[str, Any]]] = []
    with morse.load(_scene) as sim, sim.record(path):
        parts: Any = sim.context.components  # type: ignore[attr-defined]
        for index in range(6):
            getattr(sim, f"r{index}").motion.publish({"v": 1.0, "w": 0.4 * index})
        for tick in range(TICKS):
            if tick == 30:
                parts["r0.scan"].laser_range = 2.5
                parts["r3.pose"].bge_object.localPosition = [0.0, 0.0, 2.0]
            if tick == 50:
                parts["r2.pose"].output_functions.insert(0, _falsified)
            if tick == 70:
                parts["r2.pose"].output_functions.remove(_falsified)
                parts["r4.gps"].local_data["note"] = "new"
            sim.step()
            if watch:
                truth.append(_truth(sim))
    return truth


def _falsified(sensor: Any) -> None:
    sensor.local_data["x"] += 100.0


def _fields(path: Path) -> list[dict[str, Any]]:
    """The recorded fields of each sensor after each tick."""
    times = [time for time, _ in read_by_rosbags(path)["/clock"]]
    with Recording(path) as recording:
        reader = RecordedFields(recording)
        return [{name: reader.last(name, time) for name in _names()} for time in times]


def _names() -> list[str]:
    return [f"r{index}.{one}" for index in range(6) for one in SENSORS]


def test_sensors_that_nobody_reads_are_recorded_as_those_that_are_read(tmp_path: Path) -> None:
    """The fields are those of each tick, bit for bit, and the messages the same, whether a script reads them or not."""
    watched, alone = tmp_path / "watched.mcap", tmp_path / "alone.mcap"
    truth = _run(watched, watch=True)
    _run(alone, watch=False)
    for path in (watched, alone):
        for seen, recorded in zip(truth, _fields(path), strict=True):
            for name, fields in seen.items():
                for key, value in fields.items():
                    assert np.asarray(recorded[name].values[key]).tobytes() == value.tobytes(), (name, key)
    first, second = (_messages(path) for path in (watched, alone))
    assert first.keys() == second.keys()
    for topic in first:
        assert first[topic] == second[topic], topic


def _messages(path: Path) -> dict[str, list[tuple[int, str]]]:
    messages = read_by_rosbags(path)
    return {
        topic: [(time, repr(one)) for time, one in each]
        for topic, each in messages.items()
        if not topic.startswith(("/morse", "/rosout"))
    }


_ANGLES = st.one_of(st.sampled_from([0.0, -0.0, 1.5707963267948966, 3.141592653589793]), st.floats(-7.0, 7.0))


@settings(max_examples=examples(100), deadline=None)
@given(st.lists(st.tuples(_ANGLES, _ANGLES, _ANGLES), min_size=1, max_size=20))
def test_angles_of_rows_have_the_bits_of_single_ones(angles: list[tuple[float, float, float]]) -> None:
    """Roll, pitch and yaw of many rotations are those of one by one."""
    rotations = [rotation_from_euler(each, "XYZ") for each in angles]
    columns = euler_rows(list(np.array(rotations).T))
    singly = np.array([euler_angles(each) for each in rotations]).T
    assert np.stack(columns).tobytes() == np.ascontiguousarray(singly).tobytes()
