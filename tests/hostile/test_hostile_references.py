"""Robot files that refer to themselves, to devices, folders and vertices that do not exist: a line names the fault."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from morse.assets import load
from morse.assets.errors import AssetError
from morse.assets.meshfiles.reader import read_meshes
from morse.assets.nearby_files import FileRefusedError, find_near

if TYPE_CHECKING:
    from pathlib import Path

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
