"""A scenario: a scene, what happens in it, the parameters that may vary, and what has to hold."""

from __future__ import annotations

import contextlib
import inspect
import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseError
from morse.core.reports.faults import describe
from morse.core.reports.quoting import nearest
from morse.many import Study
from morse.many.results import RESERVED
from morse.many.sources import imported
from morse.plugins.falsify.expressions import Quantity, RequirementError
from morse.plugins.falsify.programs import any_port
from morse.plugins.falsify.programs import run as run_program
from morse.plugins.falsify.requirements import (
    ALWAYS,
    EVENTUALLY,
    KIND,
    LARGEST_RESULT,
    LONGEST_KIND,
    LONGEST_TEXT,
    SIGNALS,
    VERDICTS,
    Monitor,
    Requirement,
    requirement,
    violations,
)
from morse.plugins.falsify.space import Space

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence
    from concurrent.futures import Executor
    from types import FrameType

    from morse import Simulation
    from morse.core.values import Options
    from morse.plugins.falsify.campaign import Found

#: wall-clock time after which a run fails, s
_TIMEOUT = 120.0


class ViolatedError(MorseError, AssertionError):
    """A case violates requirements of its scenario."""


class Scenario:
    """What happens in a scene, with parameters, and what has to hold whatever they are.

    Args:
        scene: a scene as for `morse.load`. A function gets the parameters that it names.
        run: function of a simulation and of the parameters that it names; it lets time pass, and returns a dictionary
            of results, a number, or nothing. A run whose function raises an error has failed.
        duration: instead of ``run``: simulated seconds that pass.
        program: with a duration: the words of a program, started for each run, that steps the simulation over its
            socket: ``pymorse``, or any client that calls ``simulation step`` or ``exchange``. ``{name}`` stands for the
            value of a parameter. It finds the port in its environment variable ``MORSE_SOCKET_PORT``. The run ends with
            the program; a status other than 0 is a failure.
        seed: seeds of the simulation: one, or a list or range of them.
        defaults: values of parameters that are nothing special, towards which failing cases are made plain. Else the
            default of the argument of ``run`` or of the scene; else the middle of a distribution, or the first of
            several values.
        arguments: ``sys.argv[1:]`` of a scene script; ``{name}`` stands for the value of a parameter.
        options: other arguments of `morse.load`.
        timeout: wall-clock time after which a run fails, s; None for no limit.
        parameters: for each a distribution (`morse.many.uniform`, `loguniform`, `normal`, `choice`), a list of values,
            or a value.

    Raises:
        TypeError: nobody uses a parameter, or there is neither a function nor a duration.
        ValueError: a parameter has no values, or a default is none of them.
    """

    def __init__(
        self,
        scene: Any,
        run: Callable[..., object] | None = None,
        *,
        duration: float | None = None,
        program: Sequence[str] = (),
        seed: object = 0,
        defaults: Mapping[str, object] | None = None,
        arguments: Sequence[str] = (),
        options: Options | None = None,
        timeout: float | None = _TIMEOUT,
        **parameters: object,
    ) -> None:
        if (run is None) == (duration is None):
            raise TypeError("a scenario has either a function of a simulation, run, or a duration in seconds")
        if program and (isinstance(program, str) or duration is None):
            raise TypeError('program is a list of words, such as ["python3", "controller.py"], beside a duration')
        if duration is not None and not 0.0 < duration < math.inf:
            raise ValueError(f"duration is a simulated time in seconds, not {duration!r:.80}")
        frame = inspect.currentframe()
        caller = frame.f_back if frame is not None else None
        self._module = str(caller.f_globals.get("__name__", "")) if caller is not None else ""
        self.file = Path(caller.f_code.co_filename) if caller is not None else Path()
        self.requirements: list[Requirement] = []
        self.monitored = Monitored(run, duration, tuple(program), self.requirements)
        self._own = defaults or {}
        for name in self._own:
            if name not in parameters and name != "seed":
                raise TypeError(f"there is no parameter '{name}'{nearest(name, list(parameters))}")
        values = _defaults_of([run, scene]) | dict(self._own)
        known = {name: value for name, value in values.items() if name in parameters or name == "seed"}
        self.space = Space({**parameters, "seed": seed}, known)
        self._names = tuple(parameters)
        # its lists have the default alone: other values are chosen by the search
        lists = {name: [self.space.defaults[name]] for name in parameters}
        self._any_port = any_port if program else contextlib.nullcontext
        options = {"sockets": True, **(options or {})} if program else options
        self._study = Study(
            scene, self.monitored, arguments=arguments, options=options, timeout=timeout, seeds=[0], **lists
        )

    # -- what has to hold ------------------------------------------------------------------

    def always(self, condition: str | Callable[..., object], *, name: str | None = None) -> None:
        """Require that something holds in each tick, or of the results of each run.

        Args:
            condition: an expression, such as ``"robot.pose.z < 0.5"``; or a function of the simulation, called after
                each tick, or of ``results``, called at the end. It returns True or False, or a number that says how far
                it is from being violated.
            name: what reports call it.

        Raises:
            RequirementError: the expression is none.
        """
        self._require(ALWAYS, condition, math.inf, name)

    def eventually(
        self, condition: str | Callable[..., object], *, within: float = math.inf, name: str | None = None
    ) -> None:
        """Require that something holds in one tick of each run at least; see `always`.

        Args:
            within: simulated time until which it has to hold, s.
        """
        self._require(EVENTUALLY, condition, within, name)

    def require(self, formula: str, *, name: str | None = None) -> None:
        """Require a formula of signal temporal logic, such as ``"always[0:30] (d > 0.4)"``, by the package ``rtamt``.

        Args:
            formula: of fields of components, such as robot.pose.x, of signals, or of results that have a number for
                each tick. Times are simulated seconds.
        """
        self._require(SIGNALS, formula, math.inf, name)

    def signal(self, name: str, value: str | Callable[[Simulation], float]) -> None:
        """Name a number that each tick has.

        Args:
            value: an expression, such as ``"hypot(robot.pose.x - 3, robot.pose.y)"``, or a function of the simulation.

        Raises:
            RequirementError: the expression is none.
            ValueError: it is not a name, or something else has it.
        """
        if not name.isidentifier() or name in self.space.defaults or name in self.monitored.signals:
            raise ValueError(f"a signal cannot be called {name!r:.80}: it is not a name, or something else has it")
        if callable(value):
            self.monitored.signals[name] = value
            return
        try:
            self.monitored.signals[name] = Quantity(value)
            self.monitored.texts[name] = value
        except RequirementError as error:
            raise RequirementError(f"{_where(inspect.currentframe())}: {error}") from None

    def _require(self, mode: str, condition: object, within: float, name: str | None) -> None:
        frame = inspect.currentframe()
        where = _where(frame.f_back if frame is not None else None)
        names = (*self._names, "seed", *self.monitored.signals)
        one = requirement(mode, condition, names, within=within, name=name, where=where)
        if any(one.name == other.name for other in self.requirements):
            raise ValueError(f"{where}: there is a requirement '{one.name}' already: give this one another name")
        self.requirements.append(one)

    # -- runs ------------------------------------------------------------------------------

    def study(self) -> Study:
        """The study of the runs of this scenario; each has the verdict of each requirement in its results.

        Raises:
            ValueError: nothing is required.
        """
        if not self.requirements:
            raise ValueError("the scenario requires nothing: call always, eventually or require first")
        if self.name():
            # other processes find it by this name
            vars(self.monitored).update(__module__=self._module, __qualname__=f"{self.name()}.monitored")
        return self._study

    def name(self) -> str:
        """The variable of the script that holds the scenario; empty if there is none."""
        module = sys.modules.get(self._module)
        variables = vars(module) if module is not None else {}
        return next((name for name, value in variables.items() if value is self), "")

    def once(self, seed: int | None = None, *, record: str | os.PathLike[str] | None = None, **parameters: Any) -> Any:
        """Do one run in this process, and return its row; see `morse.many.Study.once`.

        Args:
            seed: None for the default.
            parameters: those that are not given have their defaults.
        """
        defaults = self.space.defaults
        default = defaults.pop("seed")
        unknown = [name for name in parameters if name not in defaults]
        if unknown:
            raise TypeError(f"there is no parameter '{unknown[0]}'{nearest(unknown[0], list(defaults))}")
        with self._any_port():
            return self.study().once(default if seed is None else seed, record=record, **(defaults | parameters))

    def check(
        self, parameters: Mapping[str, Any], seed: int = 0, *, record: str | os.PathLike[str] | None = None
    ) -> None:
        """Do one run, for a test.

        Raises:
            ViolatedError: it violates a requirement, or raises an error; the message says which, how far, and when.
        """
        __tracebackhide__ = True
        row = self.once(seed, record=record, **parameters)
        violated = violations(row)
        if violated:
            given = ", ".join(f"{name}={value!r}" for name, value in {**parameters, "seed": seed}.items())
            raise ViolatedError("\n".join([f"with {given}:", *(f"  {one}" for one in violated)]))

    def falsify(
        self,
        folder: str | os.PathLike[str],
        *,
        budget: float = 600.0,
        runs: int | None = None,
        workers: int | None = None,
        executor: Executor | None = None,
        search: str = "auto",
        whole_budget: bool = False,
        progress: Callable[[str], object] | None = None,
    ) -> Found:
        """Search for the smallest parameters with which a requirement is violated.

        Called again with the same folder, it continues. It ends when each requirement has been violated, and the cases
        are as small as they get, when all cases have been tried, or with the budget.

        Args:
            folder: where results, recordings and tests are written; it is created.
            budget: wall-clock time for the search, s, together with that of earlier calls.
            runs: number of runs after which it ends, too.
            workers: number of processes; by default that of the processors, 0 for this process.
            executor: a `concurrent.futures.Executor` that does the runs instead.
            search: ``guided``, ``cma``, ``optuna``, ``halton`` or ``random``; ``auto`` for ``guided``, in turn with
                ``cma`` if it is installed.
            whole_budget: whether to search on for other kinds of failures when each requirement has been violated.
            progress: called with a line about the progress, from time to time.

        Raises:
            RequirementError: a requirement cannot be judged.
            ValueError: the folder contains results of another scenario, or an argument is none of the above.
        """
        from morse.plugins.falsify.campaign import Campaign
        from morse.plugins.falsify.report import write

        campaign = Campaign(self, Path(folder), budget, runs, search, whole_budget=whole_budget, progress=progress)
        with self._any_port():
            found = campaign.go(workers, executor)
        write(found)
        return found


class Monitored:
    """The function of the study: the user's, with all requirements judged.

    Attributes:
        signals: see `Scenario.signal`.
        texts: those of signals that are expressions, on which the runs depend, too.
    """

    def __init__(
        self,
        run: Callable[..., object] | None,
        duration: float | None,
        program: tuple[str, ...],
        requirements: list[Requirement],
    ) -> None:
        self._run, self._duration, self._program, self._requirements = run, duration, program, requirements
        self.signals: dict[str, Quantity | Callable[..., object]] = {}
        self.texts: dict[str, str] = {}
        # the files of the program decide what runs do, as those of modules do
        self.files = [path.read_bytes() for word in program if (path := Path(word)).suffix and path.is_file()]
        self.__signature__ = inspect.signature(run if run is not None else _anything if program else _nothing)

    def __call__(self, simulation: Simulation, **parameters: object) -> dict[str, object]:
        """Do a run, and return its results."""
        monitor = Monitor(simulation, self._requirements, self.signals, parameters)
        simulation.observers.append(monitor)
        returned: Any = None
        if self._run is not None:
            returned = self._run(simulation, **parameters)
        elif self._duration is not None and self._program:
            run_program(simulation, self._program, parameters, self._duration)
        elif self._duration is not None:
            simulation.sleep(self._duration)
        if returned is None:
            returned = {}
        results = returned if isinstance(returned, dict) else {"result": returned}
        for name in (VERDICTS, KIND, *RESERVED):
            if name in results:
                raise RequirementError(f"a result cannot be called '{name}': it is another column of the table")
        size = len(json.dumps(results, default=_numbers))
        if size > LARGEST_RESULT:
            raise RequirementError(
                f"the run returns {size:,} characters, more than {LARGEST_RESULT:,}: return the numbers that "
                "requirements need, and write the rest to a file"
            )
        texts = {name: value for name, value in results.items() if isinstance(value, str) and value}
        kind = ", ".join(f"{name}={text:.{LONGEST_TEXT}}" for name, text in texts.items())
        return {**results, VERDICTS: monitor.verdicts(results), KIND: kind[:LONGEST_KIND]}


def _numbers(value: object) -> object:
    """Arrays as lists; others, which are no results, as text: the results are checked later."""
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)


def _anything(simulation: object, **parameters: object) -> None:
    """What a scenario with a program does."""


def _nothing(simulation: object) -> None:
    """What a scenario with a duration does."""


def _defaults_of(functions: Sequence[object]) -> dict[str, Any]:
    """The defaults of arguments of functions."""
    found: dict[str, Any] = {}
    for function in functions:
        if inspect.isroutine(function):
            for name, one in inspect.signature(function).parameters.items():
                if one.default is not one.empty:
                    found.setdefault(name, one.default)
    return found


def _where(frame: FrameType | None) -> str:
    """The line of the script that has called a method of a scenario."""
    while frame is not None and frame.f_code.co_filename == __file__:
        frame = frame.f_back
    return "" if frame is None else f"{Path(frame.f_code.co_filename).name}:{frame.f_lineno}"


def read_scenario(file: str | os.PathLike[str], name: str | None = None) -> Scenario:
    """Return the scenario of a script, which is executed; a search that it starts is not begun.

    Args:
        name: its variable; None or empty if there is one alone.

    Raises:
        RequirementError: the file does not exist, has an error, or has none or several; the message contains the line.
    """
    path = Path(file).resolve()
    if not path.is_file():
        near = nearest(path.name, [one.name for one in path.parent.glob("*.py")] if path.parent.is_dir() else [])
        raise RequirementError(f"there is no file {file}{near}")
    try:
        module = imported(str(path))
    except Exception as error:  # the script of a user may raise anything
        raise RequirementError(f"{file} has an error: {describe(error)}") from None
    scenarios = {key: value for key, value in vars(module).items() if isinstance(value, Scenario)}
    if name and name not in scenarios:
        raise RequirementError(f"{file} has no scenario '{name}'{nearest(name, list(scenarios))}")
    if not name and len(scenarios) != 1:
        which = f"several scenarios, name one: {', '.join(scenarios)}" if scenarios else "no morse.many.Scenario"
        raise RequirementError(f"{file} contains {which}")
    return scenarios[name] if name else next(iter(scenarios.values()))
