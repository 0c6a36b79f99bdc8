"""Victim."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.robot import Robot
from morse.core.services import service


class Victim(Robot):
    """A person who can be found and healed (see the sensor SearchAndRescue)."""

    _name = "Victim"
    _builder = RobotDefaults(
        "victim", properties={"Victim_Tag": True, "Requirements": "1,2,3", "Injured": True, "Severity": 10}
    )

    @service
    def heal(self) -> None:
        """Set the victim to not injured."""
        self.bge_object["Injured"] = False
        self.bge_object["Severity"] = 0
