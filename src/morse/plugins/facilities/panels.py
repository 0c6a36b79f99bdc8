"""Panels: boxes, discs and arcs that components move, each on its own, as one set."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any
from weakref import WeakKeyDictionary

import numpy as np

from morse.assets.solids import cube, cylinder, polyhedron
from morse.core.declarations import DataField, data_fields, state_variables
from morse.core.exceptions import MorseError
from morse.core.reports.quoting import short
from morse.core.robot import Robot
from morse.core.services import service
from morse.core.state import StateError
from morse.core.validation.arguments import Range
from morse.core.values import Fields
from morse.mathutils.portable import matmul
from morse.mathutils.rotations import quaternion_from_rotation
from morse.scene import BodySettings, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind
from morse.scene.extent import extent

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.interfaces import Carrier
    from morse.core.values import StateData
    from morse.core.world import Body

    Floats = NDArray[np.float64]

#: m: a person, or the middle of a robot, that is that near to a panel is in its way; so is a mesh of a robot
_NEAR, _BESIDE = 0.45, 0.05
#: angle of a hinged door that is open, rad
_WIDE = math.radians(95.0)
#: angle of one of the convex pieces of an arc, rad
_WEDGE = math.radians(7.5)
#: m: nearer shapes touch
_TOUCHING = 0.005

BeltSpeed = Annotated[float, Range(-10.0, 10.0, "m/s")]


def panel(name: str, size: Sequence[float], color: Sequence[float]) -> Node:
    """Return a box of a size (x, y, z), m, around its origin, which explicit calls move."""
    box = cube()
    half = np.array(size, dtype=np.float64) / 2.0
    red, green, blue = color
    material = Material(f"{name} paint", color=(red, green, blue, 1.0), roughness=0.5)
    corners = (box.vertices * half).astype(np.float32)
    mesh = Mesh(name, corners, box.triangles, box.material_index, materials=(material,))
    node = Node(name, NodeKind.MESH, mesh=mesh, body=BodySettings(type=PhysicsType.KINEMATIC))
    node.shapes = [CollisionShape(ShapeKind.BOX, tuple(half.tolist()))]
    return node


def disc(name: str, radius: float, thickness: float, color: Sequence[float]) -> Node:
    """Return a disc about the Z axis, m, around its origin, which explicit calls move."""
    node = panel(name, (2.0 * radius, 2.0 * radius, thickness), color)
    round_one = cylinder()
    assert node.mesh is not None
    corners = (round_one.vertices * np.array([radius, radius, 0.5 * thickness])).astype(np.float32)
    node.mesh = Mesh(name, corners, round_one.triangles, round_one.material_index, materials=node.mesh.materials)
    node.shapes = [CollisionShape(ShapeKind.CYLINDER, (radius, 0.5 * thickness))]
    return node


def arc(name: str, radii: tuple[float, float], thickness: float, angle: float, color: Sequence[float]) -> Node:
    """Return a part of a ring about the Z axis, around the height of its origin, which explicit calls move.

    Args:
        radii: the inner and the outer one, m.
        thickness: along Z, m.
        angle: from the X axis to its end, rad; negative to the right.
    """
    node = panel(name, (1.0, 1.0, thickness), color)
    count = max(2, math.ceil(abs(angle) / _WEDGE))
    turns = np.linspace(0.0, angle, count + 1)[:: 1 if angle > 0.0 else -1]
    # a chord cuts the outer circle: the arc is as wide as asked for at the middle of each wedge
    outer = radii[1] / math.cos(0.5 * abs(angle) / count)
    rays = np.array([(math.cos(one), math.sin(one)) for one in turns.tolist()])
    ring = np.concatenate([radii[0] * rays, outer * rays])
    flat = np.concatenate([np.c_[ring, np.full(len(ring), 0.5 * side * thickness)] for side in (-1.0, 1.0)])
    size = len(turns)
    faces: list[tuple[int, ...]] = [(0, size, 3 * size, 2 * size), (size - 1, 3 * size - 1, 4 * size - 1, 2 * size - 1)]
    shapes = []
    for k in range(count):
        a, b, c, d = k, k + 1, size + k, size + k + 1
        top = [2 * size + one for one in (a, b, c, d)]
        faces += [
            *((a, b, d, c), (top[0], top[2], top[3], top[1])),
            *((a, top[0], top[1], b), (c, d, top[3], top[2])),
        ]
        corners = flat[[a, b, c, d, *top]]
        shapes.append(CollisionShape(ShapeKind.CONVEX, (), vertices=corners))
    faces[1] = faces[1][::-1]
    mesh = polyhedron(name, [tuple(point) for point in flat.tolist()], faces)
    assert node.mesh is not None
    mesh.materials = node.mesh.materials
    node.mesh, node.shapes = mesh, shapes
    return node


def ghost(node: Node) -> Node:
    """Let nothing collide with a node: it is only seen."""
    node.body.type, node.shapes = PhysicsType.NO_COLLISION, []
    return node


def cabinet(
    name: str, count: int, size: tuple[float, float, float], color: Sequence[float]
) -> tuple[list[Node], list[list[float]]]:
    """Return the walls of a cabinet behind the origin, and the places of boxes in it, the uppermost ones first.

    Args:
        count: number of boxes.
        size: of a box, m.
    """
    layers = max(1, round((count * size[0] * size[1] / size[2] ** 2) ** (1.0 / 3.0)))
    across = math.ceil(math.sqrt(count / layers * size[0] / size[1]))
    deep = math.ceil(count / (layers * across))
    pitch = (size[0] + 0.02, size[1] + 0.02, size[2] + 0.001)
    inner = (deep * pitch[0] + 0.02, across * pitch[1] + 0.02, layers * pitch[2] + 0.05)
    front, middle = -0.5 * size[0] - 0.1, -0.5 * size[0] - 0.12 - 0.5 * inner[0]
    walls = []
    for own, sides, place in (
        ("bottom", (inner[0], inner[1], 0.05), (middle, 0.0, 0.025)),
        ("roof", (inner[0] + 0.04, inner[1] + 0.04, 0.02), (middle, 0.0, 0.06 + inner[2])),
        ("front", (0.02, inner[1] + 0.04, inner[2] + 0.05), (front - 0.01, 0.0, 0.025 + 0.5 * inner[2])),
        ("back", (0.02, inner[1] + 0.04, inner[2] + 0.05), (front - 0.03 - inner[0], 0.0, 0.025 + 0.5 * inner[2])),
        ("left", (inner[0], 0.02, inner[2] + 0.05), (middle, 0.5 * inner[1] + 0.01, 0.025 + 0.5 * inner[2])),
        ("right", (inner[0], 0.02, inner[2] + 0.05), (middle, -0.5 * inner[1] - 0.01, 0.025 + 0.5 * inner[2])),
    ):
        wall = panel(f"{name} {own}", sides, color)
        wall.body.type, wall.location = PhysicsType.STATIC, [*place]
        walls.append(wall)
    places = [
        [
            front - 0.03 - (column + 0.5) * pitch[0],
            (row + 0.5 - 0.5 * across) * pitch[1],
            0.0505 + layer * pitch[2] + 0.5 * size[2],
        ]
        for layer in range(layers)
        for column in range(deep)
        for row in range(across)
    ]
    return walls, places[:count][::-1]


def flight_of_steps(
    name: str, rise: float, steps: int, tread: float, width: float, colors: Sequence[Sequence[float]]
) -> list[Node]:
    """Return the solid steps and the rails of stairs along the X axis, which nothing moves.

    Args:
        name: of the stairs.
        rise: m, of all steps.
        steps: their number; the last one is the upper floor.
        tread: m, depth of a step.
        width: m, between the rails.
        colors: of the steps and of the rails.
    """
    parts = []
    for number in range(steps - 1):
        height = rise * (number + 1) / steps
        box = panel(f"{name} step {number}", (tread, width, height), colors[0])
        box.location = [(number + 0.5) * tread, 0.0, 0.5 * height]
        parts.append(box)
    run = tread * (steps - 1)
    slope = math.atan2(rise, run)
    for side, word in ((1.0, "left"), (-1.0, "right")):
        rail = panel(f"{name} {word} rail", (math.hypot(rise, run), 0.05, 0.06), colors[1])
        rail.location = [0.5 * run, side * (0.5 * width + 0.025), 0.5 * rise + 0.95]
        rail.rotation_euler = [0.0, -slope, 0.0]
        parts.append(rail)
        for number in range(0, steps - 1, 4):
            post = panel(f"{name} {word} post {number}", (0.04, 0.04, 0.95), colors[1])
            bottom = rise * (number + 1) / steps
            post.location = [(number + 0.5) * tread, side * (0.5 * width + 0.025), bottom + 0.45]
            parts.append(post)
    for one in parts:
        one.body.type = PhysicsType.STATIC
    return parts


class Panels:
    """The panels of a component, in the frame of its node at the start.

    Args:
        owner: the body of the component.
    """

    def __init__(self, context: Context, owner: Body) -> None:
        self._context = context
        nodes = [node for node in owner.node.children if node.body.type is PhysicsType.KINEMATIC]
        self._bodies = [context.world.object_of(node) for node in nodes]
        self._rows = context.world.kinematic_bodies(self._bodies)
        self.count = len(nodes)
        #: (N, 3) of their centres at the start
        self.start = np.array([node.location for node in nodes], dtype=np.float64)
        position, rotation = owner.world_pose()
        self.origin = np.array(position, dtype=np.float64)
        self.axes = np.reshape(np.array(rotation, dtype=np.float64), (3, 3))
        self._turn = quaternion_from_rotation(tuple(rotation))  # type: ignore[arg-type]
        #: corners (8, 3) of boxes around robots, in their frames
        self._boxes: WeakKeyDictionary[Carrier, Floats] = WeakKeyDictionary()

    def place(self, positions: Floats, angles: Floats, axis: int = 2) -> None:
        """Set the panels.

        Args:
            positions: (N, 3) of their centres in the frame of the component, m.
            angles: (N,) about one of its axes, rad.
            axis: 0 for its X axis, 2 for its Z axis.
        """
        world = self.origin + matmul(positions, self.axes.T)
        w, x, y, z = self._turn
        turned = [(math.cos(half), math.sin(half)) for half in (0.5 * angles).tolist()]
        if axis == 0:
            rows = [(w * c - x * s, w * s + x * c, y * c + z * s, z * c - y * s) for c, s in turned]
        else:
            rows = [(w * c - z * s, x * c + y * s, y * c - x * s, w * s + z * c) for c, s in turned]
        self._rows.place(world, np.array(rows))

    def move_surfaces(self, linear: Floats, turning: Floats) -> None:
        """Let the surfaces of the panels move during the next tick, as belts do.

        Args:
            linear: (N, 3) velocities at the origins of the panels in the frame of the component, m/s.
            turning: (N,) angular velocities about its Z axis, rad/s.
        """
        self._rows.move_surfaces(matmul(linear, self.axes.T), turning[:, None] * self.axes[:, 2])

    def objects_on(self, number: int) -> list[str]:
        """Return the names of what moves freely and touches a panel."""
        near = self._context.world.touched_by(self._bodies[number], _TOUCHING)
        return sorted(one.name for one in near if one.is_dynamic)

    def is_touched(self, number: int, margin: float) -> bool:
        """Whether something that moves is nearer than a margin, m, to the shape of a panel."""
        return any(one.is_dynamic for one in self._context.world.touched_by(self._bodies[number], margin))

    def present(self, height: float = 0.0) -> Floats:
        """Return the places (M, 2) of robots and people on a floor, in the frame of the component, m.

        Args:
            height: of the floor above the component, m; who is up to 2 m above it is on it.
        """
        points = [np.zeros((0, 3))]
        for robot in self._context.robots.values():
            if isinstance(robot, Facility):
                continue
            people = _people(robot)
            points.append(np.reshape(robot.bge_object.world_pose()[0], (1, 3)) if people is None else people)
        own = matmul(np.concatenate(points) - self.origin, self.axes)
        return np.asarray(own[(own[:, 2] > height - 0.5) & (own[:, 2] < height + 2.0), :2])

    def is_in_way(self, people: Floats, low: Sequence[float], high: Sequence[float]) -> bool:
        """Whether somebody is in a box, or near it.

        Args:
            people: see `present`.
            low, high: (3,) corners of the box in the frame of the component, m.
        """
        if ((people > np.array(low[:2]) - _NEAR) & (people < np.array(high[:2]) + _NEAR)).all(axis=1).any():
            return True
        robots = [robot for robot in self._context.robots.values() if not isinstance(robot, Facility)]
        return any(_people(robot) is None and self._is_robot_in(robot, low, high) for robot in robots)

    def _is_robot_in(self, robot: Carrier, low: Sequence[float], high: Sequence[float]) -> bool:
        """Whether the box around a robot meets another one: no axis of their faces separates them, seen from above."""
        if robot not in self._boxes:
            node = robot.bge_object.node
            corners = extent(node.walk(), node)
            own = np.zeros((0, 3)) if corners is None else np.array([*product(*zip(*corners, strict=True))])
            self._boxes[robot] = own
        if not len(self._boxes[robot]):
            return False
        position, rotation = robot.bge_object.world_pose()
        turn = matmul(self.axes.T, np.reshape(rotation, (3, 3)))
        corners = matmul(self._boxes[robot], turn.T) + matmul(np.array(position) - self.origin, self.axes)
        lower, upper = np.array(low) - _BESIDE, np.array(high) + _BESIDE
        if corners[:, 2].max() < lower[2] or corners[:, 2].min() > upper[2]:
            return False
        box = np.array([*product((lower[0], upper[0]), (lower[1], upper[1]))])
        normals = np.concatenate([np.eye(2), np.stack([-turn[1], turn[0]], axis=1)])
        a, b = matmul(corners[:, :2], normals.T), matmul(box, normals.T)
        return bool(((a.max(axis=0) >= b.min(axis=0)) & (a.min(axis=0) <= b.max(axis=0))).all())


class Facility(Robot):
    """What does not count as a robot: it does not open doors."""

    @service(changes=False)
    def get_local_data(self) -> Fields:
        """The present data."""
        return dict(self.local_data)

    def set_state(self, state: StateData) -> None:
        """Restore a state; see `Object.set_state`.

        Raises:
            StateError: a value is missing, or a number is none, or out of the range of its field.
        """
        if missing := sorted(self.get_state().keys() - state.keys()):
            raise StateError(f"'{missing[0]}' of {self.name()} is missing")
        fields, data = data_fields(type(self)), state.get("local_data")
        for name, value in data.items() if isinstance(data, dict) else ():
            if isinstance(value, float) and name in fields and not _is_within(value, fields[name]):
                raise StateError(f"the field '{name}' of {self.name()} is {value:g}")
        for name in state_variables(type(self)):
            value = state.get(name)
            if isinstance(value, float) and math.isnan(value):
                raise StateError(f"'{name}' of {self.name()} is {value:g}")
        super().set_state(state)


def _is_within(value: float, field: DataField) -> bool:
    low = -math.inf if field.low is None else field.low
    high = math.inf if field.high is None else field.high
    return low <= value <= high and (math.isfinite(value) or "inf" in field.allow)


def stored(owner: object, name: str, text: object, fits: Callable[[Any], object]) -> Any:
    """Return what the class of a scene script has written into a property, as JSON.

    Args:
        fits: whether a value is what the class writes; it may raise an error for what is not.

    Raises:
        MorseError: a script has set the property to something else.
    """
    try:
        value = json.loads(str(text))
        if fits(value):
            return value
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError, OverflowError):
        pass
    kind = type(owner).__name__
    raise MorseError(f"the property '{name}' is {short(text)}: leave it as {kind}() writes it, and use its arguments")


def check_numbers(owner: Facility, state: StateData, name: str, count: int) -> None:
    """Refuse a state with a list of other numbers than 0 to ``count - 1``, each of them once.

    Raises:
        StateError: it has such a list.
    """
    values: Any = state.get(name, [])
    is_list = isinstance(values, list) and all(type(one) is int and 0 <= one < count for one in values)
    if not is_list or len({*values}) < len(values):
        raise StateError(f"'{name}' of the {type(owner).__name__} are not different numbers from 0 to {count - 1}")


def are_lengths(values: Any) -> bool:
    """Whether values are several finite numbers that are not negative."""
    return isinstance(values, list) and all(isinstance(one, (int, float)) and 0.0 <= one < 1e6 for one in values)


def _people(robot: Carrier) -> Floats | None:
    """Return the places (N, 3) of the people of a crowd, m; None for what is no crowd."""
    data = robot.local_data
    if "present" not in data or "positions" not in data:
        return None
    positions: Floats = np.reshape(np.asarray(data["positions"], dtype=np.float64), (-1, 3))
    return np.asarray(positions[np.asarray(data["present"], dtype=bool)])


def door_places(kind: str, width: float, height: float, openness: float) -> tuple[Floats, Floats]:
    """Return positions (N, 3), m, and angles (N,), rad, of the panels of a hinged, sliding or double door."""
    middle = 0.5 * height
    if kind == "hinged":
        angle = -_WIDE * openness
        # the hinge is at y = -width / 2; the panel extends from it to the left
        x, y = -0.5 * width * math.sin(angle), -0.5 * width + 0.5 * width * math.cos(angle)
        return np.array([[x, y, middle]]), np.array([angle])
    if kind == "sliding":
        return np.array([[0.0, width * openness, middle]]), np.zeros(1)
    apart = 0.25 * width + 0.5 * width * openness
    return np.array([[0.0, -apart, middle], [0.0, apart, middle]]), np.zeros(2)


def gate_place(width: float, height: float, openness: float) -> tuple[list[float], float]:
    """Return the position (3), m, of the middle of the arm of a gate, and its angle about the X axis, rad."""
    angle = 0.5 * math.pi * openness
    hinge = -0.5 * width
    return [0.0, hinge + 0.5 * width * math.cos(angle), height + 0.5 * width * math.sin(angle)], angle


#: the lights of a traffic light, from above
LENSES = {"red": (1.0, 0.05, 0.03), "yellow": (1.0, 0.7, 0.0), "green": (0.05, 1.0, 0.25)}


def lenses(name: str, height: float) -> list[Node]:
    """Return the lenses of a traffic light: dark ones, and bright ones in front of them that are hidden.

    Args:
        height: of the uppermost lens, m.
    """
    found = []
    for row, (own, color) in enumerate(LENSES.items()):
        for bright in (False, True):
            paint = color if bright else tuple(0.18 * part for part in color)
            lens = ghost(disc(f"{name} {own}{' on' if bright else ''}", 0.11, 0.02, paint))
            lens.rotation_euler = [0.0, 0.5 * math.pi, 0.0]
            lens.location = [0.11 + 0.005 * bright, 0.0, height - 0.28 * row]
            if bright:
                assert lens.mesh is not None
                lens.visible = False
                lens.mesh.materials = tuple(replace(one, shadeless=True) for one in lens.mesh.materials if one)
            found.append(lens)
    return found


def lift_places(levels: Sequence[float], cabin: Sequence[float], height: float, openness: float) -> Floats:
    """Return positions (N, 3), m: floor, walls and doors of the cabin, and two doors of each floor.

    Args:
        levels: heights of the floors, m.
        cabin: depth, width and height, m.
        height: of the cabin above the lowest floor, m.
        openness: of the doors of the cabin, and of the floor where it stands.
    """
    depth, width, tall = cabin
    middle, closed = 0.5 * tall, 0.25 * width
    apart = closed + 0.5 * width * openness
    rows = [
        (0.0, 0.0, height - 0.05),
        (-0.5 * depth + 0.025, 0.0, height + middle),
        (0.0, 0.5 * width - 0.025, height + middle),
        (0.0, -0.5 * width + 0.025, height + middle),
        (0.5 * depth - 0.02, -apart, height + middle),
        (0.5 * depth - 0.02, apart, height + middle),
    ]
    for level in levels:
        own = apart if level == height else closed
        rows += [(0.5 * depth + 0.04, -own, level + middle), (0.5 * depth + 0.04, own, level + middle)]
    return np.array(rows)


def belt_panels(
    name: str,
    size: tuple[float, float, float],
    turn: float,
    colors: tuple[Sequence[float], Sequence[float]],
    *,
    rails: bool,
) -> list[Node]:
    """Return the panels of a conveyor at their places: the belt, two stands, and rails.

    Args:
        size: length, width and height, m.
        turn: see `morse.plugins.facilities.builder.Conveyor`.
        colors: of the belt and of the rest.
    """
    length, width, height = size
    dark, paint = colors
    radius = length / turn if turn else 0.0
    side = math.copysign(1.0, turn)

    def part(own: str, low: float, high: float, top: float, thickness: float, color: Sequence[float]) -> Node:
        """Return a strip along the belt, between two distances to the left of its middle."""
        if not turn:
            node = panel(f"{name} {own}", (length, high - low, thickness), color)
            node.location = [0.5 * length, 0.5 * (low + high), top - 0.5 * thickness]
            return node
        radii = (abs(radius) + side * low * -1.0, abs(radius) + side * high * -1.0)
        node = arc(f"{name} {own}", (min(radii), max(radii)), thickness, turn, color)
        # an arc begins on the X axis of its node: turned so that the belt begins at the origin, along +X
        node.location = [0.0, radius, top - 0.5 * thickness]
        node.rotation_euler = [0.0, 0.0, -0.5 * math.pi * side]
        return node

    parts = [part("belt", -0.5 * width, 0.5 * width, height, 0.06, dark)]
    low = height - 0.07
    for number, share in enumerate((0.08, 0.92)):
        stand = panel(f"{name} stand {number}", (0.06, 0.8 * width, low), paint)
        angle = share * turn
        along = (share * length, 0.0) if not turn else (radius * math.sin(angle), radius * (1.0 - math.cos(angle)))
        stand.location, stand.rotation_euler = [*along, 0.5 * low], [0.0, 0.0, angle]
        parts.append(stand)
    if rails:
        for own, edge in (("left rail", 0.5 * width), ("right rail", -0.5 * width - 0.03)):
            parts.append(part(own, edge, edge + 0.03, height + 0.06, 0.12, paint))
    return parts


def approach(value: float, target: float, step: float) -> float:
    """Return a value that has come nearer to another one by a step at most."""
    return target if abs(target - value) <= step else value + math.copysign(step, target - value)


def travel(
    place: float, speed: float, target: float, limits: tuple[float, float], period: float
) -> tuple[float, float]:
    """Return the place, m, and the speed, m/s, after a tick: as fast as allowed, and so that it stops at the target.

    Args:
        place, speed: before the tick.
        target: m.
        limits: speed, m/s, and acceleration, m/s^2.
        period: of a tick, s.
    """
    most, acceleration = limits
    way = target - place
    sign = math.copysign(1.0, way)
    rate = sign * speed + acceleration * period
    if rate > 0.0:
        # the speed from which it can just stop: v^2 / (2 a) = way
        rate = min(rate, math.sqrt(2.0 * acceleration * abs(way)), most)
        if rate * period >= abs(way):
            return target, 0.0
    return place + sign * rate * period, sign * rate
