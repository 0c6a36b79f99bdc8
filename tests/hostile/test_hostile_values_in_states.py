"""A saved state is data: a value of any type at any place is refused or harmless, and nothing is executed."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
import state_traps as traps
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from morse.assets import load, search
from morse.assets.errors import AssetError
from morse.assets.meshfiles.reader import read_meshes
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.cli.messages import CommandError, existing_file
from morse.core.state import Reader, StateError
from morse.core.state.attributes import is_data
from morse.simulation.recordings.input_recording import entry_from_bytes
from morse.system import regular_files as budget
from morse.system.regular_files import read_regular
from tests.kit.effort import examples
from tests.kit.programs import new_processes

CHOICES = st.tuples(st.integers(0, 10_000), st.sampled_from(sorted(traps.VALUES)))


class NoReferences:
    """A reader with these references reads data only."""

    def name_of(self, value: Any) -> str | None:
        return None

    def find(self, name: str) -> Any:
        raise StateError(f"there is no {name}")

    def find_class(self, path: str) -> type[Any] | None:
        return None

    def met_class(self, cls: type[Any]) -> None:
        pass

    def global_name(self, value: Any) -> str | None:
        return None

    def find_global(self, name: str) -> Any:
        raise StateError(f"there is no {name}")


@pytest.fixture(scope="module")
def victim(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Another process with a simulation: a hook for audit events cannot be removed from a process."""
    with new_processes() as pool:
        pool.apply(traps.begin, (str(tmp_path_factory.mktemp("victim")),))
        yield pool


@given(choices=st.lists(CHOICES, min_size=1, max_size=2))
@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
def test_any_value_at_any_place_is_refused_or_harmless(victim: Any, choices: list[tuple[int, str]]) -> None:
    wrong, _ = victim.apply(traps.attack, (choices,))
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("value", traps.VALUES)
def test_a_value_at_places_all_over_the_state(victim: Any, value: str) -> None:
    first = sorted(traps.VALUES).index(value)
    wrong, _ = victim.apply(traps.attack, ([(first + 61 * step, value) for step in range(16)],))
    assert not wrong


@pytest.mark.parametrize(
    ("component", "attribute", "value", "present"),
    [
        ("r0.pose", "position_3d", "a namespace with a method of a path", "a pose"),
        ("r0.pose", "position_3d", "a namespace with a method of another component", "a pose"),
        ("r0.pose", "position_3d", "a wiper", "a pose"),
        ("r0.trap", "position_3d", "the wiper", "a pose"),
        ("r0.trap", "initial_position_3d", "of the user", "a pose"),
        ("r0.trap", "frequency", "a text", "a number"),
        ("r0.trap", "estimate", "a namespace with a function", "in place of nothing"),
        ("r0.trap", "estimate", "a wiper", "an object of the class Estimate"),
        ("r0.trap", "hook", "a function", "nothing"),
        ("r0.trap", "hook", "a method of another component", "nothing"),
        ("r0.trap", "step", "a wiper", "a function"),
        ("r0.trap", "output_functions", "a list", "not part of"),
        ("r0.motion", "_speed", "an own component", "nothing"),
        ("r0.motion", "local_data", "a namespace with a method of a path", "a dictionary"),
        ("r0", "position_3d", "a path", "a pose"),
    ],
)
def test_a_refusal_names_the_place_and_both_kinds(
    victim: Any, component: str, attribute: str, value: str, present: str
) -> None:
    message = victim.apply(traps.message, (component, attribute, traps.VALUES[value]))
    assert message.startswith(f"{component}: ")
    assert attribute in message
    assert present in message or "not in use" in message
    assert "\n" not in message


@pytest.mark.parametrize("value", traps.VALUES.values(), ids=traps.VALUES)
def test_an_input_of_a_recording_is_data_or_refused(value: Any) -> None:
    content = msgspec.msgpack.encode([0, "service", "x", value])
    try:
        entry = entry_from_bytes(content)
    except StateError:
        return
    assert is_data(entry.content)


def _doubled(depth: int) -> list[Any]:
    """Lists of which each contains the one before twice; all of them are items of one list."""
    levels: list[Any] = [["list", [1.0, 1.0]]]
    levels += [["list", [["again", number + 1], ["again", number + 1]]] for number in range(depth)]
    return ["list", levels]


def _chained(depth: int) -> list[Any]:
    levels: list[Any] = [["list", [1.0]]]
    levels += [["list", [["again", number + 1]]] for number in range(depth)]
    return ["list", levels]


@pytest.mark.parametrize(
    "value",
    [
        _doubled(60),
        _doubled(5_000),
        _chained(5_000),
        ["array", "<f8", [2**40], b""],
        ["array", "<f8", [2**40, 2**40], b""],
        ["view", ["array", "|u1", [1], b"x"], "|u1", [2**40], 0, [0]],
        ["objects", [2**40], []],
        ["objects", [2**62, 2**62, 2**62], []],
        ["scalar", "|V2147483647", b""],
        ["list", [["view", ["array", "|u1", [50_000], bytes(50_000)], "|u1", [50_000], 0, [1]]] * 250],
        traps._nested(400),
        traps._nested(5_000),
    ],
    ids=range(12),
)
def test_what_stands_for_more_than_it_holds_is_refused_at_once(value: Any) -> None:
    begin = time.process_time()
    with pytest.raises(StateError):
        Reader(NoReferences()).part("x", value, [])
    assert time.process_time() - begin < 20.0


def test_shared_lists_and_cycles_are_restored() -> None:
    read = Reader(NoReferences()).part("x", _doubled(12), [])
    assert read[12][0] is read[11]
    ring = Reader(NoReferences()).part("x", ["list", [["again", 0]]], [])
    assert ring[0] is ring


def test_an_own_state_is_restored_whatever_attributes_hold_now(victim: Any) -> None:
    names = ("estimate", "history", "table", "space", "step", "hook", "random", "draw", "array", "path")
    values = ("nothing", "a list", "a text", "a number", "a dictionary")
    assert victim.apply(traps.exchange, (names, values)) == []


# -- robot files that refer to themselves, to devices, folders and vertices that do not exist: a line names the fau

_HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base"/>'
_TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


@pytest.mark.parametrize(
    "inside",
    ['<xacro:include filename="self.xacro"/>', '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>'],
    ids=["file", "macro"],
)
def test_a_xacro_that_contains_itself(tmp_path: Path, inside: str) -> None:
    pytest.importorskip("xacro")
    file = tmp_path / "self.xacro"
    file.write_text(f"{_HEAD}{inside}</robot>")
    with pytest.raises(AssetError, match="contains itself") as refusal:
        load(file)
    assert "Error" not in str(refusal.value)


@pytest.mark.parametrize("index", [10**20, -(10**20), 4])
def test_an_obj_with_a_vertex_that_does_not_exist(tmp_path: Path, index: int) -> None:
    file = tmp_path / "part.obj"
    file.write_text(f"{_TRIANGLE}f 1 2 {index}\n")
    with pytest.raises(AssetError, match="does not have") as refusal:
        read_meshes(file)
    assert "Error" not in str(refusal.value)


def test_a_world_whose_only_mesh_is_left_out(tmp_path: Path) -> None:
    file = tmp_path / "world.xml"
    file.write_text(
        '<mujoco><asset><mesh name="m" file="/dev/zero"/></asset>'
        '<worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>'
    )
    with pytest.raises(AssetError, match="/dev/zero"):
        load(file)


def test_a_device_or_a_folder_is_not_called_missing(tmp_path: Path) -> None:
    model = tmp_path / "robot.urdf"
    (tmp_path / "meshes").mkdir()
    (tmp_path / "endless.stl").symlink_to("/dev/zero")
    for name, kind in (("meshes", "folder"), ("endless.stl", "regular file"), ("/dev/zero", "regular file")):
        with pytest.raises(FileRefusedError, match=kind):
            find_near(name, model)
    with pytest.raises(FileRefusedError, match="does not exist"):
        find_near("nothing.stl", model)


_LINK = '<sdf version="1.7"><model name="{}"><link name="l">{}</link></model></sdf>'
_VISUAL = '<visual name="v"><geometry>{}</geometry>{}</visual>'
_BOX = "<box><size>1 1 1</size></box>"


@pytest.mark.parametrize("how", ["up", "absolute", "backslashes", "link"])
@pytest.mark.parametrize("is_downloaded", [False, True], ids=["beside", "downloaded"])
def test_the_model_of_a_folder_is_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, how: str, is_downloaded: bool
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    secret = tmp_path / "secret.sdf"
    secret.write_text(_LINK.format("secret", _VISUAL.format(_BOX, "")))
    (tmp_path / "worlds").mkdir()
    cache = tmp_path / "home/.gz/fuel/fuel.gazebosim.org/me/models/m/1"
    folder = cache if is_downloaded else tmp_path / "worlds/models/m"
    folder.mkdir(parents=True)
    up = "/".join([".."] * len(folder.relative_to(tmp_path).parts))
    names = {"up": f"{up}/secret.sdf", "absolute": str(secret), "backslashes": f"{up}/secret.sdf".replace("/", "\\")}
    (folder / "model.config").write_text(f"<model><sdf>{names.get(how, 'model.sdf')}</sdf></model>")
    if how == "link":
        (folder / "model.sdf").symlink_to(secret)
    uri = "https://fuel.gazebosim.org/1.0/me/models/m" if is_downloaded else "model://m"
    world = tmp_path / "worlds/w.sdf"
    world.write_text(f'<sdf version="1.7"><world name="w"><include><uri>{uri}</uri></include></world></sdf>')
    library = load(world)
    assert [node.name for node in library.nodes() if node.mesh is not None] == []
    assert len(library.warnings) == 1


def test_scripts_of_materials_are_read_once_and_in_the_folder(tmp_path: Path) -> None:
    secret = tmp_path / "secret.material"
    secret.write_text("material secret\n diffuse 1 0 0 1\n")
    folder = tmp_path / "m/scripts"
    folder.mkdir(parents=True)
    (folder / "a.material").write_bytes(b"material a\n" + b"diffuse 0 1 0 1\n" * 200_000)
    for number in range(99):
        (folder / f"b{number}.material").symlink_to("a.material")
    (folder / "c.material").symlink_to(secret)
    visuals = "".join(
        _VISUAL.format(
            _BOX, f"<material><script><uri>{'./' * number}scripts</uri><name>{name}</name></script></material>"
        )
        for number, name in enumerate(["a", "secret"] * 20)
    )
    (tmp_path / "m/model.sdf").write_text(_LINK.format("m", visuals))
    (tmp_path / "m/model.config").write_text("<model/>")
    begin = time.process_time()
    library = load(tmp_path / "m/model.sdf")
    assert time.process_time() - begin < 5.0  # of one file: 0.5 s
    assert library.warnings == ["the material 'secret' is left out: no script of the model contains it"]


def test_references_beside_many_packages_are_found_soon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "MOST_SEARCHES", 1000)
    for number in range(300):
        (tmp_path / f"p{number}").mkdir()
        (tmp_path / f"p{number}/package.xml").write_text(f"<package><name>q{number}</name></package>")
    (tmp_path / "p299/a.stl").write_bytes(bytes(84))
    model = tmp_path / "robot/robot.urdf"
    model.parent.mkdir()
    mesh = '<visual><geometry><mesh filename="package://{}.stl"/></geometry></visual>'
    model.write_text(
        f'<robot name="r"><link name="a">{"".join(mesh.format(f"q{i}/a") for i in range(2000))}</link></robot>'
    )
    begin = time.process_time()
    warnings = load(model).warnings
    assert time.process_time() - begin < 8.0  # a search took 20 ms
    assert any(
        "refers to more than 20,000 files" in one or "refers to more than 1,000 files" in one for one in warnings
    )


def test_a_limit_that_is_used_up_is_an_error_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"a")
    with pytest.raises(OSError, match="larger than 0 bytes"):
        read_regular(tmp_path / "a", 0)


def test_a_name_may_begin_as_a_home_folder_of_nobody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("~nobody-of-this-name.urdf").write_text(f"{_HEAD}</robot>")
    assert search.find("~nobody-of-this-name.urdf") == tmp_path / "~nobody-of-this-name.urdf"
    assert search.find_file("~nobody-of-this-name.urdf") == tmp_path / "~nobody-of-this-name.urdf"
    for name in ("~nobody-of-this-name/a.urdf", "~nobody-of-this-name"):
        for find in (search.find, search.find_file):
            with pytest.raises(search.AssetNotFoundError):
                find(name)
    with pytest.raises(CommandError, match="There is no file"):
        existing_file("~nobody-of-this-name/a.mcap")


def test_a_user_without_a_home_folder_has_no_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_home() -> Path:
        raise RuntimeError("Could not determine home directory.")

    world = tmp_path / "w.sdf"
    include = "<include><uri>https://fuel.gazebosim.org/1.0/me/models/m</uri></include>"
    world.write_text(f'<sdf version="1.7"><world name="w">{include}</world></sdf>')
    monkeypatch.setattr(Path, "home", no_home)
    (warning,) = load(world).warnings
    assert "is not on this machine" in warning


def test_a_folder_that_may_not_be_listed_hides_no_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    listed = Path.iterdir

    def iterdir(folder: Path) -> Iterator[Path]:
        if folder == tmp_path / "users":
            raise PermissionError(13, "Permission denied", str(folder))
        return listed(folder)

    model = tmp_path / "users/me/robot.urdf"
    model.parent.mkdir(parents=True)
    arm = tmp_path / "packages/arm_files"
    arm.mkdir(parents=True)
    (arm / "package.xml").write_text("<package><name>arm</name></package>")
    (arm / "a.stl").write_bytes(bytes(84))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "packages"))
    monkeypatch.setattr(Path, "iterdir", iterdir)
    assert find_near("package://arm/a.stl", model) == arm / "a.stl"
