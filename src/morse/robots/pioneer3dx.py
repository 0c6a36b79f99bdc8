"""A small indoor robot with two driven wheels and a caster."""

from morse.core.wheeled_robot import PhysicsDifferentialRobot


class Pioneer3DX(PhysicsDifferentialRobot):
    """A small indoor robot with two driven wheels and a caster."""

    _name = "Pioneer 3-DX"
    _short_desc = "A small indoor robot with two driven wheels and a caster."
