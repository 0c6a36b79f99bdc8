"""The messages between nodes and server: JSON lines, as in MORSE 1.4.

A node sends ``[node, {robot: [[x, y, z], [roll, pitch, yaw]], "__time": [simulated, step, wall clock]}]``. The server
answers with the poses of all other robots, ``{robot: [[x, y, z], [roll, pitch, yaw]]}``; positions are in the world, m,
angles in rad.
"""

from __future__ import annotations

import math

import msgspec

Pose = tuple[tuple[float, float, float], tuple[float, float, float]]
Poses = dict[str, Pose]

#: maximum bytes of a line
MAX_LINE = 1 << 20
#: maximum characters of a name
MAX_NAME = 256
#: names that begin so are not robots
_RESERVED = "__"

_encoder = msgspec.json.Encoder()
_state = msgspec.json.Decoder(tuple[str, dict[str, msgspec.Raw]])
_answer = msgspec.json.Decoder(dict[str, msgspec.Raw])
_pose = msgspec.json.Decoder(Pose)


def written_state(node: str, poses: Poses, time: tuple[float, float, float]) -> bytes:
    """Return the line of a node."""
    return bytes(_encoder.encode((node, {**poses, "__time": time}))) + b"\n"


def written_answer(poses: Poses) -> bytes:
    """Return the line of the server."""
    return bytes(_encoder.encode(poses)) + b"\n"


def read_state(line: bytes) -> tuple[str, Poses]:
    """Return the name of a node and the poses of its robots.

    Raises:
        ValueError: the line is not such a message.
    """
    try:
        node, robots = _state.decode(line)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    if not 0 < len(node) <= MAX_NAME:
        raise ValueError(f"the name of a node has 1 to {MAX_NAME} characters, not {len(node)}")
    return node, {name: read_pose(name, pose) for name, pose in robots.items() if not name.startswith(_RESERVED)}


def read_answer(line: bytes) -> dict[str, msgspec.Raw]:
    """Return the poses of robots that other nodes simulate; `read_pose` reads each of them.

    Raises:
        ValueError: the line is not such a message.
    """
    try:
        poses = _answer.decode(line)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    return {name: pose for name, pose in poses.items() if not name.startswith(_RESERVED)}


def read_pose(name: str, text: msgspec.Raw) -> Pose:
    """Return a pose.

    Raises:
        ValueError: it is not [[x, y, z], [roll, pitch, yaw]] with finite numbers, or the name is too long.
    """
    if len(name) > MAX_NAME:
        raise ValueError(f"the name of a robot has {len(name)} characters; {MAX_NAME} are allowed")
    try:
        pose: Pose = _pose.decode(text)
    except (msgspec.MsgspecError, RecursionError):
        raise ValueError(f"the pose of {name!r:.60} is not [[x, y, z], [roll, pitch, yaw]]") from None
    if not all(map(math.isfinite, (*pose[0], *pose[1]))):
        raise ValueError(f"the pose of {name!r:.60} does not consist of finite numbers")
    return pose
