"""A component that puts something else in the place of what the simulation needs fails in that line, alone."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hostile_objects as objects
import pytest

import morse
from morse.builder import ATRV, IMU, Environment, FakeRobot, Pose
from morse.core.sensor import Sensor
from morse.core.state import StateError
from morse.helpers.components import add_data
from pymorse import MorseServiceFailed

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


# -- a robot that a client describes neither ends the simulation nor disturbs other robots ---------

STEP = """<mujoco><option timestep="{step}"/><worldbody><body name="b"><freejoint/><geom size="0.1"/></body></worldbody>
</mujoco>"""
SCANNER = """<robot name="r"><link name="a"/><gazebo reference="a"><sensor name="scan" type="gpu_lidar"><ray><scan>
<horizontal><samples>{samples}</samples>{more}</horizontal></scan></ray></sensor></gazebo></robot>"""

FAN = "<min_angle>-1</min_angle><max_angle>1</max_angle>"


def scene() -> None:
    robot = ATRV("robot")
    robot.append(Pose("pose"))
    robot.append(IMU("imu"))
    Environment("empty")


@pytest.mark.parametrize("step", ["1e-12", "1e-300", "1e-5", "0.002", "1e9"])
def test_the_time_step_of_a_text_takes_a_limited_time(step: str) -> None:
    with morse.load(scene, on_failure="raise") as simulation:
        simulation.spawn("guest", STEP.format(step=step), (5.0, 0.0, 2.0))
        model = simulation.world.model
        assert model.opt.timestep >= 0.99e-4
        simulation.step(6)
        # it has fallen for a tenth of a second: g t^2 / 2
        z = simulation.world.objects_by_name["guest"].world_pose()[0][2]
        assert 2.0 - z == pytest.approx(0.049, abs=0.01)
        simulation.delete("guest")
        simulation.step(2)


@pytest.mark.parametrize("samples", ["1", "0", "-3", "1.5", "100000000", "nan"])
@pytest.mark.parametrize(
    "more", ["", "<min_angle>-1</min_angle><max_angle>1</max_angle>", "<resolution>0</resolution>"]
)
def test_sensors_come_and_go_between_measurements(samples: str, more: str) -> None:
    with morse.load(scene, on_failure="raise") as simulation:
        for _ in range(3):
            simulation.spawn("guest", SCANNER.format(samples=samples, more=more), (5.0, 0.0, 0.0))
            simulation.step(1)
            simulation.delete("guest")
        simulation.step(2)
        assert simulation.robot.imu.get()["timestamp"] == pytest.approx(simulation.clock.time)


SENSORS = {
    "camera": "<camera><image><width>16</width><height>16</height></image></camera>",
    "imu": "",
    "contact": "<contact><collision>c</collision></contact>",
}


def with_sensors(kind: str, count: int) -> str:
    sensor = f'<sensor name="s{{}}" type="{kind}"><update_rate>1</update_rate>{SENSORS[kind]}</sensor>'
    return (
        '<sdf version="1.7"><model name="m"><link name="base"><collision name="c"><geometry><box><size>1 1 1</size>'
        f"</box></geometry></collision>{''.join(map(sensor.format, range(count)))}</link></model></sdf>"
    )


@pytest.mark.parametrize("kind", SENSORS)
@pytest.mark.parametrize("count", [200, 2000])
def test_what_a_client_spawns_has_a_budget_of_components(kind: str, count: int) -> None:
    with morse.load(scene) as simulation:
        before = simulation.state_hash()
        with pytest.raises(MorseServiceFailed, match="more than 200 robots, sensors and actuators"):
            simulation.rpc("simulation", "spawn", "guest", with_sensors(kind, count), [5.0, 0.0, 2.0])
        assert simulation.state_hash() == before
        assert "guest" not in simulation.world.objects_by_name
        simulation.rpc("simulation", "spawn", "guest", with_sensors(kind, 3), [5.0, 0.0, 2.0])
        assert len([name for name in simulation.context.components if name.startswith("guest.")]) == 3


def test_a_program_spawns_more_than_a_client() -> None:
    with morse.load(scene) as simulation:
        simulation.spawn("guest", with_sensors("imu", 210), (5.0, 0.0, 2.0))
        assert len([name for name in simulation.context.components if name.startswith("guest.")]) == 210


@pytest.mark.parametrize("step", ["1e-12", "1e-4", "0.00049"])
def test_the_text_of_a_client_does_not_set_a_short_time_step(step: str) -> None:
    with morse.load(scene) as simulation:
        before = simulation.world.model.opt.timestep
        with pytest.raises(MorseServiceFailed, match=r"clients may spawn descriptions with 0\.0005 s or more"):
            simulation.rpc("simulation", "spawn", "guest", STEP.format(step=step), [5.0, 0.0, 2.0])
        assert simulation.world.model.opt.timestep == before
        simulation.rpc("simulation", "spawn", "guest", STEP.format(step="0.0005"), [5.0, 0.0, 2.0])
        assert simulation.world.model.opt.timestep == pytest.approx(0.0005, rel=0.03)


def test_a_recording_repeats_what_a_client_was_refused() -> None:
    with morse.load(scene) as simulation, morse.load(scene) as other:
        with simulation.record_inputs() as recording:
            simulation.step(2)
            with pytest.raises(MorseServiceFailed):
                simulation.rpc("simulation", "spawn", "guest", with_sensors("imu", 300), [5.0, 0.0, 2.0])
            simulation.step(2)
        other.replay(recording)
        assert other.state_hash() == simulation.state_hash()


# -- objects of a component that raise whatever is asked of them: the run goes on, and its state can be saved

OBJECTS = ["Mute", "Disguised", "Unsaved", "Unordered", "Anonymous"]
HOSTILE_OBJECTS_PLACES = ["attribute", "field", "data", "item"]


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


def hostile_objects_scene() -> None:
    robot = FakeRobot("robot")
    robot.append(Holder("holder"))
    robot.append(Neighbour("neighbour"))
    Environment("empty", fastmode=True)


@pytest.fixture
def simulation(tmp_path: Path) -> Iterator[Any]:
    with morse.load(hostile_objects_scene) as sim, sim.record(tmp_path / "run.mcap"):
        yield sim


@pytest.mark.parametrize("place", HOSTILE_OBJECTS_PLACES)
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
