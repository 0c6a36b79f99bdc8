"""The services of simulation_interfaces, on a backend with calls of the test."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import trimesh
from desk import Desk

from morse.rosmsgs.topics.backend import ServiceServer

#: constants of simulation_interfaces/Result and SimulationState
UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE = 0, 1, 2, 3
PLAYING, PAUSED = 1, 2


class Counter(ServiceServer):
    def __init__(self) -> None:
        self.calls: list[Any] = []
        self.answers: list[Any] = []

    def take(self, most: int) -> list[tuple[Any, dict[str, Any]]]:
        taken, self.calls = self.calls[:most], self.calls[most:]
        return [(None, call) for call in taken]

    def answer(self, caller: Any, response: Any) -> None:
        self.answers.append(response)

    def close(self) -> None:
        pass


class Caller:
    """Calls services of a simulation."""

    def __init__(self, sim: Any, servers: dict[str, tuple[str, Counter]]) -> None:
        self.sim, self.servers = sim, servers

    def __call__(self, name: str, /, **request: Any) -> Any:
        _, server = self.servers[f"/morse/{name}"]
        server.calls.append(request)
        until = time.monotonic() + 60.0
        while time.monotonic() < until:  # after a call that took long, the next call waits
            self.sim.context.services.process()
            if server.answers:
                return server.answers.pop()
            self.sim.tick()
        raise AssertionError(f"{name} is not answered")


def caller_of(start: Callable[..., tuple[Any, Desk]], monkeypatch: pytest.MonkeyPatch, options: str = "") -> Caller:
    servers: dict[str, tuple[str, Counter]] = {}

    def service(self: Desk, name: str, type_name: str) -> Counter:
        servers[name] = (type_name, Counter())
        return servers[name][1]

    monkeypatch.setattr(Desk, "service", service)
    monkeypatch.setattr(Desk, "has_services", True)
    sim, _ = start("robot.append(Pose('pose'))", options + "env.add_default_interface('ros2')", connected="")
    return Caller(sim, servers)


@pytest.fixture
def call(start: Callable[..., tuple[Any, Desk]], monkeypatch: pytest.MonkeyPatch) -> Caller:
    return caller_of(start, monkeypatch)


def pose(x: float, y: float, z: float, frame: str = "map") -> dict[str, Any]:
    orientation = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    return {
        "header": {"frame_id": frame},
        "pose": {"position": {"x": x, "y": y, "z": z}, "orientation": orientation},
    }


def spawn(name: str, uri: str, where: dict[str, Any], **more: Any) -> dict[str, Any]:
    default = {"allow_renaming": False, "resource_string": "", "entity_namespace": ""}
    return {"name": name, "uri": uri, "initial_pose": where, **default, **more}


REST = {"linear": {"x": 0.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
ALL = {"filter": "", "categories": [], "tags": {"tags": []}, "bounds": {"type": 0}}


def test_types_and_what_is_advertised(call: Caller) -> None:
    assert call.servers["/morse/spawn_entity"][0] == "simulation_interfaces/srv/SpawnEntity"
    features = call("get_simulator_features")["features"]["features"]
    # spawning, deleting, named poses, tags, bounds, entities, spawnables, reset, state, steps (SimulatorFeatures.msg)
    assert {0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 20, 24, 25, 26, 31, 32, 44, 45} == set(features)
    assert {7, 40, 41, 42, 43} & set(features) == set(), "neither convex hulls, nor loading of worlds"


def test_time_is_held_and_stepped(call: Caller) -> None:
    assert call("get_simulation_state")["state"]["state"] == PLAYING
    assert call("step_simulation", steps=3)["result"]["result"] == INCORRECT_STATE
    assert call("set_simulation_state", state={"state": PAUSED})["result"]["result"] == OK
    assert call("set_simulation_state", state={"state": PAUSED})["result"]["result"] == 101
    before = call.sim.clock.tick
    _, server = call.servers["/morse/step_simulation"]
    server.calls.append({"steps": 7})
    call.sim.run(duration=7 / 60)
    call.sim.context.services.process()
    assert server.answers.pop()["result"]["result"] == OK
    assert call.sim.clock.tick == before + 7
    assert call("set_simulation_state", state={"state": PLAYING})["result"]["result"] == OK
    assert call("set_simulation_state", state={"state": 99})["result"]["result"] == UNSUPPORTED


def test_entities_come_move_and_go(call: Caller) -> None:
    made = call("spawn_entity", **spawn("box", "props/crates", pose(3.0, 4.0, 1.0)))
    assert made == {"result": {"result": OK, "error_message": ""}, "entity_name": "box"}
    assert {"robot", "box"} <= set(call("get_entities", filters=ALL)["entities"])
    assert call("get_entities", filters={**ALL, "filter": "^b[a-z]*$"})["entities"] == ["box"]
    left = {**pose(5.0, 6.0, 2.0)["pose"], "orientation": {"x": 0.0, "y": 0.0, "z": 1.0, "w": 1.0}}
    put = {"header": {"frame_id": ""}, "pose": left, "twist": REST}
    assert call("set_entity_state", entity="box", state=put)["result"]["result"] == OK
    state = call("get_entity_state", entity="box")["state"]
    assert state["header"]["frame_id"] == "map"
    place, turn = state["pose"]["position"], state["pose"]["orientation"]
    assert (place["x"], place["y"]) == pytest.approx((5.0, 6.0), abs=0.05)
    assert (turn["z"], turn["w"]) == pytest.approx((0.5**0.5, 0.5**0.5), abs=0.05), "of any length"
    states = call("get_entities_states", filters={**ALL, "filter": "^box$|^robot$"})
    assert len(states["states"]) == len(states["entities"]) == 2
    assert call("delete_entity", entity="box")["result"]["result"] == OK
    assert call("get_entity_state", entity="box")["result"]["result"] == NOT_FOUND


def test_what_can_be_spawned_is_listed(call: Caller) -> None:
    uris = {one["uri"] for one in call("get_spawnables", sources=[])["spawnables"]}
    assert {"ATRV", "Quadrotor", "props/crates"} <= uris
    for number, uri in enumerate(("Pioneer3DX", "props/crates")):
        assert uri in uris
        answer = call("spawn_entity", **spawn(f"one_{number}", uri, pose(4.0 + 3 * number, 3.0, 0.3)))
        assert answer["result"]["result"] == OK
    assert call("get_spawnables", sources=["file:///etc"])["result"]["result"] != OK


def test_the_resource_of_version_2(call: Caller) -> None:
    """SpawnEntity of simulation_interfaces 2 has uri and resource_string in a message of their own."""
    request = spawn("second", "ATRV", pose(3.0, 0.0, 0.2))
    resource = {"uri": request.pop("uri"), "resource_string": request.pop("resource_string")}
    answer = call("spawn_entity", **request, entity_resource=resource)
    assert (answer["result"]["result"], answer["entity_name"]) == (OK, "second")


def test_worlds_have_the_names_of_scene_scripts(call: Caller) -> None:
    assert call("get_current_world")["world"]["name"] == "empty"
    every = {"additional_sources": [], "filter": {"tags": [], "filter_mode": 0}}
    worlds = call("get_available_worlds", **every)["worlds"]
    assert {"empty", "sandbox", "indoors-1/indoor-1", "outdoors"} <= {world["name"] for world in worlds}
    assert all(world["world_resource"]["uri"] == world["name"] for world in worlds)
    assert call("get_available_worlds", **{**every, "additional_sources": ["file:///etc"]})["result"]["result"] != OK
    assert call("get_available_worlds", **{**every, "filter": {"tags": ["wet"], "filter_mode": 0}})["worlds"] == []


def test_a_robot_that_comes_has_its_topics(call: Caller) -> None:
    assert call("spawn_entity", **spawn("second", "ATRV", pose(3.0, 0.0, 0.2)))["result"]["result"] == OK
    assert "second" in call.sim.context.robots


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        (spawn("robot", "ATRV", pose(0, 0, 0)), 101),
        (spawn("a b", "ATRV", pose(0, 0, 0)), 102),
        (spawn("../up", "ATRV", pose(0, 0, 0)), 102),
        (spawn("é", "ATRV", pose(0, 0, 0)), 102),
        (spawn("x" * 1_000_000, "ATRV", pose(0, 0, 0)), 102),
        (spawn("Simulation", "ATRV", pose(0, 0, 0), allow_renaming=True), 102),
        (spawn("ROBOT", "ATRV", pose(0, 0, 0)), 4),
        (spawn("a", "ATRV", pose(0, 0, 0), resource_string="robot"), 103),
        (spawn("a", "", pose(0, 0, 0)), 104),
        (spawn("a", "ATRV", pose(0, 0, 0), entity_namespace="other"), 105),
        (spawn("a", "ATRV", pose(0, 0, 0, frame="odom")), 109),
        (spawn("a", "ATRW", pose(0, 0, 0)), 4),
        (spawn("a", "ATRV", pose(float("nan"), 0, 0)), 4),
    ],
)
def test_what_cannot_come_is_refused_with_the_code_for_it(call: Caller, request_: dict[str, Any], code: int) -> None:
    answer = call("spawn_entity", **request_)
    assert answer["result"]["result"] == code
    assert answer["result"]["error_message"]
    assert "a" not in call.sim.context.robots


def test_names_are_changed_if_that_is_allowed(call: Caller) -> None:
    answer = call("spawn_entity", **spawn("robot", "props/crates", pose(3.0, 0.0, 0.5), allow_renaming=True))
    assert answer["entity_name"] == "robot_1"


@pytest.mark.parametrize("pattern", ["(a+)+$", ".*" * 20, "a" * 300, "x{1000}", "[", "a\\"])
def test_filters_that_may_take_for_ever_are_refused(call: Caller, pattern: str) -> None:
    assert call("get_entities", filters={**ALL, "filter": pattern})["result"]["result"] != OK


def test_a_reset_is_whole(call: Caller) -> None:
    call.sim.step(10)
    assert call("reset_simulation", scope=1)["result"]["result"] == UNSUPPORTED
    assert call("spawn_entity", **spawn("box", "props/crates", pose(3.0, 4.0, 1.0)))["result"]["result"] == OK
    before = call.sim.clock.tick
    assert before >= 10
    assert call("reset_simulation", scope=0)["result"]["result"] == OK
    assert call.sim.clock.tick < before, "ticks go on until the answer is there"
    assert "box" not in call("get_entities", filters=ALL)["entities"]
    fast = {"header": {"frame_id": "map"}, "pose": pose(0, 0, 0)["pose"],
            "twist": {**REST, "linear": {"x": 1.0, "y": 0.0, "z": 0.0}}}  # fmt: skip
    assert call("set_entity_state", entity="robot", state=fast)["result"]["result"] == UNSUPPORTED


def test_a_filter_that_takes_long_for_many_names_is_given_up(call: Caller, monkeypatch: pytest.MonkeyPatch) -> None:
    now = iter(range(100))
    monkeypatch.setattr("morse.middleware.ros2.simulation_interfaces.thread_time", lambda: next(now))
    result = call("get_entities", filters={**ALL, "filter": "a*a*a*b"})["result"]
    assert result["result"] != OK
    assert "takes too long" in result["error_message"]


def test_robots_and_objects(call: Caller) -> None:
    robot, thing = 1, 0
    assert call("spawn_entity", **spawn("box", "props/crates", pose(5.0, 0.0, 0.5)))["result"]["result"] == OK
    for name, category in (("robot", robot), ("box", thing)):
        answer = call("get_entity_info", entity=name)
        assert answer["result"]["result"] == OK
        assert answer["info"]["category"]["category"] == category
        chosen = call("get_entities", filters={**ALL, "categories": [{"category": category}]})["entities"]
        assert name in chosen
    assert "robot" not in call("get_entities", filters={**ALL, "categories": [{"category": thing}]})["entities"]
    assert "ATRV" in call("get_entity_info", entity="robot")["info"]["description"]
    assert call("get_entity_info", entity="ghost")["result"]["result"] == NOT_FOUND


URDF = """<?xml version="1.0"?>
<!-- a stranger's -->
<robot name="Scout 2">
  <link name="base_link"><inertial><mass value="8"/></inertial>
    <collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision></link>
  <link name="laser"/>
  <joint name="up" type="fixed"><parent link="base_link"/><child link="laser"/><origin xyz="0 0 0.2"/></joint>
  <gazebo reference="laser"><sensor name="scan" type="gpu_ray"><ray><scan><horizontal><samples>31</samples>
    <min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan><range><max>8</max></range></ray></sensor></gazebo>
</robot>"""


def test_a_robot_comes_as_text(call: Caller) -> None:
    assert "urdf" in call("get_simulator_features")["features"]["spawn_formats"]
    answer = call("spawn_entity", **spawn("", "", pose(6.0, 1.0, 0.2), resource_string=URDF))
    assert (answer["result"]["result"], answer["entity_name"]) == (OK, "scout_2")
    call.sim.step(30)
    state = call("get_entity_state", entity="scout_2")["state"]
    assert state["pose"]["position"]["x"] == pytest.approx(6.0, abs=0.05)
    assert call("get_entity_info", entity="scout_2")["info"]["category"]["category"] == 1, "a robot"
    assert len(call.sim.context.components["scout_2.scan"].local_data["range_list"]) == 31
    again = call("spawn_entity", **spawn("scout_2", "", pose(8.0, 1.0, 0.2), resource_string=URDF, allow_renaming=True))
    assert again["entity_name"] == "scout_2_1"
    assert call("delete_entity", entity="scout_2")["result"]["result"] == OK


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("ATRV", "the text of a robot"),
        ("<html/>", "<robot>"),
        ("<robot name='a'>", "the description: it is not XML"),
        ("<robot name='$(env HOME)'><link name='a'/></robot>", "substitutions"),
        ("<robot name='a'><link name='&#36;(find morse)'/></robot>", "substitutions"),
    ],
)
def test_a_text_that_is_no_robot_is_refused_with_the_reason(call: Caller, text: str, words: str) -> None:
    answer = call("spawn_entity", **spawn("it", "", pose(6.0, 1.0, 0.2), resource_string=text))
    assert answer["result"]["result"] != OK
    assert words in answer["result"]["error_message"]
    assert "it" not in call("get_entities", filters=ALL)["entities"]


def test_a_text_reads_no_file_of_the_machine(call: Caller, tmp_path: Path) -> None:
    trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / "secret.stl")
    mesh = f'<visual><geometry><mesh filename="file://{tmp_path}/secret.stl"/></geometry></visual>'
    text = URDF.replace('<link name="laser"/>', f'<link name="laser">{mesh}</link>')
    call("spawn_entity", **spawn("spy", "", pose(6.0, 1.0, 0.2), resource_string=text))
    nodes = [node for root in call.sim.scene.roots if root.name == "spy" for node in root.walk()]
    assert nodes
    assert not [node for node in nodes if node.mesh is not None and "secret" in node.name]
