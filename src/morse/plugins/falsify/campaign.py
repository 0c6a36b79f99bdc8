"""The search for failures of a scenario: which runs are done, and what is known of each kind of failure."""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
import shutil
import time
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.reports.quoting import nearest
from morse.plugins.falsify.expressions import FAR, RequirementError
from morse.plugins.falsify.requirements import KIND, VERDICTS, violations
from morse.plugins.falsify.search import SEARCHES, Archive, Search, is_known
from morse.plugins.falsify.shrinking import Boundary, Shrinking
from morse.plugins.falsify.space import halton
from morse.system.regular_files import read_regular
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from concurrent.futures import Executor
    from pathlib import Path

    from morse.many.sweeping import Session
    from morse.plugins.falsify.scenario import Scenario
    from morse.plugins.falsify.space import Axis

#: what the folder belongs to
FACTS = "scenario.json"
#: kinds of failures that are kept and made plain, and runs that each of them may take
_MOST_KINDS, _MOST_STEPS = 20, 400
#: proposals in a row that had all been tried, after which all cases are listed
_MOST_REPEATED = 50
#: cases in which a parameter is changed alone, to see whether it has an effect
_BASES = 10
#: wall-clock time to wait for runs at once, and between two lines about the progress, s
_WAIT, _REPORT = 0.2, 1.0
#: longest file of facts, bytes
_LONGEST = 1 << 20

_Point = dict[str, Any]
_Row = dict[str, Any]


@dataclass
class Failure:
    """A kind of failure.

    Attributes:
        kind: what it is: the requirement that is violated, or the error, with the texts that the run returns.
        parameters: those of the smallest case, with ``seed``.
        row: the row of the run of this case.
        runs: number of runs that have failed in this way.
        boundaries: for each parameter that matters, a value that passes and one next to it that fails.
        recording: path of a recording of the smallest case.
        repeats: whether it ended in the same state when it was recorded; None if it was not.
        others: path of a second recording, if it did not.
        page: path of a page that plays the run.
        is_default: whether the defaults fail already.
    """

    kind: str
    parameters: _Point
    row: _Row
    runs: int = 1
    boundaries: dict[str, Boundary] = field(default_factory=dict)
    recording: str = ""
    repeats: bool | None = None
    others: str = ""
    page: str = ""
    is_default: bool = False

    @property
    def what(self) -> list[str]:
        """What the smallest case violates, a line each."""
        return violations(self.row)

    def __str__(self) -> str:
        given = ", ".join(f"{name}={shown(value)}" for name, value in self.parameters.items())
        return f"{self.kind}: fails with {given}"


@dataclass
class Found:
    """What a search has found.

    Attributes:
        failures: one entry for each kind of failure, the plainest one first.
        rows: the rows of all runs; see `morse.many.Table`.
        remarks: what the user has to know: parameters without effect, requirements that never hold.
        folder: where everything is.
        spent: wall-clock time of the search, also of earlier calls, s.
        is_complete: whether all cases have been tried.
    """

    scenario: Scenario
    folder: Path
    failures: list[Failure] = field(default_factory=list)
    rows: list[_Row] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    spent: float = 0.0
    is_complete: bool = False

    @property
    def smallest(self) -> Failure:
        """The plainest failure.

        Raises:
            LookupError: nothing has failed.
        """
        if not self.failures:
            raise LookupError(f"nothing has failed in {len(self.rows)} runs")
        return self.failures[0]

    def __str__(self) -> str:
        count = len(self.failures)
        kinds = f"{count} kind{'s' * (count != 1)} of failure" if count else "no failure"
        return "\n".join([f"{kinds} in {len(self.rows):,} runs", *map(str, self.failures)])


def shown(value: object) -> str:
    """A value of a parameter, for people."""
    return f"{value:.6g}" if isinstance(value, float) else repr(value)


def point_of(scenario: Scenario, row: _Row) -> _Point:
    """The parameters of a row, with its seed."""
    return {axis.name: row["seed"] if axis.name == "seed" else row.get(axis.name) for axis in scenario.space.axes}


def kinds_of(row: _Row) -> list[str]:
    """The kinds of failure of a run: the requirements that it violates, or its error, with the texts it returns."""
    if row["error"]:
        # numbers and addresses of objects differ from run to run
        return [re.sub(r"0x[0-9a-fA-F]+|[-+]?\d[\d.e+-]*", "#", row["error"]).strip()]
    verdicts = row.get(VERDICTS)
    if not isinstance(verdicts, dict):
        return []
    suffix = f" ({row[KIND]})" if row.get(KIND) else ""
    return [f"{name}{suffix}" for name in violated(row)]


def violated(row: _Row) -> list[str]:
    """The names of the requirements that a run violates."""
    verdicts = row.get(VERDICTS)
    return [name for name, (holds, _, _) in verdicts.items() if not holds] if isinstance(verdicts, dict) else []


class Campaign:
    """A search for failures; see `morse.plugins.falsify.scenario.Scenario.falsify`."""

    def __init__(
        self,
        scenario: Scenario,
        folder: Path,
        budget: float,
        runs: int | None,
        search: str,
        *,
        whole_budget: bool,
        progress: Callable[[str], object] | None,
    ) -> None:
        if not 0.0 < budget < math.inf:
            raise ValueError(f"budget is a wall-clock time in seconds, not {budget!r:.80}")
        if runs is not None and (isinstance(runs, bool) or int(runs) != runs or runs < 1):
            raise ValueError(f"runs is a number of runs, or None, not {runs!r:.80}")
        if search != "auto" and search not in SEARCHES:
            raise ValueError(f"there is no search '{search}'{nearest(search, ['auto', *SEARCHES])}")
        self._scenario, self._space = scenario, scenario.space
        self._study = scenario.study()
        self._folder, self._budget, self._runs = folder, budget, runs
        self._whole, self._report = whole_budget, progress
        self._names = [one.name for one in scenario.requirements]
        self.found = Found(scenario, folder)
        self._archive = Archive(len(self._space.free), len(self._names))
        self._search_name, self._searches = search, list[Search]()
        self._known: set[str] = set()
        self._consumers: dict[str, list[Callable[[_Row], None]]] = {}
        self._ready: deque[tuple[_Point, Callable[[_Row], None]]] = deque()
        self._kinds: dict[str, Failure] = {}
        self._shrinking: set[str] = set()
        self._first_violations: set[str] = set()
        self._turn = self._repeated = self._others = 0
        self._untried: list[_Point] | None = None
        self._session: Session

    def _made(self, search: str) -> list[Search]:
        rng = np.random.default_rng(self._archive.count)
        if search != "auto":
            return [SEARCHES[search](self._space, self._archive, rng)]
        searches = [SEARCHES["guided"](self._space, self._archive, rng)]
        with contextlib.suppress(ImportError):
            searches.append(SEARCHES["cma"](self._space, self._archive, rng))
        return searches

    # -- the runs --------------------------------------------------------------------------

    def go(self, workers: int | None, executor: Executor | None) -> Found:
        """Search; see `morse.plugins.falsify.scenario.Scenario.falsify`."""
        session = self._study.open(self._folder, workers=workers, executor=executor)
        with session:
            self._folder = self.found.folder = session.folder
            self._session = session
            self._claim()
            begin, before = time.monotonic(), self._continued()
            idle: list[str] = []
            try:
                self._first()
                self._search(begin - before)
                idle = self._without_effect()
                # these runs may have failed in new ways, whose cases become plain, too
                self._search(begin - before)
            except KeyboardInterrupt:
                self.found.remarks.append("the search was interrupted: the same call continues")
            self.found.spent = before + time.monotonic() - begin
            self.found.rows = session.rows
            self.found.remarks += [
                f"the parameter '{name}' has no effect: runs that differ in it alone end in the same way"
                for name in idle
            ]
            self._conclude()
            self._record()
        return self.found

    def _claim(self) -> None:
        """Refuse a folder with results of another scenario.

        Raises:
            ValueError: it has.
        """
        path = self._folder / FACTS
        own = {"file": self._scenario.file.name, "parameters": [axis.name for axis in self._space.axes]}
        try:
            before = json.loads(read_regular(path, _LONGEST))
        except FileNotFoundError:
            before = None
        except (ValueError, RecursionError):
            raise ValueError(f"{path} is damaged: remove it, or use another folder") from None
        if isinstance(before, dict) and before.get("file") != own["file"]:
            raise ValueError(
                f"{self._folder} contains results of {str(before.get('file'))!r:.80}, not of {own['file']}: "
                "use another folder"
            )
        write_whole(path, json.dumps(own, indent=1))

    def _continued(self) -> float:
        """Take what the folder contains; return the wall-clock time that it took, s."""
        rows = self._session.rows
        for row in rows:
            self._learn(row)
        self._searches = self._made(self._search_name)
        return float(sum(row["wall"] for row in rows)) / self._session.workers

    def _first(self) -> None:
        """Do the run with the defaults alone: it says whether the scenario is one.

        Raises:
            RequirementError: a requirement cannot be judged.
        """
        row = self._row_of(self._space.defaults)
        if row["error"].startswith(RequirementError.__name__):
            raise RequirementError(row["error"].partition(": ")[2])
        if row["error"].startswith(("ScriptError", "LoadError", "FileNotFoundError")) and not row["ticks"]:
            raise RequirementError(f"the scene cannot be loaded: {row['error']} {row['where']}".strip())
        for axis in self._space.free:
            self._ready += [(self._space.defaults | {axis.name: value}, _nothing) for value in _ends(axis)]

    def _without_effect(self) -> list[str]:
        """The parameters of which no value makes a difference, neither with the defaults nor near failures."""
        rows = self._session.rows
        order: list[int] = np.argsort(self._archive.robustness.min(axis=1), kind="stable").tolist()
        bases = [point_of(self._scenario, rows[index]) for index in order[:: max(1, len(order) // _BASES)]]
        bases += [self._space.point(halton(number, len(self._space.free))) for number in range(_BASES)]
        idle = []
        for axis in self._space.free:
            default = self._row_of(self._space.defaults)
            ends = [self._space.defaults | {axis.name: value} for value in _ends(axis)]
            if not all(_is_same(self._row_of(end), default, axis) for end in ends):
                continue
            changes = [(base, base | {axis.name: value}) for base in bases for value in _ends(axis)]
            if all(_is_same(self._row_of(base), self._row_of(other), axis) for base, other in changes):
                idle.append(axis.name)
        return idle

    def _row_of(self, point: _Point) -> _Row:
        """Do a run, and wait for it."""
        result: list[_Row] = []
        self._submit(point, result.append)
        while not result:
            for row in self._session.results(_WAIT):
                self._take(row)
        return result[0]

    def _search(self, begin: float) -> None:
        last = 0.0
        while True:
            while self._session.has_room and (job := self._next(begin)) is not None:
                self._submit(*job)
            if not self._session.is_busy and not self._ready and not self._consumers:
                return
            for row in self._session.results(_WAIT):
                self._take(row)
            if self._report is not None and time.monotonic() - last > _REPORT:
                last = time.monotonic()
                self._report(self._line(begin))

    def _line(self, begin: float) -> str:
        lowest = ""
        if self._archive.count:
            open_targets = self._targets()
            values = self._archive.robustness[:, open_targets]
            finite = values[is_known(values)]
            lowest = f", nearest {finite.min():.3g}" if finite.size else ""
        left = max(0.0, self._budget - (time.monotonic() - begin))
        return f"{self._archive.count:,} runs, {len(self._kinds)} kinds of failure{lowest}, {left:.0f} s left"

    def _next(self, begin: float) -> tuple[_Point, Callable[[_Row], None]] | None:
        """The next point, and what takes its row."""
        if self._ready:
            return self._ready.popleft()
        if self._is_over(begin):
            return None
        if self._repeated > _MOST_REPEATED and self._untried is None:
            self._untried = self._space.all_cases()
            if self._untried is not None:
                np.random.default_rng(1).shuffle(self._untried)
        if self._untried is not None:
            if not self._untried:
                self.found.is_complete = True
                return None
            return self._untried.pop(), _nothing
        targets = self._targets()
        self._turn += 1
        target = targets[self._turn // len(self._searches) % len(targets)]
        search = self._searches[self._turn % len(self._searches)]
        place = search.propose(target)
        return self._space.point(place), lambda row: search.tell(place, self._robustness(row))

    def _targets(self) -> list[int]:
        """The requirements that have not been violated yet; all if there is none."""
        names = enumerate(self._names)
        return [number for number, name in names if name not in self._first_violations] or [*range(len(self._names))]

    def _is_over(self, begin: float) -> bool:
        if self.found.is_complete or not self._space.free:
            return True
        if time.monotonic() - begin > self._budget or (self._runs is not None and self._archive.count >= self._runs):
            return True
        return not self._whole and self._first_violations.issuperset(self._names)

    def _submit(self, point: _Point, consumer: Callable[[_Row], None]) -> None:
        parameters = {name: value for name, value in point.items() if name != "seed"}
        row = self._session.submit(parameters, point["seed"])
        if row is None:
            self._repeated = 0
            name = self._study.one(parameters, point["seed"]).name
            self._consumers.setdefault(name, []).append(consumer)
            return
        self._repeated += 1
        self._learn(row)
        consumer(row)

    def _take(self, row: _Row) -> None:
        consumers = self._consumers.pop(row["run"], [])
        self._learn(row)
        for consumer in consumers:
            consumer(row)

    # -- what they say ---------------------------------------------------------------------

    def _robustness(self, row: _Row) -> list[float]:
        verdicts = row.get(VERDICTS)
        if row["error"] or not isinstance(verdicts, dict):
            return [-FAR] * len(self._names)
        found = [verdicts.get(name, (False, None, 0.0))[1] for name in self._names]
        return [math.nan if value is None else float(value) for value in found]

    def _learn(self, row: _Row) -> None:
        """Take a run into account, once."""
        if row["run"] in self._known:
            return
        self._known.add(row["run"])
        point = point_of(self._scenario, row)
        self._archive.add(self._space.places(point), self._robustness(row))
        for kind in kinds_of(row):
            failure = self._kinds.get(kind)
            if failure is not None:
                failure.runs += 1
                continue
            # texts may differ in each run; requirements are few
            if len(self._kinds) >= _MOST_KINDS and self._first_violations.issuperset(violated(row)):
                self._others += 1
                continue
            self._kinds[kind] = Failure(kind, point, row, is_default=point == self._space.defaults)
            # whatever is required, a run that raises an error does not fulfil it
            is_alone = row["error"] and len(self._names) == 1
            self._first_violations.update(self._names if is_alone else violated(row))
            self._shrink(self._kinds[kind])

    def _shrink(self, failure: Failure) -> None:
        """Let a failing case become plain."""
        shrinking = Shrinking(self._space, failure.parameters)
        steps = shrinking.steps()
        failure.boundaries = shrinking.boundaries
        self._advance(failure, shrinking, steps, None, 0)

    def _advance(
        self,
        failure: Failure,
        shrinking: Shrinking,
        steps: Generator[_Point, bool, None],
        answer: bool | None,
        count: int,
    ) -> None:
        try:
            point = next(steps) if answer is None else steps.send(answer)
        except StopIteration:
            return
        if count >= _MOST_STEPS:
            steps.close()
            return

        def take(row: _Row) -> None:
            fails = failure.kind in kinds_of(row)
            if fails:
                failure.parameters, failure.row = point, row
            self._advance(failure, shrinking, steps, fails, count + 1)

        self._ready.appendleft((point, take))

    # -- the end ---------------------------------------------------------------------------

    def _conclude(self) -> None:
        """Order the failures, and say what else is to be known."""
        distance = {
            failure.kind: sum(
                axis.distance(failure.parameters[axis.name], axis.default)
                + (failure.parameters[axis.name] != axis.default)
                for axis in self._space.free
            )
            for failure in self._kinds.values()
        }
        self.found.failures = sorted(self._kinds.values(), key=lambda failure: distance[failure.kind])
        remarks = self.found.remarks
        if self._others:
            remarks.append(
                f"{self._others:,} runs have failed in other ways than the first {_MOST_KINDS}: they are in the table "
                "alone; do the texts of their results or errors differ from run to run?"
            )
        # the run with the defaults is the case of all kinds that it shows
        by_default = next((failure for failure in self.found.failures if failure.is_default), None)
        if by_default is not None:
            remarks.append(f"with the default parameters already, this fails: {'; '.join(by_default.what)}")
        robustness = self._archive.robustness
        for number, name in enumerate(self._names):
            if self._archive.count > 1 and (robustness[:, number] < 0.0).all():
                remarks.append(f"'{name}' holds in none of {self._archive.count} runs: is it what you mean?")
            elif np.isnan(robustness[:, number]).any():
                count = int(np.isnan(robustness[:, number]).sum())
                remarks.append(f"'{name}' is not a number in {count} runs, which count as failures")

    def _record(self) -> None:
        """Record the smallest case of each kind; one that does not repeat, twice."""
        for failure in self.found.failures:
            row = self._recorded(failure)
            failure.recording, failure.repeats = row["recording"], row["same"]
            if row["same"] is False and row["recording"]:
                path = self._folder / row["recording"]
                failure.others = f"recordings/{path.stem}-first.mcap"
                with contextlib.suppress(OSError):
                    shutil.move(path, self._folder / failure.others)
                self._recorded(failure)
                self.found.remarks.append(
                    f"a case does not repeat: {failure}; something in it depends on the wall-clock time, on threads, "
                    f"or on an earlier run. Both recordings are kept: {failure.others}, {failure.recording}"
                )

    def _recorded(self, failure: Failure) -> _Row:
        point = failure.parameters
        parameters = {name: value for name, value in point.items() if name != "seed"}
        name = self._study.one(parameters, point["seed"]).name
        row = failure.row
        if row.get("same") is not None and os.path.exists(self._folder / row["recording"]) and not failure.others:
            return row
        self._session.submit(parameters, point["seed"], record=True)
        while self._session.is_busy:
            for row in self._session.results(_WAIT):
                if row["run"] == name:
                    return row
        return row


def _ends(axis: Axis) -> list[Any]:
    """Values that differ most from the default."""
    values = (axis.value(0.0), axis.value(1.0)) if axis.is_ordered else axis.values[:3]
    return [value for value in values if value != axis.default]


def _is_same(row: _Row, other: _Row, axis: Axis) -> bool:
    # the seed itself is a part of the state
    is_state_same = axis.name == "seed" or row["hash"] == other["hash"]
    return bool(row["hash"]) and is_state_same and row.get(VERDICTS) == other.get(VERDICTS)


def _nothing(_row: _Row) -> None:
    """What takes a row of which nothing is expected."""
