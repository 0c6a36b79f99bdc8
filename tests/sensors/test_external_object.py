"""Components that both read and publish: devices of a real robot in a hybrid simulation."""

import pytest
from messages import published

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
