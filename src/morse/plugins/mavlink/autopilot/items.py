"""Items of missions, read from messages and checked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.framing import MavlinkMessage

#: MAV_CMD
WAYPOINT, LOITER, LOITER_TIME, RETURN, LAND, TAKEOFF = 16, 17, 19, 20, 21, 22
DELAY, CONDITION_DELAY, CONDITION_YAW, JUMP, SPEED, HOME = 93, 112, 115, 177, 178, 179
#: cameras and gimbals look where they look: these have no effect
ROI, ROI_LOCATION, ROI_NONE, MOUNT, GIMBAL = 201, 195, 197, 205, 1000
#: photos: by distance, the mode of the camera, at intervals, no more
CAMERA = (206, 530, 2000, 2001)
NOWHERE = (
    *(DELAY, CONDITION_DELAY, CONDITION_YAW, JUMP, SPEED, HOME, ROI, ROI_LOCATION, ROI_NONE, MOUNT, GIMBAL),
    *CAMERA,
)
PLACES = (WAYPOINT, LOITER, LOITER_TIME, LAND, TAKEOFF)
SUPPORTED = (*PLACES, RETURN, *NOWHERE)
#: frames: above the sea, above home, the last of which is above the terrain, and north-east-down from the origin
_SEA, _HOME, _LOCAL, _NONE = (0, 5), (3, 6, 10, 11), (1,), 2
#: MAV_MISSION_RESULT
ACCEPTED, ERROR, BAD_FRAME, UNSUPPORTED, NO_SPACE, INVALID = 0, 1, 2, 3, 4, 5
INVALID_PARAM = (6, 7, 8, 9)
INVALID_X, INVALID_Y, INVALID_Z, INVALID_SEQUENCE, DENIED, CANCELLED = 10, 11, 12, 13, 14, 15
_HIGHEST = 1e6


class Item(NamedTuple):
    """One item, as MISSION_ITEM_INT has it.

    Attributes:
        frame: MAV_FRAME.
        command: MAV_CMD.
        autocontinue: as it was sent.
        params: the first four.
        x, y: 1e-7 degrees, or 1e-4 m.
        z: m.
    """

    frame: int
    command: int
    autocontinue: int
    params: tuple[float, float, float, float]
    x: int
    y: int
    z: float


def item_of(message: MavlinkMessage, others: Sequence[int] = ()) -> Item | int:
    """Read MISSION_ITEM_INT or MISSION_ITEM; MAV_MISSION_RESULT if it is not valid or not supported.

    Args:
        message: what has arrived.
        others: the supported commands of plans that are not missions; each has a place.
    """
    params = (message.param1, message.param2, message.param3, message.param4)
    x, y = message.x, message.y
    has_place = message.command in (others or (*PLACES, HOME))
    if message.get_type() == "MISSION_ITEM":
        scale = 1e4 if message.frame in _LOCAL else 1e7
        if has_place and not (abs(x * scale) < 1 << 31 and abs(y * scale) < 1 << 31):
            return INVALID_Y if abs(x * scale) < 1 << 31 else INVALID_X
        x, y = (round(v * scale) if abs(v * scale) < 1 << 31 else 0 for v in (x, y))
    item = Item(message.frame, message.command, message.autocontinue, params, x, y, message.z)
    return fault_of(item, others) or item


def fault_of(item: Item, others: Sequence[int] = ()) -> int:
    """MAV_MISSION_RESULT of an item that is not valid or not supported, else 0; see `item_of`."""
    if item.command not in (others or SUPPORTED):
        return UNSUPPORTED
    if item.command in (others or (*PLACES, HOME)):
        if item.frame not in (*_SEA, *_HOME, *(() if others else _LOCAL)):
            return BAD_FRAME
        if item.frame not in _LOCAL and not (abs(item.x) <= 900_000_000 and abs(item.y) <= 1_800_000_000):
            return INVALID_Y if abs(item.x) <= 900_000_000 else INVALID_X
        if not abs(item.z) < _HIGHEST:
            return INVALID_Z
    for number, value in enumerate(item.params):
        if math.isinf(value) or abs(value) > 1e9:
            return INVALID_PARAM[number]
    if item.command == JUMP and math.isnan(item.params[0] + item.params[1]):
        return INVALID_PARAM[0]
    return ACCEPTED


def destination(item: Item, place: Place, home: Triple, here: Triple) -> Triple:
    """The position of an item in the world, m; zeros as latitude and longitude mean the present one, as with PX4."""
    if item.frame in _LOCAL:
        return place.world((item.x * 1e-4, item.y * 1e-4, item.z))
    latitude, longitude, _ = place.earth(here)
    if (item.x, item.y) != (0, 0):
        latitude, longitude = item.x * 1e-7, item.y * 1e-7
    altitude = item.z + (place.earth(home)[2] if item.frame in _HOME else 0.0)
    return place.from_earth(latitude, longitude, altitude)
