"""The work that every simulator does, and its analytic results.

Units: metres, radians, seconds. Standard library only, so that the program of any simulator can import it.
"""

from __future__ import annotations

import math
import random

SIZE = 20.0  # inner side of the walls, centred on the origin
WALL_THICKNESS, WALL_HEIGHT = 0.2, 1.0
BOX = (0.6, 0.6, 0.8)
BOXES = 30
RADIUS, HEIGHT, MASS = 0.20, 0.30, 10.0  # the robot: a cylinder
WHEEL_RADIUS, WHEEL_WIDTH, WHEEL_MASS, TRACK = 0.06, 0.03, 0.3, 0.30
SPEED, RATE = 0.5, 0.3  # the constant command: a circle of radius 1.667 m
SPACING = 1.0
TICK = 60  # Hz of command and pose
GRAVITY = 9.81
SCAN_RAYS, SCAN_VIEW, SCAN_RANGE, SCAN_RATE, SCAN_HEIGHT = 181, math.pi, 30.0, 10, 0.20
TICKS_PER_SCAN = TICK // SCAN_RATE
# crates that robots push: edge, mass, distance of their centre from that of the robot at the start
CRATE, CRATE_MASS, CRATE_AHEAD = 0.3, 3.0, 0.4
PUSHING_SPEED = 0.2
PANORAMA_ROWS, PANORAMA_COLUMNS = 16, 1800
PANORAMA_VIEW, PANORAMA_RANGE, PANORAMA_HEIGHT = math.radians(30), 100.0, 0.5
# images: position and target of the camera, its focal length for a sensor 32 mm wide, and its maximum depth
PICTURE_EYE, PICTURE_TARGET = (6.0, -7.0, 4.0), (0.0, 0.0, 0.5)
PICTURE_FOCAL, PICTURE_NEAR, PICTURE_FAR = 25.0, 0.1, 100.0
PICTURE_GRID = 16  # columns of compared depths, with 3/4 as many rows

Block = tuple[float, float, float, float, float, float]
Pose = tuple[float, float, float]
Ray = tuple[float, float, float]


def walls(scale: float = 1.0) -> list[Block]:
    """Centre and full edge lengths of the four walls."""
    height, thick, size = WALL_HEIGHT, WALL_THICKNESS, SIZE * scale
    away = size / 2 + thick / 2
    return [
        (away, 0, height / 2, thick, size + 2 * thick, height),
        (-away, 0, height / 2, thick, size + 2 * thick, height),
        (0, away, height / 2, size, thick, height),
        (0, -away, height / 2, size, thick, height),
    ]


def boxes(scale: float = 1.0) -> list[Block]:
    """Centre and full edge lengths of boxes along the walls, at least 1 m apart, always the same."""
    numbers, found = random.Random(7), []
    while len(found) < BOXES:
        x, y = (numbers.random() * 2 - 1) * 9.3, (numbers.random() * 2 - 1) * 9.3
        if max(abs(x), abs(y)) >= 7.0 and all((x - a) ** 2 + (y - b) ** 2 >= 1.0 for a, b, *_ in found):
            found.append((x, y, BOX[2] / 2, *BOX))
    return [(x * scale, y * scale, *rest) for x, y, *rest in found]


def blocks(count: int = 1) -> list[Block]:
    """Everything fixed except the floor; more than a hundred robots need a larger area."""
    scale = max(1.0, math.ceil(math.sqrt(count)) / 10)
    return walls(scale) + boxes(scale)


def row_blocks() -> list[Block]:
    """Four walls and twelve boxes of a row of a batch; the middle is free."""
    return walls(0.5) + [
        (away * math.cos(angle), away * math.sin(angle), BOX[2] / 2, *BOX)
        for number in range(12)
        for angle, away in [(math.tau * number / 12, 3.2 + 0.8 * (number % 2))]
    ]


#: x, y, yaw at the start of a row: the circle of the command goes around the middle
ROW_START = (0.0, -1.0, 0.0)

# robots that drive in circles ---------------------------------------------------------------


def starts(count: int) -> list[Pose]:
    """x, y, yaw of the robots: a grid that keeps its distances under a common command."""
    side = math.ceil(math.sqrt(count))
    return [
        ((i % side - (side - 1) / 2) * SPACING, (i // side - (side - 1) / 2) * SPACING - SPEED / RATE, 0.0)
        for i in range(count)
    ]


def on_circle(start: Pose, seconds: float) -> Pose:
    """The pose of a robot after that time."""
    x, y, yaw = start
    radius, turned = SPEED / RATE, yaw + RATE * seconds
    return x + radius * (math.sin(turned) - math.sin(yaw)), y - radius * (math.cos(turned) - math.cos(yaw)), turned


def worst_position(poses: list[Pose], seconds: float) -> float:
    """Maximum position error of a robot, m."""
    return max(
        math.dist(pose[:2], on_circle(start, seconds)[:2])
        for pose, start in zip(poses, starts(len(poses)), strict=True)
    )


def wheel_speeds() -> tuple[float, float]:
    """Angular speed of the left and the right wheel under the command, rad/s."""
    half = RATE * TRACK / 2
    return (SPEED - half) / WHEEL_RADIUS, (SPEED + half) / WHEEL_RADIUS


# robots that push crates ----------------------------------------------------------------------


def pushing_starts(count: int) -> list[tuple[float, float]]:
    """x, y of the robots: columns of 25 that drive along the X axis."""
    return [(-8.0 + i // 25 * 5.0, (i % 25 - 12) * 0.7) for i in range(count)]


# a flat scan --------------------------------------------------------------------------------


def scan_angles() -> list[float]:
    """Angles of the beams to the heading, from right to left."""
    return [SCAN_VIEW * (i / (SCAN_RAYS - 1) - 0.5) for i in range(SCAN_RAYS)]


def scan(pose: Pose, others: list[Pose]) -> list[float]:
    """Analytic ranges of a laser scanner at the centre of a robot."""
    x, y, yaw = pose
    rectangles = [
        (cx - sx / 2, cx + sx / 2, cy - sy / 2, cy + sy / 2) for cx, cy, _, sx, sy, _ in blocks(1 + len(others))
    ]
    ranges = []
    for angle in scan_angles():
        dx, dy = math.cos(yaw + angle), math.sin(yaw + angle)
        nearest = SCAN_RANGE
        for x0, x1, y0, y1 in rectangles:
            (a0, a1), (b0, b1) = _slab(x, dx, x0, x1), _slab(y, dy, y0, y1)
            enter, leave = max(a0, b0), min(a1, b1)
            if enter <= leave and 0 < enter < nearest:
                nearest = enter
        for ox, oy, _ in others:
            ahead = (ox - x) * dx + (oy - y) * dy
            inside = RADIUS**2 - ((ox - x) ** 2 + (oy - y) ** 2 - ahead**2)
            if ahead > 0 and inside >= 0 and 0 < ahead - math.sqrt(inside) < nearest:
                nearest = ahead - math.sqrt(inside)
        ranges.append(nearest)
    return ranges


def _slab(start: float, step: float, low: float, high: float) -> tuple[float, float]:
    if abs(step) < 1e-12:
        return (-1e9, 1e9) if low <= start <= high else (1e9, -1e9)
    a, b = (low - start) / step, (high - start) / step
    return (a, b) if a < b else (b, a)


def scan_errors(ranges: list[float], poses: list[Pose], robot: int = 0) -> tuple[float, float]:
    """Median error (m) of a scan, and the share of its beams with an error above 5 cm."""
    truth = scan(poses[robot], [p for i, p in enumerate(poses) if i != robot])
    return _errors(ranges, truth)


def _errors(ranges: list[float], truth: list[float]) -> tuple[float, float]:
    if len(ranges) != len(truth):
        return math.inf, 1.0
    errors = sorted(abs(a - b) for a, b in zip(ranges, truth, strict=True))
    return errors[len(errors) // 2], sum(e > 0.05 for e in errors) / len(errors)


# a panorama ---------------------------------------------------------------------------------


def panorama_rays() -> list[Ray]:
    """Unit vectors in the frame of the sensor, row by row from the lowest."""
    rays = []
    for row in range(PANORAMA_ROWS):
        up = PANORAMA_VIEW * (row / (PANORAMA_ROWS - 1) - 0.5)
        for column in range(PANORAMA_COLUMNS):
            around = math.tau * column / PANORAMA_COLUMNS
            rays.append((math.cos(up) * math.cos(around), math.cos(up) * math.sin(around), math.sin(up)))
    return rays


def panorama(pose: Pose, every: int = 1) -> list[float]:
    """Analytic ranges of every n-th ray of a panorama: floor, walls and boxes; the maximum range without a hit."""
    x, y, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    ranges = []
    for a, b, dz in panorama_rays()[::every]:
        dx, dy = cos * a - sin * b, sin * a + cos * b
        nearest = PANORAMA_RANGE
        if dz < 0:
            nearest = min(nearest, -PANORAMA_HEIGHT / dz)
        for cx, cy, cz, sx, sy, sz in blocks():
            slabs = (
                _slab(x, dx, cx - sx / 2, cx + sx / 2),
                _slab(y, dy, cy - sy / 2, cy + sy / 2),
                _slab(PANORAMA_HEIGHT, dz, cz - sz / 2, cz + sz / 2),
            )
            enter, leave = max(s[0] for s in slabs), min(s[1] for s in slabs)
            if enter <= leave and 0 < enter < nearest:
                nearest = enter
        ranges.append(nearest)
    return ranges


def panorama_errors(ranges: list[float], pose: Pose, every: int = 97) -> tuple[float, float]:
    """Median error (m) of every n-th ray of a panorama, and the share of those with an error above 5 cm."""
    if len(ranges) != PANORAMA_ROWS * PANORAMA_COLUMNS:
        return math.inf, 1.0
    return _errors(ranges[::every], panorama(pose, every))


# pictures -----------------------------------------------------------------------------------


def depth_grid(depths: list[list[float]]) -> list[float]:
    """Some of the depths of an image, evenly distributed; 0 without a surface before the far plane."""
    rows, columns = PICTURE_GRID * 3 // 4, PICTURE_GRID
    chosen = [
        depths[(2 * j + 1) * len(depths) // (2 * rows)][(2 * i + 1) * len(depths[0]) // (2 * columns)]
        for j in range(rows)
        for i in range(columns)
    ]
    return [depth if depth < 0.99 * PICTURE_FAR else 0.0 for depth in chosen]


def depth_disagreement(one: list[float], other: list[float]) -> float:
    """The share of depths that differ by more than 1 %."""
    if len(one) != len(other):
        return 1.0
    return sum(abs(a - b) > 0.01 * max(a, b) for a, b in zip(one, other, strict=True)) / len(one)
