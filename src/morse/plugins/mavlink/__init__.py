"""Autopilots and ground stations: MAVLink 2."""

from __future__ import annotations

from morse.core.declarations import Option
from morse.middleware.registry import Middleware

#: default ports of ground stations, and of MAVSDK
DEVICE = "udpout:127.0.0.1:14550,udpout:127.0.0.1:14540"
_DEVICE = "udpout:, udpin:, tcp: or tcpin: with address and port; several separated by commas"

MANAGER_OPTIONS = {
    "device": Option(str, DEVICE, f"destination of the messages: {_DEVICE}"),
    "world": Option(str, "nwu", "axes of the world: X north and Y west, or X east and Y north", choices=("nwu", "enu")),
    "hil": Option(bool, False, "all sensors of a robot in HIL_SENSOR and HIL_GPS, for an autopilot in the loop"),
    "vehicle": Option(int, 0, "MAV_TYPE, such as 2 for a quadrotor, 10 for a rover; 0: by the robot", low=0, high=255),
}
STREAM_OPTIONS = {
    "device": Option(str, None, f"device of this stream: {_DEVICE}"),
    "system_id": Option(int, None, "system id of the robot; by default, robots are numbered from 1", low=1, high=255),
    "full": Option(float, None, "for motors: value of the control 1.0; default: the upper limit of the field"),
}

MIDDLEWARE = Middleware(
    name="mavlink",
    stream_manager="morse.middleware.mavlink_datastream.MavlinkDatastreamManager",
    manager_options=MANAGER_OPTIONS,
    stream_options=STREAM_OPTIONS,
    default_publisher="morse.plugins.mavlink.vehicle.MavlinkStream",
    default_reader="morse.plugins.mavlink.vehicle.MavlinkStream",
    # MAVLink has no messages for images and point clouds
    not_carried=("Camera", "CameraUnit", "StereoUnit", "MocapControl"),
    modules=("pymavlink",),
    extra="mavlink",
    purpose="vehicles of MAVLink, with an autopilot",
    in_place_of=("pprzlink",),
)
