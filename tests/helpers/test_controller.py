import pytest

from morse.core.wheeled_robot import PIDController


def test_defaults():
    pid = PIDController()
    assert (pid.kp, pid.kd, pid.ki, pid.limits_integrator) == (1, 1, 1, 10)
    assert pid.setpoint == 0


def test_each_gain_alone():
    errors = (3.0, 1.0, 2.0)
    expected = {"kp": [6.0, 2.0, 4.0], "kd": [6.0, -4.0, 2.0], "ki": [6.0, 8.0, 12.0]}
    for gain, commands in expected.items():
        pid = PIDController(**{"kp": 0, "kd": 0, "ki": 0, gain: 2.0})
        assert [pid.update(-error) for error in errors] == commands


def test_the_sum_of_errors_is_limited_both_ways():
    pid = PIDController(0, 0, 1, 2.5)
    assert [pid.update(-1.0) for _ in range(4)] == [1.0, 2.0, 2.5, 2.5]
    assert [pid.update(4.0), pid.update(4.0)] == [-1.5, -2.5]


def test_a_jump_of_the_setpoint_starts_afresh():
    pid = PIDController(0, 0, 1)
    pid.update(-1.0)
    pid.setpoint = 0.1
    assert pid.update(0.1) == 1.0
    pid.setpoint = 0.3
    assert pid.update(0.3) == 0.0


def test_it_brings_an_integrator_to_its_setpoint():
    pid = PIDController(0.5, 0.1, 0.01)
    pid.setpoint = 2.0
    value = 0.0
    for _ in range(500):
        value += 0.2 * pid.update(value)
    assert value == pytest.approx(2.0, abs=1e-3)


def test_negative_limits_are_refused():
    with pytest.raises(ValueError, match="limits_integrator"):
        PIDController(limits_integrator=-1)
