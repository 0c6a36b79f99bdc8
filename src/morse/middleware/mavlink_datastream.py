"""The class path under which scene scripts know the streams of MAVLink."""

from morse.middleware.mavlink.datastream import MavlinkDatastreamManager

__all__ = ["MavlinkDatastreamManager"]
