"""Messages of every kind, decoded by rosbags: fields, units, frames and conventions of the definitions and the REPs."""

import math
from typing import Any

import numpy as np
import pytest

from morse.core.kinds import KINDS
from morse.core.kinds.kind import Message
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.kinds import Ros2Topics
from morse.rosmsgs.table import Outlet

typesys = pytest.importorskip("rosbags.typesys", reason="rosbags is not installed: pip install rosbags")
STORE: Any = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
STAMP = 12_345_678_901


class Bound:
    """A message of a component: some slots of a kind."""

    def __init__(self, kind: str, **slots: Any) -> None:
        self.kind, self.slots, self.topic, self.frame = KINDS[kind], slots, "", "own"
        self.component = self
        self.frequency = 10.0
        self.sources = ()

    def has(self, slot: str) -> bool:
        return slot in self.slots

    def gather(self) -> Message:
        return Message(self.kind, STAMP, self.frame, self.slots)


class Stream:
    kwargs = {"stamped": False}  # noqa: RUF012 - nobody changes it
    kinds: tuple[Any, ...] = ()


def said(kind: str, topic: str = "", **slots: Any) -> Any:
    """The message for a kind on a sub-topic, decoded by rosbags."""
    bound = Bound(kind, **slots)
    outlets: list[Outlet] = Ros2Topics().outlets(Stream(), bound)
    (outlet,) = [outlet for outlet in outlets if outlet.topic == topic]
    made = outlet.make(bound.gather(), "frame")
    assert made is not None
    message = STORE.deserialize_cdr(encode(outlet.type, made), outlet.type)
    assert message.__msgtype__ == outlet.type
    if hasattr(message, "header"):
        assert (message.header.stamp.sec, message.header.stamp.nanosec) == (12, 345_678_901)
    return message


def heard(kind: str, message: dict[str, Any], **slots: Any) -> dict[str, Any]:
    """The slots that a command sets."""
    inlet = Ros2Topics().inlets(Stream(), Bound(kind, **slots))[0]
    result: dict[str, Any] = inlet.take(message)
    return result


def test_every_kind_that_has_a_form_in_the_table_has_a_method() -> None:
    published = {kind for kind in KINDS if Ros2Topics.has(kind)}
    assert published == {name for name, kind in KINDS.items() if kind.published}
    commanded = {kind for kind in KINDS if Ros2Topics.has(kind, "IN")}
    assert commanded == {name for name, kind in KINDS.items() if kind.commanded}


def test_a_pose_without_orientation_is_a_point() -> None:
    assert said("pose", position=np.array([1.0, 2.0, 3.0])).point.z == 3.0
    turned = said("pose", position=(0, 0, 0), orientation=(2.0, 0.0, 0.0, 2.0)).pose.orientation
    assert (turned.w, turned.z) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5))), "of length 1, for tf"
    covariance = said("pose", position=(0, 0, 0), orientation=(1, 0, 0, 0), covariance=np.eye(6) * 4).pose.covariance
    assert covariance.reshape(6, 6)[5, 5] == 4.0


def test_an_imu_says_what_it_has_not() -> None:
    imu = said("imu", "data", angular_velocity=(0.1, 0.2, 0.3), linear_acceleration=(0.0, 0.0, 9.81))
    assert imu.linear_acceleration.z == 9.81
    assert imu.orientation_covariance[0] == -1.0
    assert set(imu.angular_velocity_covariance) == {0.0}, "unknown is not absent"
    attitude = said("attitude", orientation=(1.0, 0.0, 0.0, 0.0))
    assert attitude.linear_acceleration_covariance[0] == attitude.angular_velocity_covariance[0] == -1.0
    assert attitude.orientation_covariance[0] == 0.0


def test_a_scan_counts_its_rays_by_the_angles() -> None:
    step = math.radians(0.3)
    ranges = np.array([1.0, math.inf, -math.inf, 2.0], dtype=np.float32)
    scan = said("scan", ranges=ranges, angle_min=-0.5, angle_increment=step, range_min=0.0, range_max=30.0)
    assert round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1 == len(scan.ranges)
    np.testing.assert_array_equal(scan.ranges, ranges)
    assert scan.scan_time == pytest.approx(0.1)
    assert scan.time_increment == 0.0
    assert len(scan.intensities) == 0
    single = said("scan", ranges=ranges[:1], angle_min=0.0, angle_increment=step, range_min=0.0, range_max=1.0)
    assert single.angle_max == single.angle_min


def test_a_cloud_has_one_record_for_each_point() -> None:
    points = np.arange(12, dtype=np.float32).reshape(4, 3)
    color = np.array([[255, 128, 1]] * 4, dtype=np.uint8)
    ring = np.arange(4, dtype=np.uint16)
    cloud = said("cloud", points=points, intensity=points[:, 0], color=color, ring=ring)
    assert (cloud.height, cloud.width, cloud.row_step) == (1, 4, 4 * cloud.point_step)
    assert len(cloud.data) == cloud.row_step
    types = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
    record = np.dtype(
        {
            "names": [field.name for field in cloud.fields],
            "formats": [types[field.datatype] for field in cloud.fields],
            "offsets": [field.offset for field in cloud.fields],
            "itemsize": cloud.point_step,
        }
    )
    table = np.frombuffer(cloud.data.tobytes(), dtype=record)
    np.testing.assert_array_equal(np.stack([table["x"], table["y"], table["z"]], axis=1), points)
    assert np.ascontiguousarray(table["rgb"]).view("u4")[0] == 255 << 16 | 128 << 8 | 1
    assert list(table["ring"]) == [0, 1, 2, 3]
    assert cloud.is_dense
    grid = np.full((2, 3, 3), np.nan, dtype=np.float32)
    organised = said("cloud", points=grid)
    assert (organised.height, organised.width, organised.is_dense) == (2, 3, False)


@pytest.mark.parametrize(
    ("encoding", "pixels", "step"),
    [
        ("rgba8", np.arange(24, dtype=np.uint8).reshape(2, 3, 4), 12),
        ("32FC1", np.arange(6, dtype=np.float32).reshape(2, 3), 12),
        ("16UC1", np.arange(6, dtype=np.uint16).reshape(2, 3), 6),
    ],
)
def test_an_image_has_its_top_row_first(encoding: str, pixels: Any, step: int) -> None:
    image = said("image", "image", pixels=pixels, encoding=encoding)
    assert (image.height, image.width, image.step, image.encoding) == (2, 3, step, encoding)
    assert image.data.tobytes() == pixels.tobytes()


def test_an_ideal_camera_has_no_distortion() -> None:
    k = np.array([[500.0, 0.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]])
    info = said("camera_info", "camera_info", width=640, height=480, k=k, d=np.zeros(0), model="")
    assert (info.distortion_model, list(info.d)) == ("plumb_bob", [0.0] * 5)
    np.testing.assert_array_equal(info.k.reshape(3, 3), k)
    np.testing.assert_array_equal(info.p.reshape(3, 4)[:, :3], k)
    np.testing.assert_array_equal(info.r.reshape(3, 3), np.eye(3))


def test_a_battery_measures_its_charge_alone() -> None:
    battery = said("battery", charge=0.75, status="discharging")
    assert battery.percentage == 0.75
    assert battery.power_supply_status == battery.POWER_SUPPLY_STATUS_DISCHARGING
    assert all(map(math.isnan, (battery.voltage, battery.current, battery.charge, battery.capacity)))
    assert battery.present


def test_a_fix_is_one() -> None:
    fix = said("fix", latitude=43.5, longitude=1.5, altitude=200.0, covariance=np.diag([1.0, 4.0, 9.0]))
    assert fix.status.status == fix.status.STATUS_FIX
    assert fix.position_covariance_type == fix.COVARIANCE_TYPE_DIAGONAL_KNOWN
    unknown = said("fix", latitude=43.5, longitude=1.5, altitude=200.0)
    assert unknown.position_covariance_type == unknown.COVARIANCE_TYPE_UNKNOWN
    place = {"latitude": 0.0, "longitude": 0.0, "altitude": 0.0}
    assert said("fix", "vel", **place, velocity=(1.0, 2.0, 3.0)).twist.linear.y == 2.0
    assert said("fix", "time_reference", **place, utc="1970-01-02T00:00:00Z").time_ref.sec == 86400


def test_a_range_and_what_it_is_measured_by() -> None:
    sonar = said("range", distance=math.inf, min=0.02, max=4.0, fov=0.5, radiation="ultrasound")
    assert (sonar.radiation_type, sonar.range) == (sonar.ULTRASOUND, math.inf)
    assert sonar.max_range == 4.0


def test_weather_and_forces() -> None:
    assert said("pressure", absolute=101325.0).fluid_pressure == 101325.0
    assert said("pressure", "differential", differential=12.0).data == 12.0
    assert said("temperature", temperature=-5.0).temperature == -5.0
    assert said("magnetic_field", field=(0.0, 2e-5, -4e-5)).magnetic_field.y == 2e-5
    assert said("wrench", force=(1, 2, 3), torque=(4, 5, 6)).wrench.torque.z == 6.0
    assert said("accel", linear=(1, 2, 3)).accel.accel.linear.x == 1.0
    assert said("contact", touching=True).data is True
    forces = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
    assert said("contact", "wrench", touching=True, forces=forces).wrench.force.z == 2.0


def test_joints_have_arrays_of_one_length_or_none() -> None:
    joints = said("joints", names=("a", "b"), position=np.array([1.0, 2.0]))
    assert (joints.name, list(joints.position), len(joints.velocity)) == (["a", "b"], [1.0, 2.0], 0)


def test_some_joints_are_commanded_and_unknown_ones_refused() -> None:
    slots = {"names": ("a", "b"), "position": np.array([1.0, 2.0])}
    command = {"name": ["b"], "position": np.array([5.0]), "velocity": np.zeros(0), "effort": np.zeros(0)}
    assert list(heard("joints", command, **slots)["position"]) == [1.0, 5.0]
    with pytest.raises(ValueError, match="there is no joint 'c'; known: a, b"):
        heard("joints", {**command, "name": ["c"]}, **slots)
    with pytest.raises(ValueError, match="2 numbers of 'position' for 1 names"):
        heard("joints", {**command, "position": np.zeros(2)}, **slots)


def test_images_of_others_are_checked() -> None:
    image = {"height": 1, "width": 2, "encoding": "bgr8", "is_bigendian": 0, "step": 8}
    data = np.array([1, 2, 3, 4, 5, 6, 0, 0], dtype=np.uint8)
    assert heard("image", {**image, "data": data}, pixels=None)["pixels"].tolist() == [[[3, 2, 1], [6, 5, 4]]]
    for wrong in ({"step": 5}, {"height": 2}, {"encoding": "yuv"}, {"width": 2**31}, {"height": 0}):
        with pytest.raises(ValueError, match=r"bytes for|encoding"):
            heard("image", {**image, "data": data, **wrong}, pixels=None)
