"""The message kinds of sensors and actuators at rest."""

import math
from pathlib import Path

import numpy as np
import pytest

import morse
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


# -- messages of joints that the physics moves have velocities and efforts; commands match the control of the motor

ROBOT = """<robot name="post"><link name="world"/><link name="flag"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="wave" type="continuous"><parent link="world"/><child link="flag"/><axis xyz="0 0 1"/></joint></robot>"""
SCENE = """
from morse.builder import *
post = Robot({file!r})
mast = Armature(armature_name='post_joints')
mast.control({control!r})
post.append(mast)
state = ArmaturePose()
mast.append(state)
env = Environment('empty')
"""


@pytest.mark.parametrize("control", ["position", "velocity", "effort"])
def test_the_slots_of_joints(tmp_path: Path, control: str) -> None:
    file, script = tmp_path / "post.urdf", tmp_path / "scene.py"
    file.write_text(ROBOT)
    script.write_text(SCENE.format(file=str(file), control=control))
    with morse.load(script) as sim:
        sim.post.mast.publish({"wave": 0.5})
        sim.step(60)
        (command,) = [one for one in bind(sim.context.component("post.mast")) if one.kind.name == "joints"]
        assert {slot for slot in ("position", "velocity", "effort") if command.has(slot)} == {control}
        assert command.scatter({control: [0.7]}) == ({"wave": 0.7}, None)
        (measured,) = bind(sim.context.component("post.mast.state"))
        message = measured.gather()
        assert list(message.names) == ["wave"]
        if control == "effort":
            # 0.5 N m turn 1 kg at 0.5 m, and its own 0.01 kg m^2
            assert message.effort[0] == pytest.approx(0.5)
            assert message.velocity[0] == pytest.approx(0.5 / 0.26, rel=1e-3)
        elif control == "velocity":
            assert message.velocity[0] == pytest.approx(0.5, rel=1e-3)
            assert message.position[0] == pytest.approx(0.5, rel=0.05)
        else:
            assert message.position[0] == pytest.approx(0.5, abs=2e-3)


# -- forces on feet and in joints: weights, whatever the engine does with bodies at rest -----------

GRAVITY, MASS = 9.81, 12.0
WALKER = Path(morse.__file__).parent / "data" / "examples" / "legs" / "walker.urdf"
FEET = ("front_left", "front_right", "rear_left", "rear_right")
FORCE_SENSORS_SCENE = f"""
walker = Robot(r"{WALKER}")
walker.translate(z=0.5)
for leg in {FEET}:
    walker.append(ContactForce(leg), leg + "_shin")
walker.append(ContactForce("total"))
walker.append(ForceTorqueSensor("hip"), "front_left_thigh")
load = Cube("load")
load.scale = (0.05, 0.05, 0.05)
load.translate(0.0, 0.0, 0.65)
load._bpy_object.game.physics_type = "RIGID_BODY"
load._bpy_object.game.mass = 2.0
"""


def test_the_forces_on_the_feet_are_the_weight(simulate):
    sim = simulate(FORCE_SENSORS_SCENE, sockets=False)
    for seconds in (2, 10):  # later on, the bodies at rest sleep
        sim.step(60 * seconds)
        feet = {leg: getattr(sim.walker, leg).get() for leg in FEET}
        forces = [foot["force"] for foot in feet.values()]
        assert [sum(axis) for axis in zip(*forces, strict=True)] == pytest.approx(
            [0.0, 0.0, (MASS + 2.0) * GRAVITY], abs=0.01
        )
        assert all(foot["touching"] and foot["objects"].endswith("Ground") for foot in feet.values())
        # the floor below, and the load above
        assert sim.walker.total.get()["force"][2] == pytest.approx(MASS * GRAVITY, rel=1e-3)
        assert "load" in sim.walker.total.get()["objects"]
        # thigh and shin hang in the hip and are carried by the foot: what the leg does to the trunk
        hip = sim.walker.hip.get()["force"]
        assert sum(value**2 for value in hip) ** 0.5 == pytest.approx(forces[0][2] - 1.0 * GRAVITY, abs=0.02)


def test_nothing_presses_on_feet_in_the_air(simulate):
    sim = simulate(FORCE_SENSORS_SCENE.replace("z=0.5", "z=3.0").replace("0.65)", "9.0)"), sockets=False)
    sim.step(12)
    assert [getattr(sim.walker, leg).get()["force"] for leg in FEET] == [[0.0, 0.0, 0.0]] * 4
    assert not sim.walker.total.get()["touching"]
    # all parts fall together
    assert sim.walker.hip.get()["force"] == pytest.approx([0.0, 0.0, 0.0], abs=1.0)


def test_forces_are_measured_after_an_object_was_added(simulate):
    sim = simulate(FORCE_SENSORS_SCENE, sockets=False)
    sim.step(120)
    sim.spawn("other", "ATRV", position=[5.0, 0.0, 0.1])
    sim.step(120)
    assert sum(getattr(sim.walker, leg).get()["force"][2] for leg in FEET) == pytest.approx(14.0 * GRAVITY, rel=1e-3)


def test_a_sensor_of_torques_without_a_joint_says_so(simulate, caplog):
    sim = simulate("robot = FakeRobot()\nrobot.append(ForceTorqueSensor('load'))", sockets=False)
    sim.step(2)
    assert "robot.load: no joint of the physics carries it, and it measures 0" in caplog.text
    assert sim.robot.load.get()["force"] == [0.0, 0.0, 0.0]
