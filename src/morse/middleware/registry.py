"""Which middlewares are installed, and which classes carry which component over them.

Each middleware describes itself in ``morse/middleware/<name>/mapping.py``, by a module variable
``MIDDLEWARE``.
"""

from __future__ import annotations

import difflib
import pkgutil
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from importlib.util import find_spec

import morse.middleware
from morse.core.exceptions import MorseMiddlewareError

#: middlewares that scripts may name although this installation does not have them
_OTHER_NAMES = ("ros", "yarp", "yarp_json", "pocolibs", "moos", "hla", "mavlink", "text", "pprzlink")


@dataclass(frozen=True, slots=True)
class Middleware:
    """What a middleware can carry; classes are given by class path.

    Attributes:
        name: as scene scripts write it.
        stream_manager: carries data streams, or None.
        request_manager: offers services, or None.
        default_publisher: serializes the data of any sensor, or None if there is no generic form.
        default_reader: the same for actuators.
        streams: name of a component class to level (``"all"`` for every level) to the classes that
            carry its data, the default one first. None at all: the component cannot be streamed.
            Subclasses of a component inherit its entry; a component without one has the generic form.
    """

    name: str
    stream_manager: str | None = None
    request_manager: str | None = None
    default_publisher: str | None = None
    default_reader: str | None = None
    streams: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)

    def streams_of(self, component: type, level: str | None, direction: str) -> tuple[str, ...]:
        """The classes that can carry the data of a component, the default one first.

        Args:
            component: its class.
            level: its abstraction level, if it has levels.
            direction: ``IN`` or ``OUT``.
        """
        for base in component.__mro__:
            by_level = self.streams.get(base.__name__)
            if by_level is not None:
                return by_level.get(level or "all", by_level.get("all", ()))
        generic = self.default_reader if direction == "IN" else self.default_publisher
        return () if generic is None else (generic,)


@cache
def installed() -> dict[str, Middleware]:
    """The middlewares of this installation by name."""
    found = {}
    for info in pkgutil.iter_modules(morse.middleware.__path__, "morse.middleware."):
        mapping = f"{info.name}.mapping"
        if info.ispkg and find_spec(mapping) is not None:
            middleware: Middleware = import_module(mapping).MIDDLEWARE
            found[middleware.name] = middleware
    return found


def middleware(name: str) -> Middleware:
    """The middleware of that name.

    Raises:
        MorseMiddlewareError: it is unknown or not installed.
    """
    found = installed()
    if name in found:
        return found[name]
    names = ", ".join(sorted(found)) or "none"
    if name in _OTHER_NAMES:
        raise MorseMiddlewareError(f"the middleware '{name}' is not part of this installation (installed: {names})")
    near = difflib.get_close_matches(str(name), [*found, *_OTHER_NAMES], n=1)
    hint = f"; did you mean '{near[0]}'?" if near else ""
    raise MorseMiddlewareError(f"there is no middleware '{name}'{hint} (installed: {names})")


def stream_manager(name: str) -> str:
    """The class path of a stream manager, from the name of its middleware or from a class path.

    Raises:
        MorseMiddlewareError: unknown, or it has no data streams.
    """
    if "." in name:
        return name
    found = middleware(name).stream_manager
    if found is None:
        raise MorseMiddlewareError(f"the middleware '{name}' carries no data streams")
    return found


def request_manager(name: str) -> str:
    """The class path of a request manager, from the name of its middleware or from a class path.

    Raises:
        MorseMiddlewareError: unknown, or it has no services.
    """
    if "." in name:
        return name
    found = middleware(name).request_manager
    if found is None:
        raise MorseMiddlewareError(f"the middleware '{name}' offers no services")
    return found


def middleware_of_stream_manager(classpath: str) -> Middleware | None:
    """The middleware whose stream manager that is, or None."""
    return next((m for m in installed().values() if m.stream_manager == classpath), None)
