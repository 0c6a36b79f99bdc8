"""MAVLink with pymavlink in another process: contents and axes of messages; commands; invalid bytes."""

import json
import math
import os
import random
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseError
from morse.plugins.mavlink.axes import Axes
from morse.plugins.mavlink.framing import Framer
from tests.kit import programs
from tests.kit.programs import free_port
from tests.kit.scenes import Load
from tests.kit.waiting import step_until

pytestmark = pytest.mark.long

HERE = Path(__file__).parent
DOCS = HERE.parents[2] / "docs"
LIMIT = 60.0
MANAGER = "morse.middleware.mavlink_datastream.MavlinkDatastreamManager"
SCENE = """
from morse.builder import *
robot = {robot}()
robot.translate({place})
robot.rotate(z={yaw})
{components}
robot.add_default_interface("mavlink")
env = Environment("empty")
{properties}
env.configure_stream_manager("mavlink", device="{device}"{options})
"""


@pytest.fixture(autouse=True)
def _needs_pymavlink() -> None:
    if find_spec("pymavlink") is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("there is no pymavlink: pip install pymavlink")


@pytest.fixture
def start(load: Load) -> Load:
    def start(
        device: str, components: str, robot: str = "ATRV", place: str = "0, 0, 0", yaw: float = 0.0,
        properties: str = "", options: str = "",
    ) -> Any:  # fmt: skip
        where = {"place": place, "yaw": yaw, "properties": properties}
        text = SCENE.format(device=device, components=components, robot=robot, options=options, **where)
        return load(text, sockets=True)

    return start


def talk(sim: Any, device: str, wanted: str, *command: str) -> dict[str, Any]:
    """The messages that the peer has received when it has all wanted ones."""
    peer = [sys.executable, str(HERE / "mavlink_peer.py"), device, wanted, *command]
    seen: dict[str, Any] = json.loads(programs.talk(peer, sim.step))
    assert set(wanted.split(",")) <= seen.keys(), seen.keys()
    return seen


def part(cls: str, name: str, **properties: Any) -> str:
    listed = ", ".join(f"{key}={value!r}" for key, value in properties.items())
    return f"{name} = {cls}(); {name}.properties({listed}); robot.append({name})\n"


GPS = "gps = GPS(); gps.level('raw'); robot.append(gps)"
EARTH = "env.properties(longitude=1.4, latitude=43.6, altitude=135.0{more})"


def test_what_is_measured_arrives_in_the_axes_of_mavlink(start: Callable[..., Any]) -> None:
    port = free_port(socket.SOCK_DGRAM)
    components = "".join(
        [part("Attitude", "attitude"), part("Odometry", "odometry"), part("Pose", "pose"), part("Battery", "battery"),
         part("Thermometer", "thermometer"), part("Barometer", "barometer"), part("Accelerometer", "accelerometer"),
         part("IMU", "imu"), part("Clock", "clock"), part("RadarAltimeter", "altimeter", MaxRange=20.0)]
    )  # fmt: skip
    sim = start(f"udpout:127.0.0.1:{port}", components, place="3, 4, 0", yaw=0.5)
    sim.step(120)  # the robot comes to rest on its wheels, before anybody listens
    wanted = (
        "HEARTBEAT,ATTITUDE,LOCAL_POSITION_NED,ODOMETRY,VISION_POSITION_ESTIMATE,BATTERY_STATUS,SYS_STATUS,"
        "SCALED_PRESSURE,HIGHRES_IMU,SYSTEM_TIME,DISTANCE_SENSOR,DEBUG_FLOAT_ARRAY"
    )
    seen = talk(sim, f"udpin:127.0.0.1:{port}", wanted)
    assert {one["system"] for one in seen.values()} == {1}
    assert seen["HEARTBEAT"]["system_status"] == 4
    assert seen["HEARTBEAT"]["mavlink_version"] == 3
    # X of the world is north, Y is west: 4 m to the west are -4 m to the east; a turn to the left is a negative yaw
    vision = seen["VISION_POSITION_ESTIMATE"]
    assert (vision["x"], vision["y"]) == pytest.approx((3.0, -4.0), abs=0.01)
    assert vision["yaw"] == pytest.approx(-0.5, abs=0.01)
    assert seen["ATTITUDE"]["yaw"] == pytest.approx(-0.5, abs=0.01)
    assert seen["LOCAL_POSITION_NED"]["x"] == pytest.approx(0.0, abs=0.05)
    assert math.isnan(seen["ODOMETRY"]["pose_covariance"][0])
    # a sensor at rest measures the reaction to gravity: its specific force is -9.81 along the axis that points down
    assert seen["HIGHRES_IMU"]["zacc"] == pytest.approx(-9.81, abs=0.1)
    assert seen["HIGHRES_IMU"]["fields_updated"] & 0b111111 == 0b111111
    assert 0 < seen["BATTERY_STATUS"]["battery_remaining"] <= 100
    assert seen["BATTERY_STATUS"]["voltages"] == [0xFFFF] * 10
    assert seen["DISTANCE_SENSOR"]["orientation"] == 25
    assert seen["DISTANCE_SENSOR"]["max_distance"] == 2000
    # simulated time, ms
    assert 0 < seen["SYSTEM_TIME"]["time_boot_ms"] <= sim.clock.stamp() // 1_000_000


@pytest.mark.parametrize(
    ("world", "angle", "north", "east"), [("nwu", math.pi / 2.0, 3.0, -4.0), ("enu", 0.0, 4.0, 3.0)]
)
def test_north_is_where_the_earth_has_it(
    start: Callable[..., Any], world: str, angle: float, north: float, east: float
) -> None:
    port = free_port(socket.SOCK_DGRAM)
    components = part("Pose", "pose") + part("Attitude", "attitude") + GPS
    earth = EARTH.format(more=f", angle_against_north={angle}")
    sim = start(
        f"udpout:127.0.0.1:{port}", components, place="3, 4, 0", yaw=0.5, properties=earth, options=f", world='{world}'"
    )
    seen = talk(sim, f"udpin:127.0.0.1:{port}", "GPS_RAW_INT,VISION_POSITION_ESTIMATE,ATTITUDE")
    vision, gps = seen["VISION_POSITION_ESTIMATE"], seen["GPS_RAW_INT"]
    assert (vision["x"], vision["y"]) == pytest.approx((north, east), abs=0.01)
    # the satellites agree: 111.1 km for a degree of latitude there
    assert (gps["lat"] * 1e-7 - 43.6) * 111_100.0 == pytest.approx(north, abs=0.05)
    assert (gps["lon"] * 1e-7 - 1.4) * 80_700.0 == pytest.approx(east, abs=0.1)
    assert gps["alt"] == pytest.approx(135_000, abs=300)
    assert (gps["fix_type"], gps["satellites_visible"], gps["yaw"]) == (3, 255, 0)
    heading = angle + 0.5  # from east, counter-clockwise
    assert math.remainder(seen["ATTITUDE"]["yaw"] - (math.pi / 2.0 - heading), math.tau) == pytest.approx(0, abs=0.01)


def test_a_link_that_has_north_elsewhere_is_refused(start: Callable[..., Any]) -> None:
    gps = "gps = GPS(); gps.level('raw'); robot.append(gps)"
    with pytest.raises(MorseError, match=r"robot.gps finds north at another place .* world='enu'"):
        start(f"udpout:127.0.0.1:{free_port(socket.SOCK_DGRAM)}", gps, properties=EARTH.format(more=""))


def test_an_autopilot_in_the_loop(start: Callable[..., Any]) -> None:
    port = free_port()
    components = (
        part("IMU", "imu") + part("Barometer", "barometer") + "gps = GPS(); gps.level('raw'); robot.append(gps)\n"
        "motors = QuadrotorDynamicControl(); robot.append(motors); motors.add_stream('mavlink', full=800.0)\n"
    )
    sim = start(
        f"tcpin:127.0.0.1:{port}", components, robot="Quadrotor",
        properties=EARTH.format(more=""), options=", hil=True, world='enu'",
    )  # fmt: skip
    controls = [0.5, 0.25, 1.0, 0.0] + [0.0] * 12
    command = json.dumps(["hil_actuator_controls_send", 0, controls, 128, 0])
    seen = talk(sim, f"tcp:127.0.0.1:{port}", "HIL_SENSOR,HIL_GPS,HEARTBEAT", command)
    assert seen["HEARTBEAT"]["base_mode"] & 32
    sensor = seen["HIL_SENSOR"]
    # acceleration, turn rate, magnetic field, pressure
    assert sensor["fields_updated"] & 0b1111111111 == 0b1111111111
    # the field of the earth is about half a gauss; near France, it points north and down
    assert 0.4 < math.hypot(sensor["xmag"], sensor["ymag"], sensor["zmag"]) < 0.55
    assert sensor["zmag"] > 0.0
    assert sensor["abs_pressure"] == pytest.approx(997.0, abs=20.0)  # 135 m above sea level, standard atmosphere
    step_until(sim, lambda: sim.context.components["robot.motors"].local_data["engines"] != [0.0] * 4)
    assert list(sim.context.components["robot.motors"].local_data["engines"]) == pytest.approx(
        [400.0, 200.0, 800.0, 0.0]
    )


def test_a_gimbal_looks_where_it_is_told_and_wheels_say_how_far_they_went(start: Callable[..., Any]) -> None:
    port = free_port(socket.SOCK_DGRAM)
    components = "".join(
        ["head = PTU(); robot.append(head); angles = PTUPosture('angles'); head.append(angles)\n",
         part("WheelEncoders", "wheels", StepsPerTurn=0), part("MotionVWDiff", "motion")]
    )  # fmt: skip
    sim = start(f"udpin:127.0.0.1:{port}", components, robot="Pioneer3DX")
    sim.robot.motion.publish({"v": 0.5})
    sim.step(60)
    sim.robot.motion.publish({"v": 0.0})
    pitch, yaw = 0.2, 0.3
    command = ["gimbal_manager_set_pitchyaw_send", 0, 0, 0, 0, pitch, yaw, math.nan, math.nan]
    talk(sim, f"udpout:127.0.0.1:{port}", "HEARTBEAT", json.dumps(command))
    head = sim.context.components["robot.head"].local_data
    step_until(sim, lambda: head["pan"] != 0.0)
    # MAVLink: positive to the right and upward
    assert (head["pan"], head["tilt"]) == pytest.approx((-yaw, -pitch), abs=1e-6)
    angles = sim.context.components["robot.head.angles"].local_data
    step_until(sim, lambda: (angles["pan"], angles["tilt"]) == pytest.approx((-yaw, -pitch), abs=1e-4))
    seen = talk(sim, f"udpout:127.0.0.1:{port}", "GIMBAL_DEVICE_ATTITUDE_STATUS,WHEEL_DISTANCE", json.dumps(command))
    # rotation by yaw about Z (down), then by pitch about Y (right)
    p, y = pitch / 2.0, yaw / 2.0
    expected = (
        math.cos(y) * math.cos(p),
        -math.sin(y) * math.sin(p),
        math.cos(y) * math.sin(p),
        math.sin(y) * math.cos(p),
    )
    assert seen["GIMBAL_DEVICE_ATTITUDE_STATUS"]["q"] == pytest.approx(expected, abs=1e-3)
    assert seen["GIMBAL_DEVICE_ATTITUDE_STATUS"]["flags"] == 32  # YAW_IN_VEHICLE_FRAME
    rolled = seen["WHEEL_DISTANCE"]
    wheels = sim.context.components["robot.wheels"]
    assert rolled["count"] == 2
    assert rolled["distance"][0] == pytest.approx(wheels.local_data["position"][0] * wheels.radii[0], abs=0.05)
    assert rolled["distance"][0] > 0.1
    assert rolled["distance"][2:] == [0.0] * 14


def test_covariances_turn_with_the_axes() -> None:
    # different variances along X (east) and Y (north), correlated: upper triangle of north, east, down
    given = np.diag([1.0, 4.0, 9.0, 0.1, 0.2, 0.3])
    given[0, 1] = given[1, 0] = 0.5
    given[0, 2] = given[2, 0] = 0.25
    turned = Axes("enu").covariance(given)
    assert turned[:6] == [4.0, 0.5, 0.0, 0.0, 0.0, 0.0]
    assert turned[6:11] == [1.0, -0.25, 0.0, 0.0, 0.0]
    assert turned[15:] == pytest.approx([0.2, 0.0, 0.0, 0.1, 0.0, 0.3])
    body = Axes("enu").covariance(given, of_body=True)  # Y and Z are reversed
    assert body[:3] == [1.0, -0.5, -0.25]
    assert math.isnan(Axes("enu").covariance(None)[0])


@pytest.mark.parametrize("yaw_given", [False, True])
def test_a_place_to_fly_to(start: Callable[..., Any], yaw_given: bool) -> None:
    port = free_port(socket.SOCK_DGRAM)
    sim = start(f"udpin:127.0.0.1:{port}", "goal = RotorcraftWaypoint(); robot.append(goal)", robot="Quadrotor")
    mask = 0b101111111000 if yaw_given else 0b111111111000
    command = json.dumps(["set_position_target_local_ned_send", 0, 0, 0, 1, mask, 10, 5, -2, 0, 0, 0, 0, 0, 0, 0.5, 0])
    talk(sim, f"udpout:127.0.0.1:{port}", "HEARTBEAT", command)
    data = sim.context.components["robot.goal"].local_data
    step_until(sim, lambda: data["x"] == 10.0)
    assert (data["x"], data["y"], data["z"]) == (10.0, -5.0, 2.0)
    assert data["tolerance"] == 0.5
    assert data["yaw"] == pytest.approx(-0.5 if yaw_given else 0.0, abs=1e-3)


def test_an_attitude_to_take(start: Callable[..., Any]) -> None:
    port = free_port(socket.SOCK_DGRAM)
    sim = start(f"udpin:127.0.0.1:{port}", "stick = RotorcraftAttitude(); robot.append(stick)", robot="Quadrotor")
    roll = 0.2
    q = [math.cos(roll / 2.0), math.sin(roll / 2.0), 0.0, 0.0]
    command = json.dumps(["set_attitude_target_send", 0, 0, 0, 0, q, 0.0, 0.0, 0.3, 0.6])
    talk(sim, f"udpout:127.0.0.1:{port}", "HEARTBEAT", command)
    data = sim.context.components["robot.stick"].local_data
    step_until(sim, lambda: data["thrust"] > 0.0)
    assert data["thrust"] == pytest.approx(0.6)
    # the actuator has the axes of autopilots: no sign changes
    assert (data["roll"], data["pitch"], data["yaw"]) == pytest.approx((roll, 0.0, 0.3), abs=1e-3)


def test_a_velocity_in_the_axes_of_the_robot(start: Callable[..., Any]) -> None:
    port = free_port(socket.SOCK_DGRAM)
    sim = start(f"udpin:127.0.0.1:{port}", "motion = MotionVW(); robot.append(motion)")
    mask = 0b010111000111
    command = ["set_position_target_local_ned_send", 0, 1, 0, 8, mask, 0, 0, 0, 0.5, 0, 0, 0, 0, 0, 0, 0.25]
    talk(sim, f"udpout:127.0.0.1:{port}", "HEARTBEAT", json.dumps(command))
    data = sim.context.components["robot.motion"].local_data
    step_until(sim, lambda: data["v"] == 0.5)
    assert data["w"] == -0.25  # clockwise from above is to the right


def test_obstacles_clockwise_from_ahead(start: Callable[..., Any]) -> None:
    port = free_port(socket.SOCK_DGRAM)
    scan = "scan = Hokuyo(); scan.properties(scan_window=180.0, resolution=1.0); robot.append(scan)\n"
    box = 'box = PassiveObject("props/objects", "BoxStand"); box.translate(x=3.0, y=2.0)\n'
    sim = start(f"udpout:127.0.0.1:{port}", scan + "scan.translate(z=0.3)\n" + box)
    seen = talk(sim, f"udpin:127.0.0.1:{port}", "OBSTACLE_DISTANCE")
    message = seen["OBSTACLE_DISTANCE"]
    ranges = sim.context.components["robot.scan"].local_data["range_list"]
    assert message["increment_f"] == 5.0
    distances = message["distances"]
    # 5 degrees to the left of ahead is the last bin, 5 degrees to the right the second one; there are no data behind
    assert distances[36] == 0xFFFF
    assert all(distances[bin] == 3001 for bin in range(2, 17)), "nothing on the right: 30 m and 1 cm"
    nearest = min(range(len(ranges)), key=lambda ray: ranges[ray])
    degrees = nearest - 90  # counter-clockwise from ahead
    assert degrees > 0, "the box is on the left"
    assert distances[round(-degrees / 5.0) % 72] == pytest.approx(100.0 * ranges[nearest], abs=1.0)


def test_garbage_and_strangers_do_no_harm(start: Callable[..., Any]) -> None:
    udp, tcp = free_port(socket.SOCK_DGRAM), free_port()
    components = (
        "motion = MotionVW(); robot.append(motion)\n"
        f"motion.add_stream('mavlink', device='udpin:127.0.0.1:{udp}')\n"
        "pose = Pose(); robot.append(pose)\n"
    )
    sim = start(f"tcpin:127.0.0.1:{tcp}", components)
    rng = random.Random(1)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for size in (0, 1, 10, 1400, 60_000):
            sender.sendto(rng.randbytes(size), ("127.0.0.1", udp))
            sender.sendto(b"\xfd" * size, ("127.0.0.1", udp))
        sim.step(5)
        nan = ["set_position_target_local_ned_send", 0, 1, 0, 8, 0b010111000111, 0, 0, 0, math.nan, 0, 0, 0, 0, 0, 0, 0]
        talk(sim, f"udpout:127.0.0.1:{udp}", "HEARTBEAT", json.dumps(nan))
    browser = socket.create_connection(("127.0.0.1", tcp))
    browser.sendall(b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n\xfd\xfd\xfd")
    browser.setblocking(False)
    gone = []

    def has_ended() -> bool:
        try:
            gone.append(browser.recv(1 << 16))
        except BlockingIOError:
            return False
        except ConnectionResetError:
            return True
        return gone[-1] == b""

    step_until(sim, has_ended)
    browser.close()
    data = sim.context.components["robot.motion"].local_data
    assert (data["v"], data["w"]) == (0.0, 0.0)
    assert "robot.motion" not in sim.context.failed


def test_the_other_side_comes_and_goes(start: Callable[..., Any]) -> None:
    port = free_port()
    sim = start(f"tcp:127.0.0.1:{port}", part("Pose", "pose"))
    sim.step(30)  # without a peer
    for _ in range(2):
        seen = talk(sim, f"tcpin:127.0.0.1:{port}", "VISION_POSITION_ESTIMATE")
        assert seen["VISION_POSITION_ESTIMATE"]["system"] == 1
    sim.step(30)


def test_who_does_not_read_stops_nobody(start: Callable[..., Any]) -> None:
    port = free_port()
    scans = "".join(part("Pose", f"pose{number}") for number in range(20))
    sim = start(f"tcpin:127.0.0.1:{port}", scans)
    with socket.create_connection(("127.0.0.1", port)):
        sim.step(1500)  # 3.6 MB
    assert sim.clock.tick == 1500


def test_messages_in_pieces_and_between_noise() -> None:
    from pymavlink.dialects.v20 import common

    mav = common.MAVLink(None, srcSystem=9)
    message = mav.set_attitude_target_encode(0, 1, 1, 0, [1.0, 0.0, 0.0, 0.0], 0.1, 0.2, 0.3, 0.4)
    whole = bytes(message.pack(mav))
    number = common.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET
    framer = Framer({number})
    noise = b"\xfe\x01\xfd\x05ab"
    found = [frame for byte in noise + whole + noise * 60 + whole for frame in framer.feed(bytes([byte]))]
    good = [frame.data for frame in found if frame.data == whole]
    assert len(good) == 2
    assert mav.decode(bytearray(good[0])).thrust == pytest.approx(0.4)


def test_bytes_that_look_like_a_start_hold_up_no_message() -> None:
    from pymavlink.dialects.v20 import common

    # a system with the number of the start of a message of version 1, and values that contain it
    mav = common.MAVLink(None, srcSystem=0xFE, srcComponent=0xFD)
    framer = Framer({common.MAVLINK_MSG_ID_COMMAND_LONG})
    for number in range(20):
        data = bytes(mav.command_long_encode(1, 1, 400, number, *[-1.5e38] * 7).pack(mav))
        skipped = bytes(mav.statustext_encode(6, b"\xfe\xfd" * 25).pack(mav))
        taken = [frame.data for frame in framer.feed(skipped + data)]
        assert taken.count(data) == 1


@pytest.mark.parametrize("frame", ["nwu", "enu"])
def test_axes_there_and_back(frame: str) -> None:
    axes = Axes(frame)
    rng = random.Random(2)
    for _ in range(20):
        v = [rng.uniform(-5, 5) for _ in range(3)]
        assert axes.vector(axes.vector(v)) == pytest.approx(v)
        q = [rng.gauss(0, 1) for _ in range(4)]
        length = math.hypot(*q)
        q = [number / length for number in q]
        again = axes.quaternion(axes.quaternion(q))
        assert abs(sum(a * b for a, b in zip(q, again, strict=True))) == pytest.approx(1.0)
    # level and ahead along X: north in one world, east in the other
    level = {"nwu": 0.0, "enu": math.pi / 2.0}[frame]
    assert axes.angles((1.0, 0.0, 0.0, 0.0)) == pytest.approx((0.0, 0.0, level))
    # nose down: a positive pitch in MORSE, a negative one for aircraft
    nose_down = (math.cos(0.1), 0.0, math.sin(0.1), 0.0)
    assert axes.angles(nose_down)[1] == pytest.approx(-0.2)


@pytest.mark.parametrize(
    ("device", "components", "options", "said"),
    [
        ("serial:/dev/ttyS0", "", "", "expected udpout"),
        ("udpout:127.0.0.1:0", "", "", "expected udpout"),
        ("udpin:192.0.2.1:14550", "", "", "cannot be opened"),
        ("udpout:127.0.0.1:9", "", ", world='ned'", "world"),
        ("udpout:127.0.0.1:9", "pose2 = Pose(); robot.append(pose2); pose2.add_stream('mavlink', system_id=7)", "",
         "has the system_id"),
        ("udpout:127.0.0.1:9", "camera = VideoCamera(); robot.append(camera); camera.add_stream('mavlink')", "",
         "cannot carry"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(
    start: Callable[..., Any], device: str, components: str, options: str, said: str
) -> None:
    with pytest.raises(MorseError, match=said):
        start(device, part("Pose", "pose") + components, options=options)


def test_without_the_extra_the_line_that_installs_it_is_said(
    start: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pymavlink.dialects.v20", None)
    with pytest.raises(MorseError, match=r'pip install "pymavlink>=2.4.40,<3"'):
        start(f"udpout:127.0.0.1:{free_port(socket.SOCK_DGRAM)}", part("Pose", "pose"))


def test_the_example_of_the_documentation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    port = free_port(socket.SOCK_DGRAM)
    page = (DOCS / "mavlink.md").read_text(encoding="utf-8").replace("14550", str(port))
    blocks = [block.partition("```")[0] for block in page.split("```python\n")[1:]]
    scene, program = blocks[0], next(block for block in blocks if "import mavutil" in block)
    scene += f"env.configure_stream_manager('mavlink', device='udpout:127.0.0.1:{port}')\n"
    (tmp_path / "default.py").write_text(scene)
    (tmp_path / "client.py").write_text(program)
    with (
        morse.load(tmp_path / "default.py", sockets=True) as sim,
        tempfile.TemporaryFile("w+") as said,
        subprocess.Popen([sys.executable, str(tmp_path / "client.py")], stdout=said, stderr=said) as other,
    ):
        try:
            step_until(sim, lambda: other.poll() is not None)
        finally:
            other.kill()
        said.seek(0)
        assert "m to the north" in said.read()
