"""W4 and other waiting times of users."""

from __future__ import annotations

import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from benchmarks import work
from benchmarks.result import Result, at_most, failure
from benchmarks.trial import ROOT, Program, TrialFailed, beyond, environment, interleave

if TYPE_CHECKING:
    from collections.abc import Iterator

    from benchmarks.plan import Plan

_PATIENCE = 120.0
_MORSE = ("-c", "from morse.cli import main; main()")
_ARENA = str(ROOT / "benchmarks" / "scenes" / "arena.py")


def launch(plan: Plan) -> Iterator[Result]:
    """W4: from the command to the first tick and the first pose; imports; reading a model."""
    try:
        yield Result("W4", "first tick, 1 robot", _median(plan, _ARENA), "s", at_most(2.0), _bare(plan))
        yield Result("W4", "first pose at a client", _first_poses(plan), "s", at_most(2.0))
        yield Result("W4", "first tick, 100 robots", _median(plan, _ARENA, "count=100"), "s", at_most(5.0))
        with tempfile.TemporaryDirectory() as folder:
            home = {"HOME": folder, "XDG_CONFIG_HOME": str(Path(folder) / "config")}
            subprocess.run(
                [sys.executable, *_MORSE, "create", "ranger_sim"],
                env={**environment(), **home}, cwd=folder, check=True, capture_output=True,
            )  # fmt: skip
            seconds = _median(plan, "ranger_sim", home=home, folder=folder)
        yield Result("W4", "first tick of the tutorial", seconds, "s", at_most(2.0))
        yield _timed(plan, "import morse.builder", "morse.builder", 0.3)
        yield _timed(plan, "import pymorse", "pymorse", None)
        yield _timed(plan, "read the sandbox", "sandbox.blend", 0.1)
    except (TrialFailed, subprocess.CalledProcessError, TimeoutError) as error:
        yield failure("W4", "launch", str(error))


def _timed(plan: Plan, case: str, what: str, bound: float | None) -> Result:
    program = Program("morse", "benchmarks.programs.imports", (what,))
    seconds = interleave([program], plan.repeats)["morse"].median("seconds")
    return Result("W4", case, seconds, "s", None if bound is None else at_most(bound))


def _bare(plan: Plan) -> dict[str, float]:
    walls = []
    for _ in range(plan.repeats):
        begin = time.perf_counter()
        record = Program("mujoco", "benchmarks.peers.mujoco_loop", ("launch",)).run()
        walls.append(time.perf_counter() - begin)
        start = work.starts(1)[0]
        wrong = beyond({"x": abs(record["x"] - start[0] - work.SPEED / work.TICK)}, "x", 1e-3)
        if wrong is not None:
            raise TrialFailed(f"mujoco launch: {wrong}")
    return {"mujoco": statistics.median(walls)}


def _median(plan: Plan, *scene: str, home: dict[str, str] | None = None, folder: str | None = None) -> float:
    return statistics.median(_first_tick(scene, home or {}, folder) for _ in range(plan.repeats))


def _first_tick(scene: tuple[str, ...], home: dict[str, str], folder: str | None) -> float:
    command = [sys.executable, "-m", "benchmarks.programs.first_tick", "run", "--headless", *scene]
    begin = time.perf_counter()
    with subprocess.Popen(
        command, env={**environment(), **home}, cwd=folder or ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True,
    ) as child:  # fmt: skip
        assert child.stdout is not None
        late = threading.Timer(_PATIENCE, child.kill)
        late.start()
        said = []
        try:
            for line in child.stdout:
                if line == "first tick\n":
                    return time.perf_counter() - begin
                said.append(line)
        finally:
            late.cancel()
            child.kill()
    raise TrialFailed(f"{' '.join(scene)} had no first tick:\n{''.join(said[-5:])}")


def _first_poses(plan: Plan) -> float:
    return statistics.median(_first_pose() for _ in range(plan.repeats))


def _first_pose() -> float:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    words = ["run", "--headless", _ARENA, f"port={port}"]
    begin = time.perf_counter()
    with subprocess.Popen(
        [sys.executable, *_MORSE, *words], env=environment(), cwd=ROOT, stdout=subprocess.DEVNULL
    ) as child:
        try:
            line = _first_line(port, begin + _PATIENCE)
            seconds = time.perf_counter() - begin
        finally:
            child.terminate()
            child.wait(_PATIENCE)
    pose = msgspec.json.decode(line)
    wrong = beyond({"x": abs(pose["x"] - work.starts(1)[0][0])}, "x", 0.01)
    if wrong is not None:
        raise TrialFailed(f"the first pose is wrong: {wrong}")
    return seconds


def _first_line(port: int, until: float) -> bytes:
    while time.perf_counter() < until:
        with suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1.0) as connection:
            connection.settimeout(_PATIENCE)
            return connection.makefile("rb").readline()
        time.sleep(0.005)
    raise TimeoutError(f"no server on port {port}")
