"""The journal: all input of a simulation from outside, with the tick of each input and its outcome.

A run is determined by its scene, its seed and its inputs. Inputs are of three kinds: commands that actuators receive,
service calls (and their cancellation), and controls, the keyboard and gamepad input at the live view. The entry
``edit`` marks a run during which a model or the file of a component was edited: the inputs alone do not determine such
a run.

The entries are one sequence: each has a number (``order``) and a place in time (``life``, ``tick``), which never goes
back, although a restart sets the tick back. What happens within a restart, or while a state is restored, is no input:
it ends running services, for example, and repeating it ends them again. The outcome of an input is an entry of its own,
``outcome``; an input without one had an effect and no result, or is a service that goes on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import msgspec

from morse.core import status
from morse.core.reports.faults import ENDINGS, is_a, summary
from morse.core.state import NoReferences, StateError, Writer

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

    from morse.core.clock import Clock
    from morse.core.guard import Guard
    from morse.core.values import Value

COMMAND, SERVICE, CALL, CANCEL, CONTROLS, RESET, RESTORE, SPAWN, DELETE, EDIT, OUTCOME = (
    "command",
    "service",
    "call",
    "cancel",
    "controls",
    "reset",
    "restore",
    "spawn",
    "delete",
    "edit",
    "outcome",
)
#: inputs after which a new life begins
REBIRTHS = (RESET, RESTORE)
#: inputs that are refused as a whole, or take effect as a whole
WHOLE = (RESTORE, SPAWN, DELETE)
#: largest result of a service that an outcome contains, bytes
_LARGEST = 1 << 16
_LONGEST = 500
_encode = msgspec.msgpack.Encoder().encode


class Entry(NamedTuple):
    """One input, or the outcome of one.

    Attributes:
        tick: number of ticks that were complete when the input took effect.
        kind: ``command``, ``service``, ``call`` (a service that an actuator calls when it reads a message), ``cancel``,
            ``controls``, ``reset``, ``restore``, ``spawn``, ``delete``, ``edit`` or ``outcome``.
        name: name of the component, for commands and services; of the file, for an edit.
        content: fields of a command; name and arguments of a service call; of an outcome, the number of the input, its
            status (`morse.core.status`), and its result or the text of its error; and so on.
        until: simulated time at which a command ends, s; None if it does not end.
        life: number of restarts of the simulation, and of restored states, before.
        order: number of the entry; -1 in recordings of earlier versions.
    """

    tick: int
    kind: str
    name: str
    content: Value
    until: float | None = None
    life: int = 0
    order: int = -1


class Input:
    """An input that takes effect in a ``with`` block; an error that the block raises is its outcome.

    Attributes:
        withheld: what happened within.
    """

    __slots__ = ("_journal", "_kind", "_name", "_order", "withheld")

    def __init__(self, journal: Journal, kind: str, name: str, order: int | None) -> None:
        self._journal, self._kind, self._name, self._order = journal, kind, name, order
        self.withheld: list[tuple[str, str, object]] = []

    def __enter__(self) -> Input:
        if self._kind in REBIRTHS:
            self._journal.rebirths.append(self)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        journal = self._journal
        if self._kind in REBIRTHS:
            journal.rebirths.remove(self)
            journal.life += 1
            journal.is_blank = error is None and self._kind == RESET
        if error is not None and self._kind in WHOLE:
            # it is not repeated, but they are
            for one in self.withheld:
                journal.note(*one)
        if self._order is not None and error is not None:
            journal.refuse(self._name, self._order, error)


class Journal:
    """Passes each input to the sinks.

    Attributes:
        sinks: callbacks that receive each `Entry` in the simulation thread. Without sinks no entries are created.
        life: number of restarts of the simulation, and of restored states, so far; also of those that were refused.
        rebirths: the restarts and restored states that take effect now.
        is_blank: whether there was no input since the launch or the last restart, also without sinks.
    """

    def __init__(self, clock: Clock, guard: Guard) -> None:
        self._clock, self._guard = clock, guard
        self.sinks: list[Callable[[Entry], object]] = []
        self.life = 0
        self.rebirths: list[Input] = []
        self.is_blank = True
        self._next = 0

    def note(self, kind: str, name: str, content: object, until: float | None = None) -> int | None:
        """Record an input that takes effect now.

        Returns:
            The number of the entry; None if there is none: nobody reads it, or it happens within a restart.
        """
        self.is_blank = False
        if not self.sinks:
            return None
        if self.rebirths and kind not in (COMMAND, EDIT, OUTCOME):
            self.rebirths[-1].withheld.append((kind, name, content))
            return None
        number = self._next
        self._next += 1
        self._guard.call(self.sinks, Entry(self._clock.tick, kind, name, content, until, self.life, number))
        return number

    def input(self, kind: str, name: str, content: object) -> Input:
        """Record an input that takes effect in the ``with`` block of the result; see `note`."""
        return Input(self, kind, name, self.note(kind, name, content))

    def conclude(self, name: str, order: int, state: str, result: object) -> None:
        """Record the outcome of an input.

        Args:
            name: see `Entry`.
            order: number of the input.
            state: see `morse.core.status`.
            result: the result of a service, or the text of an error.
        """
        if self.sinks:
            self.note(OUTCOME, name, (order, state, plain_result(result)))

    def refuse(self, name: str, order: int, error: BaseException) -> None:
        """Record that an input has failed; see `conclude`."""
        if not is_a(error, ENDINGS):
            self.conclude(name, order, status.FAILED, summary(error)[:_LONGEST])


def plain_result(result: object) -> object:
    """The result of a service as plain data; None for one without such a form, or larger than 64 KiB."""
    if result is None or isinstance(result, (bool, int, float)):
        return result
    try:
        writer = Writer(NoReferences())
        value = writer.value(result)
        is_small = not writer.unsaved and len(_encode(value)) <= _LARGEST
    except (StateError, ValueError, TypeError, RecursionError, ArithmeticError):
        return None
    return value if is_small else None


def is_same_result(one: object, other: object) -> bool:
    """Whether two results of `plain_result` are equal to the bit."""
    return _encode(one) == _encode(other)
