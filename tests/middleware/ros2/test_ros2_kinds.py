"""Messages of every kind, decoded by rosbags: fields, units, frames and conventions of the definitions and the REPs."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from desk import Desk

from morse.core.kinds import KINDS
from morse.core.kinds.table import Message
from morse.helpers.geodesy import LocalPlane
from morse.helpers.transformation import Transformation3d
from morse.mathutils.rotations import rotation_from_quaternion
from morse.mathutils.rotations import turn as rotated
from morse.rosmsgs.cdr import encode
from morse.rosmsgs.kinds import Ros2Topics
from morse.rosmsgs.table import Outlet
from morse.sensors.magnetometer import DEFAULT_YEAR, MagneticField

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


# -- once around the compass: all that says where north is agrees, in every message, with the default settings

PLACE = {"longitude": 7.6, "latitude": 46.9, "altitude": 540.0}
PARTS = """
motion = MotionVW('motion'); robot.append(motion)
plain = GPS('plain'); robot.append(plain)
gps = GPS('gps'); gps.level('extended'); robot.append(gps)
compass = Magnetometer('compass'); compass.rotate(z={turned}); robot.append(compass)
imu = IMU('imu'); imu.rotate(z={turned}); robot.append(imu)
attitude = Attitude('attitude'); attitude.properties(UseAngleAgainstNorth=True); robot.append(attitude)
"""


def _apart(one: float, other: float) -> float:
    return abs(math.remainder(one - other, math.tau))


@pytest.mark.parametrize(("world", "turned"), [(0.0, 0.0), (0.7, 0.0), (-2.0, 1.1)])
def test_once_around_the_compass(start: Callable[..., Any], world: float, turned: float) -> None:
    given = ", ".join(f"{name}={value}" for name, value in PLACE.items())
    scene = f"env.properties({given}, angle_against_north={world})"
    simulation, desk = start(PARTS.format(turned=turned), scene)
    plane = LocalPlane(*PLACE.values(), world)
    north, east, _ = MagneticField(LocalPlane(*PLACE.values()), DEFAULT_YEAR, None).north_east_down((0.0, 0.0, 0.0))
    declination = math.atan2(east, north)
    simulation.robot.motion.publish({"v": 2.0, "w": 1.0})
    seen = []
    for _ in range(16):
        simulation.step(24)
        _, ahead = simulation.world.objects_by_name["robot"].world_pose()
        x, y, _ = plane.enu_of((ahead[0], ahead[3], 0.0))
        heading = math.atan2(x, y)  # clockwise from north
        seen.append(math.degrees(heading) % 360.0)
        for topic in ("compass", "imu/mag"):
            field = desk.last(f"/robot/{topic}").magnetic_field
            magnetic = math.atan2(field.y, field.x)  # of a level sensor, X forward and Y left
            assert _apart(magnetic + turned + declination, heading) < 2e-3
            assert math.hypot(field.x, field.y) == pytest.approx(math.hypot(north, east) * 1e-9, rel=1e-3)
            assert field.z < 0.0  # down, on the northern half
        velocity = desk.last("/robot/gps/vel").twist.linear
        assert _apart(math.atan2(velocity.x, velocity.y), heading) < 0.03  # the mean of a tick of the circle
        assert _apart(math.radians(simulation.robot.gps.data["heading"]), heading) < 0.03
        turn = desk.last("/robot/attitude").orientation
        yaw = 2.0 * math.atan2(turn.z, turn.w)  # counter-clockwise from east
        assert _apart(math.pi / 2.0 - yaw, heading) < 1e-3
        one, other = desk.last("/robot/plain/fix"), desk.last("/robot/gps")
        assert (one.latitude, one.longitude) == pytest.approx((other.latitude, other.longitude), abs=1e-9)
        assert one.altitude == pytest.approx(other.altitude, abs=1e-6)
    assert max(seen) - min(seen) > 330.0


def test_coordinates_of_modifiers_are_no_position_on_the_earth(start: Callable[..., Any]) -> None:
    simulation, desk = start(
        "gps = GPS('gps'); gps.alter('ECEF'); robot.append(gps)", "env.properties(longitude=1, latitude=2, altitude=3)"
    )
    simulation.step(2)
    assert "/robot/gps" in desk.publishers
    assert "/robot/gps/fix" not in desk.publishers


# -- covariances are those of the errors that a scene declares: compared with the errors of many sensors

Start = Callable[..., tuple[Any, Desk]]

MANY = 80
PATHS = """
motion = MotionVW(); robot.append(motion)
for number in range({many} + 1):
    sensor = Odometry(f"path{{number}}"); sensor.translate(0.3, 0.2, 0.0); sensor.rotate(0.0, 0.0, 0.7)
    options = dict(factor_sigma=0.2, gyro_drift_sigma=0.02) if number else {{}}
    sensor.alter("OdometryNoise", factor=1.0, **options)
    sensor.add_stream("ros2", tf=False)
    robot.append(sensor)
"""


def matrix(numbers: Any) -> Any:
    """(6, 6): row-major, the order of geometry_msgs/PoseWithCovariance."""
    return np.reshape(numbers, (6, 6))


def plane(pose: Any) -> Any:
    q = pose.orientation
    return np.array([pose.position.x, pose.position.y, 2.0 * math.atan2(q.z, q.w)])


def test_the_errors_of_many_odometries_are_as_large_as_each_says(start: Start) -> None:
    sim, desk = start(PATHS.format(many=MANY), connected="motion.add_stream('ros2')", seed=3)
    types = desk.store.types
    vector = types["geometry_msgs/msg/Vector3"]
    desk.send("/robot/cmd_vel", linear=vector(1.0, 0.0, 0.0), angular=vector(0.0, 0.0, 0.4))
    sim.step(150)
    ideal, *others = [desk.last(f"/robot/path{number}") for number in range(MANY + 1)]
    errors = np.array([plane(other.pose.pose) - plane(ideal.pose.pose) for other in others])
    declared = [matrix(other.pose.covariance)[np.ix_((0, 1, 5), (0, 1, 5))] for other in others]
    distances = [error @ np.linalg.solve(spread, error) for error, spread in zip(errors, declared, strict=True)]
    # the mean of chi-squared numbers of three degrees of freedom
    assert np.mean(distances) == pytest.approx(3.0, abs=4.0 * math.sqrt(6.0 / MANY))
    np.testing.assert_allclose(matrix(others[0].pose.covariance)[5, 5], 150 * 0.02**2, rtol=0.02)
    assert not matrix(ideal.pose.covariance).any(), "unknown"
    twist = matrix(others[0].twist.covariance)
    assert twist[5, 5] == pytest.approx((0.02 * 60.0) ** 2)
    rates = [other.twist.twist.angular.z for other in others]
    assert np.std(rates) == pytest.approx(0.02 * 60.0, rel=0.3)
    speeds = np.array([[o.twist.twist.linear.x, o.twist.twist.linear.y] for o in others])
    spread = np.mean([matrix(other.twist.covariance)[:2, :2] for other in others], axis=0)
    np.testing.assert_allclose(np.cov(speeds.T), spread, atol=0.4 * spread.max())


def test_white_noise_is_that_of_the_robot_wherever_the_sensor_is(start: Start) -> None:
    sim, desk = start(
        "path = Odometry('path'); path.translate(2.0, 0.0, 0.0); path.rotate(0.0, 0.0, math.pi / 2)\n"
        "path.noise(gaussian=0.1, field='x'); path.noise(gaussian=0.01, field='yaw')\n"
        "path.noise(gaussian=0.3, field='wz'); robot.append(path)"
    )
    sim.step(2)
    message = desk.last("/robot/path")
    pose, twist = matrix(message.pose.covariance), matrix(message.twist.covariance)
    # X of the sensor is Y of the robot, and an arm of 2 m makes 2 cm of an angle of 0.01
    assert pose[1, 1] == pytest.approx(0.1**2 + (2.0 * 0.01) ** 2, rel=0.05)
    assert pose[0, 0] == pytest.approx(0.0, abs=1e-5)
    assert pose[5, 5] == pytest.approx(0.01**2)
    assert pose[1, 5] == pytest.approx(-2.0 * 0.01**2, rel=0.05)
    assert twist[5, 5] == pytest.approx(0.3**2)
    assert twist[1, 1] == pytest.approx((2.0 * 0.3) ** 2)


def test_a_bias_that_walks_becomes_less_certain(start: Start) -> None:
    sim, desk = start("pose = Pose('pose'); pose.noise(bias_walk=0.2, field='x'); robot.append(pose)")
    variances = []
    for _ in range(2):
        sim.step(60)
        variances.append(matrix(desk.last("/robot/pose").pose.covariance)[0, 0])
    assert np.diff(variances) == pytest.approx(0.2**2, rel=0.05), "in each second"
    assert variances[0] == pytest.approx(0.2**2, rel=0.05)


def test_steps_and_axes(start: Start) -> None:
    sim, desk = start(
        "pose = Pose('pose'); pose.noise(quantization=0.3, field='y'); robot.append(pose)\n"
        "imu = IMU('imu'); imu.alter('IMUNoise', gyro_std={'x': 0.1, 'z': 0.3}, accel_std=0.2); robot.append(imu)\n"
        "device = IMU('device'); device.properties(GyroNoiseDensity=1e-3, GyroBiasInstability=0.02)\n"
        "robot.append(device)\n"
        "turn = Gyroscope('turn'); turn.alter('Noise', rot_std=0.05); robot.append(turn)\n"
        "far = RadarAltimeter('far'); far.noise(gaussian=0.05); robot.append(far)"
    )
    sim.step(2)
    assert matrix(desk.last("/robot/pose").pose.covariance)[1, 1] == pytest.approx(0.3**2 / 12.0), "uniform"
    imu = desk.last("/robot/imu/data")
    assert np.reshape(imu.angular_velocity_covariance, (3, 3)) == pytest.approx(np.diag([0.01, 0.0, 0.09]))
    assert np.reshape(imu.linear_acceleration_covariance, (3, 3)) == pytest.approx(np.eye(3) * 0.04)
    assert imu.orientation_covariance[0] == -1.0
    # the bias is a Gauss-Markov process, whose Allan deviation has a maximum of 0.6175 standard deviations
    device = desk.last("/robot/device/data")
    assert device.angular_velocity_covariance[0] == pytest.approx(60e-6 + (0.02 / 0.6175) ** 2)
    turn = desk.last("/robot/turn")
    assert np.reshape(turn.orientation_covariance, (3, 3)) == pytest.approx(np.eye(3) * 0.05**2)
    assert turn.linear_acceleration_covariance[0] == -1.0
    assert desk.last("/robot/far").variance == pytest.approx(0.05**2)


# -- frames of messages in the axes of the earth are in the tree of frames -------------------------

#: the X axis of the world points north
NORTH = "env.properties(longitude=1.4, latitude=43.6, altitude=100.0, angle_against_north=1.5707963267948966)"


def test_velocities_of_gps_are_in_a_frame_of_the_tree(start: Callable[..., Any]) -> None:
    simulation, desk = start('gps = GPS("gps"); gps.level("raw"); robot.append(gps)', NORTH)
    simulation.step(2)
    frame = desk.last("/robot/gps/vel").header.frame_id
    found = {t.child_frame_id: t for t in desk.last("/tf_static").transforms}
    assert found[frame].header.frame_id == "map"
    turn = found[frame].transform.rotation
    # east is the -Y axis of a world whose X axis points north
    east = (1.0 - 2.0 * turn.z**2, 2.0 * turn.w * turn.z)
    assert east == pytest.approx((0.0, -1.0), abs=1e-12)
    assert math.hypot(turn.x, turn.y) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("given", [NORTH, "env.properties(longitude=-70.0, latitude=-33.0, altitude=500.0)"])
def test_the_earth_is_the_parent_of_the_map(start: Callable[..., Any], given: str) -> None:
    # by REP 105; the pose in earth-centred coordinates is that of the tree
    simulation, desk = start('spot = Pose("spot"); spot.alter("ECEF"); robot.append(spot)', given)
    simulation.step(2)
    measured = desk.last("/robot/spot")
    assert measured.header.frame_id == "earth"
    (found,) = [t for t in desk.last("/tf_static").transforms if t.child_frame_id == "map"]
    assert found.header.frame_id == "earth"
    place, turn = found.transform.translation, found.transform.rotation
    pose = Transformation3d()
    pose.set_pose((place.x, place.y, place.z), rotation_from_quaternion(turn.w, turn.x, turn.y, turn.z))
    world = simulation.world.objects_by_name["robot.spot"].world_pose()[0]
    there, axes = pose.get_pose()
    expected = [one + moved for one, moved in zip(there, rotated(axes, world), strict=True)]
    position = measured.pose.position
    assert [position.x, position.y, position.z] == pytest.approx(expected, abs=1e-6)
    assert math.hypot(*there) == pytest.approx(6.37e6, rel=0.01)


def test_the_grid_is_below_the_map(start: Callable[..., Any]) -> None:
    simulation, desk = start(
        'spot = Pose("spot"); spot.alter("UTM"); robot.append(spot)',
        'env.properties(UTMXOffset=377000.0, UTMYOffset="4827000.5", UTMZOffset=100.0)',
    )
    simulation.step(2)
    measured = desk.last("/robot/spot")
    assert measured.header.frame_id == "utm"
    (found,) = [t for t in desk.last("/tf_static").transforms if t.child_frame_id == "utm"]
    assert found.header.frame_id == "map"
    origin, place = found.transform.translation, measured.pose.position
    world = simulation.world.objects_by_name["robot.spot"].world_pose()[0]
    seen = [place.x + origin.x, place.y + origin.y, place.z + origin.z]
    assert seen == pytest.approx(list(world), abs=1e-6)
    assert origin.y == -4827000.5
