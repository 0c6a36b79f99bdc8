"""Processes that answer questions: how they are started, asked, replaced and ended, for all parts of MORSE.

The executors of `concurrent.futures` give functions to processes that keep nothing, and all that a
`ProcessPoolExecutor` does has failed as soon as one of its processes dies. The processes here keep what takes long to
make: the rows of a vector, the scenes of cameras, the scene of a study. The end of one costs a single question. What
they do is a `concurrent.futures.Future`, as with any other executor.
"""

from __future__ import annotations

import contextlib
import io
import logging
import multiprocessing
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import weakref
from concurrent.futures import CancelledError, Future
from multiprocessing import connection as connections
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, NoReturn, Protocol, TypeAlias, TypeVar

from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess


def command(module: str, *words: str) -> list[str]:
    """The command line that runs a module of MORSE.

    The present folder is not searched for modules: it may be a folder of downloads, with a file such as ``json.py``.
    """
    return [sys.executable, "-P", "-m", module, *words]


def own_output() -> io.FileIO:
    """The pipe to the process that has started this one; from now on, what others print goes to the standard error.

    Scene scripts, classes of projects and libraries print to the standard output, and would get between the messages.
    The file has no buffer.
    """
    pipe = io.FileIO(os.dup(1), "wb")
    os.dup2(2, 1)
    return pipe


logger = logging.getLogger(__name__)

#: variables that keep each worker on one processor
ONE_THREAD = dict.fromkeys(("MORSE_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
#: wall-clock time after which a worker that was told to end is killed, s
GRACE = 5.0
#: the number of a question, before it and before its answer
_NUMBER = struct.Struct("<Q")
#: bytes of the largest message; a longer length is not a length, but something else: no text begins with a smaller one,
#: for whose rest the reader would wait
_MOST = (ord(" ") << 24) - 1
#: variables without which a program does not start on some systems
_NEEDED = ("SYSTEMROOT", "TMPDIR", "TEMP", "TMP", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH")

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


class Process(Protocol):
    """A process of `multiprocessing`, or a program that looks like one."""

    @property
    def exitcode(self) -> int | None:
        """Its status; that of a signal is negative."""

    def is_alive(self) -> bool:
        """Whether it has not ended."""

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end."""

    def kill(self) -> None:
        """End it at once."""


class _Program(subprocess.Popen[bytes]):
    """A program as a `Process`."""

    @property
    def exitcode(self) -> int | None:
        """See `Process`."""
        return self.poll()

    def is_alive(self) -> bool:
        """See `Process`."""
        return self.poll() is None

    def join(self, timeout: float | None = None) -> None:
        """See `Process`."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.wait(timeout)


class Worker:
    """A process that answers one question after the other.

    It speaks on a connection of its own: what is printed in it is not an answer. Each answer has the number of its
    question; that of an earlier question, which nobody waits for any more, is discarded.

    Args:
        connection: the end of this process.
        process: the other one; None if a third one has started it, and ends it.
    """

    def __init__(self, connection: Connection, process: Process | None) -> None:
        self.connection, self.process = connection, process
        self._asked = 0
        _own.add(connection)

    @classmethod
    def copy(cls, server: Callable[..., Server], *arguments: object, daemon: bool = True) -> Worker:
        """Start a copy of this process; on systems without copies a new one, which imports the main program.

        Args:
            server: called with the arguments in the worker.
            daemon: whether the end of the program ends it; it can then start no processes by `multiprocessing`.

        Raises:
            AttributeError, TypeError, pickle.PicklingError: the arguments cannot be sent to a new process.
        """
        with _starting:
            ours, theirs = multiprocessing.Pipe()
            _own.add(ours)
            with theirs:
                return cls(ours, start_copy(theirs, server, *arguments, daemon=daemon))

    @classmethod
    def program(cls, module: str, environment: Mapping[str, str] | None = None, *, is_silent: bool = False) -> Worker:
        """Start a module of MORSE that calls `serve_program`: a program of its own, not a copy of this process.

        This process may have threads and sockets, and its program needs no ``if __name__ == "__main__"``.

        Args:
            environment: environment variables; None for those of this process, for one processor.
            is_silent: whether what it prints is dropped.

        Raises:
            OSError: it cannot be started.
        """
        ours, theirs = multiprocessing.Pipe()
        with theirs:
            handle, inherited = theirs.fileno(), dict[str, Any]()
            if sys.platform == "win32":
                os.set_handle_inheritable(handle, True)
                inherited["startupinfo"] = subprocess.STARTUPINFO(lpAttributeList={"handle_list": [handle]})
            else:
                inherited["pass_fds"] = (handle,)
            process = _Program(
                command(module, str(handle)),
                stdin=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL if is_silent else None,
                env={**os.environ, **ONE_THREAD} if environment is None else environment,
                **inherited,
            )
            return cls(ours, process)

    @property
    def pid(self) -> int:
        """The number of the process."""
        return getattr(self.process, "pid", 0)

    @property
    def is_alive(self) -> bool:
        """Whether the process has not ended."""
        return self.process is None or self.process.is_alive()

    def send(self, question: bytes) -> None:
        """Ask; if the process has ended, `receive` says so."""
        self._asked += 1
        with contextlib.suppress(OSError):
            self.connection.send_bytes(_NUMBER.pack(self._asked) + question)

    def receive(self) -> bytes:
        """Return the answer to the last question.

        Raises:
            WorkerError: the process has ended.
        """
        try:
            while True:
                answer = self.connection.recv_bytes(_MOST)
                if answer[: _NUMBER.size] == _NUMBER.pack(self._asked):
                    return answer[_NUMBER.size :]
        except (EOFError, OSError, MemoryError):  # of a length that is none
            raise WorkerError(self._cause()) from None

    def ask(self, question: bytes, patience: float | None = None) -> bytes:
        """Ask, and return the answer.

        Args:
            patience: wall-clock time after which a process that has not answered is killed, s. A process that is
                stopped neither reads nor writes.

        Raises:
            WorkerError: the process has ended.
        """
        if patience is None:
            self.send(question)
            return self.receive()
        is_late = threading.Event()

        def end() -> None:
            is_late.set()
            self.kill()

        overdue = threading.Timer(patience, end)
        overdue.daemon = True
        overdue.start()
        try:
            self.send(question)
            return self.receive()
        except WorkerError:
            if is_late.is_set():
                raise WorkerError(f": it does not answer within {patience:g} s") from None
            raise
        finally:
            overdue.cancel()

    def _cause(self) -> str:
        """What has ended the process, as the continuation of a sentence."""
        if self.process is None:
            return ""
        self.process.join(1.0)
        code = self.process.exitcode
        if code is None or code >= 0:
            return ""
        name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
        return f" by {name}, perhaps because there was no memory left" if name == "SIGKILL" else f" by {name}"

    def kill(self) -> None:
        """End the process at once, also while another thread waits for its answer."""
        if self.process is not None:
            self.process.kill()
        elif hasattr(socket, "AF_UNIX"):
            with contextlib.suppress(OSError), socket.socket(fileno=os.dup(self.connection.fileno())) as ours:
                ours.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """End the process."""
        close_all([self])


def close_all(workers: Iterable[Worker]) -> None:
    """End workers, all at the same time."""
    every = list(workers)
    for worker in every:
        worker.connection.close()
    end_all([worker.process for worker in every if worker.process is not None])


def end_all(processes: Iterable[Process], patience: float = GRACE) -> None:
    """Wait until processes have ended; kill those that do not."""
    until = time.monotonic() + patience
    for process in processes:
        process.join(max(until - time.monotonic(), 0.0))
        if process.is_alive():
            process.kill()
            process.join()


class Asked(Protocol):
    """What a thread of a pool works with: a worker, or an object that speaks with workers."""

    def close(self) -> None:
        """End it."""

    def kill(self) -> None:
        """End it at once, also while it does something."""


W = TypeVar("W", bound=Asked)
T = TypeVar("T")
#: a result, or the error instead of it
_Outcome: TypeAlias = tuple[Any, BaseException | None]


class _Call(NamedTuple):
    """A function to be called with a worker.

    Attributes:
        begin: returns whether somebody still wants the result.
        done: takes the outcome.
    """

    job: Callable[[Any], Any]
    begin: Callable[[], bool]
    done: Callable[[_Outcome], object]


class WorkerPool(Generic[W]):
    """Threads that call functions with workers, each thread with its own.

    Only these threads speak with workers. An error that interrupts the thread that waits, such as Ctrl+C or one of a
    signal handler, therefore interrupts no exchange: it is completed, and the next one begins after it. A worker over
    which a function raises `WorkerError` is replaced.

    Args:
        count: number of threads.
        start: starts the worker of a thread.
        attempts: number of workers that may end over one call.
        what: such as "a process that renders images", for the log.

    Attributes:
        workers: those that live.
    """

    def __init__(self, count: int, start: Callable[[], W], *, attempts: int = 1, what: str = "a worker") -> None:
        self._start, self._attempts, self._what = start, attempts, what
        self._calls: SimpleQueue[_Call | None] = SimpleQueue()
        self.workers: set[W] = set()
        # daemons: a worker that never answers must not hold the end of the program
        self._threads = [threading.Thread(target=self._run, name="morse-worker", daemon=True) for _ in range(count)]
        for thread in self._threads:
            thread.start()

    def submit(self, job: Callable[[W], T]) -> Future[T]:
        """Let a thread call a function with its worker."""
        future: Future[T] = Future()

        def done(outcome: _Outcome) -> None:
            result, error = outcome
            if error is None:
                future.set_result(result)
            else:
                future.set_exception(error)

        self._calls.put(_Call(job, future.set_running_or_notify_cancel, done))
        return future

    def call(self, job: Callable[[W], T]) -> T:
        """Let a thread call a function with its worker, and wait for the result.

        Unlike the lock of a future, the queue of the answer is whole whenever the wait is interrupted.
        """
        outcomes: SimpleQueue[_Outcome] = SimpleQueue()
        self._calls.put(_Call(job, lambda: True, outcomes.put))
        result, error = outcomes.get()
        if error is not None:
            raise error
        return result  # type: ignore[no-any-return] # of the job

    def _run(self) -> None:
        worker: W | None = None
        with contextlib.suppress(Exception):  # the first call tells
            worker = self._started()
        while (call := self._calls.get()) is not None:
            if call.begin():
                worker, outcome = self._outcome(worker, call.job)
                call.done(outcome)
                del outcome
            # the thread must not keep what the call refers to
            del call
        self._dismiss(worker)

    def _outcome(self, worker: W | None, job: Callable[[W], object]) -> tuple[W | None, _Outcome]:
        problem = WorkerError()
        for _ in range(self._attempts):
            try:
                worker = worker or self._started()
                return worker, (job(worker), None)
            except WorkerError as error:
                problem = error
                self._dismiss(worker)
                worker = None
                if self._attempts > 1:
                    logger.warning("%s has ended%s; another one replaces it", self._what, error, extra=OF_MACHINE)
            except BaseException as error:
                return worker, (None, error)
        return None, (None, problem)

    def _started(self) -> W:
        worker = self._start()
        self.workers.add(worker)
        return worker

    def _dismiss(self, worker: W | None) -> None:
        if worker is not None:
            self.workers.discard(worker)
            worker.close()

    def close(self, patience: float = GRACE) -> None:
        """End the workers; calls that have not begun are cancelled.

        Args:
            patience: wall-clock time for the calls that have begun, s. Workers that take longer are killed.
        """
        with contextlib.suppress(Empty):
            while True:
                call = self._calls.get_nowait()
                if call is not None and call.begin():
                    call.done((None, CancelledError()))
        threads = [thread for thread in self._threads if thread is not threading.current_thread()]
        for _ in self._threads:
            self._calls.put(None)
        until = time.monotonic() + patience
        for thread in threads:
            thread.join(max(until - time.monotonic(), 0.0))
        if any(thread.is_alive() for thread in threads):
            for worker in list(self.workers):
                worker.kill()
            for thread in threads:
                thread.join(GRACE)


# -- the process that answers --------------------------------------------------------------


class Server:
    """What a worker does; subclass it."""

    def answer(self, question: bytes) -> bytes:
        """Answer a question."""
        raise NotImplementedError

    def close(self) -> None:
        """End, when there are no more questions."""


def start_copy(
    connection: Connection, server: Callable[..., Server], *arguments: object, daemon: bool = True
) -> BaseProcess:
    """Start a process that serves at the end of a connection; see `Worker.copy`."""
    context: Any = multiprocessing.get_context(kind_of_start())
    process: BaseProcess = context.Process(target=_copied, args=(connection, server, arguments), daemon=daemon)
    process.start()
    return process


def _copied(connection: Connection, server: Callable[..., Server], arguments: tuple[object, ...]) -> None:
    os.environ.update(ONE_THREAD)
    serve(connection, lambda: server(*arguments))


def program_connection() -> Connection:
    """Return the connection of a program that `Worker.program` has started."""
    # of Windows, whose type is unknown elsewhere
    kind: Any = getattr(connections, "PipeConnection", connections.Connection)
    connection: Connection = kind(int(sys.argv[1]))
    _own.add(connection)
    return connection


def serve(connection: Connection, start: Callable[[], Server], *, watches: bool = True) -> None:
    """Answer questions until the other process closes the connection or ends.

    Args:
        watches: whether a question that is open then is left; this takes a thread.
    """
    # Ctrl+C reaches all processes of a terminal: the one that asks decides what it means
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    questions, server = _Questions(connection, watches=watches), start()
    while (question := questions.get()) is not None:
        number, text = question[: _NUMBER.size], question[_NUMBER.size :]
        message = number + server.answer(text)
        questions.answered += 1
        try:
            connection.send_bytes(message)
        except OSError:
            # nobody waits any more; or a library has closed the connection, and only the end tells the one that waits
            break
    server.close()


def serve_program(start: Callable[[], Server], *, watches: bool = True) -> NoReturn:
    """Serve the process that has started this program by `Worker.program`; see `serve`."""
    with contextlib.suppress(OSError):
        os.dup2(2, 1)  # what a library prints is log
    serve(program_connection(), start, watches=watches)
    # without the finalisation of Python, which would flush a closed pipe
    os._exit(0)


def bare_environment() -> dict[str, str]:
    """The environment of a process that reads files of anybody: nothing of the user, only where the modules are."""
    needed = {name: os.environ[name] for name in _NEEDED if name in os.environ}
    return {**needed, "PYTHONPATH": os.pathsep.join(path for path in sys.path if os.path.isabs(path))}


def limit_resources(seconds: float, memory: int) -> None:
    """Limit the processor time and the memory, bytes, of this process, where the system can."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 2))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class _Questions:
    """Reads questions."""

    def __init__(self, connection: Connection, *, watches: bool) -> None:
        self._connection = connection
        self._waiting: SimpleQueue[bytes | None] = SimpleQueue()
        self._asked = self.answered = 0
        self._reader = threading.Thread(target=self._read, daemon=True) if watches else None
        if self._reader is not None:
            self._reader.start()

    def get(self) -> bytes | None:
        """Return the next question; None if there are no more."""
        if self._reader is not None:
            return self._waiting.get()
        try:
            return self._connection.recv_bytes(_MOST)
        except (EOFError, OSError):
            return None

    def _read(self) -> None:
        with contextlib.suppress(EOFError, OSError):
            while True:
                question = self._connection.recv_bytes(_MOST)
                self._asked += 1
                self._waiting.put(question)
        if self._asked > self.answered:
            os._exit(1)
        self._waiting.put(None)
