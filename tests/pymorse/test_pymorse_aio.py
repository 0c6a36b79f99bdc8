"""pymorse with asyncio: the same names, awaited; and connections that come back."""

import asyncio
import logging
import math
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import morse
from pymorse import Morse, MorseServiceFailed, MorseServicePreempted
from tests.kit.programs import free_port, python
from tests.kit.waiting import run_apart, wait_until

pytestmark = pytest.mark.long

SCENE = """
from morse.builder import *
robot = ATRV()
motion = MotionVW(); robot.append(motion)
wp = Waypoint(); robot.append(wp)
pose = Pose(); robot.append(pose)
robot.add_default_interface("socket")
env = Environment("empty")
"""
LIMIT = 60.0


class Running:
    """A simulation that runs in a thread."""

    def __init__(self, scene: Path, monkeypatch: pytest.MonkeyPatch, port: int = 0) -> None:
        self.port = port or free_port()
        monkeypatch.setenv("MORSE_SOCKET_PORT", str(self.port))
        self.sim = morse.load(scene, sockets=True)
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        while not self._end.wait(0.002):
            self.sim.step()

    def close(self) -> None:
        self._end.set()
        self._thread.join()
        self.sim.close()


@pytest.fixture
def running(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Running]:
    (tmp_path / "scene.py").write_text(SCENE)
    one = Running(tmp_path / "scene.py", monkeypatch)
    yield one
    one.close()


def test_everything_is_awaited_under_the_same_names(running: Running) -> None:
    async def program() -> None:
        async with Morse(port=running.port) as simu:
            assert simu.robots == ["robot"]
            first = await simu.robot.pose.get()
            assert set(first) >= {"x", "y", "z", "yaw"}
            simu.robot.motion.publish({"v": 1.0, "w": 0.0})
            await simu.robot.motion.publish({"v": 1.0})
            async with asyncio.timeout(LIMIT):
                async for data in simu.robot.pose:
                    if data["x"] > first["x"] + 0.2:
                        break
            assert await simu.robot["motion"].set_speed(0.0, 0.0) is None
            assert await simu.rpc("simulation", "list_robots") == ["robot"]
            before = await simu.time()
            await simu.sleep(0.1)
            assert await simu.time() >= before + 0.1
            assert (await simu.robot.pose.last())["x"] > first["x"]
            # many at once, more than there are threads
            several = await asyncio.gather(*[simu.robot.pose.get() for _ in range(50)])
            assert len(several) == 50
            exchanged = await simu.exchange({simu.robot.motion: {"v": 0.5}}, [simu.robot.pose, "robot.pose"], 2)
            assert len(exchanged) == 2
            await simu.resume()

    run_apart(program())


def test_errors_timeouts_and_cancellation(running: Running) -> None:
    async def program() -> None:
        async with Morse(port=running.port) as simu:
            with pytest.raises(MorseServiceFailed):
                await simu.rpc("simulation", "delete", "nobody")
            with pytest.raises(TypeError):
                await simu.robot.motion.set_speed(1.0)
            with pytest.raises(AttributeError, match="pose"):
                _ = simu.robot.poze
            with pytest.raises(AttributeError, match=r"use publish\(\)"):
                await simu.robot.motion.get()
            assert await simu.robot.pose.get(timeout=0.0) is None
            # to cancel the task aborts the service
            task = simu.robot.wp.goto(1000.0, 0.0, 0.0)
            await asyncio.sleep(0.1)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            again = simu.robot.wp.goto(1000.0, 0.0, 0.0)
            await asyncio.sleep(0.1)
            simu.robot.wp.goto(999.0, 0.0, 0.0)
            with pytest.raises(MorseServicePreempted):
                await asyncio.wait_for(again, LIMIT)
            raise KeyError("ends the running services")

    with pytest.raises(KeyError):
        run_apart(program())


def test_callbacks_run_in_the_loop(running: Running) -> None:
    async def program() -> None:
        threads: list[int] = []
        coroutines: list[Any] = []

        async def slow(data: Any) -> None:
            coroutines.append(data)

        async with Morse(port=running.port) as simu:
            pose = simu.robot.pose
            pose.subscribe(lambda data: threads.append(threading.get_ident()))
            pose.subscribe(slow)
            async with asyncio.timeout(LIMIT):
                while len(threads) < 3 or len(coroutines) < 3:
                    await asyncio.sleep(0.01)
            simu.robot.pose.unsubscribe(slow)
            assert set(threads) == {threading.get_ident()}

    run_apart(program())


def test_callbacks_that_always_fail_print_one_traceback_each(
    running: Running, caplog: pytest.LogCaptureFixture
) -> None:
    async def program() -> None:
        calls: list[str] = []
        unheard: list[Any] = []

        def fail(data: Any) -> None:
            calls.append("function")
            raise KeyError("nope")

        async def fail_later(data: Any) -> None:
            calls.append("coroutine")
            raise KeyError("never")

        asyncio.get_running_loop().set_exception_handler(lambda loop, context: unheard.append(context))
        async with Morse(port=running.port) as simu:
            simu.robot.pose.subscribe(fail)
            simu.robot.pose.subscribe(fail_later)
            async with asyncio.timeout(LIMIT):
                while min(calls.count("function"), calls.count("coroutine")) < 9:
                    await asyncio.sleep(0.01)
        assert unheard == []

    run_apart(program())
    told = [record.exc_info[1].args for record in caplog.records if record.exc_info and record.exc_info[1]]
    assert sorted(told) == [("never",), ("nope",)]


@pytest.mark.parametrize("binary", [False, True])
def test_a_connection_comes_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, binary: bool
) -> None:
    (tmp_path / "scene.py").write_text(SCENE)
    first = Running(tmp_path / "scene.py", monkeypatch)
    seen: list[Any] = []
    with caplog.at_level(logging.WARNING, "pymorse"), Morse(port=first.port, binary=binary, reconnect=True) as simu:
        simu.robot.pose.subscribe(seen.append)
        wait_until(lambda: bool(seen), limit=LIMIT)
        first.close()
        wait_until(lambda: not simu.is_up(), limit=LIMIT)
        with pytest.raises(ConnectionError):
            simu.time()
        second = Running(tmp_path / "scene.py", monkeypatch, first.port)
        try:
            wait_until(simu.is_up, limit=LIMIT)
            wait_until(lambda: "again, after" in caplog.text, limit=LIMIT)
            count = len(seen)
            wait_until(lambda: len(seen) > count, limit=LIMIT)
            assert simu.time() >= 0.0
            assert simu.robot.pose.get(LIMIT) is not None
            simu.robot.motion.publish({"v": 1.0})
            wait_until(lambda: simu.robot.pose.get(LIMIT)["x"] > 0.05, limit=LIMIT)
        finally:
            second.close()
    assert "trying to connect again" in caplog.text


def test_the_types_of_a_simulation_are_those_that_a_checker_uses(running: Running, tmp_path: Path) -> None:
    module, program = tmp_path / "my_scene.py", tmp_path / "program.py"
    command = [sys.executable, "-m", "pymorse", "localhost", str(running.port)]
    module.write_text(subprocess.run(command, capture_output=True, text=True, check=True, timeout=LIMIT).stdout)
    program.write_text(
        f"from my_scene import Simulation\nwith Simulation(port={running.port}) as simu:\n"
        "    data = simu.robot.pose.get()\n    assert data is not None\n    x: float = data['x']\n"
        "    simu.robot.motion.publish({'v': 1.0})\n    simu.robot.motion.set_speed(0.0, 0.0).result()\n    print(x)\n"
    )
    said = python(program, folder=tmp_path)
    assert math.isfinite(float(said.stdout)), said.stderr
    check = [sys.executable, "-m", "mypy", "--no-incremental", "program.py"]
    assert subprocess.run(check, capture_output=True, text=True, timeout=LIMIT, cwd=tmp_path).returncode == 0
    for wrong in ("data['x']", "data['height']"), ("publish({'v': 1.0})", "publish(1.0)"):
        text = program.read_text()
        program.write_text(text.replace(*wrong))
        assert subprocess.run(check, capture_output=True, text=True, timeout=LIMIT, cwd=tmp_path).returncode == 1, wrong
        program.write_text(text)
