"""Groups of components that act together."""

from __future__ import annotations

import sys
from array import array
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from morse.core.groups.group_poses import GroupPoses

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from numpy.typing import NDArray


#: largest speed that the engine accepts, m/s and rad/s
_FASTEST = 1e5
#: reference count of a dictionary that only one list refers to
_UNHELD = max(map(sys.getrefcount, [{}, {}])) if hasattr(sys, "getrefcount") else -1


class Member(Protocol):
    """A component that acts together with others; see `morse.core.object.Object`."""

    bge_object: Any
    robot_parent: Any
    frequency: float
    context: Any
    group: Group | None
    local_data: dict[str, Any]
    position_3d: Any

    def settle(self) -> None:
        """Update the attributes that ``act_together`` does not update."""


class Kept(NamedTuple):
    """The data that a group has measured in one tick; other threads may read them at any time later.

    Attributes:
        stamp: simulated time of the measurement, whole ns.
        parts: names of data fields, and a function that returns their values for a row.
    """

    stamp: int
    parts: Sequence[tuple[tuple[str, ...], Callable[[int], Any]]]

    def data(self, row: int) -> dict[str, Any]:
        """The measured fields of a member."""
        data: dict[str, Any] = {}
        for fields, values in self.parts:
            data.update(zip(fields, values(row), strict=True))
        return data


class Group:
    """Components of one class that act in the same ticks: the argument of ``act_together`` of the class.

    ``act_together(cls, group)`` of a class does for all members what ``default_action`` does for one component. Row i
    of each array belongs to ``members[i]``.

    Attributes:
        members: the components.
        context: the simulation.
        memory: dictionary in which the class may keep values between ticks. It is empty at first, and after members
            have acted alone.
        stamp: a value that changes whenever the group acts.
        poses: poses of the members in this tick: ``pose(i)``, ``numbers(i)``, ``transformation(i)``, or arrays of all:
            ``positions()``, ``rotations()``. They are computed on demand.
        is_changed: whether attributes were added to members since the group was formed.
    """

    def __init__(self, members: Sequence[Member]) -> None:
        self.members = tuple(members)
        self.context = members[0].context
        self.memory: dict[str, Any] = {}
        self.stamp = 0
        self.is_changed = False
        self._plain: dict[str, bool] = {}
        self._driven: tuple[Any, ...] = ()
        self._rows = {id(member): row for row, member in enumerate(members)}
        self._attributes = [vars(member) for member in members]
        self._robots = [vars(member.robot_parent) for member in members]
        self._datas: list[dict[str, Any]] = [member.local_data for member in members]
        self._fleet: Any = None
        self._snapshots = self.context.world.snapshots([member.bge_object for member in members])
        self._velocities: Any = None
        self._written: list[tuple[tuple[str, ...], Callable[[int], Any]]] | None = None
        self._immediate: list[int] = []
        self._time = 0.0
        self.poses = GroupPoses(self._snapshots.now())
        self._size = 0
        self._before: tuple[Any, float, Any, int] = (self._written, self._time, self.poses, self.stamp)

    def __len__(self) -> int:
        return len(self.members)

    # -- for act_together: reading ---------------------------------------------------------

    @property
    def fields(self) -> Collection[str]:
        """The names of the data fields of each member."""
        return self._datas[0].keys()

    def read(self, field: str) -> list[float]:
        """Return a field of the data of all members: N finite numbers.

        Raises:
            ValueError, TypeError: a value is not a finite number. All members then act alone in this tick, and the
            member with the wrong value is logged.
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
            raise ValueError(f"the field '{field}' contains a value that is not a finite number")
        return values

    def attributes(self, name: str) -> list[Any]:
        """Return an attribute of all members."""
        if name not in self._plain:
            # attributes that the class computes have precedence over attributes of the instances
            self._plain[name] = not hasattr(getattr(type(self.members[0]), name, None), "__set__")
        if self._plain[name]:
            try:
                return [attributes[name] for attributes in self._attributes]
            except KeyError:
                pass
        return list(map(attrgetter(name), self.members))

    def velocities(self) -> Any:
        """Return the present velocities of the robots: ``velocity(row)``, linear and angular, and ``origin(row)``."""
        if self._velocities is None:
            self._velocities = self.context.world.velocity_snapshots([m.robot_parent.bge_object for m in self.members])
        return self._velocities.now()

    # -- for act_together: writing ---------------------------------------------------------

    def write(self, fields: Sequence[str], values: Callable[[int], Any] | NDArray[Any], *, later: bool = False) -> None:
        """Set fields of the data of all members.

        Args:
            fields: F names.
            values: (N, F) an array, which must not be modified later; or a function that returns F values for a row.
                The function is called when the data of that member are read, at the latest before the group acts again;
                if they are not read, it is not called.
            later: whether the values of the function depend only on the row and on objects that do not change, such as
                ``poses``. Other threads may then call the function, also after the group has acted again.

        Raises:
            ValueError: an array of another shape.
        """
        assert self._written is not None
        names = tuple(fields)
        if callable(values):
            if not later:
                self._immediate.append(len(self._written))
            self._written.append((names, values))
            return
        array = np.asarray(values)
        if array.shape != (len(self), len(names)):
            raise ValueError(f"{len(self)} members, {len(names)} fields: the array has the shape {array.shape}")
        self._written.append((names, lambda row: array[row].tolist()))

    def drive(
        self, kinds: Sequence[str], forward: Sequence[float], aside: Sequence[float] | None, rate: Sequence[float]
    ) -> None:
        """Drive the robots of all members during this tick, as `Robot.apply_speed` does for one robot.

        Args:
            kinds: (N,) ``Position`` or ``Velocity``.
            forward, aside: (N,) m/s along the X and Y axes of the robots; None for 0.
            rate: (N,) rad/s about their Z axes.

        Raises:
            ValueError: a speed is too large.
        """
        command = (tuple(kinds), _bytes(forward), _bytes(aside), _bytes(rate))
        if self._fleet is None:
            self._fleet = self.context.world.fleet([member.robot_parent.bge_object for member in self.members])
        self._fleet.renew()
        # most commands stay the same for many ticks
        if command != self._driven:
            for speeds in (forward, aside, rate):
                # comparisons with NaN are false
                if speeds is not None and not (min(speeds) >= -_FASTEST and max(speeds) <= _FASTEST):
                    raise ValueError(f"a speed is a number from {-_FASTEST:g} to {_FASTEST:g}")
            self._fleet.command(
                forward,
                0.0 if aside is None else aside,
                rate,
                [kind == "Position" for kind in kinds] if "Position" in kinds else False,
                self._grounds,
            )
            self._driven = command
        self.context.world.drive_fleet(self._fleet)

    def _grounds(self) -> list[bool]:
        try:
            return [attributes["_is_ground_robot"] for attributes in self._robots]
        except KeyError:
            return [bool(member.robot_parent._is_ground_robot) for member in self.members]

    # -- a tick ----------------------------------------------------------------------------

    def take_stock(self) -> None:
        """Record which attributes the members have now; later ones set `is_changed`."""
        self._size = sum(map(len, self._attributes))

    def begin_command(self) -> None:
        """Begin a tick of a group of actuators."""
        self.is_changed |= sum(map(len, self._attributes)) != self._size
        self.poses = GroupPoses(self._snapshots.now())
        self.stamp += 1

    def begin_measurement(self) -> list[int]:
        """Begin a tick of a group of sensors.

        ``local_data`` of the members is removed, so that reading it calls `fill`.

        Returns:
            The rows whose ``local_data`` is still referenced elsewhere: they have to be filled at the end of the
            measurement.
        """
        attributes, datas = self._attributes, self._datas
        size, taken = sum(map(len, attributes)), 0
        columns_held: list[int] = []
        counts = list(map(sys.getrefcount, datas)) if _UNHELD >= 0 else []
        if not counts or max(counts) > _UNHELD:
            for row, count in enumerate(counts or [1 + _UNHELD] * len(datas)):
                if count > _UNHELD:
                    columns_held.append(row)
                    if attributes[row].get("local_data") is datas[row]:
                        del attributes[row]["local_data"]
                        taken += 1
            if counts:
                counts = list(map(sys.getrefcount, datas))
                columns_held = [row for row in columns_held if counts[row] > _UNHELD]
        # compares the numbers of attributes of the members, without their data
        self.is_changed |= size - taken != self._size - len(datas)
        self._before = (self._written, self._time, self.poses, self.stamp)
        self._written, self._time, self.poses = [], self.context.clock.time, GroupPoses(self._snapshots.now())
        self._immediate = []
        self.stamp += 1
        return columns_held

    def undo(self) -> None:
        """Cancel a measurement: all members keep the data of the previous measurement."""
        self._written, self._time, self.poses, self.stamp = self._before
        self.release()

    def release(self) -> None:
        """Update all members, because they are about to act alone or to be saved."""
        for row, attributes in enumerate(self._attributes):
            if "local_data" not in attributes:
                self.fill(row)
        guard = self.context.guard
        guard.each(self.members, _settle, guard.deactivate)
        self.memory.clear()

    def written(self) -> frozenset[str]:
        """The names of the data fields that the present measurement contains."""
        return frozenset(name for fields, _ in self._written or () for name in fields)

    def keep(self, rows: Sequence[int]) -> Kept:
        """Keep the present measurement of some members for another thread."""
        parts = list(self._written or ())
        for index in self._immediate:
            names, values = parts[index]
            parts[index] = names, _found({row: tuple(values(row)) for row in rows})
        return Kept(self.context.clock.stamp(self._time), parts)

    # -- for the members -------------------------------------------------------------------

    def pose_of(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the pose of a member at its last action."""
        return self.poses.pose(row)

    def fill(self, row: int) -> dict[str, Any]:
        """Fill in the data of a member and make them its ``local_data`` again."""
        try:
            data = self.peek(row)
        except BaseException as error:
            self.context.guard.deactivate(self.members[row], error)
            data = self._datas[row]
        self._attributes[row]["local_data"] = data
        return data

    def peek(self, row: int) -> dict[str, Any]:
        """The data of a member, which stay valid until the group acts again; `fill` makes them its ``local_data``."""
        data = self._datas[row]
        if self._written is not None:
            data["timestamp"] = self._time
            for fields, values in self._written:
                data.update(zip(fields, values(row), strict=True))
        return data

    def row_of(self, member: Member) -> int:
        """Return the row of a member."""
        return self._rows[id(member)]

    def data_of(self, member: Member) -> dict[str, Any]:
        """Return the data of a member, filled in on demand."""
        return self.fill(self._rows[id(member)])


def _settle(member: Member) -> None:
    member.settle()


def _found(values: Mapping[int, Any]) -> Callable[[int], Any]:
    return values.__getitem__


def _bytes(speeds: Sequence[float] | NDArray[Any] | None) -> bytes:
    """Numbers that can be compared bit for bit."""
    if speeds is None:
        return b""
    return (array("d", speeds) if isinstance(speeds, list) else np.asarray(speeds, dtype=np.float64)).tobytes()


class OnDemand:
    """``local_data`` of components whose group has removed it; the first access fills it in.

    An instance attribute of the same name, which all other components have, takes precedence.
    """

    def __get__(self, component: Member | None, owner: type) -> Any:
        if component is None:
            return self
        if component.group is None:
            raise AttributeError(f"{owner.__name__} has no local_data yet: call super().__init__ first")
        return component.group.data_of(component)
