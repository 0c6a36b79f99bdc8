"""The class path of the ROS 1 streams for clients and scene scripts."""

from morse.middleware.ros.datastream import ROSDatastreamManager

__all__ = ["ROSDatastreamManager"]
