"""Scenes as functions, for tests with processes, which import them."""

from typing import Any


def driving() -> None:
    """A robot that drives, scans a wall, and measures with noise; a ball falls."""
    from morse.builder import ATRV, Environment, MotionVW, PassiveObject, Pose, Sick

    robot = ATRV()
    motion, pose, scan = MotionVW(), Pose(), Sick()
    for part in (motion, pose, scan):
        robot.append(part)
    pose.noise(gaussian=0.02, field="x")
    crate = PassiveObject("props/crates", "small_crate")
    crate.translate(2.0, 0.3, 2.0)
    Environment("empty", fastmode=True)


def drive(simulation: Any, ticks: int) -> None:
    """Give commands that differ from tick to tick."""
    for _ in range(ticks):
        number = simulation.ticks
        simulation.robot.motion.publish({"v": 0.5 + 0.1 * (number % 7), "w": 0.3 - 0.1 * (number % 5)})
        simulation.step()


def hash_after(ticks: int) -> str:
    """The state of a simulation that ran alone."""
    import morse

    with morse.load(driving, seed=3) as simulation:
        drive(simulation, ticks)
        return simulation.state_hash()
