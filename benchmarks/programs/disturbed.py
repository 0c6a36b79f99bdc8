"""Robots that drive in circles with scans: what it costs when one of them pushes a wall, or is moved in each tick."""

from __future__ import annotations

import argparse
import statistics
import time
from typing import TYPE_CHECKING

from benchmarks import stopwatch, work
from benchmarks.programs.loading import command_all, poses, prepare

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.simulation.simulation import Simulation

#: ticks of a chunk, in which each robot scans ten times
_CHUNK = 60
#: distance between the centre of the first robot and the wall at the start, m
_AWAY = work.RADIUS + 0.05


def against_the_wall(simulation: Simulation) -> Callable[[], object]:
    """Let the first robot push the wall."""
    robot, motion = simulation.loaded.robots[0], simulation.context.components["r0.motion0"]
    robot.force_pose((work.SIZE / 2 - _AWAY, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    motion.local_data.update(v=work.SPEED, w=0.0)
    return simulation.tick


def to_and_fro(simulation: Simulation) -> Callable[[], object]:
    """Move the first robot by 0.1 m before each tick."""
    robot = simulation.loaded.robots[0]
    x, y, z = robot.bge_object.worldPosition

    def tick() -> None:
        robot.bge_object.worldPosition = (x + 0.1 * (simulation.context.clock.tick % 2), y, z)
        simulation.tick()

    return tick


_WAYS = {"wall": against_the_wall, "moves": to_and_fro}


def _time_of(tick: Callable[[], object]) -> float:
    begin = time.process_time()
    for _ in range(_CHUNK):
        tick()
    return time.process_time() - begin


def main() -> None:
    """Run both simulations in turn for ``--secs`` simulated seconds each."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=64)
    parser.add_argument("--secs", type=float, default=20.0)
    parser.add_argument("--by", choices=_WAYS, default="wall")
    arguments = parser.parse_args()
    free, disturbed = (prepare("arena", count=arguments.n, sensors="scan") for _ in range(2))
    for simulation in (free, disturbed):
        command_all(simulation)
    ticks = free.tick, _WAYS[arguments.by](disturbed)
    for tick in ticks:  # start, and reach the wall
        _time_of(tick)
    times = [[_time_of(tick) for tick in ticks] for _ in range(round(arguments.secs))]
    stopwatch.report(
        ratio=statistics.median(other / alone for alone, other in times),
        # a robot that pushes a wall is where it touches it
        to_wall_m=work.SIZE / 2 - work.RADIUS - poses(disturbed)[0][0],
    )


if __name__ == "__main__":
    main()
