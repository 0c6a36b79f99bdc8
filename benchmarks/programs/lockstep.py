"""W6: rounds per second of a TCP client that sends a command, steps one tick, and reads the pose.

``--with mujoco``: the bare loop. ``--with socket``: MORSE, plain sockets. ``--with pymorse``: MORSE, its Python client.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import select
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from benchmarks import stopwatch, work

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_COMMAND = json.dumps({"v": work.SPEED, "w": work.RATE}).encode() + b"\n"
_Pose = dict[str, Any]


@contextmanager
def _server(module: str, *arguments: str) -> Iterator[list[str]]:
    """A server process, and the words of its first line."""
    command = [sys.executable, "-m", module, *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        try:
            yield child.stdout.readline().split()
        finally:
            child.kill()


class _Line:
    """A connection for lines."""

    def __init__(self, port: str) -> None:
        self._socket = socket.create_connection(("127.0.0.1", int(port)))
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._lines = self._socket.makefile("rb")
        self.write = self._socket.sendall
        self.read = self._lines.readline

    def has_something(self, seconds: float) -> bool:
        """Whether data arrive within that time."""
        return bool(select.select([self._socket], [], [], seconds)[0])


@contextmanager
def with_mujoco() -> Iterator[Callable[[], _Pose]]:
    """One round with the bare loop."""
    with _server("benchmarks.peers.mujoco_loop", "lockstep") as (port,):
        line = _Line(port)

        def once() -> _Pose:
            line.write(_COMMAND)
            return dict(json.loads(line.read()))

        yield once


@contextmanager
def with_socket() -> Iterator[Callable[[], _Pose]]:
    """One round with MORSE: publish, call ``simulation step``, read the stream of the pose."""
    with _server("benchmarks.programs.serve") as (services, motion, pose):
        calls, commands, poses = _Line(services), _Line(motion), _Line(pose)

        def step() -> None:
            commands.write(_COMMAND)
            calls.write(b"1 simulation step\n")
            answer = calls.read()
            if b"SUCCESS" not in answer:
                raise RuntimeError(f"the simulation answers {answer!r}")

        def once() -> _Pose:
            step()
            return dict(json.loads(poses.read()))

        # the simulation may not know the new reader yet
        step()
        while not poses.has_something(0.2):
            step()
        poses.read()
        yield once


@contextmanager
def with_pymorse() -> Iterator[Callable[[], _Pose]]:
    """One round with pymorse, as a user would write it."""
    from pymorse import Morse

    with _server("benchmarks.programs.serve") as (services, *_), Morse(port=int(services)) as simu:
        simu.pause()
        robot = simu.r0

        def once() -> _Pose:
            robot.motion0.publish({"v": work.SPEED, "w": work.RATE})
            simu.step()
            return dict(robot.pose0.get_local_data().result())

        yield once


@contextmanager
def with_exchange() -> Iterator[Callable[[], _Pose]]:
    """One round with MORSE: the service ``simulation exchange`` takes the command and returns the pose."""
    command = json.dumps([{"r0.motion0": {"v": work.SPEED, "w": work.RATE}}, ["r0.pose0"]])
    line = f"1 simulation exchange {command}\n".encode()
    with _server("benchmarks.programs.serve") as (services, *_):
        calls = _Line(services)

        def once() -> _Pose:
            calls.write(line)
            _, status, value = calls.read().split(b" ", 2)
            if status != b"SUCCESS":
                raise RuntimeError(f"the simulation answers {value!r}")
            return dict(json.loads(value)["r0.pose0"])

        yield once


@contextmanager
def with_pymorse_exchange() -> Iterator[Callable[[], _Pose]]:
    """One round with the same service and pymorse."""
    from pymorse import Morse

    with _server("benchmarks.programs.serve") as (services, *_), Morse(port=int(services)) as simu:
        command, pose = {"r0.motion0": {"v": work.SPEED, "w": work.RATE}}, "r0.pose0"

        def once() -> _Pose:
            return dict(simu.exchange(command, [pose])[pose])

        yield once


_SERVERS = {
    "mujoco": with_mujoco,
    "socket": with_exchange,
    "pymorse": with_pymorse_exchange,
    "socket_streams": with_socket,
    "pymorse_streams": with_pymorse,
}


def main() -> None:
    """Run ``--rounds`` rounds."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--with", dest="server", choices=_SERVERS, required=True)
    parser.add_argument("--rounds", type=int, default=1000)
    arguments = parser.parse_args()
    os.environ.setdefault("MORSE_SOCKET_PORT", "0")
    with _SERVERS[arguments.server]() as once:
        for _ in range(20):
            once()
        begin, first = time.perf_counter(), once()
        for _ in range(arguments.rounds - 1):
            last = once()
        wall = time.perf_counter() - begin
    # ticks at constant speed along an arc: the chord is known
    half = work.RATE * (arguments.rounds - 1) / work.TICK / 2
    chord = 2 * work.SPEED / work.RATE * abs(math.sin(half))
    moved = ((last["x"] - first["x"]) ** 2 + (last["y"] - first["y"]) ** 2) ** 0.5
    stopwatch.report(rounds_per_s=arguments.rounds / wall, position_error_m=abs(moved - chord))


if __name__ == "__main__":
    main()
