"""Arranges components as entries of a schedule."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from morse.core.actuator import Actuator
from morse.core.realism import phase_of
from morse.core.rows.actuator_rows import ActuatorRows
from morse.core.rows.sensor_rows import SensorRows

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.core.object import Object
    from morse.core.rows.rows import Rows
    from morse.core.sensor import Sensor


def arranged(components: Sequence[Object], act: Callable[[Sequence[Object | Rows[Any]]], None]) -> list[Any]:
    """Return components in the order of their actions, with those of a class whose members may be rows in one entry.

    Actuators of a robot with several actuators keep their position in the order, because the last one takes precedence.
    """
    carriers: dict[int, int] = {}
    for component in components:
        carriers[id(component.robot_parent)] = carriers.get(id(component.robot_parent), 0) + 1
    order: list[Any] = []
    alike: dict[tuple[Any, float, float, str | None], list[Object]] = {}
    for component in components:
        if not component.acts_in_rows or (isinstance(component, Actuator) and carriers[id(component.robot_parent)] > 1):
            order.append(component)
            continue
        key = (type(component), component.frequency, phase_of(component), component.level)
        if key not in alike:
            alike[key] = []
            order.append(alike[key])
        alike[key].append(component)
    return [_rows(entry, act) if isinstance(entry, list) else entry for entry in order]


def _rows(members: Sequence[Object], act: Callable[[Sequence[Object | Rows[Any]]], None]) -> ActuatorRows | SensorRows:
    if isinstance(members[0], Actuator):
        return ActuatorRows(cast("Sequence[Actuator]", members), act)
    return SensorRows(cast("Sequence[Sensor]", members), act)
