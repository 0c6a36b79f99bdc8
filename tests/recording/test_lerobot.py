"""Data sets in the layout of LeRobot 2.1: github.com/huggingface/lerobot, `lerobot/datasets`, release 0.3."""

import io
import json
import resource
import signal

import numpy as np
import pytest

import morse
from morse.recording.errors import RecordingError
from morse.recording.export import export
from morse.recording.mcap.reader import McapFile
from tests.kit.programs import python

parquet = pytest.importorskip("pyarrow.parquet")

#: columns that `lerobot.datasets.utils.DEFAULT_FEATURES` requires
DEFAULT = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}


def scene():
    from morse.builder import ATRV, Cube, DepthCamera, Environment, Gyroscope, MotionVW, Pose, Sick, VideoCamera

    robot = ATRV("robot")
    eye, depth, pose, slow = VideoCamera("eye"), DepthCamera("depth"), Pose("pose"), Gyroscope("gyroscope")
    for camera in (eye, depth):
        camera.properties(cam_width=16, cam_height=12)
        camera.translate(x=0.5, z=1.0)
        camera.frequency(10)
    pose.frequency(30)
    slow.frequency(4)
    for part in (MotionVW("motion"), pose, slow, eye, depth, Sick("laser")):
        robot.append(part)
    box = Cube("Box")
    box.scale, box.location = (0.4, 4.0, 1.0), (4.0, 0.0, 0.5)
    box.static()
    Environment("empty")


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """Two lives in which a controller answers to each picture; what the sensors had measured at each."""
    path = tmp_path_factory.mktemp("lerobot") / "run.mcap"
    truth = []
    with morse.load(scene) as sim, sim.record(path):
        for life in range(2):
            sim.step(1)
            for number in range(6 + life):
                # nothing answers to the last picture: the command before holds
                if number < 5 + life:
                    command = {"v": 0.5 + 0.125 * number, "w": 0.25 * (life + 1)}
                    sim.robot.motion.publish(command)
                pose = sim.robot.pose.data
                truth.append(
                    (life, [pose[name] for name in "xyz"], command, np.array(sim.robot.eye.data["image"])[:, :, :3],
                     list(sim.robot.laser.data["range_list"]))
                )  # fmt: skip
                if number < 5 + life:
                    sim.step(6)
            if not life:
                sim.restart()
        assert sim.failures == ()
    return path, truth


def exported(path, folder, topics=()):
    with McapFile(path) as file:
        return export(file, folder, "lerobot", topics)


@pytest.fixture(scope="module")
def data_set(recording, tmp_path_factory):
    files, remarks = exported(recording[0], tmp_path_factory.mktemp("out") / "set")
    assert remarks == []
    (one,) = files
    assert one.path.name == "robot.lerobot"
    assert one.left_out == ("depth.intrinsic_matrix", "depth.points", "eye.intrinsic_matrix")
    return one.path


def lines(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def test_the_layout_holds_its_own_rules(data_set):
    info = json.loads((data_set / "meta" / "info.json").read_text())
    episodes = lines(data_set / "meta" / "episodes.jsonl")
    statistics = lines(data_set / "meta" / "episodes_stats.jsonl")
    assert info["codebase_version"] == "v2.1"
    assert info["fps"] == 10
    assert info["total_episodes"] == len(episodes) == len(statistics) == 2
    assert info["total_frames"] == sum(one["length"] for one in episodes)
    assert lines(data_set / "meta" / "tasks.jsonl") == [{"task_index": 0, "task": episodes[0]["tasks"][0]}]
    assert not [name for name in info["features"] if "/" in name]
    assert {name: info["features"][name]["dtype"] for name in DEFAULT} == DEFAULT
    total = 0
    for number, episode in enumerate(episodes):
        path = info["data_path"].format(episode_chunk=number // info["chunks_size"], episode_index=number)
        rows = parquet.read_table(data_set / path)
        assert set(rows.column_names) == set(info["features"])
        assert rows.num_rows == episode["length"]
        assert rows["frame_index"].to_pylist() == list(range(rows.num_rows))
        assert rows["index"].to_pylist() == list(range(total, total + rows.num_rows))
        assert set(rows["episode_index"].to_pylist()) == {number}
        # `check_timestamps_sync` allows 1e-4 s
        assert np.diff(rows["timestamp"].to_numpy()) == pytest.approx(1 / info["fps"], abs=1e-4)
        for name, feature in info["features"].items():
            found = statistics[number]["stats"][name]
            assert found["count"] == [rows.num_rows]
            shape = (3, 1, 1) if feature["dtype"] == "image" else tuple(feature["shape"])
            assert np.shape(found["mean"]) == np.shape(found["std"]) == shape
            if feature["dtype"] != "image":
                values = np.array(rows[name].to_pylist(), float).reshape(rows.num_rows, -1)
                assert found["mean"] == pytest.approx(values.mean(axis=0), abs=1e-5)
                assert found["std"] == pytest.approx(values.std(axis=0), abs=1e-4)
                assert found["max"] == pytest.approx(values.max(axis=0), abs=1e-5)
        total += rows.num_rows


def test_frames_have_what_the_robot_saw_and_the_command_that_answered(recording, data_set):
    from PIL import Image

    features = json.loads((data_set / "meta" / "info.json").read_text())["features"]
    state, action = features["observation.state"]["names"], features["action"]["names"]
    assert action == ["motion.v", "motion.w"]
    rows = [
        row
        for number in range(2)
        for row in parquet.read_table(data_set / "data" / "chunk-000" / f"episode_{number:06d}.parquet").to_pylist()
    ]
    assert len(rows) == len(recording[1])
    for row, (life, position, command, picture, ranges) in zip(rows, recording[1], strict=True):
        assert row["episode_index"] == life
        seen = dict(zip(state, row["observation.state"], strict=True))
        assert [seen[f"pose.{axis}"] for axis in "xyz"] == pytest.approx(position, abs=1e-6)
        assert dict(zip(action, row["action"], strict=True)) == pytest.approx(
            {f"motion.{name}": value for name, value in command.items()}
        )
        with Image.open(io.BytesIO(row["observation.images.eye"]["bytes"])) as content:
            assert (np.array(content) == picture).all()
        assert row["observation.laser.range_list"] == pytest.approx(ranges, rel=1e-6)


def test_a_slower_sensor_is_held(data_set):
    info = json.loads((data_set / "meta" / "info.json").read_text())
    column = info["features"]["observation.state"]["names"].index("gyroscope.yaw")
    rows = parquet.read_table(data_set / "data" / "chunk-000" / "episode_000001.parquet")
    values = np.array(rows["observation.state"].to_pylist())[:, column]
    # seven frames in 0.6 s, of measurements at 0, 0.25 and 0.5 s
    assert len(np.unique(values)) == 3


def test_the_library_of_hugging_face_reads_it(data_set, tmp_path, monkeypatch):
    datasets = pytest.importorskip("datasets")
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    rows = datasets.load_dataset(
        "parquet", data_dir=str(data_set / "data"), split="train", cache_dir=str(tmp_path / "cache")
    )
    info = json.loads((data_set / "meta" / "info.json").read_text())
    assert len(rows) == info["total_frames"]
    assert isinstance(rows.features["observation.images.eye"], datasets.Image)
    assert rows[0]["observation.images.eye"].size == (16, 12)
    assert len(rows[0]["action"]) == 2


def test_lerobot_reads_it(data_set):
    lerobot = pytest.importorskip("lerobot.datasets.lerobot_dataset")
    if lerobot.CODEBASE_VERSION != "v2.1":
        pytest.skip("this lerobot reads another version")
    rows = lerobot.LeRobotDataset("morse/robot", root=data_set)
    assert rows.num_episodes == 2
    assert rows[0]["observation.images.eye"].shape == (3, 12, 16)


def _silent():
    from morse.builder import ATRV, Environment, MotionVW, Pose

    first, second = ATRV("robot"), ATRV("other")
    first.append(MotionVW("motion"))
    first.append(Pose("pose"))
    second.translate(x=5)
    Environment("empty")


def test_without_commands_there_is_no_action(tmp_path):
    with morse.load(_silent) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(10)
    files, remarks = exported(tmp_path / "run.mcap", tmp_path / "out")
    assert remarks == ["robot: no actuator had a command with numbers, so there is no action"]
    info = json.loads((files[0].path / "meta" / "info.json").read_text())
    assert "action" not in info["features"]
    assert info["fps"] == 60
    assert files[0].rows == info["total_frames"] == 10


def test_a_life_without_commands_is_left_out(tmp_path):
    with morse.load(_silent) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(5)
        sim.restart()
        sim.robot.motion.publish({"v": 1.0, "w": 0.0})
        sim.step(5)
    files, remarks = exported(tmp_path / "run.mcap", tmp_path / "out")
    assert remarks == ["robot: episode 0 is left out: it has no motion.v, motion.w"]
    assert lines(files[0].path / "meta" / "episodes.jsonl")[0]["episode_index"] == 0


def _bare():
    from morse.builder import ATRV, Environment

    ATRV("robot")
    Environment("empty")


def test_a_recording_without_sensors_is_refused(tmp_path):
    with morse.load(_bare) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(2)
    with pytest.raises(RecordingError, match="has no robot with data: it has no data fields of sensors"):
        exported(tmp_path / "run.mcap", tmp_path / "out")


@pytest.mark.parametrize("name", ["../../evil", "a/b", "..", "C:\\x"])
def test_names_with_slashes_stay_in_the_folder(tmp_path, monkeypatch, name):
    with morse.load(_silent) as sim, sim.record(tmp_path / "run.mcap"):
        sim.robot.motion.publish({"v": 1.0, "w": 0.0})
        sim.step(5)
    with McapFile(tmp_path / "run.mcap") as file:
        for channel in file.channels.values():
            if "morse.component" in channel.metadata:
                channel.metadata["morse.component"] = f"{name}.{name}"
        try:
            files, _ = export(file, tmp_path / "deep" / "out", "lerobot")
        except RecordingError:
            files = []
    assert {path.name for path in tmp_path.iterdir()} == {"run.mcap", "deep"}
    assert {path.name for path in (tmp_path / "deep").iterdir()} == {"out"}
    for one in files:
        assert one.path.parent == tmp_path / "deep" / "out"
        info = json.loads((one.path / "meta" / "info.json").read_text())
        assert not [key for key in info["features"] if "/" in key or "\\" in key]


def test_a_full_disk_leaves_nothing_that_is_read_as_a_data_set(recording, tmp_path):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, before[1]))
        with pytest.raises(OSError, match="too large"):
            exported(recording[0], tmp_path / "out")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    assert not (tmp_path / "out" / "robot.lerobot" / "meta" / "info.json").exists()


def test_the_command(recording, tmp_path):
    done = python("-m", "morse", "export", str(recording[0]), "--as", "lerobot", "--to", str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    assert "13 frames of robot" in done.stdout + done.stderr
