"""The autopilot of MAVLink, by pymavlink in simulated time: arming, setpoints, one frame, rates, types, ends."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pymavlink")

from ground_station import GroundStation, fly

pytestmark = pytest.mark.long

ARM, TAKEOFF, LAND, RETURN, SET_MODE, REPOSITION, SPEED, HOME = 400, 22, 21, 20, 176, 192, 178, 179
ACCEPTED, REJECTED, DENIED, UNSUPPORTED = 0, 1, 2, 3
NAN = math.nan
#: x, y and yaw of the start: everything is an offset from there
START = "robot.translate(x=3.0, y=-2.0, z=0.2); robot.rotate(z=0.6)"


def drone(actuator: str, start: str = START) -> str:
    return (
        f"robot = Quadrotor(); {start}\ngoal = {actuator}(); robot.append(goal)\nrobot.add_default_interface('mavlink')"
    )


@pytest.fixture
def station(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    running: list[GroundStation] = []

    def load(body: str, **options: Any) -> Any:
        running.extend(fly(tmp_path, body, **options))
        return running[0] if len(running) == 1 else tuple(running)

    yield load
    for one in running:
        one.close()
    if running:
        running[0].sim.close()


def place(ground: GroundStation) -> tuple[float, float, float]:
    message = ground.last("LOCAL_POSITION_NED")
    return message.x, message.y, message.z


def target(ground: GroundStation, x: float, y: float, z: float, *, yaw: float | None = None, frame: int = 1) -> None:
    mask = 0b110111111000 if yaw is None else 0b100111111000
    ground.send("set_position_target_local_ned", 0, 1, 1, frame, mask, x, y, z, 0, 0, 0, 0, 0, 0, yaw or 0.0, 0.0)


def arrives(ground: GroundStation, x: float, y: float, z: float, within: float = 0.1) -> None:
    """It comes there, and stays there."""
    ground.until(lambda: math.dist(place(ground), (x, y, z)) < 5.0 * within)
    ground.step(360)
    assert place(ground) == pytest.approx((x, y, z), abs=within)


@pytest.mark.parametrize("world", ["nwu", "enu"])
@pytest.mark.parametrize("actuator", ["RotorcraftWaypoint", "RotorcraftVelocity", "RotorcraftAttitude"])
def test_what_is_commanded_is_what_is_reported(station: Callable[..., Any], world: str, actuator: str) -> None:
    ground = station(drone(actuator), world=world)
    target(ground, 1.0, -2.0, -4.0, yaw=math.pi / 2.0)
    arrives(ground, 1.0, -2.0, -4.0)
    ground.until(lambda: abs(ground.last("ATTITUDE").yaw - math.pi / 2.0) < 0.05)
    # north is X of the world, or Y
    x, y, z = ground.sim.context.components["robot.goal"].robot_parent.bge_object.world_pose()[0]
    expected = (4.0, 0.0) if world == "nwu" else (1.0, -1.0)
    assert (x, y, z) == pytest.approx((*expected, 4.2), abs=0.15)
    home = ground.last("HOME_POSITION")
    assert (home.x, home.y, home.z) == (0.0, 0.0, 0.0)
    here = ground.last("GLOBAL_POSITION_INT")
    assert here.relative_alt == pytest.approx(4000, abs=100)
    # a degree of latitude is 111.17 km at Zuerich, one of longitude 75.46 km (WGS84)
    assert (here.lat - home.latitude) * 1e-7 * 111_170.0 == pytest.approx(1.0, abs=0.1)
    assert (here.lon - home.longitude) * 1e-7 * 75_460.0 == pytest.approx(-2.0, abs=0.1)
    assert here.hdg == pytest.approx(9000, abs=300)


def test_modes_without_a_number_of_px4(station: Callable[..., Any]) -> None:
    """MAV_MODE alone, as `set_mode_manual` of pymavlink sends it, is read as PX4 reads it."""
    ground = station(drone("RotorcraftWaypoint"))
    manual_armed, stabilize_armed, guided_armed, auto_armed = 192.0, 208.0, 216.0, 220.0
    for base, main in ((manual_armed, 1), (stabilize_armed, 7), (guided_armed, 3)):
        assert ground.command(SET_MODE, base) == ACCEPTED
        assert ground.last("HEARTBEAT").custom_mode == main << 16
    assert ground.command(SET_MODE, auto_armed) != ACCEPTED, "there is no mission"
    assert ground.command(SET_MODE, 0.0) != ACCEPTED
    ground.send("set_mode", 1, int(manual_armed), 0)
    ground.until(lambda: ground.last("HEARTBEAT").custom_mode == 1 << 16)


@pytest.mark.parametrize("actuator", ["RotorcraftWaypoint", "RotorcraftVelocity", "RotorcraftAttitude"])
@pytest.mark.peer("pymavlink")
def test_arm_take_off_go_return_and_land(station: Callable[..., Any], actuator: str) -> None:
    ground = station(drone(actuator))
    assert not ground.is_armed()
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == REJECTED, "it is not armed"
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.is_armed()
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.until(lambda: ground.last("EXTENDED_SYS_STATE").landed_state == 2)
    ground.until(lambda: abs(place(ground)[2] + 2.5) < 0.15)
    assert ground.last("HEARTBEAT").custom_mode == 4 << 16 | 3 << 24, "hold"
    assert ground.command(ARM, 0.0) == DENIED, "it flies"
    here = ground.last("GLOBAL_POSITION_INT")
    # 6 m to the north
    goal = ((here.lat * 1e-7) + 6.0 / 111_170.0, here.lon * 1e-7, here.alt * 1e-3 + 1.0)
    assert ground.command(REPOSITION, 3.0, 1.0, 0.0, NAN, *goal) == ACCEPTED
    # COMMAND_LONG has 32 bits for 47 degrees: 0.4 m
    ground.until(lambda: math.dist(place(ground), (6.0, 0.0, -3.5)) < 0.5)
    assert ground.command(RETURN) == ACCEPTED
    highest = []
    ground.until(lambda: highest.append(place(ground)[2]) or not ground.seen[1, "HEARTBEAT"].base_mode & 128)
    assert min(highest) == pytest.approx(-10.0, abs=1.0), "RTL_RETURN_ALT"
    x, y, _ = place(ground)
    assert math.hypot(x, y) < 0.5
    assert ground.last("EXTENDED_SYS_STATE").landed_state == 1
    resting = ground.sim.context.components["robot.goal"].robot_parent.bge_object.world_pose()[0][2]
    ground.step(120)
    assert ground.sim.context.components["robot.goal"].robot_parent.bge_object.world_pose()[0][2] == pytest.approx(
        resting, abs=0.02
    )


@pytest.mark.peer("pymavlink")
def test_a_robot_drives_where_it_is_told(station: Callable[..., Any]) -> None:
    ground = station(
        "robot = ATRV(); robot.translate(x=3.0, y=-2.0); robot.rotate(z=0.6)\nmotion = MotionVW(); "
        "robot.append(motion)\nrobot.add_default_interface('mavlink')"
    )
    assert ground.last("HEARTBEAT").type == 10
    assert ground.command(TAKEOFF) == UNSUPPORTED
    assert ground.command(ARM, 1.0) == ACCEPTED
    target(ground, -4.0, 3.0, 0.0)
    ground.until(lambda: math.dist(place(ground)[:2], (-4.0, 3.0)) < 0.5)
    assert ground.command(ARM, 0.0) == ACCEPTED
    ground.step(60)
    stopped = place(ground)
    ground.step(60)
    assert math.dist(stopped, place(ground)) < 0.02


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        (drone("RotorcraftWaypoint"), 2),
        (
            "robot = RMax(); robot.translate(z=1); p = Pose(); robot.append(p); robot.add_default_interface('mavlink')",
            4,
        ),
        ("robot = Submarine(); p = Pose(); robot.append(p); robot.add_default_interface('mavlink')", 12),
        (
            "robot = Morsy(); h = Hydrodynamics(); robot.append(h); p = Pose(); robot.append(p); "
            "p.add_stream('mavlink')",
            11,
        ),
        ("robot = Pioneer3DX(); p = Pose(); robot.append(p); robot.add_default_interface('mavlink')", 10),
    ],
)
def test_a_vehicle_has_the_type_of_its_robot(station: Callable[..., Any], body: str, kind: int) -> None:
    heartbeat = station(body).last("HEARTBEAT")
    assert heartbeat.type == kind
    assert heartbeat.autopilot == 12, "PX4"


@pytest.mark.peer("pymavlink")
def test_messages_come_at_their_rates_in_simulated_time(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    ground.step(60)
    ground.heard.clear()
    ground.step(600)
    counts = {name: sum(1 for one in ground.heard if one.get_type() == name) for name in ("HEARTBEAT", "ATTITUDE")}
    assert counts == {"HEARTBEAT": 10, "ATTITUDE": 200}
    assert ground.command(511, 30.0, 100_000.0) == ACCEPTED  # ATTITUDE each 0.1 s
    assert ground.command(510, 30.0) == ACCEPTED
    assert ground.seen[1, "MESSAGE_INTERVAL"].interval_us == 100_000
    assert ground.command(511, 0.0, -1.0) == ACCEPTED
    ground.heard.clear()
    ground.step(600)
    assert sum(1 for one in ground.heard if one.get_type() == "ATTITUDE") in (99, 100, 101)
    assert not [one for one in ground.heard if one.get_type() == "HEARTBEAT"]
    assert ground.command(512, 148.0) == ACCEPTED
    ground.step(2)
    assert ground.seen[1, "AUTOPILOT_VERSION"].capabilities & 4, "missions with whole numbers"
    assert ground.command(511, 12345.0, 1e5) == UNSUPPORTED
    assert ground.command(512, NAN) == UNSUPPORTED


@pytest.mark.peer("pymavlink")
def test_parameters_are_listed_read_and_set(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    ground.send("param_request_list", 1, 1)
    names: dict[str, float] = {}
    ground.until(lambda: {one.param_id for one in ground.heard if one.get_type() == "PARAM_VALUE"} >= {"NAV_ACC_RAD"})
    ground.step(10)
    names = {one.param_id: one for one in ground.heard if one.get_type() == "PARAM_VALUE"}
    count = names["MIS_TAKEOFF_ALT"].param_count
    assert sorted(one.param_index for one in names.values()) == list(range(count))
    ground.send("param_set", 1, 1, b"MIS_TAKEOFF_ALT", 4.0, 9)
    assert ground.last("PARAM_VALUE").param_value == 4.0
    for wrong in (NAN, math.inf, -1.0, 3e38):
        ground.send("param_set", 1, 1, b"MIS_TAKEOFF_ALT", wrong, 9)
        assert ground.last("PARAM_VALUE").param_value == 4.0
    ground.send("param_request_read", 1, 1, b"NAV_ACC_RAD", -1)
    assert ground.last("PARAM_VALUE").param_id == "NAV_ACC_RAD"
    ground.send("param_request_read", 1, 1, b"", 0)
    assert ground.last("PARAM_VALUE").param_index == 0
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.until(lambda: abs(place(ground)[2] + 4.0) < 0.15)


@pytest.mark.peer("pymavlink")
def test_velocities_and_sticks(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    target(ground, 0.0, 0.0, -3.0)
    arrives(ground, 0.0, 0.0, -3.0)
    # 1.5 m/s to the east, whatever the heading
    velocity = (0, 1, 1, 1, 0b110111000111, 0, 0, 0, 0.0, 1.5, 0.0, 0, 0, 0, 0, 0)
    ground.send("set_position_target_local_ned", *velocity)
    ground.until(lambda: abs(ground.last("LOCAL_POSITION_NED").vy - 1.5) < 0.1)
    assert abs(ground.last("LOCAL_POSITION_NED").vx) < 0.2
    assert ground.command(SET_MODE, 1.0, 3.0) == ACCEPTED, "position"
    yaw = ground.last("ATTITUDE").yaw
    for _ in range(150):
        ground.send("manual_control", 1, 500, 0, 500, 0, 0)
        ground.step(2)
    north, east = math.cos(yaw), math.sin(yaw)
    speed = ground.last("LOCAL_POSITION_NED")
    assert speed.vx * north + speed.vy * east == pytest.approx(2.5, abs=0.4), "half of MPC_XY_CRUISE"
    ground.step(600)  # nobody holds the sticks
    assert math.hypot(ground.last("LOCAL_POSITION_NED").vx, ground.last("LOCAL_POSITION_NED").vy) < 0.2


@pytest.mark.peer("pymavlink")
def test_several_vehicles_and_several_stations(station: Callable[..., Any]) -> None:
    body = (
        "drones = []\nfor number in range(3):\n    one = Quadrotor(f'drone{number}')\n"
        "    one.translate(x=4.0 * number, z=0.2)\n    goal = RotorcraftWaypoint('goal')\n    one.append(goal)\n"
        "    one.add_default_interface('mavlink')\n    drones.append(one)"
    )
    first, second = station(body, stations=2)
    for number in (1, 2, 3):
        assert first.last("HEARTBEAT", number).get_srcSystem() == number
    assert second.last("HEARTBEAT", 3)
    assert second.command(ARM, 1.0, system=2) == ACCEPTED
    assert second.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN, system=2) == ACCEPTED
    second.until(lambda: second.last("LOCAL_POSITION_NED", 2).z < -2.0)
    assert first.last("HEARTBEAT", 2).base_mode & 128
    assert not first.last("HEARTBEAT", 1).base_mode & 128
    assert first.last("LOCAL_POSITION_NED", 1).z == pytest.approx(0.0, abs=0.3)


def test_the_same_messages_in_the_same_ticks_give_the_same_flight(station: Callable[..., Any], tmp_path: Path) -> None:
    def flight() -> list[tuple[float, ...]]:
        ground = fly(tmp_path, drone("RotorcraftWaypoint"))[0]
        ground.step(30)
        for number in (ARM, TAKEOFF):
            ground.send("command_long", 1, 1, number, 0, 1.0, 0, 0, 0, 0, 0, 3.0)
            ground.step(200)
        track = [tuple(map(float, ground.sim.context.robots["robot"].bge_object.world_pose()[0]))]
        ground.step(100)
        track.append(tuple(map(float, ground.sim.context.robots["robot"].bge_object.world_pose()[0])))
        ground.close()
        ground.sim.close()
        return track

    assert flight() == flight()


@pytest.mark.peer("pymavlink")
def test_a_ground_station_finds_the_gimbal_and_turns_it(station: Callable[..., Any]) -> None:
    ground = station(
        "robot = ATRV(); head = PTU(); robot.append(head)\nangles = PTUPosture('angles'); head.append(angles)\n"
        "robot.add_default_interface('mavlink')"
    )
    assert ground.command(512, 280.0) == ACCEPTED
    assert ground.command(512, 283.0) == ACCEPTED
    device = ground.seen[1, "GIMBAL_DEVICE_INFORMATION"].gimbal_device_id
    assert ground.seen[1, "GIMBAL_MANAGER_INFORMATION"].gimbal_device_id == device
    assert ground.last("GIMBAL_MANAGER_STATUS").gimbal_device_id == device
    assert ground.command(1000, -10.0, 20.0, NAN, NAN) == ACCEPTED  # pitch and yaw, degrees
    head = ground.sim.context.components["robot.head"].local_data
    # upward and to the right are negative in MORSE
    ground.until(lambda: head["tilt"] == pytest.approx(math.radians(10.0)))
    assert head["pan"] == pytest.approx(math.radians(-20.0))
    assert ground.last("GIMBAL_DEVICE_ATTITUDE_STATUS").gimbal_device_id == device
    assert ground.command(1000, math.inf, 0.0) == UNSUPPORTED
