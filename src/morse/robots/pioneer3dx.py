"""Pioneer 3-DX."""

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.wheeled_robot import PhysicsDifferentialRobot


class Pioneer3DX(PhysicsDifferentialRobot):
    """A small indoor robot with two driven wheels and a caster."""

    _name = "Pioneer 3-DX"
    # 1.4 had a FixTurningSpeed of 0.52 here to compensate for slip, which does not occur here. Its origin came to rest
    # 0.15 m above the floor
    _builder = RobotDefaults(
        "pioneer3dx",
        drive="wheels",
        properties={
            "HasSuspension": False,
            "Influence": 0.1,
            "Friction": 0.8,
            "FixTurningSpeed": 0.0,
            "RideHeight": 0.053,
        },
    )
