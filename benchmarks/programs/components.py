"""The cost of a component per tick: ``components NAME``, ``empty`` for one without an action."""

from __future__ import annotations

import statistics
import sys
import time
from typing import TYPE_CHECKING, Any

from benchmarks import stopwatch, work
from benchmarks.commands import command
from benchmarks.programs.loading import prepare

if TYPE_CHECKING:
    from morse.simulation.simulation import Simulation

_WARM_UP, _TICKS = 60, 400
#: components that move the robot by velocities, by forces, and by poses
_BY_VELOCITY = ("MotionVW", "MotionVWDiff", "MotionXYW", "Waypoint", "Destination")
_BY_FORCE = (
    *("Drag", "ExternalForce", "ForceTorque", "Hydrodynamics", "QuadrotorDynamicControl"),
    *("RotorcraftAttitude", "RotorcraftVelocity", "RotorcraftWaypoint", "SteerForce"),
)
_BY_POSE = ("Orientation", "StabilizedQuadrotor", "Teleport")


def main() -> None:
    """Move two robots in the same way, one of them with the component, and compare the times of their ticks.

    The physics of a robot that is moved by forces or poses takes longer than that of a gliding robot. For components
    that do so, only the action is measured.
    """
    name = sys.argv[1]
    robot, bare = TestWorld(name, carries=True), TestWorld(name, carries=False)
    moves = name in (*_BY_FORCE, *_BY_POSE)
    own: list[tuple[float, float]] = []
    without: list[tuple[float, float]] = []
    for tick in range(_WARM_UP + _TICKS):
        times = robot.tick()
        if name in _BY_FORCE:
            bare.body.set_velocity(*robot.body.velocity())
        times_without = bare.tick()
        if tick >= _WARM_UP:
            own.append(robot.acted if moves else times)
            without.append((0.0, 0.0) if moves else times_without)
    failed = sorted(robot.simulation.context.failed)
    if failed:
        sys.exit(f"{failed[0]} was deactivated")
    wall, processor = (_quiet(own, clock) - _quiet(without, clock) for clock in (0, 1))
    stopwatch.report(us=wall * 1e6, processor_us=processor * 1e6, rays=robot.looks_around)


def _quiet(times: list[tuple[float, float]], clock: int) -> float:
    """A low percentile of the times of ticks: other load of the machine only adds time."""
    return statistics.quantiles((entry[clock] for entry in times), n=5)[0]


class TestWorld:
    """A simulation with one moving robot."""

    def __init__(self, name: str, *, carries: bool) -> None:
        self.name = name
        self.simulation: Simulation = prepare("single", **{"class": name, "carries": carries})
        loaded = self.simulation.loaded
        self.component: Any = [*loaded.sensors, *loaded.actuators][-1] if carries else None
        self.robot: Any = loaded.robots[0]
        self.body: Any = self.robot.bge_object
        by_itself = (*_BY_FORCE, *_BY_POSE, *(_BY_VELOCITY if carries else ()))
        self._is_driven = name not in by_itself
        #: times of the wall clock and of the processor of the last action of the component, s
        self.acted = (0.0, 0.0)
        if carries:
            self._act, self.component.action = self.component.action, self._timed
        if name in _BY_FORCE:
            self.body.set_velocity((1.0, 0.0, 0.0), (0.0, 0.0, 0.1))

    def _timed(self) -> None:
        wall, processor = time.perf_counter(), time.thread_time()
        self._act()
        self.acted = time.perf_counter() - wall, time.thread_time() - processor

    @property
    def looks_around(self) -> bool:
        """Whether the component casts rays or captures images."""
        return bool(self.component.requests) or hasattr(self.component, "radars")

    def tick(self) -> tuple[float, float]:
        """Wall-clock time and processor time of this thread for a tick, seconds."""
        if self._is_driven:
            if hasattr(self.robot, "apply_vw_wheels"):
                self.robot.apply_vw_wheels(work.SPEED, work.RATE)
            else:
                self.robot.apply_speed("Velocity", [work.SPEED, 0.0, 0.0], [0.0, 0.0, work.RATE])
        if self.component is not None:
            command(self.name, self.component, self.simulation.context.clock.time)
        wall, processor = time.perf_counter(), time.thread_time()
        self.simulation.tick()
        return time.perf_counter() - wall, time.thread_time() - processor


if __name__ == "__main__":
    main()
