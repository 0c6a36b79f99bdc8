"""Declares which actions need not be called in each tick, and finds the classes for which this holds."""

from __future__ import annotations

from functools import lru_cache
from types import FunctionType
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Self

    from morse.core.interfaces import Component
    from morse.core.values import Fields, Value

_F = TypeVar("_F", bound="Callable[..., object]")

#: the methods that may be marked
_ACTIONS = ("default_action", "measure")
#: methods of a subclass that leave the action of the class as it is
_HARMLESS = frozenset(("__init__", "__init_subclass__", "get_state", "set_state", "finalize"))


def on_read(action: _F) -> _F:
    """Mark ``measure`` or ``default_action`` of a sensor whose data are computed when they are read.

    The action reads ``position_3d``, which is then the pose at the time of the measurement,
    ``local_data["timestamp"]``, the result of `Sensor.observation`, properties, and what does not change. It is not
    called for data that nobody reads. A class that needs the pose of the previous measurement defines ``remember()``,
    which takes what is needed from ``position_3d`` if the previous measurement was not read.
    """
    action.on_read = True  # type: ignore[attr-defined]
    return action


def while_same(*fields: str) -> Callable[[_F], _F]:
    """Mark ``default_action`` of an actuator that drives its robot at a speed that lasts, by ``apply_speed``.

    If the action sets the speeds of the wheels instead, the class has ``turns_wheels = True``.

    Args:
        fields: the fields of ``local_data`` on which the speed depends, and nothing else but properties. While they
            have the same values, and `Object.may_wait`, the robot is driven at the same speed without a call.
    """

    def mark(action: _F) -> _F:
        action.while_same = fields  # type: ignore[attr-defined]
        return action

    return mark


def is_on_read(cls: type) -> bool:
    """Whether the sensors of a class measure when they are read."""
    return mark_of(cls, "on_read") is True


def lasting_fields(cls: type) -> tuple[str, ...]:
    """Return the fields whose values determine the action of an actuator; () if it has to act in each tick."""
    fields: tuple[str, ...] = mark_of(cls, "while_same") or ()
    return fields


def is_overridden(component: Component) -> bool:
    """Whether an attribute of a component hides a method of its class."""
    return not _methods_of(type(component)).isdisjoint(vars(component))


@lru_cache(4096)
def _methods_of(cls: type) -> frozenset[str]:
    names = {name for base in cls.__mro__ for name in vars(base)}
    return frozenset(name for name in names if isinstance(getattr(cls, name, None), FunctionType))


def mark_of(cls: type, mark: str) -> Value:
    """Return the mark of the first action in the order of inheritance, unless a subclass changes how it acts."""
    names: set[str] = set()
    for base in cls.__mro__:
        for name in _ACTIONS:
            if name in vars(base):
                value = getattr(vars(base)[name], mark, None)
                return value if value is not None and not any(hasattr(base, other) for other in names) else None
        names |= {name for name, value in vars(base).items() if name not in _HARMLESS and _is_behaviour(value)}
    return None


def _is_behaviour(value: object) -> bool:
    return isinstance(value, (FunctionType, property, classmethod, staticmethod))


class LazyData:
    """``local_data`` of a sensor that measures on read: like a cached property, the first access makes an attribute.

    Who has accessed the dictionary may keep it. From then on the sensor measures in each tick, as other sensors do.
    Parts of MORSE that keep no reference use `present_data` instead.
    """

    def __get__(self, component: Any, owner: type) -> Any:
        if component is None:
            return self
        if component._in_rows is None:
            raise AttributeError(f"{owner.__name__} has no local_data yet: call super().__init__ first")
        data = vars(component)["local_data"] = component._in_rows.data_of(component)
        component._is_read = True
        return data


class Unclaimed:
    """Holds the data of sensors while parts of users are created, which may keep references to them.

    Attributes:
        is_changed: see `Entry`; not used.
    """

    is_changed = False

    def __init__(self, components: Iterable[Component] = ()) -> None:
        self._data: dict[int, tuple[Component, Fields]] = {}
        for component in components:
            self.add(component)

    def add(self, component: Component) -> None:
        """Hold the data of a component, if it is a sensor that measures on read and acts in each tick at present."""
        own, cls = vars(component), type(component)
        waits = cls.acts_in_rows or getattr(component, "on_demand", False)
        if component._in_rows is None and waits and isinstance(getattr(cls, "local_data", None), LazyData):
            self._data[id(component)] = component, own.pop("local_data")
            component._in_rows = self

    def data_of(self, member: Component) -> Fields:
        """See `Entry`."""
        return self._data[id(member)][1]

    kept_of = data_of

    def release(self) -> None:
        """Give all components their data, and take note of those whose data somebody has read or replaced."""
        for component, data in self._data.values():
            component._in_rows = None
            if vars(component).setdefault("local_data", data) is not data:
                component._is_read = True
        self._data.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


def present_data(component: Component) -> Fields:
    """Return ``local_data`` of a component for readers that do not keep it: it is valid until the next action."""
    rows = getattr(component, "_in_rows", None)  # streams also carry objects that are not components
    data: Fields = component.local_data if rows is None else rows.data_of(component)
    return data


def known_data(component: Component) -> Fields:
    """Return `present_data` for readers of names and sizes, for whom nothing is cast or rendered."""
    rows = getattr(component, "_in_rows", None)
    data: Fields = component.local_data if rows is None else rows.kept_of(component)
    return data
