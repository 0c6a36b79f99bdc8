"""GPS and magnetometers: positions by the geometry of WGS84, fields by published values."""

import math
import subprocess
import sys

import pytest

from morse.core.kinds import bind

SCRIPT = """
robot = FakeRobot()
robot.translate({x}, {y}, {z})
robot.rotate(0, 0, {yaw})
motion = MotionXYW()
motion.properties(ControlType="Position")
robot.append(motion)
{parts}
env = Environment("empty", fastmode=True)
{env}
"""
TOULOUSE = "env.properties(longitude=1.433333, latitude=43.6, altitude=135.0{})"
PLACE = TOULOUSE.format("")
EAST = 0.0
NORTH = math.pi / 2


def world(simulate, parts, *, env=PLACE, x=0.0, y=0.0, z=0.0, yaw=0.0, seconds=0.1):
    simulation = simulate(SCRIPT.format(parts=parts, env=env, x=x, y=y, z=z, yaw=yaw), sockets=False)
    simulation.sleep(seconds)
    return simulation


def gps(level):
    return f"gps = GPS()\ngps.level('{level}')\nrobot.append(gps)\n"


def radii(latitude):
    """Radii of curvature of the ellipsoid along the meridian and across it, m."""
    a, e2 = 6378137.0, 0.00669437999014
    w2 = 1.0 - e2 * math.sin(math.radians(latitude)) ** 2
    return a * (1.0 - e2) / w2**1.5, a / math.sqrt(w2)


def test_simple(simulate):
    simulation = world(simulate, "gps = GPS()\ngps.translate(x=1.0)\nrobot.append(gps)", x=10.0, y=8.0, z=20.0)
    data = simulation.context.component("robot.gps").local_data
    assert list(data) == ["timestamp", "x", "y", "z"]
    assert [data["x"], data["y"], data["z"]] == pytest.approx([11.0, 8.0, 20.0])
    message = bind(simulation.context.component("robot.gps"))[0].gather()
    assert (message.kind.name, message.frame) == ("pose", "world")


def test_raw(simulate):
    simulation = world(simulate, gps("raw"), x=10.0, y=8.0, z=20.0)
    data = simulation.context.component("robot.gps").local_data
    assert list(data) == ["timestamp", "longitude", "latitude", "altitude", "velocity"]
    meridian, across = radii(43.6)
    assert data["latitude"] == pytest.approx(43.6 + math.degrees(8.0 / (meridian + 155.0)), abs=1e-9)
    assert data["longitude"] == pytest.approx(
        1.433333 + math.degrees(10.0 / (across + 155.0) / math.cos(math.radians(43.6))), abs=1e-9
    )
    assert data["altitude"] == pytest.approx(155.0, abs=1e-4)


@pytest.mark.parametrize(
    ("turned", "velocity", "heading"), [(0.0, [2.0, 0.0, 0.0], 90.0), (math.pi / 2, [0.0, 2.0, 0.0], 0.0)]
)
def test_velocity_and_heading(simulate, turned, velocity, heading):
    env = TOULOUSE.format(f", angle_against_north={turned}")
    simulation = world(simulate, gps("extended"), env=env)
    simulation.context.component("robot.motion").local_data["x"] = 2.0
    simulation.sleep(0.5)
    data = simulation.context.component("robot.gps").local_data
    assert data["velocity"] == pytest.approx(velocity, abs=1e-9)
    assert data["heading"] == pytest.approx(heading, abs=1e-6)


def test_extended(simulate):
    simulation = world(simulate, gps("extended"), seconds=62.0)
    sensor = simulation.context.component("robot.gps")
    assert sensor.local_data["heading"] == math.inf
    assert (sensor.local_data["date"], sensor.local_data["time"]) == ("010170", "000102")
    fix = bind(sensor)[0].gather()
    assert (fix.utc, fix.course) == ("1970-01-01T00:01:02Z", math.inf)
    assert fix.altitude == pytest.approx(135.0)


@pytest.mark.parametrize("parts", [gps("raw"), "m = Magnetometer()\nrobot.append(m)\n"])
def test_a_world_that_is_nowhere(simulate, parts):
    with pytest.raises(Exception, match=r"longitude and latitude and altitude missing; use env.properties\(longitude"):
        world(simulate, parts, env="")


def magnetometer(setting="date=2015.0", turn=""):
    return f"m = Magnetometer()\nm.properties({setting})\n{turn}\nrobot.append(m)\n"


POLAR = "env.properties(longitude=0.0, latitude=80.0, altitude=0.0)"


@pytest.mark.parametrize(
    ("yaw", "data", "field"),
    [
        (EAST, (6627.1, -445.9, 54432.3), (-445.9, 6627.1, -54432.3)),
        (NORTH, (-445.9, -6627.1, 54432.3), (6627.1, 445.9, -54432.3)),
    ],
)
def test_published_magnetic_field(simulate, yaw, data, field):
    simulation = world(simulate, magnetometer(), env=POLAR, yaw=yaw)
    measured = simulation.context.component("robot.m").local_data
    # north, east and down as if they were the axes of the world
    assert (measured["x"], measured["y"], measured["z"]) == pytest.approx(data, abs=0.1)
    message = bind(simulation.context.component("robot.m"))[0].gather()
    # along the axes of the sensor
    assert message.field == pytest.approx([v * 1e-9 for v in field], abs=1e-10)
    assert message.frame == "own"


def test_the_covariance_of_a_noisy_magnetometer(simulate):
    simulation = world(simulate, magnetometer(turn="m.noise(gaussian=50.0)"), env=POLAR)
    covariance = bind(simulation.context.component("robot.m"))[0].gather().covariance
    assert [covariance[i][i] for i in range(3)] == pytest.approx([(50e-9) ** 2] * 3)


def test_a_magnetometer_on_its_side(simulate):
    data = (
        world(simulate, magnetometer(turn="m.rotate(y=math.pi / 2)"), env=POLAR).context.component("robot.m").local_data
    )
    # its X axis points along -Z
    assert (data["x"], data["y"], data["z"]) == pytest.approx((-54432.3, -445.9, 6627.1), abs=0.1)


def test_another_date_while_it_runs(simulate):
    simulation = world(simulate, magnetometer(), env=POLAR)
    simulation.context.component("robot.m").set_property("date", 2020.0)
    simulation.sleep(0.1)
    data = simulation.context.component("robot.m").local_data
    assert (data["x"], data["y"], data["z"]) == pytest.approx((6570.4, -146.3, 54606.0), abs=0.1)


def test_the_date_of_the_scene(simulate):
    """The clock of the scene begins at its date: of the field, of an IMU, and of GPS messages."""
    parts = (
        "m = Magnetometer()\nrobot.append(m)\nsame = Magnetometer()\nsame.properties(date=2026.5)\nrobot.append(same)\n"
        "imu = IMU()\nrobot.append(imu)\n" + gps("extended")
    )
    env = PLACE + "\nenv.set_start_date('2026-07-02T12:00:00')"
    simulation = world(simulate, parts, env=env)
    data = {name: simulation.context.component(f"robot.{name}").local_data for name in ("m", "same", "imu", "gps")}
    assert data["gps"]["date"] == "020726"
    field = [data["same"][axis] for axis in "xyz"]
    assert [data["m"][axis] for axis in "xyz"] == pytest.approx(field, abs=0.2)
    assert data["imu"]["magnetic_field"] == pytest.approx(field, abs=0.2)


@pytest.mark.parametrize("date", ["'yesterday'", "2026.9", "'2026-13-01'"])
def test_a_start_that_is_no_date(simulate, date):
    with pytest.raises(Exception, match=r"set_start_date\(date\) takes"):
        world(simulate, "", env=PLACE + f"\nenv.set_start_date({date})")


@pytest.mark.parametrize("date", [1999.0, 2040.0, "'today'"])
def test_a_date_without_a_model(simulate, date):
    with pytest.raises(Exception, match=r"'date' of Magnetometer is .*2010"):
        world(simulate, magnetometer(f"date={date}"), env=POLAR)


def test_an_imu_has_a_magnetometer_where_the_world_is_somewhere(simulate):
    simulation = world(simulate, "imu = IMU()\nrobot.append(imu)\n" + magnetometer("Model='auto'"), env=POLAR)
    imu, alone = simulation.context.component("robot.imu"), simulation.context.component("robot.m").local_data
    assert imu.local_data["magnetic_field"] == pytest.approx([alone["x"], alone["y"], alone["z"]])
    assert [message.kind.name for message in bind(imu)] == ["imu", "magnetic_field"]


def test_a_scene_without_magnetometer_does_not_wait_for_the_model():
    code = "import sys, morse.sensors.imu, morse.sensors.gps\nassert 'pygeomag' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
