"""The motors of joints, and their largest loads.

A motor for positions is a spring and a damper between the joint and its setpoint,

    effort = k (setpoint - q) - d q'

and a motor for velocities is a damper, effort = d (setpoint - q'). If the file does not contain k and d, they are
computed from the largest load of the motor:

* from the moment of inertia I of the load, with all other joints stretched, and of the rotor of the file: k = I w^2
  with w = 50 rad/s;
* from the moment m g l of the weight of the load: k = m g l / 2 mrad, so that joints do not sag;
* in the leg of a robot that is not fixed, from the robot that stands on the leg: k = 10 m g l, with which it does not
  topple over its ankle (an inverted pendulum needs m g l);
* d = 2 sqrt(k I), critically damped. For a motor that controls a velocity, d = 10 I / h, where h is the time step. If
  such a motor has a largest effort, the joint lags by at most 0.1 rad/s (2 cm/s) and its rotor has at least the inertia
  d h / 2, since the largest effort would turn a lighter one past the speed within a step. The rotor of a wheel is no
  heavier than what the largest effort speeds up at 5 m/s^2, so that it does not slow down the start; the wheel then
  lags by more if it needs its largest effort.

In a robot that is not fixed, the largest effort of a joint without limits is at most the moment of the weight of the
rest of the robot about the joint, and what its own friction and damping take: a stronger wheel would throw the robot
over.

A motor for positions also gets a rotor with the inertia d h / 2, where h is the time step, like the motors and gears of
real robots. Without a rotor, a motor at its largest effort could reverse a light link within a step, and the link would
oscillate. The rotor does not change static efforts. A motor for efforts, or with gains in the file, has only the rotor
of the file.

The engine treats velocities implicitly, but not positions. A spring that is too stiff for the time step gets the
additional damping k h / 2, with which its motion is stable for any k: the step is then that of the trapezoidal rule. A
spring with the gain of a file does not, because its file is made for its time step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import mujoco
import numpy as np

from morse.mathutils.portable import norm
from morse.physics.model.layout import Motion
from morse.physics.poses.rigid import as_array
from morse.scene import Control
from morse.scene.extent import box_around
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.physics.model.articulated import AddedJoint, Group
    from morse.physics.model.layout import Frame
    from morse.scene import JointDynamics


#: natural frequency of a motor for positions, rad/s
_FREQUENCY = 50.0
#: largest sag, rad or m
_SAG = {False: 2e-3, True: 2e-4}
#: largest difference between the speed and the commanded speed of a motor with a largest effort, rad/s or m/s
_LAG = {False: 0.1, True: 0.02}
#: damping of a motor without a largest effort as a multiple of I / h
_GRIP = 10.0
#: stiffness of a leg as a multiple of the minimum with which a robot stands
_UPRIGHT = 10.0
#: k h^2 / I, above which a spring is too stiff for the time step
_STIFF = 0.25
#: largest effort of a joint without limits that carries an arm, as a multiple of the moment of its weight
_WHEEL = 2.0
#: speed at which such a joint overcomes its own damping, rad/s
_FAST = 20.0
#: acceleration of the tread of a wheel by its largest effort, m/s^2
_START = 5.0
_GRAVITY = 9.81

#: the arrays of a model of the engine that contain the settings of motors
ARRAYS = ("actuator_gainprm", "actuator_biasprm", "dof_armature", "dof_M0")


class Load(NamedTuple):
    """The load of a motor; values in brackets are those of prismatic joints.

    Attributes:
        inertia: largest moment of inertia of the load, kg m^2 (mass, kg).
        moment: largest moment of the weight of the load, N m (weight, N).
        body: moment of inertia of the rest of a robot that may stand on it, kg m^2 (mass, kg); 0 for a robot that is
            fixed.
        tilt: moment of the weight of this rest, N m (weight, N).
        slides: whether the joint is prismatic.
        radius: of a wheel of a robot that is not fixed, m; otherwise 0.
    """

    inertia: float
    moment: float
    body: float
    tilt: float
    slides: bool
    radius: float = 0.0


class Setting(NamedTuple):
    """The setting of a motor in the engine: effort = gain * command - stiffness * q - damping * q'.

    Attributes:
        rotor: moment of inertia of the rotor at the joint, kg m^2 (mass, kg).
    """

    gain: float
    stiffness: float
    damping: float
    rotor: float


@dataclass(frozen=True, slots=True)
class Motor:
    """The motor of a joint, in any control mode.

    Attributes:
        dynamics: limits, and gains of the file.
        load: load of the motor.
        step: time step of the engine, s.
    """

    dynamics: JointDynamics
    load: Load
    step: float

    @property
    def effort(self) -> float:
        """The largest effort, N m (N): wheels are at most as strong as what throws their robot over."""
        dynamics, load = self.dynamics, self.load
        if dynamics.limited or load.slides or not load.tilt:
            return dynamics.effort
        taken = dynamics.friction + dynamics.damping * _FAST
        return min(dynamics.effort, max(load.tilt, _WHEEL * load.moment) + taken)

    def setting(self, control: Control) -> Setting:
        """Return the setting for a control mode."""
        dynamics, load, step = self.dynamics, self.load, self.step
        own = dynamics.control is control or (dynamics.control is None and control is Control.POSITION)
        gain = dynamics.gain if own else None
        rotor = dynamics.inertia
        inertia = max(load.inertia + rotor, 1e-6)
        if control is Control.EFFORT:
            return Setting(1.0, 0.0, 0.0, rotor)
        if control is Control.VELOCITY:
            if gain is None and math.isfinite(self.effort):
                gain = max(inertia / step, self.effort / _LAG[load.slides])
                if load.radius:
                    own_friction = 5.0 * dynamics.friction / _LAG[load.slides]
                    heaviest = max(inertia, self.effort * load.radius / _START)
                    gain = min(gain, max(2.0 * heaviest / step, own_friction))
                rotor = max(rotor, 0.5 * gain * step - load.inertia)
            elif gain is None:
                rotor = max(rotor, inertia)
                gain = _GRIP * max(inertia, load.body) / step
            else:
                return Setting(gain, 0.0, gain, rotor)
            # the damping of the joint takes its part of the effort
            return Setting(gain + dynamics.damping, 0.0, gain, rotor)
        slowing = dynamics.slowing if own else None
        if gain is None:
            gain = max(inertia * _FREQUENCY**2, load.moment / _SAG[load.slides])
            usual = 2.0 * math.sqrt(gain * inertia)
            leg = _UPRIGHT * load.tilt
            gain, usual = max(gain, leg), max(usual, 2.0 * math.sqrt(leg * load.body))
            slowing = usual if slowing is None else slowing
            rotor = max(rotor, 0.5 * usual * step)
        elif slowing is None:
            slowing = 2.0 * math.sqrt(gain * inertia)
        if not (own and dynamics.gain) and gain * step * step > _STIFF * (rotor + load.inertia):
            slowing += 0.5 * gain * step
        return Setting(gain, gain, slowing, rotor)

    def add_to(self, actuator: mujoco.MjsActuator, joint: mujoco.MjsJoint, control: Control) -> None:
        """Set up an actuator of a `mujoco.MjSpec` at a joint."""
        setting = self.setting(control)
        actuator.dyntype, actuator.gaintype = mujoco.mjtDyn.mjDYN_NONE, mujoco.mjtGain.mjGAIN_FIXED
        actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        actuator.gainprm[0] = setting.gain
        actuator.biasprm[1], actuator.biasprm[2] = -setting.stiffness, -setting.damping
        joint.armature = setting.rotor
        if math.isfinite(self.effort):
            actuator.forcelimited, actuator.forcerange = True, [-self.effort, self.effort]


def write(arrays: Mapping[str, NDArray[np.float64]], actuator: int, dof: int, setting: Setting) -> None:
    """Write a setting into arrays of a model; the names are those of MuJoCo."""
    arrays["actuator_gainprm"][actuator, 0] = setting.gain
    arrays["actuator_biasprm"][actuator, 1:3] = -setting.stiffness, -setting.damping
    # the engine reads the inertia of a joint that no other joint moves from this array
    arrays["dof_M0"][dof] += setting.rotor - arrays["dof_armature"][dof]
    arrays["dof_armature"][dof] = setting.rotor


def control_of(bias: NDArray[np.float64]) -> Control:
    """Return the control mode of a motor, given its row of ``actuator_biasprm``."""
    if bias[1]:
        return Control.POSITION
    return Control.VELOCITY if bias[2] else Control.EFFORT


def weight(mass: float, reach: float) -> float:
    """Return the moment of the weight of a mass at a distance, N m."""
    return _GRAVITY * mass * reach


class _Stretched(NamedTuple):
    """A part of a robot whose joints are all stretched, seen from a point.

    Attributes:
        mass: kg.
        first: sum of mass times distance, kg m.
        second: sum of mass times squared distance, kg m^2.
        inertia: sum of the largest moments of inertia of the links about their centres, kg m^2.
    """

    mass: float
    first: float
    second: float
    inertia: float

    def moved(self, length: float) -> _Stretched:
        """Return the part as seen from a point that is farther away by a length, m."""
        first = self.first + self.mass * length
        return _Stretched(self.mass, first, self.second + length * (self.first + first), self.inertia)


class _Tree:
    """The links of a robot whose base is free: those below a link follow it in one piece."""

    def __init__(self, frames: Sequence[Frame], groups: Mapping[Frame, Group]) -> None:
        self._masses = np.array([groups[frame].mass for frame in frames])
        self._centres = np.array([groups[frame].centre for frame in frames])
        self._first = {frame: number for number, frame in enumerate(frames)}

    def without(self, frame: Frame, count: int, anchor: NDArray[np.float64]) -> tuple[float, float, float]:
        """Return mass, moment of inertia and moment of weight about a point, without a frame and what is below it.

        Args:
            count: number of these frames.
        """
        first = self._first[frame]
        mass = np.delete(self._masses, slice(first, first + count))
        x, y, z = (np.delete(self._centres, slice(first, first + count), axis=0) - anchor).T
        reach = np.sqrt(x * x + y * y + z * z)
        return _sum(mass), _sum(mass * reach * reach), weight(_sum(mass * reach), 1.0)


class Loads:
    """The loads of the motors of all robots of a scene.

    Args:
        groups: the moving frames, parents before their children.
    """

    def __init__(self, groups: Mapping[Frame, Group]) -> None:
        self._groups = groups
        self._below: dict[Frame, list[Frame]] = {}
        for frame in groups:
            if frame.motion is Motion.JOINT and frame.parent is not None:
                self._below.setdefault(frame.parent, []).append(frame)
        self._stretched: dict[Frame, _Stretched] = {}
        self._counts: dict[Frame, int] = {}
        for frame in reversed(list(groups)):
            self._counts[frame] = 1 + sum(self._counts[child] for child in self._below.get(frame, ()))
            if groups[frame].joints:
                self._stretched[frame] = self._reached(frame, groups[frame].joints[0].anchor)
        self._trees: dict[Frame, _Tree] = {}

    def of(self, entry: AddedJoint, *, slides: bool) -> Load:
        """Return the largest load of the motor of a joint, whatever the other joints do.

        Args:
            slides: whether the joint is prismatic.
        """
        load = self._reached(entry.frame, entry.anchor)
        root = root_of(entry.frame)
        mass, inertia, moment, down = 0.0, 0.0, 0.0, 0.0
        if root.motion is Motion.FREE:
            if root not in self._trees:
                self._trees[root] = _Tree(self._below_first(root), self._groups)
            mass, inertia, moment = self._trees[root].without(entry.frame, self._counts[entry.frame], entry.anchor)
        down = _reach_down(entry) if mass and not entry.limit.limited else 0.0
        if slides:
            return Load(load.mass, weight(load.mass, 1.0), mass, weight(mass, 1.0), slides)
        return Load(load.second + load.inertia, weight(load.first, 1.0), inertia, moment, slides, down)

    def _reached(self, frame: Frame, anchor: NDArray[np.float64]) -> _Stretched:
        """Return a frame and what is below it, as seen from a joint of the frame."""
        group = self._groups[frame]
        own = _Stretched(group.mass, 0.0, 0.0, group.moment)
        parts = [own.moved(norm(group.centre - anchor))]
        parts += [
            self._stretched[child].moved(norm(self._groups[child].joints[0].anchor - anchor))
            if child in self._stretched
            else self._reached(child, anchor)  # fixed to the frame
            for child in self._below.get(frame, ())
        ]
        return _Stretched(*map(sum, zip(*parts, strict=True)))

    def _below_first(self, root: Frame) -> list[Frame]:
        """Return a frame and those below it; each is followed by those below it."""
        order, queue = [], [root]
        while queue:
            order.append(queue.pop())
            queue += self._below.get(order[-1], ())
        return order


def _reach_down(entry: AddedJoint) -> float:
    """Return how far the shapes that a joint moves reach below it, m: the radius of a wheel."""
    frame = entry.frame
    lows = [
        float(box_around(shape, np.array(place.position), as_array(place.rotation))[0][2])
        for node in frame.solid
        for place in (rigid_frame(node),)
        for shape in node.shapes or ()
    ]
    return max(0.0, float(entry.anchor[2]) - min(lows)) if lows else 0.0


def root_of(frame: Frame) -> Frame:
    """Return the frame that carries the joints of a frame."""
    while frame.motion is Motion.JOINT:
        assert frame.parent is not None
        frame = frame.parent
    return frame


def _sum(values: NDArray[np.float64]) -> float:
    """Return the sum in the order of the values: other sums of numpy depend on the processor."""
    return float(np.cumsum(values)[-1]) if len(values) else 0.0
