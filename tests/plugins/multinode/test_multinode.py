"""Two nodes share a world: each simulates its robots, and shows those of the other where the server says."""

import json
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.builder import ATRV, Environment, MotionVW, Pose
from morse.builder.errors import ScriptError
from morse.core.clients.network import Network
from morse.plugins.multinode.server import MultinodeServer
from morse.simulation.simulation import Simulation
from morse.wire.listener import listen, port_of

#: ticks of a node that waits for the other side, which answers in another thread
MANY = 200_000


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """The port of a server."""
    network = Network()
    listener = listen("127.0.0.1", [0])
    number = port_of(listener)
    server = MultinodeServer(listener, network)
    yield number
    server.close()
    network.stop()


@pytest.fixture
def node(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Simulation]]:
    """Call it with the name of a node and the port of the server."""
    started: list[Simulation] = []

    def start(name: str, port: int, **options: Any) -> Simulation:
        def scene() -> None:
            anna, bert = ATRV("anna"), ATRV("bert")
            bert.translate(5.0)
            for robot in (anna, bert):
                motion, pose = MotionVW("motion"), Pose("pose")
                robot.append(motion)
                robot.append(pose)
            env = Environment("empty", fastmode=True)
            shares = {"left": ["anna"], "right": ["bert"]}
            given = {"server_address": "127.0.0.1", "server_port": str(port), "distribution": shares}
            env.configure_multinode(**{**given, **options})

        monkeypatch.setenv("MORSE_NODE", name)
        simulation = morse.load(scene, sockets=True)
        started.append(simulation)
        return simulation

    yield start
    for simulation in started:
        simulation.close()


def place(simulation: Simulation, robot: str) -> tuple[float, float, float]:
    x, y, z = simulation.rpc("simulation", "get_scene_objects")[robot][1]
    return x, y, z


def step_until(condition: Callable[[], bool], *simulations: Simulation) -> None:
    for _ in range(MANY):
        for simulation in simulations:
            simulation.step()
        if condition():
            return
    raise AssertionError(f"not after {MANY} ticks")


def test_each_node_simulates_its_robots_and_sees_the_others(node: Callable[..., Simulation], port: int) -> None:
    left, right = node("left", port), node("right", port)
    assert left.robots == ["anna"]
    assert right.robots == ["bert"]
    assert [c["name"] for c in left.rpc("simulation", "details")["robots"]] == ["anna"]
    left.anna.motion.publish({"v": 1.0, "w": 0.0})
    left.step(60)
    left.anna.motion.publish({"v": 0.0, "w": 0.0})
    left.step(30)
    assert place(left, "anna")[0] > 0.5

    def agree() -> bool:
        return all(place(left, robot) == pytest.approx(place(right, robot), abs=1e-3) for robot in ("anna", "bert"))

    step_until(agree, left, right)
    assert place(right, "anna")[0] > 0.5


def test_robots_of_other_nodes_stay_without_them(node: Callable[..., Simulation], port: int) -> None:
    """They do not fall, either."""
    left = node("left", port)
    before = place(left, "bert")
    left.step(60)
    assert place(left, "bert") == before


def test_the_poses_of_others_are_inputs_of_a_recorded_run(node: Callable[..., Simulation], port: int) -> None:
    left, right = node("left", port), node("right", port)
    entries: list[Any] = []
    left.journal.sinks.append(entries.append)
    right.rpc("simulation", "set_object_position", "bert", [7.0, 1.0, 0.1])
    step_until(lambda: abs(place(left, "bert")[0] - 7.0) < 1e-3, left, right)
    assert any(entry.name == "simulation" and entry.content[1][0] == "bert" for entry in entries)


def test_a_robot_that_is_not_in_the_script(
    node: Callable[..., Simulation], port: int, caplog: pytest.LogCaptureFixture
) -> None:
    assert node("left", port, distribution={"left": ["anna", "bart"]}).robots == ["anna"]
    assert "the robot 'bart' of the node 'left' is not in the script; did you mean 'bert'?" in caplog.text


def test_an_unknown_node_simulates_everything_and_is_named(
    node: Callable[..., Simulation], port: int, caplog: pytest.LogCaptureFixture
) -> None:
    assert node("lefd", port).robots == ["anna", "bert"]
    assert "this node is called 'lefd'" in caplog.text
    assert "did you mean 'left'?" in caplog.text


def test_a_protocol_that_is_not_available(node: Callable[..., Simulation], port: int) -> None:
    with pytest.raises(ScriptError, match="use protocol='socket'"):
        node("left", port, protocol="hla")


def test_without_a_server_the_simulation_continues(
    node: Callable[..., Simulation], caplog: pytest.LogCaptureFixture
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        closed = free.getsockname()[1]
    left = node("left", closed)
    step_until(lambda: "there is no multi-node server" in caplog.text, left)
    assert "multinode_server" in caplog.text


def test_the_wire_is_that_of_1_4(port: int) -> None:
    """A node of 1.4 sends a list, and gets the robots that it has not sent."""
    with socket.create_connection(("127.0.0.1", port), timeout=60.0) as one, one.makefile("rb") as lines:
        one.sendall(b'["one", {"r1": [[1, 2, 3], [0, 0, 0.5]], "__time": [1.0, 0.016, 1e9]}]\n')
        assert json.loads(lines.readline()).keys() & {"r1", "__time"} == set()
        with socket.create_connection(("127.0.0.1", port), timeout=60.0) as two, two.makefile("rb") as others:
            two.sendall(b'["two", {}]\n')
            assert json.loads(others.readline())["r1"] == [[1.0, 2.0, 3.0], [0.0, 0.0, 0.5]]


def test_the_scene_of_the_documentation(port: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = Path(__file__).parents[3] / "docs" / "multinode.md"
    text = page.read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    script = tmp_path / "shared.py"
    script.write_text(text.replace("localhost", "127.0.0.1").replace("65000", str(port)), encoding="utf-8")
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    monkeypatch.setenv("MORSE_NODE", "right")
    with morse.load(script, sockets=True) as simulation:
        assert simulation.robots == ["bert"]
        assert simulation.streams() == ["bert.pose"]
        simulation.step()
        assert "anna" in simulation.rpc("simulation", "get_scene_objects")
