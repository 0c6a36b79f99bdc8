"""Twenty controllers with a planted fault each, for `benchmarks.programs.falsify`.

A fault is a function of a simulation, of the parameters of its scenario, and of ``mended``, which takes the fault away.
It returns a margin in metres, radians or seconds: the software has failed if it is less than the limit of the fault.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.many import uniform

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.many import Distribution

#: ticks between two commands, and their time, s
_TICKS, _STEP = 6, 0.1


def scene() -> None:
    """Two robots that move as they are told."""
    from morse.builder import Environment, MotionVW, Pose, Robot

    for name, y in (("robot", 0.0), ("other", 100.0)):
        robot = Robot(name=name)
        robot.translate(y=y)
        for part in (MotionVW("motion"), Pose("pose")):
            robot.append(part)
    Environment("empty")


class Fault(NamedTuple):
    """A planted fault.

    Attributes:
        what: what is wrong with the controller.
        run: see above.
        limit: the margin below which the software has failed.
        parameters: those of the scenario; all other arguments have their defaults.
        known: where the fault begins, for parameters whose boundary is known from the code.
    """

    what: str
    run: Callable[..., float]
    limit: float
    parameters: dict[str, Distribution]
    known: dict[str, float] = {}  # noqa: RUF012


FAULTS: dict[str, Fault] = {}


def _fault(what: str, limit: float, known: dict[str, float] | None = None, **ranges: tuple[float, float]) -> Any:
    def add(run: Callable[..., float]) -> Callable[..., float]:
        parameters = {name: uniform(*ends) for name, ends in ranges.items()}
        FAULTS[run.__name__] = Fault(what, run, limit, parameters, known or {})
        return run

    return add


def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def _poses(sim: Any, seconds: float, robot: str = "robot") -> Iterator[tuple[float, float, float, float]]:
    """Time and pose of a robot, before each command; the other robots move, too."""
    sim.measure()
    for step in range(round(seconds / _STEP)):
        data = sim[robot].pose.data
        yield step * _STEP, data["x"], data["y"], data["yaw"]
        sim.step(_TICKS)


def _drive(sim: Any, v: float, w: float = 0.0, robot: str = "robot") -> None:
    sim[robot].motion.publish({"v": v, "w": w})


def _gap(sim: Any) -> float:
    a, b = sim.robot.pose.data, sim.other.pose.data
    return math.hypot(a["x"] - b["x"], a["y"] - b["y"])


# -- go to a goal --------------------------------------------------------------------------


def _goto(sim: Any, goal: tuple[float, float], seconds: float, steer: Callable[[float, float], float]) -> Any:
    """Drive to a goal; returns the last distance to it, and how far the robot has turned, rad."""
    turned, distance = 0.0, 0.0
    for _, x, y, yaw in _poses(sim, seconds):
        distance = math.hypot(goal[0] - x, goal[1] - y)
        w = max(-1.5, min(1.5, steer(math.atan2(goal[1] - y, goal[0] - x), yaw)))
        _drive(sim, 0.0 if distance < 0.1 else min(0.6, distance), w if distance > 0.1 else 0.0)
        turned += abs(w) * _STEP * (distance > 0.1)
    return distance, turned


@_fault("the error of the heading is not wrapped", -4.5, x=(-3.0, 3.0), y=(-3.0, 3.0), yaw=(-3.1, 3.1))
def unwrapped(sim: Any, x: float = 2.0, y: float = 0.5, yaw: float = 0.0, mended: bool = False) -> float:
    sim.robot.place([0.0, 0.0, yaw])
    error = _wrapped if mended else lambda angle: angle
    return -float(_goto(sim, (x, y), 6.0, lambda bearing, now: 2.0 * error(bearing - now))[1])


@_fault("atan instead of atan2: goals behind are sought in front", -3.0, x=(-3.0, 3.0), y=(-3.0, 3.0), yaw=(-1.0, 1.0))
def half_plane(sim: Any, x: float = 2.0, y: float = 0.5, yaw: float = 0.0, mended: bool = False) -> float:
    sim.robot.place([0.0, 0.0, yaw])

    def steer(bearing: float, now: float) -> float:
        seen = bearing if mended else math.atan(math.tan(bearing))
        return 2.0 * _wrapped(seen - now)

    return -float(_goto(sim, (x, y), 9.0, steer)[0])


@_fault(
    "a dead band for headings that point exactly away from the goal",
    -5.0,
    known={"yaw": math.pi - 0.02},
    distance=(1.0, 3.0),
    bearing=(-3.1, 3.1),
    yaw=(-3.1415, 3.1415),
)
def dead_band(sim: Any, distance: float = 2.0, bearing: float = 0.0, yaw: float = 0.0, mended: bool = False) -> float:
    """The heading is relative to the goal."""
    sim.robot.place([0.0, 0.0, bearing + yaw])
    goal = (distance * math.cos(bearing), distance * math.sin(bearing))

    def steer(direction: float, now: float) -> float:
        error = _wrapped(direction - now)
        return 2.0 * error if mended or abs(error) < math.pi - 0.02 else 0.0

    turned = _goto(sim, goal, 4.0, steer)
    return -max(float(turned[1]), float(turned[0]) * 2.0)


@_fault("the goal is given in the frame of the robot, and taken for one of the world", -1.82, x=(0.5, 2.0),
        y=(-0.5, 0.5), yaw=(0.0, 1.0), start=(-1.0, 1.0))  # fmt: skip
def frame(
    sim: Any, x: float = 1.0, y: float = 0.0, yaw: float = 0.0, start: float = 0.0, mended: bool = False
) -> float:
    sim.robot.place([start, 0.0, yaw])
    c, s = (math.cos(yaw), math.sin(yaw))
    goal = (start + c * x - s * y, s * x + c * y)
    told = goal if mended else (start + x, y)
    _goto(sim, told, 6.0, lambda bearing, now: 3.0 * _wrapped(bearing - now))
    data = sim.robot.pose.data
    return -math.hypot(data["x"] - goal[0], data["y"] - goal[1])


@_fault("degrees are taken for radians in a correction of the compass", -0.25, x=(1.0, 3.0), y=(-1.0, 1.0),
        declination=(-3.0, 3.0))  # fmt: skip
def degrees(sim: Any, x: float = 2.0, y: float = 0.0, declination: float = 0.0, mended: bool = False) -> float:
    shift = math.radians(declination)
    correction = shift if mended else declination
    return -float(_goto(sim, (x, y), 8.0, lambda b, now: 2.0 * _wrapped(b - (now + shift - correction)))[0])


@_fault("the robot circles around a goal that is nearer than its turning circle", -3.0, x=(-2.0, 2.0), y=(-2.0, 2.0),
        speed=(0.2, 1.2), yaw=(-3.1, 3.1))  # fmt: skip
def circling(
    sim: Any, x: float = 2.0, y: float = 0.0, speed: float = 0.4, yaw: float = 0.0, mended: bool = False
) -> float:
    sim.robot.place([0.0, 0.0, yaw])
    nearest = math.inf
    for _, px, py, now in _poses(sim, 8.0):
        distance, error = math.hypot(x - px, y - py), _wrapped(math.atan2(y - py, x - px) - now)
        nearest = min(nearest, distance)
        if nearest < 0.15:
            return 0.0
        _drive(sim, speed * max(0.0, math.cos(error)) if mended else speed, max(-1.0, min(1.0, 2.0 * error)))
    return -nearest * 4.0


# -- brake before a wall -------------------------------------------------------------------


def _brake(sim: Any, ahead: float, v: float, grip: float, latency: float, begins: Callable[[float], bool]) -> float:
    """Drive towards a wall, and brake by ``grip`` m/s² once the controller says so; returns the last distance, m."""
    speed, told = v, deque([False] * round(latency / _STEP))
    is_braking = False
    for _, x, _, _ in _poses(sim, 9.0):
        told.append(begins(ahead - x))
        is_braking = is_braking or told.popleft()
        speed = max(0.0, speed - grip * _STEP) if is_braking else speed
        if is_braking and not speed:
            break
        _drive(sim, speed)
    return float(ahead - sim.robot.pose.data["x"])


@_fault("the braking distance grows with the speed, not with its square", -0.45, speed=(0.3, 2.0), ahead=(3.5, 8.0),
        grip=(0.5, 2.0))  # fmt: skip
def linear_brake(sim: Any, speed: float = 1.0, ahead: float = 6.0, grip: float = 1.0, mended: bool = False) -> float:
    need = 0.3 + (speed**2 / (2.0 * grip) if mended else 1.45 * speed)
    return _brake(sim, ahead, speed, grip, 0.0, lambda distance: distance - 0.2 * speed < need)


@_fault("a buffer of seven commands: what is later than 0.75 s is not expected", -0.23, known={"latency": 0.75},
        speed=(0.3, 2.0), ahead=(3.5, 8.0), grip=(0.8, 2.5), latency=(0.0, 0.8))  # fmt: skip
def short_buffer(
    sim: Any, speed: float = 1.0, ahead: float = 6.0, grip: float = 1.5, latency: float = 0.0, mended: bool = False
) -> float:
    expected = latency if mended or latency < 0.75 else 0.0
    need = 1.3 + speed**2 / (2.0 * grip) + speed * (expected - 0.02)
    return _brake(sim, ahead, speed, grip, latency, lambda distance: distance - 0.1 * speed < need)


@_fault("the speed is stored in a byte, and what is over 1.8 m/s is cut off", -0.2, speed=(0.3, 2.0),
        ahead=(4.0, 8.0), grip=(0.4, 2.5))  # fmt: skip
def byte(sim: Any, speed: float = 1.0, ahead: float = 6.0, grip: float = 1.0, mended: bool = False) -> float:
    stored = speed if mended else min(speed, 1.8)
    need = 0.3 + stored**2 / (2.0 * grip)
    return _brake(sim, ahead, speed, grip, 0.0, lambda distance: distance - 0.2 * speed < need)


@_fault("the distance is measured by echoes that are counted modulo 5 m", 0.0, known={"ahead": 5.0}, speed=(0.3, 2.0),
        ahead=(2.5, 5.3), grip=(0.5, 2.0))  # fmt: skip
def ambiguous(sim: Any, speed: float = 1.0, ahead: float = 4.0, grip: float = 1.0, mended: bool = False) -> float:
    """A wall beyond 5 m seems to be at the robot, which waits for it to move away: too late to be on time."""
    waited = 0.0
    for _, x, _, _ in _poses(sim, 6.0):
        distance = ahead - x
        seen = distance if mended else distance % 5.0
        waited += _STEP * (seen < 0.5 < distance)
        _drive(sim, speed if seen > 0.5 else 0.0)
    return 0.5 - waited


# -- another one ---------------------------------------------------------------------------


def _cross(sim: Any, other: tuple[float, float, float, float], v: float, seconds: float, yields: Any) -> float:
    """Drive straight ahead; another robot drives, too. Returns the least distance of both while this one drives, m."""
    x, y, heading, speed = other
    sim.other.place([x, y, heading])
    _drive(sim, speed, robot="other")
    nearest = math.inf
    for time, px, py, yaw in _poses(sim, seconds):
        data = sim.other.pose.data
        dx, dy = data["x"] - px, data["y"] - py
        stops = yields(time, math.hypot(dx, dy), _wrapped(math.atan2(dy, dx) - yaw))
        _drive(sim, 0.0 if stops else v)
        if not stops:
            nearest = min(nearest, math.hypot(dx, dy))
    return nearest


_WALKER = {"x": (1.0, 5.0), "y": (-5.0, 5.0), "heading": (-3.1, 3.1), "walk": (0.3, 1.5), "speed": (0.4, 1.2)}


@_fault("the last sector of the scanner is left out", 0.18, **_WALKER)
def last_sector(
    sim: Any, x: float = 4.0, y: float = 4.0, heading: float = 3.0, walk: float = 0.5, speed: float = 0.8,
    mended: bool = False,
) -> float:  # fmt: skip
    def stops(_time: float, distance: float, bearing: float) -> bool:
        sector = int((bearing + math.pi) / (2.0 * math.pi) * 36)
        return distance < 1.0 and (mended or sector != 26)

    return _cross(sim, (x, y, heading, walk), speed, 5.0, stops)


@_fault("what is exactly at the side is seen by neither of two sensors", 0.01, **_WALKER)
def blind_side(
    sim: Any, x: float = 4.0, y: float = 4.0, heading: float = 3.0, walk: float = 0.5, speed: float = 0.8,
    mended: bool = False,
) -> float:  # fmt: skip
    def stops(_time: float, distance: float, bearing: float) -> bool:
        is_seen = abs(bearing) < 1.1 or abs(bearing) > 1.35 or mended
        return distance < 0.9 and is_seen

    return _cross(sim, (x, y, heading, walk), speed, 5.0, stops)


@_fault("the message of the other one is read every second only", 0.08, **_WALKER)
def slow_reader(
    sim: Any, x: float = 4.0, y: float = 4.0, heading: float = 3.0, walk: float = 0.5, speed: float = 0.8,
    mended: bool = False,
) -> float:  # fmt: skip
    told = [math.inf]

    def stops(time: float, distance: float, _bearing: float) -> bool:
        if mended or abs(time % 1.0) < 0.05:
            told[0] = distance
        return told[0] < 1.4

    return _cross(sim, (x, y, heading, walk), speed, 5.0, stops)


@_fault("who arrives a little later does not wait: the message is late, a race", 0.002, first=(2.0, 6.0),
        second=(2.0, 6.0), speed=(0.4, 1.2), walk=(0.4, 1.2), latency=(0.0, 0.5))  # fmt: skip
def race(
    sim: Any, first: float = 3.0, second: float = 4.5, speed: float = 1.0, walk: float = 1.0, latency: float = 0.1,
    mended: bool = False,
) -> float:  # fmt: skip
    """Who arrives first goes; the other one is told so ``latency`` late."""
    own, others = first / speed, second / walk
    has_to_wait = others < own - (0.0 if mended else latency)
    is_near = mended and abs(others - own) < 1.5

    def stops(time: float, distance: float, _bearing: float) -> bool:
        return (has_to_wait or is_near) and distance < 2.5 and time < others + 0.8

    return _cross(sim, (first, -second, math.pi / 2.0, walk), speed, 8.0, stops)


@_fault("the reach of the scanner ends between its rays: a thin pole", 0.32, radius=(0.02, 0.4), y=(-0.3, 0.3),
        x=(3.0, 6.0), speed=(0.3, 1.2), known={"radius": 0.0224})  # fmt: skip
def thin_pole(
    sim: Any, radius: float = 0.3, y: float = 0.2, x: float = 4.0, speed: float = 0.6, mended: bool = False
) -> float:
    """Rays are 4 degrees apart; the robot stops 0.9 m before what they hit."""
    nearest = math.inf
    for _, px, py, _ in _poses(sim, 8.0):
        distance, bearing = math.hypot(x - px, y - py), math.atan2(y - py, x - px)
        between = abs((math.degrees(bearing) - 2.0 + 2.0) % 4.0 - 2.0)
        offset = abs(between) if not mended else 0.0
        is_hit = math.radians(offset) < math.asin(min(1.0, radius / max(distance, 1e-3)))
        is_ahead = abs(bearing) < 0.9 and abs(y - py) < 0.5 + radius
        if is_ahead and is_hit and distance < 0.9 + radius:
            break
        nearest = min(nearest, distance - radius - 0.3)
        _drive(sim, speed)
    return nearest


# -- keep a line, stay in a field ----------------------------------------------------------


def _line(sim: Any, y: float, speed: float, seconds: float, steer: Callable[[float, float], float]) -> float:
    """Follow the line y = 0; returns the greatest distance on the other side of it, m."""
    sim.robot.place([0.0, y, 0.0])
    beyond = 0.0
    for _, _, now, yaw in _poses(sim, seconds):
        _drive(sim, speed, max(-1.5, min(1.5, steer(now, yaw))))
        beyond = max(beyond, -math.copysign(1.0, y) * now)
    return beyond


@_fault("a gain that is too high for commands that come late", -0.5, y=(0.1, 1.0), speed=(0.2, 1.0),
        latency=(0.0, 0.6), gain=(0.5, 1.5))  # fmt: skip
def late_gain(
    sim: Any, y: float = 0.3, speed: float = 0.4, latency: float = 0.0, gain: float = 1.0, mended: bool = False
) -> float:
    waiting = deque([0.0] * (0 if mended else round(latency / _STEP)))

    def steer(now: float, yaw: float) -> float:
        waiting.append(-gain * now - 1.6 * yaw)
        return waiting.popleft()

    return -_line(sim, y, speed, 9.0, steer)


@_fault("the integral of the error is not limited while the wheels slip", -0.55, y=(0.1, 1.0), speed=(0.2, 1.0),
        slip=(0.0, 4.0), gain=(0.5, 1.5))  # fmt: skip
def windup(
    sim: Any, y: float = 0.3, speed: float = 0.4, slip: float = 0.0, gain: float = 1.0, mended: bool = False
) -> float:
    total, time = 0.0, 0.0

    def steer(now: float, yaw: float) -> float:
        nonlocal total, time
        time += _STEP
        total += now * _STEP
        if mended:
            total = max(-0.3, min(0.3, total))
        return 0.0 if time < slip else -gain * now - 1.6 * yaw - 0.25 * total

    return -_line(sim, y, speed, 10.0, steer)


@_fault("a square fence instead of a round one: its corners are far out", -2.805, heading=(0.0, 1.5707),
        speed=(0.3, 1.0), x=(0.0, 1.5), y=(0.0, 1.5))  # fmt: skip
def fence(
    sim: Any, heading: float = 0.0, speed: float = 0.6, x: float = 0.0, y: float = 0.0, mended: bool = False
) -> float:
    """The field is a circle of 2 m; returns how far out the robot has been, m."""
    sim.robot.place([x, y, heading])
    out = 0.0
    for _, px, py, _ in _poses(sim, 6.0):
        measure = math.hypot(px, py) if mended else max(abs(px), abs(py))
        _drive(sim, speed if measure < 2.0 - speed * _STEP else 0.0)
        out = max(out, math.hypot(px, py))
    return -out


@_fault("points are passed when they are left and right of the robot, also far beside them", -0.9, turn=(-1.4, 1.4),
        speed=(0.6, 1.2), far=(1.0, 1.8), rate=(0.4, 1.2))  # fmt: skip
def cut_corner(
    sim: Any, turn: float = 0.3, speed: float = 0.8, far: float = 1.5, rate: float = 0.8, mended: bool = False
) -> float:
    """Three points; returns how far the robot stays from the second one, m."""
    points = [(far, 0.0), (far + far * math.cos(turn), far * math.sin(turn)), (3.0 * far, 0.0)]
    index, nearest = 0, math.inf
    for _, x, y, yaw in _poses(sim, 9.0):
        dx, dy = points[index][0] - x, points[index][1] - y
        nearest = min(nearest, math.hypot(points[1][0] - x, points[1][1] - y))
        error = _wrapped(math.atan2(dy, dx) - yaw)
        is_passed = math.hypot(dx, dy) < 0.2 if mended else math.hypot(dx, dy) < 0.2 or abs(error) > 1.4
        if is_passed and index < 2:
            index += 1
        _drive(sim, speed * max(0.1, math.cos(error)) if mended else speed, max(-rate, min(rate, 2.0 * error)))
    return -nearest


@_fault("a counter of a byte begins anew after 25.6 s, and the robot goes back", -2.47, known={"pause": 9.6},
        pause=(0.0, 10.0), speed=(0.1, 1.0), bend=(-0.5, 0.5))  # fmt: skip
def counter(sim: Any, pause: float = 1.0, speed: float = 0.5, bend: float = 0.0, mended: bool = False) -> float:
    """It stands for a pause, and then drives for 6 s; the count begins at 10 s."""
    count, back = 100, 0.0
    for time, _, _, _ in _poses(sim, pause + 6.0):
        count = count + 1 if mended else (count + 1) % 256
        is_back = count < 100
        _drive(sim, 0.0 if time < pause else -speed if is_back else speed, bend)
        back += speed * _STEP * 5.0 * is_back
    return -back
