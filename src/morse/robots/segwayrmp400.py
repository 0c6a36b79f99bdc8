"""Segway RMP 400."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.wheeled_robot import PhysicsDifferentialRobot


class SegwayRMP400(PhysicsDifferentialRobot):
    """An outdoor robot with four driven wheels."""

    _name = "Segway RMP 400"
    # 1.4 had a FixTurningSpeed of 1.16 here because its slip was different; its origin came to rest 0.2 m above the
    # floor
    _builder = RobotDefaults(
        "segwayrmp400",
        drive="wheels",
        properties={
            "HasSuspension": False,
            "Influence": 0.1,
            "Friction": 0.8,
            "FixTurningSpeed": 1.09,
            "RideHeight": 0.05,
        },
    )
