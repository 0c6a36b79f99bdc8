"""Pressure, temperature, charge and time."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from morse.core.kinds import bind
from morse.viewer.feeds.sensors import ViewRays

SCRIPT = """
robot = FakeRobot()
robot.translate({x}, 0, 0)
motion = MotionXYW()
motion.properties(ControlType="Position")
robot.append(motion)
teleport = Teleport()
robot.append(teleport)
{parts}
env = Environment("empty", fastmode=True)
env.set_gravity(9.80665)
{env}
"""


def world(simulate, parts, env="", x=0.0):
    simulation = simulate(SCRIPT.format(parts=parts, env=env, x=x), sockets=False)
    simulation.context.component("robot.teleport").active = False
    return simulation


def at_height(simulate, height, setting=""):
    simulation = world(simulate, f"barometer = Barometer()\n{setting}\nrobot.append(barometer)\n")
    teleport = simulation.context.component("robot.teleport")
    teleport.active = True
    teleport.local_data["z"] = height
    simulation.sleep(0.1)
    return simulation.context.component("robot.barometer")


@pytest.mark.parametrize(
    # ISO 2533, table 5: pressure by geopotential height
    ("height", "pressure"),
    [(0.0, 101325.0), (1000.0, 89874.6), (2000.0, 79495.2), (5000.0, 54019.9), (11000.0, 22632.1)],
)
def test_the_standard_atmosphere(simulate, height, pressure):
    barometer = at_height(simulate, height)
    # the standard has another gas constant, 8.31432
    assert barometer.local_data["pressure"] == pytest.approx(pressure, rel=5e-5)
    assert bind(barometer)[0].gather().absolute == pytest.approx(pressure, rel=5e-5)


@pytest.mark.parametrize(("altitude", "pressure"), [(0.0, 101325.0), (1000.0, 89874.6), (2000.0, 79495.2)])
def test_the_altitude_of_the_world(simulate, altitude, pressure):
    place = f"env.properties(longitude=1.4, latitude=43.6, altitude={altitude - 100.0})"
    simulation = world(
        simulate, "robot.translate(z=100)\nbarometer = Barometer()\nrobot.append(barometer)\n", env=place
    )
    simulation.sleep(0.1)
    barometer = simulation.context.component("robot.barometer")
    assert barometer.local_data["pressure"] == pytest.approx(pressure, rel=5e-5)


def test_another_pressure_at_the_start(simulate):
    barometer = at_height(simulate, 1000.0, "barometer.properties(ReferencePressure=100000.0)")
    assert barometer.local_data["pressure"] == pytest.approx(89874.6 * 100000.0 / 101325.0, rel=2e-5)


def test_no_air_above_the_atmosphere_of_the_formula(simulate):
    assert at_height(simulate, 50e3).local_data["pressure"] == 0.0


def test_dynamic_pressure(simulate):
    parts = (
        "pitot = Airspeed()\nrobot.append(pitot)\naside = Airspeed()\naside.rotate(z=math.pi / 3)\nrobot.append(aside)"
    )
    simulation = world(simulate, parts)
    simulation.context.component("robot.motion").local_data["x"] = 20.0
    simulation.sleep(0.2)
    # 1/2 rho v^2 in air of 1.225 kg/m^3
    assert simulation.context.component("robot.pitot").local_data["diff_pressure"] == pytest.approx(245.0, rel=1e-6)
    assert simulation.context.component("robot.aside").local_data["diff_pressure"] == pytest.approx(
        245.0 / 4.0, rel=1e-6
    )
    assert bind(simulation.context.component("robot.pitot"))[0].gather().differential == pytest.approx(245.0)


FIRES = """
hot = Cube("Hot")
hot.location = (0, 5, 0)
hot.properties(Fire=True)
hotter = Cube("Hotter")
hotter.location = (0, 0, 10)
hotter.properties(Fire=500.0)
thermometer = Thermometer()
{}
robot.append(thermometer)
"""


@pytest.mark.parametrize(
    ("setting", "env", "expected"),
    [
        ("", "", 15.0 + 200.0 * math.exp(-1.0) + 500.0 * math.exp(-2.0)),
        ("", "env.properties(Temperature=-5.0)", -5.0 + 200.0 * math.exp(-1.0) + 500.0 * math.exp(-2.0)),
        ("Range=7.0, DefaultTemperature=20.0", "env.properties(Temperature=-5.0)", 20.0 + 200.0 * math.exp(-1.0)),
        ("Alpha=0.0, FireTemperature=100.0", "", 615.0),
        ("FireTag='Ice'", "", 15.0),
    ],
)
def test_fires(simulate, setting, env, expected):
    parts = FIRES.format(f"thermometer.properties({setting})" if setting else "")
    simulation = world(simulate, parts, env)
    simulation.sleep(0.1)
    thermometer = simulation.context.component("robot.thermometer")
    assert thermometer.local_data["temperature"] == pytest.approx(expected)
    assert bind(thermometer)[0].gather().temperature == pytest.approx(expected)


BATTERY = """
inside = Zone("Charging")
inside.size = [2.0, 2.0, 2.0]
battery = Battery()
battery.properties(DischargingRate=4.0)
{}
robot.append(battery)
"""


def test_a_battery_discharges_and_is_charged_in_a_zone(simulate):
    simulation = world(simulate, BATTERY.format(""), x=10.0)
    battery = simulation.context.component("robot.battery")
    assert (battery.local_data["charge"], battery.local_data["status"]) == (100.0, "Charged")
    simulation.sleep(5.0)
    assert battery.local_data["charge"] == pytest.approx(80.0)
    assert battery.local_data["status"] == "Discharging"
    assert bind(battery)[0].gather().charge == pytest.approx(0.8)
    simulation.context.component("robot.motion").local_data["x"] = -600.0
    simulation.sleep(1.0 / 60.0)
    simulation.context.component("robot.motion").local_data["x"] = 0.0
    simulation.sleep(2.0)
    assert battery.local_data["charge"] == pytest.approx(88.0, abs=0.2)
    assert battery.local_data["status"] == "Charging"
    simulation.sleep(4.0)
    assert (battery.local_data["charge"], battery.local_data["status"]) == (100.0, "Charged")
    assert bind(battery)[0].gather().status == "full"


def test_an_empty_battery_stays_empty(simulate):
    simulation = world(simulate, BATTERY.format("battery.frequency(10)"), x=10.0)
    simulation.sleep(30.0)
    battery = simulation.context.component("robot.battery")
    assert (battery.local_data["charge"], battery.local_data["status"]) == (0.0, "Discharging")


def test_a_clock(simulate):
    simulation = world(simulate, "clock = Clock()\nrobot.append(clock)\n")
    simulation.sleep(1.5)
    assert simulation.context.component("robot.clock").local_data == {"timestamp": pytest.approx(1.5)}
    assert bind(simulation.context.component("robot.clock"))[0].gather().now == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("growth", "factor"), [("0.1", 1.2), ("-0.1", 0.8), ("-9.0", 0.0), ("'fast'", 1.0), ("0", 1.0)]
)
def test_a_fire_that_grows(simulate, growth, factor):
    simulation = simulate(
        f"""
robot = FakeRobot()
thermometer = Thermometer()
robot.append(thermometer)
fire = Cube("fire")
fire.properties(Fire=True, Fire_Growth={growth})
fire.translate(x=5.0)
""",
        sockets=False,
    )
    simulation.sleep(2.0)
    heat = simulation.context.component("robot.thermometer").local_data["temperature"] - 15.0
    assert heat == pytest.approx(factor * 200.0 * math.exp(-1.0))


# -- rays of sensors, as sent to pages -------------------------------------------------------------

RAYS_IN_THE_VIEW_SCRIPT = """
wall = Cube("Wall")
wall.scale = (0.1, 40, 40)
wall.location = (4.1, 0, 0)
wall._bpy_object.game.physics_type = "STATIC"
robot = FakeRobot()
plain = Sick()
robot.append(plain)
arc = Infrared()
robot.append(arc)
fine = Hokuyo()
fine.properties(resolution=0.05)
robot.append(fine)
env = Environment("empty", fastmode=True)
"""


class Pages:
    """The requests of the pages, and the data sent to them."""

    def __init__(self):
        self.wishes = SimpleNamespace(overlays=frozenset())
        self.got = []

    def send(self, message):
        self.got.append(message)

    def take(self):
        got, self.got = self.got, []
        return {m.component: np.frombuffer(m.payload, dtype=np.float32).reshape(-1, 7) for m in got}


@pytest.fixture
def shown(simulate):
    simulation, pages = simulate(RAYS_IN_THE_VIEW_SCRIPT, sockets=False), Pages()
    rays = ViewRays(simulation.context, pages)

    def update(seconds):
        simulation.sleep(seconds)
        rays.update()
        return pages.take()

    update.pages = pages
    return update


def test_a_visible_arc_is_shown_unasked(shown):
    rows = shown(0.1)
    assert set(rows) == {"robot.arc"}
    assert rows["robot.arc"].shape == (21, 7)
    # 2 m, no echo
    assert rows["robot.arc"][10] == pytest.approx([0, 0, 0, 2, 0, 0, 0], abs=1e-6)


def test_what_a_page_looks_at_is_shown(shown):
    shown.pages.wishes.overlays = frozenset({"robot.plain"})
    rows = shown(0.1)["robot.plain"]
    assert rows[90] == pytest.approx([0, 0, 0, 4, 0, 0, 1], abs=1e-5)
    assert rows[0, 6] == 0
    assert np.linalg.norm(rows[0, 3:6]) == pytest.approx(30, abs=1e-4)


def test_the_same_rays_are_sent_once(shown):
    shown.pages.wishes.overlays = frozenset({"robot.plain"})
    assert set(shown(0.1)) == {"robot.arc", "robot.plain"}
    assert shown(0.0) == {}
    assert set(shown(0.1)) == {"robot.arc", "robot.plain"}


def test_of_very_many_rays_some_are_shown(shown):
    shown.pages.wishes.overlays = frozenset({"robot.fine"})
    rows = shown(0.1)["robot.fine"]
    assert 1000 < len(rows) <= 4000
    assert np.ptp(np.arctan2(rows[:, 4], rows[:, 3])) > np.radians(265)
