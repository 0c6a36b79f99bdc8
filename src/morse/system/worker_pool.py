"""Processes that answer questions: how they are started, asked, replaced and ended, for all parts of MORSE.

The executors of `concurrent.futures` give functions to processes that keep nothing, and all that a
`ProcessPoolExecutor` does has failed as soon as one of its processes dies. The processes here keep what takes long to
make: the rows of a vector, the scenes of cameras, the scene of a study. The end of one costs a single question. What
they do is a `concurrent.futures.Future`, as with any other executor.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import socket
import struct
import sys
import threading
import weakref
from concurrent.futures import Future
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeAlias, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

#: variables that keep each worker on one processor
ONE_THREAD = dict.fromkeys(("MORSE_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
#: wall-clock time after which a worker that was told to end is killed, s
GRACE = 5.0
#: the number of a question, before it and before its answer
_NUMBER = struct.Struct("<Q")
#: bytes of the largest message; a length beyond it is no length, but something else
_MOST = 1 << 32

#: the ends of connections that belong to this process; copies of it must not keep them open
_own: weakref.WeakSet[Connection] = weakref.WeakSet()
#: a copy that is made meanwhile would keep the other end of a new connection open
_starting = threading.Lock()


def _forget_others() -> None:
    """In a copy of this process: nobody there holds the lock, or asks the workers."""
    global _starting
    _starting = threading.Lock()
    for connection in list(_own):
        with contextlib.suppress(OSError):
            connection.close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_others)


class WorkerError(RuntimeError):
    """A worker has ended, or does not answer; the text says why: `` by SIGKILL``, or nothing."""


def can_fork() -> bool:
    """Whether processes can be copied, with their simulations."""
    return hasattr(os, "fork") and hasattr(socket, "send_fds") and sys.platform != "darwin"


def kind_of_start() -> str:
    """How copies of this process are started; those that are spawned need a ``__main__`` guard in the program."""
    return "fork" if can_fork() else "spawn"


# -- the process that asks -----------------------------------------------------------------


class Worker:
    """A process that answers one question after the other.

    It speaks on a connection of its own: what is printed in it is no answer. Each answer has the number of its
    question; that of an earlier question, which nobody waits for any more, is discarded.

    Args:
        connection: the end of this process.
        process: the other one.
    """

    def __init__(self, connection: Connection, process: BaseProcess) -> None:
        self._connection, self._process = connection, process
        self._asked = 0
        _own.add(connection)

    @classmethod
    def copy(cls, server: Callable[..., Server], *arguments: object) -> Worker:
        """Start a copy of this process; on systems without copies a new one, which imports the main program.

        Args:
            server: called with the arguments in the worker.

        Raises:
            AttributeError, TypeError, pickle.PicklingError: the arguments cannot be sent to a new process.
        """
        context: Any = multiprocessing.get_context(kind_of_start())
        with _starting:
            ours, theirs = context.Pipe()
            with theirs:
                _own.add(ours)
                process = context.Process(target=_copied, args=(theirs, server, arguments), daemon=True)
                process.start()
        return cls(ours, process)

    @property
    def pid(self) -> int | None:
        """The number of the process."""
        return self._process.pid

    @property
    def is_alive(self) -> bool:
        """Whether the process has not ended."""
        return self._process.is_alive()

    def send(self, question: bytes) -> None:
        """Ask; if the process has ended, `receive` says so."""
        self._asked += 1
        with contextlib.suppress(OSError):
            self._connection.send_bytes(_NUMBER.pack(self._asked) + question)

    def receive(self) -> bytes:
        """Return the answer to the last question.

        Raises:
            WorkerError: the process has ended.
        """
        try:
            while True:
                answer = self._connection.recv_bytes(_MOST)
                if answer[: _NUMBER.size] == _NUMBER.pack(self._asked):
                    return answer[_NUMBER.size :]
        except (EOFError, OSError):
            raise WorkerError(self._cause()) from None

    def _cause(self) -> str:
        """What has ended the process, as the continuation of a sentence."""
        self._process.join(1.0)
        code = self._process.exitcode
        if code is None or code >= 0:
            return ""
        name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
        return f" by {name}, perhaps because there was no memory left" if name == "SIGKILL" else f" by {name}"

    def close(self) -> None:
        """End the process."""
        close_all([self])

    def kill(self) -> None:
        """End the process at once."""
        self._process.kill()

    def hang_up(self) -> None:
        """Let the process end when it likes; it ends at once if it has not answered yet."""
        self._connection.close()

    def end(self) -> None:
        """Wait until the process has ended; kill it if it does not."""
        self._process.join(GRACE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def close_all(workers: Iterable[Worker]) -> None:
    """End workers, all at the same time."""
    every = list(workers)
    for worker in every:
        worker.hang_up()
    for worker in every:
        worker.end()


class Closable(Protocol):
    """What a thread of a pool works with."""

    def close(self) -> None:
        """End it."""


W = TypeVar("W", bound=Closable)
T = TypeVar("T")
#: a result, or the error instead of it
_Outcome: TypeAlias = tuple[Any, BaseException | None]


class WorkerPool(Generic[W]):
    """Threads that call functions with workers, each thread with its own.

    Only these threads speak with workers. An error that interrupts the thread that waits, such as Ctrl+C or one of a
    signal handler, therefore interrupts no exchange: it is completed, and the next one begins after it.

    Args:
        count: number of threads.
        start: starts the worker of a thread, when it is needed.
    """

    def __init__(self, count: int, start: Callable[[], W]) -> None:
        self._start = start
        self._jobs: SimpleQueue[tuple[Callable[[_Outcome], object], Callable[[W], Any]] | None] = SimpleQueue()
        # daemons: a worker that never answers must not hold the end of the program
        self._threads = [threading.Thread(target=self._run, name="morse-worker", daemon=True) for _ in range(count)]
        for thread in self._threads:
            thread.start()

    def submit(self, job: Callable[[W], T]) -> Future[T]:
        """Let a thread call a function with its worker."""
        future: Future[T] = Future()

        def done(outcome: _Outcome) -> None:
            result, error = outcome
            future.set_exception(error) if error is not None else future.set_result(result)

        self._jobs.put((done, job))
        return future

    def call(self, job: Callable[[W], T]) -> T:
        """Let a thread call a function with its worker, and wait for the result.

        Unlike the lock of a future, the queue of the answer is whole whenever the wait is interrupted.
        """
        outcomes: SimpleQueue[_Outcome] = SimpleQueue()
        self._jobs.put((outcomes.put, job))
        result, error = outcomes.get()
        if error is not None:
            raise error
        return result  # type: ignore[no-any-return] # of the job

    def _run(self) -> None:
        worker: W | None = None
        while (work := self._jobs.get()) is not None:
            done, job = work
            try:
                worker = self._start() if worker is None else worker
                outcome: _Outcome = job(worker), None
            except BaseException as error:
                outcome = None, error
            done(outcome)
            del done, job, work, outcome
        if worker is not None:
            worker.close()

    def close(self, patience: float | None = None) -> bool:
        """Let the threads end their workers, after what was submitted.

        Args:
            patience: longest time to wait for them, s.

        Returns:
            Whether they have ended.
        """
        for _ in self._threads:
            self._jobs.put(None)
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join(patience)
        return not any(thread.is_alive() for thread in self._threads)


# -- the process that answers --------------------------------------------------------------


class Server(Closable, Protocol):
    """What a worker does."""

    def answer(self, question: bytes) -> bytes:
        """Answer a question."""


def _copied(connection: Connection, server: Callable[..., Server], arguments: tuple[Any, ...]) -> None:
    os.environ.update(ONE_THREAD)
    serve(connection, lambda: server(*arguments))


def serve(connection: Connection, start: Callable[[], Server]) -> None:
    """Answer questions until the other process closes the connection or ends; a question that is open is then left."""
    # Ctrl+C reaches all processes of a terminal: the one that asks decides what it means
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    questions, server = _Questions(connection), start()
    while (question := questions.get()) is not None:
        number, text = question[: _NUMBER.size], question[_NUMBER.size :]
        message = number + server.answer(text)
        questions.answered += 1
        with contextlib.suppress(OSError):  # nobody waits any more
            connection.send_bytes(message)
    server.close()


class _Questions(SimpleQueue[bytes | None]):
    """Reads questions, so that the end of the other process is noticed while one is being answered."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self.asked = self.answered = 0
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        with contextlib.suppress(EOFError, OSError):
            while True:
                question = self._connection.recv_bytes(_MOST)
                self.asked += 1
                self.put(question)
        if self.asked > self.answered:
            os._exit(1)
        self.put(None)
