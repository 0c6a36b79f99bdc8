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


def test_point_clouds_are_read_by_pypcd4(recording, tmp_path):
    pypcd4 = pytest.importorskip("pypcd4")
    path, _ = recording
    files, _ = exported(path, tmp_path / "pcd", "pcd")
    clouds = sorted(files[0].path.iterdir())
    assert len(clouds) == files[0].rows > 1
    read = [pypcd4.PointCloud.from_path(one) for one in clouds]
    assert all(cloud.fields[:3] == ("x", "y", "z") for cloud in read)
    for cloud, file in zip(read, clouds, strict=True):
        assert np.array_equal(cloud.numpy(("x", "y", "z")), pcd_points(file), equal_nan=True)
    # after a tick at 1 m/s, the near face of the wall, which is 2 x 0.2 m thick, is 3.8 m - 1/60 m away
    points = read[0].numpy(("x", "y", "z"))
    depths = points[np.isfinite(points).all(axis=1)][:, 2]
    assert np.sum(np.abs(depths - (3.8 - 1 / 60)) < 0.04) > 20


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


def _seen(changes=()):
    """Two cameras with the same view, and the options of the one with colors."""

    def scene():
        from morse.builder import ATRV, Cube, Environment, SegmentationCamera, VideoCamera

        robot = ATRV("robot")
        for camera in (SegmentationCamera("labels"), VideoCamera("eye")):
            camera.properties(cam_width=24, cam_height=16)
            camera.translate(x=0.6, y=0.2, z=1.0)
            camera.rotate(z=0.1)
            camera.frequency(2)
            if camera.name == "eye":
                for change in changes:
                    change(camera)
            robot.append(camera)
        for number, (kind, x, y) in enumerate([("parcel", 4.0, 0.5), ("parcel", 4.0, -1.2), ("shelf", 6.0, 2.5)]):
            box = Cube(f"Box{number}")
            box.scale, box.location = (0.4, 0.4, 0.4), (x, y, 0.4)
            box.properties(Object=True, Type=kind)
            box.static()
        Environment("empty")

    return scene


def test_labelled_pictures_are_read_by_pycocotools(tmp_path):
    coco = pytest.importorskip("pycocotools.coco")
    from PIL import Image

    truth = []
    with morse.load(_seen()) as sim, sim.record(tmp_path / "run.mcap"):
        for _ in range(4):
            sim.step(30)
            data = sim.robot.labels.data
            truth.append((data["timestamp"], [dict(one) for one in data["objects"]], np.array(data["image"])))
            picture = np.array(sim.robot.eye.data["image"])
    files, _ = exported(tmp_path / "run.mcap", tmp_path / "out", "coco")
    assert [(one.topic, one.rows) for one in files] == [("/robot/labels/image", 4)]
    data = coco.COCO(files[0].path / "annotations.json")
    names = {one["id"]: one["name"] for one in data.loadCats(data.getCatIds())}
    assert set(names.values()) == {"parcel", "shelf"}
    assert len(data.imgs) == len(truth)
    for (time, objects, ids), number in zip(truth, sorted(data.imgs), strict=True):
        image = data.imgs[number]
        assert image["time"] == pytest.approx(time, abs=1e-6)
        with Image.open(files[0].path / "images" / image["file_name"]) as content:
            colors = np.array(content)
        assert colors.shape == (image["height"], image["width"], 3) == (16, 24, 3)
        expected = {one["id"]: one for one in objects if one["class"]}
        found = {one["object"]["id"]: one for one in data.loadAnns(data.getAnnIds(imgIds=number))}
        assert set(found) == set(expected) != set()
        for key, one in found.items():
            x0, y0, x1, y1 = expected[key]["box"]
            assert one["bbox"] == [x0, y0, x1 - x0, y1 - y0]
            assert names[one["category_id"]] == expected[key]["class"]
            assert one["area"] == expected[key]["pixels"]
            assert (data.annToMask(one).astype(bool) == (ids == key)).all()
    assert (colors == picture[:, :, :3]).all()


@pytest.mark.parametrize(
    "change",
    [
        lambda camera: camera.translate(x=0.01),
        lambda camera: camera.rotate(z=0.02),
        lambda camera: camera.properties(cam_width=20),
        lambda camera: camera.properties(cam_focal=30.0),
    ],
)
def test_a_camera_with_another_view_has_no_labels(tmp_path, change):
    with morse.load(_seen([change])) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(40)
    with pytest.raises(RecordingError, match="no color camera sees the same: add a VideoCamera"):
        exported(tmp_path / "run.mcap", tmp_path / "out", "coco")


def test_without_a_segmentation_camera_there_are_no_labels(recording, tmp_path):
    with pytest.raises(RecordingError, match="has no pictures with labels: it has no images of a SegmentationCamera"):
        exported(recording[0], tmp_path / "out", "coco")


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
