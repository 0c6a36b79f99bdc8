"""The client and the server of this project together."""

import threading
from collections.abc import Iterator

import pytest
from socket_bench import Bench

from morse.core import status
from pymorse import Morse, MorseServiceFailed, MorseServicePreempted
from tests.kit.waiting import wait_until

DETAILS = {
    "robots": [
        {
            "name": "robot1",
            "type": "ATRV",
            "components": {
                "robot1.pose": {"type": "Pose", "stream_interfaces": [["socket", "OUT"]]},
                "robot1.motion": {
                    "type": "MotionVW",
                    "services": ["echo", "add", "nothing", "refuse", "goto"],
                    "stream_interfaces": [["socket", "IN"]],
                },
                "robot1.ros": {"type": "Pose", "stream_interfaces": [["ros", "OUT"]]},
                "robot1.mute": {"type": "Light"},
            },
        }
    ],
    "environment": "indoors-1/indoor-1",
}


@pytest.fixture
def ticking() -> Iterator[Bench]:
    bench = Bench()
    bench.sensor("robot1.pose", port=0)
    bench.actuator("robot1.motion", port=0)
    bench.requests.register_service("simulation", lambda: DETAILS, "details")
    thread = threading.Thread(target=_run, args=[bench])
    thread.start()
    yield bench
    bench.stopping = True
    thread.join(60)
    bench.close()


def test_a_program_that_has_waited_for_one_sensor_has_the_messages_of_all_of_the_tick() -> None:
    names = ["pose", *(f"sensor{n}" for n in range(6)), "gps"]
    bench = Bench()
    for name in names:
        bench.sensor(f"robot1.{name}", port=0)
    components = {f"robot1.{name}": {"type": "Pose", "stream_interfaces": [["socket", "OUT"]]} for name in names}
    details = {"robots": [{"name": "robot1", "type": "ATRV", "components": components}], "environment": ""}
    bench.requests.register_service("simulation", lambda: details, "details")
    thread = threading.Thread(target=_run, args=[bench])
    thread.start()
    try:
        with Morse("127.0.0.1", bench.requests.port) as simu:
            sensors = [simu.robot1[name] for name in names]
            for sensor in sensors:
                sensor.get(timeout=60)
            # each in turn: the simulation sends first what was created first
            for number in range(1000):
                time = sensors[number % len(sensors)].get(timeout=60)["timestamp"]
                # a program that is late finds later messages
                assert all(sensor.last()["timestamp"] >= time for sensor in sensors)
    finally:
        bench.stopping = True
        thread.join(60)
        bench.close()


def _run(bench: Bench) -> None:
    pause = threading.Event()
    while not bench.stopping:
        bench.tick()
        pause.wait(0.002)


def test_a_session(ticking: Bench) -> None:
    with Morse("127.0.0.1", ticking.requests.port) as simu:
        assert simu.robots == ["robot1"]
        assert set(simu.robot1) == {"pose", "motion", "ros", "mute"}
        pose = simu.robot1.pose.get(timeout=60)
        assert pose["temperature"] == 20.5
        assert simu.robot1.pose.get(timeout=60)["timestamp"] > pose["timestamp"]
        simu.robot1.motion.publish({"v": 1.5})
        motion = ticking.components[1]
        wait_until(lambda: motion.local_data["v"] == 1.5)
        assert simu.robot1.motion.echo({"a": [1, None, "ü"]}) == {"a": [1, None, "ü"]}
        assert simu.robot1.motion.echo(0).result(60) is None
        assert simu.robot1.motion.add(1) == 3
        with pytest.raises(TypeError, match="wrong # of parameters"):
            simu.robot1.motion.goto(1).result(60)
        with pytest.raises(MorseServiceFailed, match="some parameters are expected"):
            simu.robot1.motion.goto().result(60)
        with pytest.raises(MorseServiceFailed, match="not today"):
            simu.robot1.motion.refuse().result(60)
        going = simu.robot1.motion.goto(1, 2, 3)
        going.cancel()
        with pytest.raises(MorseServicePreempted):
            going.result(60)
        with pytest.raises(AttributeError, match="no stream on the socket"):
            simu.robot1.ros.get()


def test_what_is_published_last_is_not_lost(ticking: Bench) -> None:
    motion = ticking.components[1]
    for n in range(20):
        with Morse("127.0.0.1", ticking.requests.port) as simu:
            simu.robot1.motion.publish({"v": n + 0.5})
        wait_until(lambda n=n: motion.local_data["v"] == n + 0.5)


def test_closing_waits_for_a_service_that_goes_on(ticking: Bench) -> None:
    with Morse("127.0.0.1", ticking.requests.port) as simu:
        going = simu.robot1.motion.goto(1, 2, 3)
        wait_until(lambda: ticking.arm.running_service)
        threading.Timer(0.05, ticking.arm.completed, [status.SUCCESS, "Arrived"]).start()
    assert going.result(0) == "Arrived"


@pytest.fixture
def stepping() -> Iterator[Bench]:
    """Ticks only when a client requests it."""
    bench = Bench()
    asked = threading.Event()
    bench.context.wake = asked.set
    bench.context.paused = lambda: True
    bench.sensor("robot1.pose", port=0)
    bench.actuator("robot1.motion", port=0)
    pose, motion = bench.components
    # the sensor measures the command of the actuator
    pose.default_action = lambda: pose.local_data.__setitem__("temperature", motion.local_data["v"])
    bench.components.reverse()
    bench.requests.register_service("simulation", lambda: DETAILS, "details")

    def run() -> None:
        while not bench.stopping:
            asked.wait(0.1)
            asked.clear()
            bench.context.services.process()

    def step(n: int, tell_sent: bool = False) -> None:
        for component in bench.components:
            component.action()
        bench.context.clock.advance()
        bench.streams.flush()

    bench.requests.register_service("simulation", step, "step")
    thread = threading.Thread(target=run)
    thread.start()
    yield bench
    bench.stopping = True
    thread.join(60)
    bench.close()


def test_a_step_sees_what_was_published_before_it_and_its_data_is_there_after_it(stepping: Bench) -> None:
    with Morse("127.0.0.1", stepping.requests.port) as simu:
        pose, motion = simu.robot1.pose, simu.robot1.motion
        motion.publish({"v": 0.0})
        assert pose.last() is None
        wait_until(lambda: stepping.streams._servers["robot1.pose"].connected)
        for n in range(300):
            motion.publish({"v": n + 0.5})
            simu.step()
            assert pose.last()["temperature"] == n + 0.5
