"""A part that does not end is named and left, and the process ends with its status."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event
from threading import enumerate as enumerate_threads
from typing import Any

import pytest

from morse.simulation.ending import FAULTS, Ending, threads_left

PART = """
import threading, time
from morse.core.sensor import Sensor

class Clinger(Sensor):
    def __init__(self, obj, parent=None):
        super().__init__(obj, parent)
        {start}

    def default_action(self):
        {action}

    def wait_for_ever(self):
        while True:
            time.sleep(0.05)  # here

    def hold_on(self):
        while True:
            try:
                while True:
                    time.sleep(0.05)  # here
            except BaseException:
                pass

    def finalize(self):
        {end}

class Last(Sensor):
    def finalize(self):
        print("the last one has ended", flush=True)
"""
SCENE = """
import sys
sys.path.insert(0, {folder!r})
from morse.builder import *
from clingers import Clinger, Last
robot = FakeRobot("robot")
robot.append(Clinger("clinger"))
robot.append(Last("last"))
Environment("empty", fastmode=True)
"""


HOLDING = """
import time
while True:
    try:
        print("held", flush=True)
        time.sleep(60.0)
    except BaseException:
        pass
"""


@pytest.fixture
def launch(tmp_path: Path) -> Any:
    started: list[subprocess.Popen[str]] = []

    def begin(start: str = "pass", action: str = "pass", end: str = "pass", *options: str) -> subprocess.Popen[str]:
        (tmp_path / "clingers.py").write_text(PART.format(start=start, action=action, end=end))
        (tmp_path / "scene.py").write_text(SCENE.format(folder=str(tmp_path)))
        command = [sys.executable, "-m", "morse", "run", "--headless", *options, str(tmp_path / "scene.py")]
        process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        started.append(process)
        return process

    yield begin
    for process in started:
        process.kill()
        process.wait()


@pytest.mark.parametrize(
    ("parts", "name"),
    [
        pytest.param({"end": "self.wait_for_ever()"}, "robot.clinger does not end", marks=pytest.mark.slow),
        pytest.param({"end": "threading.Event().wait()"}, "robot.clinger does not end", marks=pytest.mark.slow),
        pytest.param({"end": "self.hold_on()"}, "robot.clinger does not end", marks=pytest.mark.slow),
        (
            {"start": "threading.Thread(target=self.wait_for_ever, name='feeder').start()"},
            "thread 'feeder' does not end",
        ),
    ],
)
def test_a_run_ends(launch: Callable[..., Any], parts: dict[str, str], name: str) -> None:
    options = ("--duration", "0.2")
    process = launch(parts.get("start", "pass"), "pass", parts.get("end", "pass"), *options)
    said, _ = process.communicate(timeout=60)
    # a thread that is left has not touched the run, a component that does not end is a part of it that has failed
    assert process.returncode == (FAULTS if "end" in parts else 0), said
    (line,) = [one for one in said.splitlines() if name in one]
    assert "clingers.py:" in line
    assert "robot.clinger" in line
    assert ("robot.clinger failed and is left: it does not end (" in said) == ("end" in parts)
    if "hold_on" not in parts.get("end", ""):
        assert "the last one has ended" in said


@pytest.mark.parametrize(
    "change",
    [
        "import sys; sys.stdout = None",
        pytest.param("import sys; sys.stdout = sys.stderr = None", marks=pytest.mark.slow),
        pytest.param("import sys; sys.setrecursionlimit(50)", marks=pytest.mark.slow),
        pytest.param("import sys; sys.excepthook = threading.excepthook = None", marks=pytest.mark.slow),
        pytest.param("import os; os.closerange(3, 256)", marks=pytest.mark.slow),
        pytest.param("import logging; logging.disable(); logging.getLogger().handlers.clear()", marks=pytest.mark.slow),
        pytest.param("import resource; resource.setrlimit(resource.RLIMIT_NOFILE, (3, 256))", marks=pytest.mark.slow),
    ],
)
def test_a_run_whose_process_was_changed_ends(launch: Callable[..., Any], change: str) -> None:
    process = launch("pass", change, "pass", "--duration", "0.2")
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 0, said


def test_a_thread_that_cannot_start_hides_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    ending = Ending()
    monkeypatch.setattr("threading.Thread.start", None)
    with pytest.raises(TypeError, match="not callable"):
        ending.run("robot.arm", lambda: None)
    ending.rest()


@pytest.mark.parametrize("action", [pytest.param("self.wait_for_ever()", marks=pytest.mark.slow), "self.hold_on()"])
def test_ctrl_c_twice_ends_a_tick(launch: Callable[..., Any], action: str) -> None:
    process = launch("pass", f"print('acting', flush=True); {action}")
    for line in process.stdout:
        if line.startswith("acting"):
            break
    end = time.monotonic() + 60
    while process.poll() is None and time.monotonic() < end:
        process.send_signal(signal.SIGINT)
        time.sleep(1.0)  # a user who presses it again and again
    assert process.poll() == 130, process.stdout.read()


def test_ctrl_c_twice_ends_a_scene_script(tmp_path: Path) -> None:
    (tmp_path / "holding.py").write_text(HOLDING)
    command = [sys.executable, "-m", "morse", "run", "--headless", str(tmp_path / "holding.py")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            for _ in range(2):
                while not process.stdout.readline().startswith("held"):
                    assert process.poll() is None
                process.send_signal(signal.SIGINT)
            assert process.wait(60) == 130
        finally:
            process.kill()


def test_a_second_ctrl_c_within_a_write_ends_the_process() -> None:
    program = (
        "import sys\n"
        "from morse.cli.run import _leave\n"
        "class Busy:\n"
        "    def flush(self): raise RuntimeError('reentrant call inside BufferedWriter')\n"
        "sys.stdout = Busy()\n"
        "_leave(130)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (130, b"")


def test_ctrl_c_at_the_end_does_not_wait_for_the_limit(launch: Callable[..., Any]) -> None:
    process = launch("pass", "pass", "print('ending', flush=True); self.wait_for_ever()", "--duration", "0.2")
    for line in process.stdout:
        if line.startswith("ending"):
            break
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    (line,) = [one for one in said.splitlines() if "robot.clinger does not end" in one]
    assert float(line.partition(" after ")[2].split()[0]) < 5.0


def test_the_limit_by_a_clock(caplog: pytest.LogCaptureFixture) -> None:
    now = [0.0]

    def endless() -> None:
        now[0] = 6.0
        while True:
            time.sleep(0.001)

    ending = Ending(5.0, lambda: now[0])
    ending.run("robot.arm", endless)
    ending.run("robot.leg", lambda: None)
    (line,) = caplog.messages
    assert "robot.arm does not end: after 6.0 s it is left at" in line
    assert "test_the_end_has_a_limit.py:" in line


def test_idle_threads_of_executors_are_not_waited_for(caplog: pytest.LogCaptureFixture) -> None:
    with ThreadPoolExecutor(2) as pool:
        pool.submit(int).result()
        threads_left(3, leave=lambda status: pytest.fail("the process was left"), limit=60.0)
    assert not caplog.records


def test_busy_threads_of_executors_are_named(caplog: pytest.LogCaptureFixture) -> None:
    statuses: list[int] = []
    release = Event()
    with ThreadPoolExecutor(1, thread_name_prefix="busy") as pool:
        pool.submit(release.wait)
        threads_left(3, leave=statuses.append, limit=0.0)
        release.set()
    assert statuses == [3]
    assert "busy_0" in caplog.text


def test_the_thread_that_watches_the_end_ends_too() -> None:
    before = set(enumerate_threads())
    ending = Ending()
    for _ in range(2):
        ending.run("a part", lambda: None)
        ending.run("another part", lambda: None)
        (watch,) = set(enumerate_threads()) - before
        ending.rest()
        assert not watch.is_alive()
