"""The class path under which clients and scene scripts know the streams of ROS 1."""

from morse.middleware.ros.datastream import ROSDatastreamManager

__all__ = ["ROSDatastreamManager"]
