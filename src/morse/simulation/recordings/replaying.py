"""Replays a simulation from its recorded inputs."""

from __future__ import annotations

import contextlib
import logging
from copy import deepcopy
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core import status
from morse.core.actuator import Actuator
from morse.core.journal import (
    CALL,
    CANCEL,
    COMMAND,
    CONTROLS,
    DELETE,
    EDIT,
    OUTCOME,
    RESET,
    RESTORE,
    SERVICE,
    SPAWN,
    WHOLE,
    Entry,
    is_same_result,
)
from morse.core.reports.faults import summary
from morse.core.reports.quoting import shown
from morse.core.state import StateError
from morse.simulation.recordings.input_recording import ReplayError, shown_entry
from morse.simulation.states.saving import InputsState

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.object import Object
    from morse.core.values import Value
    from morse.simulation.handles.component_handles import LocalFuture
    from morse.simulation.recordings.input_recording import InputRecording
    from morse.simulation.simulation import Simulation

logger = logging.getLogger(__name__)


class Place(NamedTuple):
    """A position in a recording.

    Attributes:
        next: index of the next input.
        life: number of restarts before.
        taken: the inputs that actuators take in the next tick.
    """

    next: int
    life: int
    taken: dict[str, list[Entry]]


class Replay:
    """Feeds the inputs of a recording to a simulation, each in its tick, and compares their outcomes.

    What was refused when the run was recorded, such as an object whose name a server refused, is refused again, also
    without that server.

    Args:
        simulation: a simulation of the same scene; it is set to the beginning of the recording.
        results: whether the results of services are compared as well.

    Raises:
        StateError: the state at the start of the recording belongs to another scene, or files were edited during the
            recording.
        ReplayError: the inputs are not in order.
    """

    def __init__(self, simulation: Simulation, recording: InputRecording, *, results: bool = False) -> None:
        edit = next((entry for entry in recording.entries if entry.kind == EDIT), None)
        if edit is not None:
            raise StateError(
                f"the recording cannot be replayed: '{edit.name}' was edited while it ran, at tick {edit.tick}"
            )
        self._simulation = simulation
        self._recording, self._results = recording, results
        self._inputs, self._outcomes = recording.in_sequence()
        #: whether the outcomes are known
        self._is_exact = all(entry.order >= 0 for entry in recording.entries)
        self._next = 0
        #: commands and calls, by actuator
        self._taken: dict[str, list[Entry]] = {}
        self._actuators: dict[str, Object] = {}
        #: running services, by the numbers of their inputs
        self._calls: dict[int, tuple[Entry, LocalFuture]] = {}
        #: the input that takes effect now; those whose outcome is not known, by their numbers in this run
        self._giving: Entry | None = None
        self._given: dict[int, Entry] = {}
        self._misfit: ReplayError | None = None
        if recording.start is None:
            simulation.restart(recording.seed)
        else:
            simulation.restore(recording.start)
        self._born = simulation.journal.life - recording.life
        simulation.journal.sinks.append(self._hear)
        self._apply: dict[str, Callable[[Entry], object]] = {
            SERVICE: self._call,
            CANCEL: self._cancel,
            CONTROLS: lambda entry: simulation.set_controls(frozenset(entry.content[0]), *_rest(entry.content)),
            RESET: lambda entry: simulation.restart(entry.content),
            RESTORE: lambda entry: simulation.restore(entry.content),
            SPAWN: lambda entry: simulation.spawn(entry.name, *entry.content),
            DELETE: lambda entry: simulation.delete(entry.name),
        }

    @property
    def done(self) -> bool:
        """Whether the end of the recording was reached."""
        return self._next >= len(self._inputs) and self._simulation.ticks >= self._recording.last

    @property
    def _life(self) -> int:
        return self._simulation.journal.life - self._born

    def place(self) -> Place:
        """The position in the recording, for `go_to`."""
        return Place(self._next, self._life, dict(self._taken))

    def go_to(self, place: Place) -> None:
        """Continue at another position; the simulation must be in its state at that position."""
        self._next = place.next
        self._taken = dict(place.taken)
        self._born = self._simulation.journal.life - place.life
        # a restored state has ended the services, whose components go on nevertheless
        self._calls.clear()
        self._given.clear()
        self._misfit = None
        for name in self._taken:
            self._wire(name)

    def step(self) -> None:
        """Run one tick, with the inputs that were recorded before it and during it.

        Raises:
            ReplayError: an input does not fit the run, or has another outcome.
        """
        while self._next < len(self._inputs):
            entry = self._inputs[self._next]
            here = (self._life, self._simulation.ticks)
            if (entry.life, entry.tick) < here or entry.life > here[0]:
                raise ReplayError(entry, f"it is too late: the run is at tick {here[1]}{_lives(here[0])}")
            if entry.tick > here[1]:
                break
            self._next += 1
            if entry.kind in (COMMAND, CALL):
                self._taken.setdefault(entry.name, []).append(entry)
                self._wire(entry.name)
            elif entry.kind in self._apply:
                self._give(entry)
                if self._misfit is not None:
                    # inputs that follow would not fit, either
                    raise self._misfit
            else:
                raise ReplayError(entry, "there is no such kind of inputs")
        self._check_outcomes()
        if not self.done and self._simulation.tick():
            for entry in (entry for entries in self._taken.values() for entry in entries):
                raise ReplayError(entry, "no active actuator of that name has read it")
            self._check_outcomes()

    def run(self, each_tick: Callable[[], object] | None = None) -> None:
        """Run to the end of the recording.

        Args:
            each_tick: callback, called after every tick.

        Raises:
            ReplayError: an input does not fit the run, or has another outcome.
        """
        try:
            while not self.done:
                self.step()
                if each_tick is not None:
                    each_tick()
        finally:
            self.close()
        InputsState(self._simulation).set_state(self._recording.waiting)

    # -- inputs ----------------------------------------------------------------------------

    def _give(self, entry: Entry) -> None:
        """Let an input take effect, unless it was refused."""
        outcome = self._outcomes.get(entry.order)
        if outcome is not None and outcome.status == status.FAILED and entry.kind in WHOLE:
            if entry.kind == RESTORE:
                self._simulation.journal.life += 1
            return
        self._giving = entry
        try:
            self._apply[entry.kind](entry)
        except Exception as error:  # its outcome is compared
            logger.debug("%s: %s", shown_entry(entry), summary(error))
            if self._giving is not None and self._is_exact and (outcome is None or outcome.status != status.FAILED):
                raise ReplayError(entry, f"it had an effect, and is refused now: {summary(error)}") from None
        finally:
            self._giving = None
        if entry.order in self._calls:
            return
        for number, given in list(self._given.items()):
            if given is entry:
                del self._given[number]
                self._judge(entry, status.SUCCESS, None)

    def _wire(self, name: str) -> None:
        component = self._simulation.context.components.get(name)
        if component is None or self._actuators.get(name) is component:
            return
        self._actuators[name] = component
        if isinstance(component, Actuator):
            component.input_functions.append(self._take)

    def _take(self, component: Any) -> bool:
        has_input = False
        for entry in self._taken.pop(component.name(), ()):
            if entry.kind == CALL:
                with contextlib.suppress(Exception):  # as in the stream that called it
                    self._call(entry)
                continue
            has_input = True
            data, fields = component.local_data, entry.content
            for name in [name for name in data if name not in fields]:
                del data[name]
            data.update(deepcopy(fields))
            if entry.until is not None:
                component.command_end = entry.until
        return has_input

    def _call(self, entry: Entry) -> None:
        service, arguments = entry.content
        if not self._is_input(entry.name, service):
            return
        future = self._simulation.call(entry.name, service, *deepcopy(arguments))
        if not future.done():
            self._calls[entry.order] = entry, future

    def _is_input(self, component: str, service: str) -> bool:
        """Whether calls of a service are recorded. A damaged recording may contain others, which write files."""
        for obj in self._simulation.context.service_objects:
            for one in obj.services():
                if (one.component or obj.name(), one.name) == (component, service):
                    return one.changes
        return True

    def _cancel(self, entry: Entry) -> None:
        # in recordings of earlier versions, a name alone: it means the last call
        service, number = (entry.content, -1) if isinstance(entry.content, str) else entry.content
        for order, (call, future) in reversed(self._calls.items()):
            if number in (-1, order) and (call.name, call.content[0]) == (entry.name, service):
                del self._calls[order]
                future.cancel()
                return

    # -- outcomes --------------------------------------------------------------------------

    def _hear(self, entry: Entry) -> None:
        """An entry of the journal of this run."""
        if entry.kind != OUTCOME:
            if self._giving is not None and entry.kind == self._giving.kind:
                self._given[entry.order], self._giving = self._giving, None
            return
        order, state, result = entry.content
        given = self._given.pop(order, None)
        if given is None:
            return
        self._calls.pop(given.order, None)
        self._judge(given, state, result)

    def _judge(self, given: Entry, state: str, result: object) -> None:
        """Compare an outcome, now, with that of the recorded run."""
        was = self._outcomes.get(given.order)
        if self._misfit is not None or not self._is_exact:
            return
        how = ""
        if was is None:
            # a service that went on, or an effect without a result
            if state == status.FAILED:
                self._misfit = ReplayError(given, f"it had an effect, and is refused now: {shown(result)}")
            return
        tick = self._simulation.ticks
        if was.status != state:
            how = f"its outcome was {_shown(was.status, was.result)}, and is {_shown(state, result)} now"
        elif tick != was.entry.tick:
            how = f"it ended at tick {was.entry.tick}, and ends at tick {tick} now"
        elif self._results and state == status.SUCCESS and not is_same_result(was.result, result):
            how = f"its result was {shown(was.result)}, and is {shown(result)} now"
        if how:
            self._misfit = ReplayError(given, how)

    def _check_outcomes(self) -> None:
        """Raise an error for an outcome that does not fit."""
        here = (self._life, self._simulation.ticks)
        for given in self._given.values():
            was = self._outcomes.get(given.order)
            if self._misfit is None and was is not None and (was.entry.life, was.entry.tick) < here:
                self._misfit = ReplayError(given, f"it ended at tick {was.entry.tick}, and goes on now")
        if self._misfit is not None:
            raise self._misfit

    def close(self) -> None:
        """Take no more inputs."""
        if self._hear in self._simulation.journal.sinks:
            self._simulation.journal.sinks.remove(self._hear)


def _shown(state: str, result: object) -> str:
    return state if result is None else f"{state} ({shown(result)})"


def _lives(life: int) -> str:
    return f" after {life} restarts or restored states" if life else ""


def _rest(content: Value) -> tuple[tuple[float, ...], str | None]:
    return tuple(content[1]), content[2]
