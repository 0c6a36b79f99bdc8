"""Everything that comes into a simulation from outside, with the tick at which it came.

A run is determined by its scene, its seed and its inputs. Inputs are of three kinds: commands that actuators receive,
calls of services (and their cancellation), and controls: what a person does at the live view. The entry ``edit``
marks a run during which a model or the file of a component was edited: the inputs alone do not determine such a run.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clock import Clock

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
        tick: number of ticks that were done when the input took effect.
        kind: ``command``, ``service``, ``cancel``, ``controls``, ``reset``, ``restore``, ``spawn``, ``delete`` or
            ``edit``.
        name: the component, for commands and services; the file, for an edit.
        content: fields of a command; name and arguments of a service; ...
    """

    tick: int
    kind: str
    name: str
    content: Any


class Journal:
    """Hands every input to those who keep it.

    Attributes:
        sinks: called with each `Entry`, in the simulation thread. Without sinks nothing is worked out.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.sinks: list[Callable[[Entry], object]] = []

    def note(self, kind: str, name: str, content: Any) -> None:
        """An input takes effect now. The content must not change afterwards."""
        if self.sinks:
            entry = Entry(self._clock.tick, kind, name, content)
            for sink in list(self.sinks):
                sink(entry)
