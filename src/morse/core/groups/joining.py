"""Decides which components act together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.sensor import Sensor
from morse.core.streams.local_data import LocalData
from morse.system import variables

if TYPE_CHECKING:
    from morse.core.object import Object

VARIABLE = "MORSE_FLEETS"
#: methods that change how a single component acts; a class that overrides one of them cannot use an inherited
#: ``act_together``
_ALONE = ("action", "default_action", "measure", "report", "sensor_setup", "update_pose", "local_data", "active")


def are_allowed() -> bool:
    """Whether components act together; the environment variable ``MORSE_FLEETS=off`` disables it."""
    return variables.word(VARIABLE) != "off"


def has_group_action(cls: Any) -> bool:
    """Whether a class defines ``act_together``, and no subclass overrides how a single component acts."""
    for base in cls.__mro__:
        if "act_together" in vars(base):
            return issubclass(cls, (Sensor, Actuator))
        if any(name in vars(base) for name in _ALONE):
            return False
    return False


def may_join(component: Object) -> bool:
    """Whether a component whose class has a group action can take part in it now."""
    own = vars(component)
    return (
        component.active
        and getattr(component, "realism", None) is None
        and not component.input_modifiers
        and not component.output_modifiers
        and type(component.local_data) in (dict, LocalData)
        and not any(name in own for name in (*_ALONE, "act_together", "settle") if name != "local_data")
        and component.may_act_together()
    )
