"""The end of the parts of a simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.abstractobject import AbstractObject
from morse.core.guard import Failure
from morse.core.modifier import AbstractModifier
from morse.core.reports.faults import name_of
from morse.simulation.loader import Loaded

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.context import Context
    from morse.core.observer import Observer
    from morse.simulation.ending import Ending

#: methods that do nothing: most components have one of them
_NOTHING = (AbstractObject.finalize, AbstractModifier.finalize)


class Finalizing:
    """The part of `morse.simulation.simulation.Simulation` that ends components, services and observers."""

    context: Context
    loaded: Loaded
    ending: Ending

    @property
    def observers(self) -> list[Observer]:
        """The observers."""
        raise NotImplementedError

    def _overdue(self, who: str, line: str) -> None:
        """Keep that a part does not end as a failure."""
        time = self.context.clock.time
        self.context.guard.note(Failure("fault", who, "is left", time, "it does not end", line))

    def finalize_components(self) -> None:
        """Finalize the components and modifiers."""
        parts, self.loaded = self.loaded, Loaded()
        overlays = list(self.context.overlays.values())
        self.context.overlays.clear()
        for part in [*overlays, *parts.actuators, *parts.sensors, *parts.robots, *parts.modifier_objects]:
            self._finalize(part)
        self.ending.rest()

    def finalize_one(self, part: object) -> None:
        """Finalize a component, a modifier or an overlay."""
        self._finalize(part)
        self.ending.rest()

    def _finalize(self, part: Any) -> None:
        if getattr(type(part), "finalize", None) not in _NOTHING or "finalize" in _attributes(part):
            self._end_part(part, name_of(part), lambda: part.finalize())

    def _end_part(self, part: object, who: str, end: Callable[[], object]) -> None:
        guard = self.context.guard
        guard.run(lambda: self.ending.run(who, end), lambda error: guard.failed(part, who, "ended", error))

    def finalize_services(self) -> None:
        """Stop the request managers."""
        for manager in self.context.services.everybody():
            self._end_part(manager, type(manager).__name__, manager.finish)
        self.ending.rest()

    def finalize_observers(self) -> None:
        """Close the observers: streams are sent and closed, the view ends."""
        for observer in list(self.observers):
            self._end_part(observer, type(observer).__name__, observer.close)
        self.ending.rest()


def _attributes(part: object) -> Mapping[str, object]:
    """The attributes of a part, whatever its class does when an attribute is read."""
    try:
        attributes: Mapping[str, object] = object.__getattribute__(part, "__dict__")
    except AttributeError:
        return {}
    return attributes
