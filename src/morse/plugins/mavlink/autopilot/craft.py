"""What the parts of an autopilot use of the flight."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.fence import Fence
    from morse.plugins.mavlink.autopilot.helms import Motion
    from morse.plugins.mavlink.autopilot.modes import Mode
    from morse.plugins.mavlink.autopilot.parameters import Parameters
    from morse.plugins.mavlink.autopilot.place import Place
    from morse.plugins.mavlink.vehicle import Vehicle


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
