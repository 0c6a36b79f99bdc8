"""Many simulations that are stepped together, with arrays instead of messages."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from morse.core.reports.faults import ENDINGS
from morse.many.batched_step import BatchedStep
from morse.many.fields import ContactColumn, DataColumn
from morse.many.rows import RowArrays, only_row_of, rows_of, seeds_of
from morse.many.scenes import Scenes
from morse.many.window import Window
from morse.simulation.states.state import State
from morse.simulation.ticks.stepping import Ownership

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from types import TracebackType

    from morse.core.guard import Failure
    from morse.scene import Scene
    from morse.simulation.simulation import Simulation
    from morse.viewer.notebook import Frame


def batch(
    scene: Scene,
    rows: int | None = None,
    *,
    seed: int | Sequence[int] = 0,
    arguments: Sequence[object] = (),
    first_row: int = 0,
    **options: object,
) -> Batch:
    """Load many simulations, the rows of a batch.

    Row ``k`` has the data of ``morse.load(scene, seed=seeds[k])`` alone, bit for bit, whatever the other rows do.

    A stream that writes a file writes one for each row, with its number in the name: ``robot.pose-row3.txt``.

    Args:
        scene: a scene as for `morse.load`; or a list of scenes with the same robots, which the rows use in turn.
        rows: number of rows, N; by default the number of scenes, or of lists of arguments.
        seed: a number for the seeds ``seed``, ``seed + 1``, …; or a list of one seed for each row.
        arguments: ``sys.argv[1:]`` of a scene script; or a list of such lists, which the rows use in turn.
        first_row: number of the first row in names of files, for one of several batches.
        options: other arguments of `morse.load`: ``strict``, ``on_failure``, ``on_warning``.

    Raises:
        ValueError: the number of rows is missing, or the numbers of rows and seeds differ.
        FileNotFoundError, ScriptError, LoadError: see `morse.load`; a note names the row.
    """
    return Batch(scene, rows, seed=seed, arguments=arguments, first_row=first_row, **options)


class Batch(RowArrays):
    """N simulations; created by `morse.batch`.

    ``many[k]`` is the simulation of row ``k``.

    Attributes:
        seeds: the present seed of each row.
    """

    def __init__(
        self,
        scene: Scene,
        rows: int | None = None,
        *,
        seed: int | Sequence[int] = 0,
        arguments: Sequence[object] = (),
        first_row: int = 0,
        **options: object,
    ) -> None:
        super().__init__()
        self._scenes = Scenes(scene, rows, arguments, options)
        self.seeds = seeds_of(seed, range(self._scenes.rows))
        self._simulations: list[Simulation] = []
        self._failures: list[tuple[Failure, ...]] = []
        self._time = Ownership(_nothing)
        self._window: Window | None = None
        try:
            for row, one in enumerate(self.seeds):
                simulation = self._scenes.load(row, one, f"-row{first_row + row}")
                simulation.delays_interrupts = False
                self._simulations.append(simulation)
            self._batched_step = BatchedStep(self._simulations, self._commands)
        except BaseException:
            self.close()
            raise

    def __len__(self) -> int:
        return len(self._simulations)

    def __getitem__(self, row: int) -> Simulation:
        self._check_open()
        place = row if isinstance(row, slice) else only_row_of(row, len(self))
        self._batched_step.publish(range(len(self))[place] if isinstance(place, slice) else [place])
        return self._simulations[place]

    def __iter__(self) -> Iterator[Simulation]:
        self._batched_step.publish(range(len(self)))
        return iter(self._simulations)

    def __repr__(self) -> str:
        if not self._simulations:
            return "<Batch, closed>"
        self._rows(None)
        ticks = {simulation.ticks for simulation in self._simulations}
        when = f"tick {ticks.pop()}" if len(ticks) == 1 else f"ticks {min(ticks)} to {max(ticks)}"
        return f"<Batch of {len(self)} x {self._scenes}, {when}; robots: {', '.join(self._simulations[0].robots)}>"

    @property
    def failures(self) -> list[tuple[Failure, ...]]:
        """What has failed in each row, (N,); see `Simulation.failures`."""
        return [simulation.failures for simulation in self._simulations] or list(self._failures)

    # -- time ------------------------------------------------------------------------------

    def step(self, ticks: int = 1, *, measure: bool | Sequence[str] = False) -> None:
        """Publish the commands, run ``ticks`` ticks in all rows, and update the arrays.

        Args:
            measure: whether all sensors measure at the end of the step, or the names of those that do; see
                `Simulation.step`. Otherwise the data are as old as the last measurement at the rate of each sensor.

        Raises:
            CommandError: a command is not valid.
            KeyError: there is no such sensor.
            ValueError, TypeError: another argument is not valid. After these errors no time has passed in any row.
            BaseException: an error of a row, with a note that names the row; all rows have run the ticks, unless their
                physics has become unstable.
        """
        self._check_open()
        self._simulations[0].check_step(ticks, measure)
        batched_step, commands = self._batched_step, [(column, column.check()) for column in self._commands]
        together = bool(ticks) and measure is True
        # without ticks nothing is measured, unless it is wanted
        if (ticks or measure) and not together:
            self._rows(None)
        # Ctrl+C takes effect after all rows: they stay in the same tick
        with self._time:
            ran = batched_step.run(ticks if together else 0, commands)
            rest = batched_step.apart
            if rest:
                simulations = self._simulations
                self._each(rest, lambda row: simulations[row].step(ticks - int(ran[row]), measure=measure))
                self._update(rest)
                if together:
                    batched_step.join(rest)
            for reading in self._readings if together else ():
                if isinstance(reading, ContactColumn):
                    reading.begin(np.flatnonzero(ran == ticks))
        if self._window is not None:
            self._window.turn(self._up_to_date)

    def measure(self, rows: object = None, sensors: Sequence[str] | None = None) -> None:
        """Let sensors measure now, between two ticks, as after `place`; see `Simulation.measure`.

        Args:
            rows: row numbers, a slice or a mask; None for all.
            sensors: full names; None for all.
        """
        numbers = self._rows(rows)
        self._simulations[0].check_step(0, True if sensors is None else sensors)
        self._each(numbers, lambda row: self._simulations[row].measure(sensors))
        self._update(numbers)
        if self._window is not None:
            self._window.turn(self._up_to_date)

    # -- episodes --------------------------------------------------------------------------

    def restart(self, rows: object = None, seeds: int | Sequence[int] | None = None) -> None:
        """Restart some rows, as after loading them with these seeds; the others are not touched.

        Args:
            rows: row numbers, a slice or a mask; None for all.
            seeds: one seed for each of these rows, or a number ``s`` for the seeds ``s + row``; None for the present
                seeds.
        """
        self._check_open()
        numbers = rows_of(rows, len(self))
        values = [self.seeds[row] for row in numbers] if seeds is None else seeds_of(seeds, numbers)
        for row, seed in zip(numbers, values, strict=True):
            self.seeds[row] = seed
            self._batched_step.drop(row)
        self._each(numbers, lambda row: self._simulations[row].restart(self.seeds[row]))
        self._begin(numbers)

    def save(self, rows: object = None) -> list[State]:
        """Return the states of some rows; see `Simulation.save`."""
        return [self._simulations[row].save() for row in self._rows(rows)]

    def restore(self, rows: object, states: Sequence[State] | State) -> None:
        """Restore states in some rows, one for each, or one state in all of them; see `Simulation.restore`.

        Raises:
            ValueError: there is another number of states than rows.
            TypeError: it is not a state.
            StateError: a state is damaged, or belongs to another scene.
        """
        numbers = self._rows(rows)
        every: list[Any] = list(states) if isinstance(states, (list, tuple)) else [states] * len(numbers)
        for state in every:
            if not isinstance(state, State):
                raise TypeError(f"a state is what save() returns, not {state!r:.80}")
        if len(every) != len(numbers):
            raise ValueError(f"there are {len(numbers)} rows, but {len(every)} states")
        waiting = dict(zip(numbers, every, strict=True))
        self._each(numbers, lambda row: self._simulations[row].restore(waiting[row]))
        for row in numbers:
            self.seeds[row] = self._simulations[row].seed()
        self._begin(numbers)

    def _each(self, rows: Sequence[int] | range, act: Callable[[int], object]) -> None:
        """Call a function for each row; the first error is raised after all rows, with a note that names its row."""
        failure: BaseException | None = None
        for row in rows:
            try:
                act(row)
            except BaseException as error:
                if failure is None:
                    failure = error
                    if not isinstance(error, ENDINGS):
                        error.add_note(f"in row {row} of the batch, with the seed {self.seeds[row]}")
        if failure is not None:
            raise failure

    # -- the page --------------------------------------------------------------------------

    def show(self, row: int = 0, *, height: int = 480, port: int = 0) -> Frame:
        """Open a page in which browsers of this machine see a row while the batch runs; or let it show another row.

        The page is updated by `step` and `measure`, up to 30 times per second, in at most a tenth of the time. It takes
        no time while no browser has it open, and makes no difference to the data.

        Args:
            height: height of the frame in a notebook, px.
            port: TCP port; 0 for any free port, or the present one.

        Returns:
            The page as a frame, which a notebook displays; its attribute ``url`` is the address for a browser.

        Raises:
            IndexError: there is no such row.
            OSError: the port is not available.
        """
        self._check_open()
        row = only_row_of(row, len(self))
        if self._window is None:
            self._window = Window(self._scenes, port)
        return self._window.show(row, height)

    def _up_to_date(self, row: int) -> Simulation:
        self._batched_step.leave(row)
        return self._simulations[row]

    # -- the end ---------------------------------------------------------------------------

    def _simulation_of(self, row: int) -> Simulation:
        return self._simulations[row]

    def _load_sample(self) -> Simulation:
        return self._scenes.load(0, self.seeds[0])

    def _begin(self, rows: Sequence[int]) -> None:
        super()._begin(rows)
        self._batched_step.renew(rows)

    def _add_reading(self, column: DataColumn) -> None:
        super()._add_reading(column)
        self._batched_step.read(column)

    def _rows(self, rows: object) -> list[int]:
        self._check_open()
        numbers = rows_of(rows, len(self))
        for row in numbers:
            self._batched_step.leave(row)
        return numbers

    def _check_open(self) -> None:
        if not self._simulations:
            raise RuntimeError("this batch is closed: load it again")

    def close(self) -> None:
        """End all simulations; closing the batch again has no effect. Errors are raised as by `Simulation.close`."""
        self.__exit__(None, None, None)

    def __reduce__(self) -> NoReturn:
        raise TypeError("a batch cannot be copied or pickled: send its scene, or the states of rows, many.save(rows)")

    def __enter__(self) -> Batch:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        simulations, self._simulations = self._simulations, []
        if self._window is not None:
            self._window.close()
        stack = contextlib.ExitStack()
        for simulation in reversed(simulations):
            stack.push(simulation)
        try:
            stack.__exit__(kind, error, trace)
        finally:
            self._failures = [simulation.failures for simulation in simulations] or self._failures


def _nothing() -> None:
    """A step of all rows is completed in any case."""
