"""A scene with noise, rays, frames and inputs, and independent readers of its recordings."""

from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader

from morse.builder import ATRV, Battery, Environment, MotionVW, Odometry, Pose, Sick
from morse.simulation.simulation import Simulation


def scene() -> None:
    """A robot that is commanded."""
    robot = ATRV()
    motion, pose, scan, odometry, battery = MotionVW(), Pose(), Sick(), Odometry(), Battery()
    scan.translate(0.3, 0.0, 0.9)
    pose.noise(gaussian=0.01)
    for part in (motion, pose, scan, odometry, battery):
        robot.append(part)
    Environment("empty")


SCRIPT = """
from morse.builder import *

robot = ATRV()
motion, pose, scan = MotionVW(), Pose(), Sick()
scan.translate(0.3, 0.0, 0.9)
pose.noise(gaussian=0.01)
for part in (motion, pose, scan):
    robot.append(part)
Environment("empty")
"""


def drive(sim: Simulation, ticks: int = 60) -> None:
    """Step, with inputs."""
    sim.step(10)
    sim.robot.motion.publish({"v": 1.0, "w": 0.5})
    sim.step(ticks - 20)
    sim.robot.motion.set_speed(0.0, 1.0)
    sim.step(10)


def read_by_rosbags(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """Topic to log time and message."""
    found: dict[str, list[tuple[int, Any]]] = {}
    with AnyReader([path]) as reader:
        for connection, time, data in reader.messages():
            found.setdefault(connection.topic, []).append((time, reader.deserialize(data, connection.msgtype)))
    return found
