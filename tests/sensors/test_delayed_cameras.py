"""Cameras with a delay: images are rendered while the simulation goes on, and show the tick of their time stamp."""

import hashlib
import math

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseRPCTypeError
from morse.simulation.loader import LoadError

pytestmark = pytest.mark.long

SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
robot.translate(0, 0, 0.5)
motion = MotionVW("motion")
robot.append(motion)
lamp = Light("lamp")
lamp.translate(x=0.2)
robot.append(lamp)
for name, make in (("color", VideoCamera), ("cloud", DepthCamera), ("depth", DepthVideoCamera),
                   ("normals", NormalCamera), ("flow", OpticalFlowCamera),
                   ("semantic", SemanticCamera), ("heat", ThermalCamera),
                   ("things", SegmentationCamera)):
    camera = make(name)
    camera.properties(cam_width=32, cam_height=24, cam_focal=20.0, cam_near=0.1)
    camera.frequency(20)
    camera.delay({delay})
    {more}
    robot.append(camera)
box = Cube("Box")
box.scale, box.location = (0.3, 0.3, 0.3), (4, 0, 0.4)
box.properties(Object=True, Temperature=40.0)
ball = Sphere("Ball")
ball.scale, ball.location = (0.3, 0.3, 0.3), (3, 0.8, 2.0)
env = Environment("empty")
"""
CAMERAS = ("color", "cloud", "depth", "normals", "flow", "semantic", "heat", "things")
NOISY = """
    if name == 'color':
        camera.properties(full_well=2000, auto_exposure=True, stuck_pixels=0.01)
    if name == 'depth':
        camera.noise(gaussian=0.01, dropout=0.1, field='image')
"""


@pytest.fixture
def load(load):
    def drive(delay=0.05, more="pass"):
        simulation = load(SCENE.format(delay=delay, more=more))
        simulation.robot.motion.publish({"v": 1.0, "w": 0.4})
        return simulation

    return drive


def listen(simulation, names=CAMERAS):
    """Digests of all published images: camera, time stamp and content."""
    heard = []

    def hear(sensor):
        digest = hashlib.sha256()
        for name in sorted(sensor.local_data):
            value = sensor.local_data[name]
            digest.update(value.tobytes() if isinstance(value, np.ndarray) else repr(value).encode())
        heard.append((sensor.name(), sensor.local_data["timestamp"], digest.hexdigest()))

    for name in names:
        simulation.context.components[f"robot.{name}"].output_functions.append(hear)
    return heard


def test_images_are_those_of_a_camera_without_delay(load):
    at_once, later = load(delay=0.0, more=NOISY), load(delay=0.12, more=NOISY)
    direct, delayed = listen(at_once), listen(later)
    at_once.step(60)
    later.step(60)
    assert len(direct) == 160
    # 0.12 s are 8 ticks at most, and two or three images of each camera
    assert 136 <= len(delayed) <= 144
    assert set(delayed) <= set(direct)
    assert len({content for _, _, content in delayed}) > 60


def test_images_come_when_their_delay_has_passed(load):
    simulation = load(delay=0.1)
    heard = []
    camera = simulation.context.components["robot.color"]
    camera.output_functions.append(lambda one: heard.append((one.local_data["timestamp"], simulation.clock.time)))
    simulation.step(60)
    assert [taken for taken, _ in heard] == pytest.approx([1 / 60 + 0.05 * n for n in range(18)])
    assert [seen - taken for taken, seen in heard] == pytest.approx([0.1] * 18)


def test_a_delayed_image_is_seen_by_nobody_early(load):
    simulation = load(delay=0.2)
    simulation.step(12)
    assert simulation.robot.color.data["image"].size == 0
    assert simulation.robot.color.data["timestamp"] == 0.0
    simulation.step(1)
    assert simulation.robot.color.data["image"].shape == (24, 32, 4)
    assert simulation.robot.color.data["timestamp"] == pytest.approx(1 / 60)


def test_a_saved_state_holds_the_images_under_way(load):
    simulation = load(delay=0.15, more=NOISY)
    simulation.step(20)
    state = simulation.save()
    first = listen(simulation)
    simulation.step(30)
    end = simulation.state_hash()
    expected = list(first)
    first.clear()
    simulation.restore(state)
    assert simulation.save() == state
    simulation.step(30)
    assert first == expected
    assert simulation.state_hash() == end
    other = load(delay=0.15, more=NOISY)
    heard = listen(other)
    other.restore(state)
    other.step(30)
    assert heard == expected
    assert other.state_hash() == end


def test_saving_does_not_change_the_images(load):
    undisturbed, saved = load(delay=0.1, more=NOISY), load(delay=0.1, more=NOISY)
    one, two = listen(undisturbed), listen(saved)
    for _ in range(30):
        undisturbed.step()
        saved.step()
        saved.save()
    assert one == two
    assert undisturbed.state_hash() == saved.state_hash()


def test_objects_come_and_go_while_images_are_rendered(load):
    simulation, plain = load(delay=0.1), load(delay=0.0)
    delayed, direct = listen(simulation), listen(plain)
    for one in (simulation, plain):
        one.step(4)
        one.spawn("crate", "props/crates", (2.0, 0.0, 0.0))
        one.step(3)
        one.delete("Box")
        one.step(5)
        one.delete("crate")
        one.step(20)
    assert len(delayed) > 30
    assert set(delayed) <= set(direct)


def test_a_robot_goes_while_its_image_is_rendered(load):
    simulation = load(delay=0.1)
    simulation.step(2)
    simulation.delete("robot")
    simulation.step(20)
    assert simulation.context.failed == set()


def test_a_simulation_ends_or_restarts_while_images_are_rendered(load):
    simulation = load(delay=1.0)
    simulation.step(31)
    simulation.restart()
    heard = listen(simulation, ["color"])
    simulation.step(61)
    assert [time for _, time, _ in heard] == pytest.approx([1 / 60])
    simulation.close()


def test_capture_ends_with_the_last_image(load):
    simulation = load(delay=0.2, more="camera.properties(capturing=False)")
    camera = simulation.context.components["robot.color"]
    heard = listen(simulation, ["color"])
    outcomes = []
    camera.capture(outcomes.append, 3)
    simulation.step(14)
    assert len(heard) == 1
    assert outcomes == []
    simulation.step(30)
    assert outcomes == [("SUCCESS", None)]
    assert [time for _, time, _ in heard] == pytest.approx([1 / 60 + 0.05 * n for n in range(3)])
    assert not camera.capturing


def test_images_of_another_size_are_not_mixed(load):
    simulation = load(delay=0.1)
    camera = simulation.context.components["robot.cloud"]
    camera.output_functions.append(lambda one: sizes.append(len(one.local_data["points"])))
    sizes = []
    camera.set_property("keep_resolution", True)
    simulation.step(12)
    camera.set_property("cam_width", 64)
    simulation.step(20)
    assert set(sizes) == {32 * 24, 64 * 24}
    assert simulation.context.failed == set()


def test_an_error_of_an_image_deactivates_its_camera_only(load):
    simulation = load(delay=0.1)
    camera = simulation.context.components["robot.color"]
    camera.take = lambda picture: 1 / 0
    simulation.step(20)
    assert simulation.context.failed == {"robot.color"}
    assert simulation.robot.depth.data["image"].shape == (24, 32)


def test_a_camera_whose_images_depend_on_the_world_renders_at_once(tmp_path, monkeypatch):
    (tmp_path / "camera_of_a_test.py").write_text(
        "from morse.sensors.video_camera import VideoCamera\n"
        "class Own(VideoCamera):\n"
        "    _name = 'Own'\n"
        "    def take(self, picture):\n"
        "        super().take(picture)\n"
        "        self.height = self.bge_object.worldPosition[2]\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    scene = SCENE.replace('("color", VideoCamera)', '("color", Own)')
    scene = scene.replace("robot = Fake", "from camera_of_a_test import Own\nrobot = Fake")
    path = tmp_path / "scene.py"
    path.write_text(scene.format(delay=0.1, more="pass"))
    with morse.load(path) as simulation:
        simulation.step(20)
        camera = simulation.context.components["robot.color"]
        assert not camera.request.beside
        assert camera.height == pytest.approx(0.5)
        assert simulation.robot.color.data["image"].shape == (24, 32, 4)


def test_a_delay_that_needs_too_much_memory_is_refused(load, monkeypatch):
    monkeypatch.setattr("morse.core.clients.budgets.MOST_PIXELS", math.inf)  # the budget of clients refuses it earlier
    with pytest.raises(LoadError, match=r"scene\.py:\d+.*delay of 1e\+06 s.*shorten the delay"):
        load(delay=1e6)
    simulation = load(delay=5.0)
    camera = simulation.context.components["robot.color"]
    with pytest.raises(MorseRPCTypeError, match="GiB of memory"):
        camera.set_property("cam_width", 8192) or camera.set_property("cam_height", 2048)
    simulation.step(3)
    assert simulation.context.failed == set()
