"""PatrolBot."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.wheeled_robot import PhysicsDifferentialRobot


class PatrolBot(PhysicsDifferentialRobot):
    """An indoor robot with two driven wheels and casters."""

    _name = "PatrolBot"
    _builder = RobotDefaults(
        "patrolbot", drive="wheels", properties={"HasSuspension": False, "Influence": 0.1, "Friction": 0.8}
    )
