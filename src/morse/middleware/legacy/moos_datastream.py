"""The class path of the MOOS streams in scene scripts."""

from morse.middleware.moos.datastream import MOOSDatastreamManager

__all__ = ["MOOSDatastreamManager"]
