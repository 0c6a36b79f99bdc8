"""Objects of a component that raise whatever is asked of them: the run goes on, and its state can be saved."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hostile_objects as objects
import pytest

import morse
from morse.builder import Environment, FakeRobot
from morse.core.sensor import Sensor
from morse.core.state import StateError
from morse.helpers.components import add_data

OBJECTS = ["Mute", "Disguised", "Unsaved", "Unordered", "Anonymous"]
PLACES = ["attribute", "field", "data", "item"]


class Holder(Sensor):
    """Holds an object of the user, beside others that are saved."""

    add_data("count", 0, "int", "Number of measurements")
    name_of_object = "Mute"
    place = ""

    def default_action(self) -> None:
        self.local_data["count"] += 1
        self.shared = self.again = [1.0]
        value = vars(objects)[self.name_of_object]()
        if self.clock.tick < 2:
            return
        if self.place == "attribute":
            self.held = value
        elif self.place == "field":
            self.local_data["held"] = value
        elif self.place == "data":
            self.local_data = value
        elif self.place == "item":
            self.items = [self.shared, value, {"nested": [value]}]
        self.later = self.shared


class Neighbour(Holder):
    """It goes on."""

    place = "none"


def _scene() -> None:
    robot = FakeRobot("robot")
    robot.append(Holder("holder"))
    robot.append(Neighbour("neighbour"))
    Environment("empty", fastmode=True)


@pytest.fixture
def simulation(tmp_path: Path) -> Iterator[Any]:
    with morse.load(_scene) as sim, sim.record(tmp_path / "run.mcap"):
        yield sim


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", OBJECTS)
def test_a_run_with_such_an_object_goes_on_and_is_saved(
    simulation: Any, name: str, place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Holder, "name_of_object", name)
    monkeypatch.setattr(Holder, "place", place)
    simulation.step(4)
    state = simulation.save()
    count = simulation.robot.neighbour.data["count"]
    simulation.step(3)
    assert simulation.robot.neighbour.data["count"] == count + 3
    simulation.restore(state)
    holder = simulation.context.components["robot.holder"]
    assert simulation.ticks == state.tick
    assert holder.shared is holder.again, "objects that are shared remain shared"
    assert simulation.save() == state


def test_what_cannot_be_saved_is_named_once(
    simulation: Any, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(Holder, "name_of_object", "Mute")
    monkeypatch.setattr(Holder, "place", "attribute")
    simulation.step(3)
    with caplog.at_level(logging.WARNING):
        simulation.save()
        simulation.save()
    (text,) = [r.getMessage() for r in caplog.records if "cannot be saved" in r.getMessage()]
    assert "robot.holder.held" in text
    assert "Mute" in text


@pytest.mark.parametrize("error", [ValueError, GeneratorExit, BaseException])
def test_a_component_that_cannot_tell_its_state_is_named_when_it_is_saved(
    simulation: Any, error: type[BaseException], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any) -> Any:
        raise error("not now")

    simulation.step(2)
    state = simulation.save()
    monkeypatch.setattr(Neighbour, "get_state", fail)
    with pytest.raises(StateError, match=r"robot\.neighbour cannot be saved: .*not now"):
        simulation.save()
    monkeypatch.undo()
    monkeypatch.setattr(Neighbour, "set_state", fail)
    with pytest.raises(StateError, match=r"robot\.neighbour"):
        simulation.restore(state)
    monkeypatch.undo()
    simulation.step(1)
    simulation.restore(state)
    assert simulation.robot.neighbour.data["count"] == 2


@pytest.mark.parametrize("special", ["__len__", "__bool__"])
def test_a_component_that_counts_as_false_is_a_component(
    simulation: Any, special: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Neighbour, special, lambda _self: 0 if special == "__len__" else False, raising=False)
    simulation.step(2)
    state = simulation.save()
    assert "robot.neighbour" in state.parts
    simulation.step(3)
    simulation.restore(state)
    assert simulation.robot.neighbour.data["count"] == 2
