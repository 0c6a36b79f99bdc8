"""Logs of all formats, damaged ones too, and which topic is which component."""

import contextlib
import math
import struct

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseError
from morse.many import Twin
from morse.physics import UnstableError
from morse.plugins.twin.log import _flat, read_log
from morse.simulation.simulation import Simulation

SCENE = """
from morse.builder import *

robot = ATRV("robot")
motion, pose, imu = MotionVW("motion"), Pose("pose"), IMU("imu")
for part in (motion, pose, imu):
    robot.append(part)
env = Environment("empty")
"""
#: 5 s at 0.4 m/s, turning at 0.5 rad/s: a circle of 0.8 m
SPEED, RATE = 0.4, 0.5
MOVING = "[robot.motion]\ntopic = 'drive'\nv = 'motion.v'\nw = 'motion.w'\n[robot.pose]\ntopic = 'drive'\n"


def circle(time):
    return SPEED / RATE * math.sin(RATE * time), SPEED / RATE * (1.0 - math.cos(RATE * time)), RATE * time


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(SCENE)
    return path


def write_ros(folder, storage):
    """A bag of ROS with a command, a pose and an IMU."""
    rosbag1, rosbag2 = pytest.importorskip("rosbags.rosbag1"), pytest.importorskip("rosbags.rosbag2")
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS1_NOETIC if storage == "ros1" else typesys.Stores.ROS2_HUMBLE)
    types = store.types
    time_type = types["builtin_interfaces/msg/Time"]
    vector, quaternion = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]

    def header(time):
        stamp = time_type(sec=int(100 + time), nanosec=round(1e9 * (time % 1.0)))
        own = {"seq": 0} if storage == "ros1" else {}
        return types["std_msgs/msg/Header"](**own, stamp=stamp, frame_id="odom")

    def turned(yaw):
        return quaternion(x=0.0, y=0.0, z=math.sin(yaw / 2.0), w=math.cos(yaw / 2.0))

    def message(kind, time):
        if kind == "geometry_msgs/msg/Twist":
            return types[kind](linear=vector(x=SPEED, y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=RATE))
        x, y, yaw = circle(time)
        if kind == "geometry_msgs/msg/PoseStamped":
            place = types["geometry_msgs/msg/Point"](x=x, y=y, z=0.1)
            return types[kind](
                header=header(time),
                pose=types["geometry_msgs/msg/Pose"](position=place, orientation=turned(yaw)),
            )
        return types[kind](
            header=header(time),
            orientation=turned(yaw),
            orientation_covariance=np.zeros(9),
            angular_velocity=vector(x=0.0, y=0.0, z=RATE),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=vector(x=0.0, y=SPEED * RATE, z=9.81),
            linear_acceleration_covariance=np.zeros(9),
        )

    kinds = {
        "/cmd_vel": ("geometry_msgs/msg/Twist", 10.0),
        "/robot/pose": ("geometry_msgs/msg/PoseStamped", 20.0),
        "/imu/data": ("sensor_msgs/msg/Imu", 50.0),
    }
    if storage == "ros1":
        path = folder / "drive.bag"
        writer = rosbag1.Writer(path)
    else:
        path = folder / "bag"
        plugin = rosbag2.StoragePlugin.MCAP if storage == "mcap" else rosbag2.StoragePlugin.SQLITE3
        writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    with writer:
        for topic, (kind, rate) in kinds.items():
            connection = writer.add_connection(topic, kind, typestore=store)
            for k in range(int(5.0 * rate)):
                data = message(kind, k / rate)
                raw = store.serialize_ros1(data, kind) if storage == "ros1" else store.serialize_cdr(data, kind)
                writer.write(connection, int(1e9 * (100.0 + k / rate + 0.01)), raw)
    return path


@pytest.mark.parametrize("storage", ["ros1", "sqlite", "mcap", "mcap file"])
def test_bags_of_ros(tmp_path, scene, storage):
    path = write_ros(tmp_path, storage.partition(" ")[0])
    if storage == "mcap file":
        # the file of others, by the reader of MORSE
        (path,) = path.glob("*.mcap")
    twin = Twin(path, scene)
    links = {link.component: link for link in twin.links}
    assert {name: link.topic for name, link in links.items()} == {
        "robot.motion": "/cmd_vel",
        "robot.pose": "/robot/pose",
        "robot.imu": "/imu/data",
    }
    assert links["robot.motion"].is_command
    fitted = twin.fit(workers=0)
    # stamps are 10 ms earlier than the reception
    assert twin.log.series["/imu/data"].latency == pytest.approx(0.01, abs=1e-3)
    # the commands were received 10 ms after the motion began: 4 mm and 5 mrad
    assert fitted.errors["robot.pose.x"] < 0.01
    assert fitted.errors["robot.pose.yaw"] < 0.012
    assert fitted.errors["robot.imu.angular_velocity.z"] < 0.06


def test_px4(tmp_path, scene):
    pyulog = pytest.importorskip("pyulog")
    path = tmp_path / "flight.ulg"
    _write_ulog(path)
    assert pyulog.ULog(str(path)).data_list
    log = read_log(path)
    assert log.form == "PX4"
    series = log.series["vehicle_local_position"]
    assert series.columns["x"] == pytest.approx([circle(k / 10.0)[0] for k in range(50)], abs=1e-6)
    # north, east, down: the scene has X north and Y west
    twin = Twin(
        path,
        scene,
        table=_table(tmp_path, '[robot.motion]\ntopic = "cmd"\nv = "v"\nw = "w"\n\n'
        '[robot.pose]\ntopic = "vehicle_local_position"\nx = "x"\ny = "-y"\n'),
    )  # fmt: skip
    assert twin.fit(workers=0).errors["robot.pose.y"] < 0.01


def _table(folder, text):
    path = folder / "table.toml"
    path.write_text(text)
    return path


def _write_ulog(path):
    """The format of PX4: https://docs.px4.io/main/en/dev_log/ulog_file_format.html."""

    def record(kind, data):
        return struct.pack("<HB", len(data), ord(kind)) + data

    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))
    out += record("F", b"vehicle_local_position:uint64_t timestamp;float x;float y;float z;")
    out += record("F", b"cmd:uint64_t timestamp;float v;float w;")
    out += record("A", struct.pack("<BH", 0, 0) + b"vehicle_local_position")
    out += record("A", struct.pack("<BH", 0, 1) + b"cmd")
    for k in range(50):
        x, y, _ = circle(k / 10.0)
        out += record("D", struct.pack("<HQfff", 0, k * 100_000, x, -y, -0.1))
        out += record("D", struct.pack("<HQff", 1, k * 100_000, SPEED, RATE))
    path.write_bytes(out)


def test_ardupilot(tmp_path, scene):
    pytest.importorskip("pymavlink")
    path = tmp_path / "flight.bin"

    def form(number, length, name, letters, labels):
        body = struct.pack("<BB4s16s64s", number, length, name, letters, labels)
        return b"\xa3\x95\x80" + body

    out = bytearray(form(128, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns"))
    out += form(1, 3 + 8 + 12, b"XKF1", b"Qfff", b"TimeUS,PN,PE,PD")
    out += form(2, 3 + 8 + 8, b"CMD1", b"Qff", b"TimeUS,V,W")
    for k in range(50):
        x, y, _ = circle(k / 10.0)
        out += b"\xa3\x95\x01" + struct.pack("<Qfff", 1_000_000 + k * 100_000, x, -y, -0.1)
        out += b"\xa3\x95\x02" + struct.pack("<Qff", 1_000_000 + k * 100_000, SPEED, RATE)
    path.write_bytes(out)
    log = read_log(path)
    assert set(log.series) >= {"XKF1", "CMD1"}
    table = _table(tmp_path, '["robot.motion"]\ntopic = "CMD1"\nv = "V"\nw = "W"\n'
                   '["robot.pose"]\ntopic = "XKF1"\nx = "PN"\ny = "-1 * PE"\n')  # fmt: skip
    assert Twin(path, scene, table=table).fit(workers=0).errors["robot.pose.y"] < 0.01


def test_csv(tmp_path, scene):
    lines = ["time_ms, motion.v, motion.w, robot.pose.x, robot.pose.yaw, imu.angular_velocity.x, "
             "imu.angular_velocity.y, imu.angular_velocity.z, note"]  # fmt: skip
    for k in range(50):
        x, _, yaw = circle(k / 10.0)
        lines.append(f"{1000 + 100 * k},{SPEED},{RATE},{x},{math.remainder(yaw, 2 * math.pi)},0,0,{RATE},ok")
    lines += ["7000,broken", "7100,,,,,,,,", "nan,1,1,1,1,1,1,1,"]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    twin = Twin(tmp_path / "drive.csv", scene)
    assert {link.component for link in twin.links} == {"robot.motion", "robot.pose", "robot.imu"}
    errors = twin.fit(workers=0).errors
    assert errors["robot.pose.x"] < 0.01
    assert errors["robot.pose.yaw"] < 0.01


def _driven(scene, seconds=8, gain=1.1):
    """Commands, and what a robot measures that drives faster than it is told; rows of time and numbers."""
    rng = np.random.default_rng(3)
    rows, samples = [], []
    with morse.load(scene) as sim:
        for k in range(2 * seconds):
            v, w = rng.uniform(0.1, 0.5), rng.uniform(-0.6, 0.6)
            rows.append((k * 0.5, v, w))
            sim.robot.motion.publish({"v": gain * v, "w": w})
            for _ in range(5):
                sim.step(6)
                data = sim.robot.pose.data
                noise = rng.normal(0.0, 0.005, 2)
                samples.append((sim.time(), data["x"] + noise[0], data["y"] + noise[1], sim.robot.imu.data))
    return rows, samples


def test_one_axis_of_a_vector_is_enough(tmp_path, scene):
    """Many robots have a gyroscope for the vertical axis alone."""
    rows, samples = _driven(scene)
    lines = ["time,motion.v,motion.w,pose.x,pose.y,imu.angular_velocity.z"]
    lines += [f"{time},{v},{w},,," for time, v, w in rows]
    lines += [f"{time},,,{x},{y},{imu['angular_velocity'][2] + 0.05}" for time, x, y, imu in samples]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    twin = Twin(tmp_path / "drive.csv", scene, fit=["imu.bias"])
    assert [one.name for one in twin.parameters] == ["robot.imu.bias.angular_velocity.z"]
    fitted = twin.fit(workers=0)
    assert set(fitted.errors) == {"robot.pose.x", "robot.pose.y", "robot.imu.angular_velocity.z"}
    assert fitted.values["robot.imu.bias.angular_velocity.z"] == pytest.approx(0.05, abs=0.005)
    table = _table(tmp_path, twin.table())
    assert set(Twin(tmp_path / "drive.csv", scene, table=table).fit(workers=0).errors) == set(fitted.errors)


def test_what_a_planar_robot_does_not_measure_does_not_count(tmp_path, scene):
    """Height and two of three rates are 0 in the log, without noise, but not in the simulation."""
    rows, samples = _driven(scene)
    lines = ["time,motion.v,motion.w,pose.x,pose.y,pose.z,imu.angular_velocity.x,imu.angular_velocity.y,"
             "imu.angular_velocity.z"]  # fmt: skip
    lines += [f"{time},{v},{w},,,,,," for time, v, w in rows]
    lines += [f"{time},,,{x},{y},0,0,0,{imu['angular_velocity'][2]}" for time, x, y, imu in samples]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    fitted = Twin(tmp_path / "drive.csv", scene, fit=["motion.gain.v"]).fit(workers=0)
    assert set(fitted.errors) == {"robot.pose.x", "robot.pose.y", "robot.imu.angular_velocity.z"}
    assert fitted.values["robot.motion.gain.v"] == pytest.approx(1.1, abs=0.01)
    assert "robot.pose.z never changes in the log, and is not compared" in fitted.remarks
    assert any("angular_velocity: 2 of 3 numbers never change" in one for one in fitted.remarks)


def test_a_clock_that_is_off_is_found(tmp_path, scene):
    """Two seconds, more than a sensor could be late."""
    rng = np.random.default_rng(5)
    rates = rng.uniform(-1.0, 1.0, 40)
    lines = ["time,motion.v,motion.w"]
    lines += [f"{k * 0.5},0.2,{rate}" for k, rate in enumerate(rates)]
    (tmp_path / "commands.csv").write_text("\n".join(lines))
    with morse.load(scene) as sim:
        rows = []
        for rate in rates:
            sim.robot.motion.publish({"v": 0.2, "w": float(rate)})
            for _ in range(5):
                sim.step(6)
                rows.append((sim.time(), sim.robot.imu.data["angular_velocity"][2]))
    lines = ["time,motion.v,motion.w,imu.angular_velocity.x,imu.angular_velocity.y,imu.angular_velocity.z"]
    lines += [f"{k * 0.5},0.2,{rate},,," for k, rate in enumerate(rates)]
    lines += [f"{time + 2.0},,,0,0,{value}" for time, value in rows]
    (tmp_path / "late.csv").write_text("\n".join(lines))
    fitted = Twin(tmp_path / "late.csv", scene).fit(workers=0)
    clock = fitted.comparison.clocks["robot.imu"]
    assert clock.is_applied
    assert clock.delay == pytest.approx(2.0, abs=0.05)
    assert fitted.errors["robot.imu.angular_velocity.z"] < 0.25 * float(np.std(rates))
    assert any("the clock of robot.imu is +2.0" in line for line in fitted.lines())


@pytest.mark.parametrize(
    ("late", "is_told"), [({"imu": 0.4}, True), ({"imu": 0.4, "pose": 0.4}, True), ({"imu": 0.4, "pose": 0.0}, False)]
)
def test_an_offset_of_all_clocks_is_told_to_look_like_a_delay_of_commands(tmp_path, scene, late, is_told):
    """A system that does not change with time has the same output, whether its input or its output is late."""
    rates = np.random.default_rng(5).uniform(-1.0, 1.0, 30)
    lines = ["time,motion.v,motion.w,imu.angular_velocity.z,pose.yaw"]
    lines += [f"{k * 0.5},0.2,{rate},," for k, rate in enumerate(rates)]
    with morse.load(scene) as sim:
        for rate in rates:
            sim.robot.motion.publish({"v": 0.2, "w": float(rate)})
            for _ in range(5):
                sim.step(6)
                turning, yaw = sim.robot.imu.data["angular_velocity"][2], sim.robot.pose.data["yaw"]
                lines.append(f"{sim.time() + late['imu']},,,{turning},")
                if "pose" in late:
                    lines.append(f"{sim.time() + late['pose']},,,,{yaw}")
    (tmp_path / "late.csv").write_text("\n".join(lines))
    fitted = Twin(tmp_path / "late.csv", scene).fit(workers=0)
    assert fitted.comparison.clocks["robot.imu"].delay == pytest.approx(0.4, abs=0.03)
    told = [line for line in fitted.lines() if "cannot tell an offset of the clock of robot.imu from a delay" in line]
    assert bool(told) == is_told


# -- bad input -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["log.mcap", "log.bag", "log.ulg", "log.bin", "log.csv", "log.db3", "log.txt", "log"])
@pytest.mark.parametrize(
    "content",
    [b"", b"\x00" * 4096, b"\xff" * 4096, b"time\n", b"time,a\n" + b"nan,nan\n" * 9, b"\x89MCAP0\r\n" + b"\xff" * 999],
)
def test_damaged_files_are_errors_of_ours(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(MorseError):
        read_log(path)


def test_truncated_files_give_what_is_whole_or_an_error(tmp_path, scene):
    whole = tmp_path / "whole.ulg"
    _write_ulog(whole)
    data = whole.read_bytes()
    pytest.importorskip("pyulog")
    for size in range(0, len(data), 97):
        path = tmp_path / "cut.ulg"
        path.write_bytes(data[:size])
        try:
            log = read_log(path)
        except MorseError:
            continue
        assert all(np.isfinite(one.times).all() for one in log.series.values())


def test_a_cut_recording_is_read_up_to_its_last_chunk(tmp_path, scene):
    with morse.load(scene) as sim, sim.record(tmp_path / "run.mcap"):
        for _ in range(300):
            sim.robot.motion.publish({"v": 0.1})
            sim.step(6)
    data = (tmp_path / "run.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: len(data) // 2])
    # without a whole chunk, there is nothing to read
    with contextlib.suppress(MorseError):
        assert "the file is incomplete" in read_log(cut).remarks[0]
    # bits that turn over are an error, or change numbers, but raise nothing else
    rng = np.random.default_rng(1)
    for _ in range(20):
        spoilt = bytearray(data)
        for place in rng.integers(0, len(data), 8):
            spoilt[place] ^= 1 << int(rng.integers(8))
        cut.write_bytes(spoilt)
        try:
            read_log(cut)
        except MorseError:
            continue


def test_samples_that_are_no_numbers_are_left_out(tmp_path, scene):
    lines = ["time,motion.v,motion.w,pose.x"]
    lines += [f"{k / 10},{SPEED},{RATE},{'inf' if k % 3 else circle(k / 10)[0]}" for k in range(50)]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    twin = Twin(tmp_path / "drive.csv", scene)
    assert len(twin._comparison.measured["robot.pose"].times) == 17
    assert twin.fit(workers=0).errors["robot.pose.x"] < 0.02


@pytest.mark.parametrize("wrong", ["1e12", "-1e9"])
def test_a_time_that_is_years_off_is_told_instead_of_simulated(tmp_path, scene, wrong):
    lines = ["time,motion.v,motion.w,pose.x"]
    lines += [f"{wrong if k == 20 else k / 10},{SPEED},{RATE},{circle(k / 10)[0]}" for k in range(50)]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    with pytest.raises(MorseError, match=r"lasts 1,0.* s, more than 36,000 s.* robot\.pose has no measurement in the"):
        Twin(tmp_path / "drive.csv", scene)


@pytest.mark.parametrize(
    ("table", "text"),
    [
        (
            "[robot.motin]\ntopic = 'drive'\nv = 'motion.v'",
            r"no component 'robot\.motin'.*did you mean 'robot\.motion'",
        ),
        ("[robot.motion]\ntopic = 'drve'\nv = 'motion.v'", "which the log has not.*did you mean 'drive'"),
        ("[robot.motion]\ntopic = 'drive'\nvv = 'motion.v'", "has no field 'vv'"),
        ("[robot.motion]\ntopic = 'drive'\nv = 'motion.x'", "has no column 'motion.x'"),
        ("[robot.motion]\ntopic = 'drive'\nv = 3", "expected a column"),
        ("[robot.motion]\ntopic = 'drive'\nv = []", "expected a column"),
        ("[robot.motion]\ntopic = 'drive'\nv = 'yaw(motion)'", r"has no column 'motion\.x'"),
        ("[robot.motion]\ntopic = 'drive'\nv = '__import__(os)'", "has no column"),
        ("[robot.motion]\ntopic = 'drive'\nv = '1.2.3 * motion.v'", "is no number|no column"),
        ("[robot.motion]\ntopic = 'drive'", "has no field: write"),
        ("[robot.motion]\nv = 'motion.v'", "topic"),
        ("robot = 3", "no component 'robot'"),
        ("[[", "no table in TOML"),
        ("a=" + "[" * 100_000, "no table in TOML"),
        (
            "[robot.motion]\ntopic = 'drive'\nv = 'motion.v'\n"
            "[robot.imu]\ntopic = 'drive'\nangular_velocity = ['motion.v']",
            "has 3 numbers",
        ),
        (
            "[robot.motion]\ntopic = 'drive'\nv = 'motion.v'\n"
            "[robot.imu]\ntopic = 'drive'\nangular_velocity = ['', '', '']",
            "is no column",
        ),
        ("[robot.motion]\ntopic = 'drive'\nv = ''", "is no column"),
        *(
            (MOVING + f"x = {x}", text)
            for x, text in (
                ("['pose.x']", "has one number"),
                ("['pose.x', 'pose.x']", "has one number"),
                ("'1e300 * motion.v'", "no sample"),
                ("'1e400 * motion.v'", "no sample"),
            )
        ),
    ],
)
def test_wrong_tables_are_refused(tmp_path, scene, table, text):
    lines = ["time,motion.v,motion.w,pose.x"] + [f"{k / 10},{SPEED},{RATE},0" for k in range(20)]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    with pytest.raises(MorseError, match=text):
        Twin(tmp_path / "drive.csv", scene, table=_table(tmp_path, table))


def test_commands_that_no_simulation_follows_are_told(tmp_path, scene, monkeypatch):
    lines = ["time,motion.v,motion.w,pose.x"] + [f"{k / 10},1,0,0" for k in range(20)]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    twin = Twin(tmp_path / "drive.csv", scene, table=_table(tmp_path, MOVING + "x = 'pose.x'"))

    def diverge(*_args, **_options):
        raise UnstableError("robot", "it is far away")

    monkeypatch.setattr(Simulation, "step", diverge)
    with pytest.raises(MorseError, match="cannot follow the commands of the log: the physics of 'robot' diverged"):
        twin.fit(workers=0)


def test_names_of_topics_that_control_a_terminal_are_shown_harmless(tmp_path, scene):
    lines = ["time,motion.v,motion.w,pose.x,\x1b[31mred"] + [f"{k / 10},{SPEED},{RATE},0,1" for k in range(20)]
    (tmp_path / "drive\x1b.csv").write_text("\n".join(lines))
    twin = Twin(tmp_path / "drive\x1b.csv", scene)
    assert "\x1b" not in twin.table()
    assert "\x1b" not in str(twin.links[0])


def test_a_file_that_is_a_pipe_is_refused(tmp_path):
    import os

    os.mkfifo(tmp_path / "log.csv")
    with pytest.raises(MorseError, match="pipe"):
        read_log(tmp_path / "log.csv")


def test_the_nearest_name_of_a_log_is_told(tmp_path):
    (tmp_path / "drive.csv").write_text("time,a\n0,1\n")
    with pytest.raises(MorseError, match=r"did you mean 'drive\.csv'"):
        read_log(tmp_path / "drve.csv")


def test_a_command_that_is_out_of_range_is_told_with_its_time(tmp_path, scene):
    lines = ["time,motion.v,motion.w,pose.x"] + [f"{k / 10},{1e12 if k == 7 else SPEED},{RATE},0" for k in range(20)]
    (tmp_path / "drive.csv").write_text("\n".join(lines))
    with pytest.raises(MorseError, match=r"a command at 0\.700 s is refused: robot\.motion: 'v'"):
        Twin(tmp_path / "drive.csv", scene).fit(workers=0)


def test_what_a_damaged_log_of_ardupilot_skips_is_counted_and_not_printed(tmp_path, capfd):
    pytest.importorskip("pymavlink.DFReader")
    path = tmp_path / "flight.bin"
    path.write_bytes(b"\0" * 100_000)
    with pytest.raises(MorseError, match=r"no numbers: the file is damaged: in 99,[0-9]* places"):
        read_log(path)
    path.write_bytes(b"\0" * 1_100_000)
    with pytest.raises(MorseError, match="more than 1,000,000 places"):
        read_log(path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "message",
    [
        {"good": 1.0, "list": [10**400]},
        {"good": 1.0, "list": [{"a": 1.0}, 3]},
        {"good": 1.0, "list": [None, {"a": 1.0}]},
        {"good": 1.0, "huge": [1, [2]], "name": ["a"]},
    ],
)
def test_the_numbers_of_a_message_are_read_beside_what_is_none(message):
    assert _flat(message)["good"] == 1.0


def test_times_that_no_clock_shows_are_left_out(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,x\n-1e308,1\n100,2\n101,3\n1e308,4\n")
    assert read_log(path).duration == 1.0
