"""Worker processes on this machine."""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.many.worker import end_child, fork_worker
from morse.system.own_programs import command

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import TracebackType

    from morse.many.run import Run, Runs
    from morse.many.values import Row


class Task(NamedTuple):
    """One run, and the path of its recording or None."""

    run: Run
    record: str | None = None


#: variables that keep each worker on one processor
ONE_THREAD = dict.fromkeys(("MORSE_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def can_fork() -> bool:
    """Whether processes can be copied, with their simulations."""
    return hasattr(os, "fork") and hasattr(socket, "send_fds") and sys.platform != "darwin"


class Pool:
    """Workers that are forked from a process that has loaded the scene.

    A study whose functions only this process has is forked from this process.
    """

    def __init__(self, study: Runs, workers: int) -> None:
        self._study, self._most = study, workers
        self._busy: dict[socket.socket, tuple[Task, bytearray]] = {}
        self._idle: list[socket.socket] = []
        self._children: dict[socket.socket, int] = {}
        self._selector = selectors.DefaultSelector()
        reading, self._lifeline = os.pipe()
        self._reading = reading
        self._server: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        description = study.description()
        if description is not None:
            self._start_server(description)

    def _start_server(self, description: Row) -> None:
        self._control, theirs = socket.socketpair()
        with theirs:
            self._server = subprocess.Popen(
                command("morse.many.forking", str(theirs.fileno()), str(self._reading)),
                pass_fds=(theirs.fileno(), self._reading),
                env={**os.environ, **ONE_THREAD},
                stdin=subprocess.DEVNULL,
            )
        self._control.sendall(json.dumps([description, sys.path]).encode() + b"\n")
        if not self._control.recv(1):
            raise RuntimeError("the process that starts the workers has ended: see its message above")

    @property
    def has_room(self) -> bool:
        """Whether a worker is free."""
        return len(self._busy) < self._most

    @property
    def is_busy(self) -> bool:
        """Whether a run is under way."""
        return bool(self._busy)

    def submit(self, task: Task) -> None:
        """Give a run to a free worker."""
        worker = self._idle.pop() if self._idle else self._hire()
        self._busy[worker] = task, bytearray()
        self._selector.register(worker, selectors.EVENT_READ)
        message = [task.run.name, task.run.parameters, task.run.seed, task.record]
        with contextlib.suppress(OSError):  # it has died: `results` tells
            worker.sendall(json.dumps(message).encode() + b"\n")

    def _hire(self) -> socket.socket:
        ours, theirs = socket.socketpair()
        with theirs:
            if self._control is not None:
                try:
                    socket.send_fds(self._control, [b"w"], [theirs.fileno()])
                except OSError:
                    raise RuntimeError("the process that starts the workers has ended") from None
            else:
                others = [ours, *self._idle, *self._busy, _Descriptor(self._lifeline)]
                self._children[ours] = fork_worker(self._study, theirs, self._reading, others)
        return ours

    def results(self, timeout: float) -> Iterator[tuple[Task, Row | None]]:
        """Wait for results; yields each task with its row, or with None if its worker has died."""
        for key, _ in self._selector.select(timeout):
            worker: Any = key.fileobj
            task, message = self._busy[worker]
            try:
                part = worker.recv(1 << 16)
            except ConnectionError:
                part = b""
            message += part
            if part and not message.endswith(b"\n"):
                continue
            self._selector.unregister(worker)
            del self._busy[worker]
            if part:
                self._idle.append(worker)
                yield task, json.loads(message)
            else:
                self._bury(worker)
                yield task, None

    def _bury(self, worker: socket.socket) -> None:
        worker.close()
        if (child := self._children.pop(worker, None)) is not None:
            end_child(child)

    def close(self) -> None:
        """End all workers, also those that are busy."""
        os.close(self._lifeline)
        for worker in [*self._idle, *self._busy]:
            self._bury(worker)
        self._selector.close()
        if self._control is not None:
            self._control.close()
        if self._server is not None:
            try:
                self._server.wait(10.0)
            except subprocess.TimeoutExpired:
                self._server.send_signal(signal.SIGKILL)
                self._server.wait()
        os.close(self._reading)

    def __enter__(self) -> Pool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class _Descriptor:
    """A descriptor with a method ``close``."""

    def __init__(self, number: int) -> None:
        self._number = number

    def close(self) -> None:
        """Close it."""
        os.close(self._number)
