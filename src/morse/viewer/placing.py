"""Where a page puts a model: an object beside what is there, a component on a robot or on an arm."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.builder.assembly.spawning import Mount, mount_of
from morse.builder.components.actuators_with_parts import PTU
from morse.core.exceptions import MorseError
from morse.mathutils import Euler, Matrix
from morse.mathutils.rotations import compatible_euler, rotation_from_quaternion
from morse.scene.extent import extent, visible_extent

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from numpy.typing import NDArray

    from morse.scene import ComponentDeclaration, Node
    from morse.scene.extent import Corners
    from morse.simulation.simulation import Simulation

Triple = tuple[float, float, float]
#: a surface whose normal, in the frame of the robot, rises or falls by more than this is a top or a bottom, no side
_TOP = 0.7

#: free space around an object that is put beside others, and the distance of the places that are tried, m
_GAP = 0.15
_RING = 0.3
_MOST_RINGS = 60
#: what is wider is the ground or a building, not an object that stands on the ground, m
_ROOM = 5.0


class Place(NamedTuple):
    """A pose for a component.

    Attributes:
        owner: name of the robot or of the component that carries it.
        part: name of the part of the owner to which it is attached; empty for the usual one.
        position, angles: in the frame of what carries it: m, Euler angles XYZ in rad.
    """

    owner: str
    part: str = ""
    position: Triple = (0.0, 0.0, 0.0)
    angles: Triple = (0.0, 0.0, 0.0)


def can_carry(declaration: ComponentDeclaration) -> bool:
    """Whether components are attached to it: to robots, arms and pan-tilt units."""
    is_arm = declaration.kind == "actuator" and bool(declaration.node.bones)
    return declaration.kind == "robot" or is_arm or declaration.classpath == PTU._classpath


def carrier_of(simulation: Simulation, name: str, is_known: Callable[[str], bool]) -> ComponentDeclaration:
    """The robot, the arm or the pan-tilt unit to which a node belongs.

    Args:
        name: of the node.
        is_known: whether a name is that of something that has a variable of its own in the script; what comes with the
            model of a robot has none, and its robot stands for it.

    Raises:
        MorseError: the node belongs to none of them.
    """
    node = simulation.scene.find(name)
    declared = {one.node: one for one in simulation.scene.components}
    above: list[Node] = [] if node is None else [node, *node.ancestors()]
    carriers = [declared[one] for one in above if one in declared and can_carry(declared[one])]
    found = next((one for one in carriers if one.kind == "robot" or is_known(one.name)), None)
    if found is None or found.robot.name not in simulation.context.robots:
        raise MorseError("drop a sensor or an actuator on a robot")
    return found


def usual_place(simulation: Simulation, carrier: ComponentDeclaration, group: str) -> Place:
    """An actuator is in the origin of its robot, a sensor stands on it; both are at the tip of an arm."""
    mount = mount_of(carrier)
    if carrier.kind != "robot":
        return Place(carrier.name, "", triple(mount.usual))
    corners = extent((one for one in carrier.node.walk() if one.visible), carrier.node)
    if group == "actuators" or corners is None:
        return Place(carrier.name)
    low, high = corners
    return Place(carrier.name, "", (float(low[0] + high[0]) / 2, float(low[1] + high[1]) / 2, float(high[2])))


def place_at(
    simulation: Simulation,
    carrier: ComponentDeclaration,
    name: str,
    point: Sequence[float],
    normal: Sequence[float],
    box: Corners | None,
    angles: Triple,
) -> Place:
    """The pose of a component that stands on a surface at a point, and looks ahead, or away from a side.

    Args:
        name: the node whose surface it is.
        point, normal: of the surface, in the world, m.
        box: the component from its origin, m; None if it is not seen: then it is in the surface.
        angles: those at which it looks ahead, rad.

    Raises:
        MorseError: the normal has no direction.
    """
    node = simulation.scene.find(name)
    assert node is not None
    size = float(np.linalg.norm(normal))
    if size < 1e-9:
        raise MorseError(f"there is no surface with the normal {', '.join(f'{one:g}' for one in normal)}")
    part = _part(carrier, node)
    frame = _frame(simulation, mount_of(carrier, part))
    ahead, _, up = np.array(simulation.world.object_of(carrier.robot).worldOrientation).T
    away = np.asarray(normal, float) / size
    is_side = abs(float(away @ up)) < _TOP
    z = up - (up @ away) * away if is_side else away if away @ up > 0.0 else up
    x = away if is_side else ahead - (ahead @ z) * z
    x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
    turn = np.stack([x, np.cross(z, x), z], axis=1) @ np.array(Euler([*angles]).to_matrix(), float)
    below = 0.0 if box is None else float(box[0][0] if is_side else box[0][2] if away @ up > 0.0 else -box[1][2])
    origin = np.asarray(point, float) - below * away
    return Place(carrier.name, part, *_pose_in(frame, origin, turn, angles))


def local_pose(
    simulation: Simulation, node: Node, position: Sequence[float], quaternion: Sequence[float], near: Sequence[float]
) -> tuple[Triple, Triple]:
    """The pose of an object or a component for the script: in the world, or in the frame of what carries it.

    Args:
        position, quaternion: its pose in the world, m; w, x, y, z.
        near: the angles are the closest ones to these, rad.
    """
    rotation = rotation_from_quaternion(*quaternion)
    if node.parent is None:
        return triple(position), triple(compatible_euler(rotation, "XYZ", list(near)))
    frame = _frame(simulation, Mount(node.parent, node.parent_inverse))
    return _pose_in(frame, np.asarray(position, float), np.array(rotation, float).reshape(3, 3), near)


def world_pose(
    simulation: Simulation, node: Node, position: Sequence[float], angles: Sequence[float]
) -> tuple[list[float], list[float]]:
    """The pose in the world, m and w, x, y, z, for that of a script; see `local_pose`."""
    turn = Euler([*angles]).to_matrix()
    if node.parent is None:
        return [*position], [*turn.to_quaternion()]
    frame = _frame(simulation, Mount(node.parent, node.parent_inverse))
    origin = frame @ np.array([*position, 1.0])
    rotation = frame[:3, :3] @ np.array(turn, float)
    return origin[:3].tolist(), [*Matrix(rotation.tolist()).to_quaternion()]


def _part(carrier: ComponentDeclaration, node: Node) -> str:
    """The link to which a node belongs; empty if it moves as the carrier itself, or is a part of a pan-tilt unit."""
    if carrier.classpath == PTU._classpath:
        return ""
    below = [one for one in (node, *node.ancestors()) if carrier.node in one.ancestors()]
    links = [one for one in below if one.bone or (carrier.node.bones and one.parent is carrier.node)]
    return links[0].plain_name if links else ""


def _frame(simulation: Simulation, mount: Mount) -> NDArray[np.float64]:
    """4x4 to the world of the frame in which the pose of a component is given."""
    world = np.array(simulation.world.object_of(mount.node).worldTransform, float)
    return world if mount.turn is None else world @ np.array(mount.turn, float)


def _pose_in(
    frame: NDArray[np.float64],
    origin: NDArray[np.float64],
    turn: NDArray[np.float64],
    near: Sequence[float] = (0.0, 0.0, 0.0),
) -> tuple[Triple, Triple]:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, origin
    local = np.linalg.inv(frame) @ pose
    a, b, c, d, e, f, g, h, i = (float(value) for value in local[:3, :3].flat)
    angles = compatible_euler((a, b, c, d, e, f, g, h, i), "XYZ", list(near))
    return triple(local[:3, 3]), triple(angles)


def triple(values: Sequence[float] | NDArray[np.float64]) -> Triple:
    """Return three numbers as a tuple."""
    x, y, z = (float(value) for value in values)
    return x, y, z


def rounded(values: Sequence[float], decimals: int = 4) -> Triple:
    """Return three rounded numbers."""
    x, y, z = (round(value, decimals) for value in values)
    return x, y, z


def free_place(simulation: Simulation, point: Triple, box: Corners, added: Collection[str]) -> Triple:
    """The place nearest to a point where an object is not on or in another one.

    Args:
        point: m.
        box: the object from its origin, m.
        added: names of objects that pages have added: they are no part of a room.
    """
    x, y, z = point
    robots = {one.robot for one in simulation.scene.components}
    tops = {next(iter([*robot.ancestors()][::-1]), robot).name for robot in robots}
    movable = tops | {*added}
    things: list[Corners] = []
    others: list[Corners] = []
    for root in simulation.scene.roots:
        if (found := visible_extent(root)) is not None:
            length, width, height = found[1] - found[0]
            is_ground = max(length, width) > _ROOM or height < _GAP
            (others if is_ground and root.name not in movable else things).append(found)

    def is_at(low: NDArray[np.float64], high: NDArray[np.float64], corners: Corners) -> bool:
        """Whether a rectangle lies over or under a box."""
        return bool((low[:2] < corners[1][:2]).all() and (high[:2] > corners[0][:2]).all())

    here = np.array([x, y])
    # what is pointed at stands on the ground itself, or on something that does
    z = min([z, *(float(thing[0][2]) for thing in things if is_at(here - _GAP, here + _GAP, thing))])
    tall = float(box[1][2] - box[0][2])
    # the ground and the room in which the point lies are no obstacles
    walls = [
        wall
        for wall in others
        if wall[1][2] > z + _GAP and wall[0][2] < z + tall and not is_at(here - _GAP, here + _GAP, wall)
    ]
    for ring in range(_MOST_RINGS):
        for turn in range(max(1, 6 * ring)):
            angle = math.tau * turn / max(1, 6 * ring)
            place = here + ring * _RING * np.array([math.cos(angle), math.sin(angle)])
            low, high = place + box[0][:2] - _GAP, place + box[1][:2] + _GAP
            if not any(is_at(low, high, corners) for corners in (*things, *walls)):
                return float(place[0]), float(place[1]), z
    return point
