"""W1 in PyRoboSim, a kinematic simulator of the plane, without its threads: 60 Hz, scans at 10 Hz."""

from __future__ import annotations

import logging
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
from pyrobosim.core import Robot, World
from pyrobosim.sensors.lidar import Lidar2D
from pyrobosim.utils.pose import Pose

from benchmarks import work
from benchmarks.peers.fleet import circles

_LOCATIONS = """\
box:
  footprint: {{type: box, dims: [{0}, {1}]}}
  height: {2}
  locations:
    - {{name: top, footprint: {{type: parent}}}}
  nav_locations:
    - [0.9, 0]
"""


class Fleet:
    """N robots in PyRoboSim."""

    def __init__(self, count: int) -> None:
        logging.disable(logging.CRITICAL)
        self._world = World()
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "locations.yaml"
            file.write_text(_LOCATIONS.format(*work.BOX))
            self._world.add_metadata(locations=[str(file)])
        half = work.SIZE / 2
        corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
        self._world.add_room(name="room", footprint=corners)
        for x, y, *_ in work.boxes():
            self._world.add_location(category="box", parent="room", pose=Pose(x=x, y=y))
        self._robots = [self._robot(i, x, y) for i, (x, y, _) in enumerate(work.starts(count))]
        self._world.update_polygons()
        self._command = np.array([work.SPEED, 0.0, work.RATE])

    def _robot(self, number: int, x: float, y: float) -> tuple[Robot, Lidar2D]:
        lidar = Lidar2D(
            update_rate_s=1 / work.SCAN_RATE,
            angle_units="radians",
            min_angle=-work.SCAN_VIEW / 2,
            max_angle=work.SCAN_VIEW / 2 - 1e-9,
            angular_resolution=work.SCAN_VIEW / (work.SCAN_RAYS - 1),
            max_range_m=work.SCAN_RANGE,
        )
        robot = Robot(name=f"r{number}", radius=work.RADIUS, sensors={"lidar": lidar})
        self._world.add_robot(robot, loc="room", pose=Pose(x=x, y=y))
        lidar.robot = robot
        return robot, lidar

    def tick(self) -> None:
        """One step of each robot."""
        for robot, _ in self._robots:
            pose = robot.dynamics.step(self._command, 1 / work.TICK)
            if not robot.is_in_collision(pose=pose):
                robot.set_pose(pose)
                robot.dynamics.pose = pose

    def poses(self) -> list[work.Pose]:
        """x, y, yaw of every robot."""
        poses = [robot.get_pose() for robot, _ in self._robots]
        return [(float(pose.x), float(pose.y), float(pose.get_yaw())) for pose in poses]

    def scan(self) -> list[list[float]]:
        """The ranges that every robot measures."""
        for _, lidar in self._robots:
            lidar.update()
        return [[float(r) for r in lidar.get_measurement()] for _, lidar in self._robots]


if __name__ == "__main__":
    circles(Fleet)
    sys.stdout.flush()
    os._exit(0)  # its threads do not end
