"""The definitions of the messages of ROS 2 Jazzy that are in use.

Names and types are those of the packages common_interfaces, rcl_interfaces, rmw_dds_common, geometry2,
ackermann_msgs and vision_msgs.
"""

from __future__ import annotations

import logging
import re
from functools import cache
from typing import NamedTuple

from morse.core.exceptions import MorseMiddlewareError
from morse.rosmsgs.table import extensions
from morse.system import OF_MACHINE

logger = logging.getLogger(__name__)

_MESSAGES = """
builtin_interfaces/Time: int32 sec, uint32 nanosec
builtin_interfaces/Duration: int32 sec, uint32 nanosec
std_msgs/Header: builtin_interfaces/Time stamp, string frame_id
std_msgs/Bool: bool data
std_msgs/Float64: float64 data
std_msgs/Int64: int64 data
std_msgs/String: string data
std_msgs/MultiArrayDimension: string label, uint32 size, uint32 stride
std_msgs/MultiArrayLayout: std_msgs/MultiArrayDimension[] dim, uint32 data_offset
std_msgs/UInt8MultiArray: std_msgs/MultiArrayLayout layout, uint8[] data
std_msgs/Float32MultiArray: std_msgs/MultiArrayLayout layout, float32[] data
std_msgs/Float64MultiArray: std_msgs/MultiArrayLayout layout, float64[] data
std_msgs/ColorRGBA: float32 r, float32 g, float32 b, float32 a
rosgraph_msgs/Clock: builtin_interfaces/Time clock
rmw_dds_common/Gid: uint8[16] data
rmw_dds_common/NodeEntitiesInfo: string node_namespace, string node_name,
    rmw_dds_common/Gid[] reader_gid_seq, rmw_dds_common/Gid[] writer_gid_seq
rmw_dds_common/ParticipantEntitiesInfo: rmw_dds_common/Gid gid, rmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq
rcl_interfaces/Log: builtin_interfaces/Time stamp, uint8 level, string name, string msg,
    string file, string function, uint32 line
geometry_msgs/Vector3: float64 x, float64 y, float64 z
geometry_msgs/Point: float64 x, float64 y, float64 z
geometry_msgs/Quaternion: float64 x, float64 y, float64 z, float64 w = 1
geometry_msgs/Pose: geometry_msgs/Point position, geometry_msgs/Quaternion orientation
geometry_msgs/PoseStamped: std_msgs/Header header, geometry_msgs/Pose pose
geometry_msgs/PoseArray: std_msgs/Header header, geometry_msgs/Pose[] poses
geometry_msgs/PoseWithCovariance: geometry_msgs/Pose pose, float64[36] covariance
geometry_msgs/PoseWithCovarianceStamped: std_msgs/Header header, geometry_msgs/PoseWithCovariance pose
geometry_msgs/PointStamped: std_msgs/Header header, geometry_msgs/Point point
geometry_msgs/QuaternionStamped: std_msgs/Header header, geometry_msgs/Quaternion quaternion
geometry_msgs/Twist: geometry_msgs/Vector3 linear, geometry_msgs/Vector3 angular
geometry_msgs/TwistStamped: std_msgs/Header header, geometry_msgs/Twist twist
geometry_msgs/TwistWithCovariance: geometry_msgs/Twist twist, float64[36] covariance
geometry_msgs/TwistWithCovarianceStamped: std_msgs/Header header, geometry_msgs/TwistWithCovariance twist
geometry_msgs/Accel: geometry_msgs/Vector3 linear, geometry_msgs/Vector3 angular
geometry_msgs/AccelWithCovariance: geometry_msgs/Accel accel, float64[36] covariance
geometry_msgs/AccelWithCovarianceStamped: std_msgs/Header header, geometry_msgs/AccelWithCovariance accel
geometry_msgs/Wrench: geometry_msgs/Vector3 force, geometry_msgs/Vector3 torque
geometry_msgs/WrenchStamped: std_msgs/Header header, geometry_msgs/Wrench wrench
geometry_msgs/Transform: geometry_msgs/Vector3 translation, geometry_msgs/Quaternion rotation
geometry_msgs/TransformStamped: std_msgs/Header header, string child_frame_id, geometry_msgs/Transform transform
tf2_msgs/TFMessage: geometry_msgs/TransformStamped[] transforms
nav_msgs/Odometry: std_msgs/Header header, string child_frame_id,
    geometry_msgs/PoseWithCovariance pose, geometry_msgs/TwistWithCovariance twist
sensor_msgs/Imu: std_msgs/Header header,
    geometry_msgs/Quaternion orientation, float64[9] orientation_covariance,
    geometry_msgs/Vector3 angular_velocity, float64[9] angular_velocity_covariance,
    geometry_msgs/Vector3 linear_acceleration, float64[9] linear_acceleration_covariance
sensor_msgs/MagneticField: std_msgs/Header header,
    geometry_msgs/Vector3 magnetic_field, float64[9] magnetic_field_covariance
sensor_msgs/NavSatStatus: int8 status = -2, uint16 service
sensor_msgs/NavSatFix: std_msgs/Header header, sensor_msgs/NavSatStatus status,
    float64 latitude, float64 longitude, float64 altitude,
    float64[9] position_covariance, uint8 position_covariance_type
sensor_msgs/TimeReference: std_msgs/Header header, builtin_interfaces/Time time_ref, string source
sensor_msgs/FluidPressure: std_msgs/Header header, float64 fluid_pressure, float64 variance
sensor_msgs/Temperature: std_msgs/Header header, float64 temperature, float64 variance
sensor_msgs/BatteryState: std_msgs/Header header, float32 voltage, float32 temperature, float32 current,
    float32 charge, float32 capacity, float32 design_capacity, float32 percentage,
    uint8 power_supply_status, uint8 power_supply_health, uint8 power_supply_technology, bool present,
    float32[] cell_voltage, float32[] cell_temperature, string location, string serial_number
sensor_msgs/Range: std_msgs/Header header, uint8 radiation_type, float32 field_of_view,
    float32 min_range, float32 max_range, float32 range, float32 variance
sensor_msgs/LaserScan: std_msgs/Header header, float32 angle_min, float32 angle_max, float32 angle_increment,
    float32 time_increment, float32 scan_time, float32 range_min, float32 range_max,
    float32[] ranges, float32[] intensities
sensor_msgs/PointField: string name, uint32 offset, uint8 datatype, uint32 count
sensor_msgs/PointCloud2: std_msgs/Header header, uint32 height, uint32 width, sensor_msgs/PointField[] fields,
    bool is_bigendian, uint32 point_step, uint32 row_step, uint8[] data, bool is_dense
sensor_msgs/Image: std_msgs/Header header, uint32 height, uint32 width, string encoding, uint8 is_bigendian,
    uint32 step, uint8[] data
sensor_msgs/RegionOfInterest: uint32 x_offset, uint32 y_offset, uint32 height, uint32 width, bool do_rectify
sensor_msgs/CameraInfo: std_msgs/Header header, uint32 height, uint32 width, string distortion_model,
    float64[] d, float64[9] k, float64[9] r, float64[12] p,
    uint32 binning_x, uint32 binning_y, sensor_msgs/RegionOfInterest roi
sensor_msgs/JointState: std_msgs/Header header, string[] name,
    float64[] position, float64[] velocity, float64[] effort
sensor_msgs/CompressedImage: std_msgs/Header header, string format, uint8[] data
visualization_msgs/UVCoordinate: float32 u, float32 v
visualization_msgs/MeshFile: string filename, uint8[] data
visualization_msgs/Marker: std_msgs/Header header, string ns, int32 id, int32 type, int32 action,
    geometry_msgs/Pose pose, geometry_msgs/Vector3 scale, std_msgs/ColorRGBA color,
    builtin_interfaces/Duration lifetime, bool frame_locked, geometry_msgs/Point[] points, std_msgs/ColorRGBA[] colors,
    string texture_resource, sensor_msgs/CompressedImage texture, visualization_msgs/UVCoordinate[] uv_coordinates,
    string text, string mesh_resource, visualization_msgs/MeshFile mesh_file, bool mesh_use_embedded_materials
visualization_msgs/MarkerArray: visualization_msgs/Marker[] markers
diagnostic_msgs/KeyValue: string key, string value
diagnostic_msgs/DiagnosticStatus: uint8 level, string name, string message, string hardware_id,
    diagnostic_msgs/KeyValue[] values
diagnostic_msgs/DiagnosticArray: std_msgs/Header header, diagnostic_msgs/DiagnosticStatus[] status
vision_msgs/ObjectHypothesis: string class_id, float64 score
vision_msgs/ObjectHypothesisWithPose: vision_msgs/ObjectHypothesis hypothesis, geometry_msgs/PoseWithCovariance pose
vision_msgs/BoundingBox3D: geometry_msgs/Pose center, geometry_msgs/Vector3 size
vision_msgs/Detection3D: std_msgs/Header header, vision_msgs/ObjectHypothesisWithPose[] results,
    vision_msgs/BoundingBox3D bbox, string id
vision_msgs/Detection3DArray: std_msgs/Header header, vision_msgs/Detection3D[] detections
ackermann_msgs/AckermannDrive: float32 steering_angle, float32 steering_angle_velocity, float32 speed,
    float32 acceleration, float32 jerk
ackermann_msgs/AckermannDriveStamped: std_msgs/Header header, ackermann_msgs/AckermannDrive drive
trajectory_msgs/JointTrajectoryPoint: float64[] positions, float64[] velocities, float64[] accelerations,
    float64[] effort, builtin_interfaces/Duration time_from_start
trajectory_msgs/JointTrajectory: std_msgs/Header header, string[] joint_names,
    trajectory_msgs/JointTrajectoryPoint[] points
"""

#: the constants of these messages: names whose values follow each other, from 0 unless the first one says another
_CONSTANTS = """
rcl_interfaces/Log: uint8 DEBUG=10 INFO=20 WARN=30 ERROR=40 FATAL=50
sensor_msgs/NavSatStatus: int8 STATUS_UNKNOWN=-2 STATUS_NO_FIX STATUS_FIX STATUS_SBAS_FIX STATUS_GBAS_FIX,
    uint16 SERVICE_UNKNOWN SERVICE_GPS SERVICE_GLONASS SERVICE_COMPASS=4 SERVICE_GALILEO=8
sensor_msgs/NavSatFix: uint8 COVARIANCE_TYPE_UNKNOWN COVARIANCE_TYPE_APPROXIMATED COVARIANCE_TYPE_DIAGONAL_KNOWN
    COVARIANCE_TYPE_KNOWN
sensor_msgs/BatteryState: uint8 POWER_SUPPLY_STATUS_UNKNOWN POWER_SUPPLY_STATUS_CHARGING
    POWER_SUPPLY_STATUS_DISCHARGING POWER_SUPPLY_STATUS_NOT_CHARGING POWER_SUPPLY_STATUS_FULL,
    uint8 POWER_SUPPLY_HEALTH_UNKNOWN POWER_SUPPLY_HEALTH_GOOD POWER_SUPPLY_HEALTH_OVERHEAT POWER_SUPPLY_HEALTH_DEAD
    POWER_SUPPLY_HEALTH_OVERVOLTAGE POWER_SUPPLY_HEALTH_UNSPEC_FAILURE POWER_SUPPLY_HEALTH_COLD
    POWER_SUPPLY_HEALTH_WATCHDOG_TIMER_EXPIRE POWER_SUPPLY_HEALTH_SAFETY_TIMER_EXPIRE,
    uint8 POWER_SUPPLY_TECHNOLOGY_UNKNOWN POWER_SUPPLY_TECHNOLOGY_NIMH POWER_SUPPLY_TECHNOLOGY_LION
    POWER_SUPPLY_TECHNOLOGY_LIPO POWER_SUPPLY_TECHNOLOGY_LIFE POWER_SUPPLY_TECHNOLOGY_NICD
    POWER_SUPPLY_TECHNOLOGY_LIMN POWER_SUPPLY_TECHNOLOGY_TERNARY POWER_SUPPLY_TECHNOLOGY_VRLA
sensor_msgs/Range: uint8 ULTRASOUND INFRARED
sensor_msgs/PointField: uint8 INT8=1 UINT8 INT16 UINT16 INT32 UINT32 FLOAT32 FLOAT64
visualization_msgs/Marker: int32 ARROW CUBE SPHERE CYLINDER LINE_STRIP LINE_LIST CUBE_LIST SPHERE_LIST POINTS
    TEXT_VIEW_FACING MESH_RESOURCE TRIANGLE_LIST ARROW_STRIP, int32 ADD MODIFY=0 DELETE=2 DELETEALL
diagnostic_msgs/DiagnosticStatus: uint8 OK WARN ERROR STALE
"""

#: type codes of numpy
PRIMITIVES = {
    "bool": "?", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
    "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip
SINGLE, SEQUENCE = -1, 0
_NAMED = re.compile(r"[a-z]\w*/[A-Z]\w*")


class MessageField(NamedTuple):
    """A field of a message.

    Attributes:
        name: of the field.
        type: a name of `PRIMITIVES`, ``string``, or the full name of a message.
        size: `SINGLE`, `SEQUENCE`, or the length of an array.
        default: of a number.
    """

    name: str
    type: str
    size: int
    default: float


def _full(name: str) -> str:
    return name.replace("/", "/msg/") if "/" in name else name


@cache
def messages() -> dict[str, tuple[MessageField, ...]]:
    """All messages by their full name (``std_msgs/msg/Header``), each after the messages that it contains."""
    definitions = _read(_MESSAGES, {})
    for extension in extensions():
        try:
            definitions |= _read(extension.messages, definitions)
        except ValueError as error:
            logger.warning("the ROS messages of a package are left out: %s", error, extra=OF_MACHINE)
    return definitions


def _read(text: str, known: dict[str, tuple[MessageField, ...]]) -> dict[str, tuple[MessageField, ...]]:
    """The messages in a text; those that are already known keep their definition.

    Raises:
        ValueError: a line is not a definition, or contains a message that is not known.
    """
    definitions: dict[str, tuple[MessageField, ...]] = {}
    for line in re.sub(r",\n +", ", ", text).strip().splitlines():
        name, colon, fields = line.strip().partition(": ")
        if not (colon and _NAMED.fullmatch(name)):
            raise ValueError(f"expected 'package/Name: type name, type name', got {line!r:.80}")
        read = tuple(_field(field) for field in fields.split(", "))
        for field in read:
            known_type = field.type in PRIMITIVES or field.type == "string" or field.type in (known | definitions)
            if not (known_type and field.name.isidentifier()):
                raise ValueError(f"{name}: the field '{field.name}' has the unknown type '{field.type}'")
        if _full(name) not in known:
            definitions[_full(name)] = read
    return definitions


@cache
def constants() -> dict[str, tuple[str, ...]]:
    """The constants of messages by their full name, each as in a ``.msg`` file: ``uint8 FLOAT32=7``."""
    lines = {}
    for line in re.sub(r"\n +", " ", _CONSTANTS).strip().splitlines():
        name, _, groups = line.partition(": ")
        found = []
        for group in groups.split(", "):
            kind, *names = group.split()
            number = -1
            for text in names:
                constant, _, value = text.partition("=")
                number = int(value) if value else number + 1
                found.append(f"{kind} {constant}={number}")
        lines[_full(name)] = tuple(found)
    return lines


def _field(text: str) -> MessageField:
    declaration, _, default = text.partition(" = ")
    spelling, _, name = declaration.strip().partition(" ")
    kind, bracket, length = spelling.rstrip("]").partition("[")
    size = SINGLE if not bracket else int(length or SEQUENCE)
    return MessageField(name, _full(kind), size, float(default or 0))


def fields_of(type_name: str) -> tuple[MessageField, ...]:
    """The fields of a message.

    Raises:
        MorseMiddlewareError: there is no such message.
    """
    try:
        return messages()[type_name]
    except KeyError:
        raise MorseMiddlewareError(f"the ROS message {type_name} is not known") from None


def definition(type_name: str) -> str:
    """A message and all messages that it contains, in the ``.msg`` format with separators, as used in bags.

    Raises:
        MorseMiddlewareError: there is no such message.
    """
    names, waiting = [type_name], [type_name]
    while waiting:
        inner = [field.type for field in fields_of(waiting.pop(0)) if "/" in field.type]
        new = [name for name in dict.fromkeys(inner) if name not in names]
        names += new
        waiting += new
    return _SEPARATOR.join(
        (f"MSG: {_short(name)}\n" if name != type_name else "")
        + "\n".join([*constants().get(name, ()), *map(_line, fields_of(name))])
        for name in names
    )


_SEPARATOR = "\n" + 80 * "=" + "\n"


def _short(name: str) -> str:
    return name.replace("/msg/", "/")


def _line(field: MessageField) -> str:
    bracket = "" if field.size == SINGLE else f"[{field.size or ''}]"
    default = f" {field.default:g}" if field.default else ""
    return f"{_short(field.type)}{bracket} {field.name}{default}"
