"""The journal: all input of a simulation from outside, with the tick of each input.

A run is determined by its scene, its seed and its inputs. Inputs are of three kinds: commands that actuators receive,
service calls (and their cancellation), and controls, the keyboard and gamepad input at the live view. The entry
``edit`` marks a run during which a model or the file of a component was edited: the inputs alone do not determine such
a run.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clock import Clock
    from morse.core.guard import Guard
    from morse.core.values import Value

COMMAND, SERVICE, CANCEL, CONTROLS, RESET, RESTORE, SPAWN, DELETE, EDIT = (
    "command",
    "service",
    "cancel",
    "controls",
    "reset",
    "restore",
    "spawn",
    "delete",
    "edit",
)


class Entry(NamedTuple):
    """One input.

    Attributes:
        tick: number of ticks that were complete when the input took effect.
        kind: ``command``, ``service``, ``cancel``, ``controls``, ``reset``, ``restore``, ``spawn``, ``delete`` or
            ``edit``.
        name: name of the component, for commands and services; of the file, for an edit.
        content: fields of a command; name and arguments of a service call; and so on.
        until: simulated time at which a command ends, s; None if it does not end.
    """

    tick: int
    kind: str
    name: str
    content: Value
    until: float | None = None


class Journal:
    """Passes each input to the sinks.

    Attributes:
        sinks: callbacks that receive each `Entry` in the simulation thread. Without sinks no entries are created.
    """

    def __init__(self, clock: Clock, guard: Guard) -> None:
        self._clock, self._guard = clock, guard
        self.sinks: list[Callable[[Entry], object]] = []

    def note(self, kind: str, name: str, content: object, until: float | None = None) -> None:
        """Record an input that takes effect now. The content must not be modified afterwards."""
        if self.sinks:
            entry = Entry(self._clock.tick, kind, name, content, until)
            self._guard.call(self.sinks, entry)
