"""Phase, delay and noise of sensors."""

import itertools
import math

import numpy as np
import pytest
from messages import published

SCRIPT = """
robot = FakeRobot()
robot.translate(1.0, 2.0, 3.0)
{extra}
pose = Pose()
pose.frequency(10)
{setting}
robot.append(pose)
laser = Sick()
{laser}
robot.append(laser)
wall = Cube("Wall")
wall.scale = (0.1, 40, 20)
wall.location = (6.1, 0, 0)
wall._bpy_object.game.physics_type = "STATIC"
env = Environment("empty", fastmode=True)
"""


def scene(setting="", laser="", extra=""):
    return SCRIPT.format(setting=setting, laser=laser, extra=extra)


def messages(simulate, name, seconds=2.0, seed=None, **parts):
    simulation = simulate(scene(**parts), seed=seed, sockets=False)
    collected = published(simulation.context.component(name))
    simulation.sleep(seconds)
    return collected


# -- times ---------------------------------------------------------------------------------


def test_an_ideal_sensor_measures_at_once(simulate):
    times = [m["timestamp"] for m in messages(simulate, "robot.pose", 1.0)]
    assert times == pytest.approx([0.1 * i + 1 / 60 for i in range(10)])


def test_a_phase_moves_all_measurements(simulate):
    times = [m["timestamp"] for m in messages(simulate, "robot.pose", 1.0, setting="pose.phase(0.25)")]
    assert times == pytest.approx([0.25 + 0.1 * i + 1 / 60 for i in range(8)])


@pytest.mark.parametrize("delay", [0.05, 0.1, 0.25, 0.004])
def test_delayed_data_are_published_when_their_time_has_come(simulate, delay):
    simulation = simulate(scene(setting=f"pose.delay({delay})"), sockets=False)
    arrivals = []
    pose = simulation.context.component("robot.pose")
    pose.output_functions.append(lambda s: arrivals.append((s.local_data["timestamp"], simulation.time())))
    simulation.sleep(1.0)
    assert [taken for taken, _ in arrivals] == pytest.approx([0.1 * i + 1 / 60 for i in range(len(arrivals))])
    for taken, seen in arrivals:
        assert delay - 1e-9 <= seen - taken < delay + 1 / 60
    assert len(arrivals) == math.floor((1.0 - 1 / 60 - delay) / 0.1 + 1e-9) + 1


def test_nobody_sees_delayed_data_early(simulate):
    simulation = simulate(scene(setting="pose.delay(0.5)"), sockets=False)
    pose = simulation.context.component("robot.pose")
    simulation.sleep(0.4)
    assert pose.local_data["timestamp"] == pose.local_data["x"] == 0.0
    simulation.context.component("robot").bge_object.worldPosition = [9.0, 2.0, 3.0]
    simulation.sleep(0.2)
    assert pose.get_local_data()["x"] == pytest.approx(1.0)
    simulation.sleep(0.5)
    assert pose.get_local_data()["x"] == pytest.approx(9.0)


def test_modifiers_work_on_the_measurement_not_on_its_arrival(simulate):
    simulation = simulate(scene(setting="pose.delay(0.3)"), sockets=False)
    pose = simulation.context.component("robot.pose")

    class Shift:
        def modify(self):
            pose.local_data["x"] += 100.0

    pose.output_modifiers.append(Shift())
    seen = published(pose)
    simulation.sleep(1.0)
    assert {round(m["x"], 6) for m in seen} == {101.0}


# -- errors --------------------------------------------------------------------------------


def test_white_noise_has_the_deviation_asked_for(simulate):
    seen = messages(simulate, "robot.pose", 100.0, setting="pose.noise(gaussian=0.1, field='x')")
    errors = np.array([m["x"] for m in seen]) - 1.0
    assert len(errors) == 1000
    # five standard errors of mean and standard deviation
    assert abs(errors.mean()) < 5 * 0.1 / math.sqrt(1000)
    assert errors.std() == pytest.approx(0.1, abs=5 * 0.1 / math.sqrt(2000))
    assert abs(np.corrcoef(errors[1:], errors[:-1])[0, 1]) < 5 / math.sqrt(1000)
    assert {m["y"] for m in seen} == {2.0}


def test_noise_without_a_field_is_in_every_number_but_the_time_stamp(simulate):
    seen = messages(simulate, "robot.pose", 2.0, setting="pose.noise(gaussian=0.1)")
    for name in ("x", "y", "z", "roll", "pitch", "yaw"):
        assert len({m[name] for m in seen}) == len(seen)
    assert [m["timestamp"] for m in seen] == pytest.approx([0.1 * i + 1 / 60 for i in range(20)])


def test_the_bias_walks_with_the_root_of_time(simulate):
    setting = "pose.noise(bias_walk=0.2)"
    walks = []
    for seed in range(3):
        seen = messages(simulate, "robot.pose", 60.0, seed=seed, setting=setting)
        walks += [np.array([m[name] for m in seen]) for name in ("x", "y", "z")]
        walks += [np.unwrap([m[name] for m in seen]) for name in ("roll", "pitch", "yaw")]
    steps = np.concatenate([np.diff(walk) for walk in walks])
    expected = 0.2 * math.sqrt(0.1)
    assert steps.std() == pytest.approx(expected, abs=5 * expected / math.sqrt(2 * len(steps)))
    assert abs(np.corrcoef(steps[1:], steps[:-1])[0, 1]) < 5 / math.sqrt(len(steps))
    assert all(abs(walk[0] - start) < 1e-9 for walk, start in zip(walks, [1, 2, 3, 0, 0, 0] * 3, strict=True))


def test_quantized_values_are_multiples(simulate):
    seen = messages(simulate, "robot.pose", 2.0, setting="pose.noise(gaussian=0.3, quantization=0.25)")
    values = np.array([[m["x"], m["y"], m["z"]] for m in seen])
    assert np.abs(values / 0.25 - np.round(values / 0.25)).max() < 1e-9
    assert len(np.unique(values)) > 3


def test_a_lost_value_stays_as_it_was(simulate):
    simulation = simulate(scene(setting="pose.noise(dropout=0.5, field='x')"), sockets=False)
    robot, seen = simulation.context.component("robot"), published(simulation.context.component("robot.pose"))
    places = []

    for _ in range(3000):
        simulation.step()
        places.append(robot.bge_object.worldPosition.x)
        robot.bge_object.worldPosition = [places[-1] + 0.01, 2.0, 3.0]
    values = [m["x"] for m in seen]
    kept = sum(a == b for a, b in itertools.pairwise(values))
    assert abs(kept / (len(values) - 1) - 0.5) < 5 * 0.5 / math.sqrt(len(values))
    fresh = [b for a, b in itertools.pairwise(values) if a != b]
    assert fresh == pytest.approx([p for p in places if any(abs(p - f) < 1e-9 for f in fresh)])


def test_noise_does_not_add_up_in_sensors_that_add_up(simulate):
    """The integrated odometry of a robot at rest: its errors do not grow."""
    extra = "odometry = Odometry()\nodometry.noise(gaussian=0.1)\nrobot.append(odometry)"
    simulation = simulate(scene(extra=extra), sockets=False)
    seen = published(simulation.context.component("robot.odometry"))
    simulation.sleep(20.0)
    errors = np.array([m["x"] for m in seen])
    assert errors[-200:].std() == pytest.approx(0.1, abs=0.03)
    assert abs(errors[-200:].mean()) < 0.05


# -- of scanners ---------------------------------------------------------------------------


def test_noise_of_a_scanner_is_along_its_beams(simulate):
    seen = messages(simulate, "robot.laser", 5.0, laser="laser.noise(gaussian=0.02)")
    angles = np.radians(np.arange(181) - 90)
    truth = np.array([min(5.0 / max(c, 1e-9), 30.0) for c in np.cos(angles)])
    hits = truth < 29.9
    ranges = np.array([m["range_list"] for m in seen])
    points = np.array([m["point_list"] for m in seen])
    errors = (ranges - truth)[:, hits]
    assert errors.std() == pytest.approx(0.02, abs=5 * 0.02 / math.sqrt(2 * errors.size))
    assert np.abs(np.linalg.norm(points, axis=2)[:, hits] - ranges[:, hits]).max() < 1e-9
    assert (ranges[:, ~hits] == 30.0).all()
    assert (points[:, ~hits] == 0.0).all()


def test_lost_beams_have_no_echo(simulate):
    seen = messages(simulate, "robot.laser", 5.0, laser="laser.level('rssi'); laser.noise(dropout=0.2)")
    ranges = np.array([m["range_list"] for m in seen])[:, 30:151]
    lost = ranges == 30.0
    assert lost.mean() == pytest.approx(0.2, abs=5 * 0.4 / math.sqrt(lost.size))
    points = np.array([m["point_list"] for m in seen])[:, 30:151]
    remissions = np.array([m["remission_list"] for m in seen])[:, 30:151]
    assert ((points == 0.0).all(axis=2) == lost).all()
    assert ((remissions == 0.0) == lost).all()


def test_the_bias_of_a_scanner_is_that_of_all_its_beams(simulate):
    seen = messages(simulate, "robot.laser", 5.0, laser="laser.noise(bias_walk=0.1)")
    ranges = np.array([m["range_list"] for m in seen])[:, 30:151]
    biases = ranges - ranges[0]
    assert np.abs(biases - biases[:, :1]).max() < 1e-9
    assert len(np.unique(biases[:, 0])) == len(seen)


# -- repeatable ----------------------------------------------------------------------------

NOISY = "pose.noise(gaussian=0.1, bias_walk=0.1, dropout=0.1)"


def xs(simulate, **options):
    return [m["x"] for m in messages(simulate, "robot.pose", 2.0, setting=NOISY, **options)]


def test_the_same_seed_gives_the_same_noise(simulate):
    assert xs(simulate, seed=5) == xs(simulate, seed=5)
    assert xs(simulate, seed=5) != xs(simulate, seed=6)


def test_another_robot_changes_no_noise(simulate):
    extra = (
        "other = FakeRobot()\nother.translate(50, 0, 0)\n"
        "extra_pose = Pose()\nextra_pose.noise(gaussian=1.0)\nother.append(extra_pose)"
    )
    assert xs(simulate, seed=5) == xs(simulate, seed=5, extra=extra)


def test_a_restart_gives_the_numbers_of_a_new_simulation(simulate):
    simulation = simulate(scene(setting=NOISY + "; pose.delay(0.1)"), seed=5, sockets=False)
    first = published(simulation.context.component("robot.pose"))
    simulation.sleep(1.0)
    simulation.restart(5)
    second = published(simulation.context.component("robot.pose"))
    simulation.sleep(1.0)
    assert first == second
    simulation.restart(6)
    third = published(simulation.context.component("robot.pose"))
    simulation.sleep(1.0)
    assert first != third


# -- what is refused -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("pose.delay(-0.1)", r"Pose.delay\(seconds\) takes a number of at least 0, got -0.1"),
        ("pose.delay(math.nan)", r"Pose.delay\(seconds\) takes a finite number"),
        ("pose.delay('soon')", r"Pose.delay\(seconds\) takes a number, got 'soon'"),
        ("pose.phase(-1)", r"Pose.phase\(seconds\)"),
        ("pose.phase(math.inf)", r"Pose.phase\(seconds\)"),
        ("pose.noise(gaussian=-0.1)", r"Pose.noise\(gaussian\)"),
        ("pose.noise(bias_walk=math.nan)", r"Pose.noise\(bias_walk\)"),
        ("pose.noise(quantization='fine')", r"Pose.noise\(quantization\)"),
        ("pose.noise(dropout=1.5)", r"Pose.noise\(dropout\) takes a probability from 0 to 1"),
        ("pose.noise(gaussian=1, field='jaw')", r"no data field 'jaw'; did you mean 'yaw'"),
        (
            "Sick().noise(gaussian=1, field='point_list')",
            r"'point_list' is computed from 'range_list', which can have noise",
        ),
        ("pose.noise(gaussian=1, field='timestamp')", r"'timestamp' is not a measured number"),
        ("pose.frequency(-1)", r"frequency"),
        ("pose.frequency(math.nan)", r"frequency"),
    ],
)
def test_bad_settings_are_refused_with_the_line(simulate, setting, message):
    with pytest.raises(Exception, match=message) as caught:
        simulate(scene(setting=setting), sockets=False)
    line = scene(setting=setting).splitlines().index(setting) + 2
    assert f"scene0.py:{line}" in str(caught.value)
