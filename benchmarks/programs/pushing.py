"""Robots that push crates, beside a bare MuJoCo loop on a copy of the same model."""

from __future__ import annotations

import argparse
import copy
import statistics
import time
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from benchmarks import stopwatch, work
from benchmarks.programs.loading import prepare, sensors_with

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.simulation.simulation import Simulation

#: ticks until all crates are pushed, and of a chunk
_WARM_UP, _CHUNK = 60, 4


class Bare:
    """A MuJoCo loop with the same work: commands, physics, poses."""

    def __init__(self, simulation: Simulation) -> None:
        world: Any = simulation.context.world
        self._model, self._data = copy.copy(world.model), copy.copy(world.data)
        self._steps: int = world.steps
        slots = [world.slots[robot.bge_object.slot] for robot in simulation.loaded.robots]
        self._bodies = np.array([slot.body for slot in slots])
        self._dofs = np.array([slot.dof for slot in slots])

    def tick(self) -> None:
        """Command, physics, poses."""
        speeds, dofs = self._data.qvel, self._dofs
        speeds[dofs], speeds[dofs + 1], speeds[dofs + 5] = work.PUSHING_SPEED, 0.0, 0.0
        mujoco.mj_step(self._model, self._data, self._steps)
        self.poses = self._poses()

    def _poses(self) -> NDArray[np.float64]:
        """(N, 3) x, y, yaw."""
        places, turns = self._data.xpos[self._bodies], self._data.xmat[self._bodies]
        return np.column_stack([places[:, 0], places[:, 1], np.arctan2(turns[:, 3], turns[:, 0])])

    def settle(self) -> NDArray[np.float64]:
        """The exact present poses."""
        mujoco.mj_kinematics(self._model, self._data)
        return self._poses()


def _time_of(tick: Callable[[], object]) -> tuple[float, float]:
    wall, processor = time.perf_counter(), time.thread_time()
    for _ in range(_CHUNK):
        tick()
    return time.perf_counter() - wall, time.thread_time() - processor


def main() -> None:
    """Run both loops in turn for ``--secs`` simulated seconds each."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=50)
    parser.add_argument("--secs", type=float, default=10.0)
    arguments = parser.parse_args()
    simulation = prepare("pushing", count=arguments.n)
    for motion in simulation.loaded.actuators:
        motion.local_data.update(v=work.PUSHING_SPEED)
    for _ in range(_WARM_UP):
        simulation.tick()
    bare = Bare(simulation)
    times = [(_time_of(simulation.tick), _time_of(bare.tick)) for _ in range(round(arguments.secs * 60 / _CHUNK))]
    sensors = [sensor.local_data for sensor in sensors_with(simulation, "yaw")]
    reached = np.array([(data["x"], data["y"], data["yaw"]) for data in sensors])
    starts = np.array(work.pushing_starts(arguments.n))
    world = simulation.context.world
    crates = [float(world.game_object(f"crate{i}").worldPosition.x) for i in range(arguments.n)]
    stopwatch.report(
        ratio=statistics.median(theirs[0] / own[0] for own, theirs in times),
        processor_ratio=statistics.median(theirs[1] / own[1] for own, theirs in times),
        us=statistics.median(own[1] for own, _ in times) / _CHUNK * 1e6,
        disagreement_m=float(np.abs(reached - bare.settle()).max()),
        gap_m=float(np.abs(np.array(crates) - reached[:, 0] - work.RADIUS - work.CRATE / 2).max()),
        moved_m=float((reached[:, 0] - starts[:, 0]).min()),
    )
    simulation.close()


if __name__ == "__main__":
    main()
