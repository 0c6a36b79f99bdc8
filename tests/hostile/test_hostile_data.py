"""Data that stand for more than anybody can write down: the field is refused, with its size and the limit."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import morse
from morse.builder import Environment, FakeRobot
from morse.core.actuator import Actuator
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.core.streams.extent import MOST_ITEMS, MOST_NUMBERS, TooLarge, excess, listed
from morse.helpers.components import add_data
from morse.robots.fakerobot import FakeRobot as FakeRobotClass
from morse.viewer.feeds.components import ValuesFeed
from morse.viewer.protocol import encode_json
from morse.wire.encoding import to_json, written


def _doubled(times: int) -> list[Any]:
    value: list[Any] = [0.0]
    for _ in range(times):
        value = [value, value]
    return value


def _deep(times: int) -> list[Any]:
    value: list[Any] = []
    for _ in range(times):
        value = [value]
    return value


def _loop() -> list[Any]:
    value: list[Any] = []
    value.append({"again": value})
    return value


def _objects() -> Any:
    array = np.empty(1, dtype=object)
    array[0] = _doubled(40)
    return array


#: each value, and what the message says about it
VALUES: dict[str, tuple[Any, str]] = {
    "range": (lambda: range(10**12), "a range of 1,000,000,000,000 items; at most 500,000"),
    "ranges": (lambda: [range(10**20)], "a range of 100,000,000,000,000,000,000 items"),
    "broadcast": (lambda: np.broadcast_to(0.0, (10**9,)), "an array of 8,000,000,000 bytes"),
    "text": (lambda: "x" * 50_000_000, "a text of 50,000,000 characters; at most 16,777,216"),
    "texts": (lambda: {"a": ["x" * 50_000_000]}, "a text of 50,000,000 characters"),
    "bytes": (lambda: memoryview(np.broadcast_to(np.uint8(0), (2**29,))), "536,870,912 bytes"),
    "keys": (lambda: dict.fromkeys(range(1_000_000)), "a dict of 1,000,000 items; at most 500,000"),
    "table": (lambda: [[0.0] * 2000] * 2000, "items; at most 500,000"),
    "doubled": (lambda: _doubled(40), "nested lists of too many items"),
    "hidden": (lambda: [0.0, {"a": (_doubled(40),)}, 0.0], "nested lists of too many items"),
    "deep": (lambda: _deep(100_000), "nested too deeply"),
    "loop": (_loop, "contains itself"),
    "objects": (_objects, "too many items"),
    "iterator": (lambda: iter(range(10**12)), "a range_iterator, which can be read only once"),
    "generator": (lambda: (0.0 for _ in range(10**12)), "a generator, which can be read only once"),
}


class Boaster(Sensor):
    """Publishes them, beside a number."""

    add_data("count", 0, "int", "Number of measurements")
    add_data("held", 0.0, "float", "A value")
    value: Any = staticmethod(float)

    def default_action(self) -> None:
        self.local_data["count"] += 1
        if self.clock.tick >= 1:
            self.local_data["held"] = type(self).value()

    @service
    def tell(self) -> Any:
        return type(self).value()


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # the text stream of the scene is a file in the current directory
    monkeypatch.chdir(tmp_path)


def _scene() -> None:
    robot = FakeRobot("robot")
    sensor = Boaster("boaster")
    robot.append(sensor)
    sensor.add_stream("text")
    Environment("empty", fastmode=True)


@pytest.mark.parametrize("name", VALUES)
def test_the_field_is_refused_and_the_others_are_published(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    value, text = VALUES[name]
    monkeypatch.setattr(Boaster, "value", staticmethod(value))
    published: list[dict[str, Any]] = []
    with morse.load(_scene) as simulation:
        simulation.robot.boaster.subscribe(published.append)
        with simulation.record(tmp_path / "run.mcap"):
            simulation.step(4)
        simulation.restore(simulation.save())
        assert to_json(simulation.call("robot.boaster", "get_local_data").result())
        with pytest.raises(Exception, match=r"at most|only once"):
            simulation.call("robot.boaster", "tell").result()
    assert [data["count"] for data in published] == [1, 2, 3, 4]
    assert all("held" not in data for data in published[1:])
    (line,) = [one for one in caplog.messages if "'held'" in one and text in one]
    assert line.startswith("robot.boaster (Boaster)")
    assert len(line) < 300


class Pusher(Actuator):
    """Keeps them in its commands."""

    add_data("speed", 0.0, "float", "A command")

    def default_action(self) -> None:
        self.local_data["held"] = Boaster.value()


class Carrier(FakeRobotClass):
    """Keeps them in its own data."""

    def default_action(self) -> None:
        super().default_action()
        self.local_data["held"] = Boaster.value()


@pytest.mark.parametrize("owner", ["carrier", "carrier.pusher"])
@pytest.mark.parametrize("name", VALUES)
def test_the_data_of_actuators_and_robots_have_limits_too(
    name: str, owner: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def scene() -> None:
        robot = Carrier("carrier")
        robot.append(Pusher("pusher"))
        Environment("empty", fastmode=True)

    value, text = VALUES[name]
    monkeypatch.setattr(Boaster, "value", staticmethod(value))
    sent: list[Any] = []
    server: Any = SimpleNamespace(wishes=SimpleNamespace(values={owner}), send=sent.append)
    with morse.load(scene) as simulation:
        simulation.step(3)
        assert "held" not in simulation.context.component(owner).local_data
        ValuesFeed(simulation.context, server).update()
        assert encode_json(sent[0])
        simulation.restore(simulation.save())
        assert not simulation.context.failed
    line, *later = [one for one in caplog.messages if one.startswith(f"{owner} (") and "'held'" in one]
    # a busy machine takes so long that it is said again
    assert all(re.search(r"\(\d+ more of this kind\)$", one) for one in later)
    assert text in line


def test_a_million_fields_take_few_lines(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    def act(self: Any) -> None:
        self.local_data.update((f"field {number}", number) for number in range(200_000))

    monkeypatch.setattr(Boaster, "default_action", act)
    with morse.load(_scene) as simulation:
        simulation.step(2)
        assert len(simulation.context.components["robot.boaster"].local_data) <= 10_000
    assert len(caplog.messages) < 50
    assert "200,003 data fields; at most 10,000" in caplog.text


def test_a_broadcast_attribute_is_not_saved(caplog: pytest.LogCaptureFixture) -> None:
    with morse.load(_scene) as simulation:
        component = simulation.context.components["robot.boaster"]
        component.table = np.broadcast_to(0.0, (10**9,))
        simulation.save()
    assert "robot.boaster.table (an array of 8,000,000,000 bytes" in caplog.text


@pytest.mark.parametrize("write", [to_json, written])
def test_numbers_are_not_written_one_by_one_without_limit(write: Any) -> None:
    with pytest.raises((TooLarge, TypeError), match="cannot be written"):
        write({"a": np.broadcast_to(0.0, (MOST_NUMBERS + 1,))})
    assert listed(np.zeros(3)) == [0.0, 0.0, 0.0]


NUMBERS = st.integers() | st.floats() | st.text() | st.none() | st.booleans()
DATA = st.recursive(NUMBERS, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner))


@given(value=DATA)
def test_ordinary_data_are_accepted(value: Any) -> None:
    assert excess(value) == ""


@given(a=st.integers(1, 3000), b=st.integers(1, 3000))
def test_the_items_of_tables_are_counted(a: int, b: int) -> None:
    assert bool(excess([[0.0] * b] * a)) == (a * b + a > MOST_ITEMS)
