"""Handles of robots, sensors and actuators, with the interface of `pymorse.Component`."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from morse.core import status
from morse.core.actuator import Actuator, PendingCommands
from morse.core.image_colors import is_picture
from morse.core.realism import copied
from morse.core.reports.quoting import nearest
from morse.core.rows.marks import present_data
from morse.core.sensor import Sensor
from morse.core.validation.spec import CommandError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from morse.core.clock import Clock
    from morse.core.context import Context
    from morse.core.guard import Guard
    from morse.core.object import Object
    from morse.core.request_manager import Outcome
    from morse.core.values import Fields, Value
    from morse.simulation.handles.handles import Handles
    from morse.simulation.handles.world_changes import Contacts


# The result of a service that was called from within the process.


def _nothing() -> None:
    """Default for `LocalFuture.abort`: there is nothing to abort."""


class LocalFuture:
    """The result of a service call, with the interface of `pymorse.MorseFuture`.

    Most services end immediately. If a service continues over several ticks, `result` runs the simulation until the
    service has ended. A comparison of the future does the same.

    Attributes:
        abort: function that interrupts the service.
    """

    def __init__(self, tick: Callable[[], object], clock: Clock, guard: Guard) -> None:
        self._tick = tick
        self._guard = guard
        self._clock = clock
        self._outcome: Outcome | None = None
        self._callbacks: list[Callable[[LocalFuture], object]] = []
        self.abort: Callable[[], object] = _nothing

    def finish(self, outcome: Outcome) -> None:
        """Set the outcome when the service has ended."""
        self._outcome = outcome
        callbacks, self._callbacks = self._callbacks, []
        # the callbacks belong to the caller, not to the component whose service ends
        self._guard.call(callbacks, self)

    def done(self) -> bool:
        """Whether the service has ended."""
        return self._outcome is not None

    def running(self) -> bool:
        """Whether the service is still running."""
        return self._outcome is None

    def cancel(self) -> bool:
        """Interrupt the service; return True if it was still running."""
        if self.done():
            return False
        self.abort()
        return True

    def cancelled(self) -> bool:
        """Whether the service was cancelled or interrupted."""
        return self._outcome is not None and self._outcome[0] == status.PREEMPTED

    def result(self, timeout: float | None = None) -> Value:
        """Run the simulation until the service has ended, and return the result.

        Args:
            timeout: timeout in simulated seconds; None for no timeout.

        Raises:
            pymorse.MorseServiceFailed: the service failed.
            pymorse.MorseServicePreempted: the service was cancelled or interrupted.
            TimeoutError: the service takes longer than ``timeout``; it continues.
        """
        error = self.exception(timeout)
        if error is not None:
            raise error
        assert self._outcome is not None
        return self._outcome[1]

    def exception(self, timeout: float | None = None) -> BaseException | None:
        """Return the exception that `result` would raise, or None.

        Raises:
            TimeoutError: the service takes longer than ``timeout``.
        """
        last = None if timeout is None else self._clock.tick + timeout * self._clock.frequency
        while self._outcome is None:
            if last is not None and self._clock.tick >= last:
                raise TimeoutError("the service has not ended yet")
            self._tick()
        state, value = self._outcome
        if state == status.SUCCESS:
            return None
        from pymorse.errors import MorseServiceFailed, MorseServicePreempted

        return MorseServicePreempted(value) if state == status.PREEMPTED else MorseServiceFailed(value)

    def add_done_callback(self, fn: Callable[[LocalFuture], object]) -> None:
        """Call ``fn(future)`` when the service ends, or immediately if it has ended."""
        if self.done():
            fn(self)
        else:
            self._callbacks.append(fn)

    def __eq__(self, other: object) -> bool:
        return bool(self.result() == _value(other))

    def __ne__(self, other: object) -> bool:
        return bool(self.result() != _value(other))

    def __lt__(self, other: object) -> bool:
        return bool(self.result() < _value(other))

    def __le__(self, other: object) -> bool:
        return bool(self.result() <= _value(other))

    def __gt__(self, other: object) -> bool:
        return bool(self.result() > _value(other))

    def __ge__(self, other: object) -> bool:
        return bool(self.result() >= _value(other))

    # comparison uses the result, but sets and dictionaries use the identity of the future
    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return repr(self.result()) if self.done() else "<a service that is running>"


def _value(other: object) -> Value:
    return other.result() if isinstance(other, LocalFuture) else other


_C = TypeVar("_C", bound="Object")

#: number of messages of a sensor that are kept for `ComponentHandle.last`
_KEPT = 100
_PLAIN = frozenset((float, int, bool, str, type(None)))


def component_handles(simulation: Handles, kept: dict[str, ComponentHandle]) -> dict[str, object]:
    """Return the handles of all robots by name, and the lists of robots that were created in loops.

    Args:
        kept: existing handles by full name; handles of components that still exist are reused.
    """
    from pymorse.names import normalize_name, series

    context = simulation.context
    handles: dict[str, object] = {}
    for name in [name for name in kept if context.component(name) is None]:
        del kept[name]
    for name, robot in context.robots.items():
        handle = _handle(RobotHandle, simulation, name, normalize_name(name), kept)
        by_name: dict[str, ComponentHandle] = {name: handle}
        for full in sorted((n for n, c in context.components.items() if c.robot_parent is robot), key=_depth):
            above, _, own = full.rpartition(".")
            part = by_name[full] = _handle(ComponentHandle, simulation, full, normalize_name(own), kept)
            by_name.get(above, handle).parts[part.name] = part
        handles[handle.name] = handle
    for plural, members in series(handles).items():
        handles.setdefault(plural, [handles[member] for member in members])
    return handles


def _handle(
    cls: type[ComponentHandle], simulation: Handles, full: str, name: str, kept: dict[str, ComponentHandle]
) -> ComponentHandle:
    if full not in kept:
        kept[full] = cls(simulation, full, name)
    kept[full].parts.clear()
    return kept[full]


def normalized(name: str) -> str:
    """Return the attribute name for a robot."""
    from pymorse.names import normalize_name

    return normalize_name(name)


def handle_of(simulation: Handles, name: str) -> ComponentHandle:
    """Return the handle of a robot or a component, given its full name or attribute names joined by dots.

    Raises:
        KeyError: there is no such component.
        TypeError: the name is not a text.
    """
    if not isinstance(name, str):
        raise TypeError(f"a component is given by its full name, such as 'robot.pose', not {name!r:.80}")
    robot, *parts = name.split(".")
    handle = simulation[robot]
    if not isinstance(handle, ComponentHandle):
        raise KeyError(f"'{robot}' are {len(handle)} robots: name one of them, such as '{handle[0].fqn}'")
    for part in parts:
        if part not in handle.parts:
            raise KeyError(f"{handle.fqn} has no '{part}'{nearest(part, list(handle.parts))}")
        handle = handle.parts[part]
    return handle


def _depth(name: str) -> int:
    return name.count(".")


class ComponentHandle:
    """A sensor or an actuator.

    The services are methods that return a `LocalFuture`. The components mounted on this component are attributes. A
    sensor is read with `data`, `get`, `last` and `subscribe`; an actuator is commanded with `publish`.

    Attributes:
        name: name of the attribute of the robot.
        fqn: the full name in the simulation.
        parts: the components mounted on it.
    """

    #: what a program of a user calls besides services, by the kind of the component
    _own_names: ClassVar[dict[type, tuple[str, ...]]] = {
        Sensor: ("data", "get", "last", "subscribe", "unsubscribe"),
        Actuator: ("data", "publish"),
    }

    def __init__(self, simulation: Handles, fqn: str, name: str) -> None:
        self._simulation = simulation
        self._context: Context = simulation.context
        self.fqn = fqn
        self.name = name
        self.parts: dict[str, ComponentHandle] = {}
        self._wired: Object | None = None
        self._messages: deque[Fields] = deque(maxlen=_KEPT)
        self._count = 0
        self._subscribers: list[Callable[[Fields], object]] = []
        self._pending: PendingCommands

    @property
    def component(self) -> Object:
        """The component itself, as created at the last start.

        Raises:
            LookupError: the component was deleted.
            RuntimeError: the simulation is closed.
        """
        if self._simulation.finished:
            raise RuntimeError(f"{self.fqn}: the simulation is closed")
        component = self._context.component(self.fqn)
        if component is None:
            raise LookupError(f"the component '{self.fqn}' does not exist any more")
        return component

    def replaced(self, before: Object, after: Object) -> None:
        """Called when a component was replaced by another one, which has taken over its input and output functions."""
        if self._wired is before:
            self._wired = after
            if isinstance(after, Actuator):
                self._pending.move_to(after)

    # -- data ------------------------------------------------------------------------------

    @property
    def data(self) -> Fields:
        """A copy of the present data; arrays stay arrays."""
        return _copy(present_data(self.component))

    def publish(self, message: Fields) -> None:
        """Set fields of an actuator, which applies them in the next tick.

        Raises:
            AttributeError: the component is not an actuator.
            CommandError: a field does not exist, or a value is not valid; the command is then ignored.
        """
        component = self._wired
        if component is None or not self._is_current(component):
            component = self._wire(Actuator, "publish", "it is a sensor: use data, get(), last() or subscribe()")
            self._pending = PendingCommands(component)
        try:
            self._pending.give(message)
        except CommandError as error:
            raise CommandError(error.field, f"{self.fqn}: {error}") from None

    def get(self, timeout: float | None = None) -> Fields | None:
        """Run the simulation until the sensor measures, and return the data.

        Args:
            timeout: timeout in simulated seconds; None for no timeout.

        Returns:
            The data; None after ``timeout``.

        Raises:
            RuntimeError: the sensor is not active and would never measure, and there is no timeout.
        """
        sensor = self._listen("get")
        clock, count = self._context.clock, self._count
        last = None if timeout is None else clock.tick + timeout * clock.frequency
        while self._count == count:
            if last is not None and clock.tick >= last:
                return None
            if last is None and not sensor.active:
                raise RuntimeError(f"{self.fqn} is not active: it does not measure")
            self._simulation.step()
        return _copy(self._messages[-1])

    def last(self, n: int = 1) -> Fields | list[Fields] | None:
        """Return the latest data since the first use of this handle, or None; for ``n`` > 1 a list, latest first."""
        self._listen("last")
        if n == 1:
            return _copy(self._messages[-1]) if self._messages else None
        return [_copy(message) for message in list(self._messages)[: -n - 1 : -1]] or None

    def subscribe(self, callback: Callable[[Fields], object]) -> None:
        """Call ``callback(data)`` at each measurement."""
        self._listen("subscribe")
        self._subscribers.append(callback)

    def unsubscribe(self, callback: Callable[[Fields], object]) -> None:
        """Remove a callback; one that has failed was already removed."""
        if callback in self._subscribers:
            self._subscribers.remove(callback)

    def _listen(self, word: str) -> Object:
        component = self._wired
        if component is None or not self._is_current(component):
            component = self._wire(
                Sensor,
                word,
                "it is an actuator: use publish()"
                if isinstance(self.component, Actuator)
                else "it measures nothing by itself: read data, or a sensor on it",
            )
            component.output_functions.append(self._measured)
        return component

    def _is_current(self, component: Object) -> bool:
        return component is self._context.components.get(self.fqn) and not self._simulation.finished

    def _wire(self, kind: type[_C], word: str, hint: str) -> _C:
        component = self.component
        if not isinstance(component, kind):
            raise AttributeError(f"{self.fqn} has no {word}: {hint}", name=word)
        self._wired = component
        return component

    def _measured(self, sensor: Object) -> None:
        message = _copy(present_data(sensor))
        self._messages.append(message)
        self._count += 1
        if self._subscribers:
            guard, subscribers = self._context.guard, self._subscribers
            guard.each(
                list(subscribers),
                lambda callback: callback(_copy(message)),
                lambda callback, error: guard.remove(subscribers, callback, error),
            )

    def listen_again(self) -> None:
        """Subscribe again, because the component may be a new instance."""
        if isinstance(self._wired, Sensor) and self._context.component(self.fqn) is not None:
            self._listen("subscribe")

    # -- services --------------------------------------------------------------------------

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self.parts:
            return self.parts[name]
        if name in self._services():

            def call(*arguments: object) -> LocalFuture:
                return self._simulation.call(self.fqn, name, *arguments)

            return call
        raise self._missing(name)

    def _services(self) -> list[str]:
        return [declaration.name for declaration in self.component.services()]

    def _missing(self, name: str) -> Exception:
        # with a name, but without an object, Python adds no suggestion of its own
        return AttributeError(f"{self.fqn} has no '{name}'{nearest(name, [*self.parts, *self._services()])}", name=name)

    def __dir__(self) -> list[str]:
        component = None if self._simulation.finished else self._context.component(self.fqn)
        own = next((names for kind, names in self._own_names.items() if isinstance(component, kind)), ())
        return sorted(
            {"component", "fqn", "name", "parts", *own, *self.parts, *(self._services() if component else ())}
        )

    def _repr_png_(self) -> bytes | None:
        """Return the present image of a camera as a PNG file, which notebooks display; None for other components."""
        # imported on demand, because only notebooks need it
        from morse.core.image_colors import png_of

        try:
            return png_of(self.component)
        except (LookupError, RuntimeError):
            return None

    def __repr__(self) -> str:
        try:
            data = self.component.local_data
            names = ", ".join([*self.parts] or [*data] or self._services())
            # a notebook shows this in place of the picture
            blank = "; no image before sim.step()" if "image" in data and not is_picture(data["image"]) else ""
            return f"<{type(self.component).__name__} {self.fqn}: {names}{blank}>"
        except (LookupError, RuntimeError):
            return f"<{self.fqn}, which is not there any more>"


class RobotHandle(ComponentHandle):
    """A robot; its components are available as items and as attributes."""

    _own_names: ClassVar[dict[type, tuple[str, ...]]] = {
        object: (
            "contacts",
            "keys",
            "place",
            "restart",
            "set_color",
            "set_friction",
            "set_light",
            "set_mass",
            "set_texture",
        )
    }

    def __getitem__(self, name: str) -> ComponentHandle:
        """The component of that name.

        Raises:
            KeyError: the robot has no such component.
        """
        if name not in self.parts:
            raise KeyError(f"the robot {self.fqn} has no '{name}'{nearest(name, list(self.parts))}")
        return self.parts[name]

    def place(self, pose: Sequence[float]) -> None:
        """Place the robot, at rest; see `Simulation.place`."""
        self._simulation.place(self.fqn, pose)

    def set_mass(self, mass: float) -> None:
        """Set the mass of the robot, kg; see `Simulation.set_mass`."""
        self._simulation.set_mass(self.fqn, mass)

    def set_friction(self, friction: float) -> None:
        """Set the friction of the robot; see `Simulation.set_friction`."""
        self._simulation.set_friction(self.fqn, friction)

    def restart(self, seed: int | None = None) -> None:
        """Restart the robot as after the load; see `Simulation.restart_robot`, which restarts a robot by name."""
        self._simulation.restart_robot(self.fqn, seed)

    def set_color(self, color: Sequence[float]) -> None:
        """Set the colour of all surfaces of the robot; see `Simulation.set_color`."""
        self._simulation.set_color(self.fqn, color)

    def set_light(self, energy: float) -> None:
        """Set the brightness of all lamps of the robot; see `Simulation.set_light`."""
        self._simulation.set_light(self.fqn, energy)

    def set_texture(self, picture: str) -> None:
        """Set the texture of all surfaces of the robot; see `Simulation.set_texture`."""
        self._simulation.set_texture(self.fqn, picture)

    def contacts(self) -> Contacts:
        """Return what the robot touches from now on; see `Simulation.contacts`."""
        return self._simulation.contacts(self.fqn)

    def keys(self) -> list[str]:
        """The names of the components."""
        return list(self.parts)

    def __iter__(self) -> Iterator[str]:
        return iter(self.parts)

    def __len__(self) -> int:
        return len(self.parts)


def _copy(data: Fields) -> Fields:
    return {key: value if type(value) in _PLAIN else copied(value) for key, value in data.items()}
