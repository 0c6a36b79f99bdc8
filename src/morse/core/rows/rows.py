"""An entry of the schedule: the components of one class that act in the same ticks.

Most components have nothing to do in most ticks: nobody reads the data of a sensor, and no command has arrived for an
actuator. They are *rows*: nothing is called for them. `SensorRows` and `ActuatorRows` know when a row has to act; then
its ``default_action`` is called, which is the only definition of what the component does. All others act in each tick.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar, cast

from morse.core.realism import phase_of
from morse.core.rows.marks import is_overridden, lasting_fields
from morse.core.sensor import Sensor
from morse.core.streams.functions import publish, waiting
from morse.helpers.transformation import FollowingPose

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.actuator import Actuator
    from morse.core.interfaces import Acting, Component
    from morse.core.values import Fields, Value
    from morse.core.world import Snapshot
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

    def __init__(self, members: Sequence[_M], act: Callable[[Sequence[Acting]], None]) -> None:
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

    def action(self) -> None:
        """Let the members act."""
        raise NotImplementedError

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


class ActuatorRows(Rows["Actuator"]):
    """Actuators of one class whose action is marked by `morse.core.rows.marks.while_same`.

    The action of a row is called when its fields have changed. The speed at which it drives the robot lasts, and all of
    these robots are driven by one call.
    """

    functions, modifiers = "input_functions", "input_modifiers"

    def __init__(self, members: Sequence[Actuator], act: Callable[[Sequence[Acting]], None]) -> None:
        self._fields = lasting_fields(type(members[0]))
        #: members whose actions do not drive their robots at speeds that last
        self._others: set[int] = set()
        super().__init__(members, act)

    def is_row(self, member: Actuator) -> bool:
        """Whether the speed lasts."""
        return super().is_row(member) and id(member) not in self._others and not member.input_modifiers

    def _take(self) -> None:
        self._values: list[list[object]] = []
        robots = [member.robot_parent.bge_object for member in self._rows]
        world = self._context.world
        self._fleet = world.wheel_fleet(robots) if type(self.members[0]).turns_wheels else world.fleet(robots)
        # commands that end, and functions that do not tell whether they have something to do
        self._always = [
            member
            for member in self._rows
            if member.limits_commands or member.command_end is not None or None in map(waiting, member.input_functions)
        ]

    # -- a tick ------------------------------------------------------------------------------

    def action(self) -> None:
        """Read the commands that have arrived, and drive the robots."""
        self._look()
        self.stamp += 1
        self._poses = self._snapshots.now()
        if self._always or any(self._signs):
            self._take_input()
        while self._rows and not self._drive():
            self.form()
        if self._each:
            self._act(self._each)

    def prepare(self) -> None:
        """Do what `action` does, for ticks of which `went_on` tells later."""
        rows, stamp, poses = self._rows, self.stamp, self._poses
        self._act((self,))
        if self._rows is rows:
            self.stamp, self._poses = stamp, poses

    @property
    def lasts(self) -> bool:
        """Whether the robots go on at the same speeds while no command arrives."""
        return bool(self._rows) and not (self.is_changed or self._each or self._always or any(self._signs))

    def go_on(self) -> None:
        """Do what `action` does if nothing has arrived or changed."""
        self.stamp += 1
        self._poses = self._snapshots.now()
        self._fleet.drive()

    def went_on(self, ticks: int) -> None:
        """Take note of ticks in which the robots went on, of `World.advance`."""
        self.stamp += ticks
        self._poses = self._snapshots.before()

    def _take_input(self) -> None:
        busy = {id(member): member for member in self._always}
        busy.update((id(member), member) for member, sign in self._waiting if sign)
        for member in busy.values():
            self._guard.run(member.take_input, partial(self._guard.deactivate, member))

    def _drive(self) -> bool:
        """Drive all robots; return False if the rows have to be formed again."""
        if self.is_changed:
            return False
        try:
            values = [[own["local_data"][field] for own in self._attributes] for field in self._fields]
            is_same = values == self._values
        except Exception:  # a field is missing, or holds an array: the actions tell
            values, is_same = [], False
        if not is_same:
            self._renew(values)
        if self.is_changed:
            return False
        self._fleet.drive()
        return True

    def _renew(self, values: list[list[object]]) -> None:
        """Call the actions of the rows whose fields have changed."""
        rows: Sequence[int] = range(len(self._rows))
        if values and self._values:
            now, before = zip(*values, strict=True), zip(*self._values, strict=True)
            rows = [row for row, (new, old) in enumerate(zip(now, before, strict=True)) if new != old]
        self._values = values
        for row in rows:
            member = self._rows[row]
            self._guard.run(member.default_action, partial(self._guard.deactivate, member))
            if member._active and not self._fleet.adopt(row):
                self._others.add(id(member))
                self.is_changed = True


class SensorRows(Rows[Sensor]):
    """Sensors of one class whose action is marked by `morse.core.rows.marks.on_read`.

    An action of the rows stores the time and the poses of all rigid bodies, once for all of them. The measurement of a
    row is computed from these when its data are read.
    """

    _datas: Sequence[Fields] = ()

    functions, modifiers = "output_functions", "output_modifiers"

    def is_row(self, member: Sensor) -> bool:
        """Whether the sensor may measure later, because nobody can have a reference to its data."""
        return (
            super().is_row(member)
            and not member._is_read
            and member.realism is None
            and not member.output_modifiers
            and all(waiting(function) is not None for function in member.output_functions)
        )

    @property
    def sensors(self) -> Sequence[Sensor]:
        """The sensors that measure later; another list whenever they change."""
        return self._rows

    @property
    def poses(self) -> Snapshot:
        """The poses of these sensors at their last action; see `morse.core.world.Snapshot`."""
        return self._poses

    @property
    def time(self) -> float:
        """Simulated time of the last action, s."""
        return float(self._time)

    @property
    def remembers(self) -> bool:
        """Whether the sensors need the poses of the previous measurement."""
        return type(self.members[0]).remember is not Sensor.remember

    def may_skip(self) -> bool:
        """Whether a measurement may be left out, if the sensors measure again before anybody reads their data."""
        self._look()
        return not (self.is_changed or self._each or self._taps or any(self._signs))

    def skip(self, count: int) -> None:
        """Leave measurements out, of which the last one is followed by one that is not; see `remembers`."""
        self.stamp += count

    def _take(self) -> None:
        self._datas = [own.pop("local_data") for own in self._attributes]
        # the stamp of the last action whose results the attributes of each row contain
        self._measured = [self.stamp] * len(self._rows)
        self._before = self._poses
        self._time = self._time_before = self._context.clock.time
        self._taps = self._context.row_taps
        self._remembers = self.remembers
        cls = type(self.members[0])
        #: whether there is one observation for all rows; and that one, and the one before
        self._together = cls.observe is Sensor.observe and _is_shared(cls)
        self._seen: Value = None
        self._seen_before: Value = None
        self._observes = self._together or cls.observe is not Sensor.observe
        if self._observes:
            for member in self._rows:
                member.observed = member.observed_before = None

    def _release(self, member: Sensor) -> None:
        own = vars(member)
        if "local_data" in own:
            member._is_read = True  # somebody has assigned another dictionary, and may keep it
        else:
            own["local_data"] = self.data_of(member)
        if self._observes:
            member.observed = member.observed_before = None
        super()._release(member)

    # -- a tick ------------------------------------------------------------------------------

    def action(self) -> None:
        """Take note of the time and of the poses, and publish the data that somebody waits for."""
        self._look()
        self.stamp += 1
        self._before, self._time_before = self._poses, self._time
        self._poses, self._time = self._snapshots.now(), self._context.clock.time
        if self._together and self._rows:
            self._guard.run(self._observe_all, self._observe_each)
        elif self._observes:
            self._observe_each()
        if any(self._signs):
            self._publish()
        if self._taps:
            self._guard.call(self._taps, self)
        if self._each:
            self._act(self._each)

    def _observe_all(self) -> None:
        self._seen_before, self._seen = self._seen, type(self._rows[0]).observe_all(self._rows)

    def _observe_each(self, _error: object = None) -> None:
        self._seen_before = self._seen = None
        self._guard.each(self._rows, _observe, self._guard.deactivate)

    def _publish(self) -> None:
        for member in {id(member): member for member, sign in self._waiting if sign}.values():
            own = vars(member)
            data = own["local_data"] = self.data_of(member)
            if member.active:
                publish(member, member.output_functions)
            if own.get("local_data") is data:
                del own["local_data"]

    # -- reading -----------------------------------------------------------------------------

    def data_of(self, member: Component) -> Fields:
        """Return the data of a row, which are valid until its next action."""
        row = self._row_of[id(member)]
        data = self._datas[row]
        if self._measured[row] != self.stamp:
            last, self._measured[row] = self._measured[row], self.stamp
            own = vars(member)
            own["local_data"] = data
            try:
                # the rows are empty while they are released
                self._measure(row, cast("Sensor", member), data, last)
            except BaseException as error:
                self._guard.deactivate(member, error)
            own.pop("local_data", None)
        return data

    def _measure(self, row: int, member: Sensor, data: Fields, last: int) -> None:
        if self._seen is not None:
            member.observed_before, member.observed = self._seen_before, self._seen
        if self._remembers and last < self.stamp - 1:
            data["timestamp"] = self._time_before
            member.position_3d.set_pose(*self._before.pose(row))
            observed, member.observed = member.observed, member.observed_before
            member.remember()
            member.observed = observed
            member.position_3d.set_pose(*self._poses.pose(row))
        data["timestamp"] = self._time
        member.default_action()
        if member._reports:
            member.report()


def _is_shared(cls: type[Sensor]) -> bool:
    """Whether a class has one observation for all of its sensors."""
    return next(base for base in cls.__mro__ if "observe_all" in vars(base)) is not Sensor


def _observe(member: Sensor) -> None:
    member.observed_before, member.observed = member.observed, member.observe()
