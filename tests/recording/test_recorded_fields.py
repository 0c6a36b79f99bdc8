"""The data fields of all sensors come back from a recording exactly, and messages of ROS are those of the tick."""

import copy
import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import morse
from morse.recording.export import export
from morse.recording.fields.blocks import RecordedFields
from morse.recording.recording import Recording
from morse.verification.resimulation import resimulate

SENSOR = '''
"""A sensor of a project, with fields of all kinds."""

import numpy as np

from morse.core.sensor import Sensor
from morse.helpers.components import add_data


class Oddity(Sensor):
    """Measures odd things."""

    _name = "Oddity"

    add_data("count", 0, "int", "A counter")
    add_data("word", "", "string", "A word that changes")
    add_data("perhaps", None, "float", "Sometimes nothing")
    add_data("grid", [[0] * 3] * 2, "list", "Numbers", dtype="int16", shape=(2, 3))
    add_data("cloud", [], "list", "Points, more and more", dtype="float32", shape=(None, 3))
    add_data("things", [], "list<dict>", "Structures")
    add_data("scalar", 0.0, "float", "A number of numpy")

    def default_action(self):
        data, tick = self.local_data, self.clock.tick
        data["count"] = tick
        data["word"] = "even" if tick % 2 else "odd"
        data["perhaps"] = None if tick % 3 else tick / 7
        data["grid"] = np.full((2, 3), tick, dtype=np.int16)
        data["cloud"] = np.arange(3 * (tick % 5), dtype=np.float32).reshape(-1, 3)
        if not isinstance(data["things"], list) or len(data["things"]) > 3:
            data["things"] = []
        # the list of the previous tick grows
        data["things"].append({"id": tick, "place": [tick * 0.1, 0.0], "part": {"deep": (tick, "x")}})
        data["scalar"] = np.float64(tick / 3)
'''
SCENE = """
import sys
sys.path.insert(0, {folder!r})
from morse.builder import *

robot = ATRV()
motion = MotionVW()
robot.append(motion)
pose = Pose()
for part in (pose, Odometry(), IMU(), GPS(), Battery(), Sick(), Velocity(), Gyroscope(), Collision(), Clock()):
    robot.append(part)
arm = KukaLWR()
posture = ArmaturePose()
arm.append(posture)
robot.append(arm)
eye = VideoCamera()
eye.properties(cam_width=16, cam_height=12)
eye.translate(z=1.0)
robot.append(eye)
odd = SensorCreator()
odd.morseable("oddities.Oddity")
robot.append(odd)
Environment("sandbox")
"""
TICKS = 75


class Run:
    """A recorded run, and the data of all sensors in each tick."""

    def __init__(self, path: Path, script: Path) -> None:
        self.path, self.script = path, script
        self.truth: list[dict[str, dict[str, Any]]] = []


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("fields")
    (folder / "oddities.py").write_text(SENSOR)
    script = folder / "scene.py"
    script.write_text(SCENE.format(folder=str(folder)))
    found = Run(folder / "run.mcap", script)
    with morse.load(script) as sim, sim.record(found.path):
        sim.robot.motion.publish({"v": 1.0, "w": 0.7})
        sim.rpc("robot.arm", "set_rotations", [0.3, 0.2, 0.1, -0.4, 0.2, 0.1, 0.0])
        for _ in range(TICKS):
            sim.step()
            sensors = {name: one for name, one in sim.context.components.items() if hasattr(one, "output_functions")}
            found.truth.append({name: copy.deepcopy(dict(one.local_data)) for name, one in sensors.items()})
    return found


def same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)):
        return type(one) is type(other) and len(one) == len(other) and all(map(same, one, other))
    return type(one) is type(other) and (one == other or (one != one and other != other))


def test_all_fields_are_those_of_the_tick(run: Run) -> None:
    with Recording(run.path) as recording:
        fields = RecordedFields(recording)
        names = [name for name in run.truth[0] if name in fields]
        assert {"robot.odd", "robot.eye", "robot.pose", "robot.arm.posture"} <= set(names)
        for tick, truth in enumerate(run.truth, start=1):
            for name in names:
                found = fields.last(name, round(tick * 1e9 / 60) + 1000)
                if found is None:  # it has not measured yet
                    assert tick < 10 or truth[name]["timestamp"] == 0.0, name
                    continue
                for field, value in found.values.items():
                    assert same(value, truth[name][field]), (tick, name, field, value, truth[name][field])
                missing = truth[name].keys() - found.values.keys()
                assert missing <= {"point_list"}, name


def test_messages_that_are_made_together_are_those_of_the_tick(run: Run) -> None:
    # a run that is simulated again encodes each message alone, in its tick
    with Recording(run.path) as recording:
        outcome = resimulate(recording, str(run.script))
    assert outcome.departure is None
    assert outcome.ticks == TICKS
    assert outcome.messages > 10 * TICKS


def test_fields_are_declared_in_the_file(run: Run) -> None:
    with Recording(run.path) as recording:
        channels = {one.topic: one for one in recording.channels.values()}
    channel = channels["/morse/fields/robot/pose"]
    assert channel.metadata["morse.component"] == "robot.pose"
    assert '{"name": "x", "type": "float", "unit": "m", "frame": "world"}' in channel.metadata["morse.fields"]
    assert '"dtype"' not in channel.metadata["morse.fields"]


def test_tables_of_fields_have_all_digits(run: Run, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    with Recording(run.path) as recording:
        written, _ = export(recording, tmp_path / "csv", "csv", ["/morse/fields/robot/pose", "/morse/fields/robot/odd"])
        export(recording, tmp_path / "parquet", "parquet", ["/morse/fields/robot/odd"])
    pose, odd = (list(csv.DictReader(one.path.read_text().splitlines())) for one in written)
    assert [one.left_out for one in written] == [(), ("grid", "cloud")]
    assert len(pose) == len(odd) == TICKS
    for tick, row in enumerate(pose, start=1):
        truth = run.truth[tick - 1]["robot.pose"]
        assert int(row["tick"]) == tick
        assert float(row["time"]) == pytest.approx(tick / 60, abs=1e-9)
        assert {name: float(row[name]) for name in ("timestamp", "x", "y", "yaw")} == {
            name: truth[name] for name in ("timestamp", "x", "y", "yaw")
        }
    assert [row["word"] for row in odd] == [truth["robot.odd"]["word"] for truth in run.truth]
    assert json.loads(odd[4]["things"])[0] == {"id": 5, "place": [0.5, 0.0], "part": {"deep": [5, "x"]}}
    table = parquet.read_table(next((tmp_path / "parquet").iterdir()))
    assert table["perhaps"].to_pylist() == [truth["robot.odd"]["perhaps"] for truth in run.truth]
