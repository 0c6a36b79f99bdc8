"""Objects that functions of a program have spawned are shown from their descriptions in the recording."""

import logging
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zstandard

import morse
from morse.builder import ATRV, IMU, KukaLWR, Morsy, MotionVW, PassiveObject, Pose
from morse.builder.assembly.spawning import Newcomer
from morse.builder.creator import SensorCreator
from morse.core.exceptions import MorseError
from morse.core.sensor import Sensor as SensorClass
from morse.launch.playing import playing
from morse.recording.errors import RecordingError
from morse.recording.made.packing import Packing
from morse.recording.made.reading import Unpacking
from morse.recording.recording import Recording
from morse.simulation.recordings.timeline import RecordedTimeline
from morse.simulation.simulation import Simulation
from morse.verification.resimulation import resimulate
from morse.viewer.replay_view import ReplayView

SCENE = """
from morse.builder import *

robot = ATRV()
Environment("empty")
"""


def visitor() -> ATRV:
    made = ATRV()
    motion, pose, arm, imu = MotionVW(), Pose(), KukaLWR(), IMU()
    pose.translate(0.2, 0.0, 0.5)
    arm.translate(0.0, 0.0, 0.9)
    imu.frequency(30)
    made.append(motion)
    made.append(pose)
    made.append(arm)
    imu.noise(gaussian=0.01, bias_walk=0.1)
    imu.alter("IMUNoise", gyro_std=0.05)
    made.append(imu)
    return made


def crate() -> PassiveObject:
    return PassiveObject("props/crates", "small_crate")


class Run:
    """A recording, and where everything was at some positions of its time line."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.truth: dict[int, dict[str, tuple[float, ...]]] = {}

    def look(self, sim: Simulation, position: int) -> None:
        objects = sim.world.objects_by_name
        self.truth[position] = {name: objects[name].world_pose()[0] for name in sorted(objects)}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("made")
    (folder / "scene.py").write_text(SCENE)
    found = Run(folder / "run.mcap")
    with morse.load(folder / "scene.py") as sim, sim.record(found.path):
        sim.step(5)
        found.look(sim, 5)
        sim.spawn("visitor", visitor, (3.0, 1.0, 0.1), (0.0, 0.0, 1.0))
        sim.visitor.motion.publish({"v": 1.0, "w": 0.5})
        sim.step(15)
        found.look(sim, 20)
        saved = sim.save()
        sim.delete("visitor")
        sim.step(5)
        found.look(sim, 25)
        sim.spawn("visitor", crate, (3.0, -2.0, 2.0))
        sim.step(5)
        found.look(sim, 30)
        sim.restore(saved)
        sim.step(5)
        found.look(sim, 35)
        sim.restart()
        sim.step(5)
        found.look(sim, 40)
    return found


@pytest.fixture(scope="module")
def view(run: Run) -> Iterator[ReplayView]:
    with Recording(run.path) as recording, playing(recording, port=0, browser=False) as made:
        yield made


@pytest.fixture
def timeline(view: ReplayView) -> RecordedTimeline:
    return view._timeline  # type: ignore[return-value]


def test_objects_come_and_go_and_come_again(run: Run, timeline: RecordedTimeline) -> None:
    for position in (5, 20, 25, 30, 35, 40, 30, 20, 5, 35, 25):
        timeline.approach(position)
        objects = timeline._world.objects_by_name
        assert sorted(objects) == sorted(run.truth[position])
        for name, place in run.truth[position].items():
            assert objects[name].world_pose()[0] == pytest.approx(place, abs=1e-9), (position, name)


def test_panels_show_the_values_of_such_sensors(run: Run, view: ReplayView, timeline: RecordedTimeline) -> None:
    timeline.approach(20)
    feed: Any = view._feeds[0]
    data, note = feed.measured("visitor.pose")
    assert not note
    place = [data["x"], data["y"], data["z"]]
    assert place == pytest.approx(run.truth[20]["visitor.pose"], abs=1e-9)
    command, note = feed._commanded(view._simulation.context.components["visitor.motion"])
    assert (command["v"], note) == (1.0, "the last recorded command")


def test_a_recording_that_begins_later_describes_who_is_there(tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENE)
    with morse.load(tmp_path / "scene.py") as sim:
        sim.spawn("visitor", visitor, (3.0, 1.0, 0.1))
        sim.step(3)
        with sim.record(tmp_path / "run.mcap"):
            sim.step(3)
    with Recording(tmp_path / "run.mcap") as recording, playing(recording, port=0, browser=False) as view:
        assert "visitor.arm" in view._simulation.context.components


def test_equal_meshes_are_written_once(tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENE)
    with morse.load(tmp_path / "scene.py") as sim, sim.record(tmp_path / "run.mcap"):
        for number in range(2):
            sim.spawn(f"crate{number}", crate, (3.0, number, 1.0))
        sim.step(1)
    with Recording(tmp_path / "run.mcap") as recording:
        names = recording.attachments
    blocks = [name for name in names if name.startswith("blocks/")]
    assert len(blocks) == len(set(blocks)) > 0
    assert [name for name in names if name.startswith("made/")] == ["made/0", "made/1"]
    with Recording(tmp_path / "run.mcap") as recording, playing(recording, port=0, browser=False) as view:
        view._timeline.approach(1)
        assert {"crate0", "crate1"} <= view._simulation.world.objects_by_name.keys()


# -- simulated again --------------------------------------------------------------------------


def test_the_run_is_simulated_again_to_the_bit(run: Run) -> None:
    with Recording(run.path) as recording:
        outcome = resimulate(recording, trust=True)
    assert outcome.departure is None
    assert outcome.complete
    assert outcome.messages > 100


def test_from_the_inputs_alone(tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENE)
    with morse.load(tmp_path / "scene.py") as sim:
        sim.spawn("visitor", visitor, (3.0, 1.0, 0.1))
        sim.step(3)
        with sim.record(tmp_path / "run.mcap", sensors=[]):
            sim.spawn("crate", crate, (4, 0.5, 1))
            with pytest.raises(MorseError, match="already an object"):
                sim.spawn("crate", visitor)
            sim.visitor.motion.publish({"v": 1.0, "w": -0.2})
            sim.step(60)
            truth = sim.world.objects_by_name["crate"].world_pose()[0]
    with Recording(tmp_path / "run.mcap") as recording:
        outcome = resimulate(recording, trust=True)
        assert (outcome.departure, outcome.complete, outcome.ticks) == (None, True, 60)
        with playing(recording, port=0, browser=False) as view:
            while not view._timeline.approach(60):
                pass
            assert view._simulation.world.objects_by_name["crate"].world_pose()[0] == truth


class Own(SensorClass):
    """A sensor that no project contains."""

    def default_action(self) -> None:
        """Measure nothing."""


def with_own_sensor() -> ATRV:
    made = ATRV()
    own = SensorCreator("own")
    own.classpath = f"{__name__}.Own"
    made.append(own)
    return made


def test_a_class_of_another_program_is_named(tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENE)
    with morse.load(tmp_path / "scene.py") as sim, sim.record(tmp_path / "run.mcap"):
        sim.spawn("guest", with_own_sensor)
        sim.step(2)
    with Recording(tmp_path / "run.mcap") as recording:
        with pytest.raises(RecordingError, match="is not a part of MORSE or of this project"):
            resimulate(recording, trust=True)
        with playing(recording, port=0, browser=False) as view:
            view._timeline.approach(2)
            assert "guest" in view._simulation.context.robots


# -- the form -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def packed(tmp_path_factory: pytest.TempPathFactory) -> Packing:
    script = tmp_path_factory.mktemp("packed") / "scene.py"
    script.write_text(SCENE)
    with morse.load(script) as sim:
        sim.spawn("visitor", visitor, (3.0, 1.0, 0.1), (0.1, 0.2, 0.3))
        sim.spawn("person", Morsy, (5.0, 1.0, 0.1))
        made = [one.describe() for one in sim.population.made().values()]
        everybody = Newcomer([root for one in made for root in one.roots], [c for one in made for c in one.components])
        return Packing(everybody.roots, everybody.components)


def unpacked(packing: Packing, data: bytes) -> Unpacking:
    return Unpacking(data, packing.blocks.__getitem__, lambda paths: paths[0])


def test_a_description_survives_the_file(packed: Packing) -> None:
    once = unpacked(packed, packed.to_bytes())
    again = Packing(once.roots, once.components)
    assert again.blocks == packed.blocks
    # the options of streams stay behind
    assert msgspec.msgpack.decode(again.to_bytes()) == msgspec.msgpack.decode(packed.to_bytes())
    assert {one.name for one in once.components} >= {"visitor", "visitor.arm", "visitor.pose", "person"}


@pytest.mark.parametrize(
    ("part", "value"),
    [
        (("nodes", 0, "location"), [float("nan"), 0.0, 0.0]),
        (("nodes", 0, "location"), ["here", 0.0, 0.0]),
        (("nodes", 0, "parent"), 0),
        (("nodes", 1, "parent"), 10**9),
        (("nodes", 1, "name"), "visitor"),
        (("nodes", 0, "body"), {"type": "GHOST"}),
        (("nodes", 0, "cameras"), 1),
        (("components", 0, "node"), -1),
        (("components", 0, "kind"), "program"),
        (("components", 0, "frequency"), 0.0),
        (("meshes", 0, "data"), "0" * 64),
        (("meshes", 0, "materials"), [4000]),
    ],
)
def test_a_damaged_description_is_refused(packed: Packing, part: tuple[Any, ...], value: Any) -> None:
    data = msgspec.msgpack.decode(packed.to_bytes())
    inner = data
    for key in part[:-1]:
        inner = inner[key]
    inner[part[-1]] = value
    with pytest.raises(RecordingError, match="the description of an object is damaged"):
        unpacked(packed, msgspec.msgpack.encode(data))


def test_triangles_refer_to_vertices(packed: Packing) -> None:
    data = msgspec.msgpack.decode(packed.to_bytes())
    digest = data["meshes"][0]["data"]
    arrays = msgspec.msgpack.decode(packed.blocks[digest])
    arrays["triangles"][1] = b"\xff\xff\xff\x7f" * (len(arrays["triangles"][1]) // 4)
    blocks = {**packed.blocks, digest: msgspec.msgpack.encode(arrays)}
    with pytest.raises(RecordingError, match="triangles without vertices"):
        Unpacking(packed.to_bytes(), blocks.__getitem__, lambda paths: paths[0])


# -- what a file may not do -------------------------------------------------------------------


def test_a_recording_names_no_module_of_others(run: Run, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "harm.py").write_text("raise SystemExit('executed')")
    recording = Recording(run.path)
    with recording, pytest.MonkeyPatch.context() as patch, caplog.at_level(logging.WARNING):
        patch.syspath_prepend(str(tmp_path))
        with playing(recording, port=0, browser=False) as view:
            timeline: Any = view._timeline
            assert timeline.made._class_of(["harm.Robot"]) is None
            assert timeline.made._class_of(["harm.Robot", "morse.robots.atrv.ATRV"]) == "morse.robots.atrv.ATRV"
            assert timeline.made._class_of(["morse.core.clock.Clock"]) is None
            assert timeline.made._class_of(["morse.cli.app.main"]) is None
    assert "harm" not in sys.modules


def test_a_damaged_attachment_is_named_and_the_rest_is_shown(
    run: Run, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    with Recording(run.path) as recording:
        whole = recording.attachment

        def damaged(name: str) -> bytes | None:
            if name != "made/0":
                return whole(name)
            return zstandard.ZstdCompressor().compress(b"\x81\xa5nodes\x93")

        monkeypatch.setattr(recording, "attachment", damaged)
        with playing(recording, port=0, browser=False) as view:
            timeline: Any = view._timeline
            for _ in range(2):
                timeline.approach(20)
                assert "visitor" not in timeline._world.objects_by_name
                timeline.approach(30)
                assert "visitor" in timeline._world.objects_by_name
    said = [one.getMessage() for one in caplog.records if "'visitor' is not shown" in one.getMessage()]
    assert len(said) == 1
    assert "damaged" in said[0]


@pytest.mark.parametrize(
    ("sensor", "name", "value"),
    [
        ("morse.sensors.video_camera.VideoCamera", "cam_width", 10**9),
        ("morse.sensors.depth_camera.DepthCamera", "cam_height", 10**9),
        ("morse.sensors.laserscanner.LaserScanner", "resolution", 1e-12),
        ("morse.sensors.laserscanner.LaserScanner", "layers", "many"),
        ("morse.sensors.laserscanner.LaserScanner", "layers", 2000),
    ],
)
def test_images_and_scans_of_a_file_have_the_limits_of_a_script(
    packed: Packing, sensor: str, name: str, value: Any
) -> None:
    description = msgspec.msgpack.decode(packed.to_bytes())
    component = next(one for one in description["components"] if one["kind"] == "sensor")
    component["classes"] = [sensor]
    description["nodes"][component["node"]]["properties"] = {name: value}
    with pytest.raises(RecordingError, match=f"property '{name}'"):
        unpacked(packed, msgspec.msgpack.encode(description))
