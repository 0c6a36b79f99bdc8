"""Files for other tools, opened by these tools."""

import math

import numpy as np
import pytest

import morse
from morse.recording.errors import RecordingError
from morse.recording.export import FORMS, export
from morse.recording.mcap.reader import McapFile
from tests.kit.programs import python


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    def scene():
        from morse.builder import ATRV, Cube, DepthCamera, Environment, MotionVW, Pose, Sick

        robot = ATRV("robot")
        motion, pose, depth = MotionVW("motion"), Pose("pose"), DepthCamera("depth")
        depth.properties(cam_width=16, cam_height=12)
        depth.translate(z=1.0)
        depth.frequency(2)
        pose.frequency(10)
        for part in (motion, pose, depth, Sick("laser")):
            robot.append(part)
        wall = Cube("Wall")
        wall.scale, wall.location = (0.2, 4.0, 2.0), (4.0, 0.0, 1.0)
        wall.static()
        Environment("empty")

    path = tmp_path_factory.mktemp("formats") / "run.mcap"
    truth = []
    with morse.load(scene) as sim, sim.record(path):
        sim.robot.motion.publish({"v": 1.0, "w": 0.5})
        for _ in range(20):
            sim.step(6)
            data = sim.robot.pose.data
            truth.append([data[name] for name in ("timestamp", "x", "y", "z", "yaw")])
        assert sim.failures == ()
    return path, np.array(truth)


def exported(path, folder, form, topics=()):
    with McapFile(path) as file:
        return export(file, folder, form, topics)


def test_trajectories_are_read_by_evo(recording, tmp_path):
    file_interface = pytest.importorskip("evo.tools.file_interface")
    path, truth = recording
    read = {
        "tum": file_interface.read_tum_trajectory_file,
        "euroc": file_interface.read_euroc_csv_trajectory,
        "kitti": file_interface.read_kitti_poses_file,
    }
    for form, reader in read.items():
        files, remarks = exported(path, tmp_path / form, form)
        assert [one.topic for one in files] == ["/robot/pose"]
        assert remarks == []
        poses = reader(str(files[0].path))
        assert poses.positions_xyz == pytest.approx(truth[:, 1:4], abs=1e-9)
        yaws = [math.atan2(pose[1][0], pose[0][0]) for pose in poses.poses_se3]
        assert yaws == pytest.approx(truth[:, 4], abs=1e-9)
        if form != "kitti":
            assert poses.timestamps == pytest.approx(truth[:, 0], abs=1e-6)


def test_point_clouds_are_read_by_laspy(recording, tmp_path):
    laspy = pytest.importorskip("laspy")
    path, _ = recording
    las, _ = exported(path, tmp_path / "las", "las")
    pcd, _ = exported(path, tmp_path / "pcd", "pcd")
    assert [one.topic for one in las] == [one.topic for one in pcd] != []
    files = sorted(las[0].path.iterdir())
    assert len(files) == las[0].rows > 1
    cloud = laspy.read(files[0])
    points = pcd_points(sorted(pcd[0].path.iterdir())[0])
    finite = points[np.isfinite(points).all(axis=1)]
    assert len(finite) > 20
    assert cloud.xyz == pytest.approx(finite, abs=0.6e-3)


def pcd_points(path):
    """The points of a PCD file by its header (pointclouds.org, version 0.7)."""
    head, _, data = path.read_bytes().partition(b"DATA binary\n")
    facts = dict(line.split(" ", 1) for line in head.decode().splitlines() if not line.startswith("#"))
    kinds = {"F": "f", "U": "u", "I": "i"}
    names = facts["FIELDS"].split()
    sizes = zip(facts["TYPE"].split(), facts["SIZE"].split(), strict=True)
    dtype = np.dtype([(name, f"<{kinds[kind]}{size}") for name, (kind, size) in zip(names, sizes, strict=True)])
    points = np.frombuffer(data, dtype)
    assert len(points) == int(facts["POINTS"]) == int(facts["WIDTH"])
    return np.stack([points[axis] for axis in "xyz"], axis=1).astype(float)


def test_arrays_of_numpy_need_no_pickle(recording, tmp_path):
    path, truth = recording
    files, _ = exported(path, tmp_path / "numpy", "numpy", ["/robot/pose", "/morse/fields/robot/pose", "/robot/laser"])
    by_topic = {one.topic: np.load(one.path, allow_pickle=False) for one in files}
    assert by_topic["/robot/pose"]["pose.position.x"] == pytest.approx(truth[:, 1])
    assert by_topic["/morse/fields/robot/pose"]["yaw"] == pytest.approx(truth[:, 4])
    assert by_topic["/robot/laser"]["ranges"].shape[1] == 181


def test_topics_without_poses_are_told(recording, tmp_path):
    path, _ = recording
    _, remarks = exported(path, tmp_path / "a", "tum", ["/robot/laser"])
    assert remarks == ["/robot/laser is left out: its messages have no position with an orientation"]
    with morse.load(_bare) as sim, sim.record(tmp_path / "bare.mcap"):
        sim.step(2)
    with pytest.raises(RecordingError, match="has no topic with point clouds"):
        exported(tmp_path / "bare.mcap", tmp_path / "b", "las")


def _bare():
    from morse.builder import ATRV, Environment

    ATRV("robot")
    Environment("empty")


def test_the_command(recording, tmp_path):
    path, _ = recording
    done = python("-m", "morse", "export", str(path), "--as", "tum", "--to", str(tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "robot.pose.tum").is_file()
    done = python("-m", "morse", "export", str(path), "--as", "tumm")
    assert done.returncode == 2
    assert "did you mean 'tum'" in done.stdout + done.stderr
    assert "tum" in FORMS
