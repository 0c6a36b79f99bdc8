"""The part of an autopilot that saved states contain: a restored flight goes on with the same bits.

Photos, rates of messages and uploads that have not ended are not saved.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import msgspec

from morse.core.state import StateError
from morse.plugins.mavlink.autopilot.items import Item, fault_of
from morse.plugins.mavlink.autopilot.modes import mode_of_custom
from morse.plugins.mavlink.autopilot.setpoints import Setpoint  # noqa: TC001  msgspec reads it

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.values import Fields
    from morse.plugins.mavlink.autopilot.flight import Flight
    from morse.plugins.mavlink.autopilot.gimbal import Gimbal
    from morse.plugins.mavlink.autopilot.parameters import Parameters

#: m
_FARTHEST = 1e7
_Point = tuple[float, float, float]
#: commands of a helm: numbers and vectors
_Slots = dict[str, float | tuple[float, ...]]


class SavedFlight(msgspec.Struct, forbid_unknown_fields=True):
    """Attributes of `Flight`; the mode as ``custom_mode``."""

    mode: int
    is_armed: bool
    is_commanded: bool
    landed: Annotated[int, msgspec.Meta(ge=0, le=4)]
    home: _Point
    _ground: float
    _goal: _Point
    _yaw: float
    _still: float
    _lowest: float
    speed: float | None
    setpoint: Setpoint | None
    _sticks: tuple[float, float, float, float]
    _sticks_age: float
    is_released: bool
    _last: int | None


class SavedMission(msgspec.Struct, forbid_unknown_fields=True):
    """Attributes of `Mission`; the jumps as pairs."""

    items: list[Item]
    current: int
    is_started: bool
    is_complete: bool
    _jumps: list[tuple[int, int]]
    _there: float
    _is_there: bool
    _climb: float | None
    _jump: int | None
    _yaw: float | None
    _goal: _Point
    _from: _Point


class SavedFailsafe(msgspec.Struct, forbid_unknown_fields=True):
    """Attributes of `Failsafe`; the mode as ``custom_mode``."""

    _silence: float
    _is_lost: bool
    _age: float
    _is_stream: bool
    _instead: int | None
    breach: int
    breaches: int
    breach_time: int


class SavedFollow(msgspec.Struct, forbid_unknown_fields=True):
    """Attributes of `Follow`."""

    _target: _Point | None
    _course: float | None
    _age: float


class SavedGimbal(msgspec.Struct, forbid_unknown_fields=True):
    """Attributes of `Gimbal`."""

    _stamp: int
    _rates: tuple[float, float]
    _place: _Point | None
    _control: tuple[int, int]


class SavedHelm(msgspec.Struct, forbid_unknown_fields=True):
    """Attributes of a helm; those that it does not have are nothing."""

    _last: _Slots
    _goal: _Point | None = None
    _yaw: float | None = None
    _backs: bool = False


class SavedAutopilot(msgspec.Struct, forbid_unknown_fields=True):
    """One vehicle."""

    flight: SavedFlight
    mission: SavedMission
    fence: list[Item]
    parameters: dict[str, float]
    failsafe: SavedFailsafe
    follow: SavedFollow
    gimbal: SavedGimbal
    helms: list[SavedHelm]


def save(flight: Flight, parameters: Parameters, gimbal: Gimbal) -> SavedAutopilot:
    """The present state."""
    instead, jumps = flight.failsafe._instead, list(flight.mission._jumps.items())
    return SavedAutopilot(
        _read(SavedFlight, flight, mode=flight.mode.custom),
        _read(SavedMission, flight.mission, items=list(flight.mission.items), _jumps=jumps),
        list(flight.fence.items),
        dict(parameters._values),
        _read(SavedFailsafe, flight.failsafe, _instead=None if instead is None else instead.custom),
        _read(SavedFollow, flight.follow),
        _read(SavedGimbal, gimbal),
        [_read(SavedHelm, helm, _last=_plain(helm._last)) for helm in flight.helms],
    )


def checked(state: object) -> SavedAutopilot:
    """A state as it is in files.

    Raises:
        StateError: it is damaged.
    """
    try:
        values = msgspec.convert(state, SavedAutopilot)
    except msgspec.ValidationError as error:
        raise StateError(f"mavlink: the saved state of an autopilot is damaged: {error}") from None
    modes = [values.flight.mode, *([] if values.failsafe._instead is None else [values.failsafe._instead])]
    items, index = values.mission.items, values.mission.current
    if not (all(map(mode_of_custom, modes)) and 0 <= index < max(1, len(items)) and _is_possible(values)):
        raise StateError("mavlink: the saved state of an autopilot is damaged: it has no such mode, item or number")
    return values


def restore(values: SavedAutopilot, flight: Flight, parameters: Parameters, gimbal: Gimbal) -> None:
    """Restore a state; the fence first, because nothing else depends on what it refuses."""
    flight.fence.replace(values.fence)
    for name, value in values.parameters.items():
        if name in parameters._values:
            parameters.set(name, value)
    _write(values.flight, flight, mode=mode_of_custom(values.flight.mode))
    _write(values.mission, flight.mission, _jumps=dict(values.mission._jumps))
    instead = values.failsafe._instead
    _write(values.failsafe, flight.failsafe, _instead=None if instead is None else mode_of_custom(instead))
    _write(values.follow, flight.follow)
    _write(values.gimbal, gimbal)
    for one, helm in zip(values.helms, flight.helms, strict=False):
        _write(one, helm)


def _read(cls: type[Any], owner: object, **others: object) -> Any:
    names = [name for name in cls.__struct_fields__ if name not in others and hasattr(owner, name)]
    return cls(**{name: getattr(owner, name) for name in names}, **others)


def _write(values: msgspec.Struct, owner: object, **others: object) -> None:
    for name in values.__struct_fields__:
        if hasattr(owner, name):
            setattr(owner, name, others.get(name, getattr(values, name)))


def _plain(slots: Fields) -> _Slots:
    """Vectors and numbers of any kind as those of Python."""
    return {
        name: tuple(map(float, value)) if hasattr(value, "__len__") else float(value) for name, value in slots.items()
    }


def _is_possible(values: SavedAutopilot) -> bool:
    """Whether what the autopilot steers by are finite numbers, and places of a world."""
    flight, mission, follow = values.flight, values.mission, values.follow
    vectors: list[Sequence[float | None] | None] = [flight.home, flight._goal, flight._sticks, follow._target]
    vectors += [mission._goal, mission._from, values.gimbal._place, *(helm._goal for helm in values.helms)]
    numbers: list[float | None] = [flight._yaw, flight._lowest, flight.speed, mission._yaw, follow._course]
    numbers += [helm._yaw for helm in values.helms]
    if flight.setpoint is not None:
        vectors += [flight.setpoint.position, flight.setpoint.velocity]
        numbers += [flight.setpoint.yaw, flight.setpoint.rate]
    numbers += [number for vector in vectors for number in vector or ()]
    # a comparison with NaN is false
    return all(number is None or abs(number) <= _FARTHEST for number in numbers) and not any(
        map(fault_of, mission.items)
    )
