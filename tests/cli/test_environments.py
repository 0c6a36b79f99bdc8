"""create, import, rm: directories and the configuration file."""

import configparser
import os

import pytest

from conftest import Terminal


def sites(morse: Terminal) -> dict[str, str]:
    config = configparser.ConfigParser(interpolation=None)
    config.read(morse.config, encoding="utf-8")
    return dict(config["sites"])


def files_below(directory):
    return sorted(str(p.relative_to(directory)) for p in directory.rglob("*") if p.is_file())


def test_create_writes_the_files_of_the_tutorial_and_registers(morse):
    answer = morse("create", "ranger_sim")
    assert answer.status == 0
    directory = morse.directory / "ranger_sim"
    assert files_below(directory) == [
        "conftest.py",
        "default.py",
        "pyproject.toml",
        "scripts/ranger_sim_client.py",
        "src/ranger_sim/__init__.py",
        "src/ranger_sim/builder/__init__.py",
        "tests/test_default.py",
    ]
    assert sites(morse) == {"ranger_sim": str(directory)}
    assert str(directory) in answer.out
    assert "morse run ranger_sim" in answer.out
    # a bare `pytest` may be that of a Python without MORSE
    assert "python -m pytest ranger_sim" in answer.out
    assert "pip install pytest" in answer.out


def test_tutorial_finds_morsy_on_line_15(morse):
    morse("create", "ranger_sim")
    lines = (morse.directory / "ranger_sim" / "default.py").read_text().splitlines()
    assert lines[14] == "robot = Morsy()"


def test_scripts_can_be_executed(morse):
    morse("create", "ranger_sim")
    for name in ("default.py", "scripts/ranger_sim_client.py"):
        path = morse.directory / "ranger_sim" / name
        assert path.read_text().startswith("#!")
        assert os.access(path, os.X_OK)


def test_a_trailing_slash_is_not_part_of_the_name(morse):
    assert morse("create", "ranger_sim/").status == 0
    assert list(sites(morse)) == ["ranger_sim"]


def test_create_refuses_a_registered_name(morse):
    morse("create", "ranger_sim")
    answer = morse("create", "ranger_sim")
    assert answer.status == 1
    assert "already" in answer.err
    assert "-f" in answer.err


def test_create_refuses_an_existing_directory_and_leaves_it_alone(morse):
    (morse.directory / "ranger_sim").mkdir()
    (morse.directory / "ranger_sim" / "precious").write_text("x")
    answer = morse("create", "ranger_sim")
    assert answer.status == 1
    assert "morse import ranger_sim" in answer.err
    assert files_below(morse.directory / "ranger_sim") == ["precious"]
    assert not morse.config.exists()


def test_create_with_force_starts_afresh(morse):
    morse("create", "ranger_sim")
    (morse.directory / "ranger_sim" / "old.py").write_text("x")
    assert morse("create", "-f", "ranger_sim").status == 0
    assert "old.py" not in files_below(morse.directory / "ranger_sim")


def test_create_with_force_does_not_replace_a_file(morse):
    (morse.directory / "ranger_sim").write_text("a file")
    answer = morse("create", "-f", "ranger_sim")
    assert answer.status == 1
    assert (morse.directory / "ranger_sim").read_text() == "a file"


@pytest.mark.parametrize("name", ["../x", "/tmp/x", "a/b", "..", ".", "", "/", "C:\\x", "a\\b"])
def test_create_refuses_paths(morse, name):
    answer = morse("create", name)
    assert answer.status == 1
    assert answer.err.count("\n") == 1
    assert "path" in answer.err or "name" in answer.err
    assert list(morse.directory.iterdir()) == []
    assert not (morse.directory.parent / "x").exists()


@pytest.mark.parametrize(
    ("name", "mend"),
    [("my-sim", "my_sim"), ("2sim", "_2sim"), ("class", "_class"), ("random", "random_sim"), ("morse", "morse_sim")],
)
def test_create_refuses_what_python_could_not_import_and_suggests(morse, name, mend):
    answer = morse("create", name)
    assert answer.status == 1
    assert mend in answer.err
    assert morse("create", mend).status == 0


def test_import_registers_under_the_name_of_the_directory(morse):
    (morse.directory / "Old-Project").mkdir()
    answer = morse("import", "Old-Project")
    assert answer.status == 0
    assert sites(morse) == {"old-project": str(morse.directory / "Old-Project")}


def test_import_under_another_name(morse):
    (morse.directory / "there").mkdir()
    assert morse("import", "there", "here").status == 0
    assert sites(morse) == {"here": str(morse.directory / "there")}


def test_import_does_not_take_a_name_unless_forced(morse):
    morse("create", "sim")
    (morse.directory / "other").mkdir()
    answer = morse("import", "other", "sim")
    assert answer.status == 1
    assert sites(morse) == {"sim": str(morse.directory / "sim")}
    assert morse("import", "-f", "other", "sim").status == 0
    assert sites(morse) == {"sim": str(morse.directory / "other")}


@pytest.mark.parametrize("name", ["a=b", "a:b", "[sites]", "#x", " ", "a\nb", "a/b"])
def test_import_refuses_names_that_the_configuration_cannot_hold(morse, name):
    (morse.directory / "there").mkdir()
    answer = morse("import", "there", name)
    assert answer.status == 1
    assert not morse.config.exists()


@pytest.mark.parametrize("kind", ["missing", "file"])
def test_import_wants_a_directory(morse, kind):
    if kind == "file":
        (morse.directory / "there").write_text("x")
    answer = morse("import", "there")
    assert answer.status == 1
    assert str(morse.directory / "there") in answer.err


def test_a_path_with_percent_signs_survives(morse):
    (morse.directory / "100%(sure)s").mkdir()
    assert morse("import", "100%(sure)s", "sim").status == 0
    assert sites(morse)["sim"].endswith("100%(sure)s")
    assert morse("import", "-f", "100%(sure)s", "sim").status == 0


@pytest.mark.parametrize("answer", [b"y\n", b"Y\n", b"yes\n"])
def test_rm_deletes_directory_and_registration(morse, answer):
    morse("create", "sim")
    result = morse("rm", "sim", stdin=answer)
    assert result.status == 0
    assert "[y/N]" in result.out
    assert not (morse.directory / "sim").exists()
    assert sites(morse) == {}


@pytest.mark.parametrize("answer", [b"n\n", b"\n", b"yesterday\n", b""])
def test_rm_deletes_nothing_unless_told(morse, answer):
    morse("create", "sim")
    assert morse("rm", "sim", stdin=answer).status == 0
    assert (morse.directory / "sim" / "default.py").exists()
    assert "sim" in sites(morse)


def test_rm_with_force_does_not_ask(morse):
    morse("create", "sim")
    answer = morse("rm", "-f", "sim")
    assert answer.status == 0
    assert "[y/N]" not in answer.out
    assert not (morse.directory / "sim").exists()


def test_rm_forgets_what_is_gone_already(morse):
    morse("create", "sim")
    (morse.directory / "sim").rename(morse.directory / "moved")
    assert morse("rm", "sim").status == 0
    assert sites(morse) == {}


def test_rm_of_an_unknown_name_gives_the_nearest(morse):
    morse("create", "ranger_sim")
    answer = morse("rm", "-f", "rangr_sim")
    assert answer.status == 1
    assert "Did you mean 'ranger_sim'?" in answer.err


def test_rm_never_deletes_the_home_directory(morse):
    morse("import", str(morse.home), "mine")
    answer = morse("rm", "-f", "mine")
    assert answer.status == 1
    assert morse.home.is_dir()
    assert sites(morse) == {}


@pytest.mark.parametrize("content", [b"[sites\nx", b"no section\n", b"[sites]\na = 1\na = 2\n", b"\xff\xfe\x00"])
def test_a_broken_configuration_is_reported_and_not_overwritten(morse, content):
    morse.config.parent.mkdir()
    morse.config.write_bytes(content)
    answer = morse("create", "sim")
    assert answer.status == 1
    assert str(morse.config) in answer.err
    assert answer.err.count("\n") == 1
    assert morse.config.read_bytes() == content


def test_other_sections_of_the_configuration_are_kept(morse):
    morse.config.parent.mkdir()
    morse.config.write_text("[sites]\nold = /somewhere\n\n[mine]\ncolor = blue\n")
    morse("create", "sim")
    config = configparser.ConfigParser()
    config.read(morse.config)
    assert config["sites"]["old"] == "/somewhere"
    assert config["mine"]["color"] == "blue"


def test_no_room_for_the_configuration(morse):
    (morse.home / ".morse").write_text("a file where a directory should be")
    answer = morse("create", "sim")
    assert answer.status == 1
    assert answer.err.startswith("* ")
    assert ".morse" in answer.err
