"""Missions of MAVLink by pymavlink in simulated time: upload, download, flight, refusals, half uploads, floods."""

import math
import random
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("pymavlink")

from test_mavlink_flight import ACCEPTED, ARM, DENIED, SET_MODE, arrives, drone, place, station, target

pytestmark = pytest.mark.long

__all__ = ["station"]

LOCAL, ABOVE_HOME, NO_FRAME = 1, 6, 2
WAYPOINT, RETURN, LAND, TAKEOFF, JUMP, SPEED, VIDEO = 16, 20, 21, 22, 177, 178, 2500
RALLY = 2
UNSUPPORTED, NO_SPACE, INVALID_X, INVALID_SEQUENCE, CANCELLED, REFUSED = 3, 4, 10, 13, 15, 14
NAN = math.nan


def at(north: float, east: float, down: float, *, seconds: float = 0.0) -> tuple[Any, ...]:
    return LOCAL, WAYPOINT, seconds, 0.5, 0.0, NAN, round(north * 1e4), round(east * 1e4), down


def start(ground: Any) -> None:
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(SET_MODE, 1.0, 4.0, 4.0) == ACCEPTED
    assert ground.is_armed()


def track_of(ground: Any) -> list[tuple[float, float, float]]:
    return [(one.x, one.y, one.z) for one in ground.heard if one.get_type() == "LOCAL_POSITION_NED"]


SQUARE = [
    (LOCAL, TAKEOFF, 0.0, 0.0, 0.0, NAN, 0, 0, -3.0),
    (NO_FRAME, SPEED, 1.0, 3.0, -1.0, 0.0, 0, 0, 0.0),
    at(5.0, 0.0, -3.0),
    at(5.0, 5.0, -3.0, seconds=2.0),
    at(0.0, 5.0, -3.0),
    at(0.0, 0.0, -3.0),
    (LOCAL, LAND, 0.0, 0.0, 0.0, NAN, 0, 0, 0.0),
]


@pytest.mark.parametrize("actuator", ["RotorcraftWaypoint", "RotorcraftVelocity"])
@pytest.mark.peer("pymavlink")
def test_a_drone_flies_a_square_and_lands(station: Callable[..., Any], actuator: str) -> None:
    ground = station(drone(actuator))
    assert ground.upload(SQUARE) == ACCEPTED
    start(ground)
    ground.until(lambda: not ground.seen[1, "HEARTBEAT"].base_mode & 128)
    track = track_of(ground)
    for corner in ((5.0, 0.0, -3.0), (5.0, 5.0, -3.0), (0.0, 5.0, -3.0), (0.0, 0.0, -3.0)):
        assert min(math.dist(corner, one) for one in track) < 0.6, corner
    assert math.hypot(*place(ground)[:2]) < 0.5
    assert place(ground)[2] == pytest.approx(0.0, abs=0.3)
    reached = [one.seq for one in ground.heard if one.get_type() == "MISSION_ITEM_REACHED"]
    assert reached == list(range(len(SQUARE)))
    assert ground.last("MISSION_CURRENT").mission_state == 5, "complete"
    # 20 m at no more than 3 m/s, 2 s of waiting
    begin = ground.times[next(k for k, one in enumerate(ground.heard) if one.get_type() == "MISSION_ITEM_REACHED")]
    assert ground.sim.clock.time - begin > 20.0 / 3.0 + 2.0


@pytest.mark.peer("pymavlink")
def test_a_rover_drives_a_square(station: Callable[..., Any]) -> None:
    ground = station(
        "robot = ATRV(); robot.translate(x=3.0, y=-2.0); robot.rotate(z=0.6)\nmotion = MotionVW(); "
        "robot.append(motion)\nrobot.add_default_interface('mavlink')"
    )
    corners = [(3.0, 0.0), (3.0, 3.0), (0.0, 3.0), (0.0, 0.0)]
    assert ground.upload([at(*corner, 0.0) for corner in corners]) == ACCEPTED
    start(ground)
    ground.until(lambda: ground.last("MISSION_CURRENT").mission_state == 5, 200.0)
    track = track_of(ground)
    for corner in corners:
        assert min(math.dist(corner, one[:2]) for one in track) < 0.6, corner


@pytest.mark.peer("pymavlink")
def test_a_car_drives_to_places_that_it_cannot_turn_to_on_the_spot(station: Callable[..., Any]) -> None:
    ground = station(
        "robot = Hummer(); robot.translate(z=0.5)\nmotion = SteerForce(); robot.append(motion)\n"
        "robot.add_default_interface('mavlink')"
    )
    # behind it, far, and within its smallest circle
    corners = [(-6.0, 6.0), (6.0, 6.0), (7.0, 8.0), (0.0, -6.0)]
    assert ground.upload([at(*corner, 0.0) for corner in corners]) == ACCEPTED
    start(ground)
    ground.until(lambda: ground.last("MISSION_CURRENT").mission_state == 5, 400.0)
    track = track_of(ground)
    for corner in corners:
        assert min(math.dist(corner, one[:2]) for one in track) < 0.6, corner
    ground.step(240)
    stopped = place(ground)
    ground.step(120)
    assert math.dist(stopped, place(ground)) < 0.05


@pytest.mark.parametrize("actuator", ["Waypoint", "MotionXYW"])
def test_other_actuators_drive_missions_too(station: Callable[..., Any], actuator: str) -> None:
    ground = station(
        f"robot = ATRV(); robot.translate(x=3.0, y=-2.0)\nmotion = {actuator}(); robot.append(motion)\n"
        "robot.add_default_interface('mavlink')"
    )
    assert ground.upload([at(2.0, 0.0, 0.0), at(2.0, -2.0, 0.0), (LOCAL, RETURN, *[0.0] * 4, 0, 0, 0.0)]) == ACCEPTED
    start(ground)
    ground.until(lambda: math.dist(place(ground)[:2], (2.0, -2.0)) < 1.0)
    ground.until(lambda: math.hypot(*place(ground)[:2]) < 1.0)


@pytest.mark.peer("pymavlink")
def test_pause_jump_and_set_the_current_item(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    items = [
        at(0.0, 0.0, -3.0),
        at(2.0, 0.0, -3.0),
        (NO_FRAME, JUMP, 0.0, 1.0, 0.0, 0.0, 0, 0, 0.0),
        at(0.0, 4.0, -3.0),
    ]
    assert ground.upload(items) == ACCEPTED
    start(ground)
    ground.until(lambda: ground.last("MISSION_CURRENT").seq == 1)
    assert ground.command(193, 0.0) == ACCEPTED, "pause"
    ground.step(300)
    assert ground.last("MISSION_CURRENT").mission_state == 4
    assert ground.command(193, 1.0) == ACCEPTED
    ground.until(lambda: ground.last("MISSION_CURRENT").mission_state == 5)
    reached = [one.seq for one in ground.heard if one.get_type() == "MISSION_ITEM_REACHED"]
    assert reached == [0, 1, 2, 0, 1, 2, 3]
    ground.send("mission_set_current", 1, 1, 1)
    ground.until(lambda: ground.last("MISSION_CURRENT").seq == 1)
    assert ground.command(224, 7.0) == DENIED
    assert ground.command(224, NAN) == DENIED


@pytest.mark.peer("pymavlink")
def test_what_was_uploaded_is_downloaded(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    assert ground.upload(SQUARE) == ACCEPTED
    ground.send("mission_request_list", 1, 1, 0)
    assert ground.last("MISSION_COUNT").count == len(SQUARE)
    for seq, (frame, command, *rest) in enumerate(SQUARE):
        ground.send("mission_request_int", 1, 1, seq, 0)
        item = ground.last("MISSION_ITEM_INT")
        assert (item.seq, item.frame, item.command, item.x, item.y, item.z) == (seq, frame, command, *rest[4:])
        ground.send("mission_request", 1, 1, seq, 0)
        assert ground.last("MISSION_ITEM").x == pytest.approx(rest[4] * 1e-4)
    ground.send("mission_request_int", 1, 1, 99, 0)
    assert ground.last("MISSION_ACK").type == INVALID_SEQUENCE
    ground.send("mission_clear_all", 1, 1, 0)
    assert ground.last("MISSION_ACK").type == ACCEPTED
    ground.send("mission_request_list", 1, 1, 0)
    assert ground.last("MISSION_COUNT").count == 0
    assert ground.command(SET_MODE, 1.0, 4.0, 4.0) != ACCEPTED, "there is no mission"


def test_rally_points_and_what_is_not_supported_are_refused(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    assert ground.upload(SQUARE) == ACCEPTED
    ground.send("mission_count", 1, 1, 4, RALLY)
    answer = ground.last("MISSION_ACK")
    assert (answer.type, answer.mission_type) == (UNSUPPORTED, RALLY)
    ground.send("mission_request_list", 1, 1, RALLY)
    assert (ground.last("MISSION_COUNT").count, ground.seen[1, "MISSION_COUNT"].mission_type) == (0, RALLY)
    assert ground.upload([at(0, 0, -3.0), (NO_FRAME, VIDEO, *[0.0] * 4, 0, 0, 0.0)]) == UNSUPPORTED
    assert ground.upload([(99, WAYPOINT, *[0.0] * 4, 0, 0, 0.0)]) == 2, "MAV_MISSION_UNSUPPORTED_FRAME"
    assert ground.upload([(ABOVE_HOME, WAYPOINT, *[0.0] * 4, 910_000_000, 0, 5.0)]) == INVALID_X
    for wrong in (NAN, math.inf, -3e38):
        assert ground.upload([(ABOVE_HOME, WAYPOINT, *[0.0] * 4, 0, 0, wrong)]) == 12, "MAV_MISSION_INVALID_PARAM7"
    ground.send("mission_count", 1, 1, 65_535, 0)
    assert ground.last("MISSION_ACK").type == NO_SPACE
    # none of that has changed the mission
    ground.send("mission_request_list", 1, 1, 0)
    assert ground.last("MISSION_COUNT").count == len(SQUARE)


def test_a_half_upload_ends_and_one_station_uploads_at_a_time(station: Callable[..., Any]) -> None:
    first, second = station(drone("RotorcraftWaypoint"), stations=2)
    first.send("mission_count", 1, 1, 3, 0)
    assert first.last("MISSION_REQUEST_INT").seq == 0
    assert first.last("MISSION_REQUEST_INT").seq == 0, "it is asked for again"
    second.send("mission_count", 1, 1, 2, 0)
    assert second.last("MISSION_ACK").type == REFUSED
    first.read()
    begin = first.sim.clock.time
    first.until(lambda: first.last("MISSION_ACK").type == CANCELLED, 12.0)
    assert first.sim.clock.time - begin < 6.0
    assert second.upload([at(1.0, 0.0, -3.0)]) == ACCEPTED


def test_no_field_of_a_command_harms(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    target(ground, 0.0, 0.0, -3.0)
    arrives(ground, 0.0, 0.0, -3.0)
    odd = (NAN, math.inf, -math.inf, 3.4e38, -3.4e38, 1e-40, -1.0, 65_536.0)
    rng = random.Random(7)
    for command in (16, 17, 20, 22, 21, 34, 115, 176, 178, 179, 185, 192, 193, 224, 300, 510, 511, 512, 520, 1000, 246):
        for _ in range(4):
            ground.command(command, *[rng.choice(odd) for _ in range(7)])
    for _ in range(100):
        mask = rng.choice((0, 0b110111111000, 0b110111000111, rng.randrange(1 << 16)))
        numbers = [rng.choice(odd) for _ in range(11)]
        ground.send("set_position_target_local_ned", 0, 1, 1, rng.choice((1, 7, 8, 9, 12, 3)), mask, *numbers)
        whole = [rng.choice((0, (1 << 31) - 1, -(1 << 31))) for _ in range(2)]
        ground.send("set_position_target_global_int", 0, 1, 1, rng.choice((0, 5, 6, 3)), mask, *whole, *numbers[:9])
        ground.send("set_attitude_target", 0, 1, 1, rng.randrange(256), [rng.choice(odd)] * 4, *numbers[:4])
        ground.send("manual_control", 1, *[rng.choice((0x7FFF, -0x8000, 0))] * 4, 0)
        ground.step()
    assert ground.sim.context.failed == {} or not ground.sim.context.failed
    # it still obeys
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(SET_MODE, 1.0, 4.0, 3.0) == ACCEPTED
    state = ground.sim.context.robots["robot"].bge_object.world_pose()[0]
    assert all(math.isfinite(number) for number in state)


def test_a_flood_of_commands_is_bounded(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    assert ground.command(ARM, 1.0) == ACCEPTED
    packets = []
    for _ in range(20):
        packets.append(bytes(ground.mav.param_request_list_encode(1, 1).pack(ground.mav)))
        packets.append(bytes(ground.mav.mission_count_encode(1, 1, 5000, 0).pack(ground.mav)))
        packets.append(bytes(ground.mav.command_long_encode(1, 1, 512, 0, 148.0, *[0.0] * 6).pack(ground.mav)))
    for _ in range(20):
        for packet in packets:
            ground.send_bytes(packet)
        ground.heard.clear()
        ground.step()
        # what is asked in a tick is answered in that tick: at most a few messages each
        assert len(ground.heard) < 300
    assert ground.command(ARM, 0.0) == ACCEPTED
