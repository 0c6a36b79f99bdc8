"""A ground station over a bad connection, as QGroundControl asks again: packets are lost or come twice, both ways."""

import random
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("pymavlink")

from test_mavlink_flight import ACCEPTED, ARM, NAN, TAKEOFF, drone, place, station

__all__ = ["station"]

pytestmark = pytest.mark.long

REQUEST, VERSION, START, SET_MODE = 512, 148, 300, 176
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
