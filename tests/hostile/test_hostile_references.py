"""Robot files that refer to themselves, to devices, folders and vertices that do not exist: a line names the fault."""

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from morse.assets import load, search
from morse.assets.errors import AssetError
from morse.assets.meshfiles.reader import read_meshes
from morse.assets.nearby_files import FileRefusedError, find_near
from morse.cli.messages import CommandError, existing_file
from morse.system import regular_files as budget
from morse.system.regular_files import read_regular

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
