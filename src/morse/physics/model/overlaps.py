"""Robots and other bodies that overlap at the start, and robots below the floor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.model.file_models import model_of
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.physics.model.layout import Frame
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node, SourceLine

#: minimum depth of a reported overlap, m; objects that were placed on a floor by hand overlap it by less
_DEEP = 0.03
#: number of pairs in a message; number of robots that are searched for below a floor
_NAMED, _ROBOTS = 20, 200


def overlaps(state: EngineState) -> tuple[tuple[str, SourceLine | None], str]:
    """Return two messages about the pairs of overlapping objects, the deepest first; empty if there are none.

    Call it before the first tick.

    Returns:
        A message about robots and about pairs of objects that move, with the line of the script that created an object
        of the deepest pair; and one about objects that lie in what is fixed, such as crates in hills.
    """
    serious, others = dict[tuple[str, str], float](), dict[tuple[str, str], float]()
    lines: dict[tuple[str, str], SourceLine | None] = {}
    of_files = False
    contact = state.data.contact
    for (a, b), distance in zip(contact.geom.tolist(), contact.dist.tolist(), strict=True):
        frames = _frame(state, a), _frame(state, b)
        pair = (_name(frames[0], state.geom_node[a]), _name(frames[1], state.geom_node[b]))
        # one order of the names, whichever shapes of the two touch
        if pair[::-1] in serious or pair[::-1] in others:
            pair = pair[::-1]
        if distance <= -_DEEP and pair[0] != pair[1]:
            is_serious = any(frame.robot for frame in frames) or all(map(_moves, frames))
            depths = serious if is_serious else others
            of_files = of_files or (is_serious and any(model_of(frame) is not None for frame in frames))
            depths[pair] = max(depths.get(pair, 0.0), -distance)
            # the object that was created last is the one to move
            lines[pair] = max(
                (line for frame in frames if (line := frame.node.line)), key=lambda line: line.line, default=None
            )
    deepest = max(serious, key=serious.__getitem__, default=None)
    line = None if deepest is None else lines[deepest]
    speed = "; those of MJCF files part as fast as in MuJoCo" if of_files else ""
    return (_message(serious, f"{speed}; move one object of each pair"), line), _message(others, "")


def _message(depths: dict[tuple[str, str], float], advice: str) -> str:
    if not depths:
        return ""
    pairs = sorted(depths.items(), key=lambda item: -item[1])
    listing = ", ".join(f"'{a}' and '{b}' by {depth:.2g} m" for (a, b), depth in pairs[:_NAMED])
    more = f" and {len(pairs) - _NAMED} more pairs" if len(pairs) > _NAMED else ""
    return f"objects overlap at the start, and part slowly: {listing}{more}{advice}"


def below_the_floor(state: EngineState) -> tuple[str, SourceLine | None]:
    """Return a message about the robots that have fixed objects above them, but nothing below; empty if there are none.

    Such robots fall for ever. The second value is the line of the script that created the first of them.
    """
    if state.model.opt.gravity[2] >= 0.0:
        return "", None
    robots = [slot for slot in state.slots if slot.frame.robot is not None and slot.frame.motion is Motion.FREE]
    low, line = list[str](), None
    for slot in robots[:_ROBOTS]:
        origin, geom = np.array(state.data.xipos[slot.body]), np.full(1, -1, dtype=np.int32)
        if _ray(state, origin, -1.0, slot.body, geom) >= 0.0:
            continue
        height = _ray(state, origin, 1.0, slot.body, geom)
        if height >= 0.0 and not _moves(_frame(state, int(geom[0]))):
            line = line or slot.frame.node.line
            low.append(f"'{slot.frame.node.name}' by {height:.2g} m")
    return f"robots start below the floor, and fall: {', '.join(low)}; set them above it" if low else "", line


def _ray(state: EngineState, origin: NDArray[np.float64], up: float, body: int, geom: NDArray[np.int32]) -> float:
    """Return the distance to what is above or below a point, m; negative if there is nothing."""
    return float(mujoco.mj_ray(state.model, state.data, origin, np.array([0.0, 0.0, up]), None, 1, body, geom))


def _frame(state: EngineState, geom: int) -> Frame:
    """Return the body of a shape; for a wheel or a link, the robot."""
    return state.slots[state.slot_of[state.geom_node[geom]]].frame.root


def _moves(frame: Frame) -> bool:
    return frame.motion is not Motion.FIXED


def _name(frame: Frame, node: Node) -> str:
    return frame.node.name if _moves(frame) else node.name
