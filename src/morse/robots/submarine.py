"""Submarine."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot


class Submarine(Robot):
    """A submarine with neutral buoyancy."""

    _name = "Submarine"
    _builder = RobotDefaults("submarine", drive="free", properties={"NoGravity": True}, rigid_body=True)
