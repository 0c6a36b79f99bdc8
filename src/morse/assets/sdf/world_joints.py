"""Joints that connect a model with the world, declared in the world."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets.sdf.scope import MODEL, SEPARATOR, WORLD, FrameMistakeError, end_of
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from morse.assets.sdf.scope import Scope

_ENDS = ("parent", "child")


def move_into_models(world: Scope) -> None:
    """Move these joints into their models, where a joint to the world means the same."""
    for name, part in list(world.joints.items()):
        ends = {tag: end_of(part, tag) for tag in _ENDS}
        others = [tag for tag in _ENDS if ends[tag] != WORLD]
        if len(others) != 1:
            continue
        try:
            head, separator, link = world.link_of(ends[others[0]]).partition(SEPARATOR)
            pose = world.pose_of(head).inverted() @ world.pose_of(name)
        except FrameMistakeError:
            continue
        if not separator:
            continue
        element = deepcopy(part.element)
        end = element.find(others[0])
        if end is None:
            continue
        end.text = link
        joints = world.models[head].joints
        own = free_name(name, joints.__contains__)
        joints[own] = replace(part, name=own, element=element, home=MODEL, pose=pose, base=MODEL)
        del world.joints[name]
