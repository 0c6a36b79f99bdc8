"""A batch of simulations, in turn with a loop around MuJoCo that does the same.

The work is an *environment step*: six ticks at one command, then the pose and a scan of 181 rays. In the mode ``free``
robots drive in circles; in the mode ``crash`` commands are random, and a robot that touches something starts again.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

os.environ.setdefault("MORSE_THREADS", "1")

import mujoco
import numpy as np

import morse
from benchmarks import stopwatch, work
from benchmarks.peers.mujoco_loop import row_model

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TICKS, _STEPS, _CHUNK = 6, 4, 5
#: environment steps between two random commands
_HOLD = 10
_SCENE = Path(__file__).parents[1] / "scenes" / "rows.py"


class Rows:
    """A batch by its public interface."""

    def __init__(self, count: int) -> None:
        self._many = many = morse.batch(_SCENE, count)
        self._drive = many.command("robot.motion", "v", "w")
        self.scan = many.read("robot.laser", "range_list")
        self.pose = many.read("robot.pose", "x", "y", "yaw")
        self._hit = many.contacts("robot")

    def start(self, rows: Any) -> None:
        self._many.place(rows, "robot", work.ROW_START)

    def step(self, commands: NDArray[np.float64]) -> NDArray[np.bool_]:
        self._drive[:] = commands
        self._many.step(_TICKS, measure=True)
        return self._hit

    def arrays(self, commands: NDArray[np.float64]) -> None:
        """What writing and reading cost, without time that passes."""
        self._drive[:] = commands
        self._many.step(0)


class Bare:
    """A loop around N states of one MuJoCo model."""

    def __init__(self, count: int) -> None:
        self._model = model = row_model()
        self._datas = [mujoco.MjData(model) for _ in range(count)]
        self._body = model.body("robot").id
        angles = np.array(work.scan_angles())
        self._fan = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
        self._solids, self._distances = np.zeros(len(angles), np.int32), np.zeros(len(angles))
        self.scan, self.pose = np.zeros((count, len(angles))), np.zeros((count, 3))
        self._hit = np.zeros(count, dtype=bool)

    def start(self, rows: Any) -> None:
        for row in np.atleast_1d(np.arange(len(self._datas))[rows]):
            self._datas[row].qpos[:], self._datas[row].qvel[:] = work.ROW_START, 0.0

    def step(self, commands: NDArray[np.float64]) -> NDArray[np.bool_]:
        for row, (data, (v, w)) in enumerate(zip(self._datas, commands.tolist(), strict=True)):
            self._hit[row] = False
            for _ in range(_TICKS):
                yaw = data.qpos[2]
                data.qvel[:] = v * np.cos(yaw), v * np.sin(yaw), w
                mujoco.mj_step(self._model, data, _STEPS)
                self._hit[row] |= data.ncon > 0
            mujoco.mj_kinematics(self._model, data)
            self.pose[row] = data.qpos
            self._scan(row, data)
        return self._hit

    def _scan(self, row: int, data: mujoco.MjData) -> None:
        c, s = np.cos(data.qpos[2]), np.sin(data.qpos[2])
        rays = self._fan @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        origin = np.array([*data.qpos[:2], work.SCAN_HEIGHT])
        mujoco.mj_multiRay(
            self._model, data, origin, rays.ravel(), None, 1, self._body, self._solids, self._distances, None,
            len(rays), work.SCAN_RANGE,
        )  # fmt: skip
        self.scan[row] = np.where(self._distances < 0, work.SCAN_RANGE, self._distances)


def _chunk(loop: Any, commands: NDArray[np.float64], crash: bool) -> tuple[float, float]:
    wall, processor = time.perf_counter(), time.process_time()
    for command in commands:
        hit = loop.step(command)
        if crash and hit.any():
            loop.start(hit.copy())
    count = commands.shape[0] * commands.shape[1]
    return (time.perf_counter() - wall) / count * 1e6, (time.process_time() - processor) / count * 1e6


def memory_of_row(count: int) -> float:
    """MB of memory that a row adds to a batch."""

    def resident() -> float:
        return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6

    def run(rows: int) -> Rows:
        loop = Rows(rows)
        loop.start(slice(None))
        for _ in range(2):
            loop.step(np.tile([0.5, 0.5], (rows, 1)))
        return loop

    first = run(2)
    before = resident()
    _loop = run(count)
    del first
    return (resident() - before) / count


def main() -> None:
    """Run both loops in turn, and report µs of processor time per environment step."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--n", type=int, default=64)
    parser.add_argument("--mode", choices=["free", "crash"], default="free")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--memory", action="store_true")
    arguments = parser.parse_args()
    if arguments.memory:
        stopwatch.report(row_mb=memory_of_row(arguments.n))
        return
    count, crash = arguments.n, arguments.mode == "crash"
    loops: dict[str, Any] = {"morse": Rows(count), "bare": Bare(count)}
    for loop in loops.values():
        loop.start(slice(None))
    rng = np.random.default_rng(1)
    command = np.tile([0.5, 0.5], (count, 1))
    steps = _CHUNK * max(1, 16 // count)
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in loops}
    for number in range(arguments.rounds + 1):
        if crash:
            holds = rng.uniform([0.0, -1.5], [1.0, 1.5], (-(-steps // _HOLD), count, 2))
            commands = np.repeat(holds, _HOLD, axis=0)[:steps]
        else:
            commands = np.broadcast_to(command, (steps, count, 2))
        for name, loop in loops.items():
            spent = _chunk(loop, commands, crash)
            if number:
                times[name].append(spent)
    own = loops["morse"]
    begin = time.process_time()
    for _ in range(steps):
        own.arrays(command)
    arrays = (time.process_time() - begin) / steps / count * 1e6
    us = {name: statistics.median(spent[1] for spent in each) for name, each in times.items()}
    wall = {name: statistics.median(spent[0] for spent in each) for name, each in times.items()}
    ratio = statistics.median(bare[1] / own[1] for own, bare in zip(times["morse"], times["bare"], strict=True))
    error = scan = 0.0
    if not crash:
        error = float(np.abs(own.pose[:, :2] - loops["bare"].pose[:, :2]).max())
        scan = float(np.median(np.abs(own.scan - loops["bare"].scan)))
    stopwatch.report(
        morse_us=us["morse"],
        bare_us=us["bare"],
        wall=wall,
        ratio=ratio,
        arrays=arrays / us["morse"],
        position_error_m=error,
        scan_error_m=scan,
    )


if __name__ == "__main__":
    main()
