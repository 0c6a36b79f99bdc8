"""Flies, drives or dives a vehicle in its present mode."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.journal import SERVICE
from morse.mathutils.rotations import turn_back
from morse.plugins.mavlink.autopilot.camera import Cameras
from morse.plugins.mavlink.autopilot.failsafe import NO_BREACH, WARNING, Failsafe, Fence
from morse.plugins.mavlink.autopilot.helms import Motion, Speeds, TwistHelm
from morse.plugins.mavlink.autopilot.items import destination
from morse.plugins.mavlink.autopilot.mission import NEAR, ON_GROUND, Mission
from morse.plugins.mavlink.autopilot.modes import Mode
from morse.plugins.mavlink.autopilot.setpoints import Follow

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.context import Context
    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.helms import Helm
    from morse.plugins.mavlink.autopilot.items import Item
    from morse.plugins.mavlink.autopilot.parameters import Parameters
    from morse.plugins.mavlink.autopilot.setpoints import Setpoint
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.vehicle import Vehicle

IN_AIR, TAKING_OFF, LANDING = 2, 3, 4
_SECOND = 10**9
#: m: height above the ground at which an aircraft flies
_FLYING = 0.25
#: m, and s: an aircraft that descends has landed if it has not sunk by so much for that long
_STILL, _LANDED_AFTER = 0.05, 1.5
#: s after which MANUAL_CONTROL no longer counts
_BY_HAND_FOR = 1.0
_AIRCRAFT = (2, 3, 4, 13, 14, 15, 29)
_SUBMARINE = 12


class Flight:
    """The state of a vehicle: where it is, what it does.

    Attributes:
        helms: what can steer the vehicle, the best first.
        mode: the flight mode.
        is_armed: whether it may move.
        landed: MAV_LANDED_STATE.
        home: in the world, m.
        now: the present motion.
        is_commanded: whether a ground station has armed it or set a mode. Before, it obeys each setpoint.
        is_released: whether attitudes go from the ground station to the actuator.
        speed: cruising speed that a ground station has set, m/s.
        setpoint: of OFFBOARD.
        mission, fence, cameras, failsafe, follow: parts of the vehicle.
    """

    def __init__(self, vehicle: Vehicle, place: Place, parameters: Parameters, context: Context) -> None:
        self.vehicle, self.place, self.parameters = vehicle, place, parameters
        self._context = context
        self.helms: Sequence[Helm] = ()
        self.mode = Mode.HOLD
        self.now = self._motion(0.0)
        self.mission, self.fence, self.cameras = Mission(self), Fence(place), Cameras(self)
        self.failsafe, self.follow = Failsafe(self), Follow(self)
        self._last: int | None = None
        self._reset()

    def _reset(self) -> None:
        self.mode, self.is_armed, self.is_commanded = Mode.HOLD, False, False
        self.home: Triple = self.place.origin
        self.landed = ON_GROUND
        self.now = self._motion(0.0)
        self._ground = self.now.position[2]
        self._goal, self._yaw = self.now.position, self.now.yaw
        self._still = 0.0
        self._lowest = self.now.position[2]
        self.speed: float | None = None
        self.setpoint: Setpoint | None = None
        self._sticks: tuple[float, float, float, float] = (0.0,) * 4
        self._sticks_age = math.inf
        self.is_released = False
        self.failsafe.reset()
        self.follow.reset()

    # -- the state ---------------------------------------------------------------------------

    def _motion(self, dt: float) -> Motion:
        body = self.vehicle.robot.bge_object
        position, rotation = body.world_pose()
        x, y, z = position
        velocity = tuple(float(v) for v in body.velocity()[0])
        yaw = math.atan2(rotation[3], rotation[0])
        return Motion((float(x), float(y), float(z)), velocity, tuple(rotation), yaw, dt)  # type: ignore[arg-type]

    def look(self) -> None:
        """Measure the motion at the end of a tick."""
        self.now = self._motion(self.now.dt)

    def turn_rates(self) -> Triple:
        """Angular velocity in the axes of the robot, rad/s."""
        return turn_back(self.now.rotation, self.vehicle.robot.bge_object.velocity()[1])

    @property
    def stamp(self) -> int:
        """Simulated time of the last tick, ns."""
        return self._last or 0

    @property
    def is_aircraft(self) -> bool:
        """Whether it takes off and lands."""
        return self.vehicle.kind in _AIRCRAFT

    @property
    def goes_up(self) -> bool:
        """Whether it moves in three dimensions."""
        return self.is_aircraft or self.vehicle.kind == _SUBMARINE

    @property
    def helm(self) -> Helm | None:
        """What steers the vehicle; None if it has no actuator."""
        return self.helms[0] if self.helms else None

    @property
    def cruise(self) -> Speeds:
        """The speeds of missions and of all modes but OFFBOARD."""
        values = self.parameters
        level = self.speed or values["MPC_XY_CRUISE" if self.is_aircraft else "GND_SPEED_TRIM"]
        return Speeds(level, values["MPC_Z_VEL_MAX_UP"], values["MPC_Z_VEL_MAX_DN"])

    def _act(self, active: bool) -> None:
        """Start or stop the rotors."""
        for helm in self.helms:
            component = helm.stream.component_instance
            is_wanted = active and helm is self.helm
            if component.active != is_wanted:
                # a recording repeats it as a service call
                name = "activate" if is_wanted else "deactivate"
                with self._context.journal.input(SERVICE, "simulation", (name, [component.name()])):
                    component.active = is_wanted

    # -- commands ----------------------------------------------------------------------------

    def arm(self) -> bool:
        """Allow it to move; False if it has no actuator, or is outside of its fence."""
        if self.helm is None:
            return False
        if not self.is_armed and self.failsafe.breach != NO_BREACH:
            self.say(WARNING, "Arming denied: outside geofence")
            return False
        self.is_commanded = True
        if not self.is_armed:
            self.is_armed, self.landed = True, ON_GROUND
            self._ground = self.now.position[2]
            self.helm.forget()
            self._act(True)
            if self.mode is not Mode.OFFBOARD and not self.mode.by_hand and self.mode is not Mode.MISSION:
                self.switch(Mode.HOLD)
            else:
                self._stay()
        return True

    def disarm(self, *, force: bool = False) -> bool:
        """Stop it; False while an aircraft flies."""
        if self.is_aircraft and self.is_armed and self.landed != ON_GROUND and not force:
            return False
        self.is_commanded = True
        self.is_armed, self.landed, self.speed = False, ON_GROUND, None
        if self.mode not in (Mode.OFFBOARD, Mode.HOLD):
            self.mode = Mode.HOLD
        self.setpoint = None
        if self.is_aircraft:
            self._act(False)
        elif self.helm is not None:
            self.helm.go((0.0, 0.0, 0.0), self.now.yaw, 0.0, self.now)
        return True

    def switch(self, mode: Mode) -> bool:
        """Enter a mode; False if that is not possible."""
        if self.helm is None or (mode is Mode.MISSION and not self.mission.begin()):
            return False
        if mode in (Mode.LAND, Mode.TAKEOFF) and not self.is_aircraft:
            return False
        self.is_commanded = True
        if mode is not self.mode or mode is not Mode.OFFBOARD:
            self._stay()
        if mode is Mode.TAKEOFF:
            self._goal = (*self._goal[:2], self.home[2] + self.parameters["MIS_TAKEOFF_ALT"])
        if mode is Mode.RETURN:
            climbs = self.goes_up and math.dist(self._goal[:2], self.home[:2]) > 1.0
            height = self.home[2] + self.parameters["RTL_RETURN_ALT"]
            self._goal = (*self._goal[:2], max(self._goal[2], height) if climbs else self._goal[2])
        self.mode = mode
        self.failsafe.enter()
        if mode is not Mode.OFFBOARD:
            self.setpoint, self.is_released = None, False
        return True

    def _stay(self) -> None:
        self._goal, self._yaw = self.now.position, self.now.yaw
        self._still, self._lowest = 0.0, self._goal[2]

    def take_off(self, height: float) -> bool:
        """Climb to a height in the world, m."""
        if not self.switch(Mode.TAKEOFF):
            return False
        self._goal = (*self._goal[:2], height)
        return True

    def go(self, goal: Triple, yaw: float | None = None) -> None:
        """Go to a position in the world, m, and stay there."""
        self.switch(Mode.HOLD)
        self._goal = goal
        self._yaw = self.now.yaw if yaw is None else yaw

    def take_setpoint(self, setpoint: Setpoint) -> None:
        """Obey a setpoint, in OFFBOARD; also in HOLD, and before a ground station has armed the vehicle."""
        if self.follows():
            self.setpoint, self.is_released = setpoint, False

    def follows(self) -> bool:
        """Whether setpoints count; the first one starts OFFBOARD."""
        self.failsafe.hear_setpoint()
        if not self.is_commanded and self.helm is not None and not self.is_armed:
            self.arm()
            self.is_commanded = False
            self.mode = Mode.OFFBOARD
            self.failsafe.enter(is_stream=False)
        if self.mode is Mode.HOLD and self.is_armed and self.landed != TAKING_OFF:
            self.switch(Mode.OFFBOARD)
            self.failsafe.enter(is_stream=False)
        # also before it is armed: PX4 wants setpoints before the mode
        return self.mode is Mode.OFFBOARD

    def take_sticks(self, forward: float, right: float, up: float, turn: float) -> None:
        """Manual control: shares from -1 to 1; turning to the right."""
        self._sticks, self._sticks_age = (forward, right, up, turn), 0.0

    def say(self, severity: int, text: str) -> None:
        """Send a text to ground stations."""
        self.vehicle.send("statustext", severity, text.encode())

    # -- the tick ----------------------------------------------------------------------------

    def tick(self, stamp: int) -> None:
        """Steer.

        Args:
            stamp: simulated time, ns.
        """
        if self._last is not None and stamp < self._last:
            self._reset()  # the simulation has started again
            self.mission.restart()
        dt = 0.0 if self._last is None else max(0, stamp - self._last) / _SECOND
        self._last = stamp
        self.now = self._motion(dt)
        self.failsafe.tick(dt)
        if self.helm is None or not self.is_armed:
            return
        self._sticks_age += dt
        if self.is_aircraft:
            self._see_whether_it_flies()
        if not self.is_armed:
            return
        if self.mode is Mode.TAKEOFF:
            self.goto(self._goal, self._yaw)
            if abs(self._goal[2] - self.now.position[2]) < NEAR:
                self.mode, self.landed = Mode.HOLD, IN_AIR
        elif self.mode is Mode.MISSION:
            self.mission.tick()
        elif self.mode is Mode.RETURN:
            self._return()
        elif self.mode is Mode.LAND:
            self.land()
        elif self.mode is Mode.FOLLOW:
            self.goto(*(self.follow.goal() or (self._goal, self._yaw)))
        elif self.mode is Mode.OFFBOARD:
            self._follow()
        elif self.mode.by_hand:
            self._by_hand()
        else:
            self.goto(self._goal, self._yaw)

    def _see_whether_it_flies(self) -> None:
        height = self.now.position[2] - self._ground
        if self.mode is Mode.TAKEOFF:
            self.landed = TAKING_OFF if height > _FLYING / 2.0 else ON_GROUND
        elif self.mode is not Mode.LAND and self.landed != LANDING:
            self.landed = IN_AIR if height > _FLYING else ON_GROUND

    def goto(self, goal: Triple, yaw: float | None = None) -> None:
        """Steer to a position in the world, m, at the cruising speed."""
        assert self.helm is not None
        self.helm.goto(goal, yaw, self.cruise, self.now)

    def is_near(self, goal: Triple, radius: float) -> bool:
        """Whether the vehicle is within a radius of a position, m; vehicles on the ground do not climb."""
        axes = 3 if self.goes_up else 2
        return math.dist(goal[:axes], self.now.position[:axes]) <= radius

    def land(self) -> None:
        """Descend to the ground where `_goal` is; then stop the rotors."""
        assert self.helm is not None
        z = self.now.position[2]
        if z < self._lowest - _STILL:
            self._lowest, self._still = z, 0.0
        self._still += self.now.dt
        if self._still > _LANDED_AFTER:
            self.landed, self._ground = ON_GROUND, z
        elif self.landed != ON_GROUND:
            self.landed = LANDING
        if self._still > _LANDED_AFTER + self.parameters["COM_DISARM_LAND"]:
            self.disarm()
            return
        speeds = self.cruise._replace(down=self.parameters["MPC_LAND_SPEED"])
        self.helm.goto((*self._goal[:2], z - 1.0), self._yaw, speeds, self.now)

    def destination(self, item: Item) -> Triple:
        """The position of an item of a mission in the world, m."""
        return destination(item, self.place, self.home, self.now.position)

    def change_speed(self, speed: float) -> bool:
        """Set the cruising speed, m/s; -2 means that of the parameters. False if it is not a speed."""
        if speed == -2.0:
            self.speed = None
        elif 0.05 <= speed <= 1e3:
            self.speed = speed
        # -1: no change
        return speed in (-1.0, -2.0) or 0.05 <= speed <= 1e3

    def descend_at(self, goal: Triple) -> None:
        """Land at a position."""
        self.switch(Mode.LAND)
        self._goal = goal

    def _return(self) -> None:
        x, y, z = self.home
        here = self.now.position
        # first up, then across
        if self.goes_up and not self.is_near(self.home, 1.0) and self._goal[2] - here[2] > NEAR:
            self.goto(self._goal, self._yaw)
            return
        over: Triple = (x, y, self._goal[2] if self.goes_up else z)
        self.goto(over, self._yaw)
        if math.dist(over[:2], here[:2]) < (NEAR if self.goes_up else 2.0 * NEAR):
            if self.is_aircraft:
                self.descend_at(over)
            else:
                self.switch(Mode.HOLD)

    def _follow(self) -> None:
        point = self.setpoint
        assert self.helm is not None
        if point is None:
            if not self.is_released:
                self.goto(self._goal, self._yaw)
            return
        yaw = None if point.yaw is None else self.place.heading(point.yaw)
        if None not in point.position:
            self.helm.goto(self.place.world(point.position), yaw, Speeds(), self.now)  # type: ignore[arg-type]
            return
        here = self.place.local(self.now.position)
        vx, vy, vz = (0.0 if v is None else v for v in point.velocity)
        if point.is_body and point.position == (None, None, None):
            self._go_ahead((vx, -vy, -vz), -point.rate, yaw)
            return
        if point.is_body:
            heading = self.place.heading(self.now.yaw)
            c, s = math.cos(heading), math.sin(heading)
            vx, vy = c * vx - s * vy, s * vx + c * vy
        velocity = [
            v if p is None else 0.8 * (p - h) for v, p, h in zip((vx, vy, vz), point.position, here, strict=True)
        ]
        self.helm.go(self.place.axes.vector(velocity), yaw, -point.rate, self.now)

    def _by_hand(self) -> None:
        forward, right, up, turn = self._sticks if self._sticks_age < _BY_HAND_FOR else (0.0,) * 4
        speeds = self.cruise
        climb = up * (speeds.up if up > 0.0 else speeds.down)
        rate = -turn * math.radians(self.parameters["MPC_MAN_Y_MAX"])
        self._go_ahead((forward * speeds.level, -right * speeds.level, climb), rate)

    def _go_ahead(self, velocity: Triple, rate: float, yaw: float | None = None) -> None:
        """Move with a velocity forward, to the left and up, m/s, and turn to the left, rad/s, or to a yaw."""
        assert self.helm is not None
        if isinstance(self.helm, TwistHelm) and yaw is None:
            self.helm.body(velocity, rate, self.now)
            return
        x, y, z = velocity
        c, s = math.cos(self.now.yaw), math.sin(self.now.yaw)
        self.helm.go((c * x - s * y, s * x + c * y, z), yaw, rate, self.now)
