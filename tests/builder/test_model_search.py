"""The file that a model name refers to, and that each file is read once."""

import os
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from morse import assets
from morse.assets import AssetNotFoundError, UnsupportedFormatError, find, formats, instantiate, loader, search
from morse.scene import Library, Node, PhysicsType


def touch(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"")
    return path


@pytest.fixture
def ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(search, "MORSE_COMPONENTS", str(tmp_path / "ours"))
    return tmp_path / "ours"


def test_by_category(ours: Path) -> None:
    rover = touch(ours / "robots" / "rover.blend")
    deep = touch(ours / "environments" / "indoors-1" / "boxes.blend")
    assert find("rover", "robots") == rover
    assert find("indoors-1/boxes", "environments") == deep
    assert find("robots/rover") == rover
    assert find("rover.blend", "robots") == rover
    with pytest.raises(AssetNotFoundError):
        find("rover", "environments")


def test_paths(ours: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mine = touch(tmp_path / "here" / "mine.blend")
    assert find(str(mine), "robots") == mine
    monkeypatch.chdir(tmp_path / "here")
    assert find("mine.blend", "robots") == mine
    assert find("mine.blend").is_absolute()


def test_resource_directories(ours: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    project = touch(tmp_path / "project" / "data" / "sim" / "robots" / "ranger.blend")
    shared = touch(tmp_path / "shared" / "sim" / "robots" / "ranger.blend")
    other = touch(tmp_path / "shared" / "robots" / "digger.blend")
    monkeypatch.setenv("MORSE_RESOURCE_PATH", os.pathsep.join(["", str(tmp_path / "no"), str(tmp_path / "shared")]))
    assert find("sim/robots/ranger.blend", "robots") == shared
    assert find("sim/robots/ranger", "robots") == shared
    assert find("digger", "robots") == other
    search.set_project_dirs([tmp_path / "project" / "data"])
    assert find("sim/robots/ranger.blend", "robots") == project


def test_our_models_go_first(ours: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mine = touch(ours / "robots" / "rover.blend")
    touch(tmp_path / "shared" / "rover.blend")
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(tmp_path / "shared"))
    assert find("rover", "robots") == mine


def test_data_of_an_old_installation(ours: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = touch(tmp_path / "root" / "share" / "morse" / "data" / "robots" / "pr2.blend")
    with pytest.raises(AssetNotFoundError):
        find("pr2", "robots")
    monkeypatch.setenv("MORSE_ROOT", str(tmp_path / "root"))
    assert find("pr2", "robots") == old


def test_what_is_not_found_is_explained(ours: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    touch(ours / "robots" / "rover.blend")
    touch(tmp_path / "shared" / "robots" / "digger.blend")
    monkeypatch.setenv("MORSE_RESOURCE_PATH", str(tmp_path / "shared"))
    with pytest.raises(AssetNotFoundError) as caught:
        find("rovr", "robots")
    message = str(caught.value)
    assert "no model 'rovr' in 'robots'; did you mean 'rover'?" in message
    assert str(ours) in message
    assert str(tmp_path / "shared") in message
    with pytest.raises(FileNotFoundError, match=r"there are: robots/digger\.blend, rover"):
        find("xyzzy", "robots")


@pytest.mark.parametrize("bad", ["", "   ", "a\0b", "\0"])
def test_what_is_no_name(bad: str) -> None:
    with pytest.raises(ValueError, match="not the name of a model"):
        find(bad, "robots")


@pytest.mark.parametrize("odd", ["../../../etc/passwd", "x" * 5000, "~nobody/x.blend", "con", "a/b/c/d", "."])
def test_odd_names_are_just_not_found(ours: Path, odd: str) -> None:
    with pytest.raises(OSError, match="no model"):
        find(odd, "robots")


def test_a_directory_is_no_model(ours: Path) -> None:
    (ours / "robots" / "rover.blend").mkdir(parents=True)
    with pytest.raises(AssetNotFoundError):
        find("rover", "robots")


# --- loading -------------------------------------------------------------------------------------


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    done: list[Path] = []

    def read(path: Path) -> Library:
        done.append(path)
        return Library(str(path), [Node("body")], warnings=["it has a curve"])

    monkeypatch.setattr(loader, "reader_of", lambda path: read)
    monkeypatch.setattr(loader, "_cache", {})
    return done


def test_a_file_is_read_once(tmp_path: Path, reads: list[Path], caplog: pytest.LogCaptureFixture) -> None:
    model = touch(tmp_path / "rover.blend")
    first = assets.load(model)
    assert assets.load(str(model)) is first
    assert reads == [model]
    assert caplog.text.count("rover.blend: it has a curve") == 1
    model.write_bytes(b"changed")
    assert assets.load(model) is not first
    assert len(reads) == 2


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        assets.load(tmp_path / "rover.blend")


@pytest.mark.parametrize("name", ["rover.xyz", "rover", "rover.blend1", ".blend"])
def test_unknown_kinds_of_files(tmp_path: Path, name: str) -> None:
    with pytest.raises(UnsupportedFormatError, match=r"supported: \.blend") as caught:
        assets.load(touch(tmp_path / name))
    assert name in str(caught.value)


def test_suffixes_do_not_depend_on_case(tmp_path: Path) -> None:
    assert formats.reader_of(tmp_path / "ROVER.BLEND") is formats.reader_of(tmp_path / "rover.blend")


def test_copies_share_meshes_and_nothing_else() -> None:
    library = assets.load(find("morsy", "robots"))
    original = next(node for node in library.nodes() if node.mesh is not None)
    copy = instantiate(original)
    assert copy.mesh is original.mesh
    assert copy.parent is None
    assert copy.source_name == original.name
    copy.body.type = PhysicsType.SENSOR
    copy.location[0] += 5.0
    copy.properties["Label"] = "copy"
    copy.materials.append(None)
    assert original.body.type is not PhysicsType.SENSOR
    assert original.location[0] != copy.location[0]
    assert "Label" not in original.properties
    assert len(original.materials) == len(copy.materials) - 1


def test_copies_keep_the_tree(make_chain: Callable[[int], Node]) -> None:
    root = make_chain(5000)
    copies = list(instantiate(root).walk())
    assert [node.name for node in copies] == [node.name for node in root.walk()]
    assert all(copy.parent is above for above, copy in pairwise(copies))
    assert not set(copies) & set(root.walk())


@pytest.fixture
def make_chain() -> Callable[[int], Node]:
    def make(length: int) -> Node:
        nodes = [Node(f"n{i}") for i in range(length)]
        for above, below in pairwise(nodes):
            above.children.append(below)
            below.parent = above
        return nodes[0]

    return make
