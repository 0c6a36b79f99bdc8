"""Zones of weather, radio waves and sound in it, and what it draws: as published and as computed by hand; same bits."""

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import morse
from morse.helpers.air import Air
from morse.plugins.weather.medium import Conditions
from morse.plugins.weather.radio import (
    LIGHT,
    attenuation_of_sound,
    backscatter,
    echo_of_rain,
    refractive_index_of_water,
)
from morse.plugins.weather.zones import Atmosphere, Zone
from morse.viewer.live_view import AirFeed
from morse.viewer.view_messages import AirLook
from tests.kit.scenes import Load, script

SQUARE = Zone("square", ((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)), top=5.0)
numbers = st.floats(-30.0, 30.0)


# -- zones ---------------------------------------------------------------------------------


@settings(max_examples=200, deadline=None)
@given(st.tuples(numbers, numbers, numbers), st.tuples(numbers, numbers, numbers), st.floats(0.0, 80.0))
def test_the_way_through_a_zone_is_that_of_its_points(start, way, length):
    """The share of evenly spaced points of the ray that are within the zone."""
    size = math.hypot(*way)
    if size < 1e-3:
        return
    unit = [part / size for part in way]
    air = Atmosphere(Conditions(), ((SQUARE, Conditions(dust=1.0 / 0.6)),))
    ways = [np.array([part]) for part in unit]
    found = air.along(np.array(start), ways, np.array([length]), lambda one: one.extinction())
    steps = (np.arange(4000) + 0.5) / 4000 * length
    inside = sum(SQUARE.contains([a + b * step for a, b in zip(start, unit, strict=True)]) for step in steps.tolist())
    assert found[0] == pytest.approx(inside / 4000 * length, abs=0.02 + length / 1000)


def test_zones_with_a_common_border_do_not_overlap():
    beside = Zone("beside", ((10.0, 0.0), (20.0, 0.0), (20.0, 10.0)))
    across = Zone("across", ((9.0, 4.0), (20.0, 0.0), (20.0, 10.0)))
    assert not SQUARE.overlaps(beside)
    assert SQUARE.overlaps(across)
    assert across.overlaps(SQUARE)


TUNNEL = """
robot = FakeRobot()
laser = Sick()
laser.translate(z=1.0)
laser.properties(laser_range=40.0, scan_window=1.0, resolution=0.1)
robot.append(laser)
wall = Cube("wall")
wall.scale = (0.5, 60.0, 20.0)
wall.translate(x={distance} + 0.5)
wall.set_physics_type("STATIC")
env = Environment("empty")
env.weather(fog=300.0)
env.weather(zone="bank", area=[(5.0, -8.0), ({end}, 8.0)], fog=60.0)
"""


@pytest.mark.parametrize(("distance", "end"), [(12.0, 9.0), (20.0, 9.0), (20.0, 15.0), (26.0, 7.0), (30.0, 9.0)])
def test_a_wall_behind_a_bank_of_fog(load: Load, distance, end):
    """The lidar equation with the integral of the extinction: outside 2.996 / 300, in the bank 2.996 / 60."""
    simulation = load(TUNNEL.format(distance=distance, end=end))
    simulation.step(12)
    middle = simulation.robot.laser.get()["range_list"][5]
    depth = 2.996 / 300.0 * (distance - (end - 5.0)) + 2.996 / 60.0 * (end - 5.0)
    seen = math.exp(-2.0 * depth) >= (distance / 40.0) ** 2
    assert middle == (pytest.approx(distance, abs=0.01) if seen else 40.0)


def test_flakes_are_only_where_it_snows(load: Load):
    """False echoes of heavy snow behind 4 m, and none in the clear part in front."""
    simulation = load(
        """
robot = FakeRobot()
laser = Sick()
laser.translate(z=1.0)
laser.properties(laser_range=60.0, scan_window=60.0, resolution=0.1)
robot.append(laser)
env = Environment("empty")
env.weather(snow=4.0)
env.weather(zone="shelter", area=[(-20.0, -20.0), (4.0, 20.0)])
"""
    )
    echoes = []
    for _ in range(20):
        simulation.step(6)
        data = simulation.robot.laser.get()
        is_echo = np.asarray(data["range_list"]) < 60.0
        echoes.append(np.asarray(data["point_list"])[is_echo])
    points = np.concatenate(echoes)
    assert len(points) > 20
    assert points[:, 0].min() >= 4.0
    assert points[:, 0].min() < 8.0


def test_services_know_the_zones(load: Load):
    simulation = load(
        'robot = FakeRobot()\nenv = Environment("empty")\nenv.weather(zone="bank", area=[(0, 0), (4, 5)], fog=20.0)\n'
    )
    weather = next(one for one in simulation.context.service_objects if one.name() == "weather")
    assert weather.zones() == [{"zone": "bank", "area": [[0, 0], [4, 0], [4, 5], [0, 5]], "height": None}]
    weather.set({"fog": 10.0}, 0.0, "bank")
    simulation.step(2)
    assert weather.get("bank")["fog"] == 10.0
    assert weather.get()["fog"] is None
    state = simulation.save()
    weather.set({"rain": 5.0}, 10.0, "bank")
    simulation.step(60)
    assert 0.0 < weather.get("bank")["rain"] < 5.0
    simulation.restore(state)
    assert weather.get("bank")["rain"] == 0.0
    simulation.restart()
    assert weather.get("bank")["fog"] == 20.0
    for arguments, words in (
        (({"wind": [1, 0]}, 0.0, "bank"), "a zone has"),
        (({"fog": 3.0}, 0.0, "bnk"), "did you mean 'bank'"),
        (({"ice": 0.3},), "'ice' is set by the script"),
    ):
        with pytest.raises(Exception, match=re.escape(words)):
            weather.set(*arguments)


@pytest.mark.parametrize(
    ("calls", "words"),
    [
        ("env.weather(zone='', area=[(0, 0), (1, 1)])", "expected the name of the zone"),
        ("env.weather(zone=3, area=[(0, 0), (1, 1)])", "expected the name of the zone"),
        ("env.weather(zone='a')", "area=None"),
        ("env.weather(area=[(0, 0), (1, 1)])", "those of a zone"),
        ("env.weather(zone='a', area=[(0, 0), (0, 1)])", "convex"),
        ("env.weather(zone='a', area=[(0, 0), (2, 0), (0.5, 0.5), (0, 2)])", "convex"),
        ("env.weather(zone='a', area=[(0, 0), (2, 2), (2, 0), (0, 2)])", "convex"),
        ("env.weather(zone='a', area=[(0, 0), (float('nan'), 1)])", "not the corner"),
        ("env.weather(zone='a', area=[(0, 0), (10**400, 1)])", "not the corner"),
        ("env.weather(zone='a', area='abc')", "expected two opposite corners"),
        ("env.weather(zone='a', area=[(i, i * i) for i in range(99)])", "at most 32"),
        ("env.weather(zone='a', area=[(0, 0), (1, 1)], height='high')", "height="),
        ("env.weather(zone='a', area=[(0, 0), (1, 1)], wind=(1, 0))", "wind is that of the whole world"),
        ("env.weather(zone='a', area=[(0, 0), (1, 1)], ice=0.5)", "ice is that of the whole world"),
        ("env.weather(zone='a', area=[(0, 0), (2, 2)])\nenv.weather(zone='b', area=[(1, 1), (3, 3)])", "overlap"),
        ("env.weather(zone='a', area=[(0, 0), (2, 2)])\nenv.weather(zone='a', area=[(5, 5), (6, 6)])", "already"),
        ("env.weather(rain=1.0)\nenv.weather(rain=2.0)", "was set before"),
        ("env.weather(snow_cover=2.0)", "snow_cover=2.0"),
        ("env.weather(ice=float('nan'))", "ice=nan"),
        ("env.weather(lens_drops=1e9)", "lens_drops="),
        ("env.weather(ground_effect='yes')", "ground_effect="),
        ("env.weather(schedule={1.0: {'ice': 1.0}})", "'ice' does not change in a run"),
        ("for i in range(40):\n    env.weather(zone=str(i), area=[(i, 0), (i + 1, 1)])", "32 zones at most"),
    ],
)
def test_mistakes_are_named(tmp_path, calls: str, words: str):
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, f'env = Environment("empty")\n{calls}')).close()


# -- waves -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("frequency", "celsius", "decibels"),
    [(1000.0, 20.0, 5.0), (2000.0, 20.0, 9.0), (4000.0, 20.0, 22.9), (1000.0, 10.0, 3.7), (2000.0, 10.0, 9.7)],
)
def test_sound_fades_as_in_the_table_of_iso_9613_2(frequency, celsius, decibels):
    """Table 2: dB/km at a humidity of 70 %; its values are of the midbands of octaves, rounded."""
    assert 1000.0 * attenuation_of_sound(frequency, celsius, 0.7) == pytest.approx(decibels, rel=0.02, abs=0.06)


def test_small_drops_scatter_as_rayleigh_says():
    """pi^5 |K|^2 D^6 / lambda^4, with |K|^2 = 0.93 for water at 10 GHz (Battan, Radar Observation, 1973)."""
    index = refractive_index_of_water(10e9, 293.15)
    assert abs((index**2 - 1) / (index**2 + 2)) ** 2 == pytest.approx(0.93, abs=0.01)
    wavelength = LIGHT / 10e9
    for diameter in (1e-4, 3e-4):
        rayleigh = math.pi**5 * 0.93 * diameter**6 / wavelength**4
        assert backscatter(diameter, wavelength, index) == pytest.approx(rayleigh, rel=0.02)


def test_a_large_mirror_has_the_cross_section_of_its_disc():
    """pi a^2 (Skolnik, Introduction to Radar Systems, 2.7)."""
    assert backscatter(0.5, 0.01, complex(50.0, 200.0)) == pytest.approx(math.pi * 0.25**2, rel=0.02)


@pytest.mark.parametrize("rate", [1.0, 5.0, 25.0])
def test_the_echo_of_rain_at_a_weather_radar(rate):
    """pi^5 |K|^2 Z / lambda^4, with Z = 200 R^1.6 mm^6/m^3 (Marshall, Palmer 1948), within 1.5 dB."""
    wavelength = LIGHT / 9.4e9
    expected = math.pi**5 * 0.93 * 200.0 * rate**1.6 * 1e-18 / wavelength**4
    assert 10.0 * math.log10(echo_of_rain(Conditions(rain=rate), 9.4e9) / expected) == pytest.approx(0.0, abs=1.5)


def test_rain_fills_the_map_of_a_radar_at_the_speed_of_the_wind(load: Load):
    """The radar equation for a volume: constant * echo * (r^2 * angles * cell) / r^4, in dB over the noise."""
    scene = """
car = FakeRobot()
radar = Radar()
radar.properties(azimuth_fov=3.0, azimuth_resolution=3.0, elevation_fov=20.0, sensitivity=100.0)
radar.translate(z=50.0)
car.append(radar)
env = Environment("empty")
env.weather(rain=50.0, wind=({wind}, 0.0))
"""
    peaks = []
    for wind in (4.0, -4.0):
        simulation = load(scene.format(wind=wind))
        simulation.step(10)
        radar = simulation.context.components["car.radar"]
        levels = np.asarray(simulation.car.radar.get()["map"], dtype=np.float64)
        row = 10
        distance = (row + 0.5) * radar.range_resolution
        power = np.sum(10.0 ** (levels[row] / 10.0) - 1.0)
        echo = echo_of_rain(Conditions(rain=50.0), radar.carrier)
        solid = math.radians(3.0) * math.radians(20.0)
        expected = 10.0**1.3 * 100.0**4 * echo * solid * radar.range_resolution / distance**2
        # rain of 50 mm/h attenuates by 20 dB/km, there and back
        assert 10.0 * math.log10(power / expected) == pytest.approx(0.0, abs=0.04 * distance + 0.3)
        width = 2.0 * radar.max_velocity / radar.doppler_bins
        peaks.append((np.argmax(levels[row]) + 0.5) * width - radar.max_velocity)
    assert peaks == [pytest.approx(4.0, abs=0.5), pytest.approx(-4.0, abs=0.5)]


@pytest.mark.parametrize(("humid", "distance"), [(True, 3.9), (False, 3.9), (True, 2.0)])
def test_ultrasound_in_humid_air(load: Load, humid, distance):
    """ISO 9613-1: at 40 kHz and 35 °C the air absorbs more than at 20 °C and 50 %, for which the reach is given."""
    simulation = load(
        f"""
robot = FakeRobot()
finder = UltrasonicRangeFinder()
finder.properties(cone=0.0)
finder.translate(z=1.0)
robot.append(finder)
wall = Cube("wall")
wall.scale = (0.5, 9.0, 9.0)
wall.translate(x={distance} + 0.5)
wall.set_physics_type("STATIC")
env = Environment("empty")
env.properties(Temperature=35.0)
{"env.weather(fog=100.0)" if humid else ""}
"""
    )
    simulation.step(10)
    usual = attenuation_of_sound(40e3, 20.0, 0.5) * 4.0 + 20.0 * math.log10(4.0)
    now = attenuation_of_sound(40e3, 35.0, 1.0) * distance + 20.0 * math.log10(distance)
    measured = simulation.robot.finder.get()["distance"]
    assert measured == (math.inf if humid and now > usual else pytest.approx(distance, abs=0.01))


def test_the_air_mixes_its_own_heat_into_thermal_images(load: Load):
    """The fourth powers of the temperatures are mixed by exp(-2.996 d / range)."""
    simulation = load(
        """
robot = FakeRobot()
camera = ThermalCamera()
camera.properties(cam_width=32, cam_height=32, cam_far=200.0, DefaultTemperature=5.0)
camera.translate(z=1.0)
robot.append(camera)
wall = Cube("wall")
wall.scale = (0.5, 50.0, 50.0)
wall.translate(x=20.5)
wall.properties(Temperature=90.0)
env = Environment("empty")
env.weather(fog=60.0)
"""
    )
    simulation.step(10)
    seen = math.exp(-2.996 * 20.0 / 60.0)
    expected = (seen * 363.15**4 + (1.0 - seen) * 278.15**4) ** 0.25 - 273.15
    assert simulation.robot.camera.get()["image"][16][16] == pytest.approx(expected, abs=0.3)


@pytest.mark.parametrize("wet", [0.0, 1.0])
def test_dark_and_slanting_surfaces_are_lost_sooner(load: Load, wet):
    """Lambert: a share p of the light at an angle a is detected up to sqrt(p cos a / 0.8) of the reach, in clear air.

    The ground is seen from 2 m, at an angle whose cosine is 2 / r; wet, it keeps 60 % of its light. A wall stays dry.
    """
    simulation = load(f"""
robot = FakeRobot()
for name, down in (("ahead", 0.0), ("below", 0.35)):
    laser = Sick(name)
    laser.level("rssi")
    laser.alter("Weather", surfaces="material")
    laser.translate(z=2.0)
    laser.rotate(y=down)
    laser.properties(laser_range=20.0, scan_window=120.0, resolution=0.5)
    robot.append(laser)
wall = Cube("wall")
wall.scale = (0.5, 60.0, 20.0)
wall.translate(x=8.5)
wall.properties(lidar_reflectivity=0.2)
wall.static()
ground = Cube("ground")
ground.scale = (60.0, 60.0, 0.5)
ground.translate(z=-0.5)
ground.properties(lidar_reflectivity=0.6)
ground.static()
env = Environment("empty")
env.weather(wet={wet})
""")
    simulation.step(12)
    angles = np.radians(np.arange(-60.0, 60.1, 0.5))
    ahead, below = (simulation.robot[name].get() for name in ("ahead", "below"))
    truth = 8.0 / np.cos(angles)
    is_seen = 0.2 * np.cos(angles) / 0.8 >= (truth / 20.0) ** 2
    assert is_seen.any()
    assert not is_seen.all()
    assert np.asarray(ahead["range_list"]) == pytest.approx(np.where(is_seen, truth, 20.0), abs=0.01)
    expected = np.where(is_seen, 0.2 * np.cos(angles), 0.0)
    assert np.asarray(ahead["remission_list"]) == pytest.approx(expected, abs=1e-3)
    # the rays of an inclined plane meet the ground 5.5 m ahead
    truth = 2.0 / (math.sin(0.35) * np.cos(angles))
    is_seen = (0.36 if wet else 0.6) * 2.0 / truth / 0.8 >= (truth / 20.0) ** 2
    assert is_seen.any()
    assert not is_seen.all()
    assert np.asarray(below["range_list"]) == pytest.approx(np.where(is_seen, truth, 20.0), abs=0.01)


@pytest.mark.parametrize("mode", ["first", "strongest", "last"])
def test_a_scanner_reports_the_echo_that_it_is_told(load: Load, mode):
    """In dense fog with a wall at 4 m there are two echoes: a weak one of the fog at 1 m, and the wall."""
    simulation = load(
        f"""
robot = FakeRobot()
laser = Sick()
laser.alter("Weather", echo="{mode}")
laser.translate(z=1.0)
laser.properties(laser_range=40.0, scan_window=40.0)
robot.append(laser)
wall = Cube("wall")
wall.scale = (0.5, 60.0, 20.0)
wall.translate(x=4.5)
wall.set_physics_type("STATIC")
env = Environment("empty")
env.weather(fog=20.0)
"""
    )
    simulation.step(12)
    ranges = np.asarray(simulation.robot.laser.get()["range_list"])
    is_fog = ranges == 1.0
    if mode == "first":
        assert is_fog.mean() > 0.5
    else:
        # the echo of the fog varies, and is seldom stronger than that of the wall
        assert is_fog.mean() <= (0.0 if mode == "last" else 0.1)
        assert np.min(ranges[~is_fog]) == pytest.approx(4.0, abs=0.01)


# -- pictures, ground and rotors ---------------------------------------------------------------

LOOKING_DOWN = """
robot = FakeRobot()
robot.translate(z=40.0)
camera = VideoCamera()
camera.properties(cam_width=256, cam_height=256, cam_far=100.0)
camera.rotate(y=-1.5707963)
robot.append(camera)
ground = Cube("floor")
ground.scale = (90.0, 90.0, 0.5)
ground.translate(z=-0.4)
env = Environment("empty")
env.weather({weather})
"""


def _picture(simulation) -> np.ndarray:
    simulation.step(10)
    return np.asarray(simulation.robot.camera.get()["image"])[..., :3].astype(int)


@pytest.mark.parametrize("cover", [0.25, 0.6])
def test_snow_covers_its_share_of_the_ground(load: Load, cover):
    full = _picture(load(LOOKING_DOWN.format(weather="snow_cover=1.0")))
    bare = _picture(load(LOOKING_DOWN.format(weather="snow_cover=0.0")))
    some = _picture(load(LOOKING_DOWN.format(weather=f"snow_cover={cover}")))
    share = np.mean((some - bare).sum(axis=2) / np.maximum((full - bare).sum(axis=2), 1))
    assert share == pytest.approx(cover, abs=0.08)


def test_wet_ground_is_darker_from_above(load: Load):
    """A wet rough surface keeps 60 % of its light, and reflects 2 % of the sky."""
    bare = _picture(load(LOOKING_DOWN.format(weather="wet=0.0")))
    wet = _picture(load(LOOKING_DOWN.format(weather="wet=1.0")))
    assert np.mean(wet / np.maximum(bare, 1)) == pytest.approx(math.sqrt(0.6), abs=0.08)


def test_puddles_reflect_as_schlick_says(load: Load):
    """At 4 m from eyes at 1 m, water reflects 0.02 + 0.98 (1 - cos)^5 of the wall behind: its mirror image."""
    scene = """
robot = FakeRobot()
camera = VideoCamera()
camera.translate(z=1.0)
camera.properties(cam_width=200, cam_height=200, cam_fov=60.0)
robot.append(camera)
floor = Cube("floor")
floor.scale = (90.0, 90.0, 0.5)
floor.translate(z=-0.5)
wall = Cube("wall")
wall.scale = (0.5, 40.0, 40.0)
wall.translate(x=6.5)
env = Environment("empty")
env.weather(wet={wet})
"""
    bare, wet = (_picture(load(scene.format(wet=wet))) for wet in (0.0, 1.0))
    focal = 100.0 / math.tan(math.radians(30.0))
    # the ground 4 m ahead, and the wall where the reflected ray meets it, at a height of (6 - 4) / 4
    ground, image = round(100.0 + focal / 4.0), round(100.0 + focal * 0.5 / 6.0)
    cosine = 1.0 / math.sqrt(17.0)
    reflectance = 0.02 + 0.98 * (1.0 - cosine) ** 5
    expected = (1.0 - reflectance) * math.sqrt(0.6) * bare[ground, 100] + reflectance * bare[image, 100]
    assert wet[ground, 100] == pytest.approx(expected, abs=3.0)
    assert wet[image, 100] == pytest.approx(bare[image, 100], abs=1.0)


def test_as_many_drops_are_on_the_lens_as_the_script_says(load: Load):
    scene = LOOKING_DOWN.format(weather="lens_drops=12").replace(
        "env.weather", "env.simulator_frequency(20)\nenv.weather"
    )
    bare = _picture(load(LOOKING_DOWN.format(weather="wet=0.0")))
    simulation = load(scene)
    areas = []
    for _ in range(30):
        picture = _picture(simulation)
        areas.append(np.mean(np.abs(picture - bare).sum(axis=2) > 6))
    # the mean area of a circle whose radius is 0.015 + 0.045 u^2 of the height, u even from 0 to 1
    mean = np.mean([(0.015 + 0.045 * u * u) ** 2 for u in np.linspace(0.0, 1.0, 1001)]) * math.pi
    assert np.mean(areas) == pytest.approx(12 * mean, rel=0.45)


def test_delayed_pictures_are_restored_with_what_the_weather_needs(load: Load):
    """Pictures that wait for their delay in a saved state give the same images after it is restored."""
    scene = LOOKING_DOWN.format(weather="fog=50.0, snow_cover=0.5, wet=0.5, rain=5.0").replace(
        "robot.append(camera)", "camera.delay(0.3)\nrobot.append(camera)"
    )
    simulation = load(scene)
    simulation.step(40)
    state = simulation.save()
    simulation.step(6)
    after = np.asarray(simulation.robot.camera.get()["image"]).copy()
    simulation.restore(state)
    simulation.step(6)
    assert np.array_equal(np.asarray(simulation.robot.camera.get()["image"]), after)


def test_views_are_told_how_the_air_looks_when_it_changes(load: Load):
    """The extinction of Koschmieder, in each part of the world; nothing while the air is clear."""
    simulation = load("""
robot = FakeRobot()
env = Environment("empty")
env.weather(wind=(2.0, 0.0))
env.weather(zone="valley", area=[(5, 5), (9, 9)], height=2.0)
""")
    sent: list[AirLook] = []
    feed = AirFeed(simulation.context.server(Air), SimpleNamespace(send=sent.append))

    def look() -> AirLook | None:
        sent.clear()
        simulation.step(2)
        feed.update()
        feed.update()
        assert len(sent) <= 1
        return sent[0] if sent else None

    assert look() is None
    simulation.rpc("weather", "set", {"fog": 50.0}, 0.0, "valley")
    outside, valley = look().parts
    assert (outside.extinction, outside.corners) == (0.0, [])
    assert math.exp(-valley.extinction * 50.0) == pytest.approx(0.05, rel=2e-3)
    assert sorted(valley.corners) == [(5.0, 5.0), (5.0, 9.0), (9.0, 5.0), (9.0, 9.0)]
    assert valley.top == 2.0
    assert look() is None
    simulation.rpc("weather", "set", {"fog": None}, 0.0, "valley")
    assert look().parts == []


def test_ice_is_slippery(load: Load):
    """A crate on ice is braked by 0.14 of the friction of dry ground."""
    distances = {}
    for name, weather in (("dry", "wet=0.0"), ("ice", "ice=1.0")):
        simulation = load(
            f"""
robot = FakeRobot()
robot.translate(y=9.0)
crate = Cube("crate")
crate.scale = (0.5, 0.5, 0.25)
crate.translate(z=0.25)
crate.set_rigid_body()
env = Environment("empty")
env.weather({weather})
"""
        )
        simulation.step(20)
        body = next(one for one in simulation.context.world.objects() if one.name == "crate")
        body.worldLinearVelocity = [2.0, 0.0, 0.0]
        simulation.step(30)
        distances[name] = 2.0 - body.worldLinearVelocity[0]
    assert distances["ice"] == pytest.approx(0.14 * 0.7 * 9.81 * 0.5, rel=0.15)
    assert distances["dry"] > 2.0 * distances["ice"]


@pytest.mark.parametrize("height", [0.15, 0.3, 3.0])
def test_rotors_have_more_thrust_near_the_ground(load: Load, height):
    """1 / (1 - (R / 4 z)^2) (Cheeseman, Bennett 1955), beyond eight radii none."""
    scene = """
robot = QUAD2012()
robot.translate(z={height})
robot.properties(RotorRadius=0.2)
motors = QuadrotorDynamicControl()
robot.append(motors)
env = Environment("empty")
env.weather(ground_effect={on})
"""
    shares = []
    for on in (True, False):
        simulation = load(scene.format(height=height, on=on))
        body = simulation.context.robots["robot"].bge_object
        from morse.helpers.air import thrust

        simulation.step(1)
        shares.append(thrust(simulation.context, body))
        z = body.worldPosition[2]
    assert shares[1] == 1.0
    assert shares[0] == pytest.approx(1.0 if height > 1.6 else 1.0 / (1.0 - (0.2 / (4.0 * max(z, 0.1))) ** 2), rel=0.02)
