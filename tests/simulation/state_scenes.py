"""Scenes as plain numbers, so that another process can create the same scene, and actions in them."""

import sys
from pathlib import Path
from typing import Any

import morse

PARTS = str(Path(__file__).parent)


def build(plan: dict[str, Any]) -> None:
    """A scene from a plan: the number of robots, their kinds and parts, things that fall."""
    from morse.builder import ATRV, Environment, FakeRobot, Keyboard, MotionVW, Odometry, PassiveObject, Pose, Sick
    from morse.builder.creator import SensorCreator

    class Everything(SensorCreator):
        _classpath = "state_parts_of_users.Everything"

    for number, kind in enumerate(plan["robots"]):
        robot = (ATRV if kind else FakeRobot)("robot" if number == 0 else f"robot{number}")
        robot.translate(3.0 * number, 0.0, 0.2)
        motion, pose = MotionVW("motion"), Pose("pose")
        pose.noise(gaussian=0.01, field="x")
        pose.delay(0.05)
        parts: list[Any] = [motion, pose, Everything("everything")]
        if plan["scan"]:
            parts += [Odometry("odometry"), Keyboard("keyboard"), Sick("scan")]
        for part in parts:
            robot.append(part)
    for number in range(plan["things"]):
        crate = PassiveObject("props/crates", "small_crate")
        crate.name = f"crate{number}"
        crate.translate(1.5 + 0.2 * number, 0.1 * number, 1.0 + number)
    Environment("empty", fastmode=True)


def load(plan: dict[str, Any]) -> Any:
    """A simulation of a plan."""
    return morse.load(lambda: build(plan), seed=plan["seed"])


def go(simulation: Any, plan: dict[str, Any], ticks: int) -> None:
    """Step, with commands, services and keys that only depend on the tick."""
    for _ in range(ticks):
        tick = simulation.ticks
        for number in range(len(plan["robots"])):
            robot = simulation["robot" if number == 0 else f"robot{number}"]
            if (tick + number) % 4 == 0:
                robot.motion.publish({"v": 0.2 * (tick % 6), "w": 0.1 * (tick % 5) - 0.2})
        if tick % 11 == 5 and plan["things"]:
            simulation.rpc("simulation", "pull", "crate0", [0.0, 0.0, 0.0], [1.0, 1.0, 2.0])
        if tick % 11 == 9:
            simulation.rpc("simulation", "let_go")
        if tick % 13 == 6:
            simulation.set_controls(frozenset({"ArrowUp"}), (0.5,), "robot")
        simulation.step()


def go_on(plan: dict[str, Any], path: str, ticks: int) -> str:
    """For another process: restore a file, run on, and return the state."""
    if PARTS not in sys.path:
        sys.path.insert(0, PARTS)
    with load(plan) as simulation:
        simulation.restore(path)
        go(simulation, plan, ticks)
        return simulation.state_hash()
