"""What does the runs of a study: an executor of the user, processes of this machine, or this process."""

from __future__ import annotations

import faulthandler
import json
import pickle
import sys
import threading
from collections import deque
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from multiprocessing import Pipe, reduction
from typing import TYPE_CHECKING, Protocol

from morse.core.reports.faults import summary
from morse.many.run import run_once
from morse.many.scenes import SceneCache
from morse.system.workers import Server, Worker, WorkerError, WorkerPool, can_fork

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from concurrent.futures import Executor
    from types import TracebackType

    from morse.many.run import Runs, Task
    from morse.many.values import Row

#: wall-clock time of a pack of runs, s, and the most runs of one: each pack costs a message through the cluster
_PACK, _MOST_OF_A_PACK = 20.0, 500
#: packs that a driver hands out per second: a call of Ray takes 1.25 ms
DISPATCHES = 800.0
#: packs for each worker that wait in an executor of the user
_QUEUE = 3
#: wall-clock time for runs that are under way when a sweep is interrupted, s
_PATIENCE = 0.1
#: wall-clock time beyond the limit of a run after which its process ends, s
_STUCK = 30.0


def pack_size(remaining: int, workers: int, time: float) -> int:
    """Return the number of runs of the next pack.

    It is smaller near the end, so that the workers end together; but each pack takes long enough for the driver to hand
    out one to every worker meanwhile.

    Args:
        remaining: number of runs that are not in packs.
        workers: number of runs at once.
        time: wall-clock time of a run, s.
    """
    time = max(time, 1e-3)
    least = workers / (DISPATCHES * time)
    size = min(remaining / (2 * workers), _PACK / time)
    return max(1, min(_MOST_OF_A_PACK, remaining // workers + 1, int(max(least, size))))


def do_pack(study: Runs, tasks: Sequence[Task], cache: SceneCache | None = None) -> list[Row]:
    """Do several runs; called in a process of the executor."""
    cache = cache or SceneCache()
    return [run_once(study, task.run, task.record, cache) for task in tasks]


class Doer(Protocol):
    """What does packs of runs.

    Attributes:
        workers: number of packs at once.
        queue: number of packs for each worker, with those that wait.
    """

    workers: int
    queue: int

    def submit(self, tasks: Sequence[Task]) -> Future[list[Row]]:
        """Do a pack."""

    def close(self) -> None:
        """End what was started for it."""


class Elsewhere:
    """Packs are done by an executor of the user, which stays open."""

    queue = _QUEUE

    def __init__(self, study: Runs, executor: Executor, workers: int) -> None:
        self._study, self._executor, self.workers = study, executor, workers

    def submit(self, tasks: Sequence[Task]) -> Future[list[Row]]:
        """Do a pack."""
        return self._executor.submit(do_pack, self._study, tasks)

    def close(self) -> None:
        """The user ends the executor."""


class Here:
    """Runs are done in this process, at once."""

    workers = queue = 1

    def __init__(self, study: Runs) -> None:
        self._study, self._cache = study, SceneCache()

    def submit(self, tasks: Sequence[Task]) -> Future[list[Row]]:
        """Do a pack."""
        future: Future[list[Row]] = Future()
        future.set_result(do_pack(self._study, tasks, self._cache))
        return future

    def close(self) -> None:
        """Nothing was started."""


class StudyServer(Server):
    """Does runs, one after the other."""

    def __init__(self, study: Runs) -> None:
        self._study, self._cache = study, SceneCache()

    def answer(self, question: bytes) -> bytes:
        """Do pickled tasks, and return their rows."""
        tasks: Sequence[Task] = pickle.loads(question)
        rows = []
        for task in tasks:
            if self._study.timeout is not None:  # code that never returns to Python
                faulthandler.dump_traceback_later(self._study.timeout + _STUCK, exit=True)
            rows.append(run_once(self._study, task.run, task.record, self._cache))
            faulthandler.cancel_dump_traceback_later()
        return pickle.dumps(rows)


class Processes:
    """Runs are done by processes of this machine.

    They are copies of a process that has loaded the scene, or of this one if only this one has the functions of the
    study; on systems without copies, programs of their own.

    Raises:
        BrokenExecutor: the process that is to be copied has ended.
    """

    queue = 1

    def __init__(self, study: Runs, workers: int) -> None:
        self._study, self.workers = study, workers
        self._description, self._lock = study.description(), threading.Lock()
        self._original: Worker | None = None
        if self._description is not None and can_fork():
            self._original = self._program(self._description, copies=True)
        self._pool = WorkerPool(workers, self._start)

    def _program(self, description: Row, *, copies: bool) -> Worker:
        worker = Worker.program("morse.many.forking")
        try:
            worker.connection.send_bytes(json.dumps([description, sys.path, copies]).encode())
            worker.connection.recv_bytes()
        except (EOFError, OSError):
            worker.close()
            raise BrokenExecutor("the process that does the runs has ended: see its message above") from None
        return worker

    def _start(self) -> Worker:
        if self._description is None:
            return Worker.copy(StudyServer, self._study, daemon=False)
        if self._original is None:
            return self._program(self._description, copies=False)
        ours, theirs = Pipe()
        with theirs, self._lock:
            try:
                reduction.send_handle(self._original.connection, theirs.fileno(), self._original.pid)
            except OSError:
                raise BrokenExecutor("the process that starts the workers has ended") from None
        return Worker(ours, None)

    def submit(self, tasks: Sequence[Task]) -> Future[list[Row]]:
        """Do a pack."""
        question = pickle.dumps(tasks)

        def ask(worker: Worker) -> list[Row]:
            rows: list[Row] = pickle.loads(worker.ask(question))
            return rows

        return self._pool.submit(ask)

    def close(self) -> None:
        """End all processes, also those that are busy."""
        self._pool.close(_PATIENCE)
        if self._original is not None:
            self._original.close()


class Dispatcher:
    """Hands out packs of runs, and takes their rows.

    Args:
        remaining: returns the number of runs that still wait, so that the last packs are small.
    """

    def __init__(self, doer: Doer, remaining: Callable[[], int]) -> None:
        self._doer, self._remaining = doer, remaining
        self._pack: list[Task] = []
        self._packs: dict[Future[list[Row]], list[Task]] = {}
        self._alone: set[str] = set()
        self._times: deque[float] = deque(maxlen=50)
        #: why the last pack has failed
        self.problem = ""

    @property
    def has_room(self) -> bool:
        """Whether the executor takes more runs."""
        return len(self._packs) < self._doer.queue * self._doer.workers

    @property
    def is_busy(self) -> bool:
        """Whether runs are under way."""
        return bool(self._packs or self._pack)

    def submit(self, task: Task) -> None:
        """Add a run to the next pack; a run whose pack has failed goes alone."""
        self._pack.append(task)
        if len(self._pack) >= self._size() or task.run.name in self._alone:
            self._send()

    def _size(self) -> int:
        # without a queue, a pack of one run costs nothing
        if self._doer.queue == 1 or not self._times:
            return 1
        return pack_size(self._remaining(), self._doer.workers, sum(self._times) / len(self._times))

    def _send(self) -> None:
        pack, self._pack = self._pack, []
        try:
            self._packs[self._doer.submit(pack)] = pack
        except BrokenExecutor as error:
            self._give_up(error)

    def _give_up(self, error: BrokenExecutor) -> None:
        raise RuntimeError(f"the executor does no more runs ({error}): start the study again to continue") from error

    def results(self, timeout: float) -> Iterator[tuple[Task, Row | None]]:
        """Wait for results; yields each task with its row, or with None if its pack has failed."""
        if self._pack:
            self._send()
        for future in wait(self._packs, timeout, FIRST_COMPLETED).done:
            pack = self._packs.pop(future)
            error = future.exception()
            if error is None:
                for task, row in zip(pack, future.result(), strict=True):
                    self._times.append(row["wall"])
                    yield task, row
                continue
            if isinstance(error, BrokenExecutor):
                self._give_up(error)
            self.problem = "" if isinstance(error, WorkerError) else summary(error)
            self._alone.update(task.run.name for task in pack)
            for task in pack:
                yield task, None

    def __enter__(self) -> Dispatcher:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for future in self._packs:
            future.cancel()
        self._doer.close()
