"""W1 in SAPIEN (PhysX on the processor): 120 Hz; one call casts one ray."""

from __future__ import annotations

import math

import numpy as np
import sapien

from benchmarks import work
from benchmarks.peers.fleet import circles

_STEPS = 2
_START = work.RADIUS + 0.01  # rays begin outside the robot
_UPRIGHT = [math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0]  # cylinders lie along X


class Fleet:
    """N robots in SAPIEN."""

    def __init__(self, count: int) -> None:
        self._physics = sapien.physx.PhysxCpuSystem()
        self._scene = sapien.Scene([self._physics])
        self._scene.set_timestep(1 / work.TICK / _STEPS)
        slick = sapien.physx.PhysxMaterial(0.0, 0.0, 0.0)
        for x, y, z, *sizes in [(0.0, 0.0, -0.5, 120.0, 120.0, 1.0), *work.blocks(count)]:
            builder = self._scene.create_actor_builder()
            builder.add_box_collision(half_size=[size / 2 for size in sizes], material=slick)
            builder.set_initial_pose(sapien.Pose([x, y, z]))
            builder.build_static()
        self._robots = [self._robot(x, y, slick) for x, y, _ in work.starts(count)]
        self._angles = np.array(work.scan_angles())

    def _robot(self, x: float, y: float, material: object) -> tuple[object, object]:
        builder = self._scene.create_actor_builder()
        half = work.HEIGHT / 2
        density = work.MASS / (math.pi * work.RADIUS**2 * work.HEIGHT)
        builder.add_cylinder_collision(
            sapien.Pose([0, 0, 0], _UPRIGHT), radius=work.RADIUS, half_length=half, material=material, density=density
        )
        builder.set_initial_pose(sapien.Pose([x, y, half]))
        entity = builder.build()
        body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        body.linear_damping = body.angular_damping = 0.0
        return entity, body

    def poses(self) -> list[work.Pose]:
        """x, y, yaw of every robot."""
        found = []
        for entity, _ in self._robots:
            pose = entity.pose  # type: ignore[attr-defined]
            found.append((float(pose.p[0]), float(pose.p[1]), 2 * math.atan2(float(pose.q[3]), float(pose.q[0]))))
        return found

    def tick(self) -> None:
        """Command, physics."""
        for (_, body), (_, _, yaw) in zip(self._robots, self.poses(), strict=True):
            falling = float(body.linear_velocity[2])  # type: ignore[attr-defined]
            body.linear_velocity = [work.SPEED * math.cos(yaw), work.SPEED * math.sin(yaw), falling]  # type: ignore[attr-defined]
            body.angular_velocity = [0.0, 0.0, work.RATE]  # type: ignore[attr-defined]
        for _ in range(_STEPS):
            self._scene.step()

    def scan(self) -> list[list[float]]:
        """The ranges that every robot measures."""
        return [self._scan(pose) for pose in self.poses()]

    def _scan(self, pose: work.Pose) -> list[float]:
        x, y, yaw = pose
        rays = np.zeros((work.SCAN_RAYS, 3), np.float32)
        rays[:, 0], rays[:, 1] = np.cos(self._angles + yaw), np.sin(self._angles + yaw)
        origins = np.array([x, y, work.SCAN_HEIGHT], np.float32) + np.float32(_START) * rays
        reach = work.SCAN_RANGE - _START
        hits = [self._physics.raycast(origin, ray, reach) for origin, ray in zip(origins, rays, strict=True)]
        return [work.SCAN_RANGE if hit is None else _START + hit.distance for hit in hits]


if __name__ == "__main__":
    circles(Fleet)
