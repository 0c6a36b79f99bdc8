"""Typical mistakes in components: the messages name the mistake and the remedy, and the simulation can be ended."""

import signal
import threading
from collections.abc import Iterator
from typing import Any

import mistaken_parts
import pytest

import morse
from morse.builder import ATRV, Environment, Pose
from morse.builder.creator import SensorCreator
from morse.launch import stuck_ticks
from morse.simulation.loader import LoadError


@pytest.fixture(autouse=True)
def parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(mistaken_parts.__file__.rpartition("/")[0])


def with_sensor(name: str) -> Any:
    """A simulation of a robot with one of the sensors."""

    def scene() -> None:
        robot = ATRV("robot")
        creator = type(name, (SensorCreator,), {"_classpath": f"mistaken_parts.{name}"})
        robot.append(creator("sensor"))
        Environment("empty", fastmode=True)

    return morse.load(scene)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("Orphan", r"Orphan.__init__ does not call super\(\).__init__\(obj, parent\)"),
        ("Named", r"Named has the attribute 'name' \(str\), but name\(\) is a method of all components: rename it"),
        ("Alone", r"Alone.__init__\(self, obj.*cannot be called; expected __init__\(self, obj, parent=None\)"),
    ],
)
def test_constructors_that_cannot_work(name: str, text: str) -> None:
    with pytest.raises(LoadError, match=text):
        with_sensor(name)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("Yielding", r"Yielding.default_action contains 'yield': a call of it runs nothing"),
        ("Awaited", r"Awaited.default_action is declared by 'async def': a call of it runs nothing"),
        ("YieldingService", r"YieldingService.count contains 'yield'"),
        ("AwaitedService", r"AwaitedService.wait is declared by 'async def'"),
    ],
)
def test_methods_whose_calls_run_nothing(name: str, text: str) -> None:
    with pytest.raises(LoadError, match=text):
        with_sensor(name)


def with_manager(name: str) -> Any:
    """A simulation of a robot with a pose whose services one of the request managers offers."""

    def scene() -> None:
        robot = ATRV("robot")
        pose = Pose("pose")
        pose.add_service(f"mistaken_parts.{name}")
        robot.append(pose)
        Environment("empty", fastmode=True)

    return morse.load(scene, sockets=True)


def test_a_request_manager_without_arguments() -> None:
    simulation = with_manager("ManagerOf14")
    try:
        simulation.step(1)
        manager = simulation.context.services.request_managers()["mistaken_parts.ManagerOf14"]
        done, (status, fields) = manager.answer_of_service
        assert (done, status) == (True, "SUCCESS")
        assert "yaw" in fields
    finally:
        simulation.close()


@pytest.mark.parametrize("name", ["BrokenManager", "BrokenAtStart"])
def test_a_request_manager_that_cannot_start_is_named_with_its_line(name: str) -> None:
    with pytest.raises(
        LoadError, match=rf"(?s)request manager mistaken_parts.{name} cannot start.*port.*mistaken_parts"
    ):
        with_manager(name)


def with_stream(manager: str, *, used: bool = True, **options: object) -> Any:
    """A simulation of a robot with a pose, whose stream is of one of the stream managers if it is used."""

    def scene() -> None:
        robot = ATRV("robot")
        pose = Pose("pose")
        if used:
            pose.add_stream(f"mistaken_parts.{manager}", "mistaken_parts.Silent")
        robot.append(pose)
        env = Environment("empty", fastmode=True)
        env.configure_stream_manager(f"mistaken_parts.{manager}", **options)

    return morse.load(scene, sockets=True)


def test_a_stream_manager_of_1_4_has_its_options_in_kwargs() -> None:
    with with_stream("StreamsOf14", host="example.org") as simulation:
        manager = simulation.context.stream_managers["mistaken_parts.StreamsOf14"]
        assert (manager.host, manager.options) == ("example.org", {"host": "example.org"})
        assert manager.context is simulation.context
        assert list(manager.streams) == ["robot.pose"]


@pytest.mark.parametrize("used", [True, False])
def test_a_stream_manager_that_cannot_start_is_told_with_its_line(used: bool) -> None:
    text = r"(?s)stream manager mistaken_parts.BrokenStreams cannot start: KeyError.*host.*mistaken_parts.py"
    with pytest.raises(LoadError, match=text):
        with_stream("BrokenStreams", used=used, port=1)


def test_a_modifier_whose_calls_run_nothing() -> None:
    def scene() -> None:
        robot = ATRV("robot")
        pose = Pose("pose")
        pose.alter("", "mistaken_parts.YieldingModifier")
        robot.append(pose)
        Environment("empty", fastmode=True)

    with pytest.raises(LoadError, match=r"YieldingModifier.modify contains 'yield'"):
        morse.load(scene)


def test_a_misspelt_attribute(caplog: pytest.LogCaptureFixture) -> None:
    with with_sensor("Misspelt") as simulation:
        simulation.step()
    assert "no attribute 'positon_3d'; did you mean 'position_3d'?" in caplog.text


def test_a_method_that_is_hidden_while_the_component_runs(caplog: pytest.LogCaptureFixture) -> None:
    with with_sensor("NamedLater") as simulation:
        simulation.step(4)
        assert simulation.ticks == 4
    (line,) = [line for line in caplog.messages if "'name'" in line]
    assert line.startswith("robot.sensor: NamedLater has the attribute")


def test_a_newer_method_may_be_hidden_by_an_older_component(caplog: pytest.LogCaptureFixture) -> None:
    with with_sensor("Timed") as simulation:
        simulation.step(2)
    (line,) = [line for line in caplog.messages if "'progress'" in line]
    assert "sensor 'robot.sensor'" in line
    assert "ERROR" not in caplog.text


def test_data_that_do_not_match_their_declarations_are_reported_once(caplog: pytest.LogCaptureFixture) -> None:
    with with_sensor("Sloppy") as simulation:
        simulation.step(5)
    (typed,) = [line for line in caplog.messages if "'slope' is 'steep'" in line]
    assert "expected a number" in typed
    assert typed.startswith("robot.sensor (Sloppy)")
    (unknown,) = [line for line in caplog.messages if "publishes 'slop'" in line]
    assert "did you mean 'slope'?" in unknown
    assert "image" not in caplog.text


def test_data_that_cannot_be_read_are_named_and_end_nothing(caplog: pytest.LogCaptureFixture) -> None:
    with with_sensor("Unreadable") as simulation:
        simulation.step(3)
        assert simulation.ticks == 3
    for field, text in (("loop", "contains itself"), ("endless", "only once"), ("broken", "KeyError"), ("huge", "")):
        (line,) = [line for line in caplog.messages if f"the data field '{field}'" in line]
        assert text in line


@pytest.fixture
def handlers() -> Iterator[None]:
    before = signal.getsignal(signal.SIGINT)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(threading.current_thread() is not threading.main_thread(), reason="signals need the main thread")
def test_a_component_that_does_not_return_is_named_and_interrupted(
    handlers: None, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(stuck_ticks, "_INTERVAL", 0.01)
    with with_sensor("Endless") as simulation:
        stuck = stuck_ticks.StuckTicks(simulation, warn_after=3600.0, end_after=0.4)
        signal.signal(signal.SIGINT, stuck.end)
        try:
            with pytest.raises(KeyboardInterrupt):
                simulation.run()
        finally:
            stuck.close()
    assert "mistaken_parts.py:" in caplog.text
    assert "in default_action; Ctrl+C again, or a timeout" in caplog.text
