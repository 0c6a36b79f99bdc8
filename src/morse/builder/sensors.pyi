# Written by `python -m tools` from what the components declare: do not edit.

from typing import Any, Literal
from morse.builder.components.sensors import CameraCreator as CameraCreator
from morse.builder.components.sensors import CompoundSensor as CompoundSensor
from morse.builder.components.sensors import ContactSensor as ContactSensor
from morse.builder.components.sensors import Kinect as Kinect
from morse.builder.components.sensors import LaserSensorWithArc as LaserSensorWithArc
from morse.builder.components.sensors import VLP16_180 as VLP16_180
from morse.builder.creator import SensorCreator as SensorCreator

__all__ = [
    "ADIS16448",
    "Accelerometer",
    "Airspeed",
    "ArmaturePose",
    "Attitude",
    "BMI088",
    "Barometer",
    "Battery",
    "Bumper",
    "Clock",
    "Collision",
    "CompoundSensor",
    "ContactForce",
    "DepthCamera",
    "DepthCameraAggregator",
    "DepthCameraRotationZ",
    "DepthVideoCamera",
    "ForceTorqueSensor",
    "GPS",
    "Gyroscope",
    "Hokuyo",
    "HumanPosture",
    "IMU",
    "Infrared",
    "Kinect",
    "LaserScanner",
    "Magnetometer",
    "NormalCamera",
    "Odometry",
    "OpticalFlowCamera",
    "PTUPosture",
    "Pose",
    "Proximity",
    "RadarAltimeter",
    "RangeFinder",
    "RawImage",
    "SearchAndRescue",
    "SegmentationCamera",
    "SemanticCamera",
    "SensorCreator",
    "Sick",
    "SickLDMRS",
    "StereoUnit",
    "ThermalCamera",
    "Thermometer",
    "UltrasonicRangeFinder",
    "VLP16",
    "VLP16_180",
    "VN100",
    "Velocity",
    "Velodyne",
    "VelodyneRayCast",
    "VelodyneZB",
    "VideoCamera",
    "WheelEncoders",
]

class ADIS16448(SensorCreator):
    """An IMU with the noise of an Analog ADIS16448: 0.0135 deg/s/√Hz, 14.5 deg/h; 230 µg/√Hz, 0.25 mg."""
    def properties(
        self,
        *,
        ComputationMode: Literal["Automatic", "Velocity", "Position"] = ...,
        GyroNoiseDensity: float = ...,
        GyroBiasInstability: float = ...,
        GyroRandomWalk: float = ...,
        AccelNoiseDensity: float = ...,
        AccelNoiseDensityZ: float = ...,
        AccelBiasInstability: float = ...,
        AccelRandomWalk: float = ...,
        BiasCorrelationTime: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Accelerometer(SensorCreator):
    """A sensor returning the distance since the last measurement, velocity and acceleration of the robot"""
    def properties(
        self, *, ComputationMode: Literal["Automatic", "Velocity", "Position"] = ..., **kwargs: Any
    ) -> None: ...

class Airspeed(SensorCreator):
    """A sensor returning the dynamic pressure of the air, as a Pitot tube does"""
    def properties(
        self, *, ComputationMode: Literal["Automatic", "Velocity", "Position"] = ..., **kwargs: Any
    ) -> None: ...

class ArmaturePose(SensorCreator):
    """Measures the joint values of an armature"""

class Attitude(SensorCreator):
    """A sensor returning the absolute attitude and the angular velocity of the robot"""
    def properties(
        self,
        *,
        ComputationMode: Literal["Automatic", "Velocity", "Position"] = ...,
        UseAngleAgainstNorth: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class BMI088(SensorCreator):
    """An IMU with the noise of a Bosch BMI088: 0.014 deg/s/√Hz, 2 deg/h; 160 µg/√Hz in X and Y, 190 µg/√Hz in Z."""
    def properties(
        self,
        *,
        ComputationMode: Literal["Automatic", "Velocity", "Position"] = ...,
        GyroNoiseDensity: float = ...,
        GyroBiasInstability: float = ...,
        GyroRandomWalk: float = ...,
        AccelNoiseDensity: float = ...,
        AccelNoiseDensityZ: float = ...,
        AccelBiasInstability: float = ...,
        AccelRandomWalk: float = ...,
        BiasCorrelationTime: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Barometer(SensorCreator):
    """A sensor returning the atmospheric pressure"""
    def properties(self, *, ReferencePressure: float = ..., **kwargs: Any) -> None: ...

class Battery(SensorCreator):
    """A battery that discharges with time, and is charged in a zone of the type Charging"""
    def properties(self, *, DischargingRate: float = ..., **kwargs: Any) -> None: ...

class Bumper(ContactSensor):
    """A bumper that reports whether an object presses it"""
    def properties(self, *, only_objects_with_property: str = ..., Travel: float = ..., **kwargs: Any) -> None: ...

class Clock(SensorCreator):
    """A sensor that publishes simulated time"""

class Collision(ContactSensor):
    """A sensor that reports which objects touch it, while there are any"""
    def properties(self, *, only_objects_with_property: str = ..., **kwargs: Any) -> None: ...

class ContactForce(SensorCreator):
    """A sensor that measures the force of contacts on a link, such as a foot"""

class DepthCamera(CameraCreator):
    """A camera capturing 3D points cloud"""
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
        depth_noise: float = ...,
        keep_list: str = ...,
        keep_resolution: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class DepthCameraAggregator(SensorCreator):
    """Merges the clouds of several depth cameras"""
    def properties(self, *, master_camera: str = ..., **kwargs: Any) -> None: ...

class DepthCameraRotationZ(CameraCreator):
    """Rotating depth camera"""
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
        depth_noise: float = ...,
        keep_list: str = ...,
        keep_resolution: bool = ...,
        rotation: float = ...,
        **kwargs: Any,
    ) -> None: ...

class DepthVideoCamera(CameraCreator):
    """A camera capturing depth"""
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
        depth_noise: float = ...,
        **kwargs: Any,
    ) -> None: ...

class ForceTorqueSensor(SensorCreator):
    """A sensor that measures the force and the torque in the joint that carries a link, such as a wrist"""

class GPS(SensorCreator):
    """A GPS sensor that returns the position in the world, or longitude, latitude and altitude"""

class Gyroscope(SensorCreator):
    """A sensor returning the absolute yaw, pitch and roll of the sensor"""

class Hokuyo(LaserSensorWithArc):
    """A Hokuyo: 30 m, 270 degrees, 0.25 degrees, 10 Hz."""
    def properties(
        self,
        *,
        laser_range: float = ...,
        range_min: float = ...,
        resolution: float = ...,
        scan_window: float = ...,
        Visible_arc: bool = ...,
        layers: int = ...,
        layer_separation: float = ...,
        layer_offset: float = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class HumanPosture(SensorCreator):
    """Measures the pose and the joints of a person"""

class IMU(SensorCreator):
    """An inertial measurement unit returning angular velocity, linear acceleration and magnetic field"""
    def properties(
        self,
        *,
        ComputationMode: Literal["Automatic", "Velocity", "Position"] = ...,
        GyroNoiseDensity: float = ...,
        GyroBiasInstability: float = ...,
        GyroRandomWalk: float = ...,
        AccelNoiseDensity: float = ...,
        AccelNoiseDensityZ: float = ...,
        AccelBiasInstability: float = ...,
        AccelRandomWalk: float = ...,
        BiasCorrelationTime: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Infrared(LaserSensorWithArc):
    """An infrared proximity sensor: 2 m, 20 degrees, 1 degree, 10 Hz."""
    def properties(
        self,
        *,
        laser_range: float = ...,
        range_min: float = ...,
        resolution: float = ...,
        scan_window: float = ...,
        Visible_arc: bool = ...,
        layers: int = ...,
        layer_separation: float = ...,
        layer_offset: float = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class LaserScanner(LaserSensorWithArc):
    """Generic laser range sensors"""
    def properties(
        self,
        *,
        laser_range: float = ...,
        range_min: float = ...,
        resolution: float = ...,
        scan_window: float = ...,
        Visible_arc: bool = ...,
        layers: int = ...,
        layer_separation: float = ...,
        layer_offset: float = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class Magnetometer(SensorCreator):
    """A sensor returning the magnetic field of the earth"""
    def properties(
        self,
        *,
        date: float = ...,
        Model: Literal["auto", "WMM2010", "WMM2015", "WMM2015v2", "WMM2020", "WMM2025"] = ...,
        **kwargs: Any,
    ) -> None: ...

class NormalCamera(CameraCreator):
    """A camera that measures the normals of surfaces"""
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
        **kwargs: Any,
    ) -> None: ...

class Odometry(SensorCreator):
    """An odometry sensor that returns raw, partially integrated or fully integrated displacement"""

class OpticalFlowCamera(CameraCreator):
    """A camera that measures the motion of each point in the image"""
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
        **kwargs: Any,
    ) -> None: ...

class PTUPosture(SensorCreator):
    """A sensor returning the angles of a pan-tilt unit"""

class Pose(SensorCreator):
    """A sensor which returns the full pose (translation + rotation) of the sensor in the world"""

class Proximity(SensorCreator):
    """Distance sensor to detect nearby objects"""
    def properties(self, *, Range: float = ..., Track: str = ..., **kwargs: Any) -> None: ...

class RadarAltimeter(SensorCreator):
    """Compute the distance to the ground"""
    def properties(self, *, MaxRange: float = ..., **kwargs: Any) -> None: ...

class RangeFinder(SensorCreator):
    """A range finder with a single ray: 10 m, 20 Hz."""
    def properties(
        self,
        *,
        range: float = ...,
        min_range: float = ...,
        cone: float = ...,
        resolution: float = ...,
        radiation: Literal["infrared", "ultrasound", "radar"] = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class RawImage(CameraCreator):
    """A camera capturing the raw z-buffer"""
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
        depth_noise: float = ...,
        **kwargs: Any,
    ) -> None: ...

class SearchAndRescue(SensorCreator):
    """A sensor that finds victims, and heals them"""
    def properties(
        self,
        *,
        Heal_range: float = ...,
        Abilities: str = ...,
        Angle: float = ...,
        Distance: float = ...,
        Freq: float = ...,
        **kwargs: Any,
    ) -> None: ...

class SegmentationCamera(CameraCreator):
    """A camera that measures the id and the class of the object in each pixel"""
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
        tag: str = ...,
        class_tag: str = ...,
        class_names: str = ...,
        relative: bool = ...,
        fewest_pixels: int = ...,
        compression: Literal["", "png"] = ...,
        **kwargs: Any,
    ) -> None: ...

class SemanticCamera(CameraCreator):
    """A smart camera allowing to retrieve objects in its field of view"""
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
        relative: bool = ...,
        noocclusion: bool = ...,
        tag: str = ...,
        visibility: Literal["pixels", "ray"] = ...,
        **kwargs: Any,
    ) -> None: ...

class Sick(LaserSensorWithArc):
    """A SICK LMS: 30 m, 180 degrees, 1 degree, 10 Hz."""
    def properties(
        self,
        *,
        laser_range: float = ...,
        range_min: float = ...,
        resolution: float = ...,
        scan_window: float = ...,
        Visible_arc: bool = ...,
        layers: int = ...,
        layer_separation: float = ...,
        layer_offset: float = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class SickLDMRS(LaserSensorWithArc):
    """A SICK LD-MRS: 30 m, 100 degrees, 0.25 degrees, four layers, 4 Hz."""
    def properties(
        self,
        *,
        laser_range: float = ...,
        range_min: float = ...,
        resolution: float = ...,
        scan_window: float = ...,
        Visible_arc: bool = ...,
        layers: int = ...,
        layer_separation: float = ...,
        layer_offset: float = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class StereoUnit(SensorCreator):
    """A pair of cameras to perform stereo vision"""

class ThermalCamera(CameraCreator):
    """A camera that measures the temperatures of surfaces"""
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
        DefaultTemperature: float = ...,
        SkyTemperature: float = ...,
        FireTag: str = ...,
        FireTemperature: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Thermometer(SensorCreator):
    """A sensor returning the temperature, which depends on the distance of fires"""
    def properties(
        self,
        *,
        DefaultTemperature: float = ...,
        FireTag: str = ...,
        FireTemperature: float = ...,
        Range: float = ...,
        Alpha: float = ...,
        **kwargs: Any,
    ) -> None: ...

class UltrasonicRangeFinder(SensorCreator):
    """An ultrasonic range finder: a cone of 30 degrees, 0.02 to 4 m, 20 Hz."""
    def properties(
        self,
        *,
        range: float = ...,
        min_range: float = ...,
        cone: float = ...,
        resolution: float = ...,
        radiation: Literal["infrared", "ultrasound", "radar"] = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class VLP16(LaserSensorWithArc):
    """A Velodyne VLP-16: 100 m, 16 layers from 15 degrees up to 15 degrees down, all around in steps of 0.2 degrees, 10 Hz. The whole circle is measured at once, in a frame that does not turn."""
    def properties(
        self,
        *,
        laser_range: float = ...,
        range_min: float = ...,
        resolution: float = ...,
        scan_window: float = ...,
        Visible_arc: bool = ...,
        layers: int = ...,
        layer_separation: float = ...,
        layer_offset: float = ...,
        on_demand: bool = ...,
        **kwargs: Any,
    ) -> None: ...

class VN100(SensorCreator):
    """An IMU with the noise of a VectorNav VN-100: 0.0035 deg/s/√Hz, 5 deg/h; 140 µg/√Hz, 0.04 mg."""
    def properties(
        self,
        *,
        ComputationMode: Literal["Automatic", "Velocity", "Position"] = ...,
        GyroNoiseDensity: float = ...,
        GyroBiasInstability: float = ...,
        GyroRandomWalk: float = ...,
        AccelNoiseDensity: float = ...,
        AccelNoiseDensityZ: float = ...,
        AccelBiasInstability: float = ...,
        AccelRandomWalk: float = ...,
        BiasCorrelationTime: float = ...,
        **kwargs: Any,
    ) -> None: ...

class Velocity(SensorCreator):
    """A sensor returning the linear and angular velocity of the robot, in the axes of the sensor"""
    def properties(
        self, *, ComputationMode: Literal["Automatic", "Velocity", "Position"] = ..., **kwargs: Any
    ) -> None: ...

class Velodyne(CameraCreator):
    """A depth camera that rotates by its angle of view after each image."""
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
        depth_noise: float = ...,
        keep_list: str = ...,
        keep_resolution: bool = ...,
        rotation: float = ...,
        **kwargs: Any,
    ) -> None: ...

class VelodyneRayCast(LaserSensorWithArc):
    """A rotating upright fan of rays: 50 m, 31.5 degrees, 0.5 degrees; rotated by 0.01745 rad per measurement."""
    def properties(
        self,
        *,
        laser_range: float = ...,
        range_min: float = ...,
        resolution: float = ...,
        scan_window: float = ...,
        Visible_arc: bool = ...,
        layers: int = ...,
        layer_separation: float = ...,
        layer_offset: float = ...,
        on_demand: bool = ...,
        rotation: float = ...,
        **kwargs: Any,
    ) -> None: ...

class VelodyneZB(CameraCreator):
    """The same as Velodyne."""
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
        depth_noise: float = ...,
        keep_list: str = ...,
        keep_resolution: bool = ...,
        rotation: float = ...,
        **kwargs: Any,
    ) -> None: ...

class VideoCamera(CameraCreator):
    """A camera capturing RGBA image"""
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
        exposure: float = ...,
        auto_exposure: bool = ...,
        full_well: float = ...,
        read_noise: float = ...,
        stuck_pixels: float = ...,
        exposure_time: float = ...,
        readout_time: float = ...,
        motion_steps: int = ...,
        compression: Literal["", "jpeg", "png"] = ...,
        quality: int = ...,
        **kwargs: Any,
    ) -> None: ...

class WheelEncoders(SensorCreator):
    """Counts, angles and speeds of the driven wheels of a robot"""
    def properties(self, *, StepsPerTurn: int = ..., **kwargs: Any) -> None: ...
