"""Files that are written whole replace what has their name, and touch nothing else."""

import os
import stat
import sys

import pytest

from morse.core.reports.faults import is_of_python, is_users
from morse.system import whole_files
from morse.system.whole_files import write_whole


def test_files_of_similar_names_stay(tmp_path):
    for name in ("drive.new", "drive.json.new", ".drive.json", "drive.json~", "drive.tmp"):
        (tmp_path / name).write_text("mine")
    write_whole(tmp_path / "drive.json", "whole")
    assert (tmp_path / "drive.json").read_text() == "whole"
    assert sorted(path.read_text() for path in tmp_path.iterdir()) == ["mine"] * 5 + ["whole"]


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights")
def test_a_link_is_replaced_and_not_followed(tmp_path):
    (tmp_path / "precious").write_text("mine")
    (tmp_path / "page.html").symlink_to(tmp_path / "precious")
    write_whole(tmp_path / "page.html", b"whole")
    assert (tmp_path / "precious").read_text() == "mine"
    assert not (tmp_path / "page.html").is_symlink()
    # others may read it as they may read other new files
    (tmp_path / "usual").touch()
    assert stat.S_IMODE((tmp_path / "page.html").stat().st_mode) == stat.S_IMODE((tmp_path / "usual").stat().st_mode)


def test_what_cannot_be_completed_leaves_what_was_there(tmp_path, monkeypatch):
    (tmp_path / "page.html").write_text("before")

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(whole_files.os, "replace", fail)
    with pytest.raises(OSError, match="No space"):
        write_whole(tmp_path / "page.html", "after")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["before"]


def test_names_of_the_greatest_length_are_written(tmp_path):
    name = "\U0001f916" * 62 + ".html"
    write_whole(tmp_path / name, "\ud800")
    assert (tmp_path / name).read_bytes() == b"\\ud800"
    with pytest.raises(OSError, match="x" * 300):
        write_whole(tmp_path / ("x" * 300), "")
    assert len(list(tmp_path.iterdir())) == 1


def test_the_standard_library_is_not_of_the_user(tmp_path):
    assert is_of_python(os.__file__)
    assert not is_users(os.__file__)
    # packages may be installed in a folder of the standard library, as by pyenv without an environment
    inside = os.path.join(os.path.dirname(os.__file__), "site-packages", "robot", "scene.py")
    assert is_users(inside)
    assert is_users(str(tmp_path / "scene.py"))
    assert not is_users("<frozen importlib._bootstrap>")
    assert is_users("\0")
    if sys.platform != "win32":
        # the same Python by another name
        (tmp_path / "present").symlink_to(os.path.dirname(os.__file__))
        assert not is_users(str(tmp_path / "present" / "json" / "decoder.py"))
