"""Replays a simulation from its recorded inputs."""

from __future__ import annotations

import contextlib
import logging
from copy import deepcopy
from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.journal import CANCEL, COMMAND, CONTROLS, DELETE, EDIT, RESET, RESTORE, SERVICE, SPAWN, Entry
from morse.core.state import StateError
from morse.simulation.states.own_state import InputsState

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.object import Object
    from morse.core.values import Value
    from morse.simulation.handles.futures import LocalFuture
    from morse.simulation.recordings.input_recording import InputRecording
    from morse.simulation.running import Running

logger = logging.getLogger(__name__)


class Replay:
    """Feeds the inputs of a recording to a simulation, each in its tick.

    Args:
        simulation: a simulation of the same scene; it is set to the beginning of the recording.

    Raises:
        StateError: the state at the start of the recording belongs to another scene, or files were edited during the
            recording.
    """

    def __init__(self, simulation: Running, recording: InputRecording) -> None:
        edit = next((entry for entry in recording.entries if entry.kind == EDIT), None)
        if edit is not None:
            raise StateError(
                f"the recording cannot be replayed: '{edit.name}' was edited while it ran, at tick {edit.tick}"
            )
        self._simulation = simulation
        self._recording = recording
        self._next = 0
        self._commands: dict[str, Entry] = {}
        self._actuators: dict[str, Object] = {}
        self._calls: list[tuple[str, str, LocalFuture]] = []
        if recording.start is None:
            simulation.restart(recording.seed)
        else:
            simulation.restore(recording.start)
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
        return self._next >= len(self._recording.entries) and self._simulation.ticks >= self._recording.last

    def place(self) -> tuple[int, dict[str, Entry]]:
        """The position in the recording, for `go_to`."""
        return self._next, dict(self._commands)

    def go_to(self, place: tuple[int, dict[str, Entry]]) -> None:
        """Continue at another position; the simulation must be in its state at that position."""
        self._next, commands = place
        self._commands = dict(commands)
        for name in self._commands:
            self._wire(name)

    def step(self) -> None:
        """Run one tick, with the inputs that were recorded before it and during it."""
        entries = self._recording.entries
        while self._next < len(entries) and entries[self._next].tick == self._simulation.ticks:
            entry = entries[self._next]
            self._next += 1
            if entry.kind == COMMAND:
                self._commands[entry.name] = entry
                self._wire(entry.name)
                continue
            if self._commands:
                # commands are applied within a tick, so later entries came after that tick
                self._next -= 1
                break
            # a call that was refused during the recording is refused again
            with contextlib.suppress(Exception):
                self._apply[entry.kind](entry)
        if not self.done:
            self._simulation.tick()

    def run(self, each_tick: Callable[[], object] | None = None) -> None:
        """Run to the end of the recording.

        Args:
            each_tick: callback, called after every tick.
        """
        while not self.done:
            self.step()
            if each_tick is not None:
                each_tick()
        InputsState(self._simulation).set_state(self._recording.waiting)

    # -- inputs ----------------------------------------------------------------------------

    def _wire(self, name: str) -> None:
        component = self._simulation.context.components.get(name)
        if component is None or self._actuators.get(name) is component:
            return
        self._actuators[name] = component
        if isinstance(component, Actuator):
            component.input_functions.append(self._take)

    def _take(self, component: Any) -> bool:
        entry = self._commands.pop(component.name(), None)
        if entry is None:
            return False
        data, fields = component.local_data, entry.content
        for name in [name for name in data if name not in fields]:
            del data[name]
        data.update(deepcopy(fields))
        if entry.until is not None:
            component.command_end = entry.until
        return True

    def _call(self, entry: Entry) -> None:
        service, arguments = entry.content
        if not self._is_input(entry.name, service):
            return
        future = self._simulation.call(entry.name, service, *arguments)
        if not future.done():
            self._calls.append((entry.name, service, future))

    def _is_input(self, component: str, service: str) -> bool:
        """Whether calls of a service are recorded. A damaged recording may contain others, which write files."""
        for obj in self._simulation.context.service_objects:
            for one in obj.services():
                if (one.component or obj.name(), one.name) == (component, service):
                    return one.changes
        return True

    def _cancel(self, entry: Entry) -> None:
        for call in reversed(self._calls):
            component, service, future = call
            if (component, service) == (entry.name, entry.content):
                self._calls.remove(call)
                future.cancel()
                return


def _rest(content: Value) -> tuple[tuple[float, ...], str | None]:
    return tuple(content[1]), content[2]
