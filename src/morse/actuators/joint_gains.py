"""The gains of the motors of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from morse.actuators.dynamic_joints import DynamicJoints
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.scene import Control

_Gain = Annotated[float, Range(0.0, 1e9)]


class JointGains(DynamicJoints):
    """Motors whose gains scripts and clients set."""

    add_state("_gains", dict, "Gains that were set, by joint: stiffness and damping")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._gains: dict[str, list[float | None]] = {}
        settings = obj.node.articulation
        for name, stiffness, damping in settings.gains if settings is not None else ():
            if name in self.joints:
                self._set_gains(name, stiffness, damping)

    @service(changes=False)
    def get_gains(self) -> dict[str, dict[str, float]]:
        """Return the gains of the motors: name to ``stiffness`` (N·m/rad or N/m) and ``damping`` (N·m·s/rad or N·s/m).

        A motor for positions exerts stiffness * (setpoint - position) - damping * velocity, a motor for velocities
        damping * (setpoint - velocity), both up to the largest effort of the joint.
        """
        if self._motors is None:
            return {}
        gains = self._motors.gains(self.joints)
        return {name: {"stiffness": k, "damping": d} for name, (k, d) in zip(self.joints, gains, strict=True)}

    @service
    def set_gains(
        self, stiffness: _Gain | None = None, damping: _Gain | None = None, joints: list[str] | None = None
    ) -> None:
        """Set the gains of motors of dynamic joints; see `get_gains`. They stay when the control mode changes.

        Args:
            stiffness: N·m/rad or N/m, for motors that control a position; None to keep it.
            damping: N·m·s/rad or N·s/m, for motors that control a position or a velocity; None to keep it.
            joints: names of joints; None for all.
        """
        names = list(self.joints if joints is None else joints)
        for name in names:
            self._joint(name)
        if self._motors is None:
            raise MorseRPCInvokationError(
                f"{self.name()}: its joints are not dynamic and have no motors: "
                "set the property Dynamic to True in the script"
            )
        for name in names:
            self._set_gains(name, stiffness, damping)

    def _set_gains(self, name: str, stiffness: float | None, damping: float | None) -> None:
        before = self._gains.get(name, [None, None])
        gains = [before[0] if stiffness is None else stiffness, before[1] if damping is None else damping]
        self._gains[name] = gains
        if self._motors is not None:
            self._motors.set_gains(name, *gains)

    def _set_controls(self, controls: dict[str, Control]) -> None:
        super()._set_controls(controls)
        for name in controls:
            if name in self._gains:
                self._motors.set_gains(name, *self._gains[name])
