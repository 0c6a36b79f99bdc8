"""Files that change while a simulation runs: a module whose import does not end, a script that becomes a pipe."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest

from morse.builder.errors.script_error import Step
from morse.core.reports.faults import describe
from morse.launch.stuck_ticks import user_line
from morse.scene import SourceLine

if TYPE_CHECKING:
    from pathlib import Path

CLASS = "from morse.core.sensor import Sensor\n\nclass Slow(Sensor):\n    def default_action(self):\n        pass\n"
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
    with log.open("w") as out, subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT) as process:

        def said(text: str) -> None:
            end = time.monotonic() + 60.0
            while text not in log.read_text():
                assert process.poll() is None, log.read_text()
                assert time.monotonic() < end, log.read_text()
                time.sleep(0.1)

        try:
            said("SCENE INITIALIZED")
            module.write_text(CLASS + "\nwhile True:\n    pass\n")
            said(f"{module}:")
            process.send_signal(signal.SIGINT)
            said("Ctrl+C again")
            process.send_signal(signal.SIGINT)
            assert process.wait(60.0) == 130
        finally:
            process.kill()
