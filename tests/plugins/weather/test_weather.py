"""Weather: extinction, echoes, veils and gusts as published; the same bits everywhere; mistakes are named."""

import math
import re

import numpy as np
import pytest

import morse
from morse.helpers.air import wind
from morse.plugins.weather.medium import LIDAR, VISIBLE, Beam, Conditions, drops_of, falling_speed
from morse.plugins.weather.radio import attenuation
from morse.plugins.weather.services import outputs, settled, turbulence
from tests.kit.scenes import Load, script

WALL = """
robot = FakeRobot()
laser = Sick()
laser.translate(z=1.0)
laser.properties(laser_range={reach}, scan_window={window}, resolution=0.1)
robot.append(laser)
wall = Cube("wall")
wall.scale = (0.5, 60.0, 20.0)
wall.translate(x={distance} + 0.5)
wall.set_physics_type("STATIC")
env = Environment("empty")
env.weather({weather})
"""


def test_extinction_of_light_as_published():
    """5 % of the contrast are left at the meteorological range; ITU-R P.1814 for rain: 1.076 R^0.67 dB/km."""
    assert math.exp(-Conditions(fog=200.0).extinction() * 200.0) == pytest.approx(0.05, rel=2e-3)
    assert Conditions(fog=200.0).extinction(LIDAR) == Conditions(fog=200.0).extinction(VISIBLE)  # Kim: below 500 m
    assert Conditions(fog=10_000.0).extinction(LIDAR) == pytest.approx(2.996 / 1e4 * (905 / 550) ** -1.3)
    for rate, decibels in ((1.0, 1.076), (12.0, 5.687), (50.0, 14.79)):
        in_rain = 10.0 * math.log10(math.exp(Conditions(rain=rate).extinction() * 1000.0))
        assert in_rain == pytest.approx(decibels, rel=2e-3)


def test_attenuation_of_radar_as_published():
    """ITU-R P.838-3: at 77 GHz, 10 mm/h attenuate by 5.7 dB/km."""


@pytest.mark.parametrize(
    ("gigahertz", "k", "alpha"), [(20.0, 0.09164, 1.0568), (24.0, 0.1425, 1.0101), (25.0, 0.1571, 0.9991)]
)
def test_rain_weakens_radio_waves_as_the_table_of_p838_3_says(gigahertz, k, alpha):
    """ITU-R P.838-3, table 5: the coefficients for horizontal polarisation."""
    assert attenuation(Conditions(rain=1.0), gigahertz * 1e9) == pytest.approx(k, rel=1e-3)
    for rate in (0.25, 10.0, 150.0):
        assert attenuation(Conditions(rain=rate), gigahertz * 1e9) == pytest.approx(k * rate**alpha, rel=2e-3)
    assert attenuation(Conditions(fog=50.0), gigahertz * 1e9) == 0.0


@pytest.mark.parametrize("rate", [2.0, 12.0, 50.0])
def test_drops_carry_the_water_of_the_rain(rate: float):
    """The volumes of the drops by Marshall and Palmer, at the speeds by Atlas, are the rate; both are fits."""
    (drops,) = drops_of(Conditions(rain=rate))
    diameters = np.linspace(0.0, 8.0, 4001)
    density = drops.intercept * np.exp(-drops.slope * diameters)
    speeds = np.array([falling_speed(diameter) for diameter in diameters])
    flux = np.sum(density * np.pi / 6.0 * (1e-3 * diameters) ** 3 * speeds) * (diameters[1] - diameters[0])
    assert flux * 1000.0 * 3600.0 == pytest.approx(rate, rel=0.2)
    assert drops.number() == pytest.approx(np.sum(density) * (diameters[1] - diameters[0]), rel=0.01)


@pytest.mark.parametrize("distance", [10.0, 25.0, 36.0])
@pytest.mark.parametrize("fog", [200.0, 300.0, 450.0])
def test_a_wall_in_fog_is_lost_when_too_little_light_comes_back(load: Load, fog: float, distance: float):
    """The lidar equation: exp(-2 b r) / r^2 falls below what comes back from the reach in clear air."""
    simulation = load(WALL.format(reach=40.0, window=1.0, distance=distance, weather=f"fog={fog}"))
    simulation.step(12)
    middle = simulation.robot.laser.get()["range_list"][5]
    seen = math.exp(-2.0 * 2.996 / fog * distance) >= (distance / 40.0) ** 2
    assert middle == (pytest.approx(distance, abs=0.01) if seen else 40.0)


def test_dense_fog_itself_is_an_echo(load: Load):
    """At a range of sight of 20 m, where the receiver begins to see the beam (Rasshofer and others)."""
    simulation = load(WALL.format(reach=40.0, window=90.0, distance=30.0, weather="fog=20.0"))
    simulation.step(12)
    ranges = np.asarray(simulation.robot.laser.get()["range_list"])
    assert np.mean(ranges == 1.0) > 0.5
    assert set(np.unique(ranges)) <= {1.0, 40.0}


def test_drops_send_echoes_as_often_as_their_sizes_say(load: Load):
    """A Poisson process with the number of drops that are large enough, integrated over their sizes."""
    simulation = load(WALL.format(reach=60.0, window=180.0, distance=200.0, weather="rain=60.0"))
    hits = rays = 0
    for _ in range(20):
        simulation.step(6)
        ranges = np.asarray(simulation.robot.laser.get()["range_list"])
        hits, rays = hits + int((ranges < 60.0).sum()), rays + len(ranges)
    beam = Beam(60.0)
    (drops,) = drops_of(Conditions(rain=60.0))
    extinction = Conditions(rain=60.0).extinction(LIDAR)
    expected, step = 0.0, 0.01
    for distance in np.arange(1.0, 60.0, step) + step / 2:
        width = beam.aperture + beam.divergence * distance
        diameters = np.linspace(0.0, 10.0, 2001)
        echo = drops.reflectance * (1e-3 * diameters / width) ** 2 * math.exp(-2 * extinction * distance) / distance**2
        number = np.sum(drops.intercept * np.exp(-drops.slope * diameters)[echo >= beam.threshold]) * 0.005
        expected += number * math.pi / 4.0 * width**2 * step
    share = 1.0 - math.exp(-expected)
    assert share > 0.001
    # four standard deviations
    assert hits / rays == pytest.approx(share, abs=4.0 * math.sqrt(share / rays) + 0.03 * share)


def test_points_and_remissions_follow_the_ranges(load: Load):
    scene = WALL.replace("laser = Sick()", "laser = Sick()\nlaser.level('rssi')")
    simulation = load(scene.format(reach=30.0, window=60.0, distance=8.0, weather="rain=200.0, fog=150.0"))
    simulation.step(12)
    data = simulation.robot.laser.get()
    ranges, points = np.asarray(data["range_list"]), np.asarray(data["point_list"])
    lengths = np.linalg.norm(points, axis=1)
    assert lengths == pytest.approx(np.where(ranges < 30.0, ranges, 0.0), abs=1e-9)
    assert np.all(np.asarray(data["remission_list"])[ranges >= 30.0] == 0.0)


def test_a_camera_loses_contrast_with_the_distance(load: Load):
    """Koschmieder: the contrast of a black wall to the sky falls as exp(-2.996 d / range)."""
    scene = """
robot = FakeRobot()
camera = VideoCamera()
camera.translate(z=1.0)
camera.properties(cam_width=64, cam_height=64, cam_far=400.0)
robot.append(camera)
wall = Cube("wall")
wall.scale = (0.5, 200.0, 200.0)
wall.translate(x={distance} + 0.5)
env = Environment("empty")
env.weather(fog=100.0)
"""
    contrasts = []
    for distance in (10.0, 50.0, 100.0):
        simulation = load(scene.format(distance=distance))
        simulation.step(12)
        row = np.asarray(simulation.robot.camera.get()["image"])[32, 32, :3] / 255.0
        clear = load(scene.format(distance=distance).replace("env.weather(fog=100.0)", ""))
        clear.step(12)
        plain = np.asarray(clear.robot.camera.get()["image"])[32, 32, :3] / 255.0

        def light(codes: np.ndarray) -> np.ndarray:
            return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)

        sky = light(np.array([196.0, 200.0, 204.0]) / 255.0)
        contrasts.append(np.mean((light(row) - sky) / (light(plain) - sky)))
    assert contrasts == pytest.approx([math.exp(-2.996 * d / 100.0) for d in (10.0, 50.0, 100.0)], abs=0.015)


def test_the_sky_is_seen_through_the_rain_below_the_clouds(load: Load):
    """ITU-R P.1814 along 3 km / sin(elevation): the sky keeps more of its colour overhead than near the horizon."""
    for rate in (0.5, 2.0, 50.0):
        rain = Conditions(rain=rate)
        for elevation in (0.2, 0.7, 1.57):
            (way,) = rain.way_to_sky(np.array([math.sin(elevation)], np.float32))
            decibels = 10.0 * math.log10(math.exp(1.0)) * rain.extinction() * float(way)
            assert decibels == pytest.approx(1.076 * rate**0.67 * 3.0 / math.sin(elevation), rel=2e-3)
    simulation = load("""
robot = FakeRobot()
for number, pitch in enumerate((0.1, 0.7, 1.2)):
    camera = VideoCamera(f"camera{number}")
    camera.properties(cam_width=16, cam_height=16, cam_fov=1.0)
    camera.translate(z=30.0)
    camera.rotate(y=pitch)
    robot.append(camera)
env = Environment("outdoors")
env.weather()
""")
    light = {}
    for rain in (0.0, 2.0, 50.0):
        simulation.rpc("weather", "set", {"rain": rain})
        simulation.step(10)
        for number, pitch in enumerate((0.1, 0.7, 1.2)):
            codes = np.asarray(simulation.robot[f"camera{number}"].get()["image"])[8, 8, :3]
            light[rain, pitch] = ((codes / 255.0 + 0.055) / 1.055) ** 2.4
    for pitch in (0.7, 1.2):
        # near the horizon, nothing is left of the blue sky
        left = np.mean((light[2.0, pitch] - light[2.0, 0.1]) / (light[0.0, pitch] - light[2.0, 0.1]))
        assert left == pytest.approx(10.0 ** (-0.1 * 1.076 * 2.0**0.67 * 3.0 / math.sin(pitch)), abs=0.03)
        assert np.all(light[50.0, pitch] < light[2.0, pitch])


def test_gusts_have_the_spectrum_of_dryden():
    """MIL-F-8785C: 2 s^2 T / pi / (1 + (T w)^2) along the wind; s^2 T / pi (1 + 3 (T w)^2) / (1 + (T w)^2)^2 across."""
    period, speed = 0.05, 20.0
    random = np.random.default_rng(3)
    filters, series = np.zeros(5), []
    for white in random.standard_normal((200_000, 3)):
        filters = turbulence(filters, white, period, speed)
        series.append(outputs(filters))
    gusts = np.array(series)
    assert gusts.std(axis=0) == pytest.approx(1.0, abs=0.06)
    size = 4096
    blocks = gusts[: len(gusts) // size * size].reshape(-1, size, 3)
    window = np.hanning(size)[None, :, None]
    power = (np.abs(np.fft.rfft(blocks * window, axis=1)) ** 2).mean(axis=0) * 2.0 * period / np.sum(window**2)
    frequencies = np.fft.rfftfreq(size, period)
    for axis, length in ((0, 108.7), (1, 108.7), (2, 18.29)):
        time = length / speed
        w = 2.0 * np.pi * frequencies * time
        shape = 2.0 / (1.0 + w**2) if axis == 0 else (1.0 + 3.0 * w**2) / (1.0 + w**2) ** 2
        expected = 2.0 * np.pi * shape * time / np.pi
        band = slice(4, 400)  # below a tenth of the rate
        ratio = power[band, axis].reshape(-1, 36).mean(axis=1) / expected[band].reshape(-1, 36).mean(axis=1)
        assert ratio == pytest.approx(1.0, abs=0.15)


def test_gusts_have_their_strength_from_the_first_tick_on(load: Load):
    """Runs of a second are as gusty as long ones: the filters begin as after a long time."""
    random = np.random.default_rng(5)
    states = np.array([settled(white) for white in random.standard_normal((4000, 5))])
    for tick in (0, 1, 200):
        gusts = np.array([outputs(state) for state in states])
        assert gusts.std(axis=0) == pytest.approx(1.0, abs=0.05)
        assert np.abs(gusts.mean(axis=0)).max() < 0.06
        if tick:
            states = np.array([turbulence(state, random.standard_normal(3), 0.2 * tick, 6.0) for state in states])
    first = []
    for seed in (1, 2):
        simulation = load(
            "robot = FakeRobot()\nenv = Environment('empty')\nenv.weather(wind=(6, 0), gusts=1.5)\n", seed=seed
        )
        first.append(wind(simulation.context))
        simulation.step(40)
        simulation.reset(seed=seed)
        assert wind(simulation.context) == first[-1]
    assert first[0] != first[1]
    assert first[0][0] != 6.0


@pytest.mark.parametrize("mean", [(0.2, 0.1, 0.0), (3.0, 0.0, 4.0), (0.0, 0.0, 5.0), (-3.0, 4.0, 0.0)])
def test_gusts_are_as_strong_in_light_and_in_rising_wind(load: Load, mean):
    """The standard deviation is that of the script, whatever the mean wind is; its direction has the length 1."""
    simulation = load(f"robot = FakeRobot()\nenv = Environment('empty')\nenv.weather(wind={mean}, gusts=2.0)\n")
    context = simulation.context
    weather = next(one for one in context.service_objects if one.name() == "weather")
    for state in ([1.0, 0.0, 0.0, 0.0, 0.0], [0.6, 0.3, -0.2, 0.1, 0.4]):
        weather.set_state({**weather.get_state(), "gusts": state})
        along, across, up = outputs(np.array(state))
        gust = np.array(wind(context)) - np.array(wind(context, gusts=False))
        assert math.hypot(*gust[:2]) == pytest.approx(2.0 * math.hypot(along, across))
        assert gust[2] == pytest.approx(2.0 * 0.552 * up)


def test_components_read_the_wind_of_the_weather_and_of_the_environment(load: Load):
    """It follows services, and is calm as soon as the weather is."""
    simulation = load(
        """
robot = FakeRobot()
env = Environment("empty")
env.properties(wind_x=1.0, wind_y=-0.5)
env.weather(wind=(3.0, 1.0, 0.5), gusts="dryden")
""",
        sockets=True,
    )
    context = simulation.context
    weather = next(one for one in context.service_objects if one.name() == "weather")
    assert wind(context, gusts=False) == (4.0, 0.5, 0.5)
    simulation.step(60)
    gusty = wind(context)
    assert gusty != wind(context, gusts=False)
    state = simulation.save()
    simulation.step(30)
    assert wind(context) != gusty
    simulation.restore(state)
    assert wind(context) == gusty
    weather.set({"wind": [0.0, -2.0], "gusts": 0.0})
    simulation.step(2)
    assert wind(context) == (1.0, -2.5, 0.0)
    simulation.restart()
    assert wind(context, gusts=False) == (4.0, 0.5, 0.5)


def test_wind_carries_a_body_that_flies_and_not_one_that_stands(load: Load):
    scene = """
flying = FakeRobot()
flying.translate(z=500.0)
flying.set_rigid_body()
flying.set_mass(0.2)
flying.append(Pose())
standing = ATRV()
standing.translate(y=5.0, z=0.2)
env = Environment("empty")
env.weather(wind=(5.0, 0.0))
"""
    simulation = load(scene)
    first = simulation.standing.position_3d.x if hasattr(simulation.standing, "position_3d") else None
    simulation.step(240)
    standing = simulation.context.robots["standing"].position_3d.x
    assert first is None or standing == pytest.approx(first, abs=0.02)
    assert abs(standing) < 0.05


def test_the_schedule_changes_linearly_and_services_replace_it(load: Load):
    simulation = load(
        """
robot = FakeRobot()
env = Environment("empty")
env.weather(rain=10.0, schedule={1.0: {"rain": 20.0}, 2.0: {"fog": 50.0}})
""",
        sockets=True,
    )
    weather = next(one for one in simulation.context.service_objects if one.name() == "weather")
    rain = []
    for _ in range(120):
        simulation.step(1)
        rain.append(weather.get()["rain"])
    assert rain[29] == pytest.approx(15.0, abs=0.4)
    assert rain[-1] == 20.0
    assert weather.get()["fog"] is not None
    weather.set({"rain": 0.0, "wind": [1.0, 2.0]})
    simulation.step(2)
    assert weather.get()["rain"] == 0.0
    assert weather.get()["wind"] == [1.0, 2.0, 0.0]


def test_states_and_rows_have_the_same_weather(load: Load, tmp_path):
    scene = WALL.format(reach=40.0, window=40.0, distance=9.0, weather="fog=30.0, wind=(3.0, 1.0), gusts='dryden'")
    simulation = load(scene, seed=7)
    simulation.step(30)
    state = simulation.save()
    simulation.step(30)
    after = list(simulation.robot.laser.get()["range_list"])
    simulation.restore(state)
    simulation.step(30)
    assert list(simulation.robot.laser.get()["range_list"]) == after
    with morse.batch(script(tmp_path, scene), rows=2, seed=[7, 8]) as rows:
        ranges = rows.read("robot.laser", "range_list")
        rows.step(61, measure=True)
    assert list(ranges[0]) == after
    assert list(ranges[1]) != after


@pytest.mark.parametrize(
    ("weather", "words"),
    [
        ("fog=0.0", "fog=0.0: expected 1 to inf"),
        ("rain=-1", "rain=-1"),
        ("rain=float('nan')", "rain=nan"),
        ("rain='much'", "rain='much'"),
        ("wind=5.0", "wind=5.0: expected (x, y)"),
        ("wind=(1e9, 0)", "each at most 150"),
        ("gusts='strong'", "expected 'dryden'"),
        ("wet=2", "0 for dry"),
        ("schedule={'soon': {}}", "schedule: expected"),
        ("schedule={1.0: {'rian': 2}}", "did you mean 'rain'"),
        ("schedule={1.0: {'wet': 1.0}}", "'wet' does not change in a run"),
        ("schedule={10**400: {'rain': 1.0}}", "schedule: expected"),
        ("rain=10**400", "rain="),
        ("fog=10**400", "fog="),
        ("wind=(10**400, 0)", "wind="),
        ("wind=(True, 0)", "wind="),
        ("gusts=10**400", "gusts="),
    ],
)
def test_mistakes_are_named(tmp_path, weather: str, words: str):
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, f'env = Environment("empty")\nenv.weather({weather})')).close()


def test_services_refuse_what_is_no_weather(load: Load):
    simulation = load('robot = FakeRobot()\nenv = Environment("empty")\nenv.weather(rain=1.0)')
    weather = next(one for one in simulation.context.service_objects if one.name() == "weather")
    for values in (
        {"rain": "NaN"},
        {"rain": float("nan")},
        {"rain": 1e300},
        {"wind": [1]},
        {"x": 1},
        {"wet": 0.5},
        {1: 2},
    ):
        with pytest.raises(Exception, match=r"rain|wind|weather has no|wet"):
            weather.set(values)
    assert weather.get()["rain"] == 1.0


def test_a_scene_without_weather_has_no_services_of_it(load: Load):
    simulation = load('robot = FakeRobot()\nenv = Environment("empty")')
    assert "weather" not in [one.name() for one in simulation.context.service_objects]


def test_a_misspelt_method_of_the_environment_is_named(tmp_path):
    with pytest.raises(Exception, match="did you mean 'weather'"):
        morse.load(script(tmp_path, 'env = Environment("empty")\nenv.wether(rain=1.0)')).close()


def test_wet_ground_brakes_less(load: Load):
    """A crate that slides decelerates by the share of 0.7 g."""
    scene = """
robot = FakeRobot()
robot.translate(y=9.0)
crate = Cube("crate")
crate.scale = (0.5, 0.5, 0.25)
crate.translate(z=0.25)
crate.set_rigid_body()
crate.set_mass(10.0)
env = Environment("empty")
env.weather(wet={wet})
"""
    distances = []
    for wet in (0.0, 1.0):
        simulation = load(scene.format(wet=wet))
        simulation.step(30)
        body = simulation.context.world.objects_by_name["crate"]
        body.worldLinearVelocity = (2.0, 0.0, 0.0)
        begin = body.worldPosition.x
        simulation.step(180)
        distances.append(body.worldPosition.x - begin)
    assert distances[0] == pytest.approx(4.0 / (2 * 0.7 * 9.81), rel=0.1)
    assert distances[1] == pytest.approx(2.0 * distances[0], rel=0.1)


def test_numbers_of_a_tick_take_no_memory(load: Load):
    simulation = load(
        WALL.format(reach=30.0, window=10.0, distance=8.0, weather="rain=20.0, wind=(5.0, 0.0), gusts=1.0")
    )
    simulation.step(30)
    names = len(simulation.context.drawn)
    simulation.step(60)
    assert len(simulation.context.drawn) == names


def test_a_scanner_goes_on_in_air_through_which_nothing_is_seen(load: Load):
    """The loss of light on the way is greater than a float can be."""
    simulation = load(WALL.format(reach=80.0, window=2.0, distance=20.0, weather="rain=1.0"))
    simulation.step(30)
    for values in ({"dust": 100.0}, {"fog": 1.0}, {"dust": 100.0, "rain": 2000.0, "snow": 200.0}):
        simulation.rpc("weather", "set", values)
        simulation.step(30)
        assert not simulation.failures
        ranges = np.asarray(simulation.robot.laser.get()["range_list"])
        assert (ranges[ranges < 80.0] < 3.0).all()


def test_the_wind_pushes_a_robot_by_its_own_size_after_another_of_its_name(load: Load):
    scene = """
flyer = ATRV()
flyer.translate(z=60.0)
env = Environment("empty")
env.weather(wind=(20.0, 0.0))
"""
    simulation = load(scene)
    simulation.step(3)
    simulation.delete("flyer")
    simulation.spawn("flyer", "Hummer", (0.0, -40.0, 60.0))
    simulation.spawn("other", "Hummer", (0.0, 40.0, 60.0))
    simulation.step(10)
    one, other = (simulation.context.robots[name].bge_object.worldLinearVelocity.x for name in ("flyer", "other"))
    assert one > 1.0
    assert one == pytest.approx(other)


def test_the_wind_is_an_array_too(load: Load):
    simulation = load(
        'import numpy\nrobot = FakeRobot()\nenv = Environment("empty")\nenv.weather(wind=numpy.array([2.0, 1.0]))'
    )
    assert simulation.rpc("weather", "get")["wind"] == [2.0, 1.0, 0.0]
