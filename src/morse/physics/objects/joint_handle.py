"""The handle of components for joints that the physics moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.model import motors
from morse.scene import Control

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import mujoco
    from numpy.typing import NDArray

    from morse.physics.model.articulated import JointSlot
    from morse.physics.model.files import FileMotor
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node

#: smallest gain of a motor, N m/rad or N m s/rad
_LEAST = 1e-9


def _place(numbers: Sequence[int]) -> slice | NDArray[np.intp]:
    """Numbers in an array of the engine; a slice takes half of the time."""
    first = numbers[0] if numbers else 0
    if list(numbers) == list(range(first, first + len(numbers))):
        return slice(first, first + len(numbers))
    return np.array(numbers, dtype=np.intp)


class JointHandle:
    """Commands the motors of an armature, and measures its joints.

    All values are in rad, rad/s and N m for revolute joints, in m, m/s and N for prismatic joints.
    """

    #: created from the scene, without a state; cached values of the engine are not saved
    is_apparatus = True

    def __init__(self, state: EngineState, armature: Node) -> None:
        self._state = state
        self._name = armature.name
        self._model: mujoco.MjModel | None = None
        self._order: tuple[str, ...] | None = None
        self._told: tuple[str, ...] | None = None
        #: the motors of the joints that were commanded last; None if one of these has no motor
        self._channels: slice | NDArray[np.intp] | None = None

    @property
    def _slots(self) -> dict[str, JointSlot]:
        """The joints by name, looked up again after objects were added or removed."""
        state = self._state
        if self._model is not state.model:
            self._model, self._order, self._told = state.model, None, None
            self._controls = state.data.ctrl
            self._arrays = state.data.qpos, state.data.qvel, state.data.qfrc_actuator
            self._joints = next(slots for node, slots in state.joints.items() if node.name == self._name)
        return self._joints

    def _take(self, names: Sequence[str]) -> None:
        """Look up the addresses of joints that are measured."""
        slots, order = self._slots, tuple(names)
        if self._order == order:
            return
        self._order = order
        present = [slots[name] for name in names if name in slots]
        self._present = [name in slots for name in names]
        self._all = all(self._present)
        self._qpos = _place([slot.qpos for slot in present])
        self._dofs = _place([slot.dof for slot in present])

    def tell(self, names: Sequence[str], values: Sequence[float]) -> None:
        """Set the commands of motors: positions, velocities or efforts, see `morse.scene.Control`."""
        slots = self._slots
        if names is not self._told and isinstance(names, tuple):
            channels = self.channels(names)
            self._told, self._channels = names, None if -1 in channels else _place(channels)
        if names is self._told and self._channels is not None:
            self._controls[self._channels] = values
            return
        for name, value in zip(names, values, strict=True):
            slot = slots.get(name)
            if slot is not None and slot.actuator >= 0:
                self._controls[slot.actuator] = value

    def places(self, names: Sequence[str]) -> list[int]:
        """Return the numbers of joints among the positions of the world; -1 for a joint that nothing hangs on."""
        slots = self._slots
        return [slots[name].qpos if name in slots else -1 for name in names]

    def channels(self, names: Sequence[str]) -> list[int]:
        """Return the numbers of the motors of joints among the commands of the world; -1 for a joint without motor."""
        slots = self._slots
        return [slots[name].actuator if name in slots else -1 for name in names]

    def set_control(self, name: str, control: Control, command: float) -> None:
        """Change the control mode of a motor, and its command."""
        state, slot = self._state, self._slots.get(name)
        if slot is None or slot.motor is None:
            return
        arrays = {array: getattr(state.model, array) for array in motors.ARRAYS}
        motors.write(arrays, slot.actuator, slot.dof, slot.motor.setting(control))
        state.data.ctrl[slot.actuator] = command
        state.is_stirred = True

    def gains(self, names: Sequence[str]) -> list[tuple[float, float]]:
        """Return stiffness and damping of motors; 0 for those that control an effort, or are missing."""
        bias = self._state.model.actuator_biasprm
        slots = [self._slots.get(name) for name in names]
        rows = [(0.0, 0.0, 0.0) if slot is None or slot.actuator < 0 else bias[slot.actuator, :3] for slot in slots]
        return [(abs(float(row[1])), abs(float(row[2]))) for row in rows]

    def set_gains(self, name: str, stiffness: float | None, damping: float | None) -> None:
        """Set stiffness and damping of a motor, None to keep them; one that its mode does not have is ignored."""
        state, slot = self._state, self._slots.get(name)
        if slot is None or slot.motor is None:
            return
        model = state.model
        control = motors.control_of(model.actuator_biasprm[slot.actuator])
        if control is Control.EFFORT:
            return
        before = self.gains([name])[0]
        # the gains of a motor tell its control mode: they do not vanish
        d = before[1] if damping is None else max(damping, _LEAST)
        k = 0.0 if control is Control.VELOCITY else before[0] if stiffness is None else max(stiffness, _LEAST)
        arrays = {array: getattr(model, array) for array in motors.ARRAYS}
        setting = motors.Setting(k or d, k, d, float(model.dof_armature[slot.dof]))
        motors.write(arrays, slot.actuator, slot.dof, setting)
        state.is_stirred = True

    @property
    def file_motors(self) -> list[FileMotor]:
        """The actuators of the file of the armature that are not motors of single joints."""
        return [motor for motor in self._state.file_motors if motor.armature == self._name]

    def pull(self, commands: Mapping[str, float]) -> None:
        """Set the commands of actuators of the file: name to command."""
        for motor in self.file_motors:
            if motor.name in commands:
                self._state.data.ctrl[motor.actuator] = commands[motor.name]

    def tendons(self) -> dict[str, tuple[float, float, float]]:
        """Return the actuators of the file: name to length (m), speed (m/s) and force (N)."""
        data = self._state.data
        arrays = (data.actuator_length, data.actuator_velocity, data.actuator_force)
        values = {motor.name: [float(array[motor.actuator]) for array in arrays] for motor in self.file_motors}
        return {name: (a, b, c) for name, (a, b, c) in values.items()}

    def loose(self, name: str) -> tuple[list[float], list[float]]:
        """Return the position and the velocity of a bone without a joint value, as stored in the engine.

        Returns:
            Displacements (m) along the axes of the bone, then an angle (rad) or a quaternion w, x, y, z; and their
            velocities, m/s and rad/s. Both are empty if no object is attached to the bone.
        """
        slots = [self._slots.get(f"{name}{suffix}") for suffix in ("", "/x", "/y", "/z", "/turn")]
        present = [slot for slot in slots if slot is not None]
        data = self._state.data
        return (
            [value for slot in present for value in data.qpos[slot.qpos : slot.qpos + slot.width].tolist()],
            [value for slot in present for value in data.qvel[slot.dof : slot.dof + slot.dofs].tolist()],
        )

    def measured(self, names: Sequence[str]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return the measured positions and velocities, and the efforts that the motors exert, (J,) each."""
        self._take(names)
        if self._all:
            (positions, velocities, efforts), dofs = self._arrays, self._dofs
            return positions[self._qpos].copy(), velocities[dofs].copy(), efforts[dofs].copy()
        each = self.positions(names), self.velocities(names), self.efforts(names)
        return np.array(each[0]), np.array(each[1]), np.array(each[2])

    def positions(self, names: Sequence[str]) -> list[float]:
        """Return the measured positions."""
        return self._read(names, self._state.data.qpos, dofs=False)

    def velocities(self, names: Sequence[str]) -> list[float]:
        """Return the measured velocities."""
        return self._read(names, self._state.data.qvel)

    def efforts(self, names: Sequence[str]) -> list[float]:
        """Return the efforts that the motors exert."""
        return self._read(names, self._state.data.qfrc_actuator)

    def _read(self, names: Sequence[str], values: NDArray[np.float64], *, dofs: bool = True) -> list[float]:
        self._take(names)
        numbers: list[float] = values[self._dofs if dofs else self._qpos].tolist()
        if self._all:
            return numbers
        rest = iter(numbers)
        return [next(rest) if there else 0.0 for there in self._present]
