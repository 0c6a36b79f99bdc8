"""W1 in PyBullet: 240 Hz, the velocity of the robots is set in every tick.

The robots are spheres at the height of the scanner: the outline is the same, and rays of Bullet are five times slower
for cylinders.
"""

from __future__ import annotations

import math

import numpy as np
import pybullet as bullet

from benchmarks import work
from benchmarks.peers.fleet import circles

_STEPS = 4
_START = work.RADIUS + 0.01  # rays begin outside the robot


class Fleet:
    """N robots in PyBullet."""

    def __init__(self, count: int) -> None:
        bullet.connect(bullet.DIRECT)
        bullet.setTimeStep(1 / work.TICK / _STEPS)
        bullet.setGravity(0, 0, -work.GRAVITY)
        for x, y, z, *sizes in [(0.0, 0.0, -0.5, 120.0, 120.0, 1.0), *work.blocks(count)]:
            shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[size / 2 for size in sizes])
            bullet.createMultiBody(0, shape, -1, (x, y, z))
        ball = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=work.RADIUS)
        self._robots = [
            bullet.createMultiBody(work.MASS, ball, -1, (x, y, work.SCAN_HEIGHT + 0.001))
            for x, y, _ in work.starts(count)
        ]
        for robot in self._robots:
            bullet.changeDynamics(robot, -1, lateralFriction=0, linearDamping=0, angularDamping=0)
        self._angles = np.array(work.scan_angles())

    def poses(self) -> list[work.Pose]:
        """x, y, yaw of every robot."""
        found = []
        for robot in self._robots:
            (x, y, _), (_, _, qz, qw) = bullet.getBasePositionAndOrientation(robot)
            found.append((x, y, 2 * math.atan2(qz, qw)))
        return found

    def tick(self) -> None:
        """Command, physics."""
        for robot, (_, _, yaw) in zip(self._robots, self.poses(), strict=True):
            falling = bullet.getBaseVelocity(robot)[0][2]
            velocity = (work.SPEED * math.cos(yaw), work.SPEED * math.sin(yaw), falling)
            bullet.resetBaseVelocity(robot, velocity, (0, 0, work.RATE))
        for _ in range(_STEPS):
            bullet.stepSimulation()

    def scan(self) -> list[list[float]]:
        """The ranges that every robot measures."""
        return [self._scan(pose) for pose in self.poses()]

    def _scan(self, pose: work.Pose) -> list[float]:
        x, y, yaw = pose
        cos, sin = np.cos(self._angles + yaw), np.sin(self._angles + yaw)
        height = np.full(work.SCAN_RAYS, work.SCAN_HEIGHT)
        ends = [np.column_stack([x + r * cos, y + r * sin, height]).tolist() for r in (_START, work.SCAN_RANGE)]
        hits = bullet.rayTestBatch(*ends, numThreads=1)
        return [_START + hit[2] * (work.SCAN_RANGE - _START) for hit in hits]


if __name__ == "__main__":
    circles(Fleet)
