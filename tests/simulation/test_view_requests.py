"""Requests of the driving page to components."""

import math
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from morse.viewer import page_messages as page
from morse.viewer.feeds.components import StatesFeed, ViewDebug, component_tree
from morse.viewer.hub import Wishes
from morse.viewer.live_view import Moving, View
from morse.viewer.page import PageLeft
from morse.viewer.page_inputs import Commands, ServiceCalls
from morse.viewer.page_messages import ViewEvent
from morse.viewer.protocol import page_message_types
from morse.viewer.view_messages import Activity, Answer, Capturing, DebugProperties, PropertyValue, Refused

SCENE = """
from morse.builder.creator import SensorCreator

class Camera(SensorCreator):
    _classpath = "view_parts.Camera"

robot = ATRV()
left, right, pose, motion = Camera(), Camera(), Pose(), MotionVW()
robot.append(motion)
robot.append(left)
robot.append(right)
robot.append(pose)
env = Environment("empty", fastmode=True)
"""


class Asked:
    """The requests of a page to a simulation, and the messages in return."""

    def __init__(self, simulation: Any) -> None:
        self.said: list[Any] = []
        self.simulation = simulation
        self.components = simulation.context.components
        server: Any = SimpleNamespace(send=self.said.append, wishes=Wishes())
        commands = Commands(simulation.context)
        self.requests = ServiceCalls(simulation.context, server, commands)
        self.states = StatesFeed(simulation.context, server)
        self.server = server

    def capturing(self) -> list[bool]:
        return [self.components[f"robot.{name}"].capturing for name in ("left", "right")]

    def take(self) -> list[Any]:
        """The messages since the last call."""
        self.states.update()
        said = list(self.said)
        self.said.clear()
        return said


@pytest.fixture
def asked(load: Callable[..., Any]) -> Asked:
    return Asked(load(SCENE))


def test_every_event_of_a_page_is_handled(load: Callable[..., Any]) -> None:
    view = View(load(SCENE, view="web", view_port=0))
    try:
        events = {kind for kind in page_message_types() if issubclass(kind, ViewEvent)}
        # time can only go backward in recorded runs
        assert set(view._handlers) == events - {page.PlayBackward} | {PageLeft}
    finally:
        view.close()


def test_cameras_stop_and_go_on_together(asked: Asked) -> None:
    asked.take()
    asked.requests.toggle_capturing(page.ToggleCapturing())
    assert asked.capturing() == [False, False]
    assert asked.take() == [Capturing(False)]
    asked.requests.toggle_capturing(page.ToggleCapturing())
    assert asked.capturing() == [True, True]
    assert asked.take() == [Capturing(True)]
    assert asked.components["robot.pose"].capturing is None


def test_while_one_takes_pictures_the_key_stops_all(asked: Asked) -> None:
    asked.components["robot.left"].capturing = False
    asked.requests.toggle_capturing(page.ToggleCapturing())
    assert asked.capturing() == [False, False]


def test_pages_hear_of_cameras_that_are_stopped_one_by_one(asked: Asked) -> None:
    assert Capturing(True) in asked.take()
    asked.requests.set_property(page.SetProperty(1, "robot.left", "capturing", False))
    assert asked.take() == [PropertyValue("robot.left", "capturing", False), Answer(1, True, False)]
    asked.requests.set_property(page.SetProperty(2, "robot.right", "capturing", False))
    assert asked.take()[-1] == Capturing(False)


def test_without_cameras_the_key_says_so(load: Callable[..., Any]) -> None:
    asked = Asked(load("robot = ATRV()\nenv = Environment('empty', fastmode=True)"))
    asked.requests.toggle_capturing(page.ToggleCapturing())
    assert asked.take() == [Refused("toggle_capturing", "No robot has a camera.")]


def test_a_component_may_refuse_a_property_itself(asked: Asked) -> None:
    asked.requests.set_property(page.SetProperty(1, "robot.left", "zoom", 0.5))
    assert asked.said == [Answer(1, False, error="the zoom is 1 or more")]
    assert asked.components["robot.left"].zoom == 1.0
    asked.said.clear()
    asked.requests.set_property(page.SetProperty(2, "robot.left", "zoom", 4.0))
    assert asked.said == [PropertyValue("robot.left", "zoom", 4.0), Answer(2, True, 4.0)]
    asked.said.clear()
    asked.requests.set_property(page.SetProperty(3, "robot.none", "zoom", 4.0))
    assert not asked.said[0].ok


def test_pages_see_whether_a_component_acts_whoever_stopped_it(asked: Asked) -> None:
    asked.take()
    asked.requests.activate(page.Activate(1, "robot.pose", False))
    assert asked.take() == [Answer(1, True), Activity("robot.pose", False)]
    asked.components["robot.pose"].toggle_active()
    assert asked.take() == [Activity("robot.pose", True)]
    asked.components["robot.pose"].default_action = lambda: 1 / 0
    asked.simulation.tick()
    assert asked.take() == [Activity("robot.pose", False)]


def test_pages_see_the_properties_of_what_they_look_at_whoever_changes_them(asked: Asked) -> None:
    asked.server.wishes = Wishes(values=frozenset({"robot.left"}))
    asked.take()
    asked.components["robot.left"].zoom = 3.0
    asked.components["robot.right"].zoom = 3.0
    assert asked.take() == [PropertyValue("robot.left", "zoom", 3.0)]


def test_services_of_every_object_called_simulation_are_offered_and_described(asked: Asked) -> None:
    tree = {component.name: component for component in component_tree(asked.simulation.context)}
    assert {"list_robots", "get_seed", "set_camarafp_position"} <= {s.name for s in tree["simulation"].services}
    asked.requests.call(page.CallService(1, "simulation", "get_seed", []))
    assert asked.said == [Answer(1, True, asked.simulation.seed())]


def test_data_of_an_actuator_are_taken_as_a_command(asked: Asked) -> None:
    actuator = asked.components["robot.motion"]
    asked.requests.command(page.Command(1, "robot.motion", {"v": 0.5}))
    assert asked.said == [Answer(1, True)]
    assert actuator.local_data["v"] == 0.0  # not yet: commands take effect in the tick
    asked.simulation.tick()
    assert actuator.local_data["v"] == 0.5
    before = asked.simulation.context.robots["robot"].bge_object.worldPosition[0]
    for _ in range(60):
        asked.simulation.tick()
    moved = asked.simulation.context.robots["robot"].bge_object.worldPosition[0] - before
    assert moved == pytest.approx(0.5, rel=0.1)


@pytest.mark.parametrize(
    ("component", "fields", "told"),
    [
        ("robot.motion", {"v": "fast"}, "expected a number"),
        ("robot.motion", {"vv": 1.0}, "no field 'vv'; did you mean 'v'?"),
        ("robot.pose", {"x": 1.0}, "no actuator 'robot.pose'"),
    ],
)
def test_a_wrong_command_is_refused_at_once(asked: Asked, component: str, fields: dict[str, Any], told: str) -> None:
    asked.requests.command(page.Command(1, component, fields))
    (answer,) = asked.said
    assert not answer.ok
    assert told in answer.error
    asked.simulation.tick()
    assert asked.components["robot.motion"].local_data["v"] == 0.0


def test_the_journal_sees_whatever_a_page_changes(asked: Asked) -> None:
    seen: list[Any] = []
    simulation, requests = asked.simulation, asked.requests
    simulation.journal.sinks.append(seen.append)
    moving = Moving(asked.server, requests)
    requests.set_property(page.SetProperty(1, "robot.left", "zoom", 2.0))
    requests.activate(page.Activate(2, "robot.pose", False))
    moving.teleport(page.Teleport(3, "robot", (1.0, 2.0, 0.5), (1.0, 0.0, 0.0, 0.0)))
    moving.drag(page.Drag("robot", (0.0, 0.0, 0.1), (3.0, 2.0, 1.0)))
    moving.let_go()
    requests.command(page.Command(4, "robot.motion", {"v": 0.5}))
    simulation.tick()
    assert [(entry.kind, entry.name) for entry in seen] == [
        ("service", "robot.left"),
        ("service", "simulation"),
        ("service", "simulation"),
        ("service", "simulation"),
        ("service", "simulation"),
        ("command", "robot.motion"),
    ]
    assert [answer.ok for answer in asked.said if isinstance(answer, Answer)] == [True] * 4


def test_a_page_puts_objects_somewhere_and_pulls_at_them(asked: Asked) -> None:
    moving = Moving(asked.server, asked.requests)
    robot = asked.simulation.context.robots["robot"].bge_object
    half = math.sqrt(0.5)
    moving.teleport(page.Teleport(1, "robot", (1.0, 2.0, 0.5), (half, 0.0, 0.0, half)))
    assert list(robot.worldPosition) == pytest.approx([1.0, 2.0, 0.5])
    assert robot.worldOrientation.to_euler().z == pytest.approx(math.pi / 2)
    moving.drag(page.Drag("robot", (0.0, 0.0, 0.0), (4.0, 2.0, 1.0)))
    for _ in range(30):
        asked.simulation.tick()
    assert robot.worldPosition[0] > 1.2
    moving.let_go()
    moving.teleport(page.Teleport(2, "nothing", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)))
    assert not asked.said[-1].ok
    moving.drag(page.Drag("nothing", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    assert isinstance(asked.said[-1], Refused)


# -- properties that are shown while the simulation runs -------------------------------------------

VIEW_DEBUG_SCENE = """
from morse.builder.creator import SensorCreator

class Writer(SensorCreator):
    _classpath = "view_parts.Writer"

robot = ATRV()
writer, pose = Writer(), Pose()
robot.append(writer)
robot.append(pose)
robot.properties(Label="a robot", Speed=2.0)
env = Environment("empty", fastmode=True)
"""


class Shown:
    """The displayed properties of a simulation, on request."""

    def __init__(self, simulation: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        self.said: list[DebugProperties] = []
        self._now = time.monotonic()
        monkeypatch.setattr("morse.viewer.feeds.components.time.monotonic", lambda: self._now)
        self._debug = ViewDebug(simulation, SimpleNamespace(send=self.said.append))  # type: ignore[arg-type]

    def look(self, after: float = 0.25) -> dict[str, str]:
        """The properties, after some wall-clock time."""
        self._now += after
        self._debug.update()
        return {f"{p.node}.{p.name}": p.value for p in self.said[-1].properties} if self.said else {}


@pytest.fixture
def show(load: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> Callable[[str], tuple[Any, Shown]]:
    def start(more: str) -> tuple[Any, Shown]:
        simulation = load(VIEW_DEBUG_SCENE + more)
        return simulation, Shown(simulation, monkeypatch)

    return start


def test_nothing_is_shown_unless_the_script_asks(show: Any) -> None:
    simulation, shown = show("")
    simulation.tick()
    assert shown.look() == {}
    assert shown.said == []


def test_what_gets_a_value_while_running_is_shown(show: Any) -> None:
    simulation, shown = show("env.show_debug_properties()")
    assert shown.look() == {}
    simulation.tick()
    seen = shown.look()
    assert seen["robot.ticks"] == "1"
    assert seen["robot.long"].startswith("[0, 1, 2")
    assert seen["robot.text"] == "x" * 200
    assert "Broken" in seen["robot.broken"]
    assert "robot.Label" not in seen
    assert max(map(len, seen.values())) <= 200
    simulation.tick()
    assert shown.look()["robot.ticks"] == "2"
    told = len(shown.said)
    shown.look()
    assert len(shown.said) == told  # nothing has changed
    simulation.restart()
    assert shown.look() == {}


def test_marked_properties_are_shown_from_the_start(show: Any) -> None:
    _, shown = show("robot.scene_node.debug = ('Label',)\nenv.show_debug_properties()")
    assert shown.look() == {"robot.Label": "a robot"}


def test_of_very_many_only_the_first_are_shown(show: Any) -> None:
    simulation, shown = show("env.show_debug_properties()")
    robot = simulation.context.world.objects_by_name["robot"]
    for i in range(250):
        robot[f"p{i}"] = i
    assert len(shown.look()) == 100
    assert shown.said[-1].more == 150


def test_profiled_sensors_show_their_share_of_the_time(show: Any) -> None:
    simulation, shown = show("writer.profile()")
    assert shown.look() == {}
    begin = time.perf_counter()
    for _ in range(20):
        simulation.tick()
    most = time.perf_counter() - begin
    seen = shown.look(after=1.0)
    assert list(seen) == ["robot.writer.profile"]  # neither properties nor the other sensor were requested
    # 20 actions of at least 2 ms in one second of the clock
    assert 4.0 <= float(seen["robot.writer.profile"].removesuffix(" %")) <= 100.0 * most
    assert shown.look(after=1.0)["robot.writer.profile"] == "0.0 %"
