"""The class paths of streams of MORSE 1.4, which scripts give as ``method``."""

from __future__ import annotations

import logging

from morse.middleware.ros.mapping import MIDDLEWARE

logger = logging.getLogger(__name__)

_PACKAGE = "morse.middleware.ros."
_USUAL = str(MIDDLEWARE.default_publisher)
#: classes of 1.4 with other messages than the usual ones, in `morse.middleware.ros.variants`
_VARIANTS = (
    "PointCloud2Publisher",
    "Pose2DReader",
    "PosePublisher",
    "PoseWithCovarianceStampedPublisher",
    "RangePublisher",
    "SemanticCameraPublisherLisp",
    "StaticTF2Publisher",
    "StaticTFPublisher",
    "TFPublisher",
    "TwistPublisher",
)
#: ends of the names of the other classes
_ENDS = ("Publisher", "Reader", "Subscriber")


def class_path(path: str, component: str) -> str:
    """The class of a stream.

    Args:
        path: its class path, which may be one of 1.4: ``morse.middleware.ros.pose.TFPublisher``.
        component: name of the component, for a message.
    """
    if not path.startswith(_PACKAGE) or path == _USUAL or path.startswith(f"{_PACKAGE}variants."):
        return path
    name = path.rpartition(".")[2]
    if name in _VARIANTS:
        return f"{_PACKAGE}variants.{name}"
    if not name.endswith(_ENDS):
        logger.warning("ros: there is no class %s: %s uses its usual messages", path, component)
    return _USUAL
