"""W1 in robox3d (Box3D): 60 Hz with the engine's own sub-steps; the robots are prisms of 16 sides."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import robox3d
from robox3d._ffi import ffi, shim  # the only interface for casting many rays

from benchmarks import work
from benchmarks.peers.fleet import circles

if TYPE_CHECKING:
    from numpy.typing import NDArray

_START = work.RADIUS + 0.01  # rays begin outside the robot
_SIDES = 16


class Fleet:
    """N robots in robox3d."""

    def __init__(self, count: int) -> None:
        self._world = robox3d.World(gravity=(0, 0, -work.GRAVITY))
        for x, y, z, *sizes in [(0.0, 0.0, -0.5, 120.0, 120.0, 1.0), *work.blocks(count)]:
            half = tuple(size / 2 for size in sizes)
            self._world.create_body(position=(x, y, z), kind="static").add_box(half, friction=0.0)
        half = work.HEIGHT / 2
        ring = [math.tau * i / _SIDES for i in range(_SIDES)]
        hull = [(work.RADIUS * math.cos(a), work.RADIUS * math.sin(a), z) for a in ring for z in (-half, half)]
        density = work.MASS / (math.pi * work.RADIUS**2 * work.HEIGHT)
        self._robots = []
        for x, y, _ in work.starts(count):
            body = self._world.create_body(position=(x, y, half))
            body.add_hull(hull, density=density, friction=0.0)
            self._robots.append(body)
        self._group = robox3d.BodyGroup(self._robots)
        self._angles = np.array(work.scan_angles())

    def _poses(self) -> NDArray[np.float64]:
        rows = self._group.poses()
        return np.column_stack([rows[:, 0], rows[:, 1], 2 * np.arctan2(rows[:, 5], rows[:, 6])])

    def poses(self) -> list[work.Pose]:
        """x, y, yaw of every robot."""
        return [(x, y, yaw) for x, y, yaw in self._poses().tolist()]

    def tick(self) -> None:
        """Command, physics."""
        yaws = self._poses()[:, 2]
        along, across = work.SPEED * np.cos(yaws), work.SPEED * np.sin(yaws)
        for robot, vx, vy in zip(self._robots, along, across, strict=True):
            robot.linear_velocity, robot.angular_velocity = (vx, vy, 0.0), (0.0, 0.0, work.RATE)
        self._world.step(1 / work.TICK)

    def scan(self) -> list[list[float]]:
        """The ranges that every robot measures."""
        return [self._scan(pose) for pose in self.poses()]

    def _scan(self, pose: work.Pose) -> list[float]:
        x, y, yaw = pose
        count, reach = work.SCAN_RAYS, work.SCAN_RANGE - _START
        rays = np.column_stack([np.cos(self._angles + yaw), np.sin(self._angles + yaw), np.zeros(count)])
        origins = np.ascontiguousarray(np.array([x, y, work.SCAN_HEIGHT]) + _START * rays, np.float32)
        ways = np.ascontiguousarray(rays * reach, np.float32)
        shares, hits = np.empty(count, np.float32), np.empty(count, np.uint8)
        shim.rxCastRaysClosest(
            self._world.id,
            ffi.cast("float*", ffi.from_buffer(origins)),
            ffi.cast("float*", ffi.from_buffer(ways)),
            count,
            ffi.cast("float*", ffi.from_buffer(shares)),
            ffi.cast("uint8_t*", ffi.from_buffer(hits)),
        )
        return [float(r) for r in _START + np.where(hits == 0, 1.0, shares) * reach]


if __name__ == "__main__":
    circles(Fleet)
