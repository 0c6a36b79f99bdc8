"""What a vehicle does by itself: silent ground stations, setpoints that stop, the end of its fence."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

from morse.plugins.mavlink.autopilot import items
from morse.plugins.mavlink.autopilot.modes import Mode

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.items import Item
    from morse.plugins.mavlink.autopilot.modes import Craft
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.framing import MavlinkMessage


#: MAV_CMD_NAV_FENCE: a vertex of a polygon to stay in, or out of; a circle to stay in, or out of
_INSIDE, _OUTSIDE, _IN_CIRCLE, _OUT_OF_CIRCLE = 5001, 5002, 5003, 5004
#: FENCE_BREACH
NO_BREACH, BOUNDARY, TOO_HIGH = 0, 3, 2
_FEWEST_CORNERS = 3
_LARGEST = 1e7

_Point = tuple[float, float]


class _Area(NamedTuple):
    """A polygon, or a circle: one point with a radius, m."""

    stays_in: bool
    points: tuple[_Point, ...]
    radius: float

    def has(self, x: float, y: float) -> bool:
        """Whether a point is inside."""
        if self.radius:
            return math.dist(self.points[0], (x, y)) <= self.radius
        is_inside = False
        for (ax, ay), (bx, by) in zip(self.points, (*self.points[1:], self.points[0]), strict=True):
            if (ay > y) != (by > y) and x < ax + (bx - ax) * (y - ay) / (by - ay):
                is_inside = not is_inside
        return is_inside


class Fence:
    """Polygons and circles; the vehicle stays inside one of those to stay in, and outside all others, as with PX4.

    Attributes:
        items: as they were uploaded.
    """

    def __init__(self, place: Place) -> None:
        self._place = place
        self.items: list[Item] = []
        self._areas: tuple[_Area, ...] = ()

    @staticmethod
    def item_of(message: MavlinkMessage) -> Item | int:
        """Read MISSION_ITEM_INT or MISSION_ITEM; MAV_MISSION_RESULT if it is not valid or not supported."""
        item = items.item_of(message, (_INSIDE, _OUTSIDE, _IN_CIRCLE, _OUT_OF_CIRCLE))
        if isinstance(item, int):
            return item
        size = item.params[0]
        if item.command in (_IN_CIRCLE, _OUT_OF_CIRCLE):
            return item if 0.0 < size < _LARGEST else items.INVALID_PARAM[0]
        return item if size >= _FEWEST_CORNERS and size == int(size) else items.INVALID_PARAM[0]

    def replace(self, fence: list[Item]) -> int:
        """Store other items; MAV_MISSION_RESULT."""
        try:
            areas = tuple(self._areas_of(fence))
        except ValueError:
            return items.ERROR
        self.items, self._areas = fence, areas
        return items.ACCEPTED

    def _areas_of(self, fence: list[Item]) -> Iterator[_Area]:
        """The areas of items.

        Raises:
            ValueError: a polygon lacks corners.
        """
        corners: list[_Point] = []
        before: tuple[int, float] | None = None
        for item in fence:
            x, y, _ = self._place.from_earth(item.x * 1e-7, item.y * 1e-7, 0.0)
            size = item.params[0]
            if corners and before != (item.command, size):
                break
            if item.command in (_IN_CIRCLE, _OUT_OF_CIRCLE):
                yield _Area(item.command == _IN_CIRCLE, ((x, y),), size)
                continue
            corners.append((x, y))
            before = item.command, size
            if len(corners) == size:
                yield _Area(item.command == _INSIDE, tuple(corners), 0.0)
                corners = []
        if corners:
            raise ValueError("a polygon lacks corners")

    def breach(self, position: Triple, home: Triple, farthest: float, highest: float) -> int:
        """FENCE_BREACH of a position.

        Args:
            position: in the world, m.
            home: in the world, m.
            farthest: largest distance from home, m; 0 for any.
            highest: largest height above home, m; 0 for any.
        """
        x, y, z = position
        if highest and z - home[2] > highest:
            return TOO_HIGH
        if farthest and math.dist(home[:2], (x, y)) > farthest:
            return BOUNDARY
        insides = [area for area in self._areas if area.stays_in]
        if insides and not any(area.has(x, y) for area in insides):
            return BOUNDARY
        return BOUNDARY if any(area.has(x, y) for area in self._areas if not area.stays_in) else NO_BREACH


_Action = Mode | Literal["off"]
#: by NAV_DLL_ACT, and by COM_OBL_RC_ACT and GF_ACTION; "off" stops the motors
_ON_SILENCE = {1: Mode.HOLD, 2: Mode.RETURN, 3: Mode.LAND}
_OFF: Literal["off"] = "off"
_ON_LOSS: dict[int, _Action] = {
    0: Mode.POSITION, 1: Mode.ALTITUDE, 2: Mode.MANUAL, 3: Mode.RETURN, 4: Mode.LAND, 5: Mode.HOLD, 6: _OFF, 7: _OFF,
}  # fmt: skip
_ON_BREACH: dict[int, _Action] = {2: Mode.HOLD, 3: Mode.RETURN, 4: _OFF, 5: Mode.LAND}
#: MAV_SEVERITY
WARNING, _INFO = 4, 6


class Failsafe:
    """Watches the vehicle in each tick.

    Attributes:
        breach: FENCE_BREACH.
        breaches: how often the vehicle has left its fence.
        breach_time: simulated time of the last time, ns.
    """

    def __init__(self, flight: Craft) -> None:
        self._flight = flight
        self.reset()

    def reset(self) -> None:
        """The simulation has started again."""
        #: s since the last heartbeat of a ground station; infinite before the first
        self._silence = math.inf
        self._is_lost = False
        #: s since the last setpoint, or since OFFBOARD
        self._age = 0.0
        self._is_stream = False
        #: the mode that has replaced OFFBOARD because setpoints have stopped
        self._instead: Mode | None = None
        self.breach, self.breaches, self.breach_time = NO_BREACH, 0, 0

    def hear_station(self) -> None:
        """A ground station has sent a heartbeat."""
        if self._is_lost:
            self._flight.say(_INFO, "Connection to ground station regained")
        self._silence, self._is_lost = 0.0, False

    def hear_setpoint(self) -> None:
        """A setpoint has arrived: those that go on enter OFFBOARD again, if nothing else has changed the mode."""
        self._age = 0.0
        flight, instead = self._flight, self._instead
        self._instead = None
        if instead is not None and flight.mode is instead and flight.is_armed:
            flight.switch(Mode.OFFBOARD)

    def enter(self, *, is_stream: bool = True) -> None:
        """The mode has changed.

        Args:
            is_stream: whether setpoints have to go on; one that has entered OFFBOARD itself counts until the next one.
        """
        self._age, self._is_stream, self._instead = 0.0, is_stream, None

    def is_outside(self, position: Triple) -> bool:
        """Whether the fence does not contain a position in the world, m."""
        return self._breach_at(position) != NO_BREACH

    def _breach_at(self, position: Triple) -> int:
        flight = self._flight
        values = flight.parameters
        if not values["GF_ACTION"]:
            return NO_BREACH
        return flight.fence.breach(position, flight.home, values["GF_MAX_HOR_DIST"], values["GF_MAX_VER_DIST"])

    def tick(self, dt: float) -> None:
        """Act, if something is amiss; ``dt`` in s."""
        self._watch_station(dt)
        self._watch_setpoints(dt)
        self._watch_fence()

    def _watch_station(self, dt: float) -> None:
        if math.isinf(self._silence):
            return
        self._silence += dt
        values = self._flight.parameters
        action = _ON_SILENCE.get(int(values["NAV_DLL_ACT"]))
        if action is None or self._is_lost or not self._flight.is_armed or self._silence <= values["COM_DL_LOSS_T"]:
            return
        self._is_lost = True
        self._do(action, "Connection to ground station lost")

    def _watch_setpoints(self, dt: float) -> None:
        flight = self._flight
        if flight.mode is not Mode.OFFBOARD or not flight.is_armed or not self._is_stream:
            self._age = 0.0
            return
        self._age += dt
        if self._age > flight.parameters["COM_OF_LOSS_T"]:
            self._do(_ON_LOSS[int(flight.parameters["COM_OBL_RC_ACT"])], "Setpoints lost")
            self._instead = flight.mode

    def _watch_fence(self) -> None:
        flight = self._flight
        before = self.breach
        self.breach = self._breach_at(flight.now.position)
        if self.breach == NO_BREACH or before != NO_BREACH:
            return
        self.breaches += 1
        self.breach_time = flight.stamp
        if flight.is_armed:
            self._do(_ON_BREACH.get(int(flight.parameters["GF_ACTION"])), "Geofence violation")

    def _do(self, action: _Action | None, reason: str) -> None:
        flight = self._flight
        name = "warning" if action is None else action.name.lower() if isinstance(action, Mode) else "motors off"
        flight.say(WARNING, f"{reason}: {name}")
        if isinstance(action, Mode):
            if flight.mode is not Mode.LAND and not flight.switch(action):
                flight.switch(Mode.HOLD)
        elif action is not None:
            flight.disarm(force=True)
