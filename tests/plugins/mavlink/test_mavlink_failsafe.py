"""Fences, setpoints that stop, followed targets, gimbals, answers for what a vehicle does not have."""

import math
import struct
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("pymavlink")

import random

from test_mavlink_flight import (
    ACCEPTED,
    ARM,
    DENIED,
    NAN,
    REPOSITION,
    SET_MODE,
    TAKEOFF,
    UNSUPPORTED,
    drone,
    place,
    station,
    target,
)

__all__ = ["station"]

pytestmark = pytest.mark.long

FENCE, ON_EARTH = 1, 3
INSIDE, OUTSIDE, IN_CIRCLE, OUT_OF_CIRCLE = 5001, 5002, 5003, 5004
HOLD, POSITION, RETURN, LAND, OFFBOARD = 4 << 16 | 3 << 24, 3 << 16, 4 << 16 | 5 << 24, 4 << 16 | 6 << 24, 6 << 16
#: 1e-7 degrees per metre to the north, near Zuerich
METRE = 1e7 / 111_180.0
LATITUDE, LONGITUDE = 473_977_420, 85_455_940
INT32, REAL32 = 6, 9


def at(north: float, east: float) -> tuple[int, int]:
    across = METRE / math.cos(math.radians(47.4))
    return LATITUDE + round(north * METRE), LONGITUDE + round(east * across)


def polygon(command: int, corners: list[tuple[float, float]]) -> list[tuple[Any, ...]]:
    return [(ON_EARTH, command, float(len(corners)), 0.0, 0.0, 0.0, *at(*corner), 0.0) for corner in corners]


def whole(ground: Any, name: bytes, value: int) -> None:
    """Set a parameter that PX4 has as INT32: its bytes are those of a whole number."""
    ground.send("param_set", 1, 1, name, struct.unpack("<f", struct.pack("<i", value))[0], INT32)
    answer = ground.last("PARAM_VALUE")
    assert answer.param_type == INT32
    assert struct.unpack("<i", struct.pack("<f", answer.param_value))[0] == value


def hovering(station: Callable[..., Any]) -> Any:
    ground = station(drone("RotorcraftWaypoint", "robot.translate(z=0.2)"))
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.until(lambda: place(ground)[2] < -2.2)
    return ground


SQUARE = [(-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0)]


@pytest.mark.peer("pymavlink", does="a fence is uploaded, downloaded and kept")
@pytest.mark.parametrize(("action", "mode"), [(2, HOLD), (3, RETURN), (5, LAND)])
def test_a_vehicle_leaves_its_fence(station: Callable[..., Any], action: int, mode: int) -> None:
    ground = hovering(station)
    fence = [*polygon(INSIDE, SQUARE), (ON_EARTH, OUT_OF_CIRCLE, 1.0, 0.0, 0.0, 0.0, *at(3.0, 3.0), 0.0)]
    assert ground.upload(fence, type_=FENCE) == ACCEPTED
    ground.send("mission_request_list", 1, 1, FENCE)
    assert ground.last("MISSION_COUNT").count == 5
    ground.send("mission_request_int", 1, 1, 4, FENCE)
    item = ground.last("MISSION_ITEM_INT")
    assert (item.command, item.x, item.mission_type) == (OUT_OF_CIRCLE, at(3.0, 3.0)[0], FENCE)
    whole(ground, b"GF_ACTION", action)
    # to a place outside it does not go
    far, near = at(20.0, 0.0), at(-3.0, 0.0)
    for (latitude, longitude), result in ((far, DENIED), (at(3.0, 3.0), DENIED), (near, ACCEPTED)):
        order = (-1.0, 0.0, 0.0, NAN, latitude * 1e-7, longitude * 1e-7, 490.5)
        assert ground.command(REPOSITION, *order) == result
    # setpoints may lead it outside
    target(ground, -20.0, 0.0, -2.5)
    assert "Geofence" in ground.last("STATUSTEXT").text
    assert place(ground)[0] == pytest.approx(-6.0, abs=1.0)
    assert ground.last("HEARTBEAT").custom_mode in (mode, LAND if mode == RETURN else mode)
    assert ground.command(512, 162.0) == ACCEPTED
    status = ground.seen.get((1, "FENCE_STATUS")) or ground.last("FENCE_STATUS")
    assert (status.breach_count, status.breach_type) == (1, 3)
    if action == 2:
        ground.step(600)
        assert place(ground)[0] == pytest.approx(-6.0, abs=1.2)
    if action == 3:
        ground.until(lambda: not ground.is_armed())
        assert math.hypot(*place(ground)[:2]) < 0.6


def test_distances_from_home_and_no_arming_outside(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint", "robot.translate(z=0.2)"))
    ring = [(ON_EARTH, IN_CIRCLE, 5.0, 0.0, 0.0, 0.0, *at(30.0, 0.0), 0.0)]
    assert ground.upload(ring, type_=FENCE) == ACCEPTED
    ground.step(2)
    assert ground.command(ARM, 1.0) == DENIED, "outside its fence"
    ground.send("mission_clear_all", 1, 1, FENCE)
    ground.step(2)
    ground.send("param_set", 1, 1, b"GF_MAX_VER_DIST", 4.0, REAL32)
    assert ground.command(ARM, 1.0) == ACCEPTED
    ground.seen.pop((1, "STATUSTEXT"), None)
    target(ground, 0.0, 0.0, -20.0)
    assert "Geofence" in ground.last("STATUSTEXT").text
    assert place(ground)[2] == pytest.approx(-4.0, abs=0.7)


@pytest.mark.parametrize(
    "items",
    [
        polygon(INSIDE, SQUARE)[:3],
        [*polygon(INSIDE, SQUARE)[:3], *polygon(OUTSIDE, SQUARE)],
        [(ON_EARTH, INSIDE, 2.0, 0.0, 0.0, 0.0, *at(1.0, 1.0), 0.0)],
        [(ON_EARTH, INSIDE, NAN, 0.0, 0.0, 0.0, *at(1.0, 1.0), 0.0)],
        [(ON_EARTH, IN_CIRCLE, -1.0, 0.0, 0.0, 0.0, *at(1.0, 1.0), 0.0)],
        [(ON_EARTH, IN_CIRCLE, math.inf, 0.0, 0.0, 0.0, *at(1.0, 1.0), 0.0)],
        [(ON_EARTH, IN_CIRCLE, 5.0, 0.0, 0.0, 0.0, 2_000_000_000, 0, 0.0)],
        [(1, IN_CIRCLE, 5.0, 0.0, 0.0, 0.0, 0, 0, 0.0)],
        [(ON_EARTH, 16, 0.0, 0.0, 0.0, 0.0, *at(1.0, 1.0), 0.0)],
    ],
)
def test_a_fence_that_is_none_is_refused_and_the_former_one_stays(
    station: Callable[..., Any], items: list[tuple[Any, ...]]
) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    assert ground.upload(polygon(INSIDE, SQUARE), type_=FENCE) == ACCEPTED
    assert ground.upload(items, type_=FENCE) != ACCEPTED
    ground.send("mission_request_list", 1, 1, FENCE)
    assert ground.last("MISSION_COUNT").count == 4


@pytest.mark.peer("pymavlink", does="setpoints stop, and go on")
@pytest.mark.parametrize(("action", "mode"), [(0, POSITION), (4, LAND), (5, HOLD)])
def test_setpoints_that_stop(station: Callable[..., Any], action: int, mode: int) -> None:
    ground = hovering(station)
    whole(ground, b"COM_OBL_RC_ACT", action)
    forward = (0, 1, 1, 1, 0b110111000111, 0, 0, 0, 1.0, 0.0, 0.0, 0, 0, 0, 0, 0)
    ground.send("set_position_target_local_ned", *forward)
    assert ground.command(SET_MODE, 1.0, 6.0) == ACCEPTED
    for _ in range(20):
        ground.send("set_position_target_local_ned", *forward)
        ground.step(15)
    assert ground.last("HEARTBEAT").custom_mode == OFFBOARD
    ground.seen.pop((1, "STATUSTEXT"), None)
    ground.send("set_position_target_local_ned", *forward)
    end = ground.sim.clock.time
    assert "Setpoints lost" in ground.last("STATUSTEXT").text
    assert ground.sim.clock.time - end == pytest.approx(1.0, abs=0.2), "COM_OF_LOSS_T"
    assert ground.last("HEARTBEAT").custom_mode == mode
    if action != 4:
        ground.step(300)
        assert abs(ground.last("LOCAL_POSITION_NED").vx) < 0.2
    # they go on, and so does OFFBOARD
    for _ in range(10):
        ground.send("set_position_target_local_ned", *forward)
        ground.step(15)
    assert ground.last("HEARTBEAT").custom_mode == OFFBOARD
    # unless the mode was set by somebody
    ground.step(120)
    assert ground.command(21) == ACCEPTED
    for _ in range(5):
        ground.send("set_position_target_local_ned", *forward)
        ground.step(15)
    assert ground.last("HEARTBEAT").custom_mode == LAND


def test_it_follows_a_target(station: Callable[..., Any]) -> None:
    ground = hovering(station)
    for name, value in ((b"FLW_TGT_DST", 4.0), (b"FLW_TGT_HT", 3.0)):
        ground.send("param_set", 1, 1, name, value, REAL32)
    assert ground.command(SET_MODE, 1.0, 4.0, 8.0) == ACCEPTED
    zeros = ([0.0] * 3, [1.0, 0.0, 0.0, 0.0], [0.0] * 3, [0.0] * 3, 0)
    for number in range(200):
        # to the east, 1 m/s: the drone comes behind it
        where = at(5.0, number * 0.1)
        ground.send("follow_target", 0, 3, *where, 488.0, [0.0, 1.0, 0.0], *zeros)
        ground.step(6)
    assert place(ground) == pytest.approx((5.0, 20.0 - 4.0, -3.0), abs=1.8)
    for wrong in (NAN, math.inf, 3e38):
        ground.send("follow_target", 0, 3, *at(5.0, 20.0), wrong, [wrong] * 3, *zeros)
    ground.send("follow_target", 0, 3, 2_000_000_000, 2_000_000_000, 0.0, [0.0] * 3, *zeros)
    ground.step(60)
    assert all(map(math.isfinite, place(ground)))


def test_a_gimbal_looks_at_a_place_and_turns_by_rates(station: Callable[..., Any]) -> None:
    ground = station(
        "robot = Quadrotor(); robot.translate(z=0.2)\ngoal = RotorcraftWaypoint(); robot.append(goal)\n"
        "ptu = PTU(); robot.append(ptu)\nposture = PTUPosture(); ptu.append(posture)\n"
        "robot.add_default_interface('mavlink')"
    )

    def yaw_and_pitch() -> tuple[float, float]:
        w, x, y, z = ground.last("GIMBAL_DEVICE_ATTITUDE_STATUS").q
        yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        return yaw, math.asin(max(-1.0, min(2.0 * (w * y - z * x), 1.0)))

    assert ground.command(1001, -2.0, -2.0, -3.0, -3.0) == ACCEPTED
    assert ground.last("GIMBAL_MANAGER_STATUS").primary_control_sysid == 255
    latitude, longitude = at(10.0, 10.0)
    assert ground.command(195, 0, 0, 0, 0, latitude * 1e-7, longitude * 1e-7, 488.2) == ACCEPTED
    ground.until(lambda: yaw_and_pitch()[0] == pytest.approx(math.radians(45.0), abs=0.05))
    assert ground.command(197) == ACCEPTED
    ground.until(lambda: yaw_and_pitch()[0] == pytest.approx(0.0, abs=0.05))
    # 10 degrees per second to the left
    assert ground.command(1000, NAN, NAN, 0.0, -10.0) == ACCEPTED
    begin, start = ground.sim.clock.time, yaw_and_pitch()[0]
    ground.step(120)
    turned = yaw_and_pitch()[0] - start
    assert turned / (ground.sim.clock.time - begin) == pytest.approx(math.radians(-10.0), rel=0.15)
    for wrong in (math.inf, -math.inf):
        assert ground.command(1000, wrong, 0.0) == UNSUPPORTED
        ground.command(1000, NAN, NAN, wrong, wrong)
    ground.step(30)
    assert all(map(math.isfinite, yaw_and_pitch()))


@pytest.mark.peer("pymavlink", does="logs, a shell, unknown parameters: each has an answer")
def test_what_is_not_there_has_an_answer(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    ground.send("log_request_list", 1, 1, 0, 0xFFFF)
    assert ground.last("LOG_ENTRY").num_logs == 0
    ground.send("log_request_data", 1, 1, 3, 0, 90)
    assert ground.last("LOG_DATA").count == 0
    ground.send("serial_control", 10, 2, 0, 0, 5, list(b"help\n".ljust(70, b"\0")))
    answer = ground.last("SERIAL_CONTROL")
    assert b"no shell" in bytes(answer.data[: answer.count])
    if hasattr(ground.mav, "param_error_encode"):  # newer versions of pymavlink
        ground.send("param_request_read", 1, 1, b"NOT_THERE", -1)
        assert (ground.last("PARAM_ERROR").error, ground.seen[1, "PARAM_ERROR"].param_id) == (1, "NOT_THERE")
        ground.send("param_set", 1, 1, b"MIS_TAKEOFF_ALT", 1e9, REAL32)
        assert ground.last("PARAM_ERROR").error == 2, "MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE"
    # the extended protocol has the same values
    ground.send("param_ext_request_read", 1, 1, b"MIS_TAKEOFF_ALT", -1)
    assert struct.unpack("<f", ground.last("PARAM_EXT_VALUE")._param_value_raw[:4].ljust(4, b"\0"))[0] == 2.5
    ground.send("param_ext_set", 1, 1, b"MIS_TAKEOFF_ALT", struct.pack("<f", 4.5), REAL32)
    assert ground.last("PARAM_EXT_ACK").param_result == 0
    ground.send("param_ext_set", 1, 1, b"MIS_TAKEOFF_ALT", struct.pack("<f", NAN), REAL32)
    assert ground.last("PARAM_EXT_ACK").param_result == 1, "PARAM_ACK_VALUE_UNSUPPORTED"
    ground.send("param_ext_set", 1, 1, b"NOT_THERE", b"x", 11)
    assert ground.last("PARAM_EXT_ACK").param_result == 1
    ground.send("param_request_read", 1, 1, b"MIS_TAKEOFF_ALT", -1)
    assert ground.last("PARAM_VALUE").param_value == 4.5
    ground.send("set_gps_global_origin", 1, 470_000_000, 80_000_000, 0)
    assert ground.last("GPS_GLOBAL_ORIGIN").latitude == pytest.approx(LATITUDE, abs=2000), "it is that of the scene"
    for name in ("ATTITUDE_QUATERNION", "ODOMETRY", "ALTITUDE"):
        number = getattr(__import__("pymavlink.dialects.v20.common", fromlist=["x"]), f"MAVLINK_MSG_ID_{name}")
        assert ground.command(511, float(number), 200_000.0) == ACCEPTED
        assert ground.last(name)


# -- a ground station over a bad connection, as QGroundControl asks again: packets are lost or come twice, both way

REQUEST, VERSION, START, MAVLINK_LOSSES_SET_MODE = 512, 148, 300, 176
#: simulated seconds after which it asks again, and how often
AGAIN, TIMES = 1.5, 8
_LOST, _TWICE = 0.05, 0.05


class BadLine:
    """Loses and repeats packets of a ground station."""

    def __init__(self, ground: Any, seed: int) -> None:
        self.ground, self._chance = ground, random.Random(seed)
        self._send = ground.send_bytes
        ground.send_bytes = self.send
        self._socket = ground._socket
        ground._socket = self
        self._again: list[Any] = []
        self.lost = 0

    def _copies(self) -> int:
        share = self._chance.random()
        self.lost += share < _LOST
        return 0 if share < _LOST else 2 if share < _LOST + _TWICE else 1

    def send(self, data: bytes) -> None:
        for _ in range(self._copies()):
            self._send(data)

    def recvfrom(self, size: int) -> Any:
        while True:
            if self._again:
                return self._again.pop()
            packet = self._socket.recvfrom(size)
            self._again = [packet] * self._copies()

    def sendto(self, data: bytes, peer: Any) -> None:
        self._socket.sendto(data, peer)

    def close(self) -> None:
        self._socket.close()

    def ask(self, answer: str, name: str, *values: Any, when: Callable[[Any], bool] = bool) -> Any:
        """Send a message until a wanted answer comes."""
        ground = self.ground
        for _ in range(TIMES):
            first = len(ground.heard)
            ground.send(name, *values)
            end = ground.sim.clock.time + AGAIN
            while ground.sim.clock.time < end:
                ground.step()
                for one in ground.heard[first:]:
                    if one.get_type() == answer and when(one):
                        return one
        raise AssertionError(f"{name}: no {answer}")

    def command(self, number: int, *params: float) -> int:
        values = [*params, *[0.0] * (7 - len(params))]
        return int(
            self.ask(
                "COMMAND_ACK", "command_long", 1, 1, number, 0, *values, when=lambda one: one.command == number
            ).result
        )

    def upload(self, plan: list[tuple[Any, ...]]) -> int:
        """Answers requests; asks again with the last message that it has sent."""
        ground = self.ground
        message: tuple[Any, ...] = ("mission_count", 1, 1, len(plan), 0)
        for _ in range(20 * TIMES):
            first = len(ground.heard)
            ground.send(*message)
            end = ground.sim.clock.time + AGAIN
            request = None
            while ground.sim.clock.time < end and request is None:
                ground.step()
                for one in ground.heard[first:]:
                    if one.get_type() == "MISSION_ACK":
                        return int(one.type)
                    if one.get_type() == "MISSION_REQUEST_INT":
                        request = one
            if request is not None:
                frame, command, *rest = plan[request.seq]
                message = ("mission_item_int", 1, 1, request.seq, frame, command, int(request.seq == 0), 1, *rest, 0)
        raise AssertionError("the upload does not end")


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.peer("pymavlink", does="a ground station that loses 5 % of the packets both ways, and gets 5 % twice")
def test_a_ground_station_comes_through(station: Callable[..., Any], seed: int) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    ground.until(lambda: (1, "HOME_POSITION") in ground.seen)
    home = ground.seen[1, "HOME_POSITION"]
    line = BadLine(ground, seed)
    assert line.command(REQUEST, float(VERSION)) == ACCEPTED
    # all parameters, and again those that were lost
    count = line.ask("PARAM_VALUE", "param_request_list", 1, 1).param_count
    ground.step(60)
    there = {one.param_index for one in ground.heard if one.get_type() == "PARAM_VALUE"}
    for index in set(range(count)) - there:
        line.ask("PARAM_VALUE", "param_request_read", 1, 1, b"", index, when=lambda one, k=index: one.param_index == k)
    line.ask("PARAM_VALUE", "param_set", 1, 1, b"MIS_TAKEOFF_ALT", 4.0, 9,
             when=lambda one: one.param_id == "MIS_TAKEOFF_ALT" and one.param_value == 4.0)  # fmt: skip
    for kind in (0, 1, 2):
        assert line.ask("MISSION_COUNT", "mission_request_list", 1, 1, kind,
                        when=lambda one, k=kind: one.mission_type == k).count == 0  # fmt: skip
    # a mission of 12 items up, and down again
    # a degree of latitude is 111.17 km at Zuerich (WGS84)
    north = round(8.0 / 111_170.0 * 1e7)
    places = [(6, 16, 0.0, 0.0, 0.0, NAN, home.latitude + north * (k % 2), home.longitude, 5.0) for k in range(10)]
    plan = [(6, 22, 0.0, 0.0, 0.0, NAN, home.latitude, home.longitude, 5.0), *places, (2, 20, 0, 0, 0, 0, 0, 0, 0.0)]
    assert line.upload(plan) == ACCEPTED
    assert line.ask("MISSION_COUNT", "mission_request_list", 1, 1, 0).count == len(plan)
    for seq, (frame, command, *_, x, y, z) in enumerate(plan):
        item = line.ask("MISSION_ITEM_INT", "mission_request_int", 1, 1, seq, 0, when=lambda one, k=seq: one.seq == k)
        assert (item.frame, item.command, item.x, item.y, item.z) == (frame, command, x, y, z)
    assert line.command(ARM, 1.0) == ACCEPTED
    assert line.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.until(lambda: place(ground)[2] < -3.5)
    assert line.command(START) == ACCEPTED
    ground.until(lambda: not ground.is_armed())
    assert max(place(ground)[:2], key=abs) == pytest.approx(0.0, abs=1.0), "it has returned and landed"
    reached = {one.seq for one in ground.heard if one.get_type() == "MISSION_ITEM_REACHED"}
    assert len(reached) >= len(plan) - 3, "but for those messages that were lost"
    assert line.lost > 20


def test_the_last_item_is_answered_again(station: Callable[..., Any]) -> None:
    """Who has not got the last MISSION_ACK repeats the last item."""
    ground = station(drone("RotorcraftWaypoint"))
    item = (6, 16, 0.0, 0.0, 0.0, NAN, 473977420, 85455940, 5.0)
    assert ground.upload([item, item]) == ACCEPTED
    ground.send("mission_item_int", 1, 1, 1, 6, 16, 0, 1, *item[2:], 0)
    assert ground.last("MISSION_ACK").type == ACCEPTED
    # an item that nobody has asked for has no answer
    ground.seen.clear()
    ground.send("mission_item_int", 1, 1, 5, 6, 16, 0, 1, *item[2:], 0)
    ground.step(120)
    assert (1, "MISSION_ACK") not in ground.seen
