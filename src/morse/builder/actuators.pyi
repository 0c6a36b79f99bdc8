# Written by `python -m tools` from what the components declare: do not edit.

from typing import Any, Literal
from morse.builder.components.actuators_with_parts import Joystick as Joystick
from morse.builder.components.actuators_with_parts import LedArray as LedArray
from morse.builder.components.actuators_with_parts import Light as Light
from morse.builder.components.actuators_with_parts import MotionVWDiff as MotionVWDiff
from morse.builder.components.actuators_with_parts import PTU as PTU
from morse.builder.components.actuators_with_parts import Sound as Sound
from morse.builder.components.armatures import Armature as Armature
from morse.builder.components.armatures import KukaLWR as KukaLWR
from morse.builder.creator import ActuatorCreator as ActuatorCreator

__all__ = [
    "ActuatorCreator",
    "Armature",
    "Arucomarker",
    "Destination",
    "Drag",
    "ExternalForce",
    "ForceTorque",
    "Gripper",
    "Hydrodynamics",
    "Joystick",
    "Keyboard",
    "KukaLWR",
    "LedArray",
    "LiftDrag",
    "Light",
    "MotionVW",
    "MotionVWAckermann",
    "MotionVWDiff",
    "MotionXYW",
    "Orientation",
    "PA10",
    "PTU",
    "Propeller",
    "QuadrotorDynamicControl",
    "RotorcraftAttitude",
    "RotorcraftVelocity",
    "RotorcraftWaypoint",
    "Sound",
    "StabilizedQuadrotor",
    "SteerForce",
    "Teleport",
    "TimedPath",
    "Waypoint",
]

class Arucomarker(ActuatorCreator):
    """A marker for cameras with a controllable pose"""
    def properties(
        self, *, xoffset: float = ..., yoffset: float = ..., zoffset: float = ..., **kwargs: Any
    ) -> None: ...

class Destination(ActuatorCreator):
    """Motion controller which moves the robot on a straight line to a position"""
    def properties(
        self,
        *,
        ControlType: Literal["Velocity", "Position"] = ...,
        RemainAtDestination: bool = ...,
        Tolerance: float = ...,
        Speed: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Drag(ActuatorCreator):
    """Applies the resistance of air or water to the robot"""
    def properties(
        self, *, DragCoeffX: float = ..., DragCoeffY: float = ..., DragCoeffZ: float = ..., **kwargs: Any
    ) -> None: ...

class ExternalForce(ActuatorCreator):
    """Applies forces of the surroundings, such as wind, to the robot"""

class ForceTorque(ActuatorCreator):
    """Motion controller using force and torque to move a robot"""
    def properties(self, *, RobotFrame: bool = ..., **kwargs: Any) -> None: ...

class Gripper(ActuatorCreator):
    """Grasps and releases objects"""
    def properties(
        self, *, Angle: float = ..., Distance: float = ..., FingerSpeed: float = ..., **kwargs: Any
    ) -> None: ...

class Hydrodynamics(ActuatorCreator):
    """Applies buoyancy, drag and the current of water to the robot"""
    def properties(
        self,
        *,
        Surface: float = ...,
        Density: float = ...,
        Volume: float = ...,
        Length: float = ...,
        Width: float = ...,
        Height: float = ...,
        AddedMass: float = ...,
        WaveDamping: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Keyboard(ActuatorCreator):
    """Drives the robot by the keyboard of the live view"""
    def properties(
        self, *, ControlType: Literal["Position", "Velocity", "Differential"] = ..., Speed: float = ..., **kwargs: Any
    ) -> None: ...

class LiftDrag(ActuatorCreator):
    """Lift, drag and moment of a wing that moves through air or water"""
    def properties(
        self,
        *,
        Area: float = ...,
        Density: float = ...,
        ZeroAngle: float = ...,
        StallAngle: float = ...,
        LiftSlope: float = ...,
        DragSlope: float = ...,
        MomentSlope: float = ...,
        LiftSlopeStalled: float = ...,
        DragSlopeStalled: float = ...,
        MomentSlopeStalled: float = ...,
        Joint: str = ...,
        FlapLift: float = ...,
        **kwargs: Any,
    ) -> None: ...

class MotionVW(ActuatorCreator):
    """Motion controller using linear and angular speeds"""
    def properties(
        self,
        *,
        MaxSpeed: float = ...,
        MaxAcceleration: float = ...,
        MaxJerk: float = ...,
        MaxAngularSpeed: float = ...,
        MaxAngularAcceleration: float = ...,
        MaxAngularJerk: float = ...,
        ControlType: Literal["Velocity", "Position"] = ...,
        **kwargs: Any,
    ) -> None: ...

class MotionVWAckermann(ActuatorCreator):
    """Motion controller using linear and angular speeds, by driven and steered wheels"""
    def properties(
        self,
        *,
        MaxSpeed: float = ...,
        MaxAcceleration: float = ...,
        MaxJerk: float = ...,
        MaxAngularSpeed: float = ...,
        MaxAngularAcceleration: float = ...,
        MaxAngularJerk: float = ...,
        LeftWheels: str = ...,
        RightWheels: str = ...,
        LeftSteering: str = ...,
        RightSteering: str = ...,
        WheelRadius: float = ...,
        WheelBase: float = ...,
        WheelSeparation: float = ...,
        SteeringLimit: float = ...,
        **kwargs: Any,
    ) -> None: ...

class MotionXYW(ActuatorCreator):
    """Motion controller using linear (Vx, Vy) and angular speeds"""
    def properties(
        self,
        *,
        MaxSpeed: float = ...,
        MaxAcceleration: float = ...,
        MaxJerk: float = ...,
        MaxAngularSpeed: float = ...,
        MaxAngularAcceleration: float = ...,
        MaxAngularJerk: float = ...,
        ControlType: Literal["Velocity", "Position"] = ...,
        **kwargs: Any,
    ) -> None: ...

class Orientation(ActuatorCreator):
    """Motion controller which changes the orientation of the robot"""
    def properties(
        self,
        *,
        speed: float = ...,
        tolerance: float = ...,
        ControlType: Literal["Velocity", "Position"] = ...,
        **kwargs: Any,
    ) -> None: ...

class PA10(ActuatorCreator):
    """Turns the segments of a Mitsubishi PA-10 arm"""
    def properties(self, *, Speed: float = ..., Tolerance: float = ..., **kwargs: Any) -> None: ...

class Propeller(ActuatorCreator):
    """Thrust and torque of a propeller at a commanded speed"""
    def properties(
        self,
        *,
        Joint: str = ...,
        MotorConstant: float = ...,
        MomentConstant: float = ...,
        RotorDrag: float = ...,
        RollingMoment: float = ...,
        Direction: float = ...,
        TimeConstantUp: float = ...,
        TimeConstantDown: float = ...,
        MaxSpeed: float = ...,
        Slowdown: float = ...,
        **kwargs: Any,
    ) -> None: ...

class QuadrotorDynamicControl(ActuatorCreator):
    """Motion controller using the speeds of the rotors of a quadrotor"""
    def properties(
        self,
        *,
        ThrustFactor: float = ...,
        DragFactor: float = ...,
        Lever: float = ...,
        Configuration: Literal["+", "x"] = ...,
        **kwargs: Any,
    ) -> None: ...

class RotorcraftAttitude(ActuatorCreator):
    """Motion controller using force and torque to hold the attitude of a rotorcraft"""
    def properties(
        self,
        *,
        RollPitchPgain: float = ...,
        RollPitchDgain: float = ...,
        YawPgain: float = ...,
        YawDgain: float = ...,
        ThrustFactor: float = ...,
        LinearThrust: bool = ...,
        YawRateControl: bool = ...,
        UseAngleAgainstNorth: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class RotorcraftVelocity(ActuatorCreator):
    """Motion controller using force and torque to fly a rotorcraft at a velocity"""
    def properties(
        self,
        *,
        HorizontalPgain: float = ...,
        HorizontalDgain: float = ...,
        VerticalPgain: float = ...,
        YawPgain: float = ...,
        RollPitchPgain: float = ...,
        RollPitchDgain: float = ...,
        MaxBankAngle: float = ...,
        VerticalDgain: float = ...,
        YawDgain: float = ...,
        MaxVelocity: float = ...,
        **kwargs: Any,
    ) -> None: ...

class RotorcraftWaypoint(ActuatorCreator):
    """Motion controller using force and torque to fly a rotorcraft to a position"""
    def properties(
        self,
        *,
        HorizontalPgain: float = ...,
        HorizontalDgain: float = ...,
        VerticalPgain: float = ...,
        YawPgain: float = ...,
        RollPitchPgain: float = ...,
        RollPitchDgain: float = ...,
        MaxBankAngle: float = ...,
        VerticalDgain: float = ...,
        YawDgain: float = ...,
        RemainAtDestination: bool = ...,
        Target: str = ...,
        **kwargs: Any,
    ) -> None: ...

class StabilizedQuadrotor(ActuatorCreator):
    """Motion controller which moves a quadrotor with an autopilot, without forces"""

class SteerForce(ActuatorCreator):
    """Motion controller using steering, engine force and brakes of a car"""

class Teleport(ActuatorCreator):
    """Motion controller which instantly changes the pose of the robot"""

class TimedPath(ActuatorCreator):
    """Moves the robot along points, each at its time"""
    def properties(self, *, Points: str = ..., Loop: bool = ..., Delay: float = ..., **kwargs: Any) -> None: ...

class Waypoint(ActuatorCreator):
    """Motion controller which drives the robot to a position"""
    def properties(
        self,
        *,
        ControlType: Literal["Velocity", "Position"] = ...,
        RemainAtDestination: bool = ...,
        ObstacleAvoidance: bool = ...,
        FreeZ: bool = ...,
        AngleTolerance: float = ...,
        Speed: float = ...,
        Target: str = ...,
        Ignore: str = ...,
        **kwargs: Any,
    ) -> None: ...
