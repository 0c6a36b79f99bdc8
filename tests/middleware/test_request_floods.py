"""Floods of long requests over each middleware: a tick serves a few of them, and all clients in turn."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

import morse
from morse.core.clients.budgets import TimeShares
from morse.core.request_manager import OfferedService
from morse.middleware.rosbridge.datastream import RosbridgeRequestManager

#: s that a request takes, for example to spawn a robot
LONG = 0.02


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The arguments of the calls of the long service; its time is that of a clock that only the service advances."""
    calls: list[Any] = []
    monkeypatch.setattr("morse.core.clients.budgets.perf_counter", lambda: 100.0 + LONG * len(calls))
    return calls


def offer(manager: Any, served: list[Any]) -> None:
    def spawn(who: str = "") -> None:
        """Spawn."""
        served.append(who)

    manager._services["simulation", "spawn"] = OfferedService.of(spawn, "spawn", is_async=False)


def context() -> Any:
    scene = SimpleNamespace(settings=SimpleNamespace(node_name="morse"), manager_options={})
    journal = SimpleNamespace(note=lambda *_: None)
    return SimpleNamespace(scene=scene, journal=journal, wake=lambda: None, clock=None, time_shares=TimeShares())


def yarp(served: list[Any]) -> Any:
    from morse.plugins.yarp.request_manager import YarpRequestManager

    manager = YarpRequestManager(context())
    for number in range(50):
        manager._inbox.append(("simulation", [str(number), "simulation", "spawn", "[]"]), 40)
    return manager


def ros(served: list[Any]) -> Any:
    from morse.plugins.ros.request_manager import RosRequestManager, _Waiting

    manager = RosRequestManager(context())
    begin = manager._begin("simulation", "spawn")
    manager._queue.extend(_Waiting(lambda ended: begin([], ended)) for _ in range(50))
    return manager


class Server:
    """The server of a service of ROS 2 with calls that wait."""

    def __init__(self, count: int) -> None:
        self._calls: list[tuple[Any, dict[str, Any]]] = [(number, {}) for number in range(count)]

    def take(self, most: int) -> list[tuple[Any, dict[str, Any]]]:
        taken, self._calls = self._calls[:most], self._calls[most:]
        return taken

    def answer(self, caller: Any, response: Any) -> None:
        """Ignore the outcome."""


def ros2(served: list[Any]) -> Any:
    from morse.middleware.ros2.request_manager import Ros2RequestManager, _Offer

    def called_with(*words: str) -> Any:
        return SimpleNamespace(arguments=lambda _: list(words), answer=lambda *_: {})

    manager = Ros2RequestManager(context())
    manager._offers["simulation", "spawn"] = _Offer(Server(50), called_with("flood"))  # type: ignore[arg-type]
    manager._offers["other", "spawn"] = _Offer(Server(1), called_with("modest"))  # type: ignore[arg-type]
    manager._services["other", "spawn"] = OfferedService.of(lambda who: served.append(who), "spawn", is_async=False)
    return manager


@pytest.mark.parametrize("make", [yarp, ros, ros2])
def test_a_tick_serves_one_long_request(make: Callable[[list[Any]], Any], served: list[Any]) -> None:
    manager = make(served)
    offer(manager, served)
    manager.main()
    assert len(served) == 1
    manager.main()  # no time has passed: the next request has to wait
    assert len(served) == 1


def test_another_service_of_ros_2_is_served_after_one_call_of_a_flood(
    served: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    manager = ros2(served)
    offer(manager, served)
    now = [100.0]
    monkeypatch.setattr("morse.core.clients.budgets.perf_counter", lambda: now[0] + LONG * len(served))
    for _ in range(4):
        now[0] += 1.0
        manager.main()
    assert "modest" in served[:10]


class Client:
    """A client of a WebSocket server."""

    def __init__(self) -> None:
        self.calls = 0

    def keep(self, *_: Any) -> None:
        """There is memory."""

    def release(self, *_: Any) -> None:
        """There is memory."""

    def answer(self, *_: Any) -> None:
        """Ignore the outcome."""

    def services_changed(self) -> None:
        """Ignore new services."""


def test_clients_of_a_websocket_are_served_in_turn(
    served: list[Any], tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    scene = tmp_path / "scene.py"
    scene.write_text(
        "from morse.builder import *\nrobot = FakeRobot()\nrobot.append(Pose())\n"
        "robot.add_default_interface('rosbridge')\n"
        "env = Environment('empty', fastmode=True)\nenv.configure_stream_manager('rosbridge', port=0)\n"
    )
    with morse.load(scene, sockets=True) as simulation:
        managers = simulation.context.services.request_managers().values()
        manager = next(found for found in managers if isinstance(found, RosbridgeRequestManager))
        offer(manager, served)
        manager.paths = {**manager.paths, "/simulation/spawn": ("simulation", "spawn")}
        greedy, modest = Client(), Client()
        for number in range(100):
            manager.call(greedy, number, "/simulation/spawn", b'["greedy"]')  # type: ignore[arg-type]
        manager.call(modest, 0, "/simulation/spawn", b'["modest"]')  # type: ignore[arg-type]
        now = [200.0]
        monkeypatch.setattr("morse.core.clients.budgets.perf_counter", lambda: now[0] + LONG * len(served))
        for _ in range(8):
            now[0] += 10 * LONG
            before = len(served)
            manager.main()
            assert len(served) - before <= 4
        assert "modest" in served[:4]
