"""A sensor that acts alone, with the interface of a group of one member."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.physics.poses.snapshot import Snapshot


class _Poses(NamedTuple):
    snapshot: Snapshot


class Lone:
    """A sensor that acts alone.

    Attributes:
        members: the sensor.
        is_changed: see `morse.core.groups.group.Group`.
        stamp: stamp of the world at its last measurement.
        is_of_data: whether its messages follow from its data, whatever its class is.

    Args:
        component: the sensor.
        is_of_data: see above.
    """

    def __init__(self, component: Any, *, is_of_data: bool = False) -> None:
        self.is_of_data = is_of_data
        self.members = (component,)
        self.is_changed = False
        self.stamp = -1
        self._attributes = vars(component)
        self._modifiers = component.output_modifiers
        self._size = len(self._attributes)

    def is_plain(self) -> bool:
        """Return whether its messages follow from its data or its class: without noise, delay, added attributes."""
        attributes = self._attributes
        return self.is_of_data or (
            not self._modifiers
            and len(attributes) == self._size
            and attributes["output_modifiers"] is self._modifiers
            and attributes.get("realism") is None
        )

    @property
    def fields(self) -> Collection[str]:
        """The names of its data fields."""
        return self.members[0].local_data.keys()  # type: ignore[no-any-return]

    @property
    def poses(self) -> _Poses:
        """Its present pose."""
        component = self.members[0]
        return _Poses(component.context.world.snapshots([component.bge_object]).now())

    def row_of(self, member: Any) -> int:
        """Return the row of the only member."""
        return 0
