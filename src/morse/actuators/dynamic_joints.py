"""Joints that the physics moves, with motors for positions, velocities or efforts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar

from morse.actuators.joint_services import JointServices
from morse.core.declarations import DataField
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.helpers.components import add_property
from morse.scene import Control, JointKind, controls_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.scene import JointDynamics

_UNITS = {
    Control.POSITION: ("rad", "m"),
    Control.VELOCITY: ("rad/s", "m/s"),
    Control.EFFORT: ("N·m", "N"),
}
_MOST = 1e6


class DynamicJoints(JointServices):
    """Joints with masses: gravity and contacts act on them, and motors move them.

    Joints of models in which links have masses are dynamic. Joints of other models are dynamic if the script asks for
    it.
    """

    add_property(
        "_dynamic",
        False,
        "Dynamic",
        "bool",
        "Whether the physics moves the joints: links have masses, and motors move them. True by default for models "
        "from "
        "URDF and MJCF files, False for others",
    )
    add_property(
        "_control",
        "",
        "Control",
        "string",
        "Quantity that the motors of dynamic joints control: a position (rad or m), a velocity (rad/s or m/s) or an "
        "effort (N·m or N). If empty, the quantity that the model declares, otherwise position",
        choices=("", *(str(control) for control in Control)),
    )

    not_state: ClassVar[tuple[str, ...]] = ("_motors", "_controls")

    def __init__(self, obj: Any, parent: Any = None) -> None:
        self._motors: Any = None
        self._controls: dict[str, Control] = {}
        super().__init__(obj, parent)
        self._motors = obj.joints()
        if self._motors is not None:
            controls = controls_of(obj.node)
            self._controls = {name: controls[name] for name in self.joints if controls[name] is not Control.POSITION}
            for number, name in enumerate(self.joints):
                if name in self._controls:
                    self.local_data[name] = self._values[number] = 0.0

    @property
    def is_dynamic(self) -> bool:
        """Whether the physics moves the joints."""
        return self._motors is not None

    @property
    def control(self) -> Control | None:
        """The control mode of all motors; None if the motors have different modes."""
        told = {self._controls.get(name, Control.POSITION) for name in self.joints}
        return told.pop() if len(told) == 1 else None

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """Return one field for each joint."""
        found = dict(super().own_fields)
        for number, name in enumerate(self.joints):
            control = self._controls.get(name)
            if control is not None:
                slides = self.chain.joint(number).kind is JointKind.PRISMATIC
                word = "Velocity" if control is Control.VELOCITY else "Force" if slides else "Torque"
                found[name] = DataField(
                    0.0, "float", f"{word} of the motor", unit=_UNITS[control][slides], frame="joint",
                    low=-_MOST, high=_MOST,
                )  # fmt: skip
        return found

    @property
    def joint_values(self) -> tuple[float, ...]:
        """The present joint values, rad or m; measured values, if the joints are dynamic."""
        return super().joint_values if self._motors is None else tuple(self._motors.positions(self.joints))

    @property
    def joint_velocities(self) -> tuple[float, ...] | None:
        """The present joint velocities, rad/s or m/s; None if the joints are not dynamic."""
        return None if self._motors is None else tuple(self._motors.velocities(self.joints))

    @property
    def joint_efforts(self) -> tuple[float, ...] | None:
        """The present efforts of the motors, N m or N; None if the joints are not dynamic."""
        return None if self._motors is None else tuple(self._motors.efforts(self.joints))

    @service(changes=False)
    def get_controls(self) -> dict[str, str]:
        """Return the control mode of each motor: ``position``, ``velocity`` or ``effort``; empty if not dynamic."""
        if self._motors is None:
            return {}
        return {name: str(self._controls.get(name, Control.POSITION)) for name in self.joints}

    # -- motion ----------------------------------------------------------------------------

    def _move_to(self, values: Sequence[float]) -> None:
        if self._motors is None:
            super()._move_to(values)
        elif list(values) != self._values:
            self._values = list(values)
            self._motors.tell(self.joints, self._values)

    def _wanted(self) -> list[float]:
        if not self._controls:
            return super()._wanted()
        found = []
        for number, name in enumerate(self.joints):
            control, value = self._controls.get(name), float(self.local_data[name])
            if control is None:
                found.append(self.chain.clamped(number, value))
            else:
                most = self._most(self.chain.joint(number).dynamics, control)
                found.append(min(max(value, -most), most))
        return found

    @staticmethod
    def _most(dynamics: JointDynamics | None, control: Control) -> float:
        if dynamics is None:
            return math.inf
        return dynamics.speed if control is Control.VELOCITY else dynamics.effort

    def _steps(self) -> list[float]:
        steps = super()._steps()
        if not self._controls:
            return steps
        # velocities and efforts are applied immediately
        return [math.inf if name in self._controls else step for name, step in zip(self.joints, steps, strict=True)]

    def _end_if_there(self, awaited: list[str], wanted: list[float]) -> None:
        if self._motors is None:
            super()._end_if_there(awaited, wanted)
            return
        # a service ends when the joints, and not only their setpoints, have arrived
        told, self._values = self._values, list(self.joint_values)
        super()._end_if_there(awaited, wanted)
        self._values = told

    def _checked(self, values: dict[str, float], kind: JointKind) -> dict[str, float]:
        for name in values:
            if name in self._controls:
                raise MorseRPCInvokationError(
                    f"{self.name()}: the motor of '{name}' is controlled by {self._controls[name]}, not by position: "
                    f"send the field '{name}' of a message, or set the property Control to 'position' in the script"
                )
        return super()._checked(values, kind)
