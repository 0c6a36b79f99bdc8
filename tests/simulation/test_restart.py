"""A restart: what is created again, what ends, and what is kept."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import restart_parts as parts

from morse.simulation.loader import LoadError
from pymorse import MorseServiceFailed, MorseServicePreempted

SCENE = """
    from morse.builder.creator import ActuatorCreator, SensorCreator

    class Counter(SensorCreator):
        _classpath = "restart_parts.Counter"

    class Arm(ActuatorCreator):
        _classpath = "restart_parts.{arm}"

    robot = ATRV()
    counter = Counter()
    robot.append(counter)
    counter.alter("", classpath="restart_parts.Scale")
    arm = Arm()
    robot.append(arm)
    counter.add_stream("socket")
    arm.add_interface("socket")
    arm.add_overlay("socket", "restart_parts.Other")
    env = Environment("empty", fastmode=True)
    env.set_seed(7)
"""


@pytest.fixture(autouse=True)
def _forget() -> Iterator[None]:
    yield
    parts.events.clear()
    parts.Counter.broken = False


@pytest.fixture
def run(running: Callable[..., Any]) -> Any:
    return running(SCENE.format(arm="Arm"))


def test_every_component_is_made_anew(run: Any) -> None:
    simu = run.client
    simu.step(3)
    before = simu.robot.arm.which().result()
    simu.reset(seed=7)
    first, second = parts.of_kind(parts.Counter, "made")
    assert first is not second
    assert run.simulation.context.components["robot.counter"] is second
    assert simu.robot.arm.which().result() != before


def test_components_modifiers_and_overlays_end_once(load: Callable[..., Any]) -> None:
    simulation = load(SCENE.format(arm="Arm"))
    simulation.restart()
    simulation.restart(3)
    simulation.finalize_components()
    simulation.finalize_components()
    for kind, word in ((parts.Counter, "made"), (parts.Scale, "initialized")):
        made = parts.of_kind(kind, word)
        assert len(made) == 3
        assert parts.of_kind(kind, "finalized") == made
    assert len(parts.of_kind(parts.Other, "finalized")) == 3


def test_modifiers_work_on_the_new_components(run: Any) -> None:
    simu = run.client
    counter = simu.robot.counter
    counter.last()
    simu.step(5)
    assert counter.last()["count10"] == 50
    simu.reset(seed=7)
    simu.step(2)
    assert (counter.last()["count"], counter.last()["count10"]) == (2, 20)


def test_overlays_lie_over_the_new_components(run: Any) -> None:
    simu = run.client
    simu.reset(seed=7)
    assert simu.rpc("other", "which_arm") == simu.robot.arm.which().result()


def test_connections_and_ports_stay(run: Any) -> None:
    simu = run.client
    ports = simu.rpc("simulation", "get_all_stream_ports")
    counter, arm = simu.robot.counter, simu.robot.arm
    counter.last()
    arm.publish({"v": 1.0})
    simu.step()
    streams = counter.stream, arm.stream
    for seed in range(5):
        simu.reset(seed=seed)
        arm.publish({"v": 2.0 + seed})
        simu.step()
        assert counter.last()["count"] == 1
        assert run.simulation.context.components["robot.arm"].local_data["v"] == 2.0 + seed
    assert simu.rpc("simulation", "get_all_stream_ports") == ports
    assert all(stream.is_up() for stream in streams)


def test_messages_are_sent_once(run: Any) -> None:
    """Streams of deleted components send nothing."""
    simu = run.client
    received: list[Any] = []
    simu.robot.counter.subscribe(received.append)
    for seed in range(5):
        simu.reset(seed=seed)
    simu.step(4)
    deadline = time.monotonic() + 60.0
    while len(received) < 4 and time.monotonic() < deadline:
        time.sleep(0.001)
    simu.time()
    assert [message["count"] for message in received] == [1, 2, 3, 4]


def test_services_that_go_on_are_preempted(run: Any) -> None:
    simu = run.client
    going = [simu.robot.arm.reach(1.0), simu.call("time", "sleep", 10.0)]
    simu.reset(seed=7)
    for call in going:
        with pytest.raises(MorseServicePreempted):
            call.result(60)
    assert len(parts.of_kind(parts.Arm, "interrupted")) == 1
    # the new arm has no active service
    held = simu.robot.arm.hold()
    simu.time()
    assert not held.done()
    held.cancel()


def test_a_mistake_while_interrupting_stops_nothing(running: Callable[..., Any]) -> None:
    run = running(SCENE.format(arm="Clumsy"))
    simu = run.client
    going = simu.robot.arm.reach(1.0)
    simu.reset(seed=7)
    with pytest.raises(MorseServicePreempted):
        going.result(60)
    simu.step()
    assert simu.time() > 0.0


def test_what_cannot_be_made_again_ends_the_simulation_and_says_why(run: Any) -> None:
    simu = run.client
    parts.Counter.broken = True
    with pytest.raises(MorseServiceFailed, match=r"'robot\.counter'.*the device is in use"):
        simu.reset(seed=7)
    run.join()
    assert run.error is None
    assert run.simulation.failed


def test_a_restart_without_a_client(load: Callable[..., Any]) -> None:
    simulation = load(SCENE.format(arm="Arm"))
    parts.Counter.broken = True
    with pytest.raises(LoadError, match="the device is in use"):
        simulation.restart()


def test_a_simulation_that_ran_runs_on(run: Any) -> None:
    simu = run.client
    simu.resume()
    simu.sleep(0.1)
    simu.rpc("simulation", "reset")
    simu.sleep(0.1)
    assert simu.time() >= 0.1
