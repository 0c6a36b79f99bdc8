"""The journal is one sequence of inputs with outcomes; a replay stops at the entry that does not fit."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

import morse
from morse.builder import ATRV, Environment, Morsy, MotionVW, Pose, Waypoint
from morse.core.exceptions import MorseError
from morse.core.journal import CANCEL, COMMAND, OUTCOME, RESET, RESTORE, SERVICE, SPAWN, Entry
from morse.core.state import NoReferences, StateError, Writer
from morse.recording.inputs import TOPIC, as_message
from morse.recording.mcap.reader import McapFile
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter
from morse.recording.recording import Recording
from morse.simulation import population
from morse.simulation.recordings.input_recording import InputRecording, entry_from_bytes, entry_to_bytes
from morse.simulation.recordings.timeline import SimulatedTimeline
from morse.simulation.simulation import Simulation
from morse.simulation.states.state import State
from morse.verification.resimulation import resimulate

SCRIPT = """
from morse.builder import *
robot = ATRV()
goto, pose = Waypoint("goto"), Pose("pose")
robot.append(goto)
robot.append(pose)
morsy = Morsy()
morsy.translate(0.0, 3.0, 0.2)
morsy.append(MotionVW("motion"))
Environment("empty")
"""


def scene() -> None:
    """A robot with a service that takes long, and a robot with commands."""
    robot = ATRV()
    goto, pose = Waypoint("goto"), Pose("pose")
    robot.append(goto)
    robot.append(pose)
    morsy = Morsy()
    morsy.translate(0.0, 3.0, 0.2)
    morsy.append(MotionVW("motion"))
    Environment("empty")


def going_at_a_restart(sim: Simulation) -> None:
    """A restart ends a service; a command follows at an earlier tick."""
    sim.step(3)
    sim.robot.goto.goto(3.0, 1.0, 0.0, 0.3, 1.0)
    sim.step(17)
    sim.restart()
    sim.step(5)
    sim.morsy.motion.publish({"v": 0.5})
    sim.step(10)


def going_at_a_restored_state(sim: Simulation) -> None:
    """The same with a restored state, and a service that goes on at the end."""
    sim.step(4)
    before = sim.save()
    sim.robot.goto.goto(3.0, 1.0, 0.0, 0.3, 1.0)
    sim.step(6)
    sim.restore(before)
    sim.morsy.motion.publish({"v": 0.5})
    sim.robot.goto.goto(-1.0, 1.0, 0.0, 0.3, 1.0)
    sim.step(10)


def cancelled_and_refused(sim: Simulation) -> None:
    """Of two calls, the second one ends the first one, and is cancelled; others are refused."""
    first = sim.robot.goto.goto(3.0, 1.0, 0.0, 0.3, 1.0)
    sim.step(6)
    second = sim.robot.goto.goto(2.0, -1.0, 0.0, 0.3, 1.0)
    sim.step(6)
    assert first.cancelled()
    second.cancel()
    for refused in (lambda: sim.spawn("morsy", "Morsy"), lambda: sim.delete("nobody"), lambda: sim.spawn("x", "Nope")):
        with pytest.raises(MorseError):
            refused()
    with pytest.raises(Exception, match="nobody"):
        sim.rpc("simulation", "restart_robot", "nobody")
    sim.step(4)


RUNS = [going_at_a_restart, going_at_a_restored_state, cancelled_and_refused]


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("before", [0, 7])
def test_a_run_with_running_services_is_the_same_again(
    run: Callable[[Simulation], None], before: int, tmp_path: Path
) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)
    with morse.load(script) as sim:
        sim.step(before)
        if before:
            sim.restart()
            sim.step(before)
        with sim.record(tmp_path / "run.mcap"), sim.record_inputs() as inputs:
            run(sim)
        wanted = sim.state_hash()
    inputs.write(tmp_path / "run.inputs")
    with morse.load(scene) as again:
        ticks: list[int] = []
        again.replay(InputRecording.read(tmp_path / "run.inputs"), lambda: ticks.append(again.ticks))
        assert again.state_hash() == wanted
        assert len(ticks) < 100
    with Recording(tmp_path / "run.mcap") as recording:
        outcome = resimulate(recording, trust=True)
    assert outcome.departure is None
    assert outcome.complete


def test_the_entries_are_one_sequence_with_outcomes() -> None:
    with morse.load(scene) as sim, sim.record_inputs() as inputs:
        going_at_a_restart(sim)
        call = sim.robot.goto.goto(0.1, 0.0, 0.0, 0.5, 1.0)
        call.result(30.0)
    assert [entry.order for entry in inputs.entries] == list(range(len(inputs.entries)))
    moments = [(entry.life, entry.tick) for entry in inputs.entries]
    assert moments == sorted(moments)
    kinds = [entry.kind for entry in inputs.entries]
    # what the restart has ended is no input
    assert kinds == [SERVICE, RESET, OUTCOME, COMMAND, SERVICE, OUTCOME]
    outcomes = {entry.content[0]: entry for entry in inputs.entries if entry.kind == OUTCOME}
    assert {order: (entry.content[1], entry.life) for order, entry in outcomes.items()} == {
        0: ("PREEMPTED", 0),
        4: ("SUCCESS", 1),
    }
    assert all(entry_from_bytes(entry_to_bytes(entry)) == entry for entry in inputs.entries)


def guest() -> Any:
    robot = Morsy()
    robot.append(Pose("pose"))
    return robot


@pytest.mark.parametrize(
    "spawn",
    [
        lambda sim: sim.spawn("guest", "Morsy", [1.0, 3.0, 0.2]),
        lambda sim: sim.spawn("guest", guest, [1.0, 3.0, 0.2]),
        lambda sim: sim.rpc("simulation", "spawn", "guest", "props/crates", [1.0, 3.0, 0.5]),
    ],
    ids=["a robot", "a function", "a model"],
)
def test_what_a_server_refused_is_refused_again_without_the_server(
    spawn: Callable[[Simulation], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)

    def refuses(*_: object) -> None:
        raise MorseError("the server refuses this name")

    def run(sim: Simulation) -> None:
        sim.morsy.motion.publish({"v": 0.4, "w": 0.2})
        sim.step(9)
        before = sim.state_hash()
        with monkeypatch.context() as patch:
            patch.setattr(population, "connect", refuses)
            with pytest.raises(Exception, match="refuses this name"):
                spawn(sim)
        assert sim.state_hash() == before
        sim.step(20)

    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        run(sim)
        wanted = sim.state_hash()
    with morse.load(script) as never:
        never.morsy.motion.publish({"v": 0.4, "w": 0.2})
        never.step(29)
        # what is refused leaves no trace
        assert never.state_hash() == wanted
    with Recording(tmp_path / "run.mcap") as recording:
        assert resimulate(recording, trust=True).departure is None


def take_the_name(sim: Simulation) -> None:
    """A robot that is spawned has the name of a deleted robot of the launch."""
    sim.delete("robot")
    sim.spawn("robot", "Morsy", [2.0, 0.0, 0.5])
    sim.step(3)


@pytest.mark.parametrize(
    "meanwhile",
    [
        lambda sim: sim.step(3),
        lambda sim: sim.restart(),
        lambda sim: sim.delete("robot"),
        lambda sim: sim.spawn("guest", "ATRV", [0.0, -3.0, 0.5]),
        lambda sim: (sim.delete("robot"), sim.spawn("robot", "ATRV", [0.0, 0.0, 0.5])),
    ],
    ids=["nothing", "a restart", "a deletion", "a guest", "another robot of that name"],
)
def test_a_state_whose_robot_has_the_name_of_a_deleted_one_is_restored(
    meanwhile: Callable[[Simulation], object], tmp_path: Path
) -> None:
    with morse.load(scene) as sim:
        first = sim.state_hash()
        sim.save(tmp_path / "first.state")
        take_the_name(sim)
        wanted = sim.state_hash()
        sim.save(tmp_path / "taken.state")
        for _ in range(2):
            meanwhile(sim)
            sim.restore(tmp_path / "taken.state")
            assert sim.state_hash() == wanted
        sim.restore(tmp_path / "first.state")
        assert sim.state_hash() == first
    with morse.load(scene) as another:
        another.restore(tmp_path / "taken.state")
        assert another.state_hash() == wanted


def test_a_state_brings_one_robot_back_while_another_one_goes() -> None:
    """Streams and services of a robot that goes end, also if another one comes back at the same time."""
    with morse.load(scene) as sim:
        order = list(sim.context.components)
        states, hashes = {}, {}
        for name in ("robot", "morsy"):
            begin = sim.save()
            sim.delete(name)
            sim.step(2)
            states[name], hashes[name] = sim.save(), sim.state_hash()
            sim.restore(begin)
        for number in range(4):
            name, other = ("robot", "morsy")[:: 1 - 2 * (number % 2)]
            sim.restore(states[name])
            assert sim.state_hash() == hashes[name]
            sim.step(3)
            assert not sim.failures
            assert list(sim.context.robots) == [other]
            assert list(sim.context.components) == [one for one in order if one.startswith(f"{other}.")]
        sim.restart()
        assert list(sim.context.components) == order


def test_the_order_of_components_is_that_of_the_launch_when_one_comes_back() -> None:
    with morse.load(scene) as sim:
        order, state = list(sim.context.components), sim.save()
        sim.delete("robot")
        sim.restore(state)
        assert list(sim.context.components) == order


def test_a_run_that_restores_such_a_state_is_the_same_again(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        take_the_name(sim)
        state = sim.save()
        sim.morsy.motion.publish({"v": 0.4, "w": 0.2})
        sim.step(5)
        sim.restore(state)
        sim.step(5)
    with Recording(tmp_path / "run.mcap") as recording:
        assert resimulate(recording, trust=True).departure is None


def crates_come_and_go(sim: Simulation) -> tuple[State, State]:
    """Return the states with the second of two crates, and with both."""
    for number, name in enumerate(("first", "second")):
        sim.spawn(name, "props/crates", [8.0, 4.0 * number, 0.5])
    sim.step(2)
    both = sim.save()
    sim.delete("first")
    sim.step(2)
    one = sim.save()
    sim.delete("second")
    return one, both


def test_the_names_of_parts_do_not_depend_on_what_else_is_there(tmp_path: Path) -> None:
    with morse.load(scene) as sim:
        one, both = crates_come_and_go(sim)
        sim.restore(one)
        assert {node.name for node in sim.scene.nodes() if "large_crate_mesh" in node.name} == {
            "second.large_crate_mesh"
        }
        wanted = sim.state_hash()
        sim.restore(both)
        sim.restore(one)
        assert sim.state_hash() == wanted
        sim.save(tmp_path / "one.state")
    with morse.load(scene) as another:
        another.restore(tmp_path / "one.state")
        assert another.state_hash() == wanted


def test_a_refused_restore_leaves_the_names_of_parts(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        begin = sim.save()
        one, _ = crates_come_and_go(sim)
        sim.restore(one)
        names = [node.name for node in sim.scene.nodes()]
        damaged = State({**begin.parts, "physics": begin.parts["clock"]}, begin.unsaved)
        with pytest.raises(StateError):
            sim.restore(damaged)
        assert [node.name for node in sim.scene.nodes()] == names
        sim.step(5)
    with Recording(tmp_path / "run.mcap") as recording:
        assert resimulate(recording, trust=True).departure is None


# -- recordings that do not fit --------------------------------------------------------------


def test_the_input_that_does_not_fit_is_named_before_those_that_follow(monkeypatch: pytest.MonkeyPatch) -> None:
    with morse.load(scene) as sim, sim.record_inputs() as inputs:
        sim.step(2)
        state = sim.save()
        sim.step(5)
        sim.restore(state)
        sim.morsy.motion.set_speed(0.2, 0.0)
        sim.step(2)
    with morse.load(scene) as again:

        def refuse(_: object) -> None:
            raise StateError("it is refused")

        monkeypatch.setattr(again.world, "check_state", refuse)
        with pytest.raises(StateError, match=r"restore.*it had an effect, and is refused now.*it is refused"):
            again.replay(inputs)


def happened(sim: Simulation) -> None:
    sim.morsy.motion.publish({"v": 0.5})
    sim.step(4)
    sim.spawn("guest", "Morsy", [3.0, 0.0, 0.2])
    sim.morsy.motion.set_speed(0.2, 0.0)
    sim.step(3)
    sim.restart()
    sim.step(2)
    sim.robot.goto.goto(3.0, 1.0, 0.0, 0.3, 1.0)
    sim.morsy.motion.publish({"v": 0.1})
    sim.step(3)


def recorded() -> InputRecording:
    with morse.load(scene) as sim, sim.record_inputs() as inputs:
        happened(sim)
    return inputs


def changed(inputs: InputRecording, which: str, number: int = 0, **values: Any) -> InputRecording:
    """Change an entry of a kind."""
    place = [index for index, entry in enumerate(inputs.entries) if entry.kind == which][number]
    inputs.entries[place] = inputs.entries[place]._replace(**values)
    return inputs


def swapped(inputs: InputRecording) -> InputRecording:
    inputs.entries[0], inputs.entries[1] = inputs.entries[1], inputs.entries[0]
    return inputs


def added(inputs: InputRecording, *entries: Entry) -> InputRecording:
    inputs.entries.extend(entries)
    return inputs


def said(inputs: InputRecording, order: int, status: str, result: object = None, **values: Any) -> Entry:
    """An outcome of an input."""
    (entry,) = [entry for entry in inputs.entries if entry.order == order]
    return entry._replace(kind=OUTCOME, content=(order, status, result), order=99, **values)


MISFITS: dict[str, tuple[Callable[[InputRecording], InputRecording], str]] = {
    "swapped": (swapped, r"input 0 \(command morsy.motion, tick 0\): it comes after input 1"),
    "a tick of the past": (
        lambda r: changed(r, SERVICE, tick=2),
        r"set_speed of morsy.motion, tick 2\): it comes after",
    ),
    "a negative tick": (lambda r: changed(r, COMMAND, tick=-1), "too late"),
    "a life without a restart": (lambda r: changed(r, COMMAND, 1, life=2), "too late: the run is at tick"),
    "after the end": (lambda r: changed(r, COMMAND, 1, tick=10**15), "the recording ends at tick 5"),
    "after the end of a life": (lambda r: changed(r, SPAWN, tick=9), "comes after|too late"),
    "two outcomes": (lambda r: added(r, said(r, 2, "SUCCESS"), said(r, 2, "FAILED")), "two outc"),
    "refused, but it was not": (
        lambda r: added(r, said(r, 2, "FAILED", "no")),
        "its outcome was FAILED.*, and is SUCC",
    ),
    "ended, but it was not": (lambda r: added(r, said(r, 2, "PREEMPTED")), "its outcome was PREEMPTED, and is SUCC"),
    "another result": (lambda r: added(r, said(r, 2, "SUCCESS", 5)), "its result was 5, and is None now"),
    "a later outcome": (lambda r: added(r, said(r, 2, "SUCCESS", tick=5)), "ended at tick 5, and ends at tick 4 now"),
    "a service that goes on": (lambda r: added(r, said(r, 4, "SUCCESS", tick=4)), "ended at tick 4, and goes on now"),
    "an object that exists": (lambda r: changed(r, SPAWN, name="morsy"), "had an effect, and is refused now.*already"),
    "no such actuator": (lambda r: changed(r, COMMAND, 1, name="morsy.wings"), "no active actuator of that name"),
    "no actuator": (lambda r: changed(r, COMMAND, 1, name="robot.pose"), "no active actuator of that name"),
    "an unknown kind": (lambda r: changed(r, COMMAND, 1, kind="dance"), "no such kind"),
    "a restored state": (
        lambda r: changed(r, RESET, kind=RESTORE, content="nothing"),
        "had an effect, and is refused now",
    ),
}


@pytest.mark.parametrize("misfit", MISFITS)
def test_a_replay_stops_with_the_entry_that_does_not_fit(misfit: str) -> None:
    change, message = MISFITS[misfit]
    ticks: list[int] = []
    with morse.load(scene) as sim, pytest.raises(StateError, match=message):
        sim.replay(change(recorded()), lambda: ticks.append(sim.ticks))
    assert len(ticks) < 20


@pytest.mark.parametrize("misfit", [name for name in MISFITS if name != "a restored state"])
def test_a_recording_that_does_not_fit_is_different_and_names_the_entry(misfit: str, tmp_path: Path) -> None:
    """The same entries in a file: they are replaced, and the file is no larger."""
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        happened(sim)
    change, message = MISFITS[misfit]
    with McapFile(tmp_path / "run.mcap") as file, (tmp_path / "forged.mcap").open("wb", buffering=0) as target:
        writer = McapWriter(target)
        for name, table in file.metadata.items():
            writer.metadata(name, table)
        for name in file.attachments:
            writer.attachment(name, "", file.attachment(name) or b"")
        for channel in file.channels.values():
            writer.channel(channel.topic, writer.schema(channel.type, channel.definition), {})
        (inputs,) = [channel.number for channel in file.channels.values() if channel.topic == TOPIC]
        others = [one for one in file if one.channel != inputs]
        entries = change(recorded()).entries
        writer.chunk(
            [
                *others,
                *(
                    Message(inputs, entry.tick & 0xFFFF, order, order, as_message(entry, entry_to_bytes, pytest.fail))
                    for order, entry in enumerate(entries)
                ),
            ]
        )
        writer.finish()
    with Recording(tmp_path / "forged.mcap") as recording:
        outcome = resimulate(recording, trust=True)
    assert outcome.departure is not None
    assert re.search(message, f"{outcome.departure.what}: {outcome.departure.how}")
    assert outcome.ticks < 20


def test_a_recording_that_claims_to_last_for_ages_ends_where_its_messages_end(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCRIPT)
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        happened(sim)
    with Recording(tmp_path / "run.mcap") as recording:
        recording.end["tick"] = str(10**15)
        outcome = resimulate(recording, trust=True)
    assert outcome.departure is not None
    assert "no further message" in outcome.departure.how
    assert outcome.ticks == 13


def test_a_page_of_inputs_that_do_not_fit_ends_there(caplog: pytest.LogCaptureFixture) -> None:
    with morse.load(scene) as sim:
        timeline = SimulatedTimeline(sim, changed(recorded(), COMMAND, 1, name="morsy.wings"), 12)
        for _ in range(20):
            if not timeline.at_end:
                timeline.forward()
        assert timeline.position == timeline.length == 9
        # before that, it can be gone through
        while not timeline.approach(3):
            pass
        assert sim.ticks == 3
    assert "no active actuator of that name" in caplog.text


def test_a_recorded_refusal_is_not_tried() -> None:
    with morse.load(scene) as sim:
        inputs = recorded()
        sim.replay(added(inputs, said(inputs, 1, "FAILED", "the server refuses this name")))
        assert sim.robots == ["robot", "morsy"]


@pytest.mark.parametrize(
    "content",
    [
        [0, "service", "morsy.motion", 5, None, 0, 0],
        [0, "service", "morsy.motion", ["list", ["set_speed"]], None, 0, 0],
        [0, "spawn", "guest", None, None, 0, 0],
        [0, "controls", "", ["list", [1, 2]], None, 0, 0],
        [0, "outcome", "", ["list", [0, "FINE", None]], None, 0, 0],
        [0, "outcome", "", ["list", ["x", "FAILED", None]], None, 0, 0],
        [0, "reset", "", "now", None, 0, 0],
        [0, "cancel", "", ["list", [1]], None, 0, 0],
        [0, "command", "morsy.motion", {"v": 1.0}, None, "first", 0],
        [0, "command", "morsy.motion", ["dict", []], None, 0],
        [None, "command", "morsy.motion", ["dict", []], None, 0, 0],
    ],
)
def test_entries_without_their_form_are_refused(content: list[object]) -> None:
    with pytest.raises(StateError, match="damaged"):
        entry_from_bytes(msgspec.msgpack.encode(content))


# -- recordings of earlier versions ------------------------------------------------------------


def as_before(inputs: InputRecording, path: Path) -> None:
    """Write a file as MORSE 2.0 did: without outcomes, lives and numbers, and with what a restart has cancelled."""
    entries: list[list[object]] = []
    plain = Writer(NoReferences()).value
    for entry in inputs.entries:
        content = entry.content.to_bytes() if entry.kind == RESTORE else entry.content
        content = content[0] if entry.kind == CANCEL else content
        if entry.kind != OUTCOME:
            ends = [] if entry.until is None else [entry.until]
            entries.append([entry.tick, entry.kind, entry.name, plain(content), *ends])
        if entry.kind in (RESET, RESTORE):
            entries.append([entry.tick, CANCEL, "robot.goto", plain("goto")])
    head = [inputs.seed, None, inputs.last, plain(inputs.waiting)]
    path.write_bytes(b"MORSE inputs 1\n" + msgspec.msgpack.encode([head, entries]))


@pytest.mark.parametrize("run", RUNS)
def test_recordings_of_earlier_versions_are_read(run: Callable[[Simulation], None], tmp_path: Path) -> None:
    with morse.load(scene) as sim:
        with sim.record_inputs() as inputs:
            run(sim)
        wanted = sim.state_hash()
    as_before(inputs, tmp_path / "old.inputs")
    with morse.load(scene) as again:
        ticks: list[int] = []
        again.replay(InputRecording.read(tmp_path / "old.inputs"), lambda: ticks.append(again.ticks))
        assert again.state_hash() == wanted
        assert len(ticks) < 100
