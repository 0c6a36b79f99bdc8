"""Joints that the physics moves, with motors for positions, velocities or efforts."""

from __future__ import annotations

import math
from operator import eq
from typing import TYPE_CHECKING, Literal

from morse.actuators.joint_services import JointServices
from morse.core.declarations import DataField
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.helpers.components import add_property, add_state
from morse.scene import Control, JointKind, controls_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body, Joints
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

    add_state("_controls", dict, "Joints that are not controlled by position")
    add_state("_pulled", dict, "Last commands of the motors of tendons")

    _control: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        self._motors: Joints | None = None
        self._controls: dict[str, Control] = {}
        #: control modes, and the limits of the setpoints and the steps per tick that follow from them
        self._bounded: tuple[dict[str, Control], list[tuple[float, float]]] = {}, []
        self._stepped: tuple[dict[str, Control], list[float], list[float]] = {}, [], []
        #: motors of tendons: the range of the commands, and the last commands
        self._tendons: dict[str, tuple[float, float]] = {}
        self._pulled: dict[str, float] = {}
        super().__init__(obj, parent)
        self._motors = obj.joints()
        if self._motors is None and self.chain.loose:
            names = ", ".join(
                f"'{self.chain.bones[index].name}' ({self.chain.bones[index].kind})" for index in self.chain.loose
            )
            text = f"{self.name()}: {names} stay fixed, because the property Dynamic is False"
            self.context.complaints.warn(f"{self.name()}: fixed", text)
        if self._motors is not None:
            controls = controls_of(obj.node)
            self._controls = {name: controls[name] for name in self.joints if controls[name] is not Control.POSITION}
            for number, name in enumerate(self.joints):
                if name in self._controls:
                    self.local_data[name] = self._values[number] = 0.0

            for motor in self._motors.file_motors:
                self._tendons[motor.name] = motor.commands
                self._pulled[motor.name] = self.local_data[motor.name] = motor.start

    def _named(self, control: Control) -> tuple[str, ...]:
        return tuple(name for name in self.joints if self._controls.get(name, Control.POSITION) is control)

    @property
    def position_joints(self) -> tuple[str, ...]:
        """The joints whose motors control a position; all, if the joints are not dynamic."""
        return self._named(Control.POSITION)

    @property
    def velocity_joints(self) -> tuple[str, ...]:
        """The joints whose motors control a velocity."""
        return self._named(Control.VELOCITY)

    @property
    def effort_joints(self) -> tuple[str, ...]:
        """The joints whose motors control an effort."""
        return self._named(Control.EFFORT)

    @property
    def is_dynamic(self) -> bool:
        """Whether the physics moves the joints."""
        return self._motors is not None

    @property
    def control(self) -> Control | None:
        """The control mode of all motors; None if the motors have different modes."""
        kinds = {self._controls.get(name, Control.POSITION) for name in self.joints}
        return kinds.pop() if len(kinds) == 1 else None

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """Return one field for each joint."""
        fields = dict(super().own_fields)
        for number, name in enumerate(self.joints):
            control = self._controls.get(name)
            if control is not None:
                slides = self.chain.joint(number).kind is JointKind.PRISMATIC
                word = "Velocity" if control is Control.VELOCITY else "Force" if slides else "Torque"
                fields[name] = DataField(
                    0.0, "float", f"{word} of the motor", unit=_UNITS[control][slides], frame="joint",
                    low=-_MOST, high=_MOST,
                )  # fmt: skip
        for name in self._tendons:
            fields[name] = DataField(
                self._pulled[name], "float", "Command of the motor of a tendon, as the file defines it", frame="joint",
                low=-_MOST, high=_MOST,
            )  # fmt: skip
        ranges = {**dict(zip(self.joints, self._bounds(), strict=True)), **self._tendons}
        return {
            # motors without a limit have one that nobody reaches
            name: field._replace(reached=bounds if 0.0 < bounds[1] - bounds[0] < _MOST else None)
            for name, field in fields.items()
            for bounds in (ranges.get(name, (0.0, 0.0)),)
        }

    def _pull(self) -> None:
        """Pass new commands to the motors of tendons."""
        data = self.local_data
        forces = {name: min(max(float(data[name]), low), high) for name, (low, high) in self._tendons.items()}
        if self._motors is not None and forces != self._pulled:
            self._pulled = forces
            self._motors.pull(forces)

    @property
    def motors(self) -> Joints | None:
        """The joints in the physics; None if they are not dynamic."""
        motors: Joints | None = self._motors
        return motors

    @property
    def joint_values(self) -> tuple[float, ...]:
        """The present joint values, rad or m; measured values, if the joints are dynamic."""
        return super().joint_values if self._motors is None else tuple(self._motors.positions(self.joints))

    @property
    def joint_state(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | None:
        """The present values, velocities and efforts in one call, (J,) each; None if the joints are not dynamic."""
        return None if self._motors is None else self._motors.measured(self.joints)

    @property
    def joint_velocities(self) -> tuple[float, ...] | None:
        """The present joint velocities, rad/s or m/s; None if the joints are not dynamic."""
        return None if self._motors is None else tuple(self._motors.velocities(self.joints))

    @property
    def joint_efforts(self) -> tuple[float, ...] | None:
        """The present efforts of the motors, N m or N; None if the joints are not dynamic."""
        return None if self._motors is None else tuple(self._motors.efforts(self.joints))

    def loose_joint(self, name: str) -> tuple[list[float], list[float]]:
        """Return the position and the velocity of a ball, a planar or a floating joint; see `JointHandle.loose`."""
        return ([], []) if self._motors is None else self._motors.loose(name)

    @service(changes=False)
    def get_tendons(self) -> dict[str, dict[str, float]]:
        """Return the tendons that have a motor: name of the motor to ``length`` (m), ``speed`` (m/s), ``force`` (N)."""
        lengths = {} if self._motors is None else self._motors.tendons()
        return {name: {"length": a, "speed": b, "force": c} for name, (a, b, c) in lengths.items()}

    @service(changes=False)
    def get_controls(self) -> dict[str, str]:
        """Return the control mode of each motor: ``position``, ``velocity`` or ``effort``; empty if not dynamic."""
        if self._motors is None:
            return {}
        return {name: str(self._controls.get(name, Control.POSITION)) for name in self.joints}

    @service
    def set_control(self, control: Literal["position", "velocity", "effort"], joints: list[str] | None = None) -> None:
        """Change the control mode of motors of dynamic joints.

        A motor that controls a position then holds the present position. The setpoint of any other motor becomes 0.
        Motions of these joints that services have started are ended.

        Args:
            control: ``position``, ``velocity`` or ``effort``.
            joints: names of joints; None for all.
        """
        names = list(self.joints if joints is None else joints)
        for name in names:
            self._joint(name)
        self._set_controls(dict.fromkeys(names, Control(control)))

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs; ``Control`` changes the control mode of all motors."""
        before = self._control
        super().set_property(name, value)
        if self._control != before:
            control, self._control = self._control, before
            in_model = controls_of(self.bge_object.node)
            self._set_controls({joint: Control(control or in_model[joint]) for joint in self.joints})
            self._control = control

    def _set_controls(self, controls: dict[str, Control]) -> None:
        numbers = {name: number for number, name in enumerate(self.joints)}
        if self._motors is None:
            raise MorseRPCInvokationError(
                f"{self.name()}: its joints are not dynamic and have no motors: "
                "set the property Dynamic to True in the script"
            )
        self._take_over(list(controls))
        present, values = self.joint_values, list(self._values)
        for name, control in controls.items():
            number = numbers[name]
            if control is Control.POSITION:
                self._controls.pop(name, None)
            else:
                self._controls[name] = control
            setpoint = present[number] if control is Control.POSITION else 0.0
            self.local_data[name] = values[number] = setpoint
            self._motors.set_control(name, control, setpoint)
        self._values = values
        self._control = str(self.control or "")

    def _demand_positions(self, names: Sequence[str] | None = None) -> None:
        """Raise an error for a motion of joints, by default of all, while motors of them control other quantities."""
        others = {name: control for name, control in self._controls.items() if names is None or name in names}
        if others:
            name, control = next(iter(others.items()))
            raise MorseRPCInvokationError(
                f"{self.name()}: the motor of '{name}' is controlled by {control}, not by position: "
                "call set_control('position')"
            )

    # -- motion ----------------------------------------------------------------------------

    def _move_to(self, values: Sequence[float]) -> None:
        if self._motors is None:
            super()._move_to(values)
            return
        before, self._values = self._values, list(values)
        names = self.joints
        if True not in map(eq, self._values, before):
            self._motors.tell(names, self._values)
        elif self._values != before:
            # wheels that another actuator turns keep their commands
            numbers = [i for i, (new, old) in enumerate(zip(self._values, before, strict=True)) if new != old]
            self._motors.tell([names[i] for i in numbers], [self._values[i] for i in numbers])

    def _bounds(self) -> Sequence[tuple[float, float]]:
        if not self._controls:
            return super()._bounds()
        if self._controls != self._bounded[0]:
            bounds = list(super()._bounds())
            for number, name in enumerate(self.joints):
                if name in self._controls:
                    most = self._most(self.chain.joint(number).dynamics, self._controls[name])
                    bounds[number] = -most, most
            self._bounded = dict(self._controls), bounds
        return self._bounded[1]

    @staticmethod
    def _most(dynamics: JointDynamics | None, control: Control) -> float:
        if dynamics is None:
            return math.inf
        return dynamics.speed if control is Control.VELOCITY else dynamics.effort

    def _steps(self) -> list[float]:
        steps = super()._steps()
        if not self._controls:
            return steps
        if steps is not self._stepped[1] or self._controls != self._stepped[0]:
            # velocities and efforts are applied immediately
            own = [math.inf if name in self._controls else step for name, step in zip(self.joints, steps, strict=True)]
            self._stepped = dict(self._controls), steps, own
        return self._stepped[2]

    def _end_if_there(self, names: list[str], targets: list[float]) -> None:
        if self._motors is None:
            super()._end_if_there(names, targets)
            return
        # a service ends when the joints, and not only their setpoints, have arrived
        commands, self._values = self._values, list(self.joint_values)
        super()._end_if_there(names, targets)
        self._values = commands

    def _checked(self, values: dict[str, float], kind: JointKind) -> dict[str, float]:
        for name in values:
            if name in self._controls:
                raise MorseRPCInvokationError(
                    f"{self.name()}: the motor of '{name}' is controlled by {self._controls[name]}, not by position: "
                    f"send the field '{name}' of a message, or call set_control('position', ['{name}'])"
                )
        return super()._checked(values, kind)
