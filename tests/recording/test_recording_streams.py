"""The contents of a recording, read by the MCAP library and rosbags."""

import json
import logging
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from recorded import SCRIPT, drive, read_by_rosbags, scene
from rosbags.typesys import Stores, get_typestore

import morse
from morse.recording.errors import RecordingError
from morse.rosmsgs.definitions import definition, messages

TICK = 1e9 / 60


@pytest.mark.peer("rosbags")
def test_sensors_frames_and_time_open_as_a_bag(tmp_path: Path) -> None:
    with morse.load(scene) as sim, sim.record(tmp_path / "run.mcap"):
        drive(sim, ticks=60)
        x, y = sim.robot.odometry.data["x"], sim.robot.odometry.data["y"]
    topics = read_by_rosbags(tmp_path / "run.mcap")
    assert len(topics["/robot/pose"]) == len(topics["/clock"]) == len(topics["/tf"]) == 60
    assert len(topics["/robot/scan"]) == 10  # at 10 Hz
    for number, (time, message) in enumerate(topics["/clock"], start=1):
        assert time == pytest.approx(number * TICK, abs=1.0)
        assert message.clock.sec * 10**9 + message.clock.nanosec == time
    _, last = topics["/robot/odometry"][-1]
    assert last.header.frame_id == "robot/odom"
    assert last.pose.pose.position.x == pytest.approx(x)
    assert last.pose.pose.position.y == pytest.approx(y)
    _, scan = topics["/robot/scan"][0]
    assert len(scan.ranges) == 181
    assert np.all(np.isinf(scan.ranges))  # there is nothing around
    children = {t.child_frame_id for _, message in topics["/tf"] for t in message.transforms}
    assert children == {"robot/base_link"}
    fixed = {t.child_frame_id for _, message in topics["/tf_static"] for t in message.transforms}
    assert {"robot/odom", "robot/scan", "robot/pose"} <= fixed


@pytest.mark.peer("mcap", does="reads a recording with all checksums and indexes")
def test_the_mcap_library_reads_it_with_all_checksums_and_indexes(tmp_path: Path) -> None:
    with morse.load(scene) as sim, sim.record(tmp_path / "run.mcap"):
        drive(sim)
    with open(tmp_path / "run.mcap", "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        by_index = [(c.topic, m.log_time, m.data) for _, c, m in reader.iter_messages(log_time_order=True)]
        assert summary.statistics.message_count == len(by_index)
        assert [time for _, time, _ in by_index] == sorted(time for _, time, _ in by_index)
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
        assert metadata["morse"]["seed"] == "0"
        assert metadata["morse end"]["tick"] == "60"
    with open(tmp_path / "run.mcap", "rb") as file:
        streamed = [r for r in StreamReader(file, validate_crcs=True).records if type(r).__name__ == "Message"]
        assert len(streamed) == len(by_index)


def test_inputs_and_log_are_in_it(tmp_path: Path) -> None:
    with morse.load(scene) as sim, sim.record(tmp_path / "run.mcap"):
        drive(sim)
        logging.getLogger("morse.test").warning("the answer is %d", 42)
        sim.step()
    topics = read_by_rosbags(tmp_path / "run.mcap")
    inputs = [json.loads(message.data) for _, message in topics["/morse/inputs"]]
    assert [(one["tick"], one["kind"], one["name"]) for one in inputs] == [
        (10, "command", "robot.motion"),
        (50, "service", "robot.motion"),
    ]
    assert "'v': 1.0" in inputs[0]["content"]
    (line,) = [message for _, message in topics["/rosout"] if message.name == "morse.test"]
    assert (line.level, line.msg) == (30, "the answer is 42")
    assert line.stamp.sec + line.stamp.nanosec * 1e-9 == pytest.approx(61 / 60)


def test_the_script_and_the_project_are_in_it(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)
    with morse.load(script, seed=7) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(3)
    with open(tmp_path / "run.mcap", "rb") as file:
        reader = make_reader(file)
        files = {one.name: one.data for one in reader.iter_attachments()}
        (facts,) = [one.metadata for one in reader.iter_metadata() if one.name == "morse"]
    assert files["scene.py"].decode() == SCRIPT
    assert facts["seed"] == "7"
    assert facts["script"] == str(script)


def test_only_the_sensors_that_are_named(tmp_path: Path) -> None:
    with morse.load(scene) as sim:
        with sim.record(tmp_path / "run.mcap", sensors=["robot.pose"]):
            sim.step(6)
        with pytest.raises(RecordingError, match=r"no sensor 'robot\.pos' to record.*robot\.pose"):
            sim.record(tmp_path / "other.mcap", sensors=["robot.pos"])
    topics = read_by_rosbags(tmp_path / "run.mcap")
    assert "/robot/pose" in topics
    assert not {"/robot/scan", "/robot/odometry", "/robot/battery"} & topics.keys()
    assert not (tmp_path / "other.mcap").exists()


def test_time_goes_on_after_a_restart_and_new_robots_are_followed(tmp_path: Path) -> None:
    with morse.load(scene) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(30)
        sim.restart()
        sim.step(12)
        sim.spawn("guest", "Morsy", [-3.0, 0.0, 0.2])
        sim.step(6)
        sim.delete("guest")
        sim.step(6)
    topics = read_by_rosbags(tmp_path / "run.mcap")
    times = [time for time, _ in topics["/robot/pose"]]
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for _, m in topics["/robot/pose"]]
    assert len(times) == 54
    assert times == sorted(times)
    assert stamps[30] == pytest.approx(TICK, abs=1.0)  # the stamp is that of the sensor
    assert times[30] > times[29] - 1


def test_a_simulation_is_the_same_with_and_without_a_recorder(tmp_path: Path) -> None:
    hashes = []
    for recorded in (True, False):
        with morse.load(scene, seed=3) as sim:
            recorder = sim.record(tmp_path / "run.mcap") if recorded else None
            found = []
            for tick in range(40):
                if tick == 10:
                    sim.robot.motion.publish({"v": 1.0, "w": 0.5})
                if tick == 30 and recorder is not None:
                    recorder.stop()
                sim.step()
                found.append(sim.state_hash())
            hashes.append(found)
    assert hashes[0] == hashes[1]


def test_recordings_overwrite_nothing(tmp_path: Path) -> None:
    there = tmp_path / "run.mcap"
    there.write_text("precious")
    with morse.load(scene) as sim:
        with pytest.raises(RecordingError, match="exists already"):
            sim.record(there)
        with pytest.raises(RecordingError, match="cannot be written"):
            sim.record(tmp_path / "nowhere" / "run.mcap")
        sim.step()
    assert there.read_text() == "precious"


def test_services_start_and_stop_a_recording(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with morse.load(scene) as sim:
        path = sim.rpc("simulation", "start_recording", "lap")
        assert path == str(tmp_path / "lap.mcap")
        sim.step(5)
        with pytest.raises(Exception, match="stop_recording first"):
            sim.rpc("simulation", "start_recording", "other")
        assert sim.rpc("simulation", "stop_recording") == path
        assert sim.rpc("simulation", "start_recording", "lap") == str(tmp_path / "lap-2.mcap")
        for name in ("../lap", "/tmp/lap", "", "a" * 100, "lap/lap"):
            with pytest.raises(Exception, match=r"name of a recording|is being recorded"):
                sim.rpc("simulation", "start_recording", name)
    assert len(read_by_rosbags(tmp_path / "lap.mcap")["/clock"]) == 5
    with pytest.raises(Exception, match="nothing is being recorded"), morse.load(scene) as sim:
        sim.rpc("simulation", "stop_recording")


# these have the old words for bytes, char and byte, and are not recorded
@pytest.mark.parametrize(
    "name", sorted(name for name in messages() if not name.startswith(("rmw_dds_common/", "diagnostic_msgs/")))
)
@pytest.mark.peer("rosbags", does="reads the definitions as those of ROS")
def test_definitions_are_read_by_rosbags_as_those_of_ros(name: str) -> None:
    from rosbags.typesys import get_types_from_msg

    known = get_typestore(Stores.ROS2_JAZZY)
    read = get_types_from_msg(definition(name), name)
    assert name in read
    for inner, (constants, fields) in read.items():
        if inner in known.fielddefs:  # vision_msgs is not in the type store
            assert fields == known.fielddefs[inner][1], inner
            # programs that read bags write `field.datatype == PointField.FLOAT32`
            assert sorted(constants) == sorted(known.fielddefs[inner][0]), inner
