"""A study: a function that runs one simulation and returns numbers, for many parameters and seeds."""

from __future__ import annotations

import inspect
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.core.reports.quoting import nearest
from morse.many import sources
from morse.many.parameters import axis, combinations
from morse.many.run import RESERVED, Run, decisive_versions, name_of, run_once
from morse.many.values import plain
from morse.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from concurrent.futures import Executor

    from morse.core.values import Options
    from morse.many.results import Table
    from morse.many.sweeping import Session
    from morse.many.values import Row

#: arguments of `Study` that cannot be parameters
_OWN = ("seeds", "arguments", "options")


class Study:
    """Many runs of one function.

    Args:
        scene: a scene as for `morse.load`. A function gets the parameters that it names.
        run: function of a simulation and of the parameters that it names. It returns a dictionary of results, a number,
            or nothing. A run whose function raises an error has failed.
        seeds: number of seeds, for 0, 1, …; or the seeds.
        arguments: ``sys.argv[1:]`` of a scene script; ``{name}`` stands for the value of a parameter.
        options: other arguments of `morse.load`.
        timeout: wall-clock time after which a run fails, s; None for no limit.
        parameters: a list of values or a `Distribution` for each parameter. The study consists of all combinations.

    Raises:
        TypeError: neither the scene nor ``run`` has a parameter of that name, or a value is not plain data.
        ValueError: a parameter has no values.
    """

    def __init__(
        self,
        scene: Scene,
        run: Callable[..., object],
        *,
        seeds: int | Sequence[int] = 1,
        arguments: Sequence[str] = (),
        options: Options | None = None,
        timeout: float | None = None,
        **parameters: object,
    ) -> None:
        if not callable(run):
            raise TypeError(f"run is a function of a simulation, not {run!r:.80}")
        self.scene = str(Path(scene).resolve()) if isinstance(scene, (str, os.PathLike)) else scene
        self.run_function, self.arguments = run, list(arguments)
        self.options = {name: _option(name, value) for name, value in (options or {}).items()}
        if timeout is not None and not (isinstance(timeout, (int, float)) and 0.0 < timeout < 1e9):
            raise ValueError(f"timeout is a time in seconds, or None, not {timeout!r:.80}")
        self.timeout = None if timeout is None else float(timeout)
        self.seeds = list(range(seeds)) if isinstance(seeds, int) else [int(seed) for seed in seeds]
        self.axes = {name: axis(name, values) for name, values in parameters.items()}
        self._parameters_of = {
            part: _accepts(part) for part in (run, scene) if callable(part) and not isinstance(part, Scene)
        }
        for name in self.axes:
            self._check_parameter(name)
        self._identity: Row | None = None

    def _check_parameter(self, name: str) -> None:
        if name in RESERVED:
            raise TypeError(f"a parameter cannot be called '{name}': it is a column of the results")
        in_arguments = any(f"{{{name}}}" in word for word in self.arguments)
        names = {one for parameter_names in self._parameters_of.values() for one in parameter_names or ()}
        if None not in self._parameters_of.values() and name not in names and not in_arguments:
            run = getattr(self.run_function, "__name__", "run")
            raise TypeError(
                f"no one uses the parameter '{name}'{nearest(name, sorted(names))}: it is an argument neither of "
                f"{run}() nor of the scene"
            )

    @property
    def identity(self) -> Row:
        """What all runs depend on besides parameters and seeds: with another identity they are other runs.

        Of the code, this is the digest of the files of ``run`` and scene, of modules beside them, and of the values
        that both carry along.
        """
        if self._identity is None:
            self._identity = {
                "code": sources.code_of([self.run_function, self.scene]),
                "arguments": self.arguments,
                "options": self.options,
                "timeout": self.timeout,
                "versions": decisive_versions(),
            }
        return self._identity

    def runs(self) -> Iterator[Run]:
        """All runs, in the order of the parameters; the seed changes first."""
        for parameters, seed in combinations(self.axes, self.seeds):
            yield self.one(parameters, seed)

    def one(self, parameters: Row, seed: int) -> Run:
        """The run with these parameters."""
        return Run(name_of(self.identity, parameters, seed), parameters, seed)

    def __len__(self) -> int:
        count = len(self.seeds)
        for values in self.axes.values():
            count *= len(values)
        return count

    def __repr__(self) -> str:
        name = getattr(self.run_function, "__name__", "run")
        return f"<Study of {name}(): {len(self)} runs of {', '.join(self.axes) or 'no parameters'}>"

    # -- running ---------------------------------------------------------------------------

    def run(
        self,
        folder: str | os.PathLike[str],
        *,
        workers: int | None = None,
        executor: Executor | None = None,
        progress: Callable[[str], object] | None = None,
        attempts: int = 3,
    ) -> Table:
        """Do all runs that the folder does not contain yet.

        A run that fails is run again with a recording, up to 20 times for each kind of failure. A process that dies
        costs one attempt of one run.

        Args:
            folder: where results and recordings are stored; it is created.
            workers: number of processes; by default that of the processors.
            executor: a `concurrent.futures.Executor` that does the runs, instead of processes on this machine.
            progress: called with a line about the progress, from time to time.
            attempts: how often a run is tried whose process dies.

        Returns:
            The rows of all runs of this study.

        Raises:
            RuntimeError: another process runs a study in this folder.
        """
        if sources.is_loading:
            raise sources.StopLoading
        from morse.many.sweeping import sweep

        return sweep(self, folder, workers=workers, executor=executor, progress=progress, attempts=attempts)

    def open(
        self,
        folder: str | os.PathLike[str],
        *,
        workers: int | None = None,
        executor: Executor | None = None,
        attempts: int = 3,
    ) -> Session:
        """Open a folder for runs that a program chooses one after the other, such as an optimiser or a search.

        ::

            with study.open("results", workers=2) as session:
                while session.has_room:
                    session.submit(chosen(), seed=0)
                for row in session.results():
                    ...

        The lists of values of the study are not used, only the names of its parameters.

        Args:
            folder, workers, executor, attempts: see `run`.

        Raises:
            RuntimeError: another process runs a study in this folder.
        """
        if sources.is_loading:
            raise sources.StopLoading
        from morse.many.sweeping import Session

        return Session(self, folder, workers, executor, attempts)

    def once(self, seed: int = 0, *, record: str | os.PathLike[str] | None = None, **parameters: object) -> Row:
        """Do one run in this process, with any values, and return its row.

        Args:
            record: path of a recording.

        Raises:
            TypeError: a parameter is missing or not known.
        """
        for name in self.axes:
            if name not in parameters and len(self.axes[name]) == 1:
                parameters[name] = self.axes[name][0]
        if set(parameters) != set(self.axes):
            raise TypeError(
                f"the parameters are {', '.join(self.axes) or 'none'}, not {', '.join(parameters) or 'none'}"
            )
        return run_once(self, self.one(parameters, seed), record)

    def rerun(self, folder: str | os.PathLike[str], name: str) -> Row:
        """Run a run of a folder again, with a recording beside its results; the row has ``same``: is the hash equal?

        Args:
            name: its name, or the first letters of it.

        Raises:
            LookupError: there is no such run, or there are several.
        """
        from morse.many.results import Table, read_rows

        row = Table(read_rows(folder).values(), folder).find(name)
        run = self.one({key: row[key] for key in self.axes}, row["seed"])
        again = run_once(self, run, Path(folder) / "recordings" / f"{row['run']}.mcap")
        return again | {"same": again["hash"] == row["hash"], "same_identity": run.name == row["run"]}

    # -- for the runs ----------------------------------------------------------------------

    def scene_of(self, run: Run) -> Any:
        """Return the argument of `morse.load` for a run."""
        if not callable(self.scene) or isinstance(self.scene, Scene):
            return self.scene
        parameters = self._chosen(self.scene, run)
        return (lambda: self.scene(**parameters)) if parameters else self.scene

    def scene_key(self, run: Run) -> str:
        """Return what runs with the same scene have in common: the parameters and arguments of the scene."""
        of_function = callable(self.scene) and not isinstance(self.scene, Scene)
        parameters = self._chosen(self.scene, run) if of_function else {}
        return json.dumps([parameters, self.arguments_of(run)], sort_keys=True)

    def arguments_of(self, run: Run) -> list[str]:
        """Return the arguments of the scene script for a run."""
        return [word.format(**run.parameters) for word in self.arguments]

    def call(self, simulation: object, run: Run) -> Any:
        """Call the function of the study."""
        return self.run_function(simulation, **self._chosen(self.run_function, run))

    def _chosen(self, function: Any, run: Run) -> Row:
        parameter_names = self._parameters_of[function]
        return {
            name: value for name, value in run.parameters.items() if parameter_names is None or name in parameter_names
        }

    # -- for other processes ---------------------------------------------------------------

    def description(self) -> Row | None:
        """Return the study as plain data, for another process; None if only this process has its functions."""
        parts: Row = {}
        for key, part in (("run", self.run_function), ("scene", self.scene)):
            if isinstance(part, str):
                parts[key] = part
                continue
            reference = None if isinstance(part, Scene) else sources.reference_of(part)
            if reference is None:
                return None
            parts[key] = list(reference)
        return parts | {
            "arguments": self.arguments,
            "options": self.options,
            "timeout": self.timeout,
            "axes": self.axes,
            "seeds": self.seeds,
            "identity": self.identity,
        }

    @classmethod
    def of(cls, description: Row) -> Study:
        """Return the study of a description."""
        scene: Any = description["scene"]
        scene = scene if isinstance(scene, str) else sources.Reference(*scene).load()
        run = sources.Reference(*description["run"]).load()
        study = cls(
            scene,
            run,
            seeds=description["seeds"],
            arguments=description["arguments"],
            options=description["options"],
            timeout=description["timeout"],
            **description["axes"],
        )
        # of the process that has named the runs: this one may find the files elsewhere
        study._identity = description["identity"]
        return study

    def __reduce__(self) -> Any:
        description = self.description()
        if description is None:
            name = getattr(self.run_function, "__qualname__", "run")
            raise TypeError(f"{name} cannot be sent to another process: define run and scene at the top of a file")
        return Study.of, (description,)


def _option(name: str, value: object) -> Any:
    """An option as plain data."""
    return os.fspath(value) if isinstance(value, os.PathLike) else plain(value, f"the option '{name}'")


def _accepts(function: Any) -> tuple[str, ...] | None:
    """The names of the arguments of a function; None if it takes any."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return None
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    return tuple(p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY))
