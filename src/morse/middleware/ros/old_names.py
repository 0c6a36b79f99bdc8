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


def class_path(given: str, component: str) -> str:
    """The class of a stream.

    Args:
        given: its class path, which may be one of 1.4: ``morse.middleware.ros.pose.TFPublisher``.
        component: name of the component, for a message.
    """
    if not given.startswith(_PACKAGE) or given == _USUAL or given.startswith(f"{_PACKAGE}variants."):
        return given
    name = given.rpartition(".")[2]
    if name in _VARIANTS:
        return f"{_PACKAGE}variants.{name}"
    if not name.endswith(_ENDS):
        logger.warning("ros: there is no class %s: %s uses its usual messages", given, component)
    return _USUAL
