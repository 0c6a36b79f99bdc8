"""W1 in ir-sim, a kinematic simulator of the plane: 60 Hz, scans at 10 Hz."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np

from benchmarks import work
from benchmarks.peers.fleet import circles

os.environ["MPLBACKEND"] = "Agg"
import irsim  # reads the variable above


def _description(count: int) -> str:
    half = max(x for x, *_ in work.walls()) + 2
    lines = [
        f"world: {{height: {2 * half}, width: {2 * half}, offset: [-{half}, -{half}], "
        f"step_time: {1 / work.TICK}, sample_time: {1 / work.TICK}, collision_mode: 'stop'}}",
        "robot:",
    ]
    for x, y, yaw in work.starts(count):
        lines.append(
            f"  - {{kinematics: {{name: 'diff'}}, shape: {{name: 'circle', radius: {work.RADIUS}}}, "
            f"state: [{x}, {y}, {yaw}], goal: [100, 100, 0], vel_max: [2, 2], vel_min: [-2, -2], "
            f"sensors: [{{name: 'lidar2d', range_min: 0, range_max: {work.SCAN_RANGE}, "
            f"angle_range: {work.SCAN_VIEW}, number: {work.SCAN_RAYS}}}]}}"
        )
    lines.append("obstacle:")
    for x, y, _, sx, sy, _ in work.blocks(count):
        lines.append(f"  - {{shape: {{name: 'rectangle', length: {sx}, width: {sy}}}, state: [{x}, {y}, 0]}}")
    return "\n".join(lines)


class Fleet:
    """N robots in ir-sim, whose sensors measure on request, not in every step."""

    def __init__(self, count: int) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "world.yaml"
            file.write_text(_description(count))
            self._world = irsim.make(str(file), display=False, log_level="ERROR")
        self._sense = self._world._objects_sensor_step
        self._world._objects_sensor_step = lambda: None
        self._commands = [np.array([[work.SPEED], [work.RATE]])] * count
        self._numbers = list(range(count))

    def tick(self) -> None:
        """One step."""
        self._world.step(self._commands, self._numbers)

    def poses(self) -> list[work.Pose]:
        """x, y, yaw of every robot."""
        return [tuple(float(v) for v in robot.state[:3, 0]) for robot in self._world.robot_list]  # type: ignore[misc]

    def scan(self) -> list[list[float]]:
        """The ranges that every robot measures."""
        self._sense()
        return [[float(r) for r in robot.get_lidar_scan()["ranges"]] for robot in self._world.robot_list]


if __name__ == "__main__":
    circles(Fleet)
