"""Runs components that act together, and determines which components can do so."""

from __future__ import annotations

import logging
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.groups.group import Group
from morse.core.groups.joining import are_allowed, has_group_action, may_join
from morse.core.realism import Realism
from morse.core.reports.faults import ENDINGS, describe

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from morse.core.object import Object

logger = logging.getLogger(__name__)

#: minimum number of members; in smaller groups, members act one by one, which is faster
_LEAST = 4
#: number of ticks after which groups are formed again, so that further members can join
_LOOK = 64


class Together:
    """Components of one class that are due in the same ticks.

    The components that can act together do so first. The others act one by one afterwards, in order. The results do not
    depend on which components act together.

    Attributes:
        members: all components.
        frequency: Hz.
    """

    def __init__(self, members: Sequence[Object], act: Callable[[Sequence[Object]], None]) -> None:
        self.members = tuple(members)
        self.frequency = members[0].frequency
        self._act = act
        self._allowed = are_allowed()
        self._class: Any = type(members[0])
        self._commands = issubclass(self._class, Actuator)
        self._group: Group | None = None
        self._alone: Sequence[Object] = ()
        self._failed = False
        self._error: BaseException | None = None
        self._guard = members[0].context.guard
        self._ticks = 0
        self._form()

    @property
    def phase(self) -> float:
        """Time of the first action after the start, s."""
        return phase_of(self.members[0])

    def name(self) -> str:
        """Name in profiles."""
        return f"{len(self.members)} x {self._class.__name__}"

    # -- forming groups ----------------------------------------------------------------------

    def _form(self) -> None:
        self.dissolve()
        self._is_formed = True
        joining = self._allowed and not self._failed
        together = self._ready(self.members) if joining else []
        chosen = {id(member) for member in together}
        self._alone = [member for member in self.members if id(member) not in chosen]
        if not together:
            return
        inward = self._commands
        self._hooks = [m.input_functions if inward else m.output_functions for m in together]
        self._known = list(chain.from_iterable(self._hooks))
        self._modifiers = [m.input_modifiers if inward else m.output_modifiers for m in together]
        self._always: list[tuple[Object, Any]] = []
        self._sometimes: list[tuple[Object, Any]] = []
        self._signs: list[Collection[Any]] = []
        for member in together:
            for function in member.input_functions if self._commands else member.output_functions:
                sign = getattr(getattr(function, "__self__", None), "waiting", None)
                if sign is None:
                    self._always.append((member, function))
                else:
                    self._sometimes.append((member, function))
                    self._signs.append(sign)
            if isinstance(member, Actuator) and member.limits_commands:
                self._always.append((member, None))
        self._group = Group(together)
        for row, member in enumerate(together):
            member.group = self._group
            member.position_3d.follow(self._group, row)
        self._group.take_stock()

    def _ready(self, members: Sequence[Object]) -> list[Object]:
        return self._guard.those(members, may_join, self._guard.deactivate)

    def _has_changed(self, group: Group | None) -> bool:
        """Whether the group has to be formed again."""
        if not self._is_formed:
            return True
        if group is not None and (group.is_changed or any(self._modifiers) or self._have_hooks_changed()):
            return True
        looks = self._ticks % _LOOK == 0 and self._allowed and not self._failed
        # not the members of the group: asking them would fill in their data
        return bool(looks) and bool(self._alone) and bool(self._ready(self._alone))

    def _have_hooks_changed(self) -> bool:
        """Whether streams were added to members, or removed from them; most members have none."""
        if any(self._hooks):
            return list(chain.from_iterable(self._hooks)) != self._known
        return bool(self._known)

    def dissolve(self) -> None:
        """Update all members, and form the group again at the next action."""
        group, self._group = self._group, None
        self._is_formed = False
        if group is None:
            return
        self._guard.run(group.release, self._failed_as_group)
        for member in group.members:
            member.position_3d.stay()
            member.group = None

    # -- a tick ------------------------------------------------------------------------------

    def action(self) -> None:
        """Run the actions of all members."""
        self._guard.run(self._action, self._failed_as_group)

    def _action(self) -> None:
        group = self._group
        self._ticks += 1
        if self._has_changed(group):
            self._form()
        group = self._group
        if group is None or (self._command(group) if self._commands else self._measure(group)):
            if self._alone:
                self._act(self._alone)
            return
        # a member has changed or is invalid: acting one by one shows which one
        error, self._error = self._error, None
        acting = [member for member in self.members if member.active]
        self._form()
        self._act(self.members)
        if error is not None and all(member.active for member in acting):
            self._failed_as_group(error)

    def _failed_as_group(self, error: BaseException) -> None:
        self._failed = True
        self.dissolve()
        self._alone, self._is_formed = self.members, True
        logger.error(
            "[ERROR][MORSE] act_together of %s failed, although none of its components fails alone: they act "
            "one by one from now on: %s",
            self._class.__name__,
            describe(error),
        )

    def _command(self, group: Group) -> bool:
        group.begin_command()
        if group.is_changed:
            return False
        for member in self._having_something():
            self._guard.run(member.take_input, partial(self._guard.deactivate, member))  # type: ignore[attr-defined]
        return not group.is_changed and self._together(group)

    def _measure(self, group: Group) -> bool:
        held = group.begin_measurement()
        if group.is_changed or not self._together(group) or group.is_changed:
            group.undo()
            return False
        for row in held:
            group.fill(row)
        for member, publish in self._publishing():
            try:
                publish(member)
            except BaseException as error:
                self._guard.close(member, member.output_functions, publish, error)
        if taps := group.context.group_taps:
            self._guard.call(taps, group)
        return True

    def _together(self, group: Group) -> bool:
        try:
            self._class.act_together(group)
        except ENDINGS:
            raise
        except BaseException as error:
            self._error = error
            return False
        return True

    def _publishing(self) -> list[tuple[Object, Any]]:
        busy = self._always
        if any(self._signs):
            busy = [*busy, *(pair for pair, sign in zip(self._sometimes, self._signs, strict=True) if sign)]
        return busy

    def _having_something(self) -> list[Object]:
        if not self._always and not any(self._signs):
            return []
        return list({id(member): member for member, _ in self._publishing()}.values())


def phase_of(component: Any) -> float:
    """Return the time of the first action of a component after the start, s."""
    realism = getattr(component, "realism", None)
    return realism.phase if isinstance(realism, Realism) else 0.0


def arranged(components: Sequence[Object], act: Callable[[Sequence[Object]], None]) -> list[Any]:
    """Return components in the order of their actions, with those that can act together merged into one `Together`.

    Actuators of a robot with several actuators keep their position in the order, because the last one takes precedence.
    """
    carriers: dict[int, int] = {}
    for component in components:
        carriers[id(component.robot_parent)] = carriers.get(id(component.robot_parent), 0) + 1
    order: list[Any] = []
    gathered: dict[tuple[Any, float, float, str | None], list[Object]] = {}
    for component in components:
        if not has_group_action(type(component)) or (
            isinstance(component, Actuator) and carriers[id(component.robot_parent)] > 1
        ):
            order.append(component)
            continue
        key = (type(component), component.frequency, phase_of(component), component.level)
        if key not in gathered:
            gathered[key] = []
            order.append(gathered[key])
        gathered[key].append(component)
    units: list[Any] = []
    for entry in order:
        if not isinstance(entry, list):
            units.append(entry)
        elif len(entry) < _LEAST:
            units += entry
        else:
            units.append(Together(entry, act))
    return units
