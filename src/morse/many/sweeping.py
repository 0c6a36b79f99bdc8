"""Does the runs of a study."""

from __future__ import annotations

import logging
import os
import time
from collections import Counter, deque
from pathlib import Path
from typing import TYPE_CHECKING

from morse.many.executors import Dispatcher, Elsewhere, Here, Processes
from morse.many.progress import Progress
from morse.many.results import ROWS, Ledger, Table, read_facts
from morse.many.run import Task, machine_facts, signature
from morse.many.summary import write_summary
from morse.many.values import plain
from morse.system.workers import can_fork

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from concurrent.futures import Executor
    from types import TracebackType

    from morse.many.executors import Doer
    from morse.many.run import Run, Runs
    from morse.many.study import Study
    from morse.many.values import Row

logger = logging.getLogger(__name__)

#: number of failures of each kind that are recorded
RECORDED = 20
#: longest time without a line about the progress, s
_REPORT = 1.0


def sweep(
    study: Runs,
    folder: str | os.PathLike[str],
    *,
    workers: int | None,
    executor: Executor | None,
    progress: Callable[[str], object] | None,
    attempts: int,
) -> Table:
    """See `morse.many.study.Study.run`."""
    workers = _count(workers, executor)
    with Ledger(Path(folder).resolve()) as ledger:
        driver = Driver(study, ledger, workers, progress, attempts, study.runs())
        try:
            driver.go(executor)
        finally:
            table = driver.table()
            write_summary(table, len(driver.runs))
    return table


def _count(workers: int | None, executor: Executor | None) -> int:
    if workers is None:
        workers = getattr(executor, "workers", None) or getattr(executor, "_max_workers", None) or _processors()
    if isinstance(workers, bool) or int(workers) != workers or workers < 0:
        raise ValueError(f"workers is a number of processes, or 0 for this process, not {workers!r}")
    return int(workers)


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Driver:
    """Gives the runs that are missing to a pool, and stores their rows."""

    def __init__(
        self,
        study: Runs,
        ledger: Ledger,
        workers: int,
        report: Callable[[str], object] | None,
        attempts: int,
        runs: Iterable[Run],
    ) -> None:
        self._study, self._ledger, self._workers = study, ledger, workers
        self._report, self._attempts = report, attempts
        self.runs: dict[str, Run] = {run.name: run for run in runs}
        self._waiting: deque[Task] = deque()
        self._trials: Counter[str] = Counter()
        self._recordings: Counter[str] = Counter()
        rows = ledger.rows
        self._tell_of_others()
        for run in self.runs.values():
            row = rows.get(run.name)
            if row is not None and row.get("same") is not None:
                self._recordings[signature(row)] += 1
        for run in self.runs.values():
            if run.name not in rows:
                self._waiting.append(Task(run))
            elif rows[run.name].get("same") is None:
                self._record_failure(run, rows[run.name])
        successes = sum(name in rows for name in self.runs)
        failures = sum(bool(rows[name]["error"]) for name in self.runs if name in rows)
        self.progress = Progress(len(self.runs), successes, failures)
        ledger.describe(
            {
                "study": repr(study), "axes": study.axes, "runs": len(self.runs), "identity": study.identity,
                **machine_facts(),
            }
        )  # fmt: skip

    def _tell_of_others(self) -> None:
        """Say why runs that the folder contains are done again."""
        folder, now = self._ledger.folder, self._study.identity
        others = sum(name not in self.runs for name in self._ledger.rows)
        try:
            before = read_facts(folder).get("identity")
        except (OSError, ValueError):  # there is no study, or none that can be read
            before = None
        if not others or before == now:
            return
        if isinstance(before, dict):
            changes = "; ".join(
                f"another {name}" if name == "code" else f"{name}: {before.get(name)!r:.200}, now {now[name]!r:.200}"
                for name in now
                if before.get(name) != now[name]
            )
        else:
            changes = "an earlier version of MORSE, which did not compare timeout, options and versions"
        logger.warning(
            "%s contains %d runs of another study (%s): they stay in %s, and do not count",
            folder,
            others,
            changes,
            ROWS,
        )

    def go(self, executor: Executor | None) -> None:
        """Do all runs."""
        self._tell()
        if not self._waiting:
            return
        last = time.monotonic()
        with Dispatcher(self._doer(executor, len(self._waiting)), self._left) as runs:
            while self._waiting or runs.is_busy:
                while self._waiting and runs.has_room:
                    runs.submit(self._waiting.popleft())
                for task, row in runs.results(_REPORT):
                    taken = self._take(task, row, runs.problem)
                    if taken is not None and task.record is None:
                        self.progress.add(taken)
                        self._record_failure(task.run, taken)
                if time.monotonic() - last > _REPORT:
                    last = time.monotonic()
                    self._tell()
        self._tell()

    def _doer(self, executor: Executor | None, most: int) -> Doer:
        if executor is not None:
            return Elsewhere(self._study, executor, self._workers or 1)
        if self._workers == 0 or (self._study.description() is None and not can_fork()):
            return Here(self._study)
        return Processes(self._study, min(self._workers, most))

    def _left(self) -> int:
        return len(self._waiting)

    def _take(self, task: Task, row: Row | None, problem: str) -> Row | None:
        """Store and return the row of a run; None if its process has died, and it waits again."""
        if row is None:
            row = self._died(task, problem)
            if row is None:
                return None
        if task.record is not None:
            first = self._ledger.rows[task.run.name]
            same = row["hash"] == first["hash"] and row["error"] == first["error"]
            row = first | {"recording": row["recording"], "same": same}
        self._ledger.add(row)
        return row

    def _died(self, task: Task, problem: str) -> Row | None:
        """A run whose process has died waits again, or has failed."""
        name = task.run.name
        self._trials[name] += 1
        if self._trials[name] < self._attempts:
            self._waiting.appendleft(task)
            return None
        reason = f": {problem}" if problem else ""
        return {
            "run": name, **task.run.parameters, "seed": task.run.seed, "hash": "", "ticks": 0, "wall": 0.0, "cpu": 0.0,
            "error": f"its process died {self._attempts} times{reason}", "where": "", "recording": "",
            "same": False, **machine_facts(),
        }  # fmt: skip

    def _record_failure(self, run: Run, row: Row) -> None:
        """Let a failed run be done again with a recording, unless there are enough of its kind."""
        if row["error"] and row.get("same") is None:
            kind = signature(row)
            if self._recordings[kind] < RECORDED:
                self._recordings[kind] += 1
                self._waiting.append(self._recorded(run))

    def _recorded(self, run: Run) -> Task:
        return Task(run, str(self._ledger.folder / "recordings" / f"{run.name}.mcap"))

    def _tell(self) -> None:
        if self._report is not None:
            self._report(str(self.progress))

    def table(self) -> Table:
        """The rows of the runs of the study that are done."""
        rows = self._ledger.rows
        return Table([rows[name] for name in self.runs if name in rows], self._ledger.folder, self._study.axes)


class Session(Driver):
    """The runs that a program chooses while others are under way; see `morse.many.study.Study.open`.

    Attributes:
        folder: where the results are.
        workers: number of runs at once.
    """

    def __init__(
        self,
        study: Study,
        folder: str | os.PathLike[str],
        workers: int | None,
        executor: Executor | None,
        attempts: int,
    ) -> None:
        self._runs_of = study
        self._under_way: set[tuple[str, bool]] = set()
        count = _count(workers, executor)
        ledger = Ledger(Path(folder).resolve())
        try:
            super().__init__(study, ledger, count, None, attempts, ())
            self.folder, self.workers = ledger.folder, max(1, count)
            self._dispatcher = Dispatcher(self._doer(executor, self.workers), lambda: self.workers)
        except BaseException:
            ledger.close()
            raise

    @property
    def rows(self) -> list[Row]:
        """The rows of all runs of this study that the folder contains, in the order in which they have ended."""
        return [row for row in self._ledger.rows.values() if self._of(row).name == row["run"]]

    def _of(self, row: Row) -> Run:
        return self._runs_of.one({name: row.get(name) for name in self._runs_of.axes}, row["seed"])

    @property
    def has_room(self) -> bool:
        """Whether a worker is free."""
        return self._dispatcher.has_room

    @property
    def is_busy(self) -> bool:
        """Whether runs are under way."""
        return self._dispatcher.is_busy or bool(self._waiting)

    def submit(self, parameters: Row, seed: int = 0, *, record: bool = False) -> Row | None:
        """Begin a run.

        Args:
            parameters: value of each parameter.
            record: whether a run that the folder contains is done again with a recording; its row then says in ``same``
                whether it has ended in the same state.

        Returns:
            The row, if the folder contains it already; None if `results` will return it, once.

        Raises:
            TypeError: these are not the parameters of the study, or they are not plain data.
            LookupError: a run that is to be recorded has not been done.
        """
        if set(parameters) != set(self._runs_of.axes):
            raise TypeError(
                f"the parameters are {', '.join(self._runs_of.axes) or 'none'}, not {', '.join(parameters) or 'none'}"
            )
        values = {name: plain(parameters[name], f"the parameter '{name}'") for name in self._runs_of.axes}
        run = self._runs_of.one(values, seed)
        before = self._ledger.rows.get(run.name)
        if record and before is None:
            raise LookupError(f"the run {run.name} has not been done yet: submit it without a recording first")
        if before is not None and not record:
            return before
        if (run.name, record) in self._under_way:
            return None
        self._under_way.add((run.name, record))
        self._dispatcher.submit(self._recorded(run) if record else Task(run))
        return None

    def results(self, timeout: float = 1.0) -> list[Row]:
        """Wait for runs to end, and return their rows; an empty list after ``timeout`` seconds."""
        while self._waiting and self._dispatcher.has_room:
            self._dispatcher.submit(self._waiting.popleft())
        done = list(self._dispatcher.results(timeout))
        rows = []
        for task, result in done:
            row = self._take(task, result, self._dispatcher.problem)
            if row is not None:
                self._under_way.discard((task.run.name, task.record is not None))
                rows.append(row)
        return rows

    def close(self) -> None:
        """End the runs that are under way, and release the folder."""
        try:
            self._dispatcher.__exit__(None, None, None)
        finally:
            self._ledger.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
