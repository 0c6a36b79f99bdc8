"""The files and functions of MORSE that one command enters, from the socket to the wheel.

The longer this list is, the longer is the way of somebody who reads it with a debugger. Counted is the tick that takes
the command, with the functions of the network thread that receive it.
"""

from __future__ import annotations

import socket
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import morse

if TYPE_CHECKING:
    from types import FrameType

_SCENE = """
from morse.builder import *
robot = ATRV()
motion = MotionVW()
motion.add_stream("socket", port={port})
robot.append(motion)
env = Environment("empty", fastmode=True)
"""
_PACKAGE = Path(morse.__file__).parent
_PATIENCE = 60.0


class _Entered:
    """Counts calls of functions by file: of the last tick, and of all threads that start after `__init__`."""

    def __init__(self) -> None:
        self.is_on = False
        self.tick: Counter[str] = Counter()
        self.others: Counter[str] = Counter()
        threading.setprofile(lambda frame, event, _: self._count(self.others, frame, event))

    def step(self, sim: morse.Simulation) -> None:
        """Count one tick alone."""
        self.tick.clear()
        sys.setprofile(lambda frame, event, _: self._count(self.tick, frame, event))
        try:
            sim.step()
        finally:
            sys.setprofile(None)

    def _count(self, files: Counter[str], frame: FrameType, event: str) -> None:
        name = frame.f_code.co_filename
        if self.is_on and event == "call" and name.startswith(str(_PACKAGE)):
            files[Path(name).relative_to(_PACKAGE).as_posix()] += 1


def main() -> int:
    """Print each file with the number of calls, and the sums."""
    entered = _Entered()
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "scene.py"
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        script.write_text(_SCENE.format(port=port), encoding="utf-8")
        with morse.load(script, sockets=True) as sim:
            sim.step(10)
            speed = sim["robot"]["motion"].component.local_data
            with socket.create_connection(("127.0.0.1", port), _PATIENCE) as client:
                sim.step(10)
                entered.is_on = True
                client.sendall(b'{"v": 1.0, "w": 0.0}\n')
                end = time.monotonic() + _PATIENCE
                while speed["v"] != 1.0:
                    if time.monotonic() > end:
                        raise RuntimeError("the command has not arrived")
                    entered.step(sim)
                entered.is_on = False
    files = entered.tick + entered.others
    for name, calls in sorted(files.items()):
        print(f"{calls:5} {name}")
    print(f"{len(files)} files, {files.total()} calls")
    return 0
