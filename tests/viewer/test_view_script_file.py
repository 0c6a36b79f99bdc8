"""The script is saved as a whole or not at all, through links, and never over the work of others."""

import errno
import os
import resource
import stat
from pathlib import Path

import pytest

import morse
from morse.builder.editing.changes import Changes, UnwritableError
from morse.viewer import script_file
from morse.viewer.script_file import ScriptFile

TEXT = "from morse.builder import *\nenv = Environment('empty')\n"
NEW = TEXT + "# more\n"


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "scene.py"
    path.write_text(TEXT)
    return path


def files_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def refused(file: ScriptFile, script: Path, *, content: str = TEXT) -> str:
    """Why a save was refused, with the script and its folder as they were."""
    before = files_in(script.parent)
    with pytest.raises(UnwritableError) as refusal:
        file.save(NEW)
    assert script.read_text() == content
    assert files_in(script.parent) == before
    return str(refusal.value)


def test_a_symbolic_link_stays_and_its_target_is_written(script: Path, tmp_path: Path) -> None:
    folder = tmp_path / "links"
    folder.mkdir()
    first, second = folder / "first.py", folder / "second.py"
    first.symlink_to("../scene.py")
    second.symlink_to("first.py")
    script.chmod(0o640)
    assert ScriptFile(str(second)).save(NEW) == NEW.encode()
    assert script.read_text() == NEW
    assert first.is_symlink()
    assert second.is_symlink()
    assert stat.S_IMODE(script.stat().st_mode) == 0o640
    assert files_in(folder) == {"first.py", "second.py"}
    assert files_in(tmp_path) == {"links", "scene.py"}


def test_a_link_that_leads_to_itself_is_refused(script: Path) -> None:
    file = ScriptFile(str(script))
    script.unlink()
    script.symlink_to("scene.py")
    with pytest.raises(UnwritableError, match=r"scene\.py .* not saved, and stays as it was"):
        file.save(NEW)
    assert script.is_symlink()
    again = ScriptFile(str(script))
    with pytest.raises(UnwritableError, match="cannot be read"):
        again.changed(Changes())


def test_a_link_into_the_package_is_saved_beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = next(path for path in Path(morse.__file__).parent.rglob("*.py") if "Environment(" in path.read_text())
    before = own.read_bytes()
    link = tmp_path / "mine.py"
    link.symlink_to(own)
    monkeypatch.chdir(tmp_path)
    file = ScriptFile(str(link))
    assert file.path == tmp_path / "mine_2.py"
    file.save(NEW)
    assert own.read_bytes() == before
    assert (tmp_path / "mine_2.py").read_text() == NEW


def test_the_other_name_of_a_file_is_not_separated_from_it(script: Path, tmp_path: Path) -> None:
    os.link(script, tmp_path / "other.py")
    assert "2 names (hard links)" in refused(ScriptFile(str(script)), script)
    assert (tmp_path / "other.py").samefile(script)


def test_a_file_of_somebody_else_stays_with_its_owner(script: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if os.getuid() == 0:
        os.chown(script, 12345, 23456)
        ScriptFile(str(script)).save(NEW)
        assert (script.stat().st_uid, script.stat().st_gid) == (12345, 23456)
        script.write_text(TEXT)

    def refuse(*_: object) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(script_file.os, "chown", refuse)
    mine = os.stat

    def of_another(path: object, **options: object) -> os.stat_result:
        status = mine(path, **options)  # type: ignore[arg-type]
        return os.stat_result([*status[:4], 54321, *status[5:10]]) if str(path).endswith(".tmp") else status

    monkeypatch.setattr(script_file.os, "stat", of_another)
    assert "belongs to another user or group" in refused(ScriptFile(str(script)), script)


def test_a_read_only_script_is_not_replaced(script: Path) -> None:
    script.chmod(0o444)
    assert "read-only" in refused(ScriptFile(str(script)), script)


def test_a_full_disk_leaves_the_old_script(script: Path) -> None:
    file = ScriptFile(str(script))
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    # writing fails in the middle of the text, as on a full disk
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(TEXT) + 2, usual[1]))
    try:
        message = refused(file, script)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    assert os.strerror(errno.EFBIG) in message
    assert str(script.parent) in message


def test_a_folder_that_takes_no_files_leaves_the_old_script(script: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def closed(**_: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(script_file.tempfile, "mkstemp", closed)
    message = refused(ScriptFile(str(script)), script)
    assert "Permission denied" in message
    assert str(script.parent) in message


def test_the_work_of_others_is_shown_and_kept(script: Path) -> None:
    file = ScriptFile(str(script))
    theirs = TEXT + "# theirs\n"
    script.write_text(theirs)
    message = refused(file, script, content=theirs)
    assert "was changed since the scene was loaded" in message
    assert "+# theirs" in message.split("\n")
    script.write_bytes(b"\xff\xfe" * 1000)
    with pytest.raises(UnwritableError, match="it is not text"):
        file.save(NEW)
    script.write_text("x" * 10_000 + "\n" * 10_000)
    with pytest.raises(UnwritableError, match="was changed") as refusal:
        file.save(NEW)
    assert len(str(refusal.value)) < 2_000
    script.write_text(TEXT)
    file.save(NEW)
    assert script.read_text() == NEW


def test_what_others_do_while_it_is_written_is_kept(script: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = ScriptFile(str(script))
    write = os.fsync

    def meanwhile(descriptor: int) -> None:
        write(descriptor)
        script.write_text(TEXT + "# meanwhile\n")

    monkeypatch.setattr(script_file.os, "fsync", meanwhile)
    with pytest.raises(UnwritableError, match="# meanwhile"):
        file.save(NEW)
    assert script.read_text() == TEXT + "# meanwhile\n"


@pytest.mark.parametrize("other", ["nothing", "folder", "pipe"])
def test_a_script_that_is_gone_is_not_written_again(script: Path, other: str) -> None:
    file = ScriptFile(str(script))
    script.unlink()
    if other == "folder":
        script.mkdir()
    elif other == "pipe":
        os.mkfifo(script)
    with pytest.raises(UnwritableError, match="not saved"):
        file.save(NEW)
    assert script.exists() == (other != "nothing")


def test_a_new_script_does_not_replace_one_that_has_appeared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    first, second = ScriptFile("world.glb"), ScriptFile("world.glb")
    assert first.path == second.path == tmp_path / "world.py"
    first.save(NEW)
    with pytest.raises(UnwritableError, match="there is such a file now"):
        second.save(TEXT)
    assert (tmp_path / "world.py").read_text() == NEW
    first.save(TEXT)
    assert (tmp_path / "world.py").read_text() == TEXT


@pytest.mark.parametrize("content", [b"\xef\xbb\xbf" + TEXT.encode(), b"# coding: latin-1\n# \xe4\r\n" + TEXT.encode()])
def test_bytes_of_an_unchanged_text_stay(script: Path, content: bytes) -> None:
    script.write_bytes(content)
    file = ScriptFile(str(script))
    assert file.save(file.text) == content
    assert script.read_bytes() == content
