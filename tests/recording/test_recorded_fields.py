"""The data fields of all sensors come back from a recording exactly, and messages of ROS are those of the tick."""

import contextlib
import copy
import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import morse
from morse.recording.errors import RecordingError
from morse.recording.export import export
from morse.recording.fields.blocks import ReadBlock, RecordedFields, encode_block
from morse.recording.fields.columns import Keeper
from morse.recording.recording import Recording
from morse.verification.resimulation import resimulate
from tests.kit.effort import examples

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


# -- blocks of data fields come back exactly, and damaged ones are refused -------------------------

_plain = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(allow_nan=False),
    st.text(st.characters(codec="utf-8")),
    st.binary(),
)
_values = st.recursive(
    _plain,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.tuples(inner, inner),
        st.dictionaries(st.text(st.characters(codec="utf-8"), max_size=4), inner, max_size=3),
    ),
    max_leaves=8,
)
_arrays = [
    np.arange(6).astype(dtype).reshape(shape)
    for dtype in ("uint8", "int16", "float32", "float64", "bool")
    for shape in ((6,), (2, 3), (1, 2, 3))
]


def _read(columns: dict[str, list[Any]]) -> list[dict[str, Any]]:
    keeper, count = Keeper(), len(next(iter(columns.values())))
    kept = {name: tuple(keeper.kept(value) for value in values) for name, values in columns.items()}
    ticks = np.arange(count)
    block = ReadBlock(encode_block(ticks, ticks * 10, kept), "the file")
    assert len(block) == count
    return [block.row(row).values for row in range(count)]


def _is_same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    return type(one) is type(other) and one == other


@given(st.lists(_values, min_size=1, max_size=5))
@settings(max_examples=examples(100), deadline=None)
def test_values_of_all_kinds_come_back(values: list[Any]) -> None:
    rows = _read({"it": values})
    assert all(_is_same(row["it"], value) for row, value in zip(rows, values, strict=True))


@given(st.lists(st.sampled_from(_arrays), min_size=1, max_size=4))
@settings(max_examples=examples(40), deadline=None)
def test_arrays_of_equal_and_of_different_shapes_come_back(arrays: list[Any]) -> None:
    rows = _read({"it": arrays})
    assert all(_is_same(row["it"], array) for row, array in zip(rows, arrays, strict=True))


def test_bits_of_numbers_are_those_of_the_tick() -> None:
    odd = [0.0, -0.0, float("nan"), float("inf"), 5e-324, 1.7976931348623157e308]
    (row,) = _read({"it": [odd]})
    assert np.array(row["it"]).tobytes() == np.array(odd).tobytes()


def test_an_array_that_changes_afterwards_was_copied() -> None:
    array = np.zeros(3)
    kept = Keeper().kept(array)
    array[:] = 1.0
    assert kept.tolist() == [0.0, 0.0, 0.0]


@given(st.integers(0, 400), st.integers(0, 255))
@settings(max_examples=examples(200), deadline=None)
def test_damaged_blocks_are_refused_or_read(place: int, byte: int) -> None:
    keeper = Keeper()
    columns = {"a": np.arange(3.0), "b": (keeper.kept("x"),) * 3, "c": tuple(map(keeper.kept, [{}, [1], None]))}
    data = bytearray(encode_block([1, 2, 3], np.arange(3), columns))
    data[place % len(data)] = byte
    with contextlib.suppress(RecordingError):
        block = ReadBlock(bytes(data), "the file")
        for row in range(len(block)):
            block.row(row)


def test_a_block_that_claims_more_rows_than_it_has_is_refused() -> None:
    data = encode_block([1, 2, 3], np.arange(3), {"a": np.arange(2.0)})
    with pytest.raises(RecordingError, match="another length"):
        ReadBlock(data, "the file")
