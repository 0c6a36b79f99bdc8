"""The class path of the YARP services in scene scripts."""

from morse.middleware.yarp.request_manager import YarpRequestManager

__all__ = ["YarpRequestManager"]
