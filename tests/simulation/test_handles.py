"""The interface of pymorse for a simulation in the process."""

import gc
import re
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseBuilderError
from morse.core.validation.spec import CommandError
from pymorse import MorseServiceFailed, MorseServicePreempted
from tests.kit.programs import python


def scene() -> None:
    from morse.builder import ATRV, Environment, MotionVW, Pose, Sick
    from morse.builder.creator import ActuatorCreator

    class Arm(ActuatorCreator):
        _classpath = "restart_parts.Arm"

    robot = ATRV("robot")
    motion, pose, scan, arm = MotionVW("motion"), Pose("pose"), Sick("scan"), Arm("arm")
    pose.frequency(20)
    for part in (motion, pose, scan, arm):
        robot.append(part)
    for number in range(3):
        other = ATRV(f"m_{number:03d}" if number else "m")
        other.translate(4.0 * number + 4.0, 4.0)
    taken = ATRV("step")
    taken.translate(0.0, -6.0)
    Environment("empty", fastmode=True)


@pytest.fixture
def sim() -> Iterator[Any]:
    with morse.load(scene) as simulation:
        yield simulation


def test_a_command_moves_a_robot(sim: Any) -> None:
    sim.step(60)
    start = sim.robot.pose.data["x"]
    sim.robot.motion.publish({"v": 1.0})
    sim.step(60)
    assert sim.robot.pose.data["x"] - start == pytest.approx(1.0, abs=0.06)
    assert sim.time() == pytest.approx(2.0)
    assert sim.ticks == 120


@pytest.mark.parametrize(
    ("command", "text"),
    [
        ({"speed": 1.0}, r"robot\.motion: .*no field 'speed'"),
        ({"vv": 1.0}, "did you mean 'v'"),
        ({"v": "fast"}, "'v' is 'fast'"),
        ({"v": None}, "'v'"),
        ({"v": float("nan")}, "'v'"),
        ([1.0], "expected"),
        (None, "expected"),
    ],
)
def test_a_wrong_command_raises_where_it_is_given(sim: Any, command: Any, text: str) -> None:
    sim.robot.motion.publish({"v": 0.5})
    with pytest.raises(CommandError, match=text):
        sim.robot.motion.publish(command)
    sim.step()
    assert sim.robot.motion.data["v"] == 0.5


def test_words_of_the_other_kind_say_so(sim: Any) -> None:
    with pytest.raises(AttributeError, match="it is a sensor"):
        sim.robot.pose.publish({"x": 1.0})
    for word in ("get", "last"):
        with pytest.raises(AttributeError, match=r"it is an actuator: use publish"):
            getattr(sim.robot.motion, word)()
    with pytest.raises(AttributeError, match=r"robot\.pose has no 'dat'"):
        _ = sim.robot.pose.dat
    with pytest.raises(AttributeError, match=r"no robot 'robto'.*robot"):
        _ = sim.robto
    with pytest.raises(KeyError, match="pose"):
        sim.robot["pos"]


def test_data_are_copies_and_arrays_stay_arrays(sim: Any) -> None:
    sim.step(30)
    data = sim.robot.scan.data
    ranges = data["range_list"]
    assert isinstance(ranges, np.ndarray)
    ranges[:] = -1.0
    data["more"] = 1
    again = sim.robot.scan.data
    assert "more" not in again
    assert (np.asarray(again["range_list"]) >= 0.0).all()


def test_get_waits_for_the_next_measurement_and_last_keeps_them(sim: Any) -> None:
    pose = sim.robot.pose
    assert pose.last() is None
    assert pose.last(2) is None
    times = [pose.get()["timestamp"] for _ in range(3)]
    assert np.diff(times) == pytest.approx([0.05, 0.05])
    assert pose.last()["timestamp"] == times[-1]
    assert [message["timestamp"] for message in pose.last(2)] == times[:0:-1]
    sim.deactivate("robot.pose")
    assert pose.get(timeout=0.2) is None
    with pytest.raises(RuntimeError, match="not active"):
        pose.get()


def test_time_passes_for_who_waits_in_a_paused_simulation(sim: Any) -> None:
    sim.pause()
    sim.step(3)
    assert sim.ticks == 3
    assert sim.robot.pose.get(timeout=1.0) is not None
    assert sim.call("time", "sleep", 0.1).result() is None
    assert sim.paused


def test_subscribers_are_told_until_they_leave_and_after_a_restart(sim: Any) -> None:
    received: list[float] = []

    def take(message: dict[str, Any]) -> None:
        received.append(message["timestamp"])
        message.clear()

    sim.robot.pose.subscribe(take)
    sim.step(6)
    assert received == pytest.approx([1 / 60, 4 / 60])
    sim.restart()
    sim.step(3)
    assert received[2:] == pytest.approx([1 / 60])
    sim.restore(sim.save())
    sim.step(3)
    assert len(received) == 4
    sim.robot.pose.unsubscribe(take)
    sim.step(6)
    assert len(received) == 4


RUNS = [lambda sim: sim.step(10), lambda sim: sim.run(1.0, speed=float("inf"))]


@pytest.mark.parametrize("pose", [["1", "2", "0"], "120", [b"1", 2, 0], [True, 2, 0], [1, 2], 7, None, [[1], 2, 0]])
def test_a_pose_is_a_list_of_numbers(sim: Any, pose: Any) -> None:
    name = sim.robots[0]
    before = sim.pose_of(name, [0, 0, 0]), sim.state_hash()
    with pytest.raises(ValueError, match="numbers"):
        sim.place(name, pose)
    assert (sim.pose_of(name, [0, 0, 0]), sim.state_hash()) == before


@pytest.fixture
def strict() -> Iterator[Any]:
    with morse.load(scene, on_failure="raise") as simulation:
        yield simulation


def broken(_message: Any) -> None:
    raise AssertionError("the robot is not where it should be")


@pytest.mark.parametrize("run", RUNS)
def test_a_mistake_in_a_callback_is_raised_to_who_asks_for_it(strict: Any, run: Callable[[Any], object]) -> None:
    strict.robot.pose.subscribe(broken)
    with pytest.raises(AssertionError, match="not where it should be") as caught:
        run(strict)
    assert strict.ticks == 1
    assert caught.value.__notes__ == ["the callback broken failed in tick 1 of the simulation"]
    assert strict.robot.pose.component.active
    strict.robot.pose.unsubscribe(broken)
    run(strict)
    assert strict.ticks > 5


@pytest.mark.parametrize("run", RUNS)
def test_a_mistake_in_a_callback_removes_the_callback(
    sim: Any, run: Callable[[Any], object], caplog: pytest.LogCaptureFixture
) -> None:
    received: list[Any] = []
    sim.robot.pose.subscribe(broken)
    sim.robot.pose.subscribe(received.append)
    run(sim)
    assert sim.ticks >= 10
    assert len(received) >= 3
    (line,) = [one for one in caplog.messages if "the callback broken failed and is removed: AssertionError" in one]
    assert "test_handles.py" in line
    sim.robot.pose.unsubscribe(broken)


def test_time_cannot_be_told_to_pass_within_a_tick(strict: Any) -> None:
    strict.robot.pose.subscribe(lambda _: strict.step())
    with pytest.raises(RuntimeError, match="a tick is running"):
        strict.step()


# services -----------------------------------------------------------------------------------------


def test_services_that_are_done_at_once(sim: Any) -> None:
    future = sim.robot.motion.set_speed(1.0, 0.0)
    assert future.done()
    assert not future.running()
    assert not future.cancelled()
    assert future.result() is None
    assert future.exception() is None
    assert sim.rpc("simulation", "list_robots") == ["robot", "m", "m_001", "m_002", "step"]


def test_services_that_fail(sim: Any) -> None:
    with pytest.raises(MorseServiceFailed, match="has not been registered"):
        sim.rpc("robot.motion", "set_sped", 1.0)
    with pytest.raises(MorseServiceFailed, match="fast"):
        sim.robot.motion.set_speed("fast", 0.0)
    with pytest.raises(TypeError, match="set_speed"):
        sim.robot.motion.set_speed(1.0)
    with pytest.raises(MorseServiceFailed, match=r"robot\.nobody"):
        sim.rpc("robot.nobody", "stop")


def test_services_that_go_on(sim: Any) -> None:
    ended: list[Any] = []
    future = sim.call("time", "sleep", 0.5)
    future.add_done_callback(ended.append)
    assert future.running()
    with pytest.raises(TimeoutError):
        future.result(timeout=0.2)
    assert sim.time() == pytest.approx(0.2, abs=1 / 60)
    future.result()
    assert sim.time() == pytest.approx(0.5, abs=2 / 60)
    assert ended == [future]
    future.add_done_callback(ended.append)
    assert ended == [future, future]
    with pytest.raises(TimeoutError):
        sim.rpc_t(0.1, "time", "sleep", 5.0)


def test_services_that_are_interrupted(sim: Any) -> None:
    first = sim.robot.arm.reach(1.0)
    second = sim.robot.arm.reach(2.0)
    assert first.cancelled()
    with pytest.raises(MorseServicePreempted):
        first.result()
    assert second.cancel()
    assert not second.cancel()
    assert isinstance(second.exception(), MorseServicePreempted)
    held = sim.robot.arm.hold()
    with pytest.raises(MorseServiceFailed, match="already running 'hold'"):
        sim.robot.arm.hold()
    sim.cancel(held)
    assert held.cancelled()


def test_futures_compare_by_their_results(sim: Any) -> None:
    names = sim.call("simulation", "list_robots")
    assert names == ["robot", "m", "m_001", "m_002", "step"]
    assert names != []
    assert {names: 1}[names] == 1


# robots -------------------------------------------------------------------------------------------


def test_robots_that_a_loop_made_and_names_that_are_taken(caplog: pytest.LogCaptureFixture) -> None:
    with morse.load(scene) as sim:
        assert set(sim.robots) == {"robot", "m", "m_001", "m_002", "step"}
        assert [robot.fqn for robot in sim.ms] == ["m", "m_001", "m_002"]
        assert sim["step"].fqn == "step"
        sim.step()
        assert sim.ticks == 1
        assert "robot" in dir(sim)
        assert set(sim.robot.keys()) == {"motion", "pose", "scan", "arm"}
        assert "reach" in dir(sim.robot.arm)
    assert any("'step' already exists" in record.getMessage() for record in caplog.records)


# adding and removing ------------------------------------------------------------------------------


def sensing_robot() -> Any:
    from morse.builder import ATRV, MotionVW, Pose

    robot = ATRV()
    robot.append(MotionVW("motion"))
    robot.append(Pose("pose"))
    return robot


def test_robots_with_components_come_and_go(sim: Any) -> None:
    sim.step(5)
    handle = sim.spawn("late", sensing_robot, (10.0, 0.0, 0.1), (0.0, 0.0, 1.5))
    assert handle is sim.late
    sim.step(60)
    assert sim.late.pose.data["x"] == pytest.approx(10.0, abs=0.01)
    sim.late.motion.publish({"v": 1.0})
    sim.step(60)
    assert sim.late.pose.data["y"] == pytest.approx(1.0, abs=0.1)
    pose = sim.late.pose
    sim.delete("late")
    assert "late" not in sim.robots
    with pytest.raises(LookupError, match=r"late\.pose"):
        _ = pose.data
    with pytest.raises(LookupError, match=r"late\.pose"):
        pose.get()
    with pytest.raises(AttributeError, match="late"):
        _ = sim.late
    sim.step(5)


def test_a_restart_goes_back_to_who_was_there(sim: Any) -> None:
    wanted = sim.state_hash()
    sim.step(3)
    sim.spawn("late", sensing_robot, (10.0, 0.0, 0.1))
    sim.spawn("crate", "props/crates", (-5.0, 0.0, 1.0))
    sim.delete("m_001")
    sim.step(3)
    sim.restart()
    assert sim.state_hash() == wanted
    assert set(sim.robots) == {"robot", "m", "m_001", "m_002", "step"}
    with morse.load(scene) as fresh:
        for each in (sim, fresh):
            each.step(20)
        assert sim.state_hash() == fresh.state_hash()


def test_a_restore_lets_robots_come_and_go(sim: Any) -> None:
    empty = sim.save()
    sim.spawn("late", sensing_robot, (10.0, 0.0, 0.1))
    sim.spawn("crate", "props/crates", (-5.0, 0.0, 1.0))
    sim.step(10)
    full = sim.save()
    sim.step(10)
    wanted = sim.state_hash()
    sim.restore(empty)
    assert sim.state_hash() == empty.hash()
    assert "late" not in sim.robots
    sim.restore(full)
    assert sim.state_hash() == full.hash()
    sim.step(10)
    assert sim.state_hash() == wanted


def test_another_simulation_gets_who_came_by_the_name_of_a_kind(sim: Any) -> None:
    from morse.core.state import StateError

    sim.spawn("late", "ATRV", (10.0, 0.0, 0.1))
    sim.spawn("crate", "props/crates", (-5.0, 0.0, 1.0))
    sim.delete("m")
    sim.step(10)
    state = type(sim.save()).from_bytes(sim.save().to_bytes())
    with morse.load(scene) as other:
        other.restore(state)
        for each in (sim, other):
            each.step(10)
        assert sim.state_hash() == other.state_hash()
        before = other.state_hash()
        sim.spawn("made", sensing_robot, (20.0, 0.0, 0.1))
        with pytest.raises(StateError, match="'made' was created by a function"):
            other.restore(type(state).from_bytes(sim.save().to_bytes()))
        assert other.state_hash() == before


@pytest.mark.parametrize(
    ("name", "kind", "place", "text"),
    [
        ("robot", "ATRV", (0, 0, 0), "already"),
        ("new", "ATVR", (0, 0, 0), "ATRV"),
        ("new", "props/nothing", (0, 0, 0), "nothing"),
        ("new", "ATRV", (0, 0), "3 numbers"),
        ("new", "ATRV", (0, 0, float("nan")), "3 numbers"),
        ("new", "ATRV", (0, 0, "up"), "3 numbers"),
        ("new", lambda: 5, (0, 0, 0), "expected"),
        ("new", 5, (0, 0, 0), "kind"),
        ("a name.with.dots", "ATRV", (0, 0, 0), "name"),
        ("", "ATRV", (0, 0, 0), "name"),
        (5, "ATRV", (0, 0, 0), "name"),
    ],
)
def test_who_cannot_come_is_refused_and_nothing_changes(sim: Any, name: Any, kind: Any, place: Any, text: str) -> None:
    before = sim.state_hash()
    with pytest.raises((MorseBuilderError, ValueError, TypeError), match=text):
        sim.spawn(name, kind, place)
    assert sim.state_hash() == before
    for gone, hint in (("nobody", "nobody"), ("robot.nothing", "nothing")):
        with pytest.raises(MorseBuilderError, match=hint):
            sim.delete(gone)
    assert sim.state_hash() == before


@pytest.mark.parametrize("cycles", [30, pytest.param(200, marks=pytest.mark.slow)])
def test_memory_stays_where_it_was_after_many_came_and_went(sim: Any, cycles: int) -> None:
    def counted() -> int:
        gc.collect()
        return len(gc.get_objects())

    def cycle(number: int) -> None:
        sim.spawn(f"late{number}", sensing_robot, (10.0, 0.0, 0.1))
        sim.robot.motion.publish({"v": 0.1})
        sim[f"late{number}"].pose.last()
        sim.step()
        sim.robot.pose.last()
        sim.delete(f"late{number}")

    for number in range(10):
        cycle(number)
    before = counted()
    for number in range(cycles):
        cycle(number)
    # a robot with two components consists of hundreds of objects
    assert counted() - before < 1000


# the end ------------------------------------------------------------------------------------------


def test_a_closed_simulation_says_so() -> None:
    with morse.load(scene) as sim:
        pose, motion = sim.robot.pose, sim.robot.motion
        motion.publish({"v": 1.0})
        pose.subscribe(print)
        state = sim.save()
        future = sim.call("time", "sleep", 1.0)
    assert not sim.is_up()
    sim.close()
    words: list[Callable[[], object]] = [
        sim.step,
        sim.run,
        sim.save,
        sim.state_hash,
        sim.restart,
        lambda: sim.restore(state),
        lambda: sim.spawn("x", "ATRV"),
        lambda: sim.delete("robot"),
        lambda: sim.call("simulation", "list_robots"),
        lambda: motion.publish({"v": 2.0}),
        lambda: pose.data,
        pose.get,
        pose.last,
        lambda: pose.subscribe(print),
        lambda: sim.sleep(1.0),
        future.result,
    ]
    for word in words:
        with pytest.raises(RuntimeError, match="closed"):
            word()


def test_ctrl_c_ends_a_run_after_a_whole_tick(sim: Any) -> None:
    def press(_message: Any) -> None:
        if sim.ticks == 4:
            signal.raise_signal(signal.SIGINT)

    sim.robot.pose.subscribe(press)
    with morse.load(scene) as other:
        for run in (lambda: sim.run(speed=float("inf")), lambda: sim.step(1000)):
            sim.restart()
            with pytest.raises(KeyboardInterrupt):
                run()
            assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        other.step(4)
        assert other.state_hash() == sim.state_hash()
    sim.run(0.1, speed=float("inf"))
    assert sim.ticks == 10


def test_a_run_in_another_thread_is_not_disturbed_and_ends_when_it_is_closed() -> None:
    begun = threading.Event()
    failures: list[BaseException] = []

    def run() -> None:
        try:
            sim.run(speed=1.0)
        except BaseException as error:
            failures.append(error)

    with morse.load(scene) as sim:
        sim.robot.pose.subscribe(lambda _: begun.set())
        thread = threading.Thread(target=run)
        thread.start()
        assert begun.wait(60)
        with pytest.raises(RuntimeError, match="another thread"):
            sim.step()
    thread.join(60)
    assert not thread.is_alive()
    assert not failures


@pytest.mark.parametrize("duration", [-1.0, float("nan"), float("inf")])
def test_durations_that_are_none(sim: Any, duration: float) -> None:
    with pytest.raises(ValueError, match="duration"):
        sim.run(duration)
    with pytest.raises(ValueError, match="backwards"):
        sim.step(-1)
    with pytest.raises(ValueError, match="speed"):
        sim.run(1.0, speed=0.0)
    sim.run(0.0)
    assert sim.ticks == 0


def test_completion_offers_what_programs_call() -> None:
    def scene() -> None:
        from morse.builder import ATRV, Environment, MotionVW, Pose

        robot = ATRV("robot")
        robot.append(MotionVW("motion"))
        robot.append(Pose("pose"))
        Environment("empty")

    page = (Path(__file__).parents[2] / "docs" / "simulation-object.md").read_text(encoding="utf-8")
    with morse.load(scene) as sim:
        names, described = dir(sim), set(re.findall(r"\bsim\.([a-z_]+)\(", page))
        assert described - {"robot"} <= set(names)
        for name in set(names) - {"robot"}:
            assert hasattr(sim, name), name
        for name, handle in (("robot", sim.robot), ("motion", sim.robot.motion), ("pose", sim.robot.pose)):
            full = handle.fqn.replace(".", r"\.")
            assert set(re.findall(rf"\bsim\.{full}\.([a-z_]+)\(", page)) <= set(dir(handle))
            for one in dir(handle):
                assert hasattr(handle, one), (name, one)
        assert "publish" in dir(sim.robot.motion)
        assert "get" not in dir(sim.robot.motion)
        assert "get" in dir(sim.robot.pose)
        assert "publish" not in dir(sim.robot.pose)
        assert "data" not in dir(sim.robot)
        assert {"place", "restart", "pose"} <= set(dir(sim.robot))
    assert "step" in dir(sim)
    assert "robot" not in dir(sim)


@pytest.mark.parametrize(
    ("lines", "word"),
    [
        ("sim = morse.load(scene)\nsim.robo", "robo"),
        ("sim = morse.load(scene)\nsim.robot.pos", "pos"),
        ("ATRV().trnslate(1)", "trnslate"),
    ],
)
def test_a_name_is_suggested_once(lines: str, word: str) -> None:
    """Python adds a suggestion of its own to an `AttributeError` that ends a program."""
    text = "import morse\nfrom morse.builder import *\ndef scene():\n    robot = ATRV()\n    pose = Pose()\n"
    text += f"    robot.append(pose)\n    env = Environment('empty')\n{lines}\n"
    done = python("-c", text)
    last = done.stderr.strip().splitlines()[-1]
    assert f"'{word}'" in last
    assert last.casefold().count("did you mean") == 1
