"""Cameras on robots: the contents of their data and messages."""

import base64
import json
import math
import socket
import time

import numpy as np
import pytest
from messages import published

from morse.core.exceptions import MorseRPCTypeError
from morse.simulation.loader import LoadError

pytestmark = pytest.mark.long

HEAD = """
robot = FakeRobot("robot")
robot.translate(1, 0, 0)
"""
END = """
wall = Cube("Wall"); wall.scale = (0.1, 20, 20); wall.location = (6.1, 0, 0)
red = Cube("Red"); red.scale = (0.2, 0.2, 0.2); red.location = (4, -1, 1); red.color(1, 0, 0)
red.properties(Object=True, Label="THING", Description="a red box", Type="Box")
env = Environment("empty")
"""


def scene(line, more=""):
    return f"{HEAD}eye = {line}\nrobot.append(eye)\n{more}\n{END}"


@pytest.fixture
def published_camera(load):
    """As `camera`, with a port on which the camera is published."""

    def start(line, more):
        simulation = load(scene(line, more), sockets=True)
        simulation.sleep(0.1)
        return simulation.context.component("robot.eye"), simulation

    return start


@pytest.fixture
def camera(simulate):
    def make(line, more=""):
        simulation = simulate(scene(line, more), sockets=False)
        simulation.sleep(0.1)
        return simulation.context.component("robot.eye"), simulation

    return make


# --- VideoCamera ------------------------------------------------------------------------------


def test_a_picture_is_rgba_with_the_top_row_first(camera):
    eye, _ = camera("VideoCamera('eye')", "eye.properties(cam_width=64, cam_height=48, cam_focal=16)")
    image = eye.local_data["image"]
    assert image.dtype == np.uint8
    assert image.shape == (48, 64, 4)
    assert (image[..., 3] == 255).all()
    assert eye.local_data["intrinsic_matrix"] == [[32.0, 0, 31.5], [0, 32.0, 23.5], [0, 0, 1]]
    red = (image[..., 0] > 100) & (image[..., 1] < 90) & (image[..., 2] < 90)
    rows, columns = np.nonzero(red)
    # the box is 3 m ahead, 1 m to the right and 1 m up: 32 / 2.8 to 32 / 3.2 pixels from the middle
    assert columns.mean() == pytest.approx(32 + 32 / 2.85, abs=2)
    assert rows.mean() == pytest.approx(24 - 32 / 2.85, abs=2)


def test_without_vertical_flip_the_bottom_row_is_first(camera):
    flipped, _ = camera("VideoCamera('eye')", "eye.properties(Vertical_Flip=False)")
    plain, _ = camera("VideoCamera('eye')")
    np.testing.assert_array_equal(flipped.local_data["image"][::-1], plain.local_data["image"])


def test_what_scripts_get_if_they_say_nothing(camera):
    eye, simulation = camera("VideoCamera('eye')")
    assert eye.local_data["image"].shape == (256, 256, 4)
    # 35 mm of 32 mm
    assert eye.local_data["intrinsic_matrix"][0][0] == 280.0
    assert eye.frequency == 20.0
    assert list(eye.local_data) == ["timestamp", "image", "intrinsic_matrix"]
    messages = published(eye)
    simulation.sleep(1.0)
    assert len(messages) == 20


def test_the_angle_of_view_replaces_the_focal_length(camera):
    eye, _ = camera("VideoCamera('eye')", "eye.properties(cam_fov=90.0)")
    assert eye.local_data["intrinsic_matrix"][0][0] == pytest.approx(128.0)


def test_the_camera_looks_where_the_robot_looks_and_sees_nothing_out_of_reach(camera):
    eye, _ = camera("DepthVideoCamera('eye')", "eye.properties(cam_near=0.1, cam_far=3.0, Vertical_Flip=True)")
    assert np.isinf(eye.local_data["image"][128, 128])
    eye, _ = camera("DepthVideoCamera('eye')", "eye.properties(cam_near=0.1, cam_far=30.0)")
    assert eye.local_data["image"][128, 128] == pytest.approx(5.0, rel=1e-5)


@pytest.mark.parametrize(
    ("turn", "expected"),
    [
        ("x=0.3", (math.cos(0.3), math.sin(0.3), 0.0)),
        ("y=0.3", (math.cos(0.3), 0.0, math.sin(0.3))),
        ("z=0.3", (1.0, 0.0, 0.0)),
    ],
)
def test_rotations_are_exchanged_as_in_morse_14(camera, turn, expected):
    eye, _ = camera("VideoCamera('eye')", f"eye.rotate({turn})")
    rotation = np.reshape(eye.bge_object.world_pose()[1], (3, 3))
    np.testing.assert_allclose(rotation[:, 2], expected, atol=1e-6)
    if turn.startswith("x"):
        np.testing.assert_allclose(rotation[:, 1], (0, 0, -1), atol=1e-6)


def test_capture_takes_so_many_pictures(camera):
    eye, simulation = camera("VideoCamera('eye')", "eye.properties(capturing=False)")
    assert eye.local_data["image"].shape == (0, 0, 4)
    eye.capture(None, 2)
    outcomes = []
    eye.on_completion = outcomes.append
    seen = []
    eye.output_functions.append(lambda sensor: seen.append(sensor.capturing))
    simulation.sleep(0.5)
    assert outcomes == [("SUCCESS", None)]
    assert seen[:2] == [True, True]
    assert not any(seen[2:])
    before = eye.local_data["image"]
    simulation.sleep(0.5)
    assert eye.local_data["image"] is before


def test_capture_without_end_can_be_interrupted(camera):
    eye, simulation = camera("VideoCamera('eye')")
    outcomes = []
    eye.capture(outcomes.append, -1)
    simulation.sleep(0.5)
    assert outcomes == []
    assert eye.capturing
    eye.interrupt()
    assert outcomes[0][0] == "PREEMPTED"
    assert not eye.capturing


def test_the_error_of_a_scene_names_camera_and_line(camera):
    with pytest.raises(LoadError) as refusal:
        camera("VideoCamera('eye')", "eye.properties(cam_fov=180)")
    said = str(refusal.value)
    assert "'robot.eye'" in said
    assert "scene0.py:5" in said
    assert "got 180" in said
    assert "equidistant" in said
    assert "File" not in said
    with pytest.raises(LoadError, match=r"keep_list.*\[1, 17, 34\].*got 'all'"):
        camera("DepthCamera('eye')", "eye.properties(keep_list='all')")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("cam_width", 0),
        ("cam_width", 10**6),
        ("cam_fov", 180.0),
        ("cam_fov", math.nan),
        ("cam_near", 200.0),
        ("cam_far", -1),
    ],
)
def test_properties_that_make_no_picture_are_refused(camera, name, value):
    eye, simulation = camera("VideoCamera('eye')")
    with pytest.raises(MorseRPCTypeError):
        eye.set_property(name, value)
    simulation.sleep(0.2)
    assert eye.local_data["image"].shape == (256, 256, 4)


def test_properties_can_change_while_it_runs(camera):
    eye, simulation = camera("VideoCamera('eye')")
    eye.set_property("cam_width", 40)
    eye.set_property("cam_height", 30)
    simulation.sleep(0.2)
    assert eye.local_data["image"].shape == (30, 40, 4)
    assert eye.local_data["intrinsic_matrix"][0][2] == 19.5


def first_line(simulation, name):
    """The first message of a client of the socket."""
    (services,) = simulation.context.services.request_managers().values()
    _, (_, port) = services.on_incoming_request("simulation", "get_stream_port", [name])
    with socket.create_connection(("127.0.0.1", port)) as client:
        client.settimeout(0.02)
        text, end = b"", time.monotonic() + 60.0
        while time.monotonic() < end:
            simulation.sleep(1 / 60)
            try:
                text += client.recv(1 << 22)
            except TimeoutError:
                continue
            if b"\n" in text:
                break
    return json.loads(text.splitlines()[0])


def test_old_clients_read_pictures_from_the_socket(published_camera):
    more = "eye.properties(cam_width=20, cam_height=10)\neye.add_stream('socket')"
    eye, simulation = published_camera("VideoCamera('eye')", more)
    message = first_line(simulation, "robot.eye")
    assert list(message) == ["timestamp", "height", "width", "image", "intrinsic_matrix"]
    assert (message["height"], message["width"]) == (10, 20)
    pixels = np.frombuffer(base64.b64decode(message["image"]), np.uint8).reshape(10, 20, 4)
    np.testing.assert_array_equal(pixels, eye.local_data["image"])


@pytest.mark.parametrize("kind", ["DepthCamera", "VLP16_180"])
def test_old_clients_read_clouds_from_the_socket(published_camera, kind):
    eye, simulation = published_camera(f"{kind}('eye')", "eye.add_stream('socket')")
    message = first_line(simulation, "robot.eye")
    assert list(message)[:4] == ["timestamp", "height", "width", "points"]
    points = np.frombuffer(base64.b64decode(message["points"]), np.float32).reshape(-1, 3)
    np.testing.assert_array_equal(points, eye.local_data["points"])


def test_a_state_is_saved_and_restored_to_the_bit(camera):
    eye, simulation = camera("VideoCamera('eye')", "motion = MotionVW(); robot.append(motion)")
    running = simulation
    state = running.save()
    simulation.sleep(0.5)
    later = eye.local_data["image"].copy()
    running.restore(state)
    simulation.sleep(0.5)
    np.testing.assert_array_equal(simulation.context.component("robot.eye").local_data["image"], later)


# --- depth ------------------------------------------------------------------------------------


def test_a_cloud_lies_on_what_is_seen(camera):
    eye, _ = camera("DepthCamera('eye')", "eye.properties(cam_width=64, cam_height=48)")
    points = eye.local_data["points"]
    assert points.dtype == np.float32
    assert points.shape == (eye.local_data["nb_points"], 3) == (64 * 48, 3)
    wall = points[points[:, 2] > 4.0]
    np.testing.assert_allclose(wall[:, 2], 5.0, rtol=1e-5)
    box = points[(points[:, 2] < 4.0) & (points[:, 1] < -0.5)]
    # X to the right, Y down
    assert box[:, 0].min() >= 0.8 - 0.05
    assert box[:, 0].max() <= 1.2 + 0.05
    assert box[:, 1].max() <= -0.8 + 0.05
    # the bottom row comes first
    assert points[0, 1] > 0 > points[-1, 1]


def test_points_beyond_the_far_plane_are_left_out_or_null(camera):
    more = "eye.properties(cam_width=64, cam_height=48, cam_far=4.0, cam_focal=16)"
    few, _ = camera("DepthCamera('eye')", more)
    assert 0 < few.local_data["nb_points"] < 1000
    whole, _ = camera("DepthCamera('eye')", more + "\neye.properties(keep_resolution=True)")
    points = whole.local_data["points"]
    assert points.shape == (64 * 48, 3)
    assert np.count_nonzero(points.any(axis=1)) == few.local_data["nb_points"]
    seen = points[points.any(axis=1)]
    np.testing.assert_array_equal(seen, few.local_data["points"])


def test_some_rows_are_kept(camera):
    eye, _ = camera("DepthCamera('eye')", "eye.properties(cam_width=8, cam_height=48, keep_list='[1, 24, 47, 99]')")
    assert eye.local_data["nb_points"] == 3 * 8
    rows = np.unique(
        np.round(eye.local_data["points"][:, 1] / eye.local_data["points"][:, 2] * eye.lens.fy + 24 - 0.5, 3)
    )
    assert rows.tolist() == pytest.approx([1, 24, 47])


def test_the_z_buffer_is_that_of_opengl(camera):
    eye, _ = camera("RawImage('eye')", "eye.properties(cam_near=1.0, cam_far=20.0)")
    image = eye.local_data["image"]
    assert image.shape == (256, 256)
    assert image[128, 128] == pytest.approx(20 * (5 - 1) / (5 * (20 - 1)), rel=1e-5)


# --- SemanticCamera ---------------------------------------------------------------------------


def test_things_are_seen_where_they_are(camera):
    eye, _ = camera("SemanticCamera('eye')", "eye.properties(cam_focal=16)")
    (seen,) = eye.local_data["visible_objects"]
    assert list(seen) == ["name", "description", "type", "position", "orientation"]
    assert (seen["name"], seen["description"], seen["type"]) == ("THING", "a red box", "Box")
    assert seen["position"] == pytest.approx([4, -1, 1])
    assert tuple(seen["orientation"]) == pytest.approx((1, 0, 0, 0))
    assert list(eye.local_data) == ["timestamp", "visible_objects"]


def test_relative_poses_are_in_the_frame_of_the_camera(camera):
    """As in the test of MORSE 1.4: a box 2.2 m ahead and 0.2 m up, of a robot that faces -X."""
    more = """
robot.rotate(z=math.pi)
eye.properties(relative=True)
other = Cube("Other"); other.scale = (0.1, 0.1, 0.1); other.location = (1 - 2.2, 0, 0.2)
other.properties(Object=True, Label="RedBox")
"""
    eye, _ = camera("SemanticCamera('eye')", "import math" + more)
    (seen,) = eye.local_data["visible_objects"]
    assert seen["position"] == pytest.approx([0, -0.2, 2.2], abs=1e-6)
    q = seen["orientation"]
    assert [q.w, q.x, q.y, q.z] == pytest.approx([0.5, 0.5, 0.5, -0.5], abs=1e-6)


def test_what_stands_in_front_hides_things_unless_it_is_not_to(camera):
    curtain = """
eye.properties(cam_focal=16{})
curtain = Cube("Curtain"); curtain.scale = (0.05, 3, 3); curtain.location = (2.5, 0, 0)
"""
    eye, _ = camera("SemanticCamera('eye')", curtain.format(""))
    assert eye.local_data["visible_objects"] == []
    eye, _ = camera("SemanticCamera('eye')", curtain.format(", noocclusion=True"))
    assert [seen["name"] for seen in eye.local_data["visible_objects"]] == ["THING"]
    eye, _ = camera("SemanticCamera('eye')", curtain.format(", noocclusion=True") + "eye.rotate(x=1.5)")
    assert eye.local_data["visible_objects"] == []


def test_things_are_those_with_the_tag(camera):
    eye, _ = camera("SemanticCamera('eye')", "eye.properties(cam_focal=16, tag='Shiny')")
    assert eye.local_data["visible_objects"] == []


# --- several cameras --------------------------------------------------------------------------


def test_a_stereo_unit_lets_its_cameras_capture(simulate):
    simulation = simulate(
        HEAD
        + """
unit = StereoUnit("unit")
left = VideoCamera("left"); left.translate(y=0.1); unit.append(left)
right = VideoCamera("right"); right.translate(y=-0.1); unit.append(right)
for one in (left, right):
    one.properties(capturing=False, cam_width=32, cam_height=32)
robot.append(unit)
"""
        + END,
        sockets=False,
    )
    simulation.sleep(0.2)
    unit, left = simulation.context.component("robot.unit"), simulation.context.component("robot.unit.left")
    assert left.local_data["image"].size == 0
    outcomes = []
    unit.capture(outcomes.append, 2)
    simulation.sleep(0.5)
    assert outcomes == [("SUCCESS", None)]
    assert left.local_data["image"].shape == (32, 32, 4)
    assert simulation.context.component("robot.unit.right").local_data["image"].shape == (32, 32, 4)


def test_a_kinect_has_two_cameras(simulate):
    simulation = simulate(HEAD + "kinect = Kinect()\nrobot.append(kinect)\n" + END, sockets=False)
    simulation.sleep(0.2)
    assert simulation.context.component("robot.Kinect.rgb").local_data["image"].shape == (128, 128, 4)
    depth = simulation.context.component("robot.Kinect.depth").local_data["image"]
    assert depth.shape == (128, 128)
    assert depth[64, 64] == pytest.approx(5.0 - 0.06, rel=1e-4)


def test_a_rotating_camera_turns_by_its_angle_of_view(camera):
    eye, simulation = camera("Velodyne('eye')", "eye.properties(cam_width=32, cam_height=32, cam_far=50.0)")
    start = np.reshape(eye.bge_object.world_pose()[1], (3, 3))[:, 2]
    messages = published(eye)
    simulation.sleep(0.1)
    assert len(messages) == 2
    ahead = np.reshape(eye.bge_object.world_pose()[1], (3, 3))[:, 2]
    assert start @ ahead == pytest.approx(math.cos(2 * 2 * math.atan(16 / 35)), abs=1e-3)
    assert ahead[2] == pytest.approx(0.0, abs=1e-6)


def test_a_vlp16_joins_the_clouds_of_its_cameras_in_the_frame_of_the_first(simulate):
    simulation = simulate(
        HEAD + "lidar = VLP16_180('lidar')\nlidar.translate(0, 0, 1)\nrobot.append(lidar)\n" + END, sockets=False
    )
    lidar = simulation.context.component("robot.lidar")
    messages = published(lidar)
    simulation.sleep(0.5)
    assert len(messages) == 5
    points = lidar.local_data["points"]
    assert len(points) == lidar.local_data["nb_points"] > 5000
    parts = [simulation.context.component(f"robot.lidar.cam{i}").local_data["points"] for i in (1, 2, 3)]
    assert sum(map(len, parts)) == len(points)
    np.testing.assert_allclose(points[: len(parts[0])], parts[0], atol=1e-5)
    # the wall is 5 m ahead of the robot: the master is rotated 60 degrees to the right
    ahead = points[:, 2] * math.cos(math.radians(60)) - points[:, 0] * math.sin(math.radians(60))
    on_wall = np.abs(ahead - 5.0) < 1e-3
    assert on_wall.mean() > 0.2
    # only those sixteen rows of each camera
    middle = parts[1]
    rows = np.unique(np.round(middle[:, 1] / middle[:, 2] * (512 * 27.7 / 32) + 128 - 0.5))
    assert len(rows) <= 16
    assert set(rows) <= {1, 17, 34, 51, 68, 85, 102, 120, 137, 154, 171, 188, 205, 222, 239, 255}


def test_a_scene_without_cameras_loads_no_renderer(tmp_path):
    import subprocess
    import sys

    script = tmp_path / "plain.py"
    script.write_text(
        "from morse.builder import *\nrobot = FakeRobot()\nrobot.append(Pose())\nenv = Environment('empty')\n"
    )
    program = (
        "import sys, morse\n"
        f"with morse.load({str(script)!r}) as sim: sim.step(3)\n"
        "print([m for m in sys.modules if m.startswith(('morse.rendering', 'morse.kernel.drawing', 'PIL'))])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_camera_in_fastmode_takes_no_pictures(simulate, caplog):
    simulation = simulate(
        scene("VideoCamera('eye')").replace('Environment("empty")', 'Environment("empty", fastmode=True)'),
        sockets=False,
    )
    simulation.sleep(0.1)
    assert simulation.context.component("robot.eye").local_data["image"].size == 0
    assert "fastmode" in caplog.text
