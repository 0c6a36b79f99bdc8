"""Executes a mission."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from morse.plugins.mavlink.autopilot.items import (
    ACCEPTED,
    CAMERA,
    CONDITION_DELAY,
    CONDITION_YAW,
    DELAY,
    DENIED,
    HOME,
    JUMP,
    LAND,
    LOITER,
    LOITER_TIME,
    RETURN,
    SPEED,
    TAKEOFF,
    WAYPOINT,
    item_of,
)
from morse.plugins.mavlink.autopilot.modes import Mode

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.plugins.mavlink.autopilot.flight import Flight
    from morse.plugins.mavlink.autopilot.items import Item

#: items without a destination that are executed in a tick: a mission of jumps must not hold up the simulation
_IN_A_TICK = 20
_NO_MISSION, _NOT_STARTED, _ACTIVE, _PAUSED, _COMPLETE = 1, 2, 3, 4, 5
_YAW_NEAR = math.radians(5.0)
#: m: distance from a height at which an aircraft has reached it
NEAR = 0.4
#: MAV_LANDED_STATE
ON_GROUND = 1


class Mission:
    """The items of a vehicle, and which one is being executed.

    Attributes:
        items: in their order.
        current: index of the present item.
        state: MISSION_STATE.
    """

    def __init__(self, flight: Flight) -> None:
        self._flight = flight
        self.items: list[Item] = []
        self.restart()

    def restart(self) -> None:
        """Back to the first item."""
        self.current = 0
        self.is_started = self.is_complete = False
        self._jumps: dict[int, int] = {}
        self._enter()

    #: reads an item of a message
    item_of = staticmethod(item_of)

    def replace(self, items: list[Item]) -> int:
        """Store other items, from the first of which the mission starts; MAV_MISSION_RESULT."""
        self.items = items
        self.restart()
        if self._flight.mode is Mode.MISSION:
            self._flight.switch(Mode.HOLD)
        return ACCEPTED

    def begin(self) -> bool:
        """Start or continue; False if there are no items."""
        if self.is_complete:
            self.restart()
        self.is_started = bool(self.items)
        self._enter()
        return self.is_started

    def go_on_at(self, index: int) -> bool:
        """Continue with an item; False if it does not exist."""
        if not 0 <= index < len(self.items):
            return False
        self.current, self.is_complete = index, False
        self._jumps.clear()
        self._enter()
        self.tell()
        return True

    def go_to(self, item: Item, *, only_height: bool) -> int:
        """Go to the place of an item at once, or to its height, and stay there; MAV_MISSION_RESULT."""
        flight = self._flight
        x, y, z = flight.destination(item)
        goal = (*flight.now.position[:2], z) if only_height else (x, y, z)
        if flight.helm is None or not flight.is_armed or item.command != WAYPOINT or flight.failsafe.is_outside(goal):
            return DENIED
        flight.go(goal)
        return ACCEPTED

    @property
    def state(self) -> int:
        """MISSION_STATE."""
        if not self.items:
            return _NO_MISSION
        if self.is_complete:
            return _COMPLETE
        if self._flight.mode is Mode.MISSION:
            return _ACTIVE
        return _PAUSED if self.is_started else _NOT_STARTED

    def tell(self) -> None:
        """Send MISSION_CURRENT."""
        mode = 1 if self._flight.mode is Mode.MISSION else 2
        self._flight.vehicle.send("mission_current", self.current, len(self.items), self.state, mode)

    def _enter(self) -> None:
        #: seconds at the destination of the present item
        self._there, self._is_there = 0.0, False
        self._climb: float | None = None
        self._jump: int | None = None
        self._yaw: float | None = None
        self._goal = self._from = self._flight.now.position

    def tick(self) -> None:
        """Execute the present item, or several without a destination."""
        for _ in range(_IN_A_TICK):
            if self._flight.mode is not Mode.MISSION:
                return
            item = self.items[self.current]
            is_done = self._STEPS[item.command](self, item) if item.command in self._STEPS else True
            if not is_done:
                return
            self._flight.vehicle.send("mission_item_reached", self.current)
            self._next()

    def _next(self) -> None:
        self.current, jump = (self.current + 1 if self._jump is None else self._jump), self._jump
        if self.current >= len(self.items):
            self.current, self.is_complete = len(self.items) - 1, True
            if self._flight.mode is Mode.MISSION:
                self._flight.switch(Mode.HOLD)
        if jump is not None or not self.is_complete:
            self._enter()
        self.tell()

    # -- items -------------------------------------------------------------------------------

    def _stays(self, seconds: float) -> bool:
        self._there += self._flight.now.dt
        self._flight.goto(self._goal, self._yaw)
        return self._there >= seconds

    def _to_place(self, item: Item) -> bool:
        if not self._is_there and not self._go_to(item):
            return False
        self._is_there = True
        if item.command == LOITER:
            return self._stays(math.inf)
        is_timed = item.command in (WAYPOINT, LOITER_TIME) and item.params[0] > 0.0
        return self._stays(item.params[0] if is_timed else 0.0)

    def _go_to(self, item: Item) -> bool:
        """Whether the vehicle has arrived at an item."""
        flight = self._flight
        self._goal, here = flight.destination(item), flight.now.position
        if self._climb is None and flight.is_aircraft and flight.landed == ON_GROUND:
            # PX4 also takes off first, if the mission does not say so
            height = flight.home[2] + flight.parameters["MIS_TAKEOFF_ALT"]
            self._climb, self._from = max(here[2], min(height, self._goal[2])), here
        if self._climb is not None and self._climb - here[2] > NEAR:
            flight.goto((*self._from[:2], self._climb))
            return False
        if self._climb is not None:
            self._climb = -math.inf
        yaw, radius = item.params[3], item.params[1]
        if math.isfinite(yaw) and yaw != 0.0 and item.command == WAYPOINT:  # those who want any yaw send 0 or NaN
            self._yaw = flight.place.heading(math.radians(yaw))
        if item.command != WAYPOINT or not 0.05 <= radius < 1e3:
            radius = flight.parameters["NAV_ACC_RAD"]
        flight.goto(self._goal, self._yaw)
        return flight.is_near(self._goal, radius)

    def _take_off(self, item: Item) -> bool:
        flight = self._flight
        if not flight.is_aircraft:
            return True
        here = flight.now.position
        if self._climb is None:
            self._climb = flight.destination(item)[2]
            self._from = here
        goal = (*self._from[:2], max(self._climb, self._from[2]))
        flight.goto(goal, self._yaw)
        return goal[2] - here[2] < NEAR

    def _land(self, item: Item) -> bool:
        flight = self._flight
        goal = flight.destination(item)
        over = (goal[0], goal[1], flight.now.position[2])
        if not flight.is_near(over, 0.5):
            if self._climb is None:
                self._climb = flight.now.position[2]
            flight.goto((goal[0], goal[1], self._climb))
            return False
        if flight.is_aircraft:
            flight.descend_at(over)
        return True

    def _return(self, item: Item) -> bool:
        self._flight.switch(Mode.RETURN)
        return True

    def _wait(self, item: Item) -> bool:
        if self._there == 0.0:
            self._goal = self._flight.now.position
        return self._stays(item.params[0] if item.params[0] > 0.0 else 0.0)

    def _turn(self, item: Item) -> bool:
        flight = self._flight
        if self._there == 0.0:
            self._goal = flight.now.position
            angle = math.radians(item.params[0]) if math.isfinite(item.params[0]) else 0.0
            heading = (
                flight.place.heading(flight.now.yaw) + (-angle if item.params[2] < 0.0 else angle)
                if item.params[3]
                else angle
            )
            self._yaw = flight.place.heading(math.remainder(heading, math.tau))
        error = math.remainder(flight.now.yaw - (self._yaw or 0.0), math.tau)
        return self._stays(0.0) and (abs(error) < _YAW_NEAR or self._there > 10.0)

    def _jump_to(self, item: Item) -> bool:
        target, repeat = int(item.params[0]), item.params[1]
        times = self._jumps.get(self.current, 0)
        if (repeat < 0 or times < repeat) and 0 <= target < len(self.items):
            self._jumps[self.current] = times + 1
            self._jump = target
        return True

    def _photograph(self, item: Item) -> bool:
        cameras = self._flight.cameras
        if cameras.is_for(0, item.command):
            cameras.obey(0, item.command, (*item.params, item.x, item.y, item.z))
        return True

    def _change_speed(self, item: Item) -> bool:
        self._flight.change_speed(item.params[1])
        return True

    def _set_home(self, item: Item) -> bool:
        flight = self._flight
        flight.home = flight.now.position if item.params[0] == 1.0 else flight.destination(item)
        return True

    _STEPS: ClassVar[dict[int, Callable[[Mission, Item], bool]]] = {
        WAYPOINT: _to_place, LOITER: _to_place, LOITER_TIME: _to_place, TAKEOFF: _take_off, LAND: _land,
        RETURN: _return, DELAY: _wait, CONDITION_DELAY: _wait, CONDITION_YAW: _turn, JUMP: _jump_to,
        SPEED: _change_speed, HOME: _set_home, **dict.fromkeys(CAMERA, _photograph),
    }  # fmt: skip
