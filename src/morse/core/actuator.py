"""The base class of actuators."""

from __future__ import annotations

import math
from copy import deepcopy
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from morse.core.declarations import add_state, fields_of_component
from morse.core.guard import modify
from morse.core.journal import COMMAND
from morse.core.object import Object
from morse.core.rows.marks import is_overridden, lasting_fields
from morse.core.streams.extent import check_fields
from morse.core.streams.functions import Endpoint, read, waiting
from morse.core.validation.commands import Commands

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.interfaces import Component
    from morse.core.robot import Robot
    from morse.core.rows.columns import Setpoints
    from morse.core.values import Fields


class Actuator(Object):
    """Does something with the data it receives: read ``local_data`` in ``default_action``.

    The last command stays in ``local_data`` and is applied again every tick.

    Attributes:
        command_end: simulated time at which the present command ends, s; None if it does not end.
        obeys_controls: whether it reads the keys or the gamepad of the live view.
        turns_wheels: whether it drives its robot by the speeds of its wheels; see `morse.core.rows.marks.while_same`.
        commands_speed: whether it sets the speed of its robot in each tick, also if no command arrives.
    """

    robot_parent: Robot

    obeys_controls: ClassVar[bool] = False
    turns_wheels: ClassVar[bool] = False
    commands_speed: ClassVar[bool] = False
    command_end: float | None = None
    #: values of the fields before the first command
    _values_at_first: Mapping[str, object] = MappingProxyType({})
    #: the shortest time after which commands end, simulated seconds; None if they do not end
    _command_limit: float | None = None

    add_state("command_end", float | None, "Time at which the last command ends", unit="s")

    def __init_subclass__(cls, **kwargs: object) -> None:
        super().__init_subclass__(**kwargs)
        cls.acts_in_rows = bool(lasting_fields(cls))

    def limit_commands(self, seconds: float) -> None:
        """Prepare for commands that end: the scene declares a stream with the option ``timeout``.

        Args:
            seconds: the shortest timeout of a stream.
        """
        self._command_limit = seconds
        fields = fields_of_component(self)
        self._values_at_first = deepcopy({name: value for name, value in self.local_data.items() if name in fields})
        self.command_end = None

    @property
    def limits_commands(self) -> bool:
        """Whether a stream of the scene limits the time of commands."""
        return self._command_limit is not None

    def rests(self) -> bool:
        """Whether its next actions change nothing but its own pose, as long as no command arrives."""
        if not self._is_plain():
            return False
        return not self._active or (self._has_no_input() and self.holds())

    def _is_plain(self) -> bool:
        return type(self).action is Actuator.action and not is_overridden(self) and not self._is_checked

    def _has_no_input(self) -> bool:
        if self._lasting_modifiers():
            return False
        signs = [waiting(function) for function in self.input_functions]
        return self.command_end is None and not self.limits_commands and None not in signs and not any(signs)

    def lasting_setpoints(self) -> Setpoints | None:
        """What its next actions move as long as nothing but commands arrives; None if they do anything else."""
        if not self._is_plain() or not self._active or self.input_modifiers or not self._has_no_input():
            return None
        return self.setpoints()

    def setpoints(self) -> Setpoints | None:
        """What `default_action` moves while services do not move it otherwise; None if it does anything else."""
        return None

    def went_on(self, values: Sequence[float]) -> None:
        """Take note of actions that were computed elsewhere, from `setpoints`.

        Args:
            values: to which the last one has moved the joints.
        """

    def holds(self) -> bool:
        """Whether `default_action` has nothing to do until the data change."""
        return False

    def action(self) -> None:
        """One tick: update the pose, read the streams, apply the modifiers to new commands, call `default_action`."""
        if not self._active:
            return
        self.position_3d.update(self.bge_object)
        if self.input_functions or self.command_end is not None:
            self.take_input()
            if not self._active:  # a modifier has failed
                return
        self.default_action()
        if self._is_checked:
            check_fields(self)

    def take_input(self) -> None:
        """Read the commands that have arrived, end a command whose time is over, and apply the modifiers."""
        end = self.command_end
        if end is not None:
            self.command_end = None  # of several commands, the last one decides
        before = deepcopy(dict(self.local_data)) if self.input_modifiers else None
        lasting = self._lasting_modifiers()
        for modifier in lasting:
            self.local_data.update(deepcopy(dict(modifier.commanded)))
        has_input = read(self, self.input_functions)
        if end is not None and not has_input:
            has_input = self._ends(end)
        if has_input and self.context.journal.sinks:
            self.context.journal.note(COMMAND, self.name(), deepcopy(dict(self.local_data)), self.command_end)
        for modifier in lasting:
            modifier.commanded = {name: deepcopy(self.local_data[name]) for name in modifier.commanded}
        if before is not None and (has_input or lasting) and modify(self, self.input_modifiers):
            self._refuse_far(before)

    def _lasting_modifiers(self) -> list[Any]:
        """The modifiers that change the last command in each tick; see `morse.core.modifier.AbstractModifier`."""
        modifiers = self.input_modifiers
        return [modifier for modifier in modifiers if getattr(modifier, "each_tick", False)] if modifiers else []

    def _refuse_far(self, before: Fields) -> None:
        """Refuse a command that is out of range after the modifiers: the fields keep their values before it."""
        for name, field in fields_of_component(self).items():
            value = self.local_data.get(name)
            if field.allow:
                continue
            low = -math.inf if field.low is None else field.low
            high = math.inf if field.high is None else field.high
            if isinstance(value, (int, float)) and not low <= value <= high:
                text = f"its modifiers make '{name}' {value:g}, expected {low:g} to {high:g}"
                self.context.complaints.warn(
                    f"{self.name()}: {name} after its modifiers", f"{self.name()}: a command is refused: {text}"
                )
                self.local_data.clear()
                self.local_data.update(before)
                return

    def _ends(self, end: float) -> bool:
        if self.clock.time < end:
            self.command_end = end
            return False
        self.local_data.update(deepcopy(dict(self._values_at_first)))
        text = f"{self.name()}: no command for {self._command_limit or 0.0:g} s: its first values apply again"
        self.context.complaints.warn(text, text)
        return True

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Drive the robot during this tick; see `morse.core.robot.Robot.apply_speed`."""
        assert self.robot_parent is not None
        self.robot_parent.apply_speed(kind, linear_speed, angular_speed)


class PendingCommands(Endpoint):
    """Passes commands from the process or the live view to an actuator, like a stream of a client.

    Commands for an inactive actuator are kept until it is active.
    """

    def __init__(self, actuator: Actuator) -> None:
        self._commands = Commands(actuator)
        self._waiting: Fields = {}
        actuator.input_functions.append(self.default)

    def move_to(self, actuator: Actuator) -> None:
        """Switch to an actuator that replaces the present one and has taken over its input functions."""
        self._commands = Commands(actuator)

    def fitting(self, message: object) -> Fields:
        """Return the fields of a message in the form that `put` takes.

        Raises:
            CommandError: the message is not a dictionary, a value is not valid, or the actuator has no such field.
        """
        return self._commands.fitting(message)

    def put(self, fields: Fields) -> None:
        """Set fields that `fitting` has returned, as `give` does."""
        self._waiting.update(fields)

    def give(self, message: object) -> None:
        """Set fields of the actuator at its next action; if a field is set several times, the last value is used.

        Raises:
            CommandError: the message is not a dictionary, a value is not valid, or the actuator has no such field; then
                no field is set.
        """
        self.put(self.fitting(message))

    @property
    def waiting(self) -> Fields:
        """Return the fields that have not been applied yet; always the same object, because groups rely on it."""
        return self._waiting

    def forget(self) -> None:
        """Discard the commands that have not been applied yet."""
        self._waiting.clear()

    @staticmethod
    def all_of(actuator: Component) -> list[PendingCommands]:
        """Return the instances of this class among the input functions of an actuator, in order."""
        owners = [getattr(function, "__self__", None) for function in actuator.input_functions]
        return [owner for owner in owners if isinstance(owner, PendingCommands)]

    def default(self, actuator: Component) -> bool:
        """Set the fields that wait; return whether there are any."""
        if not self._waiting:
            return False
        actuator.local_data.update(self._waiting)
        self._waiting.clear()
        return True
