"""A state that is saved in flight contains the autopilot: the flight goes on with the same bits."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

pytest.importorskip("pymavlink")

from test_mavlink_failsafe import INSIDE, LAND, SQUARE, polygon
from test_mavlink_flight import ACCEPTED, ARM, NAN, SET_MODE, TAKEOFF, drone, place, station, target

from morse.core.state import StateError

__all__ = ["station"]

pytestmark = pytest.mark.long

START = "robot.translate(z=0.2)"
VEHICLES = {
    "waypoint": drone("RotorcraftWaypoint", START),
    "velocity": drone("RotorcraftVelocity", START),
    "attitude": drone("RotorcraftAttitude", START),
    "rover": "robot = ATRV()\nmotion = MotionVW(); robot.append(motion)\nrobot.add_default_interface('mavlink')",
}


def track(ground: Any, ticks: int) -> list[tuple[float, ...]]:
    robot = next(iter(ground.sim.context.robots.values()))
    places = []
    for _ in range(ticks):
        ground.step()
        places.append(tuple(robot.bge_object.world_pose()[0]))
    return places


def under_way(ground: Any, kind: str) -> None:
    """On a mission that waits, jumps and turns, at its second item."""
    items: list[tuple[Any, ...]] = [
        (1, 16, 0.0, 0.0, 0.0, NAN, 30_000, 0, -3.0),
        (1, 16, 1.0, 0.0, 0.0, NAN, 30_000, 30_000, -3.0),
        (2, 177, 0.0, 2.0, 0.0, 0.0, 0, 0, 0.0),
        (2, 20, 0.0, 0.0, 0.0, 0.0, 0, 0, 0.0),
    ]
    assert ground.upload(items) == ACCEPTED
    assert ground.upload(polygon(INSIDE, [(100.0 * a, 100.0 * b) for a, b in SQUARE]), type_=1) == ACCEPTED
    assert ground.command(300) == ACCEPTED
    ground.until(lambda: ground.last("MISSION_CURRENT").seq == 1)
    ground.step(45)


@pytest.mark.parametrize("kind", VEHICLES)
def test_a_mission_goes_on_with_the_same_bits(station: Callable[..., Any], kind: str, tmp_path: Path) -> None:
    ground = station(VEHICLES[kind])
    under_way(ground, kind)
    state = ground.sim.save()
    state.write(tmp_path / "flight.state")
    first = track(ground, 900)
    after = ground.sim.save()
    ground.sim.restore(state)
    assert track(ground, 900) == first
    assert ground.sim.save().hash() == after.hash()
    # also after something else, from a file
    assert ground.command(SET_MODE, 1.0, 4.0, 3.0) == ACCEPTED
    ground.send("mission_clear_all", 1, 1, 255)
    ground.step(10)
    ground.sim.restore(tmp_path / "flight.state")
    assert track(ground, 900) == first
    ground.send("mission_request_list", 1, 1, 1)
    assert ground.last("MISSION_COUNT").count == 4, "the fence, too"


def test_landing_and_setpoints_go_on(station: Callable[..., Any]) -> None:
    ground = station(VEHICLES["waypoint"])
    assert ground.command(ARM, 1.0) == ACCEPTED
    assert ground.command(TAKEOFF, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
    ground.until(lambda: place(ground)[2] < -2.0)
    target(ground, 4.0, 1.0, -3.0)
    ground.step(30)
    state = ground.sim.save()
    first = track(ground, 300)
    ground.sim.restore(state)
    assert track(ground, 300) == first
    assert ground.command(21) == ACCEPTED
    ground.step(20)
    state = ground.sim.save()
    first = track(ground, 900)
    assert not ground.is_armed()
    ground.sim.restore(state)
    assert ground.last("HEARTBEAT").custom_mode == LAND
    assert ground.is_armed()
    ground.sim.restore(state)
    assert track(ground, 900) == first


def _altered(state: Any, change: Callable[[Any], object]) -> Any:
    """The state of a file in which the state of the autopilot was changed."""
    head, _, content = state.to_bytes().partition(b"\n")
    parts = msgspec.msgpack.decode(content)
    (name,) = (name for name in parts if name.startswith("middleware "))
    if (other := change(parts[name][0][2])) is not None:
        parts[name] = other
    return type(state).from_bytes(head + b"\n" + msgspec.msgpack.encode(parts))


@pytest.mark.parametrize(
    "change",
    [
        lambda pilot: pilot["flight"].update(mode=99),
        lambda pilot: pilot["flight"].update(home=[1.0]),
        lambda pilot: pilot["flight"].update(home=[float("nan")] * 3),
        lambda pilot: pilot["mission"].update(current=7),
        lambda pilot: pilot["mission"].update(current=-1),
        lambda pilot: pilot["mission"].update(items=[["x"]]),
        lambda pilot: pilot.pop("gimbal") and None,
        lambda pilot: pilot["flight"].update(vehicle=1),
        lambda pilot: [],
        lambda pilot: {"a": 1},
        lambda pilot: [["robot", "device", None]],
        lambda pilot: "no state",
    ],
)
def test_a_damaged_state_is_refused_or_harmless(station: Callable[..., Any], change: Callable[[Any], object]) -> None:
    ground = station(VEHICLES["rover"])
    ground.step(5)
    good = ground.sim.save()
    bad = _altered(good, change)
    if bad.middlewares != {next(iter(good.middlewares)): []}:
        with pytest.raises(StateError, match="mavlink"):
            ground.sim.restore(bad)
    else:
        ground.sim.restore(bad)
    ground.step(60)
    assert ground.last("HEARTBEAT").type == 10
