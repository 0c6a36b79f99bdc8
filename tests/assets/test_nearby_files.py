"""A model of a robot reads the files of its package, and no others."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from morse.assets.nearby_files import FileRefusedError, find_near
from morse.assets.search import project_dirs

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A model in ``ws/rover/urdf``, meshes in ``ws/rover/meshes``, another package beside it, a secret outside."""
    for folder in ("ws/rover/urdf/deep", "ws/rover/meshes", "ws/other/meshes", "secret"):
        (tmp_path / folder).mkdir(parents=True)
    for file in ("ws/rover/meshes/a.stl", "ws/other/meshes/b.stl", "secret/c.stl", "ws/rover/urdf/d.stl"):
        (tmp_path / file).write_text("x")
    file = tmp_path / "ws/rover/urdf/rover.urdf"
    file.write_text("<robot/>")
    return file


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("d.stl", "ws/rover/urdf/d.stl"),
        ("../meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("package://rover/meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("package://other/meshes/b.stl", "ws/other/meshes/b.stl"),
    ],
)
def test_files_of_packages_are_found(model: Path, tmp_path: Path, name: str, where: str) -> None:
    assert find_near(name, model).samefile(tmp_path / where)


@pytest.mark.parametrize(
    "name",
    [
        "../../../secret/c.stl",
        "../../other/meshes/b.stl",
        "package://rover/../../secret/c.stl",
        "package://../secret/c.stl",
        "file://{root}/secret/c.stl",
        "{root}/secret/c.stl",
        "../meshes/link.stl",
    ],
)
def test_files_elsewhere_are_refused(model: Path, tmp_path: Path, name: str) -> None:
    os.symlink(tmp_path / "secret/c.stl", tmp_path / "ws/rover/meshes/link.stl")
    with pytest.raises(FileRefusedError, match=r"outside of the package|the file does not exist"):
        find_near(name.format(root=tmp_path), model)


def test_what_the_user_lists_may_be_read(model: Path, tmp_path: Path, monkeypatch) -> None:
    with project_dirs([tmp_path / "secret"]):
        assert find_near("../../../secret/c.stl", model).samefile(tmp_path / "secret/c.stl")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    assert find_near("package://secret/c.stl", model).samefile(tmp_path / "secret/c.stl")


def test_a_package_reaches_as_far_as_its_mark_says(model: Path, tmp_path: Path) -> None:
    deep = model.parent / "deep" / "rover.urdf"
    deep.write_text("<robot/>")
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../meshes/a.stl", deep)
    (tmp_path / "ws/rover/package.xml").write_text("<package/>")
    assert find_near("../../meshes/a.stl", deep).samefile(tmp_path / "ws/rover/meshes/a.stl")


@pytest.mark.parametrize("name", ["", "\0", "package://", "package:///etc/passwd", "gone.stl", "x" * 5000])
def test_names_of_nothing_are_refused(model: Path, name: str) -> None:
    with pytest.raises(FileRefusedError):
        find_near(name, model)
