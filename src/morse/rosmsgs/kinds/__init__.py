"""The messages of each kind of data."""

from morse.rosmsgs.kinds.sensing import SensingKinds
from morse.rosmsgs.kinds.spatial import SpatialKinds
from morse.rosmsgs.kinds.states import StateKinds
from morse.rosmsgs.kinds.vision import DetectingKinds, VisionKinds


class Ros2Topics(SpatialKinds, SensingKinds, VisionKinds, DetectingKinds, StateKinds):
    """The topics of all kinds in ROS 2."""
