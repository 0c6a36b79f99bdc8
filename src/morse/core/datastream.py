"""Data streams carry ``local_data`` between components and clients."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.scene import StreamDeclaration


class DatastreamManager(ABC):
    """Everything one middleware streams.

    The simulation calls `action` at the beginning of a tick, the streams while the components
    act, and `flush` at the end of the tick.

    Attributes:
        classpath: the name under which summaries and clients know it.
        options: what ``env.configure_stream_manager`` said.
    """

    classpath: str = ""

    def __init__(self, options: dict[str, Any], context: Context) -> None:
        self.options = options
        self.context = context
        if not self.classpath:
            self.classpath = f"{type(self).__module__}.{type(self).__name__}"

    @abstractmethod
    def register_component(self, component: Object, declaration: StreamDeclaration) -> None:
        """Connect a component: append to its ``output_functions`` or ``input_functions``."""

    def action(self) -> None:
        """A tick begins; this may wait for a client that paces the simulation."""

    def flush(self) -> None:
        """A tick ends: hand over what was published."""

    def finalize(self) -> None:
        """The simulation ends: send what is left, close."""


class AbstractDatastream(ABC):
    """One stream of one component.

    Attributes:
        component_instance: the component.
        component_name: its name.
        kwargs: the options of the stream from the scene script.
    """

    def __init__(self, component_instance: Object, kwargs: dict[str, Any]) -> None:
        self.component_instance = component_instance
        self.component_name = component_instance.name()
        self.kwargs = kwargs

    @property
    def data(self) -> dict[str, Any]:
        """The data of the component."""
        return self.component_instance.local_data

    def initialize(self) -> None:
        """Called once before the first tick."""

    def finalize(self) -> None:
        """Called once after the last tick."""

    @abstractmethod
    def default(self, ci: Object | None = None) -> Any:
        """Publish the data; or read and return True if something arrived."""
