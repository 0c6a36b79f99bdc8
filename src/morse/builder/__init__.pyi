# Written by `python -m tools` from what the components declare: do not edit.

from morse import mathutils as mathutils
from morse.builder import actuators as actuators
from morse.builder import bpymorse as bpymorse
from morse.builder import robots as robots
from morse.builder import sensors as sensors
from morse.builder.abstractcomponent import AbstractComponent as AbstractComponent
from morse.builder.actuators import Arucomarker as Arucomarker
from morse.builder.actuators import Destination as Destination
from morse.builder.actuators import Drag as Drag
from morse.builder.actuators import ExternalForce as ExternalForce
from morse.builder.actuators import ForceTorque as ForceTorque
from morse.builder.actuators import Gripper as Gripper
from morse.builder.actuators import Hydrodynamics as Hydrodynamics
from morse.builder.actuators import Keyboard as Keyboard
from morse.builder.actuators import LiftDrag as LiftDrag
from morse.builder.actuators import MotionVW as MotionVW
from morse.builder.actuators import MotionVWAckermann as MotionVWAckermann
from morse.builder.actuators import MotionXYW as MotionXYW
from morse.builder.actuators import Orientation as Orientation
from morse.builder.actuators import PA10 as PA10
from morse.builder.actuators import Propeller as Propeller
from morse.builder.actuators import QuadrotorDynamicControl as QuadrotorDynamicControl
from morse.builder.actuators import RotorcraftAttitude as RotorcraftAttitude
from morse.builder.actuators import RotorcraftVelocity as RotorcraftVelocity
from morse.builder.actuators import RotorcraftWaypoint as RotorcraftWaypoint
from morse.builder.actuators import StabilizedQuadrotor as StabilizedQuadrotor
from morse.builder.actuators import SteerForce as SteerForce
from morse.builder.actuators import Teleport as Teleport
from morse.builder.actuators import TimedPath as TimedPath
from morse.builder.actuators import Waypoint as Waypoint
from morse.builder.components.actuators_with_parts import Joystick as Joystick
from morse.builder.components.actuators_with_parts import LedArray as LedArray
from morse.builder.components.actuators_with_parts import Light as Light
from morse.builder.components.actuators_with_parts import MotionVWDiff as MotionVWDiff
from morse.builder.components.actuators_with_parts import PTU as PTU
from morse.builder.components.actuators_with_parts import Sound as Sound
from morse.builder.components.armatures import Armature as Armature
from morse.builder.components.armatures import KukaLWR as KukaLWR
from morse.builder.components.component import Component as Component
from morse.builder.components.passive import PassiveObject as PassiveObject
from morse.builder.components.passive import Zone as Zone
from morse.builder.components.robot import GroundRobot as GroundRobot
from morse.builder.components.robot import Robot as Robot
from morse.builder.components.robot import WheeledRobot as WheeledRobot
from morse.builder.components.robots import BarePR2 as BarePR2
from morse.builder.components.robots import BasePR2 as BasePR2
from morse.builder.components.robots import Human as Human
from morse.builder.components.robots import LocalizedPR2 as LocalizedPR2
from morse.builder.components.robots import Morsy as Morsy
from morse.builder.components.robots import NavPR2 as NavPR2
from morse.builder.components.sensors import CameraCreator as CameraCreator
from morse.builder.components.sensors import CompoundSensor as CompoundSensor
from morse.builder.components.sensors import Kinect as Kinect
from morse.builder.components.sensors import LaserSensorWithArc as LaserSensorWithArc
from morse.builder.components.sensors import VLP16_180 as VLP16_180
from morse.builder.components.solids import Camera as Camera
from morse.builder.components.solids import Cone as Cone
from morse.builder.components.solids import Coordsys as Coordsys
from morse.builder.components.solids import Cube as Cube
from morse.builder.components.solids import Cylinder as Cylinder
from morse.builder.components.solids import Empty as Empty
from morse.builder.components.solids import IcoSphere as IcoSphere
from morse.builder.components.solids import Mesh as Mesh
from morse.builder.components.solids import Plane as Plane
from morse.builder.components.solids import Sphere as Sphere
from morse.builder.components.solids import Spot as Spot
from morse.builder.components.solids import Torus as Torus
from morse.builder.creator import ActuatorCreator as ActuatorCreator
from morse.builder.creator import ComponentCreator as ComponentCreator
from morse.builder.creator import SensorCreator as SensorCreator
from morse.builder.data import Configuration as Configuration
from morse.builder.environment.environment import Environment as Environment
from morse.builder.robots import ATRV as ATRV
from morse.builder.robots import B21 as B21
from morse.builder.robots import FakeRobot as FakeRobot
from morse.builder.robots import Hummer as Hummer
from morse.builder.robots import Jido as Jido
from morse.builder.robots import PatrolBot as PatrolBot
from morse.builder.robots import Pioneer3DX as Pioneer3DX
from morse.builder.robots import QUAD2012 as QUAD2012
from morse.builder.robots import Quadrotor as Quadrotor
from morse.builder.robots import RMax as RMax
from morse.builder.robots import SegwayRMP400 as SegwayRMP400
from morse.builder.robots import Submarine as Submarine
from morse.builder.robots import Victim as Victim
from morse.builder.sensors import ADIS16448 as ADIS16448
from morse.builder.sensors import Accelerometer as Accelerometer
from morse.builder.sensors import Airspeed as Airspeed
from morse.builder.sensors import ArmaturePose as ArmaturePose
from morse.builder.sensors import Attitude as Attitude
from morse.builder.sensors import BMI088 as BMI088
from morse.builder.sensors import Barometer as Barometer
from morse.builder.sensors import Battery as Battery
from morse.builder.sensors import Bumper as Bumper
from morse.builder.sensors import Clock as Clock
from morse.builder.sensors import Collision as Collision
from morse.builder.sensors import ContactForce as ContactForce
from morse.builder.sensors import DepthCamera as DepthCamera
from morse.builder.sensors import DepthCameraAggregator as DepthCameraAggregator
from morse.builder.sensors import DepthCameraRotationZ as DepthCameraRotationZ
from morse.builder.sensors import DepthVideoCamera as DepthVideoCamera
from morse.builder.sensors import ForceTorqueSensor as ForceTorqueSensor
from morse.builder.sensors import GPS as GPS
from morse.builder.sensors import Gyroscope as Gyroscope
from morse.builder.sensors import Hokuyo as Hokuyo
from morse.builder.sensors import HumanPosture as HumanPosture
from morse.builder.sensors import IMU as IMU
from morse.builder.sensors import Infrared as Infrared
from morse.builder.sensors import LaserScanner as LaserScanner
from morse.builder.sensors import Magnetometer as Magnetometer
from morse.builder.sensors import NormalCamera as NormalCamera
from morse.builder.sensors import Odometry as Odometry
from morse.builder.sensors import OpticalFlowCamera as OpticalFlowCamera
from morse.builder.sensors import PTUPosture as PTUPosture
from morse.builder.sensors import Pose as Pose
from morse.builder.sensors import Proximity as Proximity
from morse.builder.sensors import RadarAltimeter as RadarAltimeter
from morse.builder.sensors import RangeFinder as RangeFinder
from morse.builder.sensors import RawImage as RawImage
from morse.builder.sensors import SearchAndRescue as SearchAndRescue
from morse.builder.sensors import SegmentationCamera as SegmentationCamera
from morse.builder.sensors import SemanticCamera as SemanticCamera
from morse.builder.sensors import Sick as Sick
from morse.builder.sensors import SickLDMRS as SickLDMRS
from morse.builder.sensors import StereoUnit as StereoUnit
from morse.builder.sensors import ThermalCamera as ThermalCamera
from morse.builder.sensors import Thermometer as Thermometer
from morse.builder.sensors import UltrasonicRangeFinder as UltrasonicRangeFinder
from morse.builder.sensors import VLP16 as VLP16
from morse.builder.sensors import VN100 as VN100
from morse.builder.sensors import Velocity as Velocity
from morse.builder.sensors import Velodyne as Velodyne
from morse.builder.sensors import VelodyneRayCast as VelodyneRayCast
from morse.builder.sensors import VelodyneZB as VelodyneZB
from morse.builder.sensors import VideoCamera as VideoCamera
from morse.builder.sensors import WheelEncoders as WheelEncoders
from morse.core.exceptions import BadSyntaxError as BadSyntaxError
from morse.core.exceptions import MorseBuilderBadSyntaxError as MorseBuilderBadSyntaxError
from morse.core.exceptions import MorseBuilderError as MorseBuilderError
from morse.core.exceptions import MorseBuilderNoComponentError as MorseBuilderNoComponentError
from morse.core.exceptions import MorseBuilderUnexportableError as MorseBuilderUnexportableError
from morse.core.exceptions import MorseDeclarationError as MorseDeclarationError
from morse.core.exceptions import MorseEnvironmentError as MorseEnvironmentError
from morse.core.exceptions import MorseError as MorseError
from morse.core.exceptions import MorseMethodNotFoundError as MorseMethodNotFoundError
from morse.core.exceptions import MorseMiddlewareError as MorseMiddlewareError
from morse.core.exceptions import MorseMultinodeError as MorseMultinodeError
from morse.core.exceptions import MorseRPCInvokationError as MorseRPCInvokationError
from morse.core.exceptions import MorseRPCNbArgsError as MorseRPCNbArgsError
from morse.core.exceptions import MorseRPCTypeError as MorseRPCTypeError
from morse.core.exceptions import MorseServiceAlreadyRunningError as MorseServiceAlreadyRunningError
from morse.core.exceptions import MorseServiceError as MorseServiceError
from morse.core.exceptions import MorseWrongArgsError as MorseWrongArgsError
from morse.core.exceptions import NoComponentError as NoComponentError
from morse.core.exceptions import UnexportableError as UnexportableError
from morse.plugins.facilities.builder import Button as Button
from morse.plugins.facilities.builder import Door as Door
from morse.plugins.facilities.builder import Gate as Gate
from morse.plugins.facilities.builder import Lift as Lift
from morse.plugins.facilities.builder import Stairs as Stairs
from morse.plugins.facilities.builder import TrafficLight as TrafficLight
from morse.plugins.facilities.handling import Charger as Charger
from morse.plugins.facilities.handling import Conveyor as Conveyor
from morse.plugins.facilities.handling import Dispenser as Dispenser
from morse.plugins.facilities.handling import Forklift as Forklift
from morse.plugins.facilities.handling import Turntable as Turntable
from morse.plugins.people.builder import Crowd as Crowd
from morse.plugins.sun.builder import StreetLamp as StreetLamp
from morse.plugins.traffic.builder import Traffic as Traffic
from morse.scene.scene import TimeStrategies as TimeStrategies
from typing import Any, Literal
import logging as logging
import math as math
import os as os
import pprint as pprint
import sys as sys

__all__ = [
    "ADIS16448",
    "ARS408",
    "ATRV",
    "AbstractComponent",
    "Accelerometer",
    "AcousticModem",
    "ActuatorCreator",
    "Airspeed",
    "Armature",
    "ArmaturePose",
    "Arucomarker",
    "Attitude",
    "B21",
    "BMI088",
    "BadSyntaxError",
    "BarePR2",
    "Barometer",
    "BasePR2",
    "Battery",
    "Bumper",
    "BumperStrip",
    "Button",
    "Camera",
    "Charger",
    "Clock",
    "Collision",
    "ColorSensor",
    "Component",
    "ComponentCreator",
    "CompoundSensor",
    "Cone",
    "Configuration",
    "ContactForce",
    "Conveyor",
    "Coordsys",
    "Crowd",
    "Cube",
    "Cylinder",
    "DAVIS346",
    "DVL",
    "DVL1000",
    "DVLA50",
    "DepthCamera",
    "DepthCameraAggregator",
    "DepthCameraRotationZ",
    "DepthVideoCamera",
    "Destination",
    "Dispenser",
    "Door",
    "DoorRequest",
    "DoorState",
    "Drag",
    "EchoSounder",
    "Empty",
    "Environment",
    "EventCamera",
    "ExternalForce",
    "FakeRobot",
    "ForceTorque",
    "ForceTorqueSensor",
    "Forklift",
    "GNSSReceiver",
    "GPS",
    "GasSensor",
    "Gate",
    "GeigerCounter",
    "Gripper",
    "GroundRobot",
    "Gyroscope",
    "Hokuyo",
    "Human",
    "HumanPosture",
    "Hummer",
    "Hydrodynamics",
    "IMU",
    "IRRange",
    "IcoSphere",
    "ImagingSonar",
    "Infrared",
    "Jido",
    "Joystick",
    "Keyboard",
    "Kinect",
    "KukaLWR",
    "LaserScanner",
    "LaserSensorWithArc",
    "LedArray",
    "Lift",
    "LiftDrag",
    "LiftRequest",
    "LiftState",
    "Light",
    "LineSensor",
    "LocalizedPR2",
    "Magnetometer",
    "Mesh",
    "Microphone",
    "MorseBuilderBadSyntaxError",
    "MorseBuilderError",
    "MorseBuilderNoComponentError",
    "MorseBuilderUnexportableError",
    "MorseDeclarationError",
    "MorseEnvironmentError",
    "MorseError",
    "MorseMethodNotFoundError",
    "MorseMiddlewareError",
    "MorseMultinodeError",
    "MorseRPCInvokationError",
    "MorseRPCNbArgsError",
    "MorseRPCTypeError",
    "MorseServiceAlreadyRunningError",
    "MorseServiceError",
    "MorseWrongArgsError",
    "Morsy",
    "MotionVW",
    "MotionVWAckermann",
    "MotionVWDiff",
    "MotionXYW",
    "MotorSensor",
    "MultibeamSonar",
    "NavPR2",
    "NoComponentError",
    "NormalCamera",
    "OculusM750d",
    "Odometry",
    "OpticalFlowCamera",
    "Orientation",
    "PA10",
    "PTU",
    "PTUPosture",
    "PassiveObject",
    "PatrolBot",
    "PeopleTracker",
    "Ping1D",
    "Pioneer3DX",
    "Plane",
    "Pose",
    "Propeller",
    "Proximity",
    "QUAD2012",
    "Quadrotor",
    "QuadrotorDynamicControl",
    "RFIDReader",
    "RMax",
    "Radar",
    "RadarAltimeter",
    "Radio",
    "RangeFinder",
    "RawImage",
    "Robot",
    "RotorcraftAttitude",
    "RotorcraftVelocity",
    "RotorcraftWaypoint",
    "SeaTracX150",
    "SearchAndRescue",
    "SegmentationCamera",
    "SegwayRMP400",
    "SemanticCamera",
    "SensorCreator",
    "SharpGP2Y0A21",
    "Sick",
    "SickLDMRS",
    "SideScanSonar",
    "SonicR2024",
    "Sound",
    "Sphere",
    "Spot",
    "StabilizedQuadrotor",
    "Stairs",
    "StarFish450F",
    "SteerForce",
    "StereoUnit",
    "StreetLamp",
    "Submarine",
    "TactileArray",
    "Teleport",
    "ThermalCamera",
    "Thermometer",
    "TimeStrategies",
    "TimedPath",
    "Torus",
    "Traffic",
    "TrafficLight",
    "Turntable",
    "USBL",
    "UWB",
    "UltrasonicRangeFinder",
    "UnexportableError",
    "VLP16",
    "VLP16_180",
    "VN100",
    "Velocity",
    "Velodyne",
    "VelodyneRayCast",
    "VelodyneZB",
    "Victim",
    "VideoCamera",
    "Waypoint",
    "WheelEncoders",
    "WheeledRobot",
    "Whiskers",
    "Zone",
    "bpymorse",
    "logger",
    "logging",
    "math",
    "mathutils",
    "os",
    "pprint",
    "sys",
]
logger: logging.Logger

class DoorState(SensorCreator):
    """The state of a door or a gate, as messages"""

class LiftState(SensorCreator):
    """The state of a lift, as messages"""

class DoorRequest(ActuatorCreator):
    """Opens and closes a door or a gate by messages"""

class LiftRequest(ActuatorCreator):
    """Calls a lift by messages"""

class PeopleTracker(SensorCreator):
    """Measures positions and velocities of the people around a robot"""
    def properties(self, *, Range: float = ..., Occlusion: bool = ..., **kwargs: Any) -> None: ...

class ARS408(SensorCreator):
    """A Continental ARS 408-21, far scan: 250 m, 18 degrees, resolution of 1.79 m and 1.6 degrees."""
    def properties(
        self,
        *,
        carrier: float = ...,
        bandwidth: float = ...,
        range_bins: int = ...,
        doppler_bins: int = ...,
        max_velocity: float = ...,
        azimuth_fov: float = ...,
        elevation_fov: float = ...,
        ray_spacing: float = ...,
        azimuth_resolution: float = ...,
        sensitivity: float = ...,
        ground_reflection: float = ...,
        most_detections: int = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class AcousticModem(SensorCreator):
    """Packets through water, with loss, delay and collisions"""
    def properties(
        self,
        *,
        channel: int = ...,
        carrier: float = ...,
        power: float = ...,
        sensitivity: float = ...,
        wall_loss: float = ...,
        bit_rate: float = ...,
        capture: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        **kwargs: Any,
    ) -> None: ...

class BumperStrip(SensorCreator):
    """A strip of switches along an arc"""
    def properties(
        self, *, segments: int = ..., radius: float = ..., arc: float = ..., travel: float = ..., **kwargs: Any
    ) -> None: ...

class ColorSensor(CameraCreator):
    """Mean colour in a narrow cone"""
    def properties(
        self,
        *,
        cam_width: int = ...,
        cam_height: int = ...,
        cam_focal: float = ...,
        cam_fov: float = ...,
        cam_near: float = ...,
        cam_far: float = ...,
        Vertical_Flip: bool = ...,
        retrieve_depth: bool = ...,
        retrieve_zbuffer: bool = ...,
        lens_model: Literal["plumb_bob", "equidistant"] = ...,
        distortion: str = ...,
        screen_space_error: float = ...,
        on_demand: bool = ...,
        capturing: bool = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class DAVIS346(CameraCreator):
    """An iniVation DAVIS346: 346 x 260 pixels, threshold 14.3 %, deviation 3.5 %."""
    def properties(
        self,
        *,
        cam_width: int = ...,
        cam_height: int = ...,
        cam_focal: float = ...,
        cam_fov: float = ...,
        cam_near: float = ...,
        cam_far: float = ...,
        Vertical_Flip: bool = ...,
        retrieve_depth: bool = ...,
        retrieve_zbuffer: bool = ...,
        lens_model: Literal["plumb_bob", "equidistant"] = ...,
        distortion: str = ...,
        screen_space_error: float = ...,
        on_demand: bool = ...,
        capturing: bool = ...,
        threshold: float = ...,
        threshold_deviation: float = ...,
        refractory_period: float = ...,
        noise_rate: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class DVL(SensorCreator):
    """Doppler velocity log: velocity over the ground, altitude"""
    def properties(
        self,
        *,
        beam_angle: float = ...,
        min_altitude: float = ...,
        max_altitude: float = ...,
        water_track: bool = ...,
        current_x: float = ...,
        current_y: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        scale_error: float = ...,
        noise: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class DVL1000(SensorCreator):
    """A Nortek DVL1000: 0.2 to 75 m, four beams at 25 degrees, 0.1 % and 0.1 cm/s."""
    def properties(
        self,
        *,
        beam_angle: float = ...,
        min_altitude: float = ...,
        max_altitude: float = ...,
        water_track: bool = ...,
        current_x: float = ...,
        current_y: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        scale_error: float = ...,
        noise: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class DVLA50(SensorCreator):
    """A Water Linked DVL A50: 0.05 to 50 m, four beams at 22.5 degrees, 1.01 % and 0.1 cm/s."""
    def properties(
        self,
        *,
        beam_angle: float = ...,
        min_altitude: float = ...,
        max_altitude: float = ...,
        water_track: bool = ...,
        current_x: float = ...,
        current_y: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        scale_error: float = ...,
        noise: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class EchoSounder(SensorCreator):
    """Depth of the ground below by sound"""
    def properties(
        self,
        *,
        beam_width: float = ...,
        min_range: float = ...,
        max_range: float = ...,
        carrier: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        assumed_speed: float = ...,
        resolution: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class EventCamera(CameraCreator):
    """A camera that reports changes of the brightness of pixels"""
    def properties(
        self,
        *,
        cam_width: int = ...,
        cam_height: int = ...,
        cam_focal: float = ...,
        cam_fov: float = ...,
        cam_near: float = ...,
        cam_far: float = ...,
        Vertical_Flip: bool = ...,
        retrieve_depth: bool = ...,
        retrieve_zbuffer: bool = ...,
        lens_model: Literal["plumb_bob", "equidistant"] = ...,
        distortion: str = ...,
        screen_space_error: float = ...,
        on_demand: bool = ...,
        capturing: bool = ...,
        threshold: float = ...,
        threshold_deviation: float = ...,
        refractory_period: float = ...,
        noise_rate: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class GNSSReceiver(SensorCreator):
    """Position by satellites, with multipath among buildings"""
    def properties(
        self, *, reflection: float = ..., range_noise: float = ..., errors: bool = ..., **kwargs: Any
    ) -> None: ...

class GasSensor(SensorCreator):
    """Concentration of gas in plumes of puffs"""
    def properties(
        self,
        *,
        diffusion: float = ...,
        turbulence: float = ...,
        interval: float = ...,
        lifetime: float = ...,
        **kwargs: Any,
    ) -> None: ...

class GeigerCounter(SensorCreator):
    """Counts rays of radioactive sources behind shields"""
    def properties(self, *, area: float = ..., background: float = ..., errors: bool = ..., **kwargs: Any) -> None: ...

class IRRange(SensorCreator):
    """Distance by infrared triangulation, with its voltage"""
    def properties(
        self,
        *,
        min_range: float = ...,
        max_range: float = ...,
        scale: float = ...,
        exponent: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class ImagingSonar(SensorCreator):
    """Multibeam forward-looking sonar: an image by range and angle"""
    def properties(
        self,
        *,
        beams: int = ...,
        bins: int = ...,
        elevation_rays: int = ...,
        fov: float = ...,
        elevation: float = ...,
        max_range: float = ...,
        carrier: float = ...,
        gain: float = ...,
        noise: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class LineSensor(CameraCreator):
    """A row of reflectance sensors that finds a line"""
    def properties(
        self,
        *,
        cam_width: int = ...,
        cam_height: int = ...,
        cam_focal: float = ...,
        cam_fov: float = ...,
        cam_near: float = ...,
        cam_far: float = ...,
        Vertical_Flip: bool = ...,
        retrieve_depth: bool = ...,
        retrieve_zbuffer: bool = ...,
        lens_model: Literal["plumb_bob", "equidistant"] = ...,
        distortion: str = ...,
        screen_space_error: float = ...,
        on_demand: bool = ...,
        capturing: bool = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class Microphone(SensorCreator):
    """Level of sound, and direction of the loudest source"""
    def properties(self, *, floor: float = ..., wall_loss: float = ..., **kwargs: Any) -> None: ...

class MotorSensor(SensorCreator):
    """Current and temperature of the motor of a joint"""
    def properties(
        self,
        *,
        axis: Literal["x", "y", "z"] = ...,
        torque_constant: float = ...,
        gear: float = ...,
        resistance: float = ...,
        thermal_resistance: float = ...,
        thermal_capacity: float = ...,
        ambient: float = ...,
        **kwargs: Any,
    ) -> None: ...

class MultibeamSonar(SensorCreator):
    """Depth profile across the track"""
    def properties(
        self,
        *,
        beams: int = ...,
        fov: float = ...,
        max_range: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        gradient: float = ...,
        assumed_speed: float = ...,
        **kwargs: Any,
    ) -> None: ...

class OculusM750d(SensorCreator):
    """A Blueprint Subsea Oculus M750d at 750 kHz: 512 beams, 130 x 20 degrees, up to 120 m."""
    def properties(
        self,
        *,
        beams: int = ...,
        bins: int = ...,
        elevation_rays: int = ...,
        fov: float = ...,
        elevation: float = ...,
        max_range: float = ...,
        carrier: float = ...,
        gain: float = ...,
        noise: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class Ping1D(SensorCreator):
    """A Blue Robotics Ping: 0.3 to 100 m, 25 degrees, 115 kHz; resolution 0.5 % of the range."""
    def properties(
        self,
        *,
        beam_width: float = ...,
        min_range: float = ...,
        max_range: float = ...,
        carrier: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        assumed_speed: float = ...,
        resolution: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class RFIDReader(SensorCreator):
    """Reads tags in its beam"""
    def properties(
        self,
        *,
        carrier: float = ...,
        power: float = ...,
        tag_sensitivity: float = ...,
        beam: float = ...,
        wall_loss: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Radar(SensorCreator):
    """Measures range, angle, velocity and cross-section of reflecting objects"""
    def properties(
        self,
        *,
        carrier: float = ...,
        bandwidth: float = ...,
        range_bins: int = ...,
        doppler_bins: int = ...,
        max_velocity: float = ...,
        azimuth_fov: float = ...,
        elevation_fov: float = ...,
        ray_spacing: float = ...,
        azimuth_resolution: float = ...,
        sensitivity: float = ...,
        ground_reflection: float = ...,
        most_detections: int = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class Radio(SensorCreator):
    """Packets between robots, with loss, delay and collisions"""
    def properties(
        self,
        *,
        channel: int = ...,
        carrier: float = ...,
        power: float = ...,
        sensitivity: float = ...,
        wall_loss: float = ...,
        bit_rate: float = ...,
        capture: float = ...,
        **kwargs: Any,
    ) -> None: ...

class SeaTracX150(SensorCreator):
    """A Blueprint Subsea SeaTrac X150: 1 km, 1 degree."""
    def properties(
        self,
        *,
        max_range: float = ...,
        angle_error: float = ...,
        range_error: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class SharpGP2Y0A21(SensorCreator):
    """A Sharp GP2Y0A21YK0F: 10 to 80 cm, 26 Hz, with its noise."""
    def properties(
        self,
        *,
        min_range: float = ...,
        max_range: float = ...,
        scale: float = ...,
        exponent: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class SideScanSonar(SensorCreator):
    """An image of the bottom on both sides of the track"""
    def properties(
        self,
        *,
        pings: int = ...,
        samples: int = ...,
        rays_per_side: int = ...,
        max_range: float = ...,
        gain: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class SonicR2024(SensorCreator):
    """An R2Sonic 2024: 256 beams over up to 160 degrees, 400 m."""
    def properties(
        self,
        *,
        beams: int = ...,
        fov: float = ...,
        max_range: float = ...,
        temperature: float = ...,
        salinity: float = ...,
        gradient: float = ...,
        assumed_speed: float = ...,
        **kwargs: Any,
    ) -> None: ...

class StarFish450F(SensorCreator):
    """A Blueprint Subsea StarFish 450F: 450 kHz, up to 100 m on each side."""
    def properties(
        self,
        *,
        pings: int = ...,
        samples: int = ...,
        rays_per_side: int = ...,
        max_range: float = ...,
        gain: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class TactileArray(SensorCreator):
    """Forces on the taxels of a soft skin"""
    def properties(
        self,
        *,
        rows: int = ...,
        columns: int = ...,
        pitch: float = ...,
        thickness: float = ...,
        stiffness: float = ...,
        **kwargs: Any,
    ) -> None: ...

class USBL(SensorCreator):
    """Ultra-short baseline: distance and direction of transponders"""
    def properties(
        self,
        *,
        max_range: float = ...,
        angle_error: float = ...,
        range_error: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class UWB(SensorCreator):
    """Distances of ultra-wideband anchors, with the bias of walls"""
    def properties(
        self,
        *,
        link_margin: float = ...,
        wall_loss: float = ...,
        deviation: float = ...,
        errors: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class Whiskers(SensorCreator):
    """A fan of whiskers that bend"""
    def properties(self, *, count: int = ..., spread: float = ..., length: float = ..., **kwargs: Any) -> None: ...
