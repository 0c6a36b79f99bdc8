"""Actuators that drive their robots at speeds that last."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from morse.core.rows.marks import lasting_fields, waiting
from morse.core.rows.rows import Rows

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.actuator import Actuator


class ActuatorRows(Rows["Actuator"]):
    """Actuators of one class whose action is marked by `morse.core.rows.marks.while_same`.

    The action of a row is called when its fields have changed. The speed at which it drives the robot lasts, and all of
    these robots are driven by one call.
    """

    functions, modifiers = "input_functions", "input_modifiers"

    def __init__(self, members: Sequence[Actuator], act: Callable[[Sequence[Actuator | Rows[Actuator]]], None]) -> None:
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
        """Take note of ticks in which the robots went on, of `World.step_freely`."""
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
