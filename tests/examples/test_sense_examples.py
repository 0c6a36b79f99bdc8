"""What a submarine, a car and a robot do by the sensors of the examples."""

import runpy
from pathlib import Path

import pytest

pytestmark = pytest.mark.long
FOLDER = Path(__file__).parents[2] / "examples" / "senses"


def run(name):
    return runpy.run_path(str(FOLDER / name))["main"]()


def test_a_submarine_keeps_its_height():
    worst, way, passed = run("keep_altitude.py")
    assert worst < 0.25
    assert passed > 30.0
    assert way == pytest.approx(passed, rel=0.01)


def test_a_robot_dodges_a_ball():
    main = runpy.run_path(str(FOLDER / "dodge_a_ball.py"))["main"]
    assert main(dodges=False) < 0.3
    assert main() > 0.6


def test_a_robot_finds_a_leak():
    distance, seconds = run("find_plume.py")
    assert distance < 1.5
    assert seconds < 120.0


def test_a_car_stops_before_a_parked_car_and_not_at_the_sign():
    gap, at_sign, at_hit = run("brake_by_radar.py")
    assert at_sign == 12.0
    assert 2.0 < gap < 7.0
    # the lidar sees the parked car 11.2 m ahead: sqrt(v^2 - 2 b s) is left
    assert at_hit == pytest.approx((12.0**2 - 2.0 * 5.0 * 11.2) ** 0.5, abs=1.5)
