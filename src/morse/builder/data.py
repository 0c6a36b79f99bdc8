"""Tables of available names, for scripts that search for names."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from morse.assets.search import MORSE_COMPONENTS, resource_dirs
from morse.builder import workspace
from morse.builder.components.interfaces import Interfaces
from morse.builder.names.catalog import modifier_classes
from morse.core.reports.quoting import closest
from morse.middleware import registry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

__all__ = [
    "MORSE_COMPONENTS",
    "MORSE_DATASTREAM_DICT",
    "MORSE_DATASTREAM_MODULE",
    "MORSE_RESOURCE_PATH",
    "MORSE_SERVICE_DICT",
    "Configuration",
]

#: the directories searched for models besides `MORSE_COMPONENTS`
MORSE_RESOURCE_PATH = [str(directory) for directory in resource_dirs()]

if TYPE_CHECKING:
    #: name of a middleware to the class path of its stream manager
    MORSE_DATASTREAM_MODULE: Mapping[str, str]
    #: name of a middleware to the class path of its request manager
    MORSE_SERVICE_DICT: Mapping[str, str]
    #: name of a middleware to the classes that carry data, by direction
    MORSE_DATASTREAM_DICT: Mapping[str, dict[str, str | None]]


def __getattr__(name: str) -> object:
    """The tables of middlewares, and ``MORSE_MODIFIER_DICT``, modifiers by name and component.

    The files of all of them are read for this only.
    """
    if name == "MORSE_DATASTREAM_MODULE":
        return MappingProxyType({one.name: one.stream_manager for one in _middlewares() if one.stream_manager})
    if name == "MORSE_SERVICE_DICT":
        return MappingProxyType({one.name: one.request_manager for one in _middlewares() if one.request_manager})
    if name == "MORSE_DATASTREAM_DICT":
        ways = {one.name: {"OUT": one.default_publisher, "IN": one.default_reader} for one in _middlewares()}
        return MappingProxyType(ways)
    if name == "MORSE_MODIFIER_DICT":
        return MappingProxyType(modifier_classes())
    near = closest(name, __all__)
    hint = f"; did you mean '{near}'?" if near else ""
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'{hint}", name=name)


class Configuration:
    """The declarations of the script so far, by name of the component."""

    @staticmethod
    def datastreams() -> dict[str, list[tuple[str, str, str, dict[str, object]]]]:
        """Streams: stream manager, class, direction, options."""
        return {
            c.name: [(s.manager, s.stream, s.direction, s.options) for s in c._streams] for c in _all() if c._streams
        }

    @staticmethod
    def services() -> dict[str, list[str]]:
        """Class paths of the request managers."""
        return {c.name: list(c._managers) for c in _all() if c._managers}

    @staticmethod
    def modifiers() -> dict[str, list[tuple[str, dict[str, object]]]]:
        """Modifiers: class path, options."""
        return {c.name: [(m.classpath, m.options) for m in c._modifiers] for c in _all() if c._modifiers}

    @staticmethod
    def overlays() -> dict[str, list[tuple[str, str, dict[str, object]]]]:
        """Overlays: request manager, class path, options."""
        return {c.name: [(o.manager, o.classpath, o.options) for o in c._overlays] for c in _all() if c._overlays}


def _middlewares() -> Iterable[registry.Middleware]:
    return registry.installed().values()


def _all() -> Iterator[Interfaces]:
    return (part for part in workspace.current().components if isinstance(part, Interfaces))
