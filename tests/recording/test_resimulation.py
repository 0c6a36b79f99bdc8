"""A recorded run is simulated again: it is equal, or the first difference is reported."""

import json
import math
from pathlib import Path

import pytest
from recorded import SCRIPT, drive

import morse
from morse.core.exceptions import MorseError
from morse.kernel import threads
from morse.recording.errors import RecordingError
from morse.recording.mcap import records
from morse.recording.mcap.reader import McapFile
from morse.recording.mcap.writer import McapWriter
from morse.recording.recording import Recording
from morse.rosmsgs.cdr import decode, encode
from morse.simulation.simulation import Simulation
from morse.verification.resimulation import largest_difference, resimulate


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "scene.py"
    path.write_text(SCRIPT)
    return path


def busy(sim: Simulation) -> None:
    """Inputs of every kind that a file can contain."""
    drive(sim, ticks=40)
    sim.set_controls(frozenset(["ArrowUp"]))
    before = sim.save()
    sim.spawn("guest", "Morsy", [-3.0, 0.0, 0.2])
    sim.step(7)
    sim.restore(before)
    sim.step(5)
    sim.restart(11)
    drive(sim, ticks=30)
    sim.deactivate("robot.motion")
    sim.robot.motion.publish({"v": 0.3})
    sim.step(3)


@pytest.mark.parametrize("before", [0, 25])
def test_a_run_is_the_same_again(script: Path, tmp_path: Path, before: int) -> None:
    with morse.load(script, seed=5) as sim:
        if before:
            drive(sim, before)
        with sim.record(tmp_path / "run.mcap"):
            busy(sim)
    with Recording(tmp_path / "run.mcap") as recording:
        outcome = resimulate(recording, trust=True)
    assert outcome.departure is None
    assert outcome.complete
    assert outcome.ticks == 40 + 7 + 5 + 33
    assert outcome.messages > 3 * outcome.ticks


@pytest.mark.parametrize("more", ["robot.append(Arucomarker('part'))", "person = Human()\nperson.translate(x=0.2)"])
def test_parts_that_move_only_after_the_first_tick_are_recorded_and_the_same_again(tmp_path: Path, more: str) -> None:
    script = tmp_path / "parts.py"
    script.write_text(f"from morse.builder import *\nrobot = ATRV()\n{more}\nEnvironment('empty')\n")
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        sim.step(3)
        moving = [node.name for node, _ in sim.world.moving_nodes()]
        before = sim.save()
        sim.restart()
        sim.step(2)
        sim.restore(before)
        sim.step()
        assert [node.name for node, _ in sim.world.moving_nodes()] == moving
    with Recording(tmp_path / "run.mcap") as recording:
        (nodes,) = recording.topic_numbers("/morse/nodes")
        last = [decode("std_msgs/msg/String", one.data)["data"] for one in recording.messages({nodes})][-1]
        assert json.loads(last) == moving
        assert resimulate(recording, trust=True).departure is None


def test_from_inputs_alone_everything_is_recorded_again(script: Path, tmp_path: Path) -> None:
    with (
        morse.load(script, seed=5) as sim,
        sim.record(tmp_path / "lean.mcap", sensors=[]),
        sim.record(tmp_path / "whole.mcap"),
    ):
        busy(sim)
    with Recording(tmp_path / "lean.mcap") as recording:
        assert {recording.channels[one.channel].topic for one in recording} <= {
            "/morse/inputs",
            "/morse/made",
            "/rosout",
        }
        assert recording.length() == 40 + 7 + 5 + 33
        outcome = resimulate(recording, trust=True, record=str(tmp_path / "again.mcap"))
    assert outcome.complete
    assert outcome.departure is None
    contents = []
    for name in ("whole", "again"):
        with Recording(tmp_path / f"{name}.mcap") as file:
            topics = {number: channel.topic for number, channel in file.channels.items()}
            contents.append([(topics[m.channel], *m[1:]) for m in file if topics[m.channel].startswith("/robot/")])
    assert contents[0] == contents[1]
    assert len(contents[0]) > 100


def test_a_recording_that_breaks_off_is_compared_as_far_as_it_goes(script: Path, tmp_path: Path) -> None:
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        drive(sim)
    data = (tmp_path / "run.mcap").read_bytes()
    # the end is metadata, which follows the last chunk
    (tmp_path / "part.mcap").write_bytes(data[: data.index(b"morse end")])
    with Recording(tmp_path / "part.mcap") as recording:
        outcome = resimulate(recording, trust=True)
    assert outcome.departure is None
    assert not outcome.complete
    assert outcome.ticks == 60


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("gaussian=0.01", "gaussian=0.02", "/robot/pose"),
        ("0.3, 0.0, 0.9", "0.3, 0.0, 0.8", "/tf_static"),
        ("pose, scan = MotionVW(), Pose(), Sick()", "pose, scan = MotionVW(), Pose(), Hokuyo()", "/robot/scan"),
    ],
)
def test_the_first_departure_is_named(script: Path, tmp_path: Path, old: str, new: str, what: str) -> None:
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        drive(sim, 30)
    other = tmp_path / "other.py"
    other.write_text(SCRIPT.replace(old, new))
    with Recording(tmp_path / "run.mcap") as recording:
        outcome = resimulate(recording, str(other))
    assert outcome.departure is not None
    assert outcome.departure.what == what
    assert outcome.departure.tick == 1


@pytest.mark.parametrize(
    ("kind", "by", "is_equal"),
    [("another kind", 1e-9, True), ("another kind", 1e-3, False), ("", 1e-9, False)],
)
def test_rounding_is_accepted_of_another_kind_of_processor(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, by: float, is_equal: bool
) -> None:
    with monkeypatch.context() as patch:
        if kind:
            patch.setattr(threads, "kind", lambda: kind)
        with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
            drive(sim, 30)
    moved = tmp_path / "moved.py"
    moved.write_text(SCRIPT.replace("robot = ATRV()", f"robot = ATRV()\nrobot.translate(x={by})"))
    with Recording(tmp_path / "run.mcap") as recording:
        outcome = resimulate(recording, str(moved))
    assert outcome.elsewhere == (f"processor {kind}, here {threads.kind()}" if kind else "")
    assert (outcome.departure is None) is is_equal
    if is_equal:
        assert outcome.rounding is not None
        assert outcome.messages > 30
        assert by / 2 < float(outcome.rounding.how.split(", ")[1]) < 100 * by


def test_a_word_that_differs_is_no_rounding() -> None:
    def message(text: str, level: float) -> bytes:
        return encode("sensor_msgs/msg/BatteryState", {"serial_number": text, "voltage": level})

    kind, was = "sensor_msgs/msg/BatteryState", message("one", 1.0)
    assert largest_difference(kind, was, message("one", 1.5)) == ("voltage", 0.5)
    assert largest_difference(kind, was, message("two", 1.0)) == ("serial_number", math.inf)
    assert largest_difference(kind, was, message("one", math.nan)) == ("voltage", math.inf)
    assert largest_difference(kind, was, was) == ("", 0.0)


def test_a_message_that_was_changed_is_found_with_its_tick_and_field(script: Path, tmp_path: Path) -> None:
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        drive(sim, 30)
    changed = tmp_path / "changed.mcap"
    with McapFile(tmp_path / "run.mcap") as file, changed.open("wb", buffering=0) as target:
        writer = McapWriter(target)
        for name, table in file.metadata.items():
            writer.metadata(name, table)
        for name in file.attachments:
            writer.attachment(name, "", file.attachment(name) or b"")
        for channel in file.channels.values():
            writer.channel(channel.topic, writer.schema(channel.type, channel.definition), {})
        (pose,) = [c.number for c in file.channels.values() if c.topic == "/robot/pose"]
        messages = []
        for one in file:
            if one.channel == pose and one.sequence == 17:
                # encapsulation, stamp, length of "map" with its zero, padding: x is the first number at a multiple of 8
                at = 4 + 8 + 4 + 4
                at += -(at - 4) % 8
                one = one._replace(data=one.data[:at] + bytes(8) + one.data[at + 8 :])
            messages.append(one)
        writer.chunk(messages)
        writer.finish()
    with Recording(changed) as recording:
        outcome = resimulate(recording, trust=True)
    assert outcome.departure is not None
    assert (outcome.departure.tick, outcome.departure.what) == (17, "/robot/pose")
    assert outcome.departure.how.startswith("pose.pose.position.x was 0.0, is ")


def test_a_script_that_was_changed_since_is_taken_from_the_recording(script: Path, tmp_path: Path) -> None:
    with morse.load(script) as sim, sim.record(tmp_path / "run.mcap"):
        drive(sim, 30)
    remarks: list[str] = []
    for change in (lambda: script.write_text("raise SystemExit"), script.unlink):
        change()
        with Recording(tmp_path / "run.mcap") as recording, pytest.raises(RecordingError, match="--trust"):
            resimulate(recording)
        with Recording(tmp_path / "run.mcap") as recording:
            assert resimulate(recording, say=remarks.append, trust=True).departure is None
    assert len([one for one in remarks if "the recorded script is used" in one]) == 2
    # what is executed is shown
    assert len([one for one in remarks if "executes the script inside the recording" in one]) == 2
    assert any("| robot = ATRV()" in one for one in remarks)


def test_what_cannot_be_simulated_again_says_why(script: Path, tmp_path: Path) -> None:
    from recorded import scene

    with morse.load(scene) as sim, sim.record(tmp_path / "function.mcap"):
        sim.step()
    with Recording(tmp_path / "function.mcap") as recording, pytest.raises(RecordingError, match="--scene PATH"):
        resimulate(recording)
    plain = tmp_path / "plain.mcap"
    with plain.open("wb", buffering=0) as file:
        McapWriter(file).finish()
    with pytest.raises(RecordingError, match="no recording of a run of MORSE"):
        Recording(plain)


@pytest.mark.parametrize(
    "facts",
    [
        {"seed": "many", "tick": "0"},
        {"seed": "1" * 5000, "tick": "0"},
        {"seed": "0", "tick": "5"},
        {"seed": "0", "tick": "0", "arguments": "[1, 2]"},
        {"seed": "0", "tick": "0", "arguments": "[" * 100_000},
        {"seed": "0", "tick": "0", "script": "/nowhere/scene.py"},
    ],
)
def test_damaged_facts_are_refused(tmp_path: Path, facts: dict[str, str]) -> None:
    path = tmp_path / "bad.mcap"
    with path.open("wb", buffering=0) as file:
        writer = McapWriter(file)
        writer.metadata("morse", facts)
        number = writer.channel("/morse/inputs", writer.schema("std_msgs/msg/String", "string data"), {})
        writer.chunk([records.Message(number, 0, 0, 0, b"\x00\x01\x00\x00\x03\x00\x00\x00{}\x00")] * 2)
        writer.finish()
    with Recording(path) as recording, pytest.raises(MorseError, match=r"bad\.mcap|input"):
        resimulate(recording, trust=True)
