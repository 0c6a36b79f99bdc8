"""IMUs with the errors of their data sheets."""

import math

import numpy as np
import pytest
from messages import published

from morse.core.kinds import bind

SCRIPT = """
robot = FakeRobot()
imu = {kind}()
{setting}
robot.append(imu)
env = Environment("empty", fastmode=True)
"""


def at_rest(simulate, kind="IMU", setting="", seconds=20.0, seed=None):
    simulation = simulate(SCRIPT.format(kind=kind, setting=setting), seed=seed, sockets=False)
    messages = published(simulation.context.component("robot.imu"))
    simulation.sleep(seconds)
    fields = ("angular_velocity", "linear_acceleration")
    return simulation, [np.array([message[field] for message in messages]) for field in fields]


@pytest.mark.parametrize(
    # data sheets: deg/s/√Hz, and µg/√Hz along X, Y and Z
    ("kind", "degrees", "micro_g"),
    [("ADIS16448", 0.0135, (230.0,) * 3), ("BMI088", 0.014, (160.0, 160.0, 190.0)), ("VN100", 0.0035, (140.0,) * 3)],
)
def test_real_devices(simulate, kind, degrees, micro_g):
    simulation, (gyro, force) = at_rest(simulate, kind, seconds=40.0)
    # white noise of a given density, sixty times per second; biases hardly change within seconds
    turning, pushing = (np.diff(values, axis=0).std(axis=0) / math.sqrt(120) for values in (gyro, force))
    assert turning == pytest.approx([math.radians(degrees)] * 3, rel=0.06)
    assert pushing == pytest.approx(np.array(micro_g) * 9.80665e-6, rel=0.06)
    assert force.mean(axis=0) == pytest.approx([0.0, 0.0, 9.81], abs=0.03)
    message = bind(simulation.context.component("robot.imu"))[0].gather()
    white = np.diag(message.linear_acceleration_covariance)
    assert white[2] / white[0] == pytest.approx((micro_g[2] / micro_g[0]) ** 2, rel=0.1)


def test_an_ideal_one(simulate):
    simulation, (gyro, force) = at_rest(simulate, seconds=0.5)
    assert not gyro.any()
    assert force == pytest.approx(np.tile([0.0, 0.0, 9.81], (len(force), 1)))
    assert bind(simulation.context.component("robot.imu"))[0].gather().angular_velocity_covariance is None


def test_the_same_seed_gives_the_same_errors(simulate):
    runs = [at_rest(simulate, "BMI088", seconds=0.5, seed=seed)[1][0] for seed in (1, 1, 2)]
    assert np.array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


def test_the_message_says_how_large_they_are(simulate):
    setting = "imu.properties(GyroNoiseDensity=1e-3, AccelNoiseDensity=2e-3)"
    message = bind(at_rest(simulate, setting=setting, seconds=0.1)[0].context.component("robot.imu"))[0].gather()
    assert message.angular_velocity_covariance == pytest.approx(np.eye(3) * 60e-6)
    assert message.linear_acceleration_covariance == pytest.approx(np.eye(3) * 240e-6)


def test_errors_go_on_from_a_saved_state(simulate):
    simulation, _ = at_rest(simulate, "ADIS16448", seconds=0.5)
    state = simulation.save()
    simulation.sleep(0.2)
    first = list(simulation.context.component("robot.imu").local_data["angular_velocity"])
    simulation.restore(state)
    simulation.sleep(0.2)
    assert simulation.context.component("robot.imu").local_data["angular_velocity"] == first


def test_another_noise_while_it_runs(simulate):
    simulation, _ = at_rest(simulate, seconds=0.1)
    simulation.context.component("robot.imu").set_property("GyroNoiseDensity", 0.1)
    simulation.sleep(0.1)
    assert any(simulation.context.component("robot.imu").local_data["angular_velocity"])


@pytest.mark.parametrize("setting", ["GyroNoiseDensity=-1.0", "AccelBiasInstability='low'", "BiasCorrelationTime=0.0"])
def test_what_is_no_noise(simulate, setting):
    with pytest.raises(Exception, match=f"'{setting.split('=')[0]}' of IMU is"):
        at_rest(simulate, setting=f"imu.properties({setting})")
