"""Robots, sensors and actuators for clients."""

from __future__ import annotations

import contextlib
import logging
import threading
from typing import TYPE_CHECKING, Any

from pymorse.errors import NoSuchComponentError
from pymorse.names import normalize_name, suggestion

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pymorse.binary import BinaryStream
    from pymorse.future import MorseFuture
    from pymorse.pymorse import Morse
    from pymorse.stream import StreamJSON

logger = logging.getLogger("pymorse")

_READING = ("get", "last", "subscribe", "unsubscribe")
_WRITING = ("publish",)


class Component:
    """A sensor or an actuator.

    Its services are methods that return a `MorseFuture`; the components mounted on it are attributes. A sensor has
    ``get(timeout=None)``, ``last(n=1)``, ``subscribe(callback)`` and ``unsubscribe(callback)``, an actuator
    ``publish(data)``: see `pymorse.messages.Messages`.

    The connection is opened when the component is read as an attribute of its robot (``simu.robot.pose``), so that a
    sensor receives all messages from then on. As an item (``simu.robot["pose"]``), it is opened when one of these
    methods is used.

    Args:
        name: name of the attribute of the robot.
        fqn: its full name in the simulation.
        directions: ``OUT`` if it sends data, ``IN`` if it receives data.
        port: port of its stream.
        services: names of its services.
    """

    def __init__(
        self,
        morse: Morse,
        name: str,
        fqn: str,
        directions: Iterable[str] = (),
        port: int | None = None,
        services: Iterable[str] = (),
    ) -> None:
        self._morse = morse
        self.name = name
        self.fqn = fqn
        self._directions = frozenset(directions)
        self._port = port
        self._services = {normalize_name(service): service for service in services}
        self._parts: dict[str, Component] = {}
        self._stream: StreamJSON | BinaryStream | None = None
        self._opening = threading.Lock()

    @property
    def stream(self) -> StreamJSON | BinaryStream:
        """The stream of the component, connected.

        Raises:
            AttributeError: the component has no stream.
            ConnectionError: the simulation does not respond.
        """
        if self._port is None:
            raise self._missing("stream")
        with self._opening:
            if self._stream is None:
                self._stream = self._morse._open_stream(self.fqn, self._port, self._directions)
            return self._stream

    def _ready(self) -> Component:
        """Return the component with its stream open, if it has one; after the end of the simulation, without."""
        if self._port is not None and self._stream is None:
            with contextlib.suppress(OSError):
                _ = self.stream
        return self

    def _part(self, name: str) -> Component | None:
        """The part of that name, if there is one."""
        return self._parts.get(name)

    def _add_part(self, part: Component) -> Component:
        """Make a component an attribute, and return it."""
        name = normalize_name(part.name)
        if hasattr(type(self), name) or name in vars(self):
            logger.warning(
                "the attribute for %s already exists in pymorse: access it as %s['%s']", part.fqn, self.fqn, name
            )
        self._parts[name] = part
        return part

    def _tree(self) -> list[Component]:
        """Return the component, and all components below it."""
        return [self, *(below for part in self._parts.values() for below in part._tree())]

    def __getitem__(self, name: str) -> Component:
        """The part of that name."""
        return self._parts[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in self._parts:
            return self._parts[name]._ready()
        if name in self._services:
            return self._method(name)
        if name in _WRITING:
            self._morse._check_open()
        if (name in _READING and "OUT" in self._directions) or (name in _WRITING and "IN" in self._directions):
            return getattr(self.stream, name)
        raise self._missing(name)

    def _method(self, name: str) -> Callable[..., MorseFuture]:
        service = self._services[name]

        def call(*args: object) -> MorseFuture:
            return self._morse.call(self.fqn, service, *args)

        # arguments by keyword cannot be sent; the error of Python then names the service
        call.__name__, call.__qualname__ = name, f"{self.fqn}.{service}"
        call.__doc__ = f"Call the service {service} of {self.fqn}; returns a future."
        return call

    def _missing(self, name: str) -> Exception:
        if name in (*_READING, *_WRITING, "stream"):
            if not self._directions:
                hint = (
                    f"it has no stream on the socket; add one in the scene with {self.name}.add_stream('socket'), or "
                    "with add_default_interface('socket') of the robot"
                )
            elif name in _READING:
                hint = "it is an actuator and takes data: use publish()"
            else:
                hint = "it is a sensor and sends data: use get(), last() or subscribe()"
            return AttributeError(f"{self.fqn} has no {name}: {hint}", name=name)
        # with a name, but without an object, Python adds no suggestion of its own
        return AttributeError(f"{self.fqn} has no '{name}'{self._hint(name)}", name=name)

    def _hint(self, name: str) -> str:
        """What else there is, and how a component offers its services, if it offers none."""
        there = suggestion(name, self._names())
        is_complete = self._services or "did you mean" in there
        return (
            there if is_complete else f"{there}; for its services, add {self.name}.add_service('socket') to the scene"
        )

    def _names(self) -> list[str]:
        streaming = (_READING if "OUT" in self._directions else ()) + (_WRITING if "IN" in self._directions else ())
        return [*self._parts, *self._services, *streaming]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._names()]

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.fqn}: {', '.join(self._names()) or 'no interface'}>"

    def close(self) -> None:
        """Close the stream, if it is open; it is opened again at its next use."""
        with self._opening:
            stream, self._stream = self._stream, None
        if stream is not None:
            stream.close()


class Robot(Component, dict[str, Component]):
    """A robot; its components are available as items and as attributes."""

    def __init__(self, morse: Morse, name: str, fqn: str, services: Iterable[str] = ()) -> None:
        super().__init__(morse, name, fqn, services=services)

    def _add_part(self, part: Component) -> Component:
        """Make a component an attribute and an item, and return it."""
        dict.__setitem__(self, normalize_name(part.name), part)
        return super()._add_part(part)

    def __getitem__(self, name: str) -> Component:
        """The component of that name.

        Raises:
            KeyError: the robot has no such component.
        """
        if name not in self._parts:
            raise self._missing(name)
        return self._parts[name]

    def _missing(self, name: str) -> Exception:
        return NoSuchComponentError(f"the robot {self.fqn} has no '{name}'{suggestion(name, self._names())}")

    def __repr__(self) -> str:
        return Component.__repr__(self)

    def __hash__(self) -> int:  # type: ignore[override] # two robots are never the same
        return id(self)

    def __eq__(self, other: object) -> bool:
        return self is other
