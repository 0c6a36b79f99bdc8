"""Data streams carry ``local_data`` between components and clients."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, cast

from morse.core.classes.classpath import load_class
from morse.core.declarations import Option
from morse.core.exceptions import MorseMiddlewareError
from morse.core.kinds.table import GENERAL
from morse.core.mapping import mapped_kinds
from morse.core.observer import Observer
from morse.core.reports.quoting import shown
from morse.core.streams.functions import Endpoint
from morse.core.validation.fields import checked_options, with_defaults
from morse.scene import StreamDeclaration

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.actuator import Actuator
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import Fields, Options, Value


_SECOND = 10**9
#: options of the streams of all middlewares
COMMON_OPTIONS: Mapping[str, Option] = {
    "timeout": Option(float, None, "for actuators: simulated seconds after which a command ends", low=1e-3, unit="s"),
    "period": Option(float, None, "for sensors: shortest simulated time between messages", low=1e-6, unit="s"),
}


class AbstractDatastream(Endpoint, ABC):
    """One stream of one component.

    Attributes:
        component_instance: the component.
        component_name: its name.
        kwargs: the options of the stream from the scene script.
        manager: the middleware that carries the stream; set before `initialize`.
        direction: ``OUT`` or ``IN``; set before `initialize`.
    """

    #: options that scripts may give; None: any option, because the stream checks them itself
    options: ClassVar[Mapping[str, Option] | None] = None
    manager: DatastreamManager
    direction: str = ""

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        self.component_instance = component_instance
        self.component_name = component_instance.name()
        self.kwargs = kwargs

    @property
    def data(self) -> Fields:
        """``local_data`` of the component."""
        return self.component_instance.local_data

    def initialize(self) -> None:
        """Called once before the first tick."""

    def finalize(self) -> None:
        """Called once after the last tick, and when the component is recreated or deleted."""

    @abstractmethod
    def default(self, ci: Object | None = None) -> object:
        """Publish the data (``OUT``); or read and return True if data arrived (``IN``)."""


class DatastreamManager(Observer):
    """The data streams of one middleware.

    A middleware defines the form of messages, by methods that are marked with `morse.core.mapping.maps`, and how they
    are sent, by `send`; it passes what arrives to `morse.core.streams.kind_stream.KindStream.receive`.

    This class does the rest. It keeps the streams: `connect` adds a stream, `disconnect` removes the streams of a
    component that is deleted, and `finalize` removes all streams. The streams of a component that is recreated replace
    the former ones. Subclasses are notified by `opened`, `closed` and `left`. A stream sends at most one message in
    each ``period`` of its options, and ends commands after its ``timeout``. A stream that raises an error is closed and
    named in the log; its component and all other streams continue.

    The simulation calls `action` at the beginning of a tick, the streams when their components act, and `flush` at the
    end of the tick.

    Attributes:
        classpath: the name under which summaries and clients know it.
        options: options from ``env.configure_stream_manager``, and defaults for the others.
        streams: the open streams, a list for each name of a component, in the order of the script.
    """

    classpath: str = ""
    #: options of ``env.configure_stream_manager``; None: those of the description of the middleware
    manager_options: ClassVar[Mapping[str, Option] | None] = None
    #: whether a component has one message with all of its fields, instead of one for each of its kinds
    by_component: ClassVar[bool] = False
    _mapped: ClassVar[dict[tuple[str, str], str]] = {}

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        cls._mapped = mapped_kinds(cls)

    def __init__(self, options: Options, context: Context) -> None:
        if isinstance(context, dict):
            # a subclass of MORSE 1.4 passes on (args, kwargs), of which the second are the options
            options, context = context, cast("Context", options)
        self.context = context
        self.streams: dict[str, list[Any]] = {}
        if not self.classpath:
            self.classpath = f"{type(self).__module__}.{type(self).__name__}"
        self.options = options
        if self.manager_options is not None:
            owner = self.classpath.rpartition(".")[2]
            values = checked_options(owner, self.manager_options, options)
            self.options = with_defaults(self.manager_options, values)

    # -- saved states ------------------------------------------------------------------------

    def get_state(self) -> object:
        """What the middleware itself does in the next ticks depends on, as plain data; None if on nothing."""
        return None

    def set_state(self, state: object) -> None:
        """Restore what `get_state` has returned, possibly from a file.

        Raises:
            StateError: it is damaged; nothing has changed.
        """

    # -- streams -----------------------------------------------------------------------------

    def connect(self, component: Object, declaration: StreamDeclaration) -> None:
        """Open a stream for a component; the streams of a former component of the same name are closed first.

        Raises:
            MorseMiddlewareError: the middleware cannot carry the stream.
            OptionError: the stream has no such option.
        """
        name = component.name()
        before = self.streams.get(name)
        if before and before[0].component_instance is not component:
            self._close_streams(name)
        if type(self).register_component is DatastreamManager.register_component:
            self._attach(component, declaration)
        else:
            data = [declaration.manager, declaration.stream, declaration.direction, dict(declaration.options)]
            self.register_component(name, component, data)

    def register_component(self, component_name: str, component_instance: Object, mw_data: list[Any]) -> None:
        """Create a stream and attach it to a component; managers written for MORSE 1.4 override it.

        Args:
            component_name: name of the component.
            component_instance: the component.
            mw_data: name of the manager, class path of the stream, direction, options.
        """
        self._attach(component_instance, StreamDeclaration(*mw_data[:4]))

    def _attach(self, component: Object, declaration: StreamDeclaration) -> None:
        stream = self.make_stream(component, declaration)
        stream.manager, stream.direction = self, declaration.direction
        self.streams.setdefault(component.name(), []).append(stream)
        self.opened(stream)
        try:
            stream.initialize()
        except BaseException:
            # what has not begun is not ended
            self.streams[component.name()].remove(stream)
            raise
        functions = component.input_functions if declaration.direction == "IN" else component.output_functions
        functions.append(self._called(stream, declaration))

    def _called(self, stream: AbstractDatastream, declaration: StreamDeclaration) -> Callable[..., object]:
        """The function of a stream that its component calls."""
        from morse.core.actuator import Actuator

        common = self._common_options(type(stream))
        # a class without declared options may have others of these names
        options: Options = {
            name: value for name, value in declaration.options.items() if name in common and _is_number(value)
        }
        timeout, period = options.get("timeout"), options.get("period")
        is_of_actuator = declaration.direction == "IN" and isinstance(stream.component_instance, Actuator)
        if timeout is not None and not is_of_actuator:
            raise MorseMiddlewareError(
                f"{stream.component_name}: timeout={timeout} is for actuators, whose commands it ends"
            )
        if period is not None and declaration.direction == "IN":
            raise MorseMiddlewareError(
                f"{stream.component_name}: period={period} is for sensors, of whose messages it omits some"
            )
        if timeout is not None:
            return CommandTimeout(stream, float(timeout)).default
        return stream.default if period is None else Paced(stream, float(period)).default

    @staticmethod
    def _common_options(cls: type) -> Mapping[str, Option]:
        """The options that a stream of a class has in addition to its own."""
        own_options = getattr(cls, "options", None) or {}
        return {name: option for name, option in COMMON_OPTIONS.items() if name not in own_options}

    def make_stream(self, component: Object, declaration: StreamDeclaration) -> Any:
        """Create the stream for a declaration.

        Raises:
            MorseMiddlewareError: the declared class is not a stream.
        """
        cls = load_class(declaration.stream)
        if not callable(getattr(cls, "default", None)):
            raise MorseMiddlewareError(f"{declaration.stream} is not a stream: it has no method 'default'")
        own_options = getattr(cls, "options", None)
        options = dict(declaration.options)
        if own_options is not None:
            declarations = {**self._common_options(cls), **own_options}
            values = checked_options(f"the stream of {component.name()}", declarations, options)
            options = with_defaults(own_options, {name: value for name, value in values.items() if name in own_options})
        return cls(component, options)

    def disconnect(self, component: Object) -> None:
        """Close the streams of a component that is deleted; those of another one of the same name remain."""
        name = component.name()
        streams = self.streams.get(name, ())
        if not any(stream.component_instance is not component for stream in streams):
            self._close_streams(name)
            self.left(name)

    def _close_streams(self, name: str) -> None:
        for stream in self.streams.pop(name, ()):
            self._close_stream(stream)

    def _close_stream(self, stream: AbstractDatastream) -> None:
        try:
            stream.finalize()
        finally:
            self.closed(stream)

    def drop(self, stream: AbstractDatastream) -> None:
        """Close a stream that has failed; the component and its other streams continue."""
        for name, streams in list(self.streams.items()):
            others = [one for one in streams if one is not stream]
            if len(others) < len(streams):
                self.streams[name] = others
                self._close_stream(stream)

    def opened(self, stream: Any) -> None:
        """Called when a stream opens, before its `AbstractDatastream.initialize`."""

    def closed(self, stream: Any) -> None:
        """Called when a stream was closed; a stream of a new component of the same name may follow."""

    def left(self, name: str) -> None:
        """Called when the component of that name no longer exists."""

    # -- kinds -------------------------------------------------------------------------------

    def mapping(self, kind: str, direction: str = "OUT") -> Callable[..., Value] | None:
        """Return the method that carries a kind, else the method for ``general``; None if there is neither."""
        name = self._mapped.get((kind, direction)) or self._mapped.get((GENERAL, direction))
        return None if name is None else getattr(self, name)

    @classmethod
    def has_form(cls, kind: str, direction: str = "OUT") -> bool:
        """Whether a kind has a form of its own, not that of ``general``."""
        return (kind, direction) in cls._mapped

    def wanted(self, stream: Any, topic: str) -> bool:
        """Whether the stream has a reader; without a reader no messages are created.

        Args:
            topic: sub-topic of the stream; empty for its main topic.
        """
        return True

    def send(self, stream: Any, payload: Any) -> None:
        """Send what a method marked with `maps` has returned; called in the tick.

        Raises:
            NotImplementedError: the middleware does not define how.
        """
        raise NotImplementedError(
            f"{type(self).__name__} has a method that returns a payload, {shown(payload)}, but no method "
            "send(self, stream, payload)"
        )

    # -- the tick ----------------------------------------------------------------------------

    def before_tick(self) -> None:
        """See `action`."""
        self.action()

    def after_tick(self) -> None:
        """See `flush`."""
        self.flush()

    def close(self) -> None:
        """See `finalize`."""
        self.finalize()

    def action(self) -> None:
        """Called at the beginning of a tick; it may wait for a client that paces the simulation."""

    def drain(self) -> None:
        """Read everything that has arrived, so that a tick that a client requests uses the commands sent before it."""

    def push(self) -> None:
        """Send what earlier ticks have published, before an answer to a service call is sent."""

    def sent(self) -> dict[str, int]:
        """Return the number of messages sent per connection; clients that step the simulation wait for all of them."""
        return {}

    def flush(self) -> None:
        """Called at the end of a tick: send what was published."""

    def finalize(self) -> None:
        """Called at the end of the simulation: send the remaining messages and close the connections."""
        for name in list(self.streams):
            self._close_streams(name)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


class Paced(AbstractDatastream):
    """Calls a stream in the first tick of each period.

    Args:
        stream: of a sensor.
        period: simulated time, s.
    """

    def __init__(self, stream: AbstractDatastream, period: float) -> None:
        super().__init__(stream.component_instance, stream.kwargs)
        self.stream, self._period = stream, round(period * _SECOND)
        self._last: int | None = None

    def default(self, ci: Object | None = None) -> object:
        """See `AbstractDatastream.default`."""
        number = self.component_instance.clock.stamp() // self._period
        if number == self._last:
            return False
        self._last = number
        return self.stream.default(ci)


class CommandTimeout(AbstractDatastream):
    """Reads the stream of an actuator; the actuator itself ends the command, so that the end is part of its state.

    Args:
        stream: of the actuator.
        seconds: of simulated time.
    """

    component_instance: Actuator

    def __init__(self, stream: AbstractDatastream, seconds: float) -> None:
        super().__init__(stream.component_instance, stream.kwargs)
        self.stream, self._seconds = stream, seconds

    def default(self, ci: Object | None = None) -> bool:
        """See `AbstractDatastream.default`."""
        if not self.stream.default(ci):
            return False
        self.component_instance.command_end = self.component_instance.clock.time + self._seconds
        return True
