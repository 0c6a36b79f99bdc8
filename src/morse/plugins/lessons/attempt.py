"""What the check of a lesson uses: the simulation, the program of the student, and what is right."""

from __future__ import annotations

import importlib.util
import itertools
import math
import os
import reprlib
import sys
import threading
import time
from collections.abc import Iterable, Sized
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, TypeVar
from urllib.parse import urlsplit

import morse
from morse.core.reports.faults import describe
from morse.core.reports.printing import echo
from morse.plugins.lessons.catalog import PROGRAM, Lesson

_T = TypeVar("_T")

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from types import ModuleType

    from morse import Simulation


#: processor seconds that one call of a student's function may take; a busy machine takes nothing away from them
LONGEST_CALL = 10.0
#: wall-clock seconds that one call of a function that waits may take; it waits if it computes for less than these
#: processor seconds: a loop gets little of a busy computer, and may take longer
_LONGEST_WAIT, _IDLE = 60.0, 0.5
#: processor seconds of a whole check
LONGEST_CHECK = 300.0
#: items of what a student's function yields; more may be endless
_MOST_ITEMS = 100_000
#: seconds between two looks at the file of the program, while its result is shown
_LOOK = 0.25


#: points that are missing if a check has been cut short: what would have been checked later is not known
PROGRAM_RUNS, CHECK_RUNS, CHECK_ENDS = "The program runs.", "The check runs.", "The check ends."


@dataclass(frozen=True, slots=True)
class Finding:
    """A point of a check.

    Attributes:
        what: what is expected, as a sentence.
        is_right: whether it is so.
        hint: what is so instead, and what might help; empty if it is right.
    """

    what: str
    is_right: bool
    hint: str = ""

    def as_data(self) -> dict[str, object]:
        """Plain data for JSON."""
        return asdict(self)


class _ProgramSavedError(Exception):
    """The program was saved while it was checked in the page: the check begins again."""


class WrongProgramError(Exception):
    """The program of the student raises an error, or does not return what the lesson needs."""


class Attempt:
    """A student's program in the scene of a lesson.

    Args:
        lesson: the lesson.
        folder: the folder with the program.
        is_shown: whether the simulation has a live view and runs in real time.
        record: the file of a recording of the first simulation.

    Attributes:
        findings: what has been said by `expect`.
    """

    def __init__(self, lesson: Lesson, folder: Path, is_shown: bool = False, record: Path | None = None) -> None:
        self.findings: list[Finding] = []
        self._lesson = lesson
        self._folder = folder
        self._is_shown = is_shown
        self._record = record
        #: of the live view; 0 for any
        self._port = 0
        self._simulation: Simulation | None = None
        self._student: ModuleType | None = None
        #: of the file of the program: of this check at first, then when it was imported
        self._stamp = _stamp(folder / PROGRAM)
        self._watch: _Watch | None = None

    # -- for checks ------------------------------------------------------------------------

    @property
    def simulation(self) -> Simulation:
        """The simulation of the scene of the lesson, or of the scene that `load` has loaded last."""
        return self._simulation if self._simulation is not None else self.load(self.scene)

    @property
    def scene(self) -> Callable[[], object]:
        """The scene of the lesson."""
        return self._lesson.module.scene  # type: ignore[no-any-return]

    def load(self, scene: Callable[[], object]) -> Simulation:
        """Load a scene, in the place of the present one, if any, and measure; the program starts anew."""
        self.close()
        self._student = None
        record, self._record = self._record, None
        self._simulation = morse.load(
            scene,
            on_failure="raise",
            view="web" if self._is_shown else None,
            view_port=self._port,
            record=record,
            seed=1,
        )
        view = self._simulation.view
        if self._is_shown and view is not None:
            if not self._port:
                echo(f"* The live view: {view.url}")
            # open pages connect again to each further simulation
            self._port = urlsplit(view.url).port or 0
            self.tell()
        self._simulation.measure()
        return self._simulation

    def tell(self, *, is_checked: bool = False) -> None:
        """Show the task and what has been found so far in the page, if there is one."""
        if self._simulation is not None:
            points = [(one.what, one.is_right, one.hint) for one in self.findings]
            self._simulation.show_task(self._lesson.title, self._lesson.task, points, is_checked=is_checked)

    def step(self, seconds: float) -> None:
        """Let simulated time pass, in real time if the lesson is shown; then all sensors measure."""
        if self._is_shown:
            if self.is_outdated:
                raise _ProgramSavedError
            self.simulation.run(seconds)
        else:
            self.simulation.sleep(seconds)
        self.simulation.measure()
        if self._watch is not None:
            # a function of the student that drives has the whole time again after each step
            self._watch.renew()

    def call(self, name: str, *arguments: object) -> object:
        """Call a function of the student's program, and return what it returns; what it yields is a list.

        Raises:
            WrongProgramError: there is no such function, it raises an error, or yields too much.
        """
        function = getattr(self._program(), name, None)
        if not callable(function):
            raise WrongProgramError(f"{PROGRAM} has no function {name}(): it may have been renamed")
        return self._watched(f"{name}()", lambda: _whole(name, function(*arguments)))

    def numbers(self, count: int, name: str, *arguments: object) -> tuple[float, ...]:
        """Call a function of the student's program that returns a tuple of finite numbers.

        Raises:
            WrongProgramError: there is no such function, it raises an error, or returns something else.
        """
        result = self.call(name, *arguments)
        return self._watched(f"{name}()", lambda: _numbers(name, result, count, f"{count} numbers"))

    def number(self, name: str, *arguments: object) -> float:
        """Call a function of the student's program that returns a finite number; see `numbers`."""
        result = [self.call(name, *arguments)]
        (value,) = self._watched(f"{name}()", lambda: _numbers(name, result, 1, "a number"))
        return value

    def expect(self, is_right: object, what: str, hint: str = "") -> bool:
        """Say whether something is right.

        Args:
            is_right: whether it is.
            what: what is expected, as a sentence: "The robot stops before the wall."
            hint: what is so instead, and what might help.
        """
        self.findings.append(Finding(what, bool(is_right), "" if is_right else hint))
        self.tell()
        return bool(is_right)

    # -- for those who run checks ----------------------------------------------------------

    def run(self, on_endless: Callable[[], None]) -> None:
        """Run the check.

        Args:
            on_endless: called in another thread if a function of the student does not return; the process ends then.
        """
        self._watch = _Watch(self, on_endless, math.inf if self._is_shown else LONGEST_CHECK)
        try:
            self._lesson.module.check(self)
        except _ProgramSavedError:
            return
        except WrongProgramError as error:
            self.expect(False, PROGRAM_RUNS, str(error))
        except Exception as error:  # the lesson may be one of a teacher
            self.expect(False, CHECK_RUNS, f"the lesson itself has failed: {describe(error)}")
        finally:
            self._watch.close()
            if not self._is_shown:
                self.close()
            elif not self.is_outdated:
                self.tell(is_checked=True)
                # the robot would go on with its last command, and leave the view
                self.simulation.pause()

    def again(self, on_endless: Callable[[], None]) -> None:
        """Check once more, with the program as it is now."""
        self.findings.clear()
        self._stamp = _stamp(self._folder / PROGRAM)
        self.load(self.scene)
        self.run(on_endless)

    @property
    def is_outdated(self) -> bool:
        """Whether the program has been saved since it was imported."""
        return _stamp(self._folder / PROGRAM) not in (self._stamp, None)

    def wait_for_change(self) -> bool:
        """Show the simulation until the program is saved; returns False if a page ends the simulation before."""
        simulation, ended = self.simulation, threading.Event()

        def look() -> None:
            while not self.is_outdated:
                if ended.wait(_LOOK):
                    return
            simulation.stop()

        threading.Thread(target=look, daemon=True, name="changes of a program").start()
        try:
            simulation.run()
        finally:
            ended.set()
        return self.is_outdated

    def close(self) -> None:
        """End the simulation."""
        simulation, self._simulation = self._simulation, None
        if simulation is not None:
            simulation.close()

    def _program(self) -> ModuleType:
        if self._student is None:
            file = self._folder / PROGRAM
            self._stamp = _stamp(file)
            if not file.is_file():
                raise WrongProgramError(f"there is no file {file}")
            spec = importlib.util.spec_from_file_location("controller", file)
            if spec is None or spec.loader is None:
                raise WrongProgramError(f"{file} cannot be imported")
            module, loader = importlib.util.module_from_spec(spec), spec.loader
            if str(self._folder) not in sys.path:
                sys.path.insert(0, str(self._folder))
            self._watched("the program", lambda: loader.exec_module(module))
            self._student = module
        return self._student

    def _watched(self, what: str, function: Callable[[], _T]) -> _T:
        watch = self._watch
        if watch is not None:
            watch.begin(what)
        try:
            return function()
        except (KeyboardInterrupt, WrongProgramError, _ProgramSavedError):
            raise
        except BaseException as error:  # the program of a student may raise anything
            raise WrongProgramError(describe(error)) from None
        finally:
            if watch is not None:
                watch.end()


def at(*place: float) -> str:
    """A place for a hint, such as ``(1.0, -2.5)``, m."""
    return f"({', '.join(f'{round(part, 1) + 0.0:.1f}' for part in place)})"


def _stamp(file: Path) -> tuple[int, int] | None:
    try:
        status = file.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def _whole(name: str, result: object) -> object:
    """What a function has returned; a list of what it yields."""
    if not isinstance(result, Iterable) or isinstance(result, Sized):
        return result
    items = list(itertools.islice(result, _MOST_ITEMS + 1))
    if len(items) > _MOST_ITEMS:
        raise WrongProgramError(f"{name}() yields more than {_MOST_ITEMS:,} items: is this endless?")
    return items


def _numbers(name: str, result: object, count: int, expected: str) -> tuple[float, ...]:
    given = result[0] if count == 1 and isinstance(result, list) else result
    try:
        values = tuple(float(part) for part in itertools.islice(result, count + 1))  # type: ignore[call-overload]
    except Exception:  # a student may return anything
        values = ()
    if len(values) != count or not all(map(math.isfinite, values)):
        finite = ", not infinite and not NaN" if len(values) == count else ""
        raise WrongProgramError(f"{name}() returned {reprlib.repr(given)}, expected {expected}{finite}") from None
    return values


class _Watch:
    """Ends the process if a function of the student or the check takes too long, after the line has been noted."""

    def __init__(self, attempt: Attempt, on_endless: Callable[[], None], longest: float) -> None:
        self._attempt, self._on_endless = attempt, on_endless
        self._main = threading.get_ident()
        self._what = ""
        self._end = time.process_time() + longest
        self._longest = longest
        #: processor and wall-clock time, s, at which the present call has begun
        self._since: tuple[float, float] | None = None
        self._closed = threading.Event()
        threading.Thread(target=self._look, daemon=True, name="watch of a lesson").start()

    def begin(self, what: str) -> None:
        self._what, self._since = what, _now()

    def renew(self) -> None:
        if self._since is not None:
            self._since = _now()

    def end(self) -> None:
        self._since = None

    def close(self) -> None:
        self._closed.set()

    def _look(self) -> None:
        while not self._closed.wait(0.25):
            since, (computed, passed) = self._since, _now()
            if since is not None and computed - since[0] > LONGEST_CALL:
                self._stop(PROGRAM_RUNS, self._endless(f"{LONGEST_CALL:g} s", "Is this an endless loop?"))
            if since is not None and passed - since[1] > _LONGEST_WAIT and computed - since[0] < _IDLE:
                self._stop(PROGRAM_RUNS, self._endless(f"{_LONGEST_WAIT:g} s", "What does it wait for?"))
            if computed > self._end:
                self._stop(CHECK_ENDS, f"it has not ended after {self._longest:g} s")

    def _stop(self, what: str, hint: str) -> None:
        self._attempt.expect(False, what, hint)
        self._on_endless()
        os._exit(1)

    def _endless(self, time_taken: str, question: str) -> str:
        frame = sys._current_frames().get(self._main)
        while frame is not None and not frame.f_code.co_filename.endswith(PROGRAM):
            frame = frame.f_back
        where = "" if frame is None else f": it is in line {frame.f_lineno} of {PROGRAM}"
        return f"{self._what} has not returned after {time_taken}{where}. {question}"


def _now() -> tuple[float, float]:
    return time.process_time(), time.monotonic()
