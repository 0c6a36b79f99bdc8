"""A component that puts something else in the place of what the simulation needs fails in that line, alone."""

from pathlib import Path
from typing import Any

import pytest

import morse
from morse.builder import Environment, FakeRobot
from morse.core.sensor import Sensor
from morse.helpers.components import add_data

OWN = ["bge_object", "robot_parent", "context", "clock"]
LISTS = ["input_functions", "output_functions", "input_modifiers", "output_modifiers"]
OF_CLOCK = ["tick", "time", "frequency", "period"]
OF_CONTEXT = [
    *("clock", "world", "services", "guard", "journal", "complaints", "robots", "components", "stream_managers"),
    *("service_objects", "overlays", "failed", "time_shares", "arrivals", "scene"),
]
PLACES = [
    *((f"self.{name}", value) for name in OWN for value in (None, 5)),
    *((f"self.{name}", value) for name in LISTS for value in (None, "abc", ())),
    *((f"self.robot_parent.{name}", None) for name in (*OWN[:1], *LISTS)),
    *((f"self.clock.{name}", value) for name in OF_CLOCK for value in (None, 0)),
    *((f"self.context.{name}", None) for name in OF_CONTEXT),
]


class Meddler(Sensor):
    """Assigns a value in its third tick."""

    add_data("count", 0, "int", "Number of measurements")
    place, value = "", None

    def default_action(self) -> None:
        self.local_data["count"] += 1
        if self.clock.tick == 2 and self.place:
            owner, _, name = self.place.rpartition(".")
            setattr(eval(owner, {"self": self}), name, self.value)


class Bystander(Meddler):
    """It goes on."""

    default_action = Sensor.default_action

    def measure(self) -> None:
        self.local_data["count"] += 1


class Closed(Meddler):
    """No attribute can be read or set from its third tick on."""

    def default_action(self) -> None:
        if self.clock.tick == 2:
            self.__class__ = Shut


class Shut(Closed):
    def __getattribute__(self, name: str) -> Any:
        raise ValueError(name)

    def __setattr__(self, name: str, value: Any) -> None:
        raise ValueError(name)


def _scene(cls: type[Any] = Meddler) -> Any:
    def describe() -> None:
        robot = FakeRobot("robot")
        robot.append(cls("meddler"))
        robot.append(Bystander("bystander"))
        Environment("empty", fastmode=True)

    return describe


@pytest.mark.parametrize(("place", "value"), PLACES)
def test_it_is_deactivated_in_that_line(
    place: str, value: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(Meddler, "place", place)
    monkeypatch.setattr(Meddler, "value", value)
    with morse.load(_scene()) as simulation:
        with simulation.record(tmp_path / "run.mcap"):
            simulation.step(5)
        state = simulation.save()
        simulation.step(2)
        simulation.restore(state)
        assert simulation.ticks == 5
        assert simulation.context.failed == {"robot.meddler"}
        assert simulation.context.components["robot.bystander"].local_data["count"] == 5
    (line,) = [one for one in caplog.messages if "robot.meddler failed and is deactivated" in one]
    assert f"'{place.rpartition('.')[2]}'" in line
    assert "test_hostile_attributes.py" in line


def test_a_component_that_cannot_be_switched_off_is_named_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with morse.load(_scene(Closed)) as simulation:
        simulation.step(6)
        assert simulation.context.components["robot.bystander"].local_data["count"] == 6
    assert len([one for one in caplog.messages if "failed and is deactivated" in one]) == 1


def test_what_a_component_may_set_remains(tmp_path: Path) -> None:
    with morse.load(_scene()) as simulation:
        component = simulation.context.components["robot.meddler"]
        component.output_functions = [*component.output_functions, lambda _: counts.append(simulation.ticks)]
        counts: list[int] = []
        component.bge_object = component.robot_parent.bge_object
        simulation.step(2)
    assert counts == [1, 2]
    assert component.name() == "robot"
