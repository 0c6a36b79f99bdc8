"""How bodies stand at the start: their lowest points, overlaps, and robots that are raised out of the ground.

Thin ground is no obstacle to a robot that lies on both sides of it: the contacts above and below keep the robot inside,
and push it aside. A robot with few collision shapes, such as those of its feet, may even touch nothing there. The
origin of many robots with legs is in their trunk; at height 0 their legs are below the floor.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.files import model_of
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from morse.physics.bodies import Bodies
    from morse.physics.model.layout import Frame, Slot
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
    contact = _contacts(state)
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


def _contacts(state: EngineState) -> Any:
    """Return the contacts at the poses that components have given to bodies since the model was compiled.

    They are those of a copy: the first tick begins with the contacts of the model.
    """
    if not state.touched:
        return state.data.contact
    data = mujoco.MjData(state.model)
    data.qpos[:], data.mocap_pos[:], data.mocap_quat[:] = state.data.qpos, state.data.mocap_pos, state.data.mocap_quat
    mujoco.mj_fwdPosition(state.model, data)
    return data.contact


def _message(depths: dict[tuple[str, str], float], advice: str) -> str:
    if not depths:
        return ""
    pairs = sorted(depths.items(), key=lambda item: -item[1])
    listing = ", ".join(f"'{a}' and '{b}' by {depth:.2g} m" for (a, b), depth in pairs[:_NAMED])
    more = f" and {len(pairs) - _NAMED} more pairs" if len(pairs) > _NAMED else ""
    return f"objects overlap at the start, and part slowly: {listing}{more}{advice}"


def below_the_floor(state: EngineState) -> tuple[str, SourceLine | None]:
    """Return a message about the robots that have fixed objects above them, but nothing below; empty if there are none.

    Such robots fall for ever. So do all robots that stand, in a world without a floor, which the message says. The
    second value is the line of the script that created the first of them.
    """
    if state.model.opt.gravity[2] >= 0.0:
        return "", None
    robots = [slot for slot in state.slots if slot.frame.robot is not None and slot.frame.motion is Motion.FREE]
    low, line = list[str](), None
    falling: list[Slot] = []
    for slot in robots[:_ROBOTS]:
        if _hit(state, slot, -1.0) is not None:
            continue
        above = _hit(state, slot, 1.0)
        if above is not None and not _moves(above[1]):
            line = line or slot.frame.node.line
            low.append(f"'{slot.frame.node.name}' by {above[0]:.2g} m")
        elif _needs_floor(state, slot):
            falling.append(slot)
    if low:
        return f"robots start below the floor, and fall: {', '.join(low)}; set them above it", line
    if falling and len(falling) == len([slot for slot in robots if _needs_floor(state, slot)]):
        names = ", ".join(f"'{slot.frame.node.name}'" for slot in falling)
        return f"the world has no floor below its robots, which fall: {names}", falling[0].frame.node.line
    return "", line


def _needs_floor(state: EngineState, slot: Slot) -> bool:
    """Whether a robot stands or drives; others may fly."""
    index = state.slot_of[slot.frame.node]
    is_driven = bool(slot.frame.node.properties.get("GroundRobot")) or index in state.wheels or _is_of_file(slot.frame)
    is_heavy = slot.frame.node.body.gravity and not slot.frame.node.properties.get("NoGravity")
    return is_driven and is_heavy and bottom_of(state, slot.frame.node) is not None


def _hit(state: EngineState, slot: Slot, up: float) -> tuple[float, Frame] | None:
    """Return the distance to what is above or below the centre of a robot, m, and the body that it is; None if nothing.

    The parts of the robot do not count.
    """
    origin, geom = np.array(state.data.xipos[slot.body]), np.full(1, -1, dtype=np.int32)
    way, direction = 0.0, np.array([0.0, 0.0, up])
    for _ in range(_MOST_HITS):
        point = origin + way * direction
        distance = float(mujoco.mj_ray(state.model, state.data, point, direction, None, 1, slot.body, geom))
        if distance < 0.0:
            return None
        way += distance
        frame = _frame(state, int(geom[0]))
        if frame is not slot.frame:
            return way, frame
        way += _APART
    return None


def _frame(state: EngineState, geom: int) -> Frame:
    """Return the body of a shape; for a wheel or a link, the robot."""
    return state.slots[state.slot_of[state.geom_node[geom]]].frame.root


def _moves(frame: Frame) -> bool:
    return frame.motion is not Motion.FIXED


def _name(frame: Frame, node: Node) -> str:
    return frame.node.name if _moves(frame) else node.name


def bottom_of(state: EngineState, node: Node) -> float | None:
    """Return the height of the lowest point of a body with wheels and links, m; None if it has no collision shapes."""
    lowest = lowest_of(state, node)
    return None if lowest is None else lowest[0]


def lowest_of(state: EngineState, node: Node) -> tuple[float, int] | None:
    """Return the height of the lowest point of a body with wheels and links, m, and the geom that has it."""
    own = state.slots[state.slot_of[node]]
    slots = [state.slots[index] for index in state.attached.get(state.slot_of[node], ())]
    geoms = [geom for slot in (own, *slots) for numbers in slot.geoms.values() for geom in numbers]
    return min(((_lowest(state, geom), geom) for geom in geoms if state.model.geom_contype[geom]), default=None)


def _lowest(state: EngineState, geom: int) -> float:
    a, b, c = (float(size) for size in state.model.geom_size[geom])
    up_x, up_y, up_z = up = tuple(float(part) for part in state.data.geom_xmat[geom][6:])
    height = float(state.data.geom_xpos[geom][2])
    kind = int(state.model.geom_type[geom])
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = int(state.model.geom_dataid[geom])
        first, count = int(state.model.mesh_vertadr[mesh]), int(state.model.mesh_vertnum[mesh])
        return height + float(matmul(state.model.mesh_vert[first : first + count], up).min())
    if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
        return height - a
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return height - math.hypot(a * up_x, b * up_y, c * up_z)
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return height - a * math.hypot(up_x, up_y) - b * abs(up_z)
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return height - a - b * abs(up_z)
    return height - a * abs(up_x) - b * abs(up_y) - c * abs(up_z)


def lowest_shape(state: EngineState) -> tuple[float, bool]:
    """Return the height of the lowest point of all collision shapes at their present poses, m.

    Infinity if there are none; an endless plane that is level has one height, another one minus infinity. The second
    value is whether any of the shapes stands still.
    """
    model, data = state.model, state.data
    solid = (model.geom_contype | model.geom_conaffinity) != 0
    # these planes represent the top faces of boxes, and end where the boxes end
    solid[list(state.planes.values())] = False
    if not solid.any():
        return math.inf, False
    rows = data.geom_xmat[solid].reshape(-1, 3, 3)[:, 2]
    centre, half = model.geom_aabb[solid, :3], model.geom_aabb[solid, 3:]
    heights = data.geom_xpos[solid, 2] + (rows * centre).sum(1) - (np.abs(rows) * half).sum(1)
    planes = model.geom_type[solid] == mujoco.mjtGeom.mjGEOM_PLANE
    level = np.abs(rows[:, 2]) > 1.0 - 1e-9
    heights[planes] = np.where(level, data.geom_xpos[solid, 2], -math.inf)[planes]
    return float(heights.min()), bool((model.body_weldid[model.geom_bodyid[solid]] == 0).any())


#: depth of the bottom of a robot below the ground that it touches, beyond which the contacts cannot be trusted to push
#: the robot out, m
_SUNKEN = 0.15
#: depth that the contacts correct, m
_SHALLOW = 0.02
_STEP = 0.02
#: shapes that a ray passes at most, and distance behind one from which it goes on, m
_MOST_HITS, _APART = 100, 1e-4
#: vertical part of the normal of a contact with the ground
_UPWARD = 0.7


def raise_sunken(state: EngineState, bodies: Bodies) -> bool:
    """Raise robots whose bottom is deep inside fixed bodies, by the height of their origin over their bottom at most.

    A robot that overlaps something higher, such as a wall, keeps its pose.

    Returns:
        Whether the pose of any robot has changed; the contacts are then those of the new poses.
    """
    # without gravity, nothing stands on the ground
    if state.model.opt.gravity[2] >= 0.0:
        return False
    sunken = _sunken(state)
    below = _below_thin_ground(state)
    sunken |= {index: bottom for index, (bottom, _) in below.items()}
    if not sunken:
        return False
    starts = {index: tuple(state.positions[index]) for index in sunken}
    limits = {index: starts[index][2] - bottom + _SUNKEN for index, bottom in sunken.items()}
    lifted = set(sunken)
    for count in range(1, int(max(limits.values()) / _STEP) + 1):
        for index in lifted:
            x, y, z = starts[index]
            if index in below:
                bottom, ground = below[index]
                z += ground - bottom
            bodies.place(index, (x, y, z + count * _STEP), state.rotations[index])
        mujoco.mj_kinematics(state.model, state.data)
        mujoco.mj_collision(state.model, state.data)
        lifted = {index for index in lifted & _overlapping(state, _SHALLOW).keys() if limits[index] > count * _STEP}
        if not lifted:
            break
    for index in starts.keys() & _overlapping(state, _SHALLOW).keys():
        bodies.place(index, starts[index], state.rotations[index])
    return True


def raised(state: EngineState) -> tuple[str, SourceLine | None]:
    """Return a message about the robots that `raise_sunken` has raised; empty if there are none.

    The second value is the line of the script that created the first of them.

    Call it before the first tick.
    """
    robots, line = list[str](), None
    for index, slot in enumerate(state.slots):
        height = state.positions[index][2] - slot.pose.position[2] if _stands(state, index) else 0.0
        if height >= _STEP / 2:
            line = line or slot.frame.node.line
            robots.append(f"'{slot.frame.node.name}' by {height:.2g} m")
    mend = "; translate them up in the script"
    return f"robots start inside the ground, and are put on it: {', '.join(robots)}{mend}" if robots else "", line


def _sunken(state: EngineState) -> dict[int, float]:
    """Return the robots that are deep inside the ground, and the height of their bottom, m."""
    bottoms = {}
    for index, (depth, height) in _overlapping(state, _SHALLOW).items():
        frame = state.slots[index].frame
        bottom = bottom_of(state, frame.node)
        if bottom is not None and (depth > _SUNKEN or (_is_of_file(frame) and height - bottom > _SUNKEN)):
            bottoms[index] = bottom
    return bottoms


def _below_thin_ground(state: EngineState) -> dict[int, tuple[float, float]]:
    """Return the robots of files with their bottom below a fixed body and their origin above it.

    They may touch nothing, or only with what is higher, such as the thighs of straight legs.

    Returns:
        The index of each robot to the heights of its bottom and of the ground below its origin, m.
    """
    robots: dict[int, tuple[float, float]] = {}
    for index, slot in enumerate(state.slots):
        if slot.frame.motion is not Motion.FREE or not _is_of_file(slot.frame):
            continue
        lowest = lowest_of(state, slot.frame.node)
        x, y, z = (float(value) for value in state.positions[index])
        if lowest is None or z - lowest[0] <= _SUNKEN:
            continue
        ground = _fixed_height(state, (x, y, z + _SHALLOW), -1.0)
        foot = state.data.geom_xpos[lowest[1]]
        ceiling = _fixed_height(state, (float(foot[0]), float(foot[1]), float(foot[2])), 1.0)
        if ground is not None and ceiling is not None and lowest[0] + _SUNKEN < ground and ceiling <= ground + _SHALLOW:
            robots[index] = lowest[0], ground
    return robots


def _fixed_height(state: EngineState, origin: tuple[float, float, float], up: float) -> float | None:
    """Return the height at which a vertical ray hits the first fixed body, m; it passes through all others."""
    point, geom = np.array(origin), np.full(1, -1, dtype=np.int32)
    for _ in range(_MOST_HITS):
        distance = float(mujoco.mj_ray(state.model, state.data, point, np.array([0.0, 0.0, up]), None, 1, -1, geom))
        if distance < 0.0:
            return None
        point[2] += up * distance
        node = state.geom_node[int(geom[0])]
        is_solid = bool(state.model.geom_contype[geom[0]] or state.model.geom_conaffinity[geom[0]])
        if is_solid and state.slots[state.slot_of[node]].frame.root.motion is Motion.FIXED:
            return float(point[2])
        point[2] += up * _APART
    return None


def _overlapping(state: EngineState, depth: float) -> dict[int, tuple[float, float]]:
    """Return the robots that overlap a fixed body by more than a depth, m.

    Returns:
        The index of each robot to the largest depth, and the height of the highest level contact, m.
    """
    contact = state.data.contact
    deep = np.nonzero(np.asarray(contact.dist) < -depth)[0].tolist()
    robots: dict[int, tuple[float, float]] = {}
    for number in deep:
        frames = [state.slots[state.slot_of[state.geom_node[geom]]].frame.root for geom in contact.geom[number]]
        for one, other in (frames, frames[::-1]):
            index = state.slot_of[one.node]
            if other.motion is Motion.FIXED and _stands(state, index):
                is_level = abs(contact.frame[number][2]) > _UPWARD
                most, height = robots.get(index, (0.0, -np.inf))
                level = float(contact.pos[number][2]) if is_level else -np.inf
                robots[index] = max(most, -float(contact.dist[number])), max(height, level)
    return robots


def _stands(state: EngineState, index: int) -> bool:
    """Whether a body is a robot of a file, or a ground robot without joints."""
    frame = state.slots[index].frame
    is_ground_robot = bool(frame.node.properties.get("GroundRobot")) and index not in state.attached
    return frame.motion is Motion.FREE and (is_ground_robot or _is_of_file(frame))


def _is_of_file(frame: Frame) -> bool:
    """Whether a body is a robot from a URDF, MJCF or SDF file without a floor, to which its pose would refer."""
    settings = frame.node.articulation
    has_floor = settings is not None and settings.model is not None and settings.model.has_floor
    return frame.robot is not None and settings is not None and not has_floor
