"""Plan a path around boxes.

The map of a yard is known: rectangles stand in it. Write `plan`, which returns a path around them for a round robot
of 0.5 m radius, at most a quarter longer than the shortest one. Then a robot drives the first path.

* Make a grid, and mark the cells that are nearer to a rectangle, or to the border of the yard, than the radius of the
  robot.
* Dijkstra's algorithm visits the cells in the order of their path length from the start; A* adds the distance to the
  goal. Both find the shortest path on the grid. `heapq` is a queue that returns the smallest item first.
* Diagonal steps are 1.41 times as long as straight ones.
* Remember from which cell each cell was reached, and go back from the goal to get the path.
"""

from __future__ import annotations

import heapq
import itertools
import math
import reprlib
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import WrongProgramError, at

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Plan a path around boxes."""


def plan(boxes, start, goal):
    """Return the points of a path from start to goal, as a list of (x, y), m; None if there is none.

    Args:
        boxes: rectangles (x_min, y_min, x_max, y_max), m. The yard extends from (0, 0) to (16, 12).
        start: x, y of the robot, whose radius is 0.5 m.
        goal: x, y of the place to which it drives.
    """
    return [start, goal]
'''

_SIZE, _RADIUS = (16.0, 12.0), 0.5
_BOXES = [(3.0, 0.0, 4.0, 8.0), (7.0, 4.0, 8.0, 12.0), (11.0, 0.0, 12.0, 7.0), (11.0, 8.6, 12.0, 12.0)]
_WAYS = [((1.0, 1.0), (14.5, 1.5)), ((1.5, 10.5), (9.5, 10.5)), ((5.5, 1.0), (14.0, 10.5))]
_CLOSED = [(6.0, 0.0, 7.0, 12.0)]
_MOST_POINTS = 1000


def scene() -> None:
    from morse.builder import ATRV, Cube, Environment, Pose, Waypoint

    robot = ATRV("robot")
    robot.translate(1.0, 1.0)
    goal = Waypoint("goal")
    robot.append(goal)
    pose = Pose("pose")
    robot.append(pose)
    boxes = [(3, 0, 4, 8), (7, 4, 8, 12), (11, 0, 12, 7), (11, 8.6, 12, 12)]
    for k, (left, bottom, right, top) in enumerate(boxes):
        box = Cube(f"box_{k}")
        box.location = ((left + right) / 2, (bottom + top) / 2, 0.5)
        box.scale = ((right - left) / 2, (top - bottom) / 2, 0.5)
        box.set_color(0.3, 0.45, 0.35)
        box.static()

    env = Environment("empty")
    env.set_camera_location([8.0, -6.0, 15.0])
    env.set_camera_rotation([0.7, 0.0, 0.0])
    env.show(overlays=["trails"])


def _is_free(boxes, x, y, radius):
    inside = radius <= x <= _SIZE[0] - radius and radius <= y <= _SIZE[1] - radius
    near = (math.hypot(max(a - x, 0, x - c), max(b - y, 0, y - d)) for a, b, c, d in boxes)
    return inside and all(gap >= radius for gap in near)


def _shortest(boxes, start, goal, size=0.25):
    """The length of the shortest way on a grid with 16 directions, m; inf without one."""
    steps = [(i, j) for i in range(-2, 3) for j in range(-2, 3) if math.gcd(i, j) == 1]
    first, last = (tuple(round(part / size) for part in place) for place in (start, goal))
    best, queue = {first: 0.0}, [(0.0, first)]
    while queue:
        length, here = heapq.heappop(queue)
        if here == last:
            return length
        if length > best[here]:
            continue
        for i, j in steps:
            cell = here[0] + i, here[1] + j
            total = length + size * math.hypot(i, j)
            if total < best.get(cell, math.inf) and _is_free(boxes, cell[0] * size, cell[1] * size, _RADIUS - 0.05):
                best[cell] = total
                heapq.heappush(queue, (total, cell))
    return math.inf


def _way(attempt, boxes, start, goal):
    """The path of the student, or None.

    Raises:
        WrongProgramError: it is neither a list of points nor None.
    """
    points = attempt.call("plan", list(boxes), start, goal)
    if points is None:
        return None
    try:
        way = [(float(x), float(y)) for x, y in points]
    except Exception:  # a student may return anything
        way = []
    if not 2 <= len(way) <= _MOST_POINTS or not all(math.isfinite(part) for point in way for part in point):
        expected = f"a list of 2 to {_MOST_POINTS} points (x, y), or None"
        raise WrongProgramError(f"plan() returned {reprlib.repr(points)}, expected {expected}")
    return way


def check(attempt: Attempt) -> None:
    for start, goal in _WAYS:
        name = f"from ({start[0]:g}, {start[1]:g}) to ({goal[0]:g}, {goal[1]:g})"
        way = _way(attempt, _BOXES, start, goal)
        ends = way and math.dist(way[0], start) < 0.3 and math.dist(way[-1], goal) < 0.3
        attempt.expect(
            ends,
            f"There is a path {name}.",
            f"It goes from {at(*way[0])} to {at(*way[-1])}." if way else "plan() returned None.",
        )
        way = way or [start]
        length = sum(math.dist(a, b) for a, b in itertools.pairwise(way))
        count = max(2, min(10000, int(length / 0.05)))
        points = [
            (a[0] + (b[0] - a[0]) * k / count, a[1] + (b[1] - a[1]) * k / count)
            for a, b in itertools.pairwise(way)
            for k in range(max(2, min(count, int(math.dist(a, b) / 0.05) + 2)))
        ]
        hit = next((point for point in points if not _is_free(_BOXES, *point, _RADIUS - 0.1)), None)
        clear = attempt.expect(
            ends and hit is None,
            f"It keeps 0.5 m from the boxes and the border {name}.",
            f"At ({hit[0]:.1f}, {hit[1]:.1f}) it is too near." if hit else "This counts when there is a path.",
        )
        shortest = _shortest(_BOXES, start, goal)
        attempt.expect(
            clear and length <= 1.25 * shortest,
            f"It is at most a quarter longer than the shortest path {name}.",
            f"It is {length:.1f} m long; {shortest:.1f} m are possible."
            if clear
            else "This counts when it keeps this distance.",
        )
    tries = len(attempt.findings) > sum(not finding.is_right for finding in attempt.findings)
    attempt.expect(
        _way(attempt, _CLOSED, (2.0, 6.0), (12.0, 6.0)) is None and tries,
        "It returns None where there is no path.",
        "A wall from side to side is in the way there." if tries else "This counts when it has found a path.",
    )
    _drive(attempt, all(finding.is_right for finding in attempt.findings))


def _drive(attempt, is_right):
    what = "The robot drives the first path and touches nothing."
    if not is_right:
        attempt.expect(False, what, "This counts when everything else is right.")
        return
    start, goal = _WAYS[0]
    robot = attempt.simulation.robot
    contacts = robot.contacts()
    for x, y in _way(attempt, _BOXES, start, goal)[1:]:
        robot.goal.publish({"x": x, "y": y, "z": 0.0, "tolerance": 0.2, "speed": 1.0})
        for _ in range(600):
            attempt.step(0.1)
            if math.dist((robot.pose.data["x"], robot.pose.data["y"]), (x, y)) < 0.3:
                break
    place = robot.pose.data["x"], robot.pose.data["y"]
    attempt.expect(
        math.dist(place, goal) < 0.5 and not contacts.touched,
        what,
        f"It ends at ({place[0]:.1f}, {place[1]:.1f}){' and has touched a box' if contacts.touched else ''}.",
    )
