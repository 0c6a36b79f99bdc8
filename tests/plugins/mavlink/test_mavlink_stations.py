"""What ground stations ask at their start, and what a vehicle does when they fall silent."""

import math
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("pymavlink")

from test_mavlink_flight import ACCEPTED, ARM, NAN, TAKEOFF, UNSUPPORTED, drone, place, station

__all__ = ["station"]

pytestmark = pytest.mark.long

REQUEST, GET_HOME, GET_CAPABILITIES, GET_PROTOCOL = 512, 410, 520, 519
AVAILABLE_MODES, COMPONENT_METADATA, COMPONENT_INFORMATION, PROTOCOL_VERSION = 435, 397, 395, 300
FENCE, RALLY = 1, 2
HOLD, LAND, RETURN = 4 << 16 | 3 << 24, 4 << 16 | 6 << 24, 4 << 16 | 5 << 24


def beat(ground: Any) -> None:
    ground.send("heartbeat", 6, 8, 192, 0, 4)


@pytest.mark.peer("pymavlink", does="asks what QGroundControl asks at its start, in its order")
def test_the_questions_of_qgroundcontrol_at_its_start(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    beat(ground)
    heartbeat = ground.last("HEARTBEAT")
    assert (heartbeat.type, heartbeat.autopilot) == (2, 12)
    # the version decides what follows; it asks for it by two commands, and for the protocol
    assert ground.command(REQUEST, 148.0) == ACCEPTED
    version = (
        ground.last("AUTOPILOT_VERSION")
        if (1, "AUTOPILOT_VERSION") not in ground.seen
        else ground.seen[1, "AUTOPILOT_VERSION"]
    )
    assert version.capabilities & 4
    assert version.capabilities & 1 << 14, "fences"
    assert not version.capabilities & 1 << 15, "no rally points: it does not ask for them"
    assert ground.command(GET_CAPABILITIES, 1.0) == ACCEPTED
    # what it can do without: each has an answer, or it waits and asks again
    assert ground.command(GET_PROTOCOL, 1.0) == UNSUPPORTED
    for number in (PROTOCOL_VERSION, AVAILABLE_MODES, COMPONENT_METADATA, COMPONENT_INFORMATION):
        assert ground.command(REQUEST, number) == UNSUPPORTED
    # the list of parameters, then one by one those that were lost, by their number
    ground.send("param_request_list", 1, 1)
    count = ground.last("PARAM_VALUE").param_count
    ground.until(
        lambda: {one.param_index for one in ground.heard if one.get_type() == "PARAM_VALUE"} == set(range(count))
    )
    for index in range(count):
        ground.send("param_request_read", 1, 1, b"", index)
        assert ground.last("PARAM_VALUE").param_index == index
    # plans: an empty mission is a count of 0, which it acknowledges
    ground.send("mission_request_list", 1, 1, 0)
    assert ground.last("MISSION_COUNT").count == 0
    ground.send("mission_ack", 1, 1, 0, 0)
    for kind in (FENCE, RALLY):
        ground.send("mission_request_list", 1, 1, kind)
        answer = ground.last("MISSION_COUNT")
        assert (answer.count, answer.mission_type) == (0, kind)
    assert ground.command(GET_HOME) == ACCEPTED
    assert ground.last("HOME_POSITION").approach_x != 0.0, "NaN: there is no approach"
    ground.send("request_data_stream", 1, 1, 0, 4, 1)
    ground.step(60)
    assert ground.last("HEARTBEAT").system_status in (3, 4)


@pytest.mark.parametrize(("action", "mode"), [(0, HOLD), (1, HOLD), (2, RETURN), (3, LAND)])
def test_a_vehicle_whose_station_falls_silent(station: Callable[..., Any], action: int, mode: int) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    ground.send("param_set", 1, 1, b"NAV_DLL_ACT", float(action), 9)
    ground.send("param_set", 1, 1, b"COM_DL_LOSS_T", 5.0, 9)
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    while ground.sim.clock.time < 12.0:
        beat(ground)
        ground.step(60)
    assert ground.last("HEARTBEAT").custom_mode == HOLD
    beat(ground)
    silent = ground.sim.clock.time
    if not action:
        ground.step(12 * 60)
        assert ground.last("HEARTBEAT").custom_mode == HOLD
        assert (1, "STATUSTEXT") not in ground.seen
        return
    said = ground.last("STATUSTEXT")
    assert 5.0 - 0.1 < ground.sim.clock.time - silent < 5.0 + 0.2
    assert "lost" in said.text
    # above home, a return lands at once
    assert ground.last("HEARTBEAT").custom_mode in (mode, LAND if action == 2 else mode)
    beat(ground)
    assert "regained" in ground.last("STATUSTEXT").text
    if action == 3:
        ground.until(lambda: not ground.is_armed())
        assert math.hypot(*place(ground)[:2]) < 0.5


def test_a_vehicle_that_never_had_a_station_does_not_miss_it(station: Callable[..., Any]) -> None:
    ground = station(drone("RotorcraftWaypoint"))
    ground.send("param_set", 1, 1, b"NAV_DLL_ACT", 3.0, 9)
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.step(15 * 60)
    assert ground.last("HEARTBEAT").custom_mode == HOLD


@pytest.mark.parametrize(("current", "north"), [(2, 10.0), (3, 0.0)])
def test_an_item_beside_a_mission_is_a_place_to_go_to(station: Callable[..., Any], current: int, north: float) -> None:
    """As `simple_goto` of DroneKit sends it, and the change of altitude of older ground stations."""
    ground = station(drone("RotorcraftWaypoint"))
    home = ground.last("HOME_POSITION")
    # a degree of latitude is 111.17 km at Zuerich (WGS84)
    latitude, longitude = home.latitude * 1e-7 + 10.0 / 111_170.0, home.longitude * 1e-7
    item = (1, 0, 0, 3, 16, current, 0, 0.0, 0.0, 0.0, 0.0, latitude, longitude, 6.0)
    ground.send("mission_item", *item)
    assert ground.last("MISSION_ACK").type != ACCEPTED, "it is not armed"
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.until(lambda: ground.last("EXTENDED_SYS_STATE").landed_state == 2)
    ground.send("mission_item", *item)
    assert ground.last("MISSION_ACK").type == ACCEPTED
    ground.until(lambda: math.dist(place(ground), (north, 0.0, -6.0)) < 1.0)
    assert ground.last("HEARTBEAT").custom_mode == HOLD
