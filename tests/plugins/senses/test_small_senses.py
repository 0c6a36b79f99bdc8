"""Reflectance, infrared, touch, motors, gas, sound, radiation, transponders, links: each against its formula."""

import math

import numpy as np
import pytest

import morse

SCENE = """
robot = FakeRobot()
robot.translate(z=1.0)
{sensor}
{objects}
env = Environment("empty")
env.properties({environment})
"""


@pytest.fixture
def measured(load):
    """The data of a sensor after its first measurements."""

    def measure(sensor, objects="", environment="", at="x=0", ticks=3, **properties):
        given = ", ".join(f"{name}={value!r}" for name, value in properties.items())
        text = f"sensor = {sensor}('sensor'); sensor.translate({at}); sensor.properties({given}); robot.append(sensor)"
        simulation = load(SCENE.format(sensor=text, objects=objects, environment=environment))
        simulation.step(ticks)
        assert simulation.failures == ()
        return simulation.robot.sensor.get()

    return measure


def thing(what, x=5.0, y=0.0, z=1.0, name="thing"):
    return f"{name} = Empty('{name}'); {name}.translate({x}, {y}, {z}); {name}.properties({what})\n"


def wall(x, thickness=0.2, name="wall", what=""):
    text = f"{name} = Cube('{name}'); {name}.scale = ({thickness / 2}, 5, 5); {name}.translate({x}, 0, 1)\n"
    return text + f"{name}.static(); {name}.properties({what})\n"


# -- light --------------------------------------------------------------------------------------

BOARD = """
board = Cube("board"); board.scale = (0.01, 2, 2); board.translate(0.5, 0, 1); board.color({0}, {0}, {0})
line = Cube("line"); line.scale = (0.011, 0.03, 2); line.translate(0.5, {1}, 1); line.color(0, 0, 0)
"""


@pytest.mark.parametrize("y", [-0.15, 0.0, 0.15])
def test_the_line_sensor_finds_a_dark_line(measured, y):
    data = measured("LineSensor", BOARD.format(1.0, y))
    assert len(data["values"]) == 8
    half = 0.49 * math.tan(math.radians(30.0))
    assert data["position"] == pytest.approx(y / half, abs=0.15)
    dark = int(np.argmin(data["values"]))
    assert (dark < 4) == (y > 0) or y == 0.0


def test_the_colour_sensor_measures_red(measured):
    data = measured("ColorSensor", 'red = Cube("red"); red.translate(2.0, 0, 1); red.color(1.0, 0.0, 0.0)')
    assert data["red"] > 5.0 * max(data["green"], data["blue"])
    assert data["clear"] == pytest.approx(0.2126 * data["red"] + 0.7152 * data["green"] + 0.0722 * data["blue"])


@pytest.mark.parametrize(("distance", "voltage"), [(0.1, 2.33), (0.2, 1.31), (0.4, 0.74)])
def test_the_voltage_of_an_infrared_sensor_is_that_of_its_curve(measured, distance, voltage):
    """Within 10 % of points that are read from the curve of the GP2Y0A21YK0F."""
    data = measured("IRRange", wall(distance + 0.1))
    assert data["voltage"] == pytest.approx(voltage, rel=0.1)
    assert data["distance"] == pytest.approx(distance, abs=1e-6)


def test_an_infrared_sensor_errs_below_its_range_and_sees_nothing_beyond(measured):
    assert measured("IRRange", wall(0.05 + 0.1))["distance"] > 0.2
    assert measured("IRRange", wall(3.0))["distance"] == math.inf


# -- touch --------------------------------------------------------------------------------------


def test_a_bumper_strip_tells_the_segment(measured):
    post = 'post = Cylinder("post"); post.scale = (0.05, 0.05, 1); post.translate(0.17, 0.17, 1); post.static()'
    pressed = measured("BumperStrip", post, segments=6)["pressed"]
    assert pressed == [False, True, True, False, False, False] or pressed == [False, True, False, False, False, False]
    assert not any(measured("BumperStrip", "")["pressed"])


def test_a_whisker_bends_by_what_is_missing_of_its_length(measured):
    bends = measured("Whiskers", wall(0.2, 0.2), count=1, length=0.2)["bends"]
    assert bends == pytest.approx([0.5], abs=1e-9)


def test_the_force_on_a_skin_is_stiffness_times_depth(measured):
    data = measured("TactileArray", wall(0.103, 0.2), rows=4, columns=6, stiffness=100.0)
    assert data["forces"].shape == (4, 6)
    assert data["forces"] == pytest.approx(np.full((4, 6), 100.0 * 0.002), rel=1e-4)
    assert data["total"] == pytest.approx(24 * 0.2, rel=1e-4)


def test_the_first_taxel_is_the_upper_left_one(measured):
    corner = 'c = Cube("c"); c.scale = (0.05, 0.005, 0.005); c.translate(0.052, 0.014, 1.014); c.static()'
    forces = measured("TactileArray", corner)["forces"]
    assert forces[0, 0] > 0.0
    assert not forces[4:].any()
    assert not forces[:, 4:].any()


# -- motors -------------------------------------------------------------------------------------

ARM = """
<mujoco><worldbody><body name="base"><geom type="box" size=".05 .05 .05"/>
<body name="link" pos="0 0 .1"><joint name="hinge" type="hinge" axis="0 1 0" damping="1000"/>
<geom type="box" pos=".25 0 0" size=".25 .02 .02" mass="2"/></body></body></worldbody></mujoco>
"""


def test_the_current_carries_the_load_and_heats_the_winding(tmp_path):
    (tmp_path / "arm.xml").write_text(ARM)

    def scene():
        from morse.builder import Environment, MotorSensor, Robot

        arm = Robot(str(tmp_path / "arm.xml"))
        arm.name = "arm"
        arm.translate(z=1.0)
        sensor = MotorSensor("sensor")
        sensor.properties(axis="y", torque_constant=0.05, gear=50.0)
        arm.append(sensor, "link")
        Environment("empty", fastmode=True)

    with morse.load(scene, sockets=False) as simulation:
        simulation.step(30)
        data = simulation.arm.sensor.data
        sensor = simulation.context.components["arm.sensor"]
        assert abs(data["current"]) == pytest.approx(2.0 * 9.81 * 0.25 / (0.05 * 50.0), rel=0.02)
        # in the end, the losses flow to the air: T - Ta = R_th I² R(T)
        warm = sensor.ambient
        for _ in range(2000):
            warm = sensor.heated(warm, 3.0, 1.0)
        resistance = sensor.resistance * (1.0 + 0.00393 * (warm - 20.0))
        assert warm - sensor.ambient == pytest.approx(sensor.thermal_resistance * 9.0 * resistance, rel=1e-6)
        # without current it cools by exp(-t / R C)
        cool = 100.0
        for _ in range(6000):
            cool = sensor.heated(cool, 0.0, 0.01)
        assert cool == pytest.approx(25.0 + 75.0 * math.exp(-60.0 / 60.0), abs=0.05)
        assert sensor.heated(25.0, 1e9, 1.0) == 1000.0


# -- gas, sound, radiation ----------------------------------------------------------------------


def test_many_puffs_are_the_plume_of_a_point_source_in_a_uniform_wind(measured):
    """Q / (4 π D r) exp(-u (r - x) / 2 D), 4 m downwind and 0.3 m aside."""
    data = measured(
        "GasSensor", thing("gas_source=2.0", x=-4.0, y=-0.3), "wind_x=1.0", ticks=1800, turbulence=0.0, interval=0.02,
        lifetime=25.0, diffusion=0.05,
    )  # fmt: skip
    r = math.hypot(4.0, 0.3)
    expected = 2.0 / (4 * math.pi * 0.05 * r) * math.exp(-(r - 4.0) / (2 * 0.05))
    assert data["concentration"] == pytest.approx(expected, rel=0.02)


def test_there_is_no_gas_upwind_and_all_sensors_find_one_plume(load):
    sensors = "\n".join(
        f"s{i} = GasSensor('s{i}'); s{i}.translate(x={x}); robot.append(s{i})" for i, x in enumerate((0.0, 0.0, -9.0))
    )
    simulation = load(SCENE.format(sensor=sensors, objects=thing("gas_source=2.0", x=-4.0), environment="wind_x=1.0"))
    simulation.step(600)
    here, there, upwind = (simulation.robot.__getattr__(f"s{i}").data["concentration"] for i in range(3))
    assert here == there > 0.0
    assert upwind < 1e-6 * here


def test_the_wind_of_the_weather_carries_the_gas(load):
    """The same bits as the properties of the environment, and the sum of both."""
    found = []
    for properties, weather in (
        ("wind_x=1.0, wind_y=0.5", ""),
        ("", "wind=(1.0, 0.5)"),
        ("wind_x=0.5", "wind=(0.5, 0.5)"),
    ):
        text = SCENE.format(
            sensor="nose = GasSensor('nose'); robot.append(nose)",
            objects=thing("gas_source=2.0", x=-4.0, y=-2.0), environment=properties,
        )  # fmt: skip
        simulation = load(text + (f"env.weather({weather})\n" if weather else ""))
        simulation.step(400)
        found.append(simulation.robot.nose.data["concentration"])
    assert found[0] == found[1] == found[2] > 1e-3


def test_the_level_of_sound_falls_with_the_distance_and_adds_as_power(measured):
    near = measured("Microphone", thing("sound_level=80", x=1.0), floor=-20.0)["level"]
    far = measured("Microphone", thing("sound_level=80", x=10.0), floor=-20.0)["level"]
    assert (near, far) == (pytest.approx(80.0, abs=1e-6), pytest.approx(60.0, abs=1e-6))
    two = thing("sound_level=80", x=1.0) + thing("sound_level=80", x=0.0, y=1.0, name="other")
    assert measured("Microphone", two)["level"] == pytest.approx(80.0 + 10 * math.log10(2.0), abs=1e-3)


def test_a_microphone_hears_the_direction_and_less_behind_a_wall(measured):
    data = measured("Microphone", thing("sound_level=80", x=3.0, y=3.0))
    assert data["azimuth"] == pytest.approx(math.pi / 4)
    open_air = measured("Microphone", thing("sound_level=80"), floor=-20.0)["level"]
    behind = measured("Microphone", thing("sound_level=80") + wall(3.0), wall_loss=20.0, floor=-20.0)["level"]
    assert open_air - behind == pytest.approx(20.0, abs=0.1)


def test_radiation_falls_with_the_square_of_the_distance_and_in_shields(measured):
    def rate(objects):
        return measured("GeigerCounter", objects, background=0.0)["rate"]

    near, far = rate(thing("activity=1e6", x=2.0)), rate(thing("activity=1e6", x=6.0))
    assert near == pytest.approx(1e6 * 0.001 / (4 * math.pi * 4.0), rel=1e-9)
    assert near / far == pytest.approx(9.0, rel=1e-9)
    shielded = rate(thing("activity=1e6", x=2.0) + wall(1.0, 0.2, what="attenuation=12.0"))
    assert shielded / near == pytest.approx(math.exp(-12.0 * 0.2), rel=1e-6)
    # half of the radiation of caesium 137 goes through 3.9 cm of concrete
    bare = rate(thing("activity=1e6", x=2.0) + wall(1.0, 0.039))
    assert bare / near == pytest.approx(0.5, abs=0.01)
    twice = wall(1.0, 0.2, what="attenuation=12.0") + wall(1.5, 0.1, "other", "attenuation=5.0")
    assert rate(thing("activity=1e6", x=2.0) + twice) / near == pytest.approx(math.exp(-12 * 0.2 - 5 * 0.1), rel=1e-6)


def test_counts_have_a_poisson_distribution(load):
    sensor = "sensor = GeigerCounter('sensor'); sensor.properties(errors=True, background=60.0); robot.append(sensor)"
    simulation = load(SCENE.format(sensor=sensor, objects="", environment=""))
    counts = []
    for _ in range(300):
        simulation.step(6)
        counts.append(simulation.robot.sensor.data["counts"])
    assert np.mean(counts) == pytest.approx(6.0, abs=4 * math.sqrt(6.0 / 300))
    assert np.var(counts) == pytest.approx(6.0, rel=0.4)


# -- transponders -------------------------------------------------------------------------------


def test_usbl_measures_range_and_bearing(measured):
    (fix,) = measured("USBL", thing("usbl_beacon=True", x=30.0, y=40.0, z=1.0))["fixes"]
    assert fix["name"] == "thing"
    assert (fix["range"], fix["azimuth"]) == (pytest.approx(50.0), pytest.approx(math.atan2(40, 30)))
    assert measured("USBL", thing("usbl_beacon=True") + wall(3.0))["fixes"] == []
    assert measured("USBL", thing("usbl_beacon=True"), max_range=4.0)["fixes"] == []


def test_a_wall_makes_uwb_ranges_too_long(measured):
    (free,) = measured("UWB", thing("uwb_anchor=True"))["ranges"]
    (behind,) = measured("UWB", thing("uwb_anchor=True") + wall(3.0, 0.2, what="permittivity=6.25"))["ranges"]
    assert (free["range"], free["los"]) == (pytest.approx(5.0), True)
    assert (behind["range"], behind["los"]) == (pytest.approx(5.0 + 1.5 * 0.2, abs=1e-6), False)


def test_a_tag_answers_as_far_as_friis_says(measured):
    reach = 10 ** ((36.0 + 18.0) / 20) * 299792458.0 / (4 * math.pi * 866e6)
    (tag,) = measured("RFIDReader", thing("rfid='E200 1234'", x=reach * 0.99))["tags"]
    assert tag["id"] == "E200 1234"
    assert tag["power"] == pytest.approx(-18.0 - 20 * math.log10(0.99), abs=0.01)
    assert measured("RFIDReader", thing("rfid='E200 1234'", x=reach * 1.01))["tags"] == []
    assert measured("RFIDReader", thing("rfid='E200 1234'", x=0.0, y=3.0))["tags"] == []


# -- links --------------------------------------------------------------------------------------

LINKS = """
for index, x in enumerate(({places})):
    robot = FakeRobot(f"r{{index}}")
    robot.translate(x, 0.0, {z})
    radio = {kind}("radio")
    radio.properties({properties})
    robot.append(radio)
{objects}
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def links(load):
    def make(*places, kind="Radio", z=1.0, objects="", **properties):
        given = ", ".join(f"{name}={value!r}" for name, value in properties.items())
        text = LINKS.format(places=", ".join(map(str, places)) + ",", kind=kind, z=z, properties=given, objects=objects)
        return load(text)

    return make


def heard(simulation, robot, ticks=60):
    """The texts that a robot receives, and the number of lost ones."""
    texts, lost = [], 0
    for _ in range(ticks):
        simulation.step(1)
        radio = simulation.context.components[f"{robot}.radio"]
        if radio.local_data["timestamp"] == simulation.context.clock.time:
            texts += [(one["sender"], one["text"]) for one in radio.local_data["received"]]
            lost += radio.local_data["lost"]
    return texts, lost


def test_free_space_and_walls(links):
    simulation = links(0.0, 10.0, 100.0, objects=wall(50.0), wall_loss=8.0)
    simulation.step(3)
    near, far = simulation.r0.radio.data["links"]
    assert near["rssi"] == pytest.approx(20.0 - 20 * math.log10(4 * math.pi * 10.0 * 2.4e9 / 299792458.0), abs=1e-6)
    assert near["rssi"] - far["rssi"] == pytest.approx(20.0 + 8.0, abs=1e-6)
    assert near["delay"] == pytest.approx(10.0 / 299792458.0)


def test_a_text_reaches_the_radios_of_the_channel_once(links):
    simulation = links(0.0, 10.0)
    simulation.step(3)
    simulation.r0.radio.send("hello").result()
    assert heard(simulation, "r1") == ([("r0.radio", "hello")], 0)


def test_packets_that_overlap_are_lost(links):
    simulation = links(-10.0, 0.0, 10.0, bit_rate=1000.0)
    simulation.step(3)
    simulation.r0.radio.send("one")
    simulation.r2.radio.send("two")
    assert heard(simulation, "r1") == ([], 2)


def test_the_stronger_packet_survives_if_it_is_much_stronger(links):
    simulation = links(-10.0, 0.0, 500.0, bit_rate=1000.0)
    simulation.step(3)
    simulation.r0.radio.send("near")
    simulation.r2.radio.send("far")
    assert heard(simulation, "r1") == ([("r0.radio", "near")], 1)


def test_sound_is_late(links):
    """1,500 m take a second; the packet of 20 bytes takes 1.6 s at 100 bits per second."""
    simulation = links(0.0, 1500.0, kind="AcousticModem", z=-10.0)
    simulation.step(6)
    begin = simulation.context.clock.time
    simulation.r0.radio.send("dive")
    texts = []
    for _ in range(240):
        simulation.step(1)
        texts += simulation.context.components["r1.radio"].local_data["received"]
    assert texts[0]["text"] == "dive"
    delay = simulation.r0.radio.data["links"][0]["delay"]
    assert delay == pytest.approx(1500.0 / 1490.0, rel=2e-3)
    assert texts[0]["time"] - begin == pytest.approx(delay + 1.6, abs=0.05)


def test_a_text_that_is_too_long_is_refused(links):
    simulation = links(0.0, 10.0)
    simulation.step(3)
    with pytest.raises(Exception, match="at most 1000 bytes, given 5,000"):
        simulation.r0.radio.send("x" * 5000).result()
    for _ in range(300):
        simulation.r0.radio.send("x")
    simulation.step(3)
    assert len(simulation.context.components["r0.radio"]._sent) <= 64


# -- anything -----------------------------------------------------------------------------------

PROPERTIES = [
    "gas_source",
    "activity",
    "sound_level",
    "usbl_beacon",
    "uwb_anchor",
    "rfid",
    "attenuation",
    "permittivity",
]
SENSORS = ["GasSensor", "GeigerCounter", "Microphone", "USBL", "UWB", "RFIDReader"]


@pytest.mark.parametrize("sensor", SENSORS)
@pytest.mark.parametrize("value", ["'much'", "1e300", "-1e300", "True"])
def test_properties_of_objects_may_be_anything(measured, sensor, value):
    what = ", ".join(f"{name}={value}" for name in PROPERTIES)
    data = measured(sensor, thing(what, x=0.0) + thing(what, name="other") + wall(3.0, what=what), f"wind_x={value}")
    for item in data.values():
        if isinstance(item, float):
            assert math.isfinite(item)
