"""Rules for every sensor beyond the contract: its rate, and rays that depend on properties."""

import json

import pytest

import morse
from morse.wire.encoding import to_json

pytestmark = pytest.mark.long

#: on their own robot: all except sensors with arguments, and cameras
SENSORS = (
    "Accelerometer", "ADIS16448", "Airspeed", "Attitude", "Barometer", "Battery", "BMI088", "Bumper", "Clock",
    "Collision", "GPS", "Gyroscope", "IMU", "Magnetometer", "Odometry", "Pose", "Proximity", "RadarAltimeter",
    "RangeFinder", "SearchAndRescue", "Sick", "Thermometer", "UltrasonicRangeFinder", "Velocity", "VelodyneRayCast",
    "WheelEncoders",
)  # fmt: skip
SCRIPT = """
from morse.builder import *
robot = Pioneer3DX()
motion = MotionVWDiff()
robot.append(motion)
sensor = {name}()
sensor.translate(0.1, 0.05, 0.5)
{setting}
robot.append(sensor)
wall = Cube("Wall")
wall.location = (4.0, 0, 1.0)
wall.properties(Fire=True, Robot_Tag=True, Injured=True)
wall._bpy_object.game.physics_type = "STATIC"
env = Environment("empty", fastmode=True)
env.properties(longitude=1.43, latitude=43.6, altitude=135.0)
"""
LEVELS = {"GPS": ("simple", "raw", "extended"), "Odometry": ("raw", "differential", "integrated")}
CASES = [(name, level) for name in SENSORS for level in LEVELS.get(name, ("",))]


@pytest.fixture(params=CASES, ids=lambda case: "-".join(filter(None, case)))
def make(request, load):
    name, level = request.param
    setting = f"sensor.level('{level}')" if level else ""
    return lambda seed=1: load(SCRIPT.format(name=name, setting=setting), seed=seed)


def drive(simulation, ticks=90):
    """The published messages: JSON, one per measurement."""
    said = []
    simulation.context.components["robot.sensor"].output_functions.append(
        lambda sensor: said.append(to_json(sensor.local_data))
    )
    simulation.robot.motion.publish({"v": 0.4, "w": 0.3})
    simulation.step(ticks)
    return said


def test_it_publishes_at_its_rate(make):
    simulation = make()
    said = drive(simulation)
    component = simulation.context.components["robot.sensor"]
    if type(component).__name__ != "Collision":  # which publishes only during a contact
        assert len(said) == pytest.approx(1.5 * component.frequency, abs=1)
    for line in said:
        assert next(iter(json.loads(line))) == "timestamp"


@pytest.mark.parametrize(
    ("name", "range_property"), [("RangeFinder", "range"), ("RadarAltimeter", "MaxRange"), ("Sick", "laser_range")]
)
def test_rays_of_before_a_property_was_changed(tmp_path, name, range_property):
    path = tmp_path / "scene.py"
    path.write_text(SCRIPT.format(name=name, setting=""))
    with morse.load(path) as simulation:
        sensor = simulation.context.components["robot.sensor"]
        sensor.set_property(range_property, 0.2)
        simulation.step(30)
        state, near = simulation.save(), to_json(simulation.robot.sensor.data)
        sensor.set_property(range_property, 20.0)
        simulation.step(30)
        far = to_json(simulation.robot.sensor.data)
        simulation.restore(state)
        simulation.step(30)
        again = to_json(simulation.robot.sensor.data)
    without_time = [line.partition(b",")[2] for line in (near, far, again)]
    assert without_time[0] == without_time[2] != without_time[1]
