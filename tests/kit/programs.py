"""Other programs in tests: their ports, their results, and those that a simulation talks with."""

import json
import multiprocessing
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from multiprocessing.pool import Pool
from pathlib import Path
from typing import Any, NamedTuple

#: s, after which a program counts as lost
_LIMIT = 200.0
#: what a process executes that imports the packages beside the tests, and these
BESIDE = f"import sys; sys.path.append({str(Path(__file__).parents[2])!r})"
#: what a process executes that runs several commands of ``morse``
_COMMANDS = """
import contextlib, io, json, os, sys
from morse.cli.app import execute
for folder, words in json.loads(sys.argv[1]):
    os.chdir(folder)
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        status = execute(words)
    print(json.dumps([status, out.getvalue(), err.getvalue()]))
"""


def new_processes(count: int = 1) -> Pool:
    """Processes that start anew, as on Windows."""
    return multiprocessing.get_context("spawn").Pool(count, exec, (BESIDE,))


def free_ports(count: int, kind: socket.SocketKind = socket.SOCK_STREAM) -> list[int]:
    """Ports of 127.0.0.1 that no program uses now."""
    probes = [socket.socket(socket.AF_INET, kind) for _ in range(count)]
    try:
        for probe in probes:
            probe.bind(("127.0.0.1", 0))
        return [probe.getsockname()[1] for probe in probes]
    finally:
        for probe in probes:
            probe.close()


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """A port of 127.0.0.1 that no program uses now."""
    return free_ports(1, kind)[0]


class Line:
    """A connection of a client that speaks in lines, such as the services of a simulation; also a context manager."""

    def __init__(self, port: int, timeout: float = 60.0) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._lines = self.socket.makefile("rb")

    def __enter__(self) -> "Line":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def send(self, data: bytes) -> None:
        self.socket.sendall(data)

    def read(self) -> bytes:
        return self._lines.readline()

    def answer(self, component: str, service: str, *arguments: object) -> bytes:
        """Call a service; the line of its answer."""
        self.send(f"c {component} {service} {json.dumps(arguments)}\n".encode())
        return self.read()

    def call(self, component: str, service: str, *arguments: object) -> Any:
        """Call a service; its result, or an AssertionError."""
        number, status, *value = self.answer(component, service, *arguments).split(maxsplit=2)
        assert (number, status) == (b"c", b"SUCCESS"), value
        return json.loads(value[0]) if value else None

    def close(self) -> None:
        self._lines.close()
        self.socket.close()

    def vanish(self) -> None:
        """Close without a shutdown, like a program that is killed."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.close()


def python(
    *words: object, folder: Path | None = None, limit: float = 240.0, **more: object
) -> subprocess.CompletedProcess[str]:
    """Run Python with some arguments, and return its result with its output as texts.

    Args:
        folder: its working folder.
        limit: s; it is killed later.
        more: variables of its environment, in addition to those of this process.
    """
    return subprocess.run(
        [sys.executable, *map(str, words)],
        cwd=folder,
        env={**os.environ, **{name: str(value) for name, value in more.items()}},
        capture_output=True,
        encoding="utf-8",
        timeout=limit,
        check=False,
    )


class Outcome(NamedTuple):
    """How a command of ``morse`` has ended, and what it has said."""

    status: int
    out: str
    err: str


def commands(lines: Iterable[tuple[Path, Iterable[str]]], **more: object) -> list[Outcome]:
    """Run command lines of ``morse`` one after the other in one process: most of the time of one goes into the start.

    Args:
        lines: for each one the working folder, and the words after ``morse``.
        more: variables of the environment, in addition to those of this process.
    """
    text = json.dumps([(str(folder), list(words)) for folder, words in lines])
    done = python("-P", "-c", _COMMANDS, text, **more)
    assert done.returncode == 0, done.stderr
    return [Outcome(*json.loads(line)) for line in done.stdout.splitlines()]


def talk(command: list[str], step: Callable[[], object], environment: Mapping[str, str] | None = None) -> str:
    """Run a program, call a function until it has ended, and return its output.

    Raises:
        AssertionError: it fails, with what it says.
    """
    with tempfile.TemporaryFile("w+") as said, tempfile.TemporaryFile("w+") as complaints:
        # files, because an unread pipe would block the program
        with subprocess.Popen(command, stdout=said, stderr=complaints, env=environment) as other:
            end = time.monotonic() + _LIMIT
            try:
                while other.poll() is None and time.monotonic() < end:
                    step()
                    time.sleep(0.002)  # leaves the processor to the program
            finally:
                other.kill()
        for file in (said, complaints):
            file.seek(0)
        text = said.read()
        assert other.returncode == 0, text + complaints.read()
    return text
