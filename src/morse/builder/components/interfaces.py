"""Interfaces of a component: streams, services, overlays, modifiers, levels."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.builder.errors import checks
from morse.builder.errors.declared import modifier_options, stream_options, with_file_options
from morse.builder.names import frames
from morse.builder.names.catalog import find_modifier
from morse.core import declarations
from morse.core.exceptions import MorseBuilderError, MorseBuilderUnexportableError
from morse.middleware import registry
from morse.scene import ModifierDeclaration, OverlayDeclaration, StreamDeclaration

if TYPE_CHECKING:
    from morse.core.values import Options


logger = logging.getLogger(__name__)

_DIRECTIONS = ("IN", "OUT")


class Interfaces:
    """The part of `AbstractComponent` for streams, services, overlays, modifiers and levels."""

    _kind: str
    _exportable: bool
    name: str

    def _init_interfaces(self) -> None:
        self._level: str | None = None
        #: options of streams that the file of the robot sets
        self._file_options: dict[str, str | bool] = {}
        self._streams: list[StreamDeclaration] = []
        self._managers: list[str] = []
        self._modifiers: list[ModifierDeclaration] = []
        self._overlays: list[OverlayDeclaration] = []

    def component_class(self) -> type | None:
        """Class path of the component class."""
        raise NotImplementedError

    # --- data -------------------------------------------------------------------------------

    def add_stream(
        self,
        datastream: str,
        method: str | None = None,
        path: str | None = None,
        classpath: str | None = None,
        direction: str | None = None,
        **kwargs: object,
    ) -> None:
        """Stream the data of this component.

        Args:
            datastream: name of a middleware, or class path of a stream manager.
            method: class that publishes or reads, if it is not the default class of the middleware.
            path: module of that class, if ``method`` contains only its name.
            classpath: class path of that class, instead of ``method`` and ``path``.
            direction: ``OUT`` (default for sensors) or ``IN`` (default for actuators).
            **kwargs: options of the stream: ``topic``, ``port``, ``frame_id``, ...

        Raises:
            MorseMiddlewareError: the middleware is unknown.
            MorseBuilderUnexportableError: the component has no data, or the middleware cannot
                carry it.
            OptionError: the middleware has no such option, or the value is not valid.
        """
        manager = registry.stream_manager(checks.text(datastream, "add_stream(datastream)"))
        if not self._exportable:
            raise MorseBuilderUnexportableError(
                f"{type(self).__name__} has no data to stream; add_service('{datastream}') offers its services"
            )
        way = self._direction(direction)
        # scripts of 1.4 give the module of a method as a file: "morse/middleware/ros/imu"
        stream_class = classpath or (f"{path.replace('/', '.')}.{method}" if path and method else method)
        options = dict(kwargs)
        middleware = registry.middleware_of_stream_manager(manager) if stream_class is not None else None
        # a class of the user has a module
        if (
            stream_class is None
            or "." not in stream_class
            or (middleware is not None and not middleware.has_stream(stream_class))
        ):
            usual = self._default_stream(manager, datastream, way)
            if stream_class is not None:
                logger.warning(
                    "there is no class %s: %s uses the usual stream of '%s'",
                    stream_class, self.name, datastream,
                )  # fmt: skip
            stream_class = usual
        if stream_class.startswith("morse."):
            # a class of the user may have options of its own
            options = stream_options(manager, with_file_options(manager, kwargs, self._file_options))
        stream = StreamDeclaration(manager, stream_class, way, options, frames.source_line())
        self._streams.append(stream)

    def _direction(self, direction: str | None) -> str:
        if direction is not None:
            return checks.choice(direction, _DIRECTIONS, "add_stream(direction)")
        if self._kind in ("sensor", "actuator"):
            return "OUT" if self._kind == "sensor" else "IN"
        if type(self).__name__ == "Camera":
            raise MorseBuilderUnexportableError(
                "Camera() is a viewpoint in the scene and not a sensor: use VideoCamera() for images"
            )
        raise MorseBuilderUnexportableError(
            f"{type(self).__name__} is neither a sensor nor an actuator, and has no data to stream; to stream the "
            "data of all components of a robot, use robot.add_default_interface('socket')"
        )

    def _default_stream(self, manager: str, datastream: str, direction: str) -> str:
        middleware = registry.middleware_of_stream_manager(manager)
        if middleware is None:
            raise MorseBuilderError(
                f"add_stream('{datastream}') needs the class that publishes or reads: add_stream('{datastream}', "
                "classpath='my_sim.streams.MyPublisher')"
            )
        cls = self.component_class() or object
        stream = middleware.stream_of(cls, direction)
        if stream is None:
            what, own = ("take commands for", "MyReader") if direction == "IN" else ("carry the data of", "MyPublisher")
            raise MorseBuilderUnexportableError(
                f"the middleware '{middleware.name}' cannot {what} {type(self).__name__}; give a class "
                f"that can: classpath='my_sim.streams.{own}'"
            )
        return stream

    # --- services ---------------------------------------------------------------------------

    def add_service(self, interface: str, component: Interfaces | None = None, config: Options | None = None) -> None:
        """Offer the services of this component.

        Args:
            interface: name of a middleware, or class path of a request manager.
            component: the component whose services are offered instead.
            config: accepted for old scripts; no request manager has options.

        Raises:
            MorseMiddlewareError: unknown middleware.
        """
        target = self if component is None else component
        if not isinstance(target, Interfaces):
            raise TypeError(f"add_service(component) takes a component, got {checks.shown(component)}")
        if config:
            logger.warning("request managers have no options: %s is ignored", config)
        manager = registry.request_manager(checks.text(interface, "add_service(interface)"))
        if manager not in target._managers:
            target._managers.append(manager)

    def add_interface(self, interface: str, **kwargs: Any) -> None:
        """Offer the services and stream the data of this component.

        Args:
            interface: name of a middleware.
            **kwargs: options of the stream.

        Raises:
            MorseMiddlewareError: unknown middleware.
        """
        middleware = registry.middleware(checks.text(interface, "add_interface(interface)"))
        if middleware.request_manager is not None:
            self.add_service(interface)
        if self._can_stream(middleware):
            self.add_stream(interface, **kwargs)

    def _can_stream(self, middleware: registry.Middleware) -> bool:
        if middleware.stream_manager is None or not self._exportable or self._kind not in ("sensor", "actuator"):
            return False
        cls = self.component_class() or object
        return middleware.stream_of(cls, self._direction(None)) is not None

    def _add_missing_interface(self, interface: str) -> None:
        """Offer the services on a middleware; stream the data as well, unless the script has added a stream."""
        middleware = registry.middleware(interface)
        if any(stream.manager == middleware.stream_manager for stream in self._streams):
            if middleware.request_manager is not None:
                self.add_service(interface)
        else:
            self.add_interface(interface)

    def add_overlay(self, datastream: str, overlay: str, config: Options | None = None, **kwargs: object) -> None:
        """Offer the services of an overlay instead of those of the component.

        Args:
            datastream: name of a middleware, or class path of a request manager.
            overlay: class path of the overlay.
            config: options of the overlay.
            **kwargs: more options of the overlay.

        Raises:
            MorseMiddlewareError: unknown middleware.
        """
        manager = registry.request_manager(checks.text(datastream, "add_overlay(datastream)"))
        classpath = checks.text(overlay, "add_overlay(overlay)")
        options = {**(config or {}), **kwargs}
        self._overlays.append(OverlayDeclaration(manager, classpath, options, frames.source_line()))

    # --- data -----------------------------------------------------------------------------

    def alter(
        self,
        modifier_name: str | None = None,
        classpath: str | None = None,
        direction: str | None = None,
        **kwargs: object,
    ) -> None:
        """Add a modifier, which changes the data after a measurement or before an actuator acts.

        Args:
            modifier_name: e.g. ``NED`` or ``Noise``.
            classpath: class of a modifier, instead of a name.
            direction: ``IN`` or ``OUT`` for components that both read and publish (`ExternalObject`); the others have
                only one direction.
            **kwargs: options of the modifier.

        Raises:
            MorseBuilderError: there is no such modifier for this component.
            OptionError: the modifier has no such option, or the value is not valid.
        """
        if direction is not None:
            checks.choice(direction, _DIRECTIONS, "alter(direction)")
        if classpath is None:
            if modifier_name is None:
                raise TypeError("alter takes the name of a modifier such as 'NED', or the classpath of one")
            classpath = find_modifier(checks.text(modifier_name, "alter(modifier_name)"), self.component_class())
        else:
            checks.text(classpath, "alter(classpath)")
        options = modifier_options(classpath, kwargs)
        self._modifiers.append(ModifierDeclaration(classpath, options, frames.source_line(), direction))

    def level(self, level: str) -> None:
        """Set the abstraction level.

        Args:
            level: one of the declared abstraction levels, or ``default``.

        Raises:
            MorseBuilderError: the component does not declare the level.
        """
        level_name = checks.text(level, "level(name)")
        cls = self.component_class()
        levels = declarations.levels(cls) if cls is not None else {}
        if level_name == "default" and levels:
            level_name = next((name for name, entry in levels.items() if entry.default), next(iter(levels)))
        if level_name not in levels:
            choices = f"has {', '.join(levels)}" if levels else "has no abstraction levels"
            near = checks.closest(level_name, levels)
            hint = f"; did you mean '{near}'?" if near else ""
            raise MorseBuilderError(f"no level '{level_name}': {type(self).__name__} {choices}{hint}")
        self._level = level_name
