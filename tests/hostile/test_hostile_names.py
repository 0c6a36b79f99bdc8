"""Names that clients, pages and files give in a running simulation are words; no name becomes a path."""

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.builder import ATRV, Environment, Pose
from morse.core.exceptions import MorseError
from morse.core.state import StateError
from morse.core.validation.names import LONGEST_NAME, RESERVED, check_name, file_name, word_of
from morse.simulation.simulation import Simulation
from morse.system.free_names import free_name

#: no words
NO_WORDS = [
    *("", " ", ".", "..", "a.b", "robot.pose", "../up", "/tmp/evil", "a/b", "a\\b", "C:", "~root", "a b", "-rf", "a-b"),
    *("a\0b", "a\nb", "a\r\nb", "\x1b[2J", "a\u202eb", "a\u200bb", "a\ud800", "9a", "a#b", "a+b", "a*", "a?", "a:b"),
    *('"a"', "'a'", "{a}", "%s", "$HOME", "a;b", "é", "аtrv", "ａtrv", "a²", "robot\u0301", "x" * 101, "x" * 1_000_000),
]  # fmt: skip
#: words that are reserved, or are those of something else, in any case
TAKEN = ["robot", "Robot", "ROBOT", "simulation", "Simulation", "time", "TIME", "communication", "rosapi", "rpc", "NUL"]
BAD = [*NO_WORDS, *TAKEN]


def scene() -> None:
    robot = ATRV()
    robot.append(Pose("pose"))
    Environment("empty")


@pytest.fixture
def sim(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Simulation]:
    monkeypatch.chdir(tmp_path)
    with morse.load(scene) as simulation:
        yield simulation


@pytest.mark.parametrize("name", BAD, ids=lambda name: ascii(name)[:20])
def test_no_door_lets_a_bad_name_in(sim: Simulation, name: str) -> None:
    before = sim.state_hash()
    with pytest.raises(MorseError):
        sim.spawn(name, "ATRV")
    service = next(one for one in sim.context.service_objects if hasattr(one, "list_spawnables"))
    with pytest.raises(MorseError) as refusal:
        service.spawn(name, "props/crates")
    assert len(str(refusal.value)) < 600
    assert str(refusal.value).isprintable()
    state = {**sim.population.get_state(), "came": [[name, "ATRV", [9.0, 0.0, 0.0], [0.0, 0.0, 0.0]]]}
    with pytest.raises((MorseError, StateError)):
        sim.population.set_state(state)
    assert sim.state_hash() == before
    assert sim.context.world.objects_by_name.keys() == {node.name for node in sim.scene.nodes()}


@pytest.mark.parametrize("name", [None, 5, b"robot2", ["a"], {"a": 1}, 1e999])
def test_what_is_no_text_is_no_name(sim: Simulation, name: Any) -> None:
    with pytest.raises(MorseError, match="the name of an object is a word"):
        sim.population.spawn(name, "ATRV", [0.0] * 3, [0.0] * 3)


@pytest.mark.parametrize("name", ["a", "_", "A9_z", "x" * LONGEST_NAME, "robot_2", "simulation_1"])
def test_words_are_names(sim: Simulation, name: str) -> None:
    sim.spawn(name, "ATRV", (9.0, 0.0, 0.2))
    assert name in sim.context.robots
    sim.delete(name)


def test_every_pseudo_component_is_reserved(sim: Simulation) -> None:
    assert {obj.name() for obj in sim.context.service_objects} <= RESERVED


def test_names_that_differ_only_for_some_clients_are_the_same(sim: Simulation) -> None:
    """``front-left`` of a script is ``front_left`` for pymorse and ROS."""
    with pytest.raises(MorseError, match="differ only"):
        check_name("front_left", ["Front-left"])
    check_name("front_left2", ["Front-left"])


@pytest.mark.parametrize("text", [*NO_WORDS, *TAKEN, *sorted(RESERVED)])
def test_a_similar_word_is_a_name(text: str) -> None:
    check_name(word_of(text))


@pytest.mark.parametrize("text", [*NO_WORDS, "nul", "NUL.txt", ".hidden", "..", "x" * 999, "é" * 999, "a\ud800"])
def test_a_name_of_a_file_stays_in_its_folder(tmp_path: Path, text: str) -> None:
    path = tmp_path / (file_name(text) + ".morse-state")
    path.write_bytes(b"")
    assert [one.name for one in tmp_path.iterdir()] == [path.name]
    assert path.resolve().parent == tmp_path.resolve()
    assert path.name.isprintable()
    assert not path.name.startswith((".", "-"))


def test_names_of_files_of_usual_components_are_kept() -> None:
    for name in ("robot.imu", "robot.arm.pose-2", "robot_001.caméra", "late.clock_1"):
        assert file_name(name) == name


DESCRIPTION = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
ixz="0" iyz="0"/></inertial><collision><geometry><box size="1 1 1"/></geometry></collision></link>
<gazebo reference="a"><sensor type="imu" name={name}/></gazebo></robot>"""


@pytest.mark.parametrize("name", ["../../up", "/tmp/evil", "a.b", "simulation", "x" * 1_000_000, "a&#10;b", "é", ""])
def test_sensors_of_a_sent_description_have_words(sim: Simulation, name: str) -> None:
    before = set(sim.context.components)
    with contextlib.suppress(MorseError):
        sim.spawn("guest", DESCRIPTION.format(name=json.dumps(name, ensure_ascii=False)), (9.0, 0.0, 1.0))
    for new in set(sim.context.components) - before:
        robot, _, part = new.partition(".")
        assert robot == "guest"
        assert part.replace("_", "a").isalnum()


def test_the_text_stream_of_a_spawned_robot_overwrites_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)

    def watched() -> None:
        robot = ATRV()
        robot.append(Pose("pose"))
        Environment("empty").add_default_interface("text")

    (tmp_path / "guest.pose.txt").write_text("precious")

    def guest() -> Any:
        robot = ATRV()
        robot.append(Pose("pose"))
        robot.add_default_interface("text")
        return robot

    with morse.load(watched) as simulation:
        simulation.run(duration=0.1)
        simulation.spawn("guest", guest, (9.0, 0.0, 0.2))
        simulation.run(duration=0.1)
        simulation.delete("guest")
        simulation.spawn("guest", guest, (9.0, 0.0, 0.2))
        simulation.run(duration=0.1)
    assert (tmp_path / "guest.pose.txt").read_text() == "precious"
    assert (tmp_path / "guest.pose_2.txt").read_text().startswith("ROBOT guest || SENSOR guest.pose")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["guest.pose.txt", "guest.pose_2.txt", "robot.pose.txt"]


@pytest.mark.parametrize("count", [0, 1, 2, 99, 100, 101, 102, 103, 1000, 5000])
def test_a_free_name_among_many_equal_ones_is_the_first_and_is_found_soon(count: int) -> None:
    taken = {"a", *(f"a_{number}" for number in range(2, count + 1))} if count else set()
    asked: list[str] = []

    def is_taken(name: str) -> bool:
        asked.append(name)
        return name in taken

    assert free_name("a", is_taken) == ("a" if not count else f"a_{max(count + 1, 2)}")
    assert len(asked) <= 130


@pytest.mark.parametrize(
    "name", ["world", "World", "world/", "default", "main", "__proto__", "</script>", '"', "r/base"]
)
def test_a_scene_may_use_names_of_the_engine(name: str) -> None:
    def two_robots() -> None:
        ATRV(name).translate(0.0, 0.0, 0.5)
        ATRV("other").translate(3.0, 0.0, 0.5)
        Environment("empty")

    with morse.load(two_robots) as simulation:
        simulation.step(60)
        first, second = (simulation.context.robots[one].position_3d.z for one in (name, "other"))
        assert first == pytest.approx(second, abs=1e-6)
        assert first < 0.45
