"""An entry of the schedule: the components of one class that act in the same ticks.

Most components have nothing to do in most ticks: nobody reads the data of a sensor, and no command has arrived for an
actuator. They are *rows*: nothing is called for them. `SensorRows` and `ActuatorRows` know when a row has to act; then
its ``default_action`` is called, which is the only definition of what the component does. All others act in each tick.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar, cast

from morse.core.realism import phase_of
from morse.core.rows.marks import is_overridden, waiting
from morse.helpers.transformation import FollowingPose

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.interfaces import Component
    from morse.core.values import Fields
    from morse.core.world.body import Mounting

_M = TypeVar("_M", bound="Component")

#: number of ticks after which components that act in each tick may become rows
_LOOK = 64


class Rows(Generic[_M]):
    """Components of one class with the same rate, phase and level.

    Args:
        members: the components.
        act: calls the action of components.

    Attributes:
        members: the components, in the order of the scene.
        frequency: Hz.
        stamp: number of actions.
        functions: name of the attribute of a member with the functions of its streams.
        modifiers: name of its attribute with the modifiers of its data.
        is_changed: whether a member has changed, so that it may have to act in each tick, or no longer has to.
    """

    functions: ClassVar[str]
    modifiers: ClassVar[str]

    def __init__(self, members: Sequence[_M], act: Callable[[Sequence[_M | Rows[_M]]], None]) -> None:
        self.members = tuple(members)
        self.frequency = members[0].frequency
        self.stamp = 0
        self.is_changed = True
        self._is_off = False
        self._act = act
        self._context = members[0].context
        self._guard = self._context.guard
        self._rows: list[_M] = []
        self._each: Sequence[_M] = ()
        self.form()

    @property
    def phase(self) -> float:
        """Time of the first action after the start, s."""
        return phase_of(self.members[0])

    def name(self) -> str:
        """Name in profiles."""
        return f"{len(self.members)} x {type(self.members[0]).__name__}" if self.members[1:] else self.members[0].name()

    # -- who is a row ------------------------------------------------------------------------

    def is_row(self, member: _M) -> bool:
        """Whether nothing has to be called for a member in most ticks."""
        return (
            member.active
            and not self._is_off
            and not is_overridden(member)
            and isinstance(member.position_3d, FollowingPose)
            and isinstance(vars(member)["local_data"], dict)
            and member.may_wait()
        )

    def form(self) -> None:
        """Determine which members are rows."""
        self.release()
        guard = self._guard
        rows = self._rows = guard.those(self.members, self.is_row, guard.deactivate)
        ids = set(map(id, rows))
        self._each = [member for member in self.members if id(member) not in ids]
        self._row_of = {id(member): row for row, member in enumerate(rows)}
        self._attributes = [vars(member) for member in rows]
        #: functions and modifiers of the rows, which may change, and as they were
        self._hooks = [
            hooks for member in rows for hooks in (getattr(member, self.functions), getattr(member, self.modifiers))
        ]
        self._known_hooks = [list(hooks) for hooks in self._hooks]
        #: members, and what their streams wait for
        self._waiting = [
            (member, sign)
            for member in rows
            for function in getattr(member, self.functions)
            if (sign := waiting(function)) is not None
        ]
        self._signs = [sign for _, sign in self._waiting]
        self._objects = [member.bge_object for member in rows]
        self._snapshots = self._context.world.snapshots(self._objects)
        self._poses = self._snapshots.now()
        for row, member in enumerate(rows):
            member._in_rows = self
            cast("FollowingPose", member.position_3d).follow(self, row)
        self._take()
        self._size = sum(map(len, self._attributes))
        self.is_changed = False

    def _take(self) -> None:
        """Prepare the rows that were just chosen."""

    def release(self) -> None:
        """Let all members be components like others, with the data and the poses of their last actions."""
        rows, self._rows = self._rows, []
        self._guard.each(rows, self._release, self._guard.deactivate)
        self.is_changed = True

    def switch_off(self) -> None:
        """Called after an error that no member has raised: all of them act in each tick from now on."""
        self._is_off = self.is_changed = True

    def _release(self, member: _M) -> None:
        cast("FollowingPose", member.position_3d).stay()
        member._in_rows = None

    def _look(self) -> None:
        """Form the rows again if something has changed."""
        if (
            self.is_changed
            or sum(map(len, self._attributes)) != self._size
            or self._hooks != self._known_hooks
            or (self._each and self.stamp % _LOOK == 0 and self._guard.those(self._each, self.is_row, _nothing))
        ):
            self.form()

    # -- for the members ---------------------------------------------------------------------

    def pose_of(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the pose of a row at its last action: the arguments of `Transformation3d.set_pose`."""
        return self._poses.pose(row)

    def place_of(self, member: _M) -> tuple[int, Mounting]:
        """Return the rigid group of a row, and its pose in the group, at its last action."""
        return self._snapshots.place(self._row_of[id(member)])

    def data_of(self, member: Component) -> Fields:
        """Return the data of a row."""
        data: Fields = vars(member)["local_data"]
        return data

    def kept_of(self, member: Component) -> Fields:
        """Return the data of a row."""
        return self.data_of(member)


def _nothing(_member: object, _error: BaseException) -> None:
    """A member that cannot tell stays as it is; its own action shows the error."""
