"""Modifiers that add noise: mean and standard deviation over many measurements, and paths in closed form."""

import math
import statistics
from collections.abc import Callable
from typing import Any

import pytest

import morse
from morse.builder import Environment, FakeRobot, MotionVW, Odometry, Pose
from morse.core.exceptions import MorseError

COUNT = 2000


def with_pose(**options: Any) -> Callable[[], None]:
    """A scene with a noisy pose sensor."""

    def scene() -> None:
        robot = FakeRobot()
        robot.translate(1.0, 2.0, 3.0)
        pose = Pose()
        pose.alter("Noise", **options)
        robot.append(pose)
        Environment("empty", fastmode=True)

    return scene


def measured(scene: Callable[[], None], field: str, seed: int = 1) -> list[float]:
    """Many measurements of a field."""
    with morse.load(scene, seed=seed) as sim:
        return [sim.robot.pose.get()[field] for _ in range(COUNT)]


@pytest.mark.parametrize(
    ("field", "true", "deviation"), [("x", 1.0, 0.05), ("z", 3.0, 0.05), ("yaw", 0.0, math.radians(5.0))]
)
def test_the_noise_has_the_deviations_of_the_specification(field: str, true: float, deviation: float) -> None:
    values = measured(with_pose(), field)
    # four standard errors of the mean, and of the standard deviation, of that many values
    assert statistics.fmean(values) == pytest.approx(true, abs=4 * deviation / COUNT**0.5)
    assert statistics.stdev(values) == pytest.approx(deviation, rel=4 / (2 * COUNT) ** 0.5)


def test_axes_that_are_not_named_have_no_noise() -> None:
    scene = with_pose(pos_std={"y": 0.5}, rot_std=0.0)
    assert set(measured(scene, "x")) == {1.0}
    assert statistics.stdev(measured(scene, "y")) == pytest.approx(0.5, rel=0.1)


def test_flat_noise_leaves_roll_and_pitch() -> None:
    scene = with_pose(_2D=True)
    assert len(set(measured(scene, "roll"))) == 1
    assert len(set(measured(scene, "yaw"))) > COUNT / 2


def test_angles_stay_angles() -> None:
    values = measured(with_pose(rot_std=3.0), "yaw")
    assert max(map(abs, values)) <= math.pi
    assert max(values) > 3.0


def test_the_seed_determines_the_noise() -> None:
    scene = with_pose()
    assert measured(scene, "x", 5) == measured(scene, "x", 5)
    assert measured(scene, "x", 5) != measured(scene, "x", 6)


@pytest.mark.parametrize(
    "options", [{"pos_std": -1.0}, {"pos_std": {"q": 1.0}}, {"pos_std": "much"}, {"rot_std": math.inf}]
)
def test_deviations_that_are_none_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(MorseError, match=next(iter(options))):
        morse.load(with_pose(**options))


# -- odometry --------------------------------------------------------------------------------


def driven(level: str, **options: Any) -> Any:
    """A robot that drives straight on at 1 m/s, with noisy odometry beside a true pose."""

    def scene() -> None:
        robot = FakeRobot()
        motion = MotionVW()
        robot.append(motion)
        odometry = Odometry()
        odometry.level(level)
        odometry.alter("", classpath="morse.modifiers.odometry_noise.OdometryNoiseModifier", **options)
        robot.append(odometry)
        Environment("empty", fastmode=True)

    sim = morse.load(scene)
    sim.robot.motion.publish({"v": 1.0})
    return sim


def test_a_wheel_that_is_too_large_measures_too_far() -> None:
    with driven("integrated", factor=1.05) as sim:
        sim.step(120)
        data = sim.robot.odometry.data
        assert (data["x"], data["y"], data["yaw"]) == pytest.approx((2.0 * 1.05, 0.0, 0.0), abs=1e-9)
        assert data["vx"] == pytest.approx(1.05)


def test_raw_and_differential_displacements_are_scaled() -> None:
    with driven("raw", factor=1.1) as sim:
        sim.step(10)
        assert sim.robot.odometry.data["dS"] == pytest.approx(1.1 / 60.0)
    with driven("differential", factor=1.1, gyro_drift=0.01) as sim:
        sim.step(10)
        data = sim.robot.odometry.data
        assert (data["dx"], data["dyaw"]) == pytest.approx((1.1 / 60.0, 0.01))


def test_a_drifting_gyroscope_bends_the_path_into_a_circle() -> None:
    drift, ticks = 0.01, 157  # about a quarter of a turn
    with driven("integrated", factor=1.0, gyro_drift=drift) as sim:
        sim.step(ticks)
        data = sim.robot.odometry.data
    # a polygon of steps of 1/60 m that turns by the drift after each
    x = sum(math.cos(drift * k) for k in range(ticks)) / 60.0
    y = sum(math.sin(drift * k) for k in range(ticks)) / 60.0
    assert (data["x"], data["y"]) == pytest.approx((x, y), abs=1e-9)
    assert data["yaw"] == pytest.approx(drift * ticks)


def test_the_noise_can_be_forgotten_by_a_service_of_the_sensor() -> None:
    with driven("integrated", factor=1.5, gyro_drift=0.01) as sim:
        sim.step(60)
        assert sim.robot.odometry.data["x"] > 1.2
        sim.robot.odometry.reset_noise()
        sim.step(1)
        data = sim.robot.odometry.data
        assert (data["x"], data["y"]) == pytest.approx((1.0 + 1.5 / 60.0, 0.0), abs=1e-9)
