"""No message that an autopilot reads harms it, whatever its fields are."""

import math
from collections.abc import Callable
from typing import Any

import pytest

pytest.importorskip("pymavlink")

import contextlib
import copy
import logging
from collections.abc import Iterator

from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common
from test_mavlink_flight import station
from test_mavlink_states import VEHICLES, _altered, under_way

from morse.core.state import StateError
from morse.plugins.mavlink.autopilot.pilot import MESSAGES
from tests.kit.effort import examples

__all__ = ["station"]

pytestmark = pytest.mark.long

BODY = (
    "robot = Quadrotor(); robot.translate(z=0.2)\ngoal = RotorcraftWaypoint(); robot.append(goal)\n"
    "eye = VideoCamera(); eye.properties(cam_width=8, cam_height=8); robot.append(eye)\n"
    "head = PTU(); robot.append(head)\nrobot.add_default_interface('mavlink')"
)
NAMES = [*MESSAGES, "HEARTBEAT", "GIMBAL_MANAGER_SET_PITCHYAW", "SET_ATTITUDE_TARGET", "NAMED_VALUE_FLOAT",
         "SET_POSITION_TARGET_LOCAL_NED", "SET_POSITION_TARGET_GLOBAL_INT", "HIL_ACTUATOR_CONTROLS"]  # fmt: skip
#: commands that something obeys, beside all others
COMMANDS = [17, 20, 21, 22, 176, 178, 179, 185, 192, 193, 195, 197, 203, 206, 224, 300, 400, 410, 510, 511, 512, 520,
            521, 526, 527, 530, 1000, 1001, 2000, 2001, 5001, 5003, 16, 93, 115, 177]  # fmt: skip
FLOATS = st.one_of(
    st.sampled_from([math.nan, math.inf, -math.inf, 0.0, 1.0, -1.0, 2.0, 3.4e38, -3.4e38, 1e-40, 21196.0]),
    st.floats(width=32),
)
_BITS = {"uint8_t": (0, 8), "int8_t": (1, 8), "uint16_t": (0, 16), "int16_t": (1, 16), "uint32_t": (0, 32),
         "int32_t": (1, 32), "uint64_t": (0, 64), "int64_t": (1, 64)}  # fmt: skip


def number(kind: str) -> st.SearchStrategy[Any]:
    if kind in ("float", "double"):
        return FLOATS
    signed, bits = _BITS[kind]
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    few = [value for value in (0, 1, 2, 3, 5, low, high, 255, 65_535) if low <= value <= high]
    return st.one_of(st.sampled_from(few), st.integers(low, high))


@st.composite
def messages(draw: st.DrawFn) -> tuple[str, list[Any]]:
    """The name of an encoder, and its fields."""
    name = draw(st.sampled_from(NAMES))
    cls = getattr(common, f"MAVLink_{name.lower()}_message")
    values: list[Any] = []
    kinds = dict(zip(cls.ordered_fieldnames, zip(cls.lengths, cls.array_lengths, strict=True), strict=True))
    for field, kind in zip(cls.fieldnames, cls.fieldtypes, strict=True):
        length = max(kinds[field])
        if kind == "char":
            values.append(draw(st.one_of(st.sampled_from([b"GF_ACTION", b"MIS_TAKEOFF_ALT"]), st.binary(max_size=16))))
        elif field in ("target_system", "target"):
            values.append(draw(st.sampled_from([0, 1])))
        elif field == "target_component":
            values.append(draw(st.sampled_from([0, 1, 1, 100, 154, 255])))
        elif field == "command":
            values.append(draw(st.one_of(st.sampled_from(COMMANDS), number(kind))))
        elif length > 1:
            values.append(draw(st.lists(number(kind), min_size=length, max_size=length)))
        else:
            values.append(draw(number(kind)))
    return name.lower(), values


def test_no_sequence_of_messages_harms(station: Callable[..., Any]) -> None:
    ground = station(BODY, fastmode=False)
    ground.until(lambda: any(m.get_srcComponent() == 100 for m in ground.heard))
    robot = next(iter(ground.sim.context.robots.values()))

    @settings(max_examples=examples(200), deadline=None)
    @given(st.lists(st.tuples(messages(), st.integers(0, 3)), min_size=5, max_size=25))
    def attack(parts: list[tuple[tuple[str, list[Any]], int]]) -> None:
        for (name, values), ticks in parts:
            ground.send(name, *values)
            ground.step(ticks)
        ground.step(2)
        ground.heard.clear()
        ground.times.clear()
        assert "mavlink" in str(list(ground.sim.context.stream_managers)), "it is still there"
        assert all(map(math.isfinite, robot.bge_object.world_pose()[0]))

    attack()
    ground.seen.pop((1, "HEARTBEAT"), None)
    assert ground.command(511, 0.0, 1e6) == 0
    ground.until(lambda: any(m.get_type() == "HEARTBEAT" and m.get_srcComponent() == 1 for m in ground.heard))
    assert ground.sim.save().middlewares, "what it has learned can be saved"


# -- a state that a stranger has written is refused, or the autopilot goes on with it --------------

VALUES = st.sampled_from(
    [math.nan, math.inf, 1e308, -1e308, 1e-310, -1, 0, 1, 255, 256, 65_536, 2**31, 2**63, -(2**63), True, None, "x",
     "x" * 10_000, [], [1.0], [math.nan] * 3, [1e300, 1e300, 1e300], {}, {"v": math.nan}, {"velocity": [1.0]}]
)  # fmt: skip


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path of each value within a state."""
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, inner in pairs:
        yield (*path, name)
        yield from places(inner, (*path, name))


@pytest.mark.parametrize("kind", VEHICLES)
def test_any_value_in_a_state_is_refused_or_harmless(
    station: Callable[..., Any], kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    ground = station(VEHICLES[kind])
    under_way(ground, kind)
    good = ground.sim.save()
    content: list[Any] = []
    _altered(good, lambda pilot: content.append(copy.deepcopy(pilot)))
    paths = list(places(content[0]))

    @settings(max_examples=examples(400), deadline=None)
    @given(st.lists(st.tuples(st.sampled_from(paths), VALUES), min_size=1, max_size=3))
    def change(changes: list[tuple[tuple[Any, ...], Any]]) -> None:
        caplog.clear()

        def change_some(pilot: Any) -> None:
            for (*way, last), value in changes:
                inner = pilot
                try:
                    for name in way:
                        inner = inner[name]
                    inner[last] = copy.deepcopy(value)  # a later change may be inside it
                except (TypeError, IndexError, KeyError):
                    pass  # another change has removed it

        with contextlib.suppress(StateError):
            ground.sim.restore(_altered(good, change_some))
        ground.step(10)
        ground.sim.restore(good)
        ground.step(2)
        assert [one.getMessage() for one in caplog.records if one.levelno >= logging.ERROR] == []

    change()
