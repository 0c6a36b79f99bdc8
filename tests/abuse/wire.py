"""Raw clients: some well-behaved, some not."""

from __future__ import annotations

import contextlib
import json
import re
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.kit.programs import Line

HZ = 60


class Witness(threading.Thread):
    """A well-behaved client that records errors: at the end, `errors` must be empty.

    It must get every message of a sensor, and a right answer to every call.
    """

    def __init__(self, port: int, stream: int) -> None:
        super().__init__()
        self.errors: list[str] = []
        self.messages = self.calls = 0
        self.slowest = 0.0
        self._port, self._stream = port, stream
        self._ending = threading.Event()

    def run(self) -> None:
        try:
            services, pose = Line(self._port), Line(self._stream)
            listening = threading.Thread(target=self._guarded, args=[self._listen, pose])
            listening.start()
            self._guarded(self._ask, services)
            listening.join()
            services.close()
            pose.close()
        except Exception as error:
            self.errors.append(repr(error))

    def _guarded(self, work: Callable[[Line], None], line: Line) -> None:
        try:
            work(line)
        except Exception as error:
            self.errors.append(repr(error))

    def _listen(self, pose: Line) -> None:
        # the first message may have been made for a reader who left before this one came, and ticks without readers
        # make none: the messages of all ticks follow from the second one on
        pose.read()
        last = None
        while not self._ending.is_set():
            tick = round(json.loads(pose.read())["timestamp"] * HZ)
            if last is not None and tick != last + 1:
                self.errors.append(f"after the message of tick {last} came that of tick {tick}")
            last = tick
            self.messages += 1

    def _ask(self, services: Line) -> None:
        while not self._ending.wait(0.005):
            begin = time.monotonic()
            services.send(b"17 simulation list_robots\n")
            answer = services.read()
            self.slowest = max(self.slowest, time.monotonic() - begin)
            self.calls += 1
            if answer != b'17 SUCCESS ["anna", "bert"]\n':
                self.errors.append(f"an answer was {answer!r}")

    def __enter__(self) -> Witness:
        self.start()
        self.wait_for(3)
        return self

    def wait_for(self, messages: int) -> None:
        """Wait for a number of further messages and answers."""
        goals = self.messages + messages, self.calls + messages
        deadline = time.monotonic() + 60.0
        while (self.messages, self.calls) < goals or self.calls < goals[1]:
            if self.errors or not self.is_alive() or time.monotonic() > deadline:
                raise AssertionError(f"{self.messages} messages, {self.calls} answers; {self.errors}")
            time.sleep(0.005)

    def __exit__(self, kind: Any, *_: object) -> None:
        try:
            if kind is None:
                self.wait_for(10)
        finally:
            self._ending.set()
            self.join(60.0)
        if kind is None:
            assert self.errors == []
            assert not self.is_alive()


class Footprint:
    """Memory, descriptors and threads of a process."""

    def __init__(self, pid: int) -> None:
        self._place = Path("/proc", str(pid))

    @classmethod
    def possible(cls) -> bool:
        return Path("/proc/self/smaps_rollup").exists()

    @property
    def memory(self) -> int:
        """Anonymous memory that it has written to, bytes.

        Memory of files is excluded: it becomes private when another process that has mapped the same libraries ends.
        """
        text = (self._place / "smaps_rollup").read_text()
        return 1024 * sum(int(size) for size in re.findall(r"^(?:Anonymous|Swap): +(\d+) kB", text, re.MULTILINE))

    @property
    def descriptors(self) -> int:
        return len(list((self._place / "fd").iterdir()))

    @property
    def threads(self) -> int:
        return len(list((self._place / "task").iterdir()))


def drained(line: Line, seconds: float = 30.0) -> bytes:
    """All data until the other side closes."""
    received = b""
    line.socket.settimeout(seconds)
    with contextlib.suppress(ConnectionResetError):
        while data := line.socket.recv(1 << 20):
            received += data
    return received
