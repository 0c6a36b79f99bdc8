"""Files that change while a simulation runs: a module whose import does not end, a script that becomes a pipe."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from websockets.sync import client

from morse.builder.errors.script_error import Step
from morse.builder.script import load_scene
from morse.core.reports.faults import describe
from morse.launch import stuck_ticks
from morse.launch.rereading import Rereading
from morse.launch.stuck_ticks import user_line
from morse.scene import SourceLine
from morse.simulation.options import RunOptions
from morse.simulation.watching import watch
from morse.viewer.protocol import VERSION

CLASS = "from morse.core.sensor import Sensor\n\nclass Slow(Sensor):\n    def default_action(self):\n        pass\n"
ENDLESS = "\nwhile True:\n    pass\n"
EDITED = 'from morse.builder import *\nrobot = FakeRobot("robot")\nEnvironment("empty")\n'
MINUTE = 60.0
SCENE = """
import sys
sys.path.insert(0, {folder!r})
from morse.builder import *
from slow_class import Slow
robot = FakeRobot("robot")
robot.append(Slow("slow"))
Environment("empty")
"""


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="without pipes in the file system")
def test_errors_are_described_although_their_files_have_become_pipes_or_large(tmp_path: Path) -> None:
    file = tmp_path / "fault.py"
    lines = {}
    for kind in ("file", "large", "pipe"):
        file.unlink(missing_ok=True)
        file.write_text("def fail():\n    raise ValueError('here')\n")
        names: dict[str, object] = {"__name__": "fault"}
        exec(compile(file.read_text(), str(file), "exec"), names)
        if kind == "large":
            with file.open("a") as end:
                end.write("#" * (3 << 20))
        if kind == "pipe":
            file.unlink()
            os.mkfifo(file)
        try:
            names["fail"]()  # type: ignore[operator]
        except ValueError as error:
            lines[kind] = describe(error)
        assert str(Step(SourceLine(str(file), 2))).startswith(f"{file}:2")
    assert "raise ValueError('here')" in lines["file"]
    for kind in ("large", "pipe"):
        assert f'File "{file}", line 2, in fail' in lines[kind]
        assert "raise ValueError" not in lines[kind]
    assert user_line(sys._getframe()) is None


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl+C cannot be sent to one process")
def test_a_saved_class_whose_import_does_not_end_is_named_and_ended(tmp_path: Path) -> None:
    module, log = tmp_path / "slow_class.py", tmp_path / "log.txt"
    module.write_text(CLASS)
    (tmp_path / "scene.py").write_text(SCENE.format(folder=str(tmp_path)))
    command = [sys.executable, "-u", "-m", "morse", "run", "--headless", "--watch", str(tmp_path / "scene.py")]
    _stop_twice(command, log, "SCENE INITIALIZED", lambda: module.write_text(CLASS + ENDLESS), str(module))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl+C cannot be sent to one process")
def test_an_edited_script_that_does_not_end_is_named_and_ended(tmp_path: Path) -> None:
    """It is executed again when a page restarts the simulation."""
    script, log = tmp_path / "scene.py", tmp_path / "log.txt"
    script.write_text(EDITED)
    command = [sys.executable, "-u", "-m", "morse", "run", "--no-browser", "--view-port", "0", str(script)]

    def restart() -> None:
        script.write_text(EDITED + ENDLESS)
        port = int(re.findall(r"the live view is at http://127.0.0.1:(\d+)", log.read_text())[0])
        with client.connect(f"ws://127.0.0.1:{port}/ws") as websocket:
            websocket.send(json.dumps({"type": "hello", "version": VERSION}))
            while '"seat"' not in str(websocket.recv(MINUTE)):
                pass
            websocket.send('{"type": "reset"}')

    _stop_twice(command, log, "the live view is at", restart, str(script))


def _stop_twice(command: list[str], log: Path, ready: str, endless: Callable[[], object], place: str) -> None:
    """Run something that does not end, until the log names it, and end it by two signals."""
    with log.open("w") as out, subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT) as process:

        def said(text: str) -> None:
            end = time.monotonic() + MINUTE
            while text not in log.read_text():
                assert process.poll() is None, log.read_text()
                assert time.monotonic() < end, log.read_text()
                time.sleep(0.1)

        try:
            said(ready)
            endless()
            said(f"{place}:")
            process.send_signal(signal.SIGINT)
            said("Ctrl+C again")
            process.send_signal(signal.SIGINT)
            assert process.wait(MINUTE) == 130
        finally:
            process.kill()


def test_the_line_of_an_edited_script_is_known_while_it_is_executed(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(EDITED)
    options = RunOptions(str(script))
    scene = load_scene(options)
    scene.project.stay()
    rereading = Rereading(options, scene, {})
    probe = "import sys\nfrom morse.launch import stuck_ticks as s\ns.lines.append(s.user_line(sys._getframe()))\n"
    script.write_text(EDITED + probe)
    stuck_ticks.lines = []  # type: ignore[attr-defined]
    try:
        assert rereading.start_anew(SimpleNamespace(observers=[], view=None, stop=list))  # type: ignore[arg-type]
        assert stuck_ticks.lines == [f"{script}:{EDITED.count(chr(10)) + 3}, in <module>"]  # type: ignore[attr-defined]
    finally:
        del stuck_ticks.lines  # type: ignore[attr-defined]
        (rereading.successor[0] if rereading.successor else scene).project.leave()


def test_a_file_that_is_read_for_ever_is_left_at_the_end(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    begun, over = threading.Event(), threading.Event()

    def prepare(_simulation: object, _path: str) -> None:
        begun.set()
        over.wait(MINUTE)

    monkeypatch.setattr(watch, "prepare", prepare)
    monkeypatch.setattr(watch, "_FAREWELL", 0.05)
    scene = SimpleNamespace(project=None, models=[])
    simulation: Any = SimpleNamespace(options=SimpleNamespace(script="scene.py"), scene=scene, reread=None)
    watching = watch.Watch(simulation)
    watching._unread["large.urdf"] = time.monotonic()
    assert begun.wait(MINUTE)
    watching.close()
    assert "large.urdf is still being read" in caplog.text
    over.set()
    watching._thread.join(MINUTE)
    assert not watching._thread.is_alive()
