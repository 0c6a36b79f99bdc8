"""Simulations in a process of their own with few file descriptors, and their clients."""

import os
import re
import signal
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.kit.waiting import wait_until

_MINUTE = 60.0
_START = """
import resource, runpy
resource.setrlimit(resource.RLIMIT_NOFILE, ({0}, {0}))
runpy.run_module("morse", run_name="__main__", alter_sys=True)
"""


class Run:
    """A running simulation.

    Attributes:
        process: its process.
    """

    def __init__(self, process: subprocess.Popen[bytes], log: Path) -> None:
        self.process, self._log = process, log

    @property
    def log(self) -> str:
        return self._log.read_text(encoding="utf-8", errors="replace")

    def port(self, pattern: str) -> int:
        """A port that the log names."""

        def find() -> re.Match[str] | None:
            assert self.process.poll() is None, self.log
            return re.search(pattern, self.log)

        return int(wait_until(find)[1])


@contextmanager
def limited_run(scene: str, folder: Path, descriptors: int, *options: str, **environment: str) -> Iterator[Run]:
    """A simulation that may open a number of descriptors; it must end without an error."""
    script, log = folder / "scene.py", folder / "log.txt"
    script.write_text(scene, encoding="utf-8")
    with log.open("wb") as output:
        process = subprocess.Popen(
            [sys.executable, "-c", _START.format(descriptors), "run", *options, str(script)],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env={**os.environ, "MORSE_SOCKET_PORT": "0", **environment},
        )
    run = Run(process, log)
    try:
        try:
            yield run
        except TimeoutError as error:
            raise AssertionError(f"no answer; the log:\n{run.log}") from error
        assert process.poll() is None, run.log
        process.send_signal(signal.SIGINT)
        process.wait(_MINUTE)
        assert "Traceback" not in run.log
        assert "Uncaught" not in run.log
    finally:
        process.kill()
        process.wait()


def told_once(log: str, text: str) -> bool:
    """Whether a log names an event once; counts of more of the kind may follow."""
    return len([line for line in log.splitlines() if text in line and "of this kind" not in line]) == 1


def connect(port: int) -> socket.socket:
    return socket.create_connection(("127.0.0.1", port), timeout=_MINUTE)


def reset(sock: socket.socket) -> None:
    """Close by a reset."""
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    sock.close()


def call(port: int, request: bytes = b"1 simulation get_all_stream_ports []\n") -> bytes:
    """The reply of a service on a new connection; empty if the connection is refused or closed."""
    try:
        with connect(port) as sock:
            sock.sendall(request)
            with sock.makefile("rb") as lines:
                return lines.readline()
    except ConnectionError:
        return b""


def is_closed(sock: socket.socket) -> bool:
    """Whether the other side has closed a connection."""
    sock.settimeout(0.0)
    try:
        while data := sock.recv(1 << 16):
            del data
    except BlockingIOError:
        return False
    except ConnectionError:
        return True
    finally:
        sock.settimeout(_MINUTE)
    return True
