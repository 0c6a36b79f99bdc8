"""Map a room.

A robot drives in a circle in a room and measures distances. Where are walls and boxes? Write `Mapper`, which collects
the cells of 0.5 m that contain something.

* A ray of the length r at an angle a ends at (r cos a, r sin a) in the frame of the robot. Rotate this point by the
  yaw, and add the position of the robot.
* The column of a point is `math.floor(x / 0.5)`, its row is `math.floor(y / 0.5)`.
* A ray that hits nothing has no end point: leave it out.
"""

from __future__ import annotations

import math
import reprlib
from typing import TYPE_CHECKING

from morse.plugins.lessons.attempt import WrongProgramError

if TYPE_CHECKING:
    from morse.plugins.lessons.attempt import Attempt

START = '''
"""Map a room."""


class Mapper:
    """Collects the cells of 0.5 m that contain something."""

    def add(self, pose, ranges):
        """Note a scan.

        Args:
            pose: x, y (m) and yaw (rad) of the scanner, which is level.
            ranges: 360 distances, m: ray k looks (k - 180) degrees to the left of ahead; 20 where nothing is hit.
        """

    def cells(self):
        """Return the cells as (column, row): cell (2, -1) is 1.0 m <= x < 1.5 m, -0.5 m <= y < 0 m."""
        return set()


mapper = Mapper()
add, cells = mapper.add, mapper.cells
'''

#: of the boxes: x, y, half of the size, m
_BOXES = [(2.25, 1.75, 0.5), (-2.5, 0.25, 0.75), (0.75, -2.75, 0.6)]


def scene() -> None:
    from morse.builder import Cube, Environment, Hokuyo, Morsy, MotionVW, Pose

    robot = Morsy("robot")
    motion = MotionVW("motion")
    robot.append(motion)
    pose = Pose("pose")
    robot.append(pose)
    laser = Hokuyo("laser")
    laser.translate(z=0.5)
    laser.properties(laser_range=20.0, scan_window=359.0, resolution=1.0)
    robot.append(laser)

    for k, (x, y, half) in enumerate([(2.25, 1.75, 0.5), (-2.5, 0.25, 0.75), (0.75, -2.75, 0.6)]):
        box = Cube(f"box_{k}")
        box.location = (x, y, 0.5)
        box.scale = (half, half, 0.5)
        box.set_color(0.7, 0.45, 0.2)
        box.static()
    sides = [(0, 4.85, 5.1, 0.25), (0, -4.85, 5.1, 0.25), (-4.85, 0, 0.25, 4.6)]
    sides += [(4.85, 2.8, 0.25, 1.8), (4.85, -2.8, 0.25, 1.8)]  # with a door between them
    for k, (x, y, half_x, half_y) in enumerate(sides):
        wall = Cube(f"wall_{k}")
        wall.location = (x, y, 0.5)
        wall.scale = (half_x, half_y, 0.5)
        wall.set_color(0.75, 0.72, 0.65)
        wall.static()

    env = Environment("empty")
    env.set_camera_location([0.0, -9.0, 10.0])
    env.set_camera_rotation([0.7, 0.0, 0.0])
    env.show(rays=[laser], overlays=["trails"])


def _occupied(x: float, y: float) -> bool:
    """Whether a place is in a box or a wall, or at its border."""
    near = 0.05
    boxes = any(abs(x - bx) <= half + near and abs(y - by) <= half + near for bx, by, half in _BOXES)
    return boxes or 4.6 - near <= max(abs(x), abs(y)) <= 5.1 + near


def check(attempt: Attempt) -> None:
    robot = attempt.simulation.robot
    for _ in range(80):
        robot.motion.publish({"v": 0.6, "w": 0.5})
        attempt.step(0.15)
        data = robot.pose.data
        attempt.call("add", (data["x"], data["y"], data["yaw"]), list(robot.laser.data["range_list"]))
    found = attempt.call("cells")
    try:
        cells = {(int(column), int(row)) for column, row in found}  # type: ignore[attr-defined]
    except Exception:  # a student may return anything
        raise WrongProgramError(f"cells() returned {reprlib.repr(found)}, expected pairs of integers") from None
    sides = [(-4.5 + 0.1 * k, side) for k in range(91) for side in (-4.65, 4.65)]
    walls = {(math.floor(x / 0.5), math.floor(y / 0.5)) for x, y in [*sides, *((y, x) for x, y in sides)]}
    # corners and the door are not counted
    walls = {(c, r) for c, r in walls if max(abs(c + 0.5), abs(r + 0.5)) < 10 and not (c == 9 and abs(r + 0.5) < 2.5)}
    seen = {cell for cell in walls if cell in cells}
    empty = {
        (c, r) for c, r in cells if not any(_occupied(c / 2 + a / 8, r / 2 + b / 8) for a in range(5) for b in range(5))
    }
    attempt.expect(cells, "It finds something.", "cells() is empty: add() has to remember the cells of the points.")
    # who marks all cells has found nothing
    is_map = len(empty) <= 0.2 * len(cells)
    vague = f"This counts when fewer than a fifth of the cells are empty, now {len(empty)} of {len(cells)}."
    attempt.expect(
        is_map and len(seen) > 0.7 * len(walls),
        "It finds the walls.",
        f"It finds {len(seen)} of their {len(walls)} cells: have you rotated the points by the yaw?"
        if is_map
        else vague,
    )
    for x, y, half in _BOXES:
        near = any(abs(c / 2 + 0.25 - x) < half + 0.3 and abs(r / 2 + 0.25 - y) < half + 0.3 for c, r in cells)
        attempt.expect(
            is_map and near, f"It finds the box at ({x:g}, {y:g}).", "No cell is near it." if is_map else vague
        )
    attempt.expect(
        cells and not empty,
        "Each cell has something in it.",
        f"{len(empty)} cells are empty, such as {min(empty)}." if empty else "This counts when there are cells.",
    )
