"""Flight modes, with the numbers of PX4, and what the parts of an autopilot know of the craft.

Ground stations and MAVSDK know the modes of PX4 and of ArduPilot only.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.failsafe import Fence
    from morse.plugins.mavlink.autopilot.helms import Motion
    from morse.plugins.mavlink.autopilot.parameters import Parameters
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.vehicle import Vehicle


#: bits of base_mode in HEARTBEAT: these are the modes of an autopilot; armed; stabilized, guided, automatic, by hand
_CUSTOM, _ARMED, _BY_HAND, _STABILIZED, _GUIDED, _AUTO = 1, 128, 64, 16, 8, 4


class Mode(Enum):
    """Main mode and sub mode of PX4."""

    MANUAL = 1, 0
    ALTITUDE = 2, 0
    POSITION = 3, 0
    STABILIZED = 7, 0
    OFFBOARD = 6, 0
    READY = 4, 1
    TAKEOFF = 4, 2
    HOLD = 4, 3
    MISSION = 4, 4
    RETURN = 4, 5
    LAND = 4, 6
    FOLLOW = 4, 8

    @property
    def custom(self) -> int:
        """``custom_mode`` of HEARTBEAT."""
        main, sub = self.value
        return main << 16 | sub << 24

    @property
    def by_hand(self) -> bool:
        """Whether MANUAL_CONTROL steers the vehicle."""
        return self in (Mode.MANUAL, Mode.ALTITUDE, Mode.POSITION, Mode.STABILIZED)

    def base(self, is_armed: bool) -> int:
        """``base_mode`` of HEARTBEAT."""
        kind = _BY_HAND if self.by_hand else _GUIDED | _AUTO
        return _CUSTOM | _STABILIZED | kind | (_ARMED if is_armed else 0)


_BY_NUMBERS = {mode.value: mode for mode in Mode}


def mode_of_base(base: int) -> Mode | None:
    """The mode of bits of ``base_mode`` alone, without a custom mode, as PX4 reads them; None if there is none."""
    if base & _AUTO:
        return Mode.MISSION
    if not base & _BY_HAND:
        return None
    return Mode.POSITION if base & _GUIDED else Mode.STABILIZED if base & _STABILIZED else Mode.MANUAL


def mode_of(main: float, sub: float) -> Mode | None:
    """The mode of the parameters of MAV_CMD_DO_SET_MODE; None if there is no such mode."""
    return _BY_NUMBERS.get((main, sub)) or (None if main == 4 else _BY_NUMBERS.get((main, 0)))  # type: ignore[arg-type]


def mode_of_custom(custom: int) -> Mode | None:
    """The mode of ``custom_mode`` of the message SET_MODE; None if there is no such mode."""
    return mode_of(custom >> 16 & 0xFF, custom >> 24 & 0xFF)


class Craft(Protocol):
    """See `morse.plugins.mavlink.autopilot.flight.Flight`."""

    vehicle: Vehicle
    place: Place
    parameters: Parameters
    fence: Fence
    mode: Mode
    home: Triple
    now: Motion
    is_armed: bool

    @property
    def stamp(self) -> int:
        """Simulated time of the last tick, ns."""

    @property
    def goes_up(self) -> bool:
        """Whether it moves in three dimensions."""

    def switch(self, mode: Mode) -> bool:
        """Enter a mode; False if that is not possible."""

    def disarm(self, *, force: bool = False) -> bool:
        """Stop it; False while an aircraft flies."""

    def say(self, severity: int, text: str) -> None:
        """Send a text to ground stations."""
