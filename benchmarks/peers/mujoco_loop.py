"""The work in a bare loop around MuJoCo: the reference.

Planar robots have two slide joints and a hinge, and their velocity is set in every tick. Wheeled robots have a free
joint, two velocity motors, ellipsoids as wheels (with one contact point each) and casters without friction.
"""

from __future__ import annotations

import argparse
import json
import socket
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from benchmarks import stopwatch, work

if TYPE_CHECKING:
    from numpy.typing import NDArray

_STEPS = 4  # engine steps per tick: 240 Hz


def _arena(blocks: list[work.Block]) -> list[str]:
    parts = [
        f'<mujoco><option timestep="{1 / work.TICK / _STEPS}" integrator="implicitfast"/><worldbody>'
        '<geom type="plane" size="60 60 1" friction="1 0.005 0.0001"/>'
    ]
    return parts + [
        f'<geom type="box" pos="{x} {y} {z}" size="{sx / 2} {sy / 2} {sz / 2}"/>' for x, y, z, sx, sy, sz in blocks
    ]


def row_model() -> mujoco.MjModel:
    """One planar robot in the arena of a row of a batch."""
    parts = [*_arena(work.row_blocks()), _planar("robot", 0.0, 0.0), "</worldbody></mujoco>"]
    return mujoco.MjModel.from_xml_string("".join(parts))


def _model(count: int, drive: str) -> mujoco.MjModel:
    parts = _arena(work.blocks(count))
    robot = _planar if drive == "planar" else _wheeled
    parts += [robot(f"r{i}", x, y) for i, (x, y, _) in enumerate(work.starts(count))]
    parts.append("</worldbody>")
    if drive == "wheels":
        motors = (f'<velocity joint="r{i}{side}" kv="5"/>' for i in range(count) for side in "LR")
        parts.append(f"<actuator>{''.join(motors)}</actuator>")
    return mujoco.MjModel.from_xml_string("".join([*parts, "</mujoco>"]))


def _planar(name: str, x: float, y: float) -> str:
    return (
        f'<body name="{name}" pos="{x} {y} 0"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
        f'<joint type="hinge" axis="0 0 1"/><geom type="cylinder" pos="0 0 {work.HEIGHT / 2 + 0.01}" '
        f'size="{work.RADIUS} {work.HEIGHT / 2}" mass="{work.MASS}" friction="0"/></body>'
    )


def _wheeled(name: str, x: float, y: float) -> str:
    radius = work.WHEEL_RADIUS
    wheels = "".join(
        f'<body pos="0 {at} {radius}"><joint name="{name}{side}" type="hinge" axis="0 1 0"/><geom type="ellipsoid" '
        f'size="{radius} {work.WHEEL_WIDTH / 2} {radius}" mass="{work.WHEEL_MASS}" friction="1 .005 .0001"/></body>'
        for side, at in (("L", work.TRACK / 2), ("R", -work.TRACK / 2))
    )
    casters = "".join(
        f'<geom type="sphere" pos="{at} 0 .03" size=".03" mass=".01" friction="0" condim="1" priority="1"/>'
        for at in (0.15, -0.15)
    )
    return (
        f'<body name="{name}" pos="{x} {y} 0"><freejoint/><geom type="cylinder" pos="0 0 {work.HEIGHT / 2 + 0.02}" '
        f'size="{work.RADIUS} {work.HEIGHT / 2 - 0.02}" mass="{work.MASS - 2 * work.WHEEL_MASS}"/>{casters}{wheels}'
        "</body>"
    )


class Loop:
    """N robots.

    Attributes:
        speed, rate: the command, m/s and rad/s.
    """

    def __init__(self, count: int, drive: str = "planar") -> None:
        self.model = _model(count, drive)
        self.data = mujoco.MjData(self.model)
        self.speed, self.rate = work.SPEED, work.RATE
        self._drive = drive
        self._bodies = np.array([self.model.body(f"r{i}").id for i in range(count)])
        self._angles = np.array(work.scan_angles())
        self._solids = np.zeros(work.SCAN_RAYS, np.int32)
        self._distances = np.zeros(work.SCAN_RAYS)
        self._ticks = 0
        self.ranges: list[NDArray[np.float64]] = []
        mujoco.mj_forward(self.model, self.data)

    def tick(self) -> None:
        """Command, physics, poses."""
        data = self.data
        if self._drive == "planar":
            yaw, speeds = data.qpos[2::3], data.qvel.reshape(-1, 3)
            speeds[:, 0], speeds[:, 1], speeds[:, 2] = self.speed * np.cos(yaw), self.speed * np.sin(yaw), self.rate
        else:
            data.ctrl[0::2], data.ctrl[1::2] = work.wheel_speeds()
        mujoco.mj_step(self.model, data, _STEPS)
        self.poses = self._poses()

    def tick_and_scan(self) -> None:
        """A tick; every sixth one every robot scans."""
        self.tick()
        self._ticks += 1
        if self._ticks % work.TICKS_PER_SCAN == 0:
            mujoco.mj_kinematics(self.model, self.data)
            self.poses = self._poses()
            self.ranges = [self._scan(i, pose) for i, pose in enumerate(self.poses)]

    def _poses(self) -> NDArray[np.float64]:
        """(N, 3) x, y, yaw."""
        places, turns = self.data.xpos[self._bodies], self.data.xmat[self._bodies]
        return np.column_stack([places[:, 0], places[:, 1], np.arctan2(turns[:, 3], turns[:, 0])])

    def settle(self) -> list[work.Pose]:
        """The exact present x, y, yaw of the robots."""
        mujoco.mj_kinematics(self.model, self.data)
        self.poses = self._poses()
        return [(float(x), float(y), float(yaw)) for x, y, yaw in self.poses]

    def _scan(self, robot: int, pose: NDArray[np.float64]) -> NDArray[np.float64]:
        angles = self._angles + pose[2]
        rays = np.zeros((work.SCAN_RAYS, 3))
        rays[:, 0], rays[:, 1] = np.cos(angles), np.sin(angles)
        origin = np.array([pose[0], pose[1], work.SCAN_HEIGHT])
        self._cast(robot, origin, rays, self._solids, self._distances, work.SCAN_RANGE)
        return np.where(self._distances < 0, work.SCAN_RANGE, self._distances)

    def _cast(
        self,
        robot: int,
        origin: NDArray[np.float64],
        rays: NDArray[np.float64],
        solids: NDArray[np.int32],
        distances: NDArray[np.float64],
        reach: float,
    ) -> None:
        own = int(self._bodies[robot])
        mujoco.mj_multiRay(
            self.model, self.data, origin, rays.ravel(), None, 1, own, solids, distances, None, len(rays), reach
        )

    def panorama(self, rays: NDArray[np.float64]) -> NDArray[np.float64]:
        """Ranges (R,) of rays (R, 3) of the first robot, after a tick."""
        mujoco.mj_kinematics(self.model, self.data)
        body = self._bodies[0]
        solids, distances = np.zeros(len(rays), np.int32), np.zeros(len(rays))
        turned = rays @ self.data.xmat[body].reshape(3, 3).T
        origin = self.data.xpos[body] + [0.0, 0.0, work.PANORAMA_HEIGHT]
        self._cast(0, origin, turned, solids, distances, work.PANORAMA_RANGE)
        return np.where(distances < 0, work.PANORAMA_RANGE, distances)


def circles(arguments: argparse.Namespace) -> None:
    """W1."""
    loop = Loop(arguments.n, arguments.drive)
    scans = arguments.sensors == "scan"
    pace, seconds = stopwatch.measure(loop.tick_and_scan if scans else loop.tick, arguments.secs)
    ranges = loop.ranges[0].tolist() if scans else []
    final = loop.settle()
    error, bad = work.scan_errors(ranges, final) if scans else (None, None)
    stopwatch.report(
        factor=pace.wall,
        processor_factor=pace.processor,
        seconds=seconds,
        position_error_m=work.worst_position(final, seconds),
        scan_error_m=error,
        scan_bad_share=bad,
    )


def panorama(arguments: argparse.Namespace) -> None:
    """W3."""
    loop = Loop(1)
    rays = np.array(work.panorama_rays())
    ranges, ticks = np.zeros(0), 0

    def tick() -> None:
        nonlocal ranges, ticks
        loop.tick()
        ticks += 1
        if ticks % work.TICKS_PER_SCAN == 0:
            ranges = loop.panorama(rays)

    pace, _ = stopwatch.measure(tick, arguments.secs)
    (pose,) = loop.settle()
    error, bad = work.panorama_errors(ranges.tolist(), pose)
    stopwatch.report(
        rays_per_s=pace.wall * work.SCAN_RATE * len(rays),
        processor_rays_per_s=pace.processor * work.SCAN_RATE * len(rays),
        scan_error_m=error,
        scan_bad_share=bad,
    )


def launch(_: argparse.Namespace) -> None:
    """W4: import and load everything; one tick, one pose."""
    loop = Loop(1)
    loop.tick()
    x, y, _yaw = loop.settle()[0]
    stopwatch.report(x=x, y=y)


def lockstep(_: argparse.Namespace) -> None:
    """W6: receive a line with the command, run a tick, send a line with the pose."""
    loop = Loop(1)
    with socket.create_server(("127.0.0.1", 0)) as server:
        print(server.getsockname()[1], flush=True)
        connection, _peer = server.accept()
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        with connection, connection.makefile("rwb") as lines:
            for line in lines:
                message = json.loads(line)
                loop.speed, loop.rate = message["v"], message["w"]
                loop.tick()
                x, y, yaw = loop.settle()[0]
                lines.write(json.dumps({"x": x, "y": y, "yaw": yaw}).encode() + b"\n")
                lines.flush()


_WORK = {"circles": circles, "panorama": panorama, "launch": launch, "lockstep": lockstep}


def main() -> None:
    """Run one of the benchmarks."""
    parser = argparse.ArgumentParser()
    parser.add_argument("work", choices=_WORK)
    parser.add_argument("--n", type=int, default=1)
    parser.add_argument("--secs", type=float, default=20.0)
    parser.add_argument("--drive", choices=["planar", "wheels"], default="planar")
    parser.add_argument("--sensors", choices=["scan", "pose"], default="scan")
    arguments = parser.parse_args()
    _WORK[arguments.work](arguments)


if __name__ == "__main__":
    main()
