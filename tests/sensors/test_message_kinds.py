"""The message kinds of sensors and actuators at rest."""

import math

import numpy as np
import pytest

from morse.core.kinds import bind
from morse.core.validation import Commands

SCRIPT = """
robot = FakeRobot()
robot.translate(1.0, 2.0, 3.0)
robot.rotate(z=math.pi / 2)
{parts}
wall = Cube("Wall")
wall.scale = (0.1, 40, 20)
wall.location = (6.1, 0, 0)
wall._bpy_object.game.physics_type = "STATIC"
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def component(simulate):
    def make(parts, name, seconds=0.2):
        simulation = simulate(SCRIPT.format(parts=parts), sockets=False)
        simulation.sleep(seconds)
        return simulation.context.component(name)

    return make


def laser(kind, setting=""):
    return f"laser = {kind}()\n{setting}\nlaser.rotate(z=-math.pi / 2)\nrobot.append(laser)"


def test_a_flat_scan(component):
    sick = component(laser("Sick"), "robot.laser")
    (scan,) = bind(sick)
    message = scan.gather()
    assert message.kind.name == "scan"
    assert message.ranges.dtype == np.float32
    assert len(message.ranges) == 181
    assert message.angle_min == pytest.approx(-math.pi / 2)
    assert message.angle_increment == pytest.approx(math.radians(1.0))
    assert (message.range_min, message.range_max) == (0.0, 30.0)
    # index 0 points to the right, along the wall: no hit
    assert message.ranges[0] == np.inf
    for degrees in (0, 30, -30):
        assert message.ranges[90 + degrees] == pytest.approx(5.0 / math.cos(math.radians(degrees)), abs=1e-4)
    assert message.intensities is None
    (_, cloud) = bind(sick, on_request=True)
    points = cloud.gather().points
    assert cloud.topic == "points"
    assert len(points) == np.isfinite(message.ranges).sum()
    assert points[:, 0] == pytest.approx(5.0, abs=1e-4)


def test_a_whole_turn_has_no_ray_twice(component):
    scanner = component(laser("Sick", "laser.properties(scan_window=360.0)"), "robot.laser")
    assert len(scanner.local_data["range_list"]) == 361
    assert len(bind(scanner)[0].gather().ranges) == 360


def test_several_layers_are_a_cloud(component):
    scanner = component(laser("SickLDMRS", "laser.level('rssi')"), "robot.laser", 0.5)
    (cloud,) = bind(scanner)
    message = cloud.gather()
    assert cloud.kind.name == "cloud"
    assert message.points.shape == (len(message.ring), 3)
    assert len(message.intensity) == len(message.ring)
    assert message.ring.dtype == np.uint16
    assert sorted(set(message.ring.tolist())) == [0, 1, 2, 3]
    heights = [np.degrees(np.arctan2(p[2], np.hypot(p[0], p[1]))) for p in message.points]
    for layer, expected in enumerate([1.2, 0.4, -0.4, -1.2]):
        own = [h for h, ring in zip(heights, message.ring, strict=True) if ring == layer]
        assert own == pytest.approx([expected] * len(own), abs=1e-3)


def test_a_turning_scanner_is_a_cloud(component):
    assert [b.kind.name for b in bind(component(laser("VelodyneRayCast"), "robot.laser"))] == ["cloud"]


def test_distances_alone_are_a_range_and_a_scan(component):
    scanner = component(laser("Infrared", "laser.level('range'); laser.properties(laser_range=8.0)"), "robot.laser")
    distance, scan = bind(scanner)
    assert distance.gather().distance == pytest.approx(5.0, abs=1e-4)
    assert distance.gather().fov == pytest.approx(math.radians(20.0))
    assert (scan.kind.name, scan.topic) == ("scan", "scan")


def test_pose_and_altimeter(component):
    pose = component("pose = Pose()\npose.translate(x=1.0)\nrobot.append(pose)", "robot.pose")
    message = bind(pose)[0].gather()
    assert message.frame == "world"
    assert message.position == pytest.approx([1.0, 3.0, 3.0], abs=1e-6)
    assert message.orientation == pytest.approx([math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)], abs=1e-6)
    radar = component("radar = RadarAltimeter()\nrobot.append(radar)", "robot.radar")
    message = bind(radar)[0].gather()
    assert (message.radiation, message.max) == ("radar", 30.0)
    assert message.distance == pytest.approx(3.0, abs=1e-3)


def test_odometry_gives_the_rates_of_the_body(component):
    odometry = component("odometry = Odometry()\nrobot.append(odometry)", "robot.odometry")
    odometry.local_data.update(roll=0.3, pitch=-0.4, wx=0.1, wy=0.2, wz=0.5)
    (bound,) = bind(odometry)
    message = bound.gather()
    assert message.frame == "start"
    # the same from rotation matrices at two close times: [w] = R^T dR/dt
    from morse.mathutils import Euler

    step = 1e-6
    before = np.array(Euler([0.3, -0.4, 0.0]).to_matrix())
    after = np.array(Euler([0.3 + 0.1 * step, -0.4 + 0.2 * step, 0.5 * step]).to_matrix())
    skew = before.T @ (after - before) / step
    assert message.angular == pytest.approx([skew[2, 1], skew[0, 2], skew[1, 0]], abs=1e-5)


def test_commands_by_kind_drive_a_robot(simulate):
    simulation = simulate(SCRIPT.format(parts="motion = MotionVW()\nrobot.append(motion)"), sockets=False)
    motion = simulation.context.component("robot.motion")
    (twist,) = bind(motion)
    fields, remark = twist.scatter({"linear": [1.0, 0.0, 0.0], "angular": [0.0, 0.0, 0.0]})
    assert remark is None
    Commands(motion).take(fields)
    simulation.sleep(1.0)
    assert simulation.context.component("robot").position_3d.y == pytest.approx(3.0, abs=0.05)


def test_what_does_not_fit_names_the_component_and_its_line(simulate, tmp_path, monkeypatch):
    (tmp_path / "wrong_kind.py").write_text(
        "from morse.core.sensor import Sensor\n"
        "from morse.builder.creator import SensorCreator\n"
        "from morse.helpers.components import add_data, add_kind\n"
        "class Boiler(Sensor):\n"
        "    add_data('heat', 0.0, 'float', '', unit='W')\n"
        "    add_kind('temperature', temperature='heat')\n"
        "class BoilerB(SensorCreator):\n"
        "    _classpath = 'wrong_kind.Boiler'\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(Exception, match="it takes °C; field 'heat' has W; known: K, degC, °F") as caught:
        simulate(
            SCRIPT.format(parts="from wrong_kind import *\nboiler = BoilerB()\nrobot.append(boiler)"), sockets=False
        )
    assert "robot.boiler" in str(caught.value)
    assert "scene0.py:" in str(caught.value)
