"""Data that are measured when they are read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Self

    from morse.core.interfaces import Component
    from morse.core.values import Fields


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
    rows = getattr(component, "_in_rows", None)  # streams also carry objects that are no components
    data: Fields = component.local_data if rows is None else rows.data_of(component)
    return data


def known_data(component: Component) -> Fields:
    """Return `present_data` for readers of names and sizes, for whom nothing is cast or rendered."""
    rows = getattr(component, "_in_rows", None)
    data: Fields = component.local_data if rows is None else rows.kept_of(component)
    return data
