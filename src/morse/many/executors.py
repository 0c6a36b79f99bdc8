"""Runs by a `concurrent.futures.Executor`: threads, processes, a cluster."""

from __future__ import annotations

from collections import deque
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, ProcessPoolExecutor, wait
from typing import TYPE_CHECKING

from morse.core.reports.faults import summary
from morse.many.pool import ONE_THREAD, Task
from morse.many.run import run_once
from morse.many.stock import Stock

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from concurrent.futures import Executor
    from types import TracebackType

    from morse.many.run import Runs
    from morse.many.values import Row

#: wall-clock time of a pack of runs, s, and the most runs of one: each pack costs a message through the cluster
_PACK, _MOST_OF_A_PACK = 20.0, 500
#: packs that a driver hands out per second: a call of Ray takes 1.25 ms
DISPATCHES = 800.0
#: packs for each worker that wait in the executor
_QUEUE = 3


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


def do_pack(study: Runs, tasks: Sequence[Task]) -> list[Row]:
    """Do several runs; called in a process of the executor."""
    stock = Stock()
    return [run_once(study, task.run, task.record, stock) for task in tasks]


class ExecutorPool:
    """Gives packs of runs to an executor; see `morse.many.pool.Pool`.

    Args:
        start: function that returns the executor, called again if its processes have died.
        workers: number of runs that it does at once.
        remaining: returns the number of runs that still wait, so that the last packs are small.
        restarts: whether an executor whose processes have died is replaced.
    """

    def __init__(
        self, study: Runs, start: Callable[[], Executor], workers: int, remaining: Callable[[], int], *, restarts: bool
    ) -> None:
        self._study, self._start, self._workers = study, start, workers
        self._remaining, self._restarts = remaining, restarts
        self._executor = start()
        self._pack: list[Task] = []
        self._packs: dict[Future[list[Row]], list[Task]] = {}
        self._alone: set[str] = set()
        self._times: deque[float] = deque(maxlen=50)
        #: why the last pack has failed
        self.problem = ""

    @property
    def has_room(self) -> bool:
        """Whether the executor takes more runs."""
        return len(self._packs) < _QUEUE * self._workers

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
        if not self._times:
            return 1
        return pack_size(self._remaining(), self._workers, sum(self._times) / len(self._times))

    def _send(self) -> None:
        pack, self._pack = self._pack, []
        try:
            self._packs[self._executor.submit(do_pack, self._study, pack)] = pack
        except BrokenExecutor as error:
            self._replace(error)
            self._packs[self._executor.submit(do_pack, self._study, pack)] = pack

    def _replace(self, error: BrokenExecutor) -> None:
        if not self._restarts:
            raise RuntimeError(
                f"the executor does no more runs ({error}): start the study again to continue"
            ) from error
        self._executor.shutdown(wait=False, cancel_futures=True)
        self._executor = self._start()

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
            self.problem = summary(error)
            self._alone.update(task.run.name for task in pack)
            if isinstance(error, BrokenExecutor) and not self._restarts:
                self._replace(error)
            for task in pack:
                yield task, None

    def close(self) -> None:
        """Cancel what waits; an executor of the user stays open."""
        for future in self._packs:
            future.cancel()
        if self._restarts:
            self._executor.shutdown(wait=False, cancel_futures=True)

    def __enter__(self) -> ExecutorPool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def processes(workers: int) -> Executor:
    """Return processes that are started from nothing, for systems that cannot copy processes."""
    import multiprocessing

    return ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), initializer=_one_thread)


def _one_thread() -> None:
    import os

    os.environ.update(ONE_THREAD)


class InlinePool:
    """Does the runs in this process."""

    def __init__(self, study: Runs) -> None:
        self._study, self._stock = study, Stock()
        self._task: Task | None = None

    @property
    def has_room(self) -> bool:
        """Whether no run waits."""
        return self._task is None

    @property
    def is_busy(self) -> bool:
        """Whether a run waits."""
        return self._task is not None

    def submit(self, task: Task) -> None:
        """Take a run."""
        self._task = task

    def results(self, timeout: float) -> Iterator[tuple[Task, Row | None]]:
        """Do the run."""
        task, self._task = self._task, None
        if task is not None:
            yield task, run_once(self._study, task.run, task.record, self._stock)

    def __enter__(self) -> InlinePool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        pass
