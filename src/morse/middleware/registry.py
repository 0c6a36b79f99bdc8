"""The installed middlewares, and the classes that connect components to them.

Each middleware describes itself by a `Middleware`: those of the core in their packages below ``morse.middleware`` as
``MIDDLEWARE``, those of plug-ins and of other packages by an entry point::

    [project.entry-points."morse.middlewares"]
    zenoh = "my_lab.zenoh:MIDDLEWARE"

Descriptions do not import the middleware itself, so that a scene only loads what it uses.
"""

from __future__ import annotations

import logging
import pkgutil
import re
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

import morse.middleware
from morse.core.classes.plugins import PluginError, attempt, entry_points, load
from morse.core.declarations import kinds as kinds_of
from morse.core.declarations import says_nothing
from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import closest
from morse.system import OF_MACHINE, extras

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from importlib.metadata import EntryPoint

    from morse.core.declarations import Option

logger = logging.getLogger(__name__)

#: middlewares that scripts may name although this installation does not have them, and their alternatives
_OTHER_NAMES = {
    "pocolibs": "ros2",
    "hla": "socket",
}
#: class paths of the managers of MORSE 1.4 and earlier, such as ``morse.middleware.moos_datastream.MOOS``
_OLD_MANAGER = re.compile(r"morse\.middleware\.(\w+?)_(?:datastream|request_manager|mw)\.\w+")
_GROUP = "morse.middlewares"
_PACKAGE = "morse.middleware."
_KIND_STREAM = "morse.core.streams.kind_stream.KindStream"


@dataclass(frozen=True, slots=True)
class Middleware:
    """The description of a middleware; classes are given by class path.

    Attributes:
        name: its name in scene scripts.
        stream_manager: manages data streams (`morse.core.datastream.DatastreamManager`), or None.
        request_manager: offers services, or None.
        manager_options: options of ``env.configure_stream_manager``, whose defaults the manager gets; None if it
            declares or validates them itself.
        stream_options: options of ``add_stream``; None if the streams validate them themselves.
        default_publisher: the class of the streams of sensors. The usual class sends message kinds by the methods
            that the stream manager marks with `morse.core.mapping.maps`.
        default_reader: the same for actuators; None if actuators cannot be commanded.
        needs_network: whether it opens connections; if not, it is used in every simulation.
        not_carried: names of component classes without streams.
        kinds: the message kinds without which a component has no streams; empty if all components have.
        modules: Python modules of others without which it cannot connect.
        mend: how to install them, and what can be used without them; a sentence without a full stop.
        imports: Python modules that scripts import together with them.
        extra: the extra of MORSE that installs these modules.
        install: the command that installs them, for middlewares of other packages.
        purpose: what it gives, in a few words, for lists of what is installed.
        in_place_of: names of middlewares that scripts may name although they are gone, and for which this one can be
            used.
        names_topics_as_ros: whether its topics and frames have names of ROS, so that a stream takes those that the file
            of a robot sets.
        node_protocols: values of ``protocol`` of ``env.configure_multinode`` for which it exchanges the poses of robots
            with other simulations; its options are then ``server_address`` and ``server_port``.
        takes_old_names: whether its streams can be given by class paths of MORSE 1.4 that are not classes any more.
    """

    name: str
    stream_manager: str | None = None
    request_manager: str | None = None
    manager_options: Mapping[str, Option] | None = field(default_factory=dict)
    stream_options: Mapping[str, Option] | None = field(default_factory=dict)
    default_publisher: str | None = _KIND_STREAM
    default_reader: str | None = _KIND_STREAM
    needs_network: bool = True
    not_carried: tuple[str, ...] = ()
    kinds: tuple[str, ...] = ()
    modules: tuple[str, ...] = ()
    mend: str = ""
    imports: tuple[str, ...] = ()
    extra: str = ""
    install: str = ""
    purpose: str = ""
    in_place_of: tuple[str, ...] = ()
    names_topics_as_ros: bool = False
    node_protocols: tuple[str, ...] = ()
    takes_old_names: bool = False

    def lacks(self) -> list[str]:
        """Those of its modules that are not installed; nothing is imported."""
        return [module for module in self.modules if not _is_installed(module)]

    def how_to_install(self) -> str:
        """The command that installs what it needs; empty if it needs nothing."""
        return self.install or (extras.install(self.extra) if self.extra else "")

    @property
    def missing(self) -> str:
        """A message if it cannot connect because modules are not installed; else empty. Nothing is imported."""
        names = [f"'{module}'" for module in self.lacks()]
        several = len(names) > 1
        what = f"{self.name}: the Python module{'s' if several else ''} {' and '.join(names)}"
        mend = self.mend or (f"To install it: {self.how_to_install()}" if self.how_to_install() else "")
        mend = f". {mend}" if mend else ""
        return f"{what} {'are' if several else 'is'} not installed{mend}" if names else ""

    def has_stream(self, classpath: str) -> bool:
        """Whether there is a stream class with that path; those outside MORSE are not looked up."""
        if self.takes_old_names or not classpath.startswith(_PACKAGE):
            return True
        module, _, name = classpath.rpartition(".")
        try:
            return hasattr(import_module(module), name)
        except ImportError:
            return False

    def leaves_out(self, component: type) -> bool:
        """Whether the middleware has no streams for a class of components, because of its name or its message kinds."""
        if any(base.__name__ in self.not_carried for base in component.__mro__):
            return True
        return bool(self.kinds) and not any(use.kind in self.kinds for use in kinds_of(component))

    def stream_of(self, component: type, direction: str) -> str | None:
        """The default stream class of a component; None if the middleware does not support the component.

        Args:
            component: its class.
            direction: ``IN`` or ``OUT``.
        """
        if self.stream_manager is None or says_nothing(component) or self.leaves_out(component):
            return None
        return self.default_reader if direction == "IN" else self.default_publisher


@cache
def _ours(package: str) -> Middleware | None:
    entry = getattr(import_module(package), "MIDDLEWARE", None)
    return entry if isinstance(entry, Middleware) else None


def _is_installed(module: str) -> bool:
    try:
        return attempt(lambda: find_spec(module)) is not None
    except PluginError:  # a package above it is not installed, or fails
        return False


def _brought(point: EntryPoint) -> Middleware:
    try:
        return load(point, as_middleware)
    except PluginError as error:
        raise MorseMiddlewareError(
            f"the middleware '{point.name}' of an installed package ({point.value}) cannot be loaded: {error}"
        ) from None


def as_middleware(entry: object) -> Middleware:
    """What an entry point names.

    Raises:
        TypeError: it is not a description of a middleware.
    """
    if not isinstance(entry, Middleware):
        raise TypeError(f"it is {entry!r:.80}, expected a morse.middleware.registry.Middleware")
    return entry


def installed() -> dict[str, Middleware]:
    """The middlewares of this installation by name; the log names those that cannot be loaded."""
    middlewares = {}
    for info in pkgutil.iter_modules(morse.middleware.__path__, "morse.middleware."):
        if info.ispkg and (entry := _ours(info.name)) is not None:
            middlewares[entry.name] = entry
    for point in entry_points(_GROUP):
        try:
            middlewares.setdefault(point.name, _brought(point))
        except MorseMiddlewareError as error:
            logger.warning("%s", error, extra=OF_MACHINE)
    return middlewares


def middleware_of_module(name: str) -> Middleware | None:
    """The middleware that needs a Python module of others, or whose scripts import it."""
    entries = installed().values()
    return next((entry for entry in entries if name.partition(".")[0] in (*entry.modules, *entry.imports)), None)


def missing_modules(managers: Iterable[str]) -> dict[str, str]:
    """The stream and request managers that cannot connect because a module is not installed; nothing is imported.

    Args:
        managers: class paths of stream and request managers.

    Returns:
        The class path of each of them, and a message.
    """
    messages = {
        manager: entry.missing
        for entry in installed().values()
        for manager in (entry.stream_manager, entry.request_manager)
        if manager is not None and entry.modules
    }
    return {manager: messages[manager] for manager in managers if messages.get(manager)}


def middleware(name: str) -> Middleware:
    """The middleware of that name.

    Raises:
        MorseMiddlewareError: it is unknown, not installed or broken.
    """
    package = f"morse.middleware.{name}"
    if (
        name.isidentifier()
        and find_spec(package) is not None
        and (entry := _ours(package)) is not None
        and entry.name == name
    ):
        return entry
    for point in entry_points(_GROUP):
        if point.name == name:
            return _brought(point)
    middlewares = installed()
    if name in middlewares:
        return middlewares[name]
    names = ", ".join(sorted(middlewares)) or "none"
    others = _other_names()
    if name in others:
        raise MorseMiddlewareError(
            f"the middleware '{name}' is not part of this installation; {others[name]} can be used instead "
            f"(installed: {names})"
        )
    near = closest(name, [*middlewares, *others])
    hint = f"; did you mean '{near}'?" if near else ""
    own = "" if near else "; one of your own needs an entry point 'morse.middlewares' in pyproject.toml"
    raise MorseMiddlewareError(f"there is no middleware '{name}'{hint}{own} (installed: {names})")


def _other_names() -> dict[str, str]:
    """Names of middlewares that are not there, and what can be used for each."""
    return _OTHER_NAMES | {other: entry.name for entry in installed().values() for other in entry.in_place_of}


def middleware_of_nodes(protocol: str) -> Middleware | None:
    """The middleware that exchanges the poses of robots with other simulations by a protocol, or None."""
    return next((entry for entry in installed().values() if protocol in entry.node_protocols), None)


def stream_manager(name: str) -> str:
    """The class path of a stream manager, from the name of its middleware or from a class path.

    Raises:
        MorseMiddlewareError: it is unknown, or has no data streams.
    """
    if "." in name:
        return _of_1_4(name, "stream_manager")
    path = middleware(name).stream_manager
    if path is None:
        raise MorseMiddlewareError(f"the middleware '{name}' has no data streams")
    return path


def request_manager(name: str) -> str:
    """The class path of a request manager, from the name of its middleware or from a class path.

    Raises:
        MorseMiddlewareError: it is unknown, or has no services.
    """
    if "." in name:
        return _of_1_4(name, "request_manager")
    path = middleware(name).request_manager
    if path is None:
        raise MorseMiddlewareError(f"the middleware '{name}' offers no services")
    return path


def _of_1_4(classpath: str, kind: str) -> str:
    """The class path of a manager; for a class of MORSE 1.4 that is not there, that of its middleware.

    Raises:
        MorseMiddlewareError: it is a class of a middleware that is not part of this installation.
    """
    old = _OLD_MANAGER.fullmatch(classpath)
    if old is None or old[1] not in [*installed(), *_other_names()]:
        return classpath
    today: str | None = getattr(middleware(old[1]), kind)
    return today or classpath


def middleware_of_stream_manager(classpath: str) -> Middleware | None:
    """The middleware with that stream manager, or None."""
    return next((m for m in installed().values() if m.stream_manager == classpath), None)


@cache
def needs_network(classpath: str) -> bool:
    """Whether a stream manager opens connections, as far as is known."""
    entry = middleware_of_stream_manager(classpath)
    return entry is None or entry.needs_network
