"""The topics of these senses with the messages of ROS 2 (entry point ``morse.ros_messages``).

The types are those of the packages radar_msgs, marine_acoustic_msgs and event_camera_msgs; if a backend does not have a
package, the data are a ``std_msgs/String`` of JSON, or no message.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.rosmsgs.parts import as_json, header, time, xyz
from morse.rosmsgs.table import Outlet, RosExtension, TopicTable, topics

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import RosMessage
    from morse.rosmsgs.table import Carrier

_MESSAGES = """
radar_msgs/RadarReturn: float32 range, float32 azimuth, float32 elevation, float32 doppler_velocity, float32 amplitude
radar_msgs/RadarScan: std_msgs/Header header, radar_msgs/RadarReturn[] returns
marine_acoustic_msgs/Dvl: std_msgs/Header header, uint8 velocity_mode, uint8 dvl_type,
    geometry_msgs/Vector3 velocity, float64[9] velocity_covar, float64 altitude, float64 course_gnd, float64 speed_gnd,
    uint8 num_good_beams, float64 sound_speed, bool beam_ranges_valid, bool beam_velocities_valid,
    geometry_msgs/Vector3[4] beam_unit_vec, float64[4] range, float64[4] range_covar, float64[4] beam_quality,
    float64[4] beam_velocity, float64[4] beam_velocity_covar
marine_acoustic_msgs/PingInfo: float32 frequency, float32 sound_speed, float32[] tx_beamwidths, float32[] rx_beamwidths
marine_acoustic_msgs/SonarImageData: bool is_bigendian, uint32 dtype, uint32 beam_count, uint8[] data
marine_acoustic_msgs/ProjectedSonarImage: std_msgs/Header header, marine_acoustic_msgs/PingInfo ping_info,
    geometry_msgs/Vector3[] beam_directions, float32[] ranges, marine_acoustic_msgs/SonarImageData image
event_camera_msgs/EventPacket: std_msgs/Header header, uint32 height, uint32 width, uint64 seq, uint64 time_base,
    string encoding, bool is_bigendian, uint8[] events
"""

_NS = 10**9


class SenseTopics(TopicTable):
    """The topics of the kinds of these senses."""

    @topics("radar_returns")
    def radar_returns(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Returns of a radar."""
        text = Outlet("std_msgs/msg/String", lambda m, f: {"data": as_json(list(m.records))})
        return [Outlet("radar_msgs/msg/RadarScan", _radar_scan, instead=text)]

    @topics("doppler_log")
    def doppler_log(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """A Doppler log, also as a twist."""
        return [
            Outlet("marine_acoustic_msgs/msg/Dvl", _dvl, or_none=True),
            Outlet("geometry_msgs/msg/TwistStamped", _twist, "twist"),
        ]

    @topics("sonar_image")
    def sonar_image(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """A sonar image by beams, and as a picture."""
        return [
            Outlet("marine_acoustic_msgs/msg/ProjectedSonarImage", _sonar_image, or_none=True),
            Outlet("sensor_msgs/msg/Image", _picture, "image"),
        ]

    @topics("events")
    def events(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """A packet of events."""
        return [Outlet("event_camera_msgs/msg/EventPacket", _event_packet, or_none=True)]


def _radar_scan(message: Message, frame: str) -> RosMessage:
    returns = [
        {
            "range": one["range"],
            "azimuth": one["azimuth"],
            "elevation": one["elevation"],
            "doppler_velocity": one["velocity"],
            "amplitude": 10.0 * math.log10(max(one["rcs"], 1e-30)),
        }
        for one in message.records
    ]
    return {"header": header(message, frame), "returns": returns}


def _dvl(message: Message, frame: str) -> RosMessage:
    ranges = np.asarray(message.ranges, dtype=np.float64)
    good = np.isfinite(ranges)
    vx, vy, _ = message.velocity
    return {
        "header": header(message, frame),
        "velocity_mode": int(message.reference == "water"),
        "velocity": xyz(message.velocity),
        "altitude": message.altitude,
        "course_gnd": math.atan2(vy, vx),
        "speed_gnd": math.hypot(vx, vy),
        "num_good_beams": int(np.count_nonzero(good)),
        "sound_speed": message.sound_speed,
        "beam_ranges_valid": bool(good.any()),
        "beam_velocities_valid": bool(message.locked),
        "beam_unit_vec": [xyz(beam) for beam in np.asarray(message.beams).tolist()],
        "range": ranges.tolist(),
        "beam_quality": good.astype(np.float64).tolist(),
        "beam_velocity": np.asarray(message.beam_velocities, dtype=np.float64).tolist(),
    }


def _twist(message: Message, frame: str) -> RosMessage | None:
    if not message.locked:
        return None
    return {"header": header(message, frame), "twist": {"linear": xyz(message.velocity)}}


def _sonar_image(message: Message, frame: str) -> RosMessage:
    pixels = np.ascontiguousarray(message.pixels)
    azimuths = np.asarray(message.azimuths).tolist()
    return {
        "header": header(message, frame),
        "ping_info": {"frequency": message.frequency, "sound_speed": message.sound_speed},
        "beam_directions": [{"x": math.cos(a), "y": math.sin(a), "z": 0.0} for a in azimuths],
        "ranges": np.asarray(message.ranges, dtype=np.float32),
        "image": {"beam_count": pixels.shape[1], "data": pixels.tobytes()},
    }


def _picture(message: Message, frame: str) -> RosMessage:
    pixels = np.ascontiguousarray(message.pixels)
    height, width = pixels.shape
    return {
        "header": header(message, frame),
        "height": height,
        "width": width,
        "encoding": "mono8",
        "step": width,
        "data": pixels.tobytes(),
    }


def _event_packet(message: Message, frame: str) -> RosMessage | None:
    events = np.asarray(message.events, dtype=np.float64)
    if not len(events):
        return None
    times = np.rint(events[:, 2] * _NS).astype(np.uint64)
    base = times.min()
    # encoding "mono" of event_camera_msgs: polarity, 15 bits of the row, 16 of the column, 32 of ns since the base
    words = (times - base) | events[:, 0].astype(np.uint64) << np.uint64(32)
    words |= events[:, 1].astype(np.uint64) << np.uint64(48)
    words |= (events[:, 3] > 0).astype(np.uint64) << np.uint64(63)
    return {
        "header": {"stamp": time(int(base)), "frame_id": header(message, frame)["frame_id"]},
        "height": int(message.height),
        "width": int(message.width),
        "time_base": int(base),
        "encoding": "mono",
        "events": words.astype("<u8").tobytes(),
    }


MESSAGES = RosExtension(SenseTopics(), _MESSAGES)
