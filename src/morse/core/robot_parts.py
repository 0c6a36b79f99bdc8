"""The links of an armature as moving parts, with the names of its file."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.mathutils.rotations import nine, product, turn_back
from morse.scene import JointKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator, Sequence

    from morse.core.world import Body
    from morse.helpers.chain import Chain, Pose


CONTINUOUS, REVOLUTE, PRISMATIC = "continuous", "revolute", "prismatic"
FIXED, FLOATING = "fixed", "floating"


class MovingPart(NamedTuple):
    """A part that a joint moves.

    Attributes:
        joint: name of the joint; messages of the kind ``joints`` use the same one.
        object: the part in the world.
        parent: the object relative to which it moves; None for the body of the robot.
        axis: (3,) unit vector along or about which it moves, in the frame of the part.
        position: function that returns the present joint value, rad or m.
        type: type of the joint in URDF: ``continuous``, ``revolute`` or ``prismatic``; ``fixed``; or ``floating`` for
            any other motion.
        low, high: limits, rad or m.
        frame: name of the part in its file; empty for a part that is named after its joint.
        offset: (3,) m, origin of the frame of the part, which is on its joint, in the frame of its object.
        mimic: the joint that this one follows, factor and offset; or None.
    """

    joint: str
    object: Body
    parent: Body | None
    axis: tuple[float, float, float]
    position: Callable[[], float]
    type: str = CONTINUOUS
    low: float = -math.pi
    high: float = math.pi
    frame: str = ""
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mimic: tuple[str, float, float] | None = None


#: property of targets of inverse kinematics, which are not links
_TARGET = "IK_Bone"
#: tolerance, m
_NEAR = 1e-9


class _Link(NamedTuple):
    """An object on a bone; -1 for the armature itself."""

    object: Body
    bone: int


def link_parts(
    armature: Body, chain: Chain, values: Callable[[], Sequence[float]], components: Container[str] = ()
) -> list[MovingPart]:
    """Return the links of an armature, parents before their children.

    Each link has the frame of its object. If its joint is not on the origin of the object, the origin of the frame is
    moved to the joint.

    Args:
        armature: the object of the armature.
        chain: the bones of the armature.
        values: function that returns the present joint values, rad or m.
        components: names of objects that are not links.
    """
    links = list(_links(armature, chain, components))
    frames = chain.frames(chain.start)
    moving = [index for index, bone in enumerate(chain.linked) if bone.kind.has_value]
    parts: list[MovingPart] = []
    first: dict[int, Body] = {}
    for link in links:
        above, path = link.bone, []
        while above >= 0 and above not in first:
            path.append(above)
            above = chain.bones[above].parent
        parent = first.get(above)
        joints = [index for index in path if index in moving or chain.bones[index].kind.is_loose]
        first.setdefault(link.bone, link.object)
        name = link.object.node.plain_name
        if len(joints) != 1 or chain.bones[joints[0]].kind.is_loose:
            kind = FLOATING if joints else FIXED
            joint = chain.bones[path[0]].name if path and len(joints) < 2 else f"{name}_{kind}"
            parts.append(MovingPart(joint, link.object, parent, (1.0, 0.0, 0.0), float, kind, frame=name))
            continue
        parts.append(_moved(armature, link, parent, joints[0], chain, frames, moving.index(joints[0]), values))
    return parts


def _links(armature: Body, chain: Chain, components: Container[str]) -> Iterator[_Link]:
    """Iterate over the objects that are links: all named objects of a file, otherwise the first object on each bone."""
    in_file = any(bone.dynamics is not None for bone in chain.bones)
    on: dict[int, list[Body]] = {}
    for child in armature.children:
        properties = child.node.properties
        if _TARGET in properties or child.name in components or "Component_Tag" in properties:
            continue
        index = chain.index(child.node.bone) if child.node.bone else -1
        if index is not None and (in_file or index >= 0):
            on.setdefault(index, []).append(child)
    for index in sorted(on):
        for child in on[index] if in_file else on[index][:1]:
            yield _Link(child, index)


def _moved(
    armature: Body,
    link: _Link,
    parent: Body | None,
    index: int,
    chain: Chain,
    frames: Sequence[Pose],
    number: int,
    values: Callable[[], Sequence[float]],
) -> MovingPart:
    """The part that one joint moves."""
    bone, (anchor, bone_rotation) = chain.bones[index], frames[index]
    # computed at the joint values of the file, because an object does not move relative to its bone
    place, rotation = _at_start(link, armature)
    axis = turn_back(rotation, (bone_rotation[bone.axis], bone_rotation[bone.axis + 3], bone_rotation[bone.axis + 6]))
    away = turn_back(rotation, tuple(a - b for a, b in zip(anchor, place, strict=True)))
    along = sum(a * b for a, b in zip(away, axis, strict=True))
    slides = bone.kind is JointKind.PRISMATIC
    beside = [a - along * b for a, b in zip(away, axis, strict=True)]
    offset = away if not slides and math.hypot(*beside) > _NEAR else (0.0, 0.0, 0.0)
    leader = chain.bones[bone.leader].name if bone.leader >= 0 else ""
    return MovingPart(
        bone.name,
        link.object,
        parent,
        (axis[0], axis[1], axis[2]),
        lambda: chain.bone_values(values())[number],
        PRISMATIC if slides else REVOLUTE,
        bone.low,
        bone.high,
        frame=link.object.node.plain_name,
        offset=(offset[0], offset[1], offset[2]),
        mimic=(leader, bone.factor, bone.offset) if leader else None,
    )


def _at_start(link: _Link, armature: Body) -> tuple[Sequence[float], Sequence[float]]:
    """The pose of an object in the armature at the joint values of the scene."""
    outer, inner = rigid_frame(armature.node), rigid_frame(link.object.node)
    base, place = nine(list(outer.rotation)), [b - a for a, b in zip(outer.position, inner.position, strict=True)]
    back = (base[0], base[3], base[6], base[1], base[4], base[7], base[2], base[5], base[8])
    return turn_back(base, place), product(back, nine(list(inner.rotation)))
