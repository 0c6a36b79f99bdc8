"""Contacts of people and robots: limited forces on both, and how hard they are.

A body is a spring between a robot and the mass of the person, with the constants and the limits of ISO/TS 15066:2016,
annex A: the peak of a free impact is v sqrt(mu k), with the reduced mass mu (A.3.4). People are no walls: they are
moved.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.plugins.people.wayfinding import hull
from morse.scene import PhysicsType
from morse.scene.extent import corners
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from morse.core.world import Body
    from morse.scene import Node

    Floats = NDArray[np.float64]


class Region(NamedTuple):
    """A region of the body, by ISO/TS 15066:2016, tables A.2 and A.3.

    Attributes:
        name: of the region.
        top: share of the height of the body up to which it reaches.
        stiffness: N/m.
        mass: kg, effective.
        pressing, impact: N, permissible forces, quasi-static and transient; None where an impact is not permissible.
    """

    name: str
    top: float
    stiffness: float
    mass: float
    pressing: float
    impact: float | None


REGIONS = (
    Region("lower legs", 0.285, 60e3, 75.0, 130.0, 260.0),
    Region("thighs and knees", 0.48, 50e3, 75.0, 220.0, 440.0),
    Region("pelvis", 0.58, 25e3, 40.0, 180.0, 360.0),
    Region("abdomen", 0.68, 10e3, 40.0, 110.0, 220.0),
    Region("chest", 0.80, 25e3, 40.0, 140.0, 280.0),
    Region("neck", 0.87, 50e3, 1.2, 150.0, 300.0),
    Region("skull and face", 1.0, 75e3, 4.4, 65.0, None),
)


def regions(low: float, high: float, height: float) -> tuple[Region, ...]:
    """Return the regions of a body of a height that something between two heights above the floor meets, m."""
    bottom, met = 0.0, []
    for region in REGIONS:
        top = region.top * height
        if low < top and high > bottom:
            met.append(region)
        bottom = top
    return tuple(met)


class Footprint(NamedTuple):
    """What a robot covers of the floor, in its own axes.

    Attributes:
        outline: (V, 2) convex, counter-clockwise, m.
        low, high: heights of its lowest and its highest point above its origin, m.
        discs: (D, 3) centres and radii, m: circles that cover the outline.
    """

    outline: Floats
    low: float
    high: float
    discs: Floats


class Mover(NamedTuple):
    """A robot that people may see and touch."""

    body: Body
    print: Footprint
    seen: NDArray[np.bool_]


def is_placed(node: Node) -> bool:
    """Whether explicit calls move a body that others touch."""
    return node.body.type is PhysicsType.KINEMATIC and node.body.collides


def footprint(node: Node, bodies: Iterable[Node]) -> Footprint | None:
    """Return the footprint of a robot; None if it has no shapes.

    Args:
        node: of the robot.
        bodies: with the shapes of the robot, at their poses in the scene.
    """
    own = rigid_frame(node)
    turn = np.array([[float(v) for v in row] for row in own.rotation])
    clouds = []
    for body in bodies:
        frame = rigid_frame(body)
        position = np.array([float(v) for v in frame.position])
        rotation = np.array([[float(v) for v in row] for row in frame.rotation])
        clouds += [corners(shape, position, rotation) for shape in body.shapes or () if shape.heights is None]
    if not clouds:
        return None
    apart = np.concatenate(clouds) - np.array([float(v) for v in own.position])
    points = np.stack([(apart * turn[:, axis]).sum(axis=1) for axis in range(3)], axis=1)
    outline = hull(points[:, :2])
    if len(outline) < 3:
        return None
    return Footprint(outline, float(points[:, 2].min()), float(points[:, 2].max()), _discs(outline))


def _discs(outline: Floats) -> Floats:
    low, high = outline.min(axis=0), outline.max(axis=0)
    size = high - low
    long = int(size.argmax())
    count = min(max(1, round(size[long] / max(size[1 - long], 0.1))), 8)
    part = size[long] / count
    discs = np.zeros((count, 3))
    discs[:, 1 - long] = 0.5 * (low[1 - long] + high[1 - long])
    discs[:, long] = low[long] + part * (np.arange(count) + 0.5)
    discs[:, 2] = 0.5 * math.hypot(part, size[1 - long])
    return discs


def nearest(outline: Floats, point: Floats) -> tuple[float, Floats, Floats]:
    """Return the distance (m, negative within) of a point to a convex outline, the nearest place, and the way out."""
    a, b = outline, np.roll(outline, -1, axis=0)
    way = b - a
    share = np.clip(((point - a) * way).sum(axis=1) / np.maximum((way * way).sum(axis=1), 1e-12), 0.0, 1.0)
    places = a + share[:, None] * way
    apart = point - places
    distances = np.sqrt((apart * apart).sum(axis=1))
    best = int(distances.argmin())
    side = way[:, 0] * (point[1] - a[:, 1]) - way[:, 1] * (point[0] - a[:, 0])
    within = bool((side >= 0.0).all())
    outward = np.array([way[best, 1], -way[best, 0]])
    outward = outward / max(math.hypot(*outward.tolist()), 1e-12)
    if not within and distances[best] > 1e-9:
        outward = apart[best] / distances[best]
    return (-float(distances[best]) if within else float(distances[best])), places[best], outward


#: steps of the spring within a tick
_PARTS = 32


def press(
    overlap: float, closing: float, seconds: float, region: Region, robot_mass: float, body_mass: float
) -> tuple[float, float]:
    """Return the impulse (N s) and the peak of the force (N) of a contact during a tick.

    Args:
        overlap: m, at the beginning; negative for a gap.
        closing: m/s, speed at which they approach each other.
        seconds: of the tick.
        region: of the body.
        robot_mass: kg; infinite for a robot whose drive does not yield.
        body_mass: kg, of the person.
    """
    inverse = 1.0 / body_mass + (0.0 if math.isinf(robot_mass) else 1.0 / robot_mass)
    step, impulse, peak = seconds / _PARTS, 0.0, 0.0
    for _ in range(_PARTS):
        force = region.stiffness * max(overlap, 0.0)
        closing -= step * force * inverse
        overlap += step * closing
        impulse += step * force
        peak = max(peak, force)
    return impulse, peak
