"""A sensor measures, noise is added, and dependent fields are computed from the noisy values."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from messages import published

from morse.core.declarations.fields import DataField
from morse.core.realism import Noise, generator_state, measured, set_generator_state
from morse.mathutils import Quaternion
from morse.scene.component import NoiseModel

PARTS = """
import math
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.core.actuator import Actuator
from morse.core.sensor import Sensor
from morse.helpers.components import add_data

class Thermometer(Sensor):
    add_data("celsius", 0.0, "float", "", unit="°C", low=-1.0, high=50.0)
    add_data("fahrenheit", 0.0, "float", "", unit="°F", follows="celsius")
    def measure(self):
        self.local_data["celsius"] = 20.0
    def report(self):
        self.local_data["fahrenheit"] = self.local_data["celsius"] * 1.8 + 32.0

class Eyes(Sensor):
    add_data("left", 0.0, "float", "")
    add_data("right", 0.0, "float", "")
    def __init__(self, obj, parent=None):
        super().__init__(obj, parent)
        self.left = self.add_rays([[0, 1, 0]], 50.0)
        self.right = self.add_rays([[0, -1, 0], [1, -1, 0]], 50.0)
    def default_action(self):
        self.local_data["left"] = float(self.left.distances[0])
        self.local_data["right"] = float(self.right.distances[0])

class Shy(Actuator):
    "Stands still before a wall."
    add_data("seen", math.inf, "float", "", unit="m", allow=("inf",))
    def __init__(self, obj, parent=None):
        super().__init__(obj, parent)
        self.add_rays([[1, 0, 0]], 50.0)
    def default_action(self):
        self.local_data["seen"] = float(self.rays.distances[0])
        self.robot_parent.apply_speed("Velocity", [1.0 if self.rays.distances[0] > 2.0 else 0.0, 0, 0], [0, 0, 0])

class ThermometerB(SensorCreator):
    _classpath = "measuring_parts.Thermometer"
class EyesB(SensorCreator):
    _classpath = "measuring_parts.Eyes"
class ShyB(ActuatorCreator):
    _classpath = "measuring_parts.Shy"
"""
SCRIPT = """
from measuring_parts import *
robot = FakeRobot()
robot.translate(z=1.0)
thermometer = ThermometerB()
{setting}
robot.append(thermometer)
eyes = EyesB()
robot.append(eyes)
shy = ShyB()
robot.append(shy)
PLACES = [("North", (0, 5, 0)), ("South", (0, -3, 0)), ("East", (8, 0, 0))]
for name, place in PLACES:
    wall = Cube(name)
    wall.location = place
    wall.scale = (0.5, 20, 5) if name == "East" else (20, 0.5, 5)
    wall._bpy_object.game.physics_type = "STATIC"
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def simulate_parts(simulate, tmp_path, monkeypatch):
    (tmp_path / "measuring_parts.py").write_text(PARTS, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    return lambda setting="", **options: simulate(SCRIPT.format(setting=setting), **options, sockets=False)


def test_derived_fields_follow_the_noise(simulate_parts):
    simulation = simulate_parts("thermometer.noise(gaussian=0.5)")
    seen = published(simulation.context.component("robot.thermometer"))
    simulation.sleep(2.0)
    celsius = np.array([m["celsius"] for m in seen])
    assert celsius.std() == pytest.approx(0.5, rel=0.3)
    assert [m["fahrenheit"] for m in seen] == pytest.approx(celsius * 1.8 + 32.0)


def test_derived_fields_follow_without_noise_too(simulate_parts):
    simulation = simulate_parts()
    simulation.sleep(0.1)
    assert simulation.context.component("robot.thermometer").local_data["fahrenheit"] == pytest.approx(68.0)


def test_noise_stays_in_the_declared_range(simulate_parts):
    simulation = simulate_parts("thermometer.noise(gaussian=40.0)")
    seen = published(simulation.context.component("robot.thermometer"))
    simulation.sleep(2.0)
    values = [m["celsius"] for m in seen]
    assert min(values) == -1.0
    assert max(values) == 50.0


def test_a_sensor_looks_along_several_bundles_of_rays(simulate_parts):
    simulation = simulate_parts()
    simulation.sleep(0.1)
    eyes = simulation.context.component("robot.eyes")
    assert eyes.local_data["left"] == pytest.approx(4.5, abs=1e-3)
    assert eyes.local_data["right"] == pytest.approx(2.5, abs=1e-3)
    assert eyes.rays is eyes.left
    assert eyes.requests == [eyes.left, eyes.right]


def test_actuators_look_along_rays_before_they_act(simulate_parts):
    simulation = simulate_parts()
    simulation.sleep(1 / 60)
    assert simulation.context.component("robot.shy").local_data["seen"] == pytest.approx(7.5, abs=1e-3)
    casts = []
    rays = simulation.world.rays
    cast = rays.cast
    rays.cast = lambda bundles: casts.append(len(bundles)) or cast(bundles)
    simulation.sleep(10.0)
    assert simulation.context.component("robot.shy").local_data["seen"] == pytest.approx(2.0, abs=0.05)
    # of all components that are due, in one call: actuators before the physics, sensors after it
    assert set(casts) == {1, 2}


def noise(field, seed=1, **model):
    return Noise(NoiseModel(**model), np.random.Generator(np.random.PCG64(seed)), field)


@given(st.floats(-math.pi, math.pi), st.integers(0, 2**32))
def test_angles_stay_within_half_a_turn(angle, seed):
    field = DataField(0.0, unit="rad", angle=True)
    value = measured(angle, noise(field, seed, gaussian=2.0))
    assert -math.pi < value <= math.pi
    free = measured(angle, noise(None, seed, gaussian=2.0))
    assert math.isclose(math.cos(value), math.cos(free), abs_tol=1e-9)
    assert math.isclose(math.sin(value), math.sin(free), abs_tol=1e-9)


def test_the_ends_of_half_a_turn_are_one():
    field = DataField(0.0, unit="deg", angle=True)
    assert noise(field).possible(np.array([180.0, -180.0, 190.0, 540.0])).tolist() == [180.0, 180.0, -170.0, 180.0]


@given(st.integers(0, 2**32))
def test_quaternions_keep_their_length(seed):
    field = DataField([1.0, 0.0, 0.0, 0.0], shape=(4,), quaternion=True)
    value = measured(Quaternion((1.0, 0.0, 0.0, 0.0)), noise(field, seed, gaussian=0.3))
    assert type(value) is Quaternion
    assert math.hypot(*value) == pytest.approx(1.0)


def test_what_is_infinitely_far_stays_so():
    field = DataField(0.0, unit="m", low=0.0, high=5.0, allow=("inf",))
    assert measured(math.inf, noise(field, gaussian=1.0)) == math.inf


def test_generators_go_on_from_a_state():
    generator = np.random.Generator(np.random.PCG64(3))
    generator.integers(0, 10, dtype=np.int32)  # leaves half of a draw in the generator
    state = generator_state(generator)
    expected = [generator.integers(0, 1000, dtype=np.int32) for _ in range(5)] + generator.normal(size=3).tolist()
    other = np.random.Generator(np.random.PCG64(4))
    set_generator_state(other, state)
    assert [other.integers(0, 1000, dtype=np.int32) for _ in range(5)] + other.normal(size=3).tolist() == expected


def test_noise_and_delay_go_on_from_a_state(simulate_parts):
    setting = "thermometer.noise(gaussian=1.0, bias_walk=0.5, dropout=0.1); thermometer.delay(0.2)"
    simulation = simulate_parts(setting, seed=3)
    sensor = simulation.context.component("robot.thermometer")
    simulation.sleep(1.0)
    state, shown = sensor.realism.get_state(), dict(sensor.local_data)
    times = [time - simulation.time() for time, _ in state["waiting"]]
    assert len(times) == 12
    first = published(sensor)
    simulation.sleep(1.0)
    sensor.output_functions.clear()
    # the same again, one second later
    state["waiting"] = [[time + 1.0, data] for time, data in state["waiting"]]
    state["last"] += 1.0
    sensor.realism.set_state(state)
    sensor.local_data.update(shown)
    second = published(sensor)
    simulation.sleep(1.0)
    assert len(first) == len(second) == 60
    assert [m["celsius"] for m in second] == pytest.approx([m["celsius"] for m in first], rel=1e-12)
