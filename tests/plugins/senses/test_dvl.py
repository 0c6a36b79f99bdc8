"""The Doppler log measures the velocity of the body in its frame."""

import math

import numpy as np
import pytest

import morse
from morse.recording.recording import Recording
from morse.rosmsgs.cdr import decode

SCENE = """
ground = Cube("ground"); ground.scale = (200, 200, 0.5); ground.translate(z=-20.5); ground.static()
robot = Submarine()
robot.translate(z={z})
robot.rotate(0.0, {pitch}, 0.3)
motion = MotionXYW()
robot.append(motion)
log = DVL()
log.rotate(z={turn})
log.properties({properties})
robot.append(log)
{more}
Environment("empty", fastmode=True)
"""


def scene(z=-16.0, pitch=0.0, turn=0.0, more="", **properties):
    given = ", ".join(f"{name}={value!r}" for name, value in properties.items())
    return SCENE.format(z=z, pitch=pitch, turn=turn, properties=given, more=more)


@pytest.mark.parametrize("turn", [0.0, 0.8])
def test_velocity_and_altitude(load, turn):
    simulation = load(scene(turn=turn))
    simulation.robot.motion.publish({"x": 1.2, "y": -0.4, "w": 0.2})
    simulation.sleep(0.5)
    data = simulation.robot.log.get()
    # the axes of the sensor are turned to the left
    expected = (1.2 * math.cos(turn) - 0.4 * math.sin(turn), -1.2 * math.sin(turn) - 0.4 * math.cos(turn), 0.0)
    assert data["velocity"] == pytest.approx(expected, abs=1e-5)
    assert data["altitude"] == pytest.approx(4.0, abs=1e-6)
    assert (data["locked"], data["reference"]) == (True, "bottom")
    assert data["ranges"] == pytest.approx([4.0 / math.cos(math.radians(30.0))] * 4, abs=1e-6)


def test_the_altitude_is_vertical_when_the_sensor_leans(load):
    simulation = load(scene(pitch=0.2))
    simulation.step()
    data = simulation.robot.log.get()
    assert data["altitude"] == pytest.approx(4.0, abs=1e-6)
    assert max(data["ranges"]) - min(data["ranges"]) > 0.5


@pytest.mark.parametrize(("z", "limit"), [(-16.0, {"max_altitude": 3.0}), (-19.9, {"min_altitude": 0.3})])
def test_there_is_no_lock_beyond_the_range(load, z, limit):
    simulation = load(scene(z=z, **limit))
    simulation.step()
    data = simulation.robot.log.get()
    assert (data["locked"], data["reference"], data["altitude"]) == (False, "none", math.inf)
    assert np.isnan(data["velocity"]).all()


def test_three_beams_suffice(load):
    """A pit below one of the beams."""
    simulation = load(
        scene().replace(
            "ground.scale = (200, 200, 0.5); ground.translate(z=-20.5)",
            ("ground.scale = (50, 50, 0.5); ground.translate(x=-48.5, z=-20.5); ground.rotate(z=0.0)"),
        )
    )
    simulation.robot.motion.publish({"x": 0.1, "y": 0.0, "w": 0.0})
    simulation.sleep(0.2)
    data = simulation.robot.log.get()
    good = np.isfinite(data["ranges"])
    assert good.sum() == 3
    assert data["velocity"] == pytest.approx((0.1, 0.0, 0.0), abs=1e-5)


def test_the_lock_to_the_water_measures_the_current(load):
    simulation = load(scene(z=-10.0, max_altitude=3.0, water_track=True, current_x=0.5, current_y=0.0))
    simulation.step()
    data = simulation.robot.log.get()
    assert (data["locked"], data["reference"]) == (True, "water")
    # the robot is turned by 0.3 rad, and at rest
    assert data["velocity"] == pytest.approx((-0.5 * math.cos(0.3), 0.5 * math.sin(0.3), 0.0), abs=1e-6)


def test_the_errors_are_those_of_the_data_sheet(load):
    simulation = load(scene(errors=True, scale_error=0.01, noise=0.002))
    simulation.robot.motion.publish({"x": 1.0, "y": 0.0, "w": 0.0})
    simulation.sleep(0.5)
    speeds = []
    for _ in range(200):
        simulation.step(6)
        speeds.append(simulation.robot.log.data["velocity"][0])
    assert np.mean(speeds) == pytest.approx(1.01, abs=1e-3)
    # each beam sees sin 30° sqrt(0.5) of the velocity along X
    assert np.std(speeds) == pytest.approx(0.002 / (2 * math.sin(math.radians(30)) * math.sqrt(0.5)), rel=0.2)


def test_the_message_is_that_of_marine_acoustic_msgs(tmp_path):
    file = tmp_path / "log.mcap"

    def build():
        from morse.builder import DVL, Cube, Environment, Submarine

        ground = Cube("ground")
        ground.scale = (50, 50, 0.5)
        ground.static()
        robot = Submarine()
        robot.translate(z=5.0)
        log = DVL()
        robot.append(log)
        Environment("empty", fastmode=True)

    with morse.load(build, sockets=False, record=str(file)) as simulation:
        simulation.step(20)
        data = simulation.robot.log.data
    with Recording(file) as recording:
        channel = {one.topic: one for one in recording.channels.values()}["/robot/log"]
        assert channel.type == "marine_acoustic_msgs/msg/Dvl"
        message = decode(channel.type, bytes(list(recording.messages({channel.number}))[-1].data))
    assert message["altitude"] == pytest.approx(data["altitude"])
    assert message["num_good_beams"] == 4
    assert message["sound_speed"] == pytest.approx(1490.0, abs=2.0)  # Mackenzie at 10 °C, 35 parts per thousand
    assert [beam["z"] for beam in message["beam_unit_vec"]] == pytest.approx([-math.cos(math.radians(30.0))] * 4)
