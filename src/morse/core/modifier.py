"""The base class of modifiers."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

from morse.core.state.attributes import replace, state_of
from morse.core.validation.fields import checked_options

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.declarations import Option
    from morse.core.object import Object
    from morse.core.values import Fields, Options, StateData, Value

logger = logging.getLogger(__name__)


class AbstractModifier(ABC):
    """Changes the data of a component: after a measurement, or when a command arrives.

    Attributes:
        component_instance: the component.
        kwargs: the options that the scene script gave to ``alter``.
        options: the declared options by name; None if the class declares none, so that all options are accepted.
        changes: changes of the declarations of fields, e.g. ``{"x": {"unit": "ft"}}``: ``unit``, ``frame``, ``low``,
            ``high``, and the noise that the modifier adds: ``stddev``, the standard deviation of white noise, and
            ``walk``, that of a random walk after one second. Both are numbers, or have one number for each axis.
        commanded: with ``each_tick``, the fields of an actuator that it changes, as the last command has set them:
            `modify` finds these values, not its own results of the last tick.
        covariances: for noise that depends on the measurements: functions by covariance slot that return the present
            covariance, an array of the shape of the slot, or None.

    Raises:
        OptionError: an option is not declared, or its value is not valid.
    """

    options: ClassVar[Mapping[str, Option] | None] = None
    #: whether `modify` is also called in ticks in which no command arrives, because the result depends on time
    each_tick: ClassVar[bool] = False
    changes: Mapping[str, Mapping[str, object]] = MappingProxyType({})
    commanded: Mapping[str, Value] = MappingProxyType({})
    covariances: Mapping[str, Callable[[], NDArray[np.float64] | None]] = MappingProxyType({})
    #: attributes that are not part of the state: they are created from the scene
    not_state: ClassVar[tuple[str, ...]] = ("component_instance", "kwargs", "_complaints", "covariances")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        self.component_instance = component_instance
        self.kwargs = kwargs if self.options is None else checked_options(type(self).__name__, self.options, kwargs)
        self._complaints: set[str] = set()

    def get_state(self) -> StateData:
        """Return the state of the modifier: its attributes, except those in `not_state`."""
        return state_of(self)

    def set_state(self, state: StateData) -> None:
        """Restore a state that `get_state` returned."""
        replace(self, self.get_state(), state)

    @property
    def data(self) -> Fields:
        """The data of the component."""
        return self.component_instance.local_data

    def parameter(self, arg: str, prop: str | None = None, default: object = None) -> Value:
        """Return an option of the script, else a property of the environment, else the default."""
        if arg in self.kwargs:
            return self.kwargs[arg]
        environment = self.component_instance.context.scene.properties
        if prop is not None and prop in environment:
            return environment[prop]
        return default

    def key_error(self, detail: object) -> None:
        """Log, once, that the component does not have a field that this modifier changes."""
        complaint = str(detail)
        if complaint not in self._complaints:
            self._complaints.add(complaint)
            fields = ", ".join(self.data)
            logger.warning(
                "%s has no field %s for %s to change; it has %s",
                self.component_instance.name(),
                complaint,
                type(self).__name__,
                fields,
            )

    def origin(self) -> tuple[float, float, float] | None:
        """Origin of the frame in `changes`, in the world, m; None for a frame with other axes than the world."""
        return None

    def initialize(self) -> None:
        """Called once before the first tick."""

    def finalize(self) -> None:
        """Called once after the last tick."""

    @abstractmethod
    def modify(self) -> None:
        """Change ``self.data`` in place."""
