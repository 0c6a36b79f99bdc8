"""The guard: it calls code that is not the simulator's own, and switches off the part that raises.

A fault stays where it is. Every call of a component, a modifier, a stream, a middleware, an observer, a server or a
callback goes through a function of this file. What it raises switches off that part, which is named in the log with the
file and the line; all other parts continue with the data that they would have had anyway. Only what ends a program is
passed on: `KeyboardInterrupt` and `SystemExit`.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Protocol, TypeVar

from morse.core.reports.faults import (
    ENDINGS,
    attribute,
    class_name,
    definition,
    describe,
    is_a,
    is_users,
    line_of_fault,
    name_of,
    place,
    summary,
    trace_of,
    user_frames,
)
from morse.core.streams.functions import manager_of, stream_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, MutableMapping, MutableSequence, Sequence

    from morse.core.clock import Clock
    from morse.core.interfaces import Acting, Component, Middleware, Modifier
    from morse.core.observer import Observer

_R = TypeVar("_R")
_P = TypeVar("_P")
_O = TypeVar("_O", bound="Observer")
_Call = TypeVar("_Call", bound="Callable[..., object]")

logger = logging.getLogger(__name__)

#: consequence of an error while a part is being closed
_AGAIN = "is left as it is"
#: largest number of failures that are kept, so that clients which cause them do not fill the memory
_MOST = 1000
#: largest number of parts that a message names, and of characters of an error in it
_MOST_LINES, _LONGEST_CAUSE = 50, 200


def before_tick(observer: Observer) -> None:
    """Notify an observer; for `Guard.each`."""
    observer.before_tick()


def after_tick(observer: Observer) -> None:
    """Notify an observer; for `Guard.each`."""
    observer.after_tick()


class Failure(NamedTuple):
    """What has failed in a simulation.

    Attributes:
        kind: ``fault`` for a part that was switched off because it raised an error, or did not end; ``fallen`` for a
            robot that has left the world.
        part: name of the component, else words such as ``the stream Line of robot.pose``.
        consequence: what has followed, such as ``is deactivated``.
        time: simulated time at which it was noticed, s.
        cause: class and message of the error, or the place of the robot.
        where: file and line of the cause, such as ``/home/me/scene.py:12``; empty if they are not known.
    """

    kind: Literal["fault", "fallen"]
    part: str
    consequence: str
    time: float
    cause: str
    where: str = ""

    def __str__(self) -> str:
        cause = " ".join(self.cause.split())
        cause = cause if len(cause) <= _LONGEST_CAUSE else f"{cause[:_LONGEST_CAUSE]}…"
        where = f" ({self.where})" if self.where else ""
        failed = "failed and " if self.kind == "fault" else ""
        return f"at {self.time:.3f} s {self.part} {failed}{self.consequence}: {cause}{where}"


def by_part(failures: Iterable[Failure]) -> str:
    """Return one line for each part that has failed: its first failure, and the number of the others."""
    parts: dict[str, list[Failure]] = {}
    for failure in failures:
        parts.setdefault(failure.part, []).append(failure)
    lines = [f"{first}{f', and {len(others)} more' if others else ''}" for first, *others in parts.values()]
    if len(lines) > _MOST_LINES:
        lines[_MOST_LINES:] = [f"and {len(lines) - _MOST_LINES} other parts"]
    return "\n".join(f"  {line}" for line in lines)


class Guarded(Protocol):
    """The parts of a simulation that the guard reads, see `morse.core.context.Context`."""

    @property
    def clock(self) -> Clock:
        """The clock."""

    @property
    def failed(self) -> set[str]:
        """Names of the components that were deactivated."""

    @property
    def stream_managers(self) -> MutableMapping[str, Middleware]:
        """The middlewares by class path."""

    @property
    def robots(self) -> Mapping[str, Component]:
        """Robots by name."""

    @property
    def components(self) -> Mapping[str, Component]:
        """Sensors and actuators by name."""


class Guard:
    """Switches off the parts of one simulation that raise errors, and names them in the log.

    Attributes:
        raises: receives each error and the name of its part instead of the log, if the program asked for that by
            ``on_failure="raise"``; None to log them. It returns False for an error that has to be logged nevertheless.
        failures: what has failed since the scene was loaded, the first thousand; a restart keeps them.
        managers_off: class paths of the middlewares that have failed: a restart does not open them again.
        remarks: returns texts about a component that has failed, such as the methods that its attributes hide.
    """

    def __init__(self, context: Guarded) -> None:
        self._context = context
        self.raises: Callable[[BaseException, str], bool] | None = None
        self.failures: list[Failure] = []
        self.managers_off: set[str] = set()
        self.remarks: Callable[[object], Iterable[str]] = _no_remarks
        #: components that cannot be switched off: they go on raising, and nobody hears of it
        self._deaf: dict[int, Acting] = {}

    # -- calls -----------------------------------------------------------------------------

    def act(self, components: Iterable[Acting]) -> None:
        """Let components act; one that raises is deactivated."""
        for component in components:
            try:
                component.action()
            except BaseException as error:
                self.deactivate(component, error)

    def each(
        self, parts: Iterable[_P], call: Callable[[_P], object], off: Callable[[_P, BaseException], object]
    ) -> None:
        """Call a function with each part; ``off(part, error)`` switches off those for which it raises."""
        failures: list[tuple[_P, BaseException]] | None = None
        for part in parts:
            try:
                call(part)
            except ENDINGS:
                raise
            except BaseException as error:
                failures = failures or []
                failures.append((part, error))
        if failures is not None:
            # afterwards, because it may change the list of the parts
            for part, failure in failures:
                off(part, failure)

    def those(
        self, parts: Iterable[_P], holds: Callable[[_P], object], off: Callable[[_P, BaseException], object]
    ) -> list[_P]:
        """Return the parts for which a condition holds; ``off(part, error)`` switches off those that cannot tell."""
        members: list[_P] = []

        def look(part: _P) -> None:
            if holds(part):
                members.append(part)

        self.each(parts, look, off)
        return members

    def run(self, function: Callable[[], _R], off: Callable[[BaseException], object]) -> _R | None:
        """Return the result of a function; None after ``off(error)`` if it raises."""
        try:
            return function()
        except ENDINGS:
            raise
        except BaseException as error:
            off(error)
        return None

    def call(self, functions: MutableSequence[_Call], *arguments: object) -> None:
        """Call the functions of a list; one that raises is removed from it."""
        self.each(functions, lambda one: one(*arguments), lambda one, error: self.remove(functions, one, error))

    def tell(self, observers: MutableSequence[_O], call: Callable[[_O], object]) -> None:
        """Notify observers; one that raises is removed and closed."""
        self.each(observers, call, lambda observer, error: self.dismiss(observers, observer, error))

    # -- switching off -----------------------------------------------------------------------

    def failed(self, part: object, who: str, what: str, error: BaseException) -> None:
        """Report a part that has failed, and that is switched off.

        Args:
            who: the part in the message.
            what: what follows from the failure: ``is closed``.

        Raises:
            KeyboardInterrupt, SystemExit: the error is not a failure, but ends the program.
        """
        if is_a(error, ENDINGS):
            raise error
        self.note(Failure("fault", who, what, self._context.clock.time, summary(error), line_of_fault(part, error)))
        if self.raises is not None and self.raises(error, who):
            return
        text = describe(error)
        if not user_frames(trace_of(error)):
            lines = definition(part)
            if not lines or not is_users(lines.split('"')[1]):
                lines = place(error)
            text += f"\n{lines}" if lines and not is_a(error, OSError) else ""
        logger.error("[ERROR][MORSE] %s failed and %s: %s", who, what, text)

    def note(self, failure: Failure) -> None:
        """Keep a failure that is reported elsewhere."""
        if len(self.failures) < _MOST:
            self.failures.append(failure)

    def deactivate(self, component: Acting, error: BaseException, culprit: object = None) -> None:
        """Switch off a component.

        Args:
            culprit: its modifier that has raised the error, if it was not the component itself.
        """
        if is_a(error, ENDINGS):
            raise error
        if id(component) in self._deaf:
            return
        remarks = self.run(lambda: list(self.remarks(component)), _ignored) or []
        name = name_of(component)
        for text in remarks:
            logger.error("[ERROR][MORSE] %s: %s", name, text)
        if culprit is None:
            self.failed(component, name, "is deactivated", error)
        else:
            who = f"the modifier {class_name(type(culprit))} of {name}"
            self.failed(culprit, who, f"{name} is deactivated, because its data are not modified", error)
        self._context.failed.add(name)
        self.run(lambda: component.switch_off(), lambda _: self._deaf.update({id(component): component}))

    def close(
        self, component: Component, functions: MutableSequence[_Call], function: _Call, error: BaseException
    ) -> None:
        """Close a stream of a component, and nothing else; if the component has lost its data, that is the fault."""
        if not is_a(vars(component).get("local_data", {}), dict):
            if component._active:  # each of its streams finds out
                self.deactivate(component, _without_data(component, error))
            return
        stream = stream_of(function)
        self.failed(stream, f"the stream {name_of(stream)} of {name_of(component)}", "is closed", error)
        functions[:] = [one for one in functions if one is not function and stream_of(one) is not stream]
        drop = attribute(attribute(stream, "manager"), "drop")
        if drop is not None:
            self.run(lambda: drop(stream), lambda again: self.failed(stream, name_of(stream), _AGAIN, again))

    def remove(self, functions: MutableSequence[_Call], function: object, error: BaseException) -> None:
        """Remove a callback from its list."""
        self.failed(function, f"the callback {name_of(function)}", "is removed", error)
        functions[:] = [one for one in functions if one is not function]

    def dismiss(self, observers: MutableSequence[_O], observer: _O, error: BaseException) -> None:
        """Remove an observer, and close it; of a middleware, also all of its streams."""
        own = attribute(observer, "__dict__", {}).get("classpath")
        who = f"the middleware {own}" if is_a(own, str) else f"the observer {class_name(type(observer))}"
        self.failed(observer, who, "is removed", error)
        observers[:] = [one for one in observers if one is not observer]
        managers: MutableMapping[str, Any] = self._context.stream_managers
        for path in [path for path, manager in managers.items() if manager is observer]:
            del managers[path]
            self.managers_off.add(path)
            for component in [*self._context.robots.values(), *self._context.components.values()]:
                for functions in (component.input_functions, component.output_functions):
                    functions[:] = [one for one in functions if manager_of(one) is not observer]
        self.run(observer.close, lambda again: self.failed(observer, who, _AGAIN, again))


def _no_remarks(_component: object) -> Iterable[str]:
    return ()


def _ignored(_error: BaseException) -> None:
    """Used where another error is being reported."""


def _without_data(component: object, error: BaseException) -> BaseException:
    kind = class_name(type(vars(component).get("local_data")))
    return TypeError(f"self.local_data is a dictionary of the data, not {kind}").with_traceback(trace_of(error))


def modify(component: Component, modifiers: Sequence[Modifier]) -> bool:
    """Apply modifiers to the data of a component.

    Returns:
        False if one has raised. Data without a promised modification must be neither published nor obeyed: the
        component is deactivated.
    """
    for modifier in modifiers:
        try:
            modifier.modify()
        except BaseException as error:
            component.context.guard.deactivate(component, error, modifier)
            return False
    return True
