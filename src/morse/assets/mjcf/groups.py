"""Divides the bodies of an MJCF model into the robot and other objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError

if TYPE_CHECKING:
    from pathlib import Path

    from morse.assets.mjcf.model import ModelData

#: maximum number of bodies, and maximum depth of the tree of bodies
MOST_BODIES, _DEEPEST = 10_000, 200


@dataclass(frozen=True, slots=True)
class Group:
    """Bodies that become one robot or object.

    Attributes:
        tops: those below the world.
        bodies: all, parents first.
        base: the body with the free joint, or None for bodies that are fixed to the world.
    """

    tops: tuple[int, ...]
    bodies: tuple[int, ...]
    base: int | None


def groups_of(model: ModelData, path: Path) -> list[Group]:
    """Return the groups of a model, the robot first.

    Each free body is a group, and all fixed bodies together. The robot is the group with most joints; of several, a
    free one.

    Raises:
        AssetError: there are too many bodies, or they are nested too deeply.
    """
    bodies, joints = model.bodies, model.joints
    if len(bodies) > MOST_BODIES:
        raise AssetError(path, f"it has {len(bodies)} bodies, more than {MOST_BODIES}")
    top_of, depth = {0: 0}, {0: 0}
    members: dict[int, list[int]] = {}
    for index in range(1, len(bodies)):
        parent = bodies[index].parent
        top_of[index] = top = index if parent == 0 else top_of[parent]
        depth[index] = depth[parent] + 1
        if depth[index] > _DEEPEST:
            raise AssetError(path, f"the tree of bodies is deeper than {_DEEPEST}")
        members.setdefault(top, []).append(index)
    free = [top for top in members if any(joints[joint].kind == "free" for joint in bodies[top].joints)]
    anchors = [top for top in members if top not in free]
    groups = [Group((top,), tuple(members[top]), top) for top in free]
    if anchors:
        groups.append(Group(tuple(anchors), tuple(index for top in anchors for index in members[top]), None))

    def count(group: Group) -> int:
        return sum(joints[joint].kind != "free" for body in group.bodies for joint in bodies[body].joints)

    return sorted(groups, key=lambda group: -count(group))
