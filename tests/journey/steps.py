"""The actions of a user who follows the tutorial: types commands, edits files, looks at the view."""

import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

BLOCKS = Path(__file__).parent / "blocks"


def block(name: str) -> str:
    """A piece of code of the tutorial, unchanged."""
    return (BLOCKS / name).read_text()


class Running:
    """A simulation that was started with ``morse run``."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.lines: list[str] = []
        self._queue: queue.Queue[str | None] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._queue.put(line.rstrip("\n"))
        self._queue.put(None)

    def until(self, text: str, limit: float = 60.0) -> str:
        """Read the log up to a line that contains ``text``."""
        end = time.monotonic() + limit
        while True:
            left = end - time.monotonic()
            assert left > 0, f"no line with {text!r} within {limit} s; the log:\n" + "\n".join(self.lines)
            try:
                line = self._queue.get(timeout=left)
            except queue.Empty:
                continue
            assert line is not None, f"the simulation ended before {text!r}; the log:\n" + "\n".join(self.lines)
            self.lines.append(line)
            if text in line:
                return line

    @property
    def url(self) -> str:
        """The address of the live view in the log."""
        found = [m.group() for line in self.lines for m in re.finditer(r"http://\S+", line)]
        assert found, "no address of the live view in the log:\n" + "\n".join(self.lines)
        return found[-1]

    def stop(self) -> None:
        """Press Ctrl+C, and check that it ends cleanly."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            self.until("EXITING SIMULATION")
        assert self.process.wait(60) == 0


class Person:
    """A user with an empty home directory and the tutorial."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        home = folder / "home"
        home.mkdir(exist_ok=True)
        dropped = ("MORSE_ROOT", "MORSE_RESOURCE_PATH", "MORSE_NODE", "DISPLAY", "WAYLAND_DISPLAY")
        kept = {key: value for key, value in os.environ.items() if key not in dropped}
        self.started: list[Running] = []
        self.environment = {**kept, "HOME": str(home), "PYTHONUNBUFFERED": "1"}
        self.morse = Path(sys.executable).with_name("morse")
        assert self.morse.exists(), "install the package first: the journey starts with the command 'morse'"

    @property
    def project(self) -> Path:
        return self.folder / "ranger_sim"

    def types(self, *command: str, answer: str = "", cwd: Path | None = None) -> str:
        """Run ``morse ...`` and return its output."""
        done = subprocess.run(
            [str(self.morse), *command],
            cwd=cwd or self.folder,
            env=self.environment,
            input=answer,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def runs(self, *arguments: str) -> Running:
        """``morse run ...``, until everything is ready."""
        process = subprocess.Popen(
            [str(self.morse), "run", *arguments],
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        running = Running(process)
        self.started.append(running)
        running.until("SCENE INITIALIZED")
        return running

    def leaves(self) -> None:
        """End all processes, whatever failed."""
        for running in self.started:
            if running.process.poll() is None:
                running.process.kill()

    def edits(self, script: str, blend: Path | None, *arguments: str) -> None:
        """Work on a model in Blender; None for a new file."""
        blender = shutil.which(os.environ.get("MORSE_BLENDER", "blender"))
        assert blender is not None, "the journey needs Blender: apt-get install blender"
        done = subprocess.run(
            [
                blender,
                *("-b", "--factory-startup", "-noaudio", *([] if blend is None else [str(blend)])),
                *("--python-exit-code", "3", "--python", str(Path(__file__).parent / script), "--", *arguments),
            ],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
