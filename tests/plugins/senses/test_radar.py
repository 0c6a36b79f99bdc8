"""The radar against formulas of the field, and on its way through the simulator."""

import json
import math

import numpy as np
import pytest

import morse
from morse.plugins.senses.sensors.radar import LIGHT, doppler_shift, trihedral
from morse.recording.recording import Recording
from morse.rosmsgs.cdr import decode

SCENE = """
robot = ATRV()
robot.translate(z=0.2)
motion = MotionVW()
robot.append(motion)
radar = Radar()
radar.translate(x=0.0, z=0.8)
radar.properties({properties})
robot.append(radar)
{objects}
Environment("empty", fastmode=True)
"""
CORNER = 'c = Empty("corner"); c.translate({x}, {y}, 1.0); c.properties({what})'


def scene(*objects: str, **properties: object) -> str:
    """The radar sees no ground within its range, unless a test says otherwise."""
    properties = {"elevation_fov": 2.0, **properties}
    given = ", ".join(f"{name}={value!r}" for name, value in properties.items())
    return SCENE.format(properties=given, objects="\n".join(objects))


def corner(x: float, y: float = 0.0, what: str = "radar_cross_section=10.0") -> str:
    return CORNER.format(x=x, y=y, what=what)


def strongest(simulation):
    return simulation.robot.radar.get()["detections"][0]


def test_the_published_doppler_shift_of_77_ghz():
    assert doppler_shift(-10.0, 77e9) == pytest.approx(5137, abs=0.5)


def test_a_trihedral_corner_has_the_cross_section_of_the_formula(load):
    simulation = load(scene(corner(20.0, 5.0, "radar_corner=0.2")))
    simulation.step()
    found = strongest(simulation)
    assert found["rcs"] == pytest.approx(4 * math.pi * 0.2**4 / (3 * (LIGHT / 77e9) ** 2), rel=1e-6)
    assert found["rcs"] == pytest.approx(trihedral(0.2, 77e9), rel=1e-6)
    assert found["range"] == pytest.approx(math.hypot(20.0, 5.0), abs=1e-3)
    assert found["azimuth"] == pytest.approx(math.atan2(5.0, 20.0), abs=1e-3)
    assert found["velocity"] == pytest.approx(0.0, abs=0.01)  # the robot still comes to rest


def test_the_power_of_an_echo_falls_with_the_fourth_power_of_the_distance(load):
    size = LIGHT / 2 / 96e6
    near, far = (10 + 0.5) * size, (30 + 0.5) * size  # in the middle of a cell
    peaks = []
    for distance in (near, far):
        simulation = load(scene(corner(distance)))
        simulation.step()
        image = simulation.robot.radar.get()["map"]
        peaks.append(10.0 ** (float(image.max()) / 10.0) - 1.0)
    assert peaks[0] / peaks[1] == pytest.approx((far / near) ** 4, rel=0.01)


@pytest.mark.parametrize(("bandwidth", "apart"), [(96e6, True), (30e6, False)])
def test_two_targets_are_told_apart_if_they_differ_by_a_range_cell(load, bandwidth, apart):
    """c / 2 B is 1.56 m for 96 MHz and 5 m for 30 MHz; the targets are 3.2 m apart."""
    other = corner(24.2).replace('"corner"', '"other"')
    simulation = load(scene(corner(21.0), other, bandwidth=bandwidth, range_bins=64))
    simulation.step()
    distances = {round(one["range"], 3) for one in simulation.robot.radar.get()["detections"] if one["rcs"] > 5.0}
    assert (distances == {21.0, 24.2}) is apart


def test_a_target_ahead_of_a_moving_robot_approaches(load):
    simulation = load(scene(corner(40.0)))
    simulation.robot.motion.publish({"v": 8.0, "w": 0.0})
    simulation.sleep(0.5)
    assert strongest(simulation)["velocity"] == pytest.approx(-8.0, abs=1e-3)
    image = simulation.robot.radar.get()["map"]
    column = int(np.unravel_index(image.argmax(), image.shape)[1])
    assert column == round((-8.0 + 50.0) / (100.0 / 128))


def test_a_velocity_beyond_the_largest_one_is_ambiguous(load):
    simulation = load(scene(corner(40.0), max_velocity=5.0))
    simulation.robot.motion.publish({"v": 6.0, "w": 0.0})
    simulation.sleep(0.5)
    assert strongest(simulation)["velocity"] == pytest.approx(10.0 - 6.0, abs=1e-3)


def test_a_sphere_has_the_cross_section_of_geometrical_optics_and_of_lambert(load):
    """Pi a² (1 + s²) of a mirror with slopes of the deviation s, to the first order, and 8 pi a² / 3 of a white one."""
    ball = """
ball = Sphere("ball"); ball.translate(30.0, 0.0, 1.0); ball.static(); ball.properties(radar_reflectivity=1.0)
"""
    simulation = load(scene(ball, ray_spacing=0.2, azimuth_fov=6.0, elevation_fov=6.0))
    simulation.step()
    sensor = simulation.context.components["robot.radar"]
    echoes = sensor._surfaces(sensor.scan())
    on_ball = echoes[(echoes[:, 0] > 28.5) & (echoes[:, 0] < 30.5)]
    rough, slope = 0.6, 0.3
    expected = math.pi * ((1 - rough) * (1 + slope**2) + rough * 8 / 3)
    assert on_ball[:, 4].sum() == pytest.approx(expected, rel=0.1)


def test_an_object_hides_what_is_behind_it(load):
    wall = 'wall = Cube("wall"); wall.scale = (0.1, 3.0, 3.0); wall.translate(15.0, 0, 1); wall.static()'
    simulation = load(scene(corner(30.0, what="radar_corner=1.0"), wall))
    simulation.step()
    assert all(one["range"] < 20.0 for one in simulation.robot.radar.get()["detections"])


def test_an_empty_world_has_no_echo(load):
    simulation = load(scene())
    simulation.step()
    data = simulation.robot.radar.get()
    assert data["detections"] == []
    assert data["map"].shape == (64, 128)
    assert data["map"].max() == 0.0  # the mean of the noise


@pytest.mark.parametrize("value", ["'much'", "1e300", "-5.0", "True", "0"])
def test_properties_of_objects_may_be_anything(load, value):
    simulation = load(scene(corner(20.0, what=f"radar_cross_section={value}, radar_reflectivity={value}")))
    simulation.step(3)
    assert simulation.failures == ()
    for one in simulation.robot.radar.get()["detections"]:
        assert all(math.isfinite(number) for number in one.values())


def test_a_radar_inside_an_object_goes_on(load):
    box = 'box = Cube("box"); box.scale = (9, 9, 9); box.static()'
    simulation = load(scene(box, corner(0.0)))
    simulation.step(3)
    assert simulation.failures == ()
    assert np.isfinite(simulation.robot.radar.get()["map"]).all()


def test_the_noise_of_a_cell_is_exponential(load):
    simulation = load(scene(errors=True))
    simulation.step()
    power = 10.0 ** (np.asarray(simulation.robot.radar.get()["map"], dtype=np.float64) / 10.0)
    assert power.mean() == pytest.approx(1.0, abs=0.05)
    assert power.std() == pytest.approx(1.0, abs=0.08)


def noisy_scene():
    from morse.builder import ATRV, ARS408, Cube, Empty, Environment, MotionVW  # noqa: I001 (names of a scene)

    robot = ATRV()
    motion = MotionVW()
    robot.append(motion)
    radar = ARS408()
    radar.translate(z=1.0)
    radar.frequency(20)
    robot.append(radar)
    thing = Empty("thing")
    thing.translate(60.0, 0.5, 1.0)
    thing.properties(radar_corner=0.3)
    wall = Cube("wall")
    wall.translate(30.0, 3.0, 1.0)
    wall.static()
    Environment("empty", fastmode=True)


def data_of(simulation):
    data = simulation.robot.radar.get()
    return json.dumps(data["detections"]), data["map"].tobytes()


def test_a_row_of_a_batch_and_a_restored_state_have_the_bits_of_the_simulation_alone():
    with morse.load(noisy_scene, seed=5, sockets=False) as alone:
        alone.robot.motion.publish({"v": 3.0, "w": 0.1})
        alone.step(10)
        state = alone.save()
        alone.step(20)
        expected = data_of(alone)
        alone.restore(state)
        alone.step(20)
        assert data_of(alone) == expected
    with morse.batch(noisy_scene, 2, seed=4) as many:
        assert list(many.seeds) == [4, 5]
        many[1].robot.motion.publish({"v": 3.0, "w": 0.1})
        many.step(30)
        assert data_of(many[1]) == expected
        assert data_of(many[0]) != expected


def test_returns_are_recorded_as_messages_of_radar_msgs(tmp_path):
    file = tmp_path / "radar.mcap"
    with morse.load(noisy_scene, seed=5, sockets=False, record=str(file)) as simulation:
        simulation.step(30)
        last = simulation.robot.radar.get()["detections"]
    with Recording(file) as recording:
        channels = {one.topic: one for one in recording.channels.values()}
        channel = channels["/robot/radar"]
        assert channel.type == "radar_msgs/msg/RadarScan"
        message = list(recording.messages({channel.number}))[-1]
    returns = decode("radar_msgs/msg/RadarScan", bytes(message.data))["returns"]
    assert [one["range"] for one in returns] == pytest.approx([one["range"] for one in last], rel=1e-6)
    assert returns[0]["amplitude"] == pytest.approx(10 * math.log10(last[0]["rcs"]), rel=1e-6)


@pytest.mark.parametrize(("carrier", "rate"), [(77e9, 50.0), (24e9, 100.0), (10e9, 5.0)])
def test_rain_weakens_an_echo_there_and_back(load, carrier, rate):
    """By ITU-R P.838-3, twice the attenuation of one way; a receiver takes the target for a smaller one."""
    text = scene(corner(90.0), carrier=carrier).replace("Environment(", "env = Environment(")
    simulation = load(text + f"env.weather(rain={rate})\n")
    simulation.step()
    found = strongest(simulation)
    k, alpha = {77e9: (1.1320, 0.7177), 24e9: (0.1425, 1.0101), 10e9: (0.01217, 1.2571)}[carrier]
    lost = 2.0 * k * rate**alpha * found["range"] / 1000.0
    assert found["rcs"] == pytest.approx(10.0 * 10.0 ** (-lost / 10.0), rel=2e-3)


@pytest.mark.parametrize(("carrier", "distance"), [(24e9, 60.0), (77e9, 90.0)])
def test_the_ground_makes_lobes_of_two_ray_interference(load, carrier, distance):
    """There and back, the power is 16 sin⁴(2π h_t h_r / λ d) of that in free space, unless a kerb hides the ground."""
    radar_height, wave = 0.9, LIGHT / carrier
    heights = np.linspace(0.25, 1.6, 9)
    lines, angles = [], np.radians(np.linspace(-32.0, 32.0, len(heights)))
    for number, (height, angle) in enumerate(zip(heights.tolist(), angles.tolist(), strict=True)):
        x, y = distance * math.cos(angle), distance * math.sin(angle)
        lines.append(f'c = Empty("c{number}"); c.translate({x}, {y}, {height}); c.properties(radar_cross_section=1e4)')
    # between the radar and where the wave to the last target meets the ground, but below the direct way
    bounce = distance * radar_height / (radar_height + heights[-1])
    x, y = 0.97 * bounce * math.cos(angles[-1]), 0.97 * bounce * math.sin(angles[-1])
    lines.append(f'w = Cube("kerb"); w.scale = (0.2, 0.2, 0.1); w.translate({x}, {y}, 0.1); w.static()')
    scene = f"""
robot = FakeRobot()
robot.translate(z={radar_height})
radar = Radar()
radar.properties(carrier={carrier}, ground_reflection={{share}}, elevation_fov=6.0)
robot.append(radar)
ground = Cube("ground")
ground.scale = (200.0, 200.0, 0.5)
ground.translate(z=-0.5)
ground.static()
{chr(10).join(lines)}
Environment("empty", fastmode=True)
"""
    simulation = load(scene.format(share=1.0))
    simulation.step()
    # the strongest in each direction: the ground itself is weak
    detections = reversed(simulation.robot.radar.get()["detections"])
    found = {round(math.degrees(one["azimuth"])): one["rcs"] for one in detections}
    expected = 16.0 * np.sin(2.0 * math.pi * heights * radar_height / (wave * distance)) ** 4
    expected[-1] = 1.0
    assert expected[:-1].min() < 1.0 < 8.0 < expected[:-1].max()
    for angle, factor in zip(np.degrees(angles), expected, strict=True):
        if factor > 0.05:
            assert found[round(angle)] / 1e4 == pytest.approx(factor, rel=0.03, abs=0.02)
    simulation = load(scene.format(share=0.0))
    simulation.step()
    plain = [one["rcs"] for one in simulation.robot.radar.get()["detections"] if one["rcs"] > 5e3]
    assert plain == pytest.approx([1e4] * len(heights), rel=1e-3)
