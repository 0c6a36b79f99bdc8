"""Echo sounder, imaging sonar, side-scan and multibeam sonar."""

import math

import numpy as np
import pytest

import morse
from morse.plugins.senses.scanning import echoes_by_range
from morse.plugins.senses.water import sound_speed, transmission_loss

SCENE = """
ground = Cube("ground"); ground.scale = (200, 200, 0.5); ground.translate(z=-20.5); ground.static()
robot = Submarine()
robot.translate(z={z})
robot.rotate(y={pitch})
sonar = {sensor}("sonar")
sonar.properties({properties})
robot.append(sonar)
{more}
Environment("empty", fastmode=True)
"""


@pytest.fixture
def measured(load):
    """The data of a sensor after its first measurement."""

    def measure(sensor, z=-16.0, more="", pitch=0.0, **properties):
        given = ", ".join(f"{name}={value!r}" for name, value in properties.items())
        text = SCENE.format(sensor=sensor, z=z, properties=given, more=more, pitch=pitch)
        simulation = load(text)
        simulation.step(2)
        assert simulation.failures == ()
        return simulation.robot.sonar.get()

    return measure


# -- echo sounder -----------------------------------------------------------------------------


def test_the_echo_sounder_measures_the_depth(measured):
    assert measured("EchoSounder")["depth"] == pytest.approx(4.0, abs=1e-6)
    assert measured("EchoSounder", max_range=3.0)["depth"] == math.inf


def test_the_first_echo_of_a_flat_bottom_is_vertical_within_the_beam(measured):
    leaning = measured("EchoSounder", pitch=math.radians(10.0), beam_width=30.0)["depth"]
    assert leaning == pytest.approx(4.0, rel=2e-3)


def test_a_wrong_speed_of_sound_is_a_wrong_depth(measured):
    true = sound_speed(10.0, 35.0, 18.0)
    assert measured("EchoSounder", assumed_speed=1450.0)["depth"] == pytest.approx(4.0 * 1450.0 / true, rel=1e-6)


def test_the_level_of_an_echo_falls_by_spreading_and_absorption(measured):
    near, far = (measured("EchoSounder", z=z)["level"] for z in (-15.0, -10.0))
    assert near - far == pytest.approx(20 * math.log10(2.0) + 2 * 5 * 0.053, abs=0.1)  # α of 200 kHz: 53 dB/km
    assert transmission_loss(10.0, 0.0) == pytest.approx(20.0)


# -- imaging sonar ----------------------------------------------------------------------------

WALL = 'wall = Cube("wall"); wall.scale = (0.2, 30, 30); wall.translate(x={x}, z=-16); wall.static()'
POST = 'post = Cube("post"); post.scale = (0.3, 0.3, 6); post.translate(x=8.0, y={y}, z=-16); post.static()'


def test_a_wall_across_the_beam_is_white_at_its_range(measured):
    image = measured("ImagingSonar", more=WALL.format(x=10.2), gain=0.0, elevation=1.0)["image"]
    assert image.shape == (256, 512)
    row = int(10.0 / (30.0 / 256))
    middle = image[:, 250:262]
    assert (middle.argmax(axis=0) == row).all()
    assert middle.max() == int(255 * math.sqrt(0.5))  # the amplitude of half of the power


def test_equal_walls_look_equal_at_all_ranges(measured):
    """The gain by the range makes up for spreading and absorption."""
    near, far = (
        int(measured("ImagingSonar", more=WALL.format(x=x), gain=0.0, elevation=1.0)["image"][:, 256].max())
        for x in (6.2, 24.2)
    )
    assert near == pytest.approx(far, abs=2)


def test_there_is_a_shadow_behind_a_post(measured):
    image = measured("ImagingSonar", more=POST.format(y=0.0), pitch=0.3)["image"]
    row = int(7.7 / math.cos(0.3) / (30.0 / 256))
    column = image[:, 256].astype(int)
    beside = image[:, 400].astype(int)
    assert column[row - 12 : row + 12].max() > 60
    assert column[row + 40 : row + 100].max() == 0
    assert beside[row + 40 : row + 100].min() > 0


def test_the_leftmost_column_is_the_left_side(measured):
    image = measured("ImagingSonar", more=POST.format(y=4.0))["image"]
    azimuth = math.atan2(4.0, 8.0)
    expected = (math.radians(65.0) - azimuth) / math.radians(130.0) * 512
    column = image.max(axis=0).argmax()
    assert column == pytest.approx(expected, abs=15)


def test_speckle_has_a_rayleigh_distribution(measured):
    """The mean of the amplitudes is sqrt(pi) / 2 of their root mean square."""
    plain = measured("ImagingSonar", pitch=0.3)["image"].astype(float)
    image = measured("ImagingSonar", pitch=0.3, errors=True, noise=-200.0)["image"].astype(float)
    seen = (plain > 20.0) & (plain < 60.0)
    ratio = image[seen] / plain[seen]
    assert ratio.mean() == pytest.approx(math.sqrt(math.pi) / 2.0, rel=0.03)
    assert (ratio**2).mean() == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("sensor", ["ImagingSonar", "SideScanSonar", "MultibeamSonar", "EchoSounder", "DVL"])
@pytest.mark.parametrize("z", [-1000.0, 1e6])
def test_a_world_without_echoes_is_no_fault(measured, sensor, z):
    data = measured(sensor, z=z)
    if "image" in data:
        assert data["image"].max() == 0
    else:
        assert not np.isfinite(data.get("depth", data.get("altitude", math.inf)))


@pytest.mark.parametrize("sensor", ["ImagingSonar", "SideScanSonar", "MultibeamSonar", "EchoSounder", "DVL"])
def test_a_sensor_inside_of_an_object_is_no_fault(measured, sensor):
    measured(sensor, more='box = Cube("box"); box.scale = (3, 3, 3); box.translate(z=-16); box.static()')


def test_power_is_kept_when_echoes_are_spread():
    bins = np.array([[2], [5], [6], [9]])
    power = np.array([[3.0], [1.0], [2.0], [4.0]])
    cells = echoes_by_range(bins, power, np.array([[True], [True], [False]]), 9)
    assert cells[:, 0] == pytest.approx([0, 0, 1, 1, 1, 1, 2, 0, 0])  # 3 in three cells; the last ray has no echo


# -- side-scan and multibeam ------------------------------------------------------------------


def test_side_scan_has_a_water_column_and_shows_what_is_on_each_side(measured):
    stone = 'stone = Cube("stone"); stone.scale = (3, 0.5, 1.0); stone.translate(y=10.0, z=-19); stone.static()'
    image = measured("SideScanSonar", more=stone)["image"]
    row = image[-1].astype(int)
    cell = 50.0 / 256
    assert row[256 - int(3.9 / cell) : 256 + int(3.9 / cell)].max() == 0  # no echo nearer than the bottom
    assert row[256 + int(4.2 / cell)] > 50
    port, starboard = row[:256][::-1], row[256:]
    stone_at = int(math.hypot(9.5, 2.5) / cell)
    shadow = slice(int(12.6 / cell), int(15.0 / cell))
    assert port[stone_at - 3 : stone_at + 4].max() > 1.5 * starboard[stone_at]
    assert port[shadow].max() == 0
    assert starboard[shadow].min() > 0


def test_a_side_scan_keeps_its_newest_pings(load):
    simulation = load(SCENE.format(sensor="SideScanSonar", z=-16, properties="pings=5", more="", pitch=0.0))
    simulation.step(90)
    assert simulation.robot.sonar.data["image"].shape == (5, 512)


def test_a_multibeam_sonar_measures_a_flat_bottom(measured):
    data = measured("MultibeamSonar")
    assert data["points"][:, 2] == pytest.approx(np.full(256, -4.0), abs=1e-6)
    assert data["points"][0, 1] == pytest.approx(4.0 * math.tan(math.radians(60.0) * 255 / 256), rel=1e-6)


def test_rays_bend_to_where_sound_is_slower(measured):
    """Against Snell's law, integrated in small steps: with warm water above, outer beams reach the bottom nearer."""
    gradient, speed = -2.0, sound_speed(10.0, 35.0, 16.0)
    data = measured("MultibeamSonar", gradient=gradient)
    for beam in (0, 40, 100):
        angle = math.radians(60.0) * (1 - (2 * beam + 1) / 256)
        depth, time, steps = 0.0, 0.0, 20_000
        for _ in range(steps):
            depth += 4.0 / steps
            now = speed + gradient * (depth - 2.0 / steps)
            cosine = math.sin(angle) * now / speed  # of the grazing angle
            time += 4.0 / steps / math.sqrt(1.0 - cosine**2) / now
        assert data["ranges"][beam] == pytest.approx(time * speed, rel=2e-4)  # straight rays: 6e-3


# -- bits -------------------------------------------------------------------------------------


def sonar_scene():
    from morse.builder import (
        DVL,
        Cube,
        EchoSounder,
        Environment,
        ImagingSonar,
        MotionXYW,
        SideScanSonar,
        Submarine,
    )

    ground = Cube("ground")
    ground.scale = (50, 50, 0.5)
    ground.translate(z=-20.5)
    ground.static()
    robot = Submarine()
    robot.translate(z=-17.0)
    motion = MotionXYW()
    robot.append(motion)
    image, side, depth, log = ImagingSonar(), SideScanSonar(), EchoSounder(), DVL()
    for sensor in (image, side, depth, log):
        sensor.properties(errors=True)
        robot.append(sensor)
    image.properties(beams=64)
    image.rotate(y=0.3)
    Environment("empty", fastmode=True)


def bits(simulation):
    robot = simulation.robot
    images = robot.image.data["image"].tobytes(), robot.side.data["image"].tobytes()
    return *images, robot.depth.data["depth"], tuple(robot.log.data["velocity"])


def test_rows_and_restored_states_have_the_bits_of_the_simulation_alone():
    with morse.load(sonar_scene, seed=5, sockets=False) as alone:
        alone.robot.motion.publish({"x": 0.5, "y": 0.1, "w": 0.1})
        alone.step(30)
        state = alone.save()
        alone.step(30)
        expected = bits(alone)
        alone.restore(state)
        alone.step(30)
        assert bits(alone) == expected
    with morse.batch(sonar_scene, 2, seed=4) as many:
        many[1].robot.motion.publish({"x": 0.5, "y": 0.1, "w": 0.1})
        many.step(60)
        assert bits(many[1]) == expected
        assert bits(many[0]) != expected
