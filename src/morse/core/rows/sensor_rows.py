"""Sensors that measure when their data are read."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from morse.core.guard import publish
from morse.core.rows.marks import waiting
from morse.core.rows.rows import Rows
from morse.core.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.interfaces import Component
    from morse.core.values import Fields, Value
    from morse.core.world import Snapshot


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
