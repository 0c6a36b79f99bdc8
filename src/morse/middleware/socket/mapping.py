"""What the socket middleware carries: JSON for every component, images and clouds in base64."""

from __future__ import annotations

from morse.middleware.registry import Middleware

_VIDEO = ("morse.middleware.sockets.video_camera.VideoPublisher",)
_DEPTH = ("morse.middleware.sockets.depth_camera.DepthCameraPublisher",)

MIDDLEWARE = Middleware(
    name="socket",
    stream_manager="morse.middleware.socket_datastream.SocketDatastreamManager",
    request_manager="morse.middleware.socket_request_manager.SocketRequestManager",
    default_publisher="morse.middleware.socket_datastream.SocketPublisher",
    default_reader="morse.middleware.socket_datastream.SocketReader",
    streams={
        "VideoCamera": {"all": _VIDEO},
        "DepthVideoCamera": {"all": _VIDEO},
        "DepthCamera": {"all": _DEPTH},
        "DepthCameraAggregator": {"all": _DEPTH},
        "PR2JointState": {"all": ("morse.middleware.sockets.jointstate.PR2JointStatePublisher",)},
        # it carries cameras and measures nothing
        "StereoUnit": {"all": ()},
        "MocapControl": {"all": ()},
    },
)
