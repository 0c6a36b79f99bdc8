"""Robots and other bodies that overlap at the start.

Objects of a world model that overlap its ground, such as crates on hills, are not reported.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from morse.physics.model.layout import Frame
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node

#: minimum depth of a reported overlap, m; objects that were placed on a floor by hand overlap it by less
_DEEP = 0.03
_NAMED = 5


def overlaps(state: EngineState) -> str:
    """Return a message about the pairs of overlapping objects, the deepest first; empty if there are none.

    Call it before the first tick.
    """
    depths: dict[tuple[str, str], float] = {}
    contact = state.data.contact
    for (a, b), distance in zip(contact.geom.tolist(), contact.dist.tolist(), strict=True):
        frames = _frame(state, a), _frame(state, b)
        if distance > -_DEEP or not (any(frame.robot for frame in frames) or all(map(_moves, frames))):
            continue
        pair = (_name(frames[0], state.geom_node[a]), _name(frames[1], state.geom_node[b]))
        if pair[0] != pair[1]:
            depths[pair] = max(depths.get(pair, 0.0), -distance)
    if not depths:
        return ""
    pairs = sorted(depths.items(), key=lambda item: -item[1])
    listing = ", ".join(f"'{a}' and '{b}' by {depth:.2g} m" for (a, b), depth in pairs[:_NAMED])
    more = f" and {len(pairs) - _NAMED} more pairs" if len(pairs) > _NAMED else ""
    return f"objects overlap at the start, and will be pushed apart: {listing}{more}; move one object of each pair"


def _frame(state: EngineState, geom: int) -> Frame:
    """Return the body of a shape; for a wheel or a link, the robot."""
    frame = state.slots[state.slot_of[state.geom_node[geom]]].frame
    while frame.parent is not None:
        frame = frame.parent
    return frame


def _moves(frame: Frame) -> bool:
    return frame.motion is not Motion.FIXED


def _name(frame: Frame, node: Node) -> str:
    return frame.node.name if _moves(frame) else node.name
