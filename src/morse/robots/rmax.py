"""RMax."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class RMax(Robot):
    """A helicopter."""

    _name = "RMax"
    _builder = RobotDefaults("rmax", drive="free", properties={"NoGravity": True}, rigid_body=True)
