"""The class path of the MAVLink streams in scene scripts."""

from morse.middleware.mavlink.datastream import MavlinkDatastreamManager

__all__ = ["MavlinkDatastreamManager"]
