"""Recordings as tables: the tables contain the recorded data."""

import csv
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from recorded import drive, read_by_rosbags, scene

import morse
from morse.recording.errors import RecordingError
from morse.recording.export import export
from morse.recording.fields import DECLARED, FIELDS, FIELDS_TYPE
from morse.recording.formats import Csv
from morse.recording.mcap.reader import McapFile
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("run") / "run.mcap"
    with morse.load(scene) as sim, sim.record(path):
        drive(sim)
        sim.restart()
        sim.step(5)
    return path


def test_csv_has_every_number_to_the_last_digit(run: Path, tmp_path: Path) -> None:
    with McapFile(run) as file:
        written, remarks = export(file, tmp_path / "out", "csv")
    assert remarks == []
    bag = read_by_rosbags(run)
    assert {one.topic: one.rows for one in written if one.topic in ("/robot/pose", "/tf", "/robot/scan")} == {
        topic: len(bag[topic]) for topic in ("/robot/pose", "/tf", "/robot/scan")
    }
    with (tmp_path / "out" / "robot.pose.csv").open(newline="") as text:
        rows = list(csv.DictReader(text))
    for row, (time, message) in zip(rows, bag["/robot/pose"], strict=True):
        position = message.pose.pose.position
        assert [float(row[f"pose.pose.position.{axis}"]) for axis in "xyz"] == [position.x, position.y, position.z]
        assert [float(row[f"pose.covariance[{i}]"]) for i in range(36)] == list(message.pose.covariance)
        assert row["header.frame_id"] == "map"
        assert float(row["log_time"]) == time / 1e9
    assert [int(row["tick"]) for row in rows] == [*range(1, 61), *range(1, 6)]
    assert float(rows[60]["time"]) == pytest.approx(1 / 60)
    assert float(rows[60]["log_time"]) > float(rows[59]["log_time"]) - 1e-9
    with (tmp_path / "out" / "robot.scan.csv").open(newline="") as text:
        scans = list(csv.DictReader(text))
    ranges = json.loads(scans[0]["ranges"])
    assert len(ranges) == 181
    assert math.isinf(ranges[0])


def test_a_list_of_transforms_has_a_row_for_each(run: Path, tmp_path: Path) -> None:
    with McapFile(run) as file:
        export(file, tmp_path / "out", "csv", ["/tf_static"])
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["tf_static.csv"]
    with (tmp_path / "out" / "tf_static.csv").open(newline="") as text:
        rows = {row["child_frame_id"]: row for row in csv.DictReader(text)}
    assert float(rows["robot/scan"]["transform.translation.z"]) == pytest.approx(0.9)
    assert rows["robot/scan"]["header.frame_id"] == "robot/base_link"


def test_parquet_keeps_types_and_lists(run: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    with McapFile(run) as file:
        export(file, tmp_path / "out", "parquet")
    bag = read_by_rosbags(run)
    scans = parquet.read_table(tmp_path / "out" / "robot.scan.parquet")
    assert str(scans.schema.field("ranges").type) == "list<element: float>"
    for held, (_, message) in zip(scans.column("ranges").to_pylist(), bag["/robot/scan"], strict=True):
        np.testing.assert_array_equal(np.array(held, dtype=np.float32), message.ranges)
    poses = parquet.read_table(tmp_path / "out" / "robot.pose.parquet")
    assert poses.column("pose.pose.position.x").to_pylist() == [
        message.pose.pose.position.x for _, message in bag["/robot/pose"]
    ]


def test_parquet_without_its_package_names_the_line_that_installs_it(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with McapFile(run) as file, pytest.raises(RecordingError, match=r'pip install "pyarrow>=15"'):
        export(file, tmp_path / "out", "parquet")
    assert not (tmp_path / "out").exists()


def test_nothing_is_overwritten_and_topics_are_checked(run: Path, tmp_path: Path) -> None:
    (tmp_path / "precious.csv").write_text("precious")
    with McapFile(run) as file:
        with pytest.raises(RecordingError, match="exists already"):
            export(file, tmp_path, "csv")
        with pytest.raises(RecordingError, match=r"no topic '/robot/pos' in .*/robot/pose"):
            export(file, tmp_path / "out", "csv", ["/robot/pos"])
    assert (tmp_path / "precious.csv").read_text() == "precious"


def test_topics_of_hostile_files_stay_in_the_folder(tmp_path: Path) -> None:
    path, out = tmp_path / "hostile.mcap", tmp_path / "deep" / "out"
    topics = ["/../../../evil", "/a", "/A", "a", "..", "", "/" + "x" * 5000, "/nul\0byte", "C:\\evil", "/a/b.csv"]
    with path.open("wb", buffering=0) as file:
        writer = McapWriter(file)
        schema = writer.schema("std_msgs/msg/String", "string data")
        for number, topic in enumerate(topics, start=1):
            writer.channel(topic, schema, {})
            writer.chunk([Message(number, 0, 0, 0, b"\x00\x01\x00\x00\x03\x00\x00\x00ab\x00")])
        unknown = writer.channel("/unknown", writer.schema("my_msgs/msg/Thing", "int32 a"), {})
        writer.chunk([Message(unknown, 0, 0, 0, b"\x00\x01\x00\x00\x03\x00\x00\x00")])
        writer.finish()
    with McapFile(path) as file:
        written, remarks = export(file, out, "csv")
    assert len({one.path.name.lower() for one in written}) == len(topics)
    assert all(one.path.parent == out and one.path.is_file() and one.rows == 1 for one in written)
    assert len(remarks) == 1
    assert "my_msgs/msg/Thing is not known" in remarks[0]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["deep", "hostile.mcap"]


def test_texts_and_names_of_fields_are_no_formulas_for_a_spreadsheet(tmp_path: Path) -> None:
    path = tmp_path / "hostile.mcap"
    with path.open("wb", buffering=0) as file:
        writer = McapWriter(file)
        writer.channel("/text", writer.schema("std_msgs/msg/String", "string data"), {})
        text = b'=HYPERLINK("http://[::1]/")\x00'
        writer.chunk([Message(1, 0, 0, 0, b"\x00\x01\x00\x00" + len(text).to_bytes(4, "little") + text)])
        declared = json.dumps([{"name": "@SUM(A1)", "type": "string", "shape": None}])
        writer.channel(f"{FIELDS}/robot", writer.schema(FIELDS_TYPE, ""), {DECLARED: declared})
        writer.finish()
    with McapFile(path) as file:
        export(file, tmp_path / "out", "csv")
    with (tmp_path / "out" / "text.csv").open(newline="") as lines:
        assert [row["data"] for row in csv.DictReader(lines)] == ['\'=HYPERLINK("http://[::1]/")']
    tables = [(tmp_path / "out" / name).read_text() for name in ("text.csv", "morse.fields.robot.csv")]
    assert "'@SUM(A1)" in tables[1]
    assert not any(
        cell[0] in "=@" for table in tables for row in csv.reader(table.splitlines()) for cell in row if cell
    )


def test_texts_in_lists_are_no_formulas_for_a_spreadsheet() -> None:
    # which separates by semicolons, and knows no quotes within a cell
    assert Csv._cell(["a;=1+1", -1]) == '["a;\'=1+1", -1]'


@pytest.mark.parametrize("data", [b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00\xff\xff\xff\xffab", b"\x09" * 40])
def test_damaged_messages_are_refused_with_their_tick(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "damaged.mcap"
    with path.open("wb", buffering=0) as file:
        writer = McapWriter(file)
        writer.channel("/tf", writer.schema("tf2_msgs/msg/TFMessage", ""), {})
        writer.chunk([Message(1, 7, 0, 0, data)])
        writer.finish()
    with McapFile(path) as file, pytest.raises(RecordingError, match="a message of tick 7 is damaged"):
        export(file, tmp_path / "out", "csv")
