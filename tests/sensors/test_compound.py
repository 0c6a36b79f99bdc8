"""Several sensors in one message."""

import math

import pytest
from messages import published

from morse.core.exceptions import MorseRPCTypeError
from morse.core.kinds import bind
from morse.wire.encoding import to_json

SCRIPT = """
robot = FakeRobot()
robot.translate(1.0, 2.0, 3.0)
pose = Pose()
robot.append(pose)
clock = Clock()
robot.append(clock)
both = CompoundSensor([pose, clock])
robot.append(both)
env = Environment("empty", fastmode=True)
"""


def test_the_data_of_its_members(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.5)
    data = simulation.context.component("robot.both").local_data
    assert list(data) == ["timestamp", "robot.pose", "robot.clock"]
    assert data["robot.pose"] == simulation.context.component("robot.pose").local_data
    assert data["robot.clock"] == {"timestamp": pytest.approx(0.5)}
    assert b'"robot.pose": {"timestamp": 0.5, "x": 1.0, "y": 2.0, "z": 3.0' in to_json(data)


def test_it_may_have_a_name_of_its_own(simulate):
    simulation = simulate(SCRIPT.replace("[pose, clock]", "[pose, clock], 'named'"), sockets=False)
    simulation.sleep(0.1)
    assert "robot.pose" in simulation.context.component("robot.named").local_data


@pytest.mark.parametrize("members", ["['pose']", "[None]"])
def test_a_member_that_is_none(simulate, members):
    with pytest.raises(Exception, match=r"CompoundSensor\(sensors\) takes a list of sensors"):
        simulate(SCRIPT.replace("[pose, clock]", members), sockets=False)


@pytest.mark.parametrize("names", ["robot.pose,robot.nobody", "robot.both"])
def test_names_of_no_other_sensor_are_refused_while_it_runs(simulate, names):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.1)
    with pytest.raises(MorseRPCTypeError, match="there is no other sensor 'robot"):
        simulation.context.component("robot.both").set_property("sensors", names)
    simulation.sleep(0.1)
    assert "robot.clock" in simulation.context.component("robot.both").local_data


def test_other_members_while_it_runs(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.1)
    simulation.context.component("robot.both").set_property("sensors", "robot.clock")
    simulation.sleep(0.1)
    assert list(simulation.context.component("robot.both").local_data) == ["timestamp", "robot.clock"]


def test_the_message_kinds_of_its_members(simulate):
    simulation = simulate(SCRIPT, sockets=False)
    simulation.sleep(0.5)
    messages = {one.topic: one.gather() for one in bind(simulation.context.component("robot.both"))}
    assert {topic: message.kind.name for topic, message in messages.items()} == {"pose": "pose", "clock": "clock"}
    assert messages["pose"].position == pytest.approx([1.0, 2.0, 3.0])
    assert messages["clock"].now == pytest.approx(0.5)


def test_members_of_the_same_name(simulate):
    more = "other = FakeRobot()\nother.pose = Pose()\nother.append(other.pose)\n"
    script = SCRIPT.replace("both = ", more + "both = ").replace("[pose, clock]", "[pose, other.pose]")
    simulation = simulate(script, sockets=False)
    simulation.sleep(0.1)
    assert [one.topic for one in bind(simulation.context.component("robot.both"))] == ["robot_pose", "other_pose"]


# -- angles of a pan-tilt unit after commands ------------------------------------------------------

PTU_POSTURE_SCRIPT = """
from morse.builder import *
robot = ATRV()
robot.rotate(0, 0, 0.7)
ptu = PTU()
ptu.translate(0.2, 0.0, 0.9)
robot.append(ptu)
{before}
posture = PTUPosture()
{carrier}.append(posture)
{more}
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def load(load):
    return lambda carrier="ptu", before="", more="": load(
        PTU_POSTURE_SCRIPT.format(carrier=carrier, before=before, more=more)
    )


def test_the_angles_that_it_was_told(load):
    simulation = load()
    simulation.robot.ptu.publish({"pan": 0.5, "tilt": -0.25})
    simulation.step(15)
    # a quarter of a second at 1 rad/s
    assert simulation.robot.ptu.posture.data["pan"] == pytest.approx(0.25, abs=0.02)
    simulation.step(60)
    posture = simulation.robot.ptu.posture.data
    assert (posture["pan"], posture["tilt"]) == pytest.approx((0.5, -0.25), abs=1e-6)
    message = bind(simulation.context.components["robot.ptu.posture"])[0].gather()
    assert message.names == ("pan", "tilt")
    assert message.position == pytest.approx([0.5, -0.25], abs=1e-6)


def test_angles_stay_within_half_a_turn(load):
    simulation = load()
    simulation.robot.ptu.publish({"pan": 3.0, "tilt": 0.0})
    simulation.step(200)
    simulation.robot.ptu.publish({"pan": 3.5, "tilt": 0.0})
    simulation.step(60)
    assert simulation.robot.ptu.posture.data["pan"] == pytest.approx(3.5 - 2 * math.pi, abs=1e-6)


def test_on_something_that_the_unit_carries(load):
    simulation = load("eye", before="eye = Pose()", more="ptu.append(eye)")
    simulation.robot.ptu.publish({"pan": 0.2, "tilt": 0.1})
    simulation.step(60)
    data = simulation.context.components["robot.ptu.eye.posture"].local_data
    assert (data["pan"], data["tilt"]) == pytest.approx((0.2, 0.1), abs=1e-6)


def test_without_a_unit(load):
    with pytest.raises(Exception, match="it measures a pan-tilt unit: append it to a pan-tilt unit"):
        load("robot")


# -- components that both read and publish: devices of a real robot in a hybrid simulation ---------

PARTS = """
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.core.external_object import ExternalActuator, ExternalObject, ExternalSensor
from morse.helpers.components import add_data

class Range(ExternalSensor):
    _name = "Range"
    add_data("x", 0.0, "float", "East", unit="m", frame="world")
    add_data("y", 0.0, "float", "North", unit="m", frame="world")
    add_data("z", 0.0, "float", "Up", unit="m", frame="world")
    add_data("twice", 0.0, "float", "Twice x", unit="m", follows="x")

    def report(self):
        self.local_data["twice"] = 2.0 * self.local_data["x"]

class Motor(ExternalActuator):
    _name = "Motor"
    add_data("v", 0.0, "float", "Speed", unit="m/s")

class RealRange(SensorCreator):
    _classpath = "external_devices.Range"

class RealMotor(ActuatorCreator):
    _classpath = "external_devices.Motor"
"""

SCENE = """
from external_devices import RealMotor, RealRange
robot = FakeRobot()
sensor = RealRange()
sensor.alter(classpath="morse.modifiers.feet.FeetToMeter", direction="IN")
{more}
robot.append(sensor)
motor = RealMotor()
robot.append(motor)
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def scene(simulate, tmp_path, monkeypatch):
    (tmp_path / "external_devices.py").write_text(PARTS)
    monkeypatch.syspath_prepend(str(tmp_path))
    return lambda more="": simulate(SCENE.format(more=more), sockets=False)


def arrive(component, **fields):
    """Data that a device has sent."""
    waiting = [fields]

    def read(target):
        if not waiting:
            return False
        target.local_data.update(waiting.pop())
        return True

    component.input_functions.append(read)


def test_data_that_arrive_are_published_with_the_time_of_the_simulation(scene):
    simulation = scene()
    sensor = simulation.context.component("robot.sensor")
    messages = published(sensor)
    arrive(sensor, x=3.0, y=0.0, z=0.0)
    simulation.sleep(3 / 60)
    # the modifier of the input divides once, when the data arrive
    assert [message["x"] for message in messages] == [pytest.approx(3.0 / 3.2808399)] * 3
    assert messages[-1]["twice"] == 2.0 * messages[-1]["x"]
    assert messages[-1]["timestamp"] == simulation.time()


def test_a_modifier_without_a_direction_changes_what_a_sensor_publishes(scene):
    simulation = scene(
        'sensor.alter(classpath="morse.modifiers.utm.CoordinatesToUTM", x_offset=100.0, y_offset=0.0, z_offset=0.0)'
    )
    sensor = simulation.context.component("robot.sensor")
    assert len(sensor.input_modifiers) == len(sensor.output_modifiers) == 1


def test_noise_of_the_script_changes_each_measurement(scene):
    simulation = scene('sensor.noise(0.1, field="y")')
    sensor = simulation.context.component("robot.sensor")
    messages = published(sensor)
    arrive(sensor, x=0.0, y=5.0 * 3.2808399, z=0.0)
    simulation.sleep(0.5)
    values = [message["y"] for message in messages]
    assert len(set(values)) == len(values) == 30
    assert sum(values) / len(values) == pytest.approx(5.0, abs=0.1)


def test_an_actuator_publishes_its_commands(scene):
    simulation = scene()
    motor = simulation.context.component("robot.motor")
    messages = published(motor)
    arrive(motor, v=2.5)
    simulation.sleep(2 / 60)
    assert messages == [{"v": 2.5}] * 2


def test_an_inactive_device_is_silent(scene):
    simulation = scene()
    motor = simulation.context.component("robot.motor")
    messages = published(motor)
    motor.active = False
    simulation.sleep(2 / 60)
    assert messages == []
