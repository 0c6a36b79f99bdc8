"""Recordings that name programs, arguments, places, modules and models: nothing of that is executed or imported.

Without ``--trust``, a recorded run is shown, filmed, exported and simulated again without a program of the file.
"""

import json
import os
import subprocess
import sys
import timeit
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zstandard

import morse
from morse.core.journal import SPAWN, Entry
from morse.recording.errors import RecordingError
from morse.recording.inputs import TOPIC, as_message
from morse.recording.made import reading
from morse.recording.made.reading import RecordedMade
from morse.recording.mcap.reader import McapFile
from morse.recording.mcap.writer import McapWriter
from morse.recording.recording import Recording
from morse.simulation.recordings.input_recording import entry_to_bytes

SCENE = """
from morse.builder import *

robot = ATRV()
motion, pose = MotionVW(), Pose()
pose.alter("NED")
robot.append(motion)
robot.append(pose)
Environment("empty", fastmode=True)
"""
#: a scene script that leaves a trace
EVIL = SCENE + "\nimport os\nos.system('touch PWNED')\n"
HARM = "raise SystemExit('imported')\n"
COMMAND = ["-n", "1", "-r", "1", "__import__('os').system('touch PWNED')"]
LINE = ["--size", "32x24", "--rate", "1", "--length", "0.1", "-o", "film.gif"]
AUDITOR = Path(__file__).with_name("recording_auditor.py")


class Received:
    """A folder with recordings of a stranger, and a home with a registered project.

    Attributes:
        folder: the working directory, in which archives are unpacked.
        project: a registered project.
        run: an honest recording.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.home, self.project = folder / "received", folder / "home", folder / "mine"
        self.run, lean = self.folder / "run.mcap", self.folder / "lean.mcap"
        for place in (self.folder / "sub", self.home / ".morse", self.project / "unpacked"):
            place.mkdir(parents=True)
        (self.home / ".morse" / "config").write_text(f"[sites]\nmine = {self.project}\nhere = {self.folder}\n")
        author = folder / "author.py"
        author.write_text(SCENE)
        with morse.load(author) as sim, sim.record(self.run), sim.record(lean, sensors=[]):
            sim.robot.motion.publish({"v": 1.0})
            sim.spawn("guest", "Morsy", (3.0, 0.0, 0.2))
            sim.step(6)
        for place in (self.folder, self.folder / "sub", self.project / "unpacked"):
            (place / "evil.py").write_text(EVIL)
        (self.project / "evil_setup.py").write_text("import os\nos.system('touch PWNED')\n")
        (self.project / "evil_link.py").symlink_to(self.folder / "evil.py")
        (self.folder / "harm.py").write_text(HARM)
        (self.folder / "evil.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")

    def forged(self, name: str, source: Path | None = None, **changes: Any) -> str:
        """A changed copy of a recording."""
        rewritten(self.run if source is None else source, self.folder / name, **changes)
        return name

    def read(self, *commands: list[str]) -> list[dict[str, Any]]:
        """What is seen while commands read recordings."""
        # the folders of scripts may not be on the path of the process
        environment = {**os.environ, "HOME": str(self.home), "PYTHONPATH": ""}
        done = subprocess.run(
            [sys.executable, AUDITOR, json.dumps(commands)],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=280,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return [json.loads(line) for line in done.stdout.splitlines()]

    def traces(self) -> list[Path]:
        """The files that executed programs have left."""
        return [one for place in (self.folder, self.project) for one in place.rglob("PWNED")]


def rewritten(
    source: Path,
    target: Path,
    facts: dict[str, str] | None = None,
    attachments: dict[str, bytes] | None = None,
    without: Iterable[str] = (),
    entries: Iterable[Entry] = (),
) -> None:
    """Write a copy with other facts, attachments and inputs, and without the attachments of some prefixes."""
    with McapFile(source) as file, target.open("wb", buffering=0) as stream:
        writer = McapWriter(stream)
        for name, table in file.metadata.items():
            writer.metadata(name, {**table, **(facts or {})} if name == "morse" else table)
        kept = {name: file.attachment(name) or b"" for name in file.attachments if not name.startswith(tuple(without))}
        for name, data in (kept | (attachments or {})).items():
            writer.attachment(name, "", data)
        for channel in file.channels.values():
            writer.channel(channel.topic, writer.schema(channel.type, channel.definition), {})
        (inputs,) = [channel.number for channel in file.channels.values() if channel.topic == TOPIC]
        messages = list(file)
        first = next(one for one in messages if one.channel == inputs)
        data = [as_message(entry, entry_to_bytes, pytest.fail) for entry in entries]
        writer.chunk([*(first._replace(data=one) for one in data), *messages])
        writer.finish()


def unpacked(path: Path, name: str) -> Any:
    with McapFile(path) as file:
        return msgspec.msgpack.decode(zstandard.ZstdDecompressor().stream_reader(file.attachment(name) or b"").read())


def packed(value: Any) -> bytes:
    return zstandard.ZstdCompressor().compress(msgspec.msgpack.encode(value))


def uses(name: str) -> list[list[str]]:
    """Every command that reads a recording, without ``--trust``."""
    return [
        ["show", name],
        ["replay", name, "--resimulate"],
        ["replay", name, "--resimulate", "--record", f"again-{name}"],
        ["export", name, "--csv", "--to", f"tables-{name}"],
        ["export", name, "--mcap", "-o", f"whole-{name}"],
        ["export", name, "--film", *LINE],
    ]


@pytest.fixture(scope="module")
def received(tmp_path_factory: pytest.TempPathFactory) -> Received:
    return Received(tmp_path_factory.mktemp("hostile"))


def _timeit(_: Received) -> tuple[str, bytes]:
    return timeit.__file__, Path(timeit.__file__).read_bytes()


def _at(place: str) -> Callable[[Received], tuple[str, bytes]]:
    """A script at a place, whose content the sender knows."""

    def named(received: Received) -> tuple[str, bytes]:
        script = place.format(folder=received.folder, project=received.project)
        path = received.folder / script
        return script, path.read_bytes() if path.is_file() else EVIL.encode()

    return named


PLACES: dict[str, Callable[[Received], tuple[str, bytes]]] = {
    "a program of the system": _timeit,
    "the working directory by /proc": _at("/proc/self/cwd/evil.py"),
    "another root of /proc": _at("/proc/self/root{folder}/evil.py"),
    "a descriptor": _at("/dev/fd/0"),
    "a relative path": _at("evil.py"),
    "beside the recording, in a registered folder": _at("{folder}/evil.py"),
    "below the recording": _at("{folder}/sub/evil.py"),
    "through another folder": _at("{project}/unpacked/../../received/evil.py"),
    "unpacked in a registered project": _at("{project}/unpacked/evil.py"),
    "another program of a registered project": _at("{project}/evil_setup.py"),
    "a link in a registered project": _at("{project}/evil_link.py"),
}
#: recordings that describe their scene, recordings of earlier versions, and recordings of the inputs alone
KINDS: dict[str, dict[str, Any]] = {"new": {}, "old": {"without": ["scene/"]}, "lean": {"without": ["scene/"]}}


@pytest.mark.parametrize("kind", KINDS)
def test_no_program_is_executed_that_a_recording_names(received: Received, kind: str) -> None:
    commands = []
    for number, place in enumerate(PLACES.values()):
        script, content = place(received)
        facts = {"script": script, "arguments": json.dumps(COMMAND), "source_paths": json.dumps([str(received.folder)])}
        source = received.folder / ("lean.mcap" if kind == "lean" else "run.mcap")
        name = f"{kind}-{number}.mcap"
        received.forged(name, source, facts=facts, attachments={"scene.py": content}, **KINDS[kind])
        commands += uses(name)
    outcomes = received.read(*commands)
    for words, outcome in zip(commands, outcomes, strict=True):
        assert outcome["seen"] == [], words
        assert "Traceback" not in outcome["error"], words
        # a recording that describes its scene is shown; all others name the mend
        refused = words[1] == "--resimulate" or "--resimulate" in words or not words[1].startswith("new")
        if words[0] == "show" or "--film" in words or "--resimulate" in words:
            assert outcome["status"] == int(refused), (words, outcome["error"])
            assert "--scene PATH" in outcome["error"] or not refused, (words, outcome["error"])
        else:
            assert outcome["status"] == 0, (words, outcome["error"])
    assert received.traces() == []


def test_no_module_is_imported_that_a_description_names(received: Received) -> None:
    commands = []
    for source in ("run.mcap", "lean.mcap"):
        objects = unpacked(received.folder / source, "scene/objects")
        guest = unpacked(received.folder / source, "made/0")
        for form in (objects, guest):
            for component in form["components"]:
                component["classes"] = ["harm.Robot", "harm:Robot", "timeit.Timer", *component["classes"]]
                component["modifiers"] = [["harm.Modifier", {}], ["timeit.Timer", {}]]
        attachments = {"scene/objects": packed(objects), "made/0": packed(guest)}
        commands += uses(received.forged(f"classes-{source}", received.folder / source, attachments=attachments))
    for words, outcome in zip(commands, received.read(*commands), strict=True):
        assert outcome["seen"] == [], words
        assert "Traceback" not in outcome["error"], words
        if words[0] == "show" and "lean" not in words[1]:
            assert outcome["status"] == 0, "it is shown with the classes of MORSE"
    assert received.traces() == []


def test_no_model_is_opened_that_an_input_names(received: Received) -> None:
    commands = []
    for kind in ("/proc/self/cwd/evil.obj", "evil.obj", str(received.folder / "evil.obj")):
        for source in ("run.mcap", "lean.mcap"):
            entry = Entry(0, SPAWN, "thing", (kind, [0.0] * 3, [0.0] * 3))
            name = f"models-{len(commands)}.mcap"
            received.forged(name, received.folder / source, entries=[entry])
            commands += [words for words in uses(name) if "--resimulate" not in words]
    for words, outcome in zip(commands, received.read(*commands), strict=True):
        assert outcome["seen"] == [], words
        assert "Traceback" not in outcome["error"], words


def test_meshes_are_limited_in_sum(received: Received, monkeypatch: pytest.MonkeyPatch) -> None:
    with Recording(received.run) as recording:
        sizes = [int(one["data"] != "") for one in unpacked(received.run, "scene/objects")["meshes"]]
        assert sum(sizes) > 1
        assert RecordedMade(recording, tuple).scene()
        monkeypatch.setattr(reading, "_MOST_BYTES", 100_000)
        with pytest.raises(RecordingError, match="the meshes are larger than"):
            RecordedMade(recording, tuple).scene()


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("settings", {"gravity": float("nan")}),
        ("settings", {"frequency": 0.0}),
        ("settings", {"frequency": 1e12}),
        ("settings", {"physics_steps": 2**40}),
        ("settings", "fast"),
        ("environment", 5),
        ("zones", [["nowhere", "Charging"]]),
        ("zones", [[0, 0]]),
        ("properties", []),
        ("script", "evil.py"),
    ],
)
def test_damaged_descriptions_of_a_scene_are_refused(received: Received, part: str, value: Any) -> None:
    scene = unpacked(received.run, "scene/settings")
    scene[part] = scene["settings"] | value if isinstance(value, dict) else value
    name = received.forged("damaged.mcap", attachments={"scene/settings": packed(scene)})
    with (
        Recording(received.folder / name) as recording,
        pytest.raises(RecordingError, match="the description of the scene is damaged"),
    ):
        RecordedMade(recording, tuple).scene()


@pytest.mark.parametrize("type_", ["text/html", "image/svg+xml", ""])
def test_images_have_the_types_of_pictures(received: Received, type_: str) -> None:
    objects = unpacked(received.run, "scene/objects")
    assert objects["images"], "the scene has textures"
    objects["images"][0]["mime"] = type_
    name = received.forged("images.mcap", attachments={"scene/objects": packed(objects)})
    with Recording(received.folder / name) as recording, pytest.raises(RecordingError, match="images that are not"):
        RecordedMade(recording, tuple).scene()


def test_the_auditor_sees_what_is_executed(received: Received) -> None:
    """The counterpart: what the user trusts or names is executed, and seen."""
    script, content = _at("{folder}/evil.py")(received)
    name = received.forged("trusted.mcap", facts={"script": script}, attachments={"scene.py": content})
    trusted, named = received.read(
        ["replay", name, "--resimulate", "--trust"], ["replay", name, "--resimulate", "--scene", "evil.py"]
    )
    for outcome in (trusted, named):
        assert any(one.startswith("os.system") for one in outcome["seen"])
        assert any(one.startswith("exec") for one in outcome["seen"])
    for trace in received.traces():
        trace.unlink()
