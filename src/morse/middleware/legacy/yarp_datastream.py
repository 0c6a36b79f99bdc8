"""The class path of the YARP streams in scene scripts."""

from morse.middleware.yarp.datastream import YarpDatastreamManager

__all__ = ["YarpDatastreamManager"]
