"""Components that act together."""

from __future__ import annotations

import sys
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from morse.core.group_poses import GroupPoses

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray


#: m/s and rad/s: as far as the engine takes them
_FASTEST = 1e5
#: references of a dictionary that nobody holds but a list
_UNHELD = max(map(sys.getrefcount, [{}, {}])) if hasattr(sys, "getrefcount") else -1


class Member(Protocol):
    """A component that acts together with others; see `morse.core.object.Object`."""

    bge_object: Any
    robot_parent: Any
    context: Any
    group: Group | None
    local_data: dict[str, Any]
    position_3d: Any

    def settle(self) -> None:
        """Bring those attributes up to date that ``act_together`` leaves as they were."""


class Group:
    """Components of one class that act in the same ticks: what ``act_together`` of the class gets.

    A class that defines ``act_together(cls, group)`` does in it for all members what ``default_action`` does for one.
    Row i of everything is ``members[i]``.

    Attributes:
        members: the components.
        context: the simulation.
        memory: for the class: what it wants to find again in the next tick. It is empty at first, and after members
            have acted alone.
        stamp: changes whenever the group acts.
        poses: where the members are in this tick: ``pose(i)``, ``numbers(i)``, ``transformation(i)``, or arrays of
            all: ``positions()``, ``rotations()``. Nothing is worked out before it is asked for.
        is_changed: whether members have got attributes since the group was formed.
    """

    def __init__(self, members: Sequence[Member]) -> None:
        self.members = tuple(members)
        self.context = members[0].context
        self.memory: dict[str, Any] = {}
        self.stamp = 0
        self.is_changed = False
        self._rows = {id(member): row for row, member in enumerate(members)}
        self._attributes = [vars(member) for member in members]
        self._datas: list[dict[str, Any]] = [member.local_data for member in members]
        self._fleet: Any = None
        self._snapshots = self.context.world.snapshots([member.bge_object for member in members])
        self._written: list[tuple[tuple[str, ...], Callable[[int], Any]]] | None = None
        self._time = 0.0
        self.poses = GroupPoses(self._snapshots.now())
        self._size = 0
        self._before: tuple[Any, float, Any, int] = (self._written, self._time, self.poses, self.stamp)

    def __len__(self) -> int:
        return len(self.members)

    # -- what act_together reads -----------------------------------------------------------

    def read(self, field: str) -> list[float]:
        """A field of the data of all members: N finite numbers.

        Raises:
            ValueError, TypeError: one of them is none. All members act alone then, in this tick, and the log says which
                one is wrong.
        """
        values = [data[field] for data in self._datas]
        try:
            total = sum(values)
        except TypeError:
            total = None
        if type(total) is not float and type(total) is not int:
            values = [float(value) for value in values]
            total = sum(values)
        if not -sys.float_info.max <= total <= sys.float_info.max:
            raise ValueError(f"the field '{field}' holds what is not a finite number")
        return values

    def attributes(self, name: str) -> list[Any]:
        """An attribute of all members."""
        return list(map(attrgetter(name), self.members))

    # -- what act_together does ------------------------------------------------------------

    def write(self, fields: Sequence[str], values: Callable[[int], Any] | NDArray[Any]) -> None:
        """Fill fields of the data of all members, for those who will read them.

        Args:
            fields: F names.
            values: (N, F) an array, which must not change any more; or a function that gives F values for a row. It is
                called when somebody reads the data of that member, at the latest before the group acts again; if
                nobody does, never.

        Raises:
            ValueError: an array of another shape.
        """
        assert self._written is not None
        names = tuple(fields)
        if callable(values):
            self._written.append((names, values))
            return
        array = np.asarray(values)
        if array.shape != (len(self), len(names)):
            raise ValueError(f"{len(self)} members, {len(names)} fields: the array has the shape {array.shape}")
        self._written.append((names, lambda row: array[row].tolist()))

    def drive(
        self, kinds: Sequence[str], forward: Sequence[float], aside: Sequence[float] | None, rate: Sequence[float]
    ) -> None:
        """Drive the robots of all members during this tick, as `Robot.apply_speed` does with one.

        Args:
            kinds: (N,) ``Position`` or ``Velocity``.
            forward, aside: (N,) m/s along the axes of the robots; None for no speed.
            rate: (N,) rad/s about their Z axes.

        Raises:
            ValueError: a speed is too large.
        """
        for speeds in (forward, aside, rate):
            # nothing compares with what is not a number
            if speeds is not None and not (min(speeds) >= -_FASTEST and max(speeds) <= _FASTEST):
                raise ValueError(f"a speed is a number from {-_FASTEST:g} to {_FASTEST:g}")
        if self._fleet is None:
            self._fleet = self.context.world.fleet([member.robot_parent.bge_object for member in self.members])
        self._fleet.command(
            forward,
            0.0 if aside is None else aside,
            rate,
            [kind == "Position" for kind in kinds] if "Position" in kinds else False,
            self._is_ground_robot,
        )
        self.context.world.drive_fleet(self._fleet)

    def _is_ground_robot(self, row: int) -> bool:
        return bool(self.members[row].robot_parent._is_ground_robot)

    # -- a tick ----------------------------------------------------------------------------

    def take_stock(self) -> None:
        """The members have the attributes now that they are to have."""
        self._size = sum(map(len, self._attributes))

    def begin_command(self) -> None:
        """The members, which are actuators, act now."""
        self.is_changed |= sum(map(len, self._attributes)) != self._size
        self.poses = GroupPoses(self._snapshots.now())
        self.stamp += 1

    def begin_measurement(self) -> list[int]:
        """The members, which are sensors, measure now.

        Their data are taken away from them, so that whoever wants to read them has to ask for them: see `fill`.

        Returns:
            The rows whose data somebody holds all the same: they are to be filled when the measurement is done.
        """
        attributes, datas = self._attributes, self._datas
        size, taken = sum(map(len, attributes)), 0
        held: list[int] = []
        counts = list(map(sys.getrefcount, datas)) if _UNHELD >= 0 else []
        if not counts or max(counts) > _UNHELD:
            for row, count in enumerate(counts or [1 + _UNHELD] * len(datas)):
                if count > _UNHELD:
                    held.append(row)
                    if attributes[row].get("local_data") is datas[row]:
                        del attributes[row]["local_data"]
                        taken += 1
            if counts:
                counts = list(map(sys.getrefcount, datas))
                held = [row for row in held if counts[row] > _UNHELD]
        # without the data of all of them
        self.is_changed |= size - taken != self._size - len(datas)
        self._before = (self._written, self._time, self.poses, self.stamp)
        self._written, self._time, self.poses = [], self.context.clock.time, GroupPoses(self._snapshots.now())
        self.stamp += 1
        return held

    def undo(self) -> None:
        """There was no measurement: all members have the data of the one before."""
        self._written, self._time, self.poses, self.stamp = self._before
        self.release()

    def release(self) -> None:
        """Give all members what is their own: they act alone now, or are saved."""
        for row, attributes in enumerate(self._attributes):
            if "local_data" not in attributes:
                self.fill(row)
            self.members[row].settle()
        self.memory.clear()

    # -- for the members -------------------------------------------------------------------

    def pose_of(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """The pose of a member when it acted last."""
        return self.poses.pose(row)

    def fill(self, row: int) -> dict[str, Any]:
        """Fill in the data of a member, and give them back to it."""
        data = self._datas[row]
        if self._written is not None:
            data["timestamp"] = self._time
            for fields, values in self._written:
                data.update(zip(fields, values(row), strict=True))
        self._attributes[row]["local_data"] = data
        return data

    def data_of(self, member: Member) -> dict[str, Any]:
        """The data of a member that somebody wants to read now."""
        return self.fill(self._rows[id(member)])


class OnDemand:
    """``local_data`` of components whose group has taken them away: they are filled in, and given back.

    An attribute of the same name, which all other components have, comes first.
    """

    def __get__(self, component: Member | None, owner: type) -> Any:
        if component is None:
            return self
        if component.group is None:
            raise AttributeError(f"{owner.__name__} has no local_data yet: call super().__init__ first")
        return component.group.data_of(component)
