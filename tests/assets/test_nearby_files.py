"""A model of a robot reads the files of its package, and no others."""

import os
from pathlib import Path

import pytest

from morse.assets.nearby_files import FileRefusedError, find_near, find_package
from morse.assets.search import project_dirs


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
        # from the package, and from a file of macros in a folder that is one deeper
        ("meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("../../meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("package://rover/meshes/a.stl", "ws/rover/meshes/a.stl"),
        ("package://other/meshes/b.stl", "ws/other/meshes/b.stl"),
        ("package:///other/meshes/b.stl", "ws/other/meshes/b.stl"),
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
    deep = tmp_path / "ws" / "rover" / "made" / "deep" / "rover.urdf"
    deep.parent.mkdir(parents=True)
    deep.write_text("<robot/>")
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../meshes/a.stl", deep)
    (tmp_path / "ws/rover/package.xml").write_text("<package/>")
    assert find_near("../../meshes/a.stl", deep).samefile(tmp_path / "ws/rover/meshes/a.stl")


@pytest.mark.parametrize("marks", [(), ("ws/rover/urdf/deep/__init__.py", "ws/rover/urdf/__init__.py")])
def test_a_package_without_a_mark_is_above_its_folder_of_models(model: Path, tmp_path: Path, marks) -> None:
    for mark in marks:
        (tmp_path / mark).touch()
    deep = model.parent / "deep" / "rover.urdf"
    assert find_near("../../meshes/a.stl", deep).samefile(tmp_path / "ws/rover/meshes/a.stl")
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../../other/meshes/b.stl", deep)


def test_python_packages_reach_as_far_as_they_are_nested(model: Path, tmp_path: Path) -> None:
    deep = tmp_path / "ws" / "rover" / "made" / "deep" / "rover.urdf"
    deep.parent.mkdir(parents=True)
    for folder in (deep.parent, deep.parent.parent):
        (folder / "__init__.py").touch()
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../meshes/a.stl", deep)
    (tmp_path / "ws/rover/__init__.py").touch()
    assert find_near("../../meshes/a.stl", deep).samefile(tmp_path / "ws/rover/meshes/a.stl")


def test_a_renamed_package_and_other_capitals_are_understood(model: Path, tmp_path: Path) -> None:
    mesh = tmp_path / "ws/rover/meshes/a.stl"
    for name in ("package://rover_description/meshes/a.stl", "../meshes/A.STL", "package://rover/meshes/A.stl"):
        assert find_near(name, model).samefile(mesh)
    assert find_package("rover_description", model).samefile(tmp_path / "ws/rover")
    (tmp_path / "ws").rename(tmp_path / "xacro")
    model = tmp_path / "xacro/rover/urdf/rover.urdf"
    assert find_package("rover_description", model).samefile(tmp_path / "xacro/rover"), "the nearest"
    (tmp_path / "xacro").rename(tmp_path / "ws")
    model = tmp_path / "ws/rover/urdf/rover.urdf"
    with pytest.raises(FileRefusedError, match="outside of the package"):
        find_near("../../other/meshes/B.stl", model)
    # a package that says its name is not another one
    (tmp_path / "ws/rover/package.xml").write_text("<package><name>rover</name></package>")
    with pytest.raises(FileRefusedError, match="there is no package 'rover_description'"):
        find_package("rover_description", model)


@pytest.mark.parametrize("name", ["", "\0", "package://", "package:///etc/passwd", "gone.stl", "x" * 5000])
def test_names_of_nothing_are_refused(model: Path, name: str) -> None:
    with pytest.raises(FileRefusedError):
        find_near(name, model)
