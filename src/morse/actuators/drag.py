"""Resistance of air or water."""

from morse.core.actuator import Actuator
from morse.core.limits import Limits
from morse.helpers.components import add_property

_COEFFICIENT: Limits = {"unit": "kg/m", "low": 0.0}


class Drag(Actuator):
    """Applies a drag force that is quadratic in the speed, separately along each axis of the robot.

    F = -sign(v) v^2 C, with the speed v along an axis of the robot and the coefficient C of that axis. C is half the
    product of the density of the fluid, the drag coefficient and the cross-section. In one tick the force reduces the
    speed at most to 0.
    """

    applies_forces = True
    _name = "Drag"
    _short_desc = "Applies the resistance of air or water to the robot"
    _source = "quadratic drag, F = 1/2 ρ v² c A, with C = 1/2 ρ c A"

    add_property("_drag_x", 0.09, "DragCoeffX", "float", "Coefficient along X", **_COEFFICIENT)
    add_property("_drag_y", 0.09, "DragCoeffY", "float", "Coefficient along Y", **_COEFFICIENT)
    add_property("_drag_z", 0.5, "DragCoeffZ", "float", "Coefficient along Z", **_COEFFICIENT)

    _drag_x: float
    _drag_y: float
    _drag_z: float

    def default_action(self) -> None:
        """Apply the force."""
        body = self.robot_parent.bge_object
        velocity = body.localLinearVelocity
        most = body.mass * self.frequency
        force = [
            -v * min(abs(v) * c, most)
            for v, c in zip(velocity, (self._drag_x, self._drag_y, self._drag_z), strict=True)
        ]
        body.wrench(force, (0.0, 0.0, 0.0), True)
