"""Clouds of depth cameras, as pages receive them."""

from types import SimpleNamespace

import numpy as np
import pytest

import morse
from morse.viewer.feeds.sensors import ViewClouds
from morse.viewer.hub import Wishes

SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
robot.translate(1.0, 0.5, 1.0)
robot.rotate(z=0.3)
motion = MotionVW("motion")
robot.append(motion)
for name, make in (("eye", DepthCamera), ("turning", Velodyne), ("late", DepthCamera), ("color", VideoCamera),
                   ("laser", Sick)):
    sensor = make(name)
    if name != "laser":
        sensor.properties(cam_width=32, cam_height=24, cam_near=0.5, cam_far=30.0, cam_focal=20.0)
    sensor.frequency(20)
    robot.append(sensor)
    if name == "late":
        sensor.delay(0.2)
for name, place, half in (("Front", (6.1, 0, 0), (0.1, 20, 20)), ("Left", (0, 8.1, 0), (20, 0.1, 20)),
                          ("Back", (-6.1, 0, 0), (0.1, 20, 20)), ("Right", (0, -8.1, 0), (20, 0.1, 20))):
    wall = Cube(name)
    wall.location, wall.scale = place, half
    wall._bpy_object.game.physics_type = "STATIC"
env = Environment("empty")
"""


@pytest.fixture(scope="module")
def simulation(tmp_path_factory):
    path = tmp_path_factory.mktemp("clouds") / "scene.py"
    path.write_text(SCENE)
    with morse.load(path) as made:
        made.robot.motion.publish({"v": 1.0, "w": 0.8})
        yield made


@pytest.fixture
def feed(simulation):
    sent: list = []

    def make(*names):
        server = SimpleNamespace(wishes=Wishes(overlays=frozenset(f"robot.{name}" for name in names)), send=sent.append)
        made = ViewClouds(simulation.context, server)
        made.sent = sent
        return made

    return make


def points(message):
    return np.frombuffer(message.payload, np.float32).reshape(-1, 3)


def on_a_surface(cloud):
    x, y, z = np.abs(cloud).T
    return (abs(x - 6.0) < 0.01) | (abs(y - 8.0) < 0.01) | (z < 0.01)


@pytest.mark.parametrize("name", ["eye", "turning", "late"])
def test_points_are_on_the_walls_of_the_world(simulation, feed, name):
    made = feed(name)
    for _ in range(15):
        simulation.step()
        made.update()
    assert {message.component for message in made.sent} == {f"robot.{name}"}
    clouds = [points(message) for message in made.sent if len(message.payload)]
    assert len(clouds) >= 3
    for cloud in clouds:
        assert len(cloud) > 300
        assert on_a_surface(cloud).all()


def test_a_cloud_is_sent_once_and_only_if_it_is_shown(simulation, feed):
    made = feed("eye", "color", "laser", "nobody")
    simulation.step(6)
    made.update()
    made.update()
    assert [message.component for message in made.sent] == ["robot.eye"]
    none = feed()
    none.sent.clear()
    none.update()
    assert none.sent == []


def test_of_many_points_some_are_sent(simulation, feed):
    made = feed("eye")
    camera = simulation.context.components["robot.eye"]
    camera.local_data["points"] = np.ones((25_000, 3), np.float32)
    made.update()
    assert len(points(made.sent[0])) == 8334
    camera.local_data["points"] = np.array([[0, 0, 0], [np.nan, 0, 1], [0, 0, np.inf], [0, 0, 2]], np.float32)
    made.update()
    assert len(points(made.sent[1])) == 1
    simulation.step(6)
