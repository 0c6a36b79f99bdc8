"""The `morse` and `morseexec` programs in separate processes, and their help."""

import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import morse
from morse.version import __version__

SOURCES = str(Path(morse.__file__).parents[1])
MORSE = "from morse.cli import main; main()"
MORSEEXEC = "from morse.cli.morseexec import main; main()"


def program(code, *words, home, stdin="", **variables):
    environment = {**os.environ, "HOME": str(home), "USERPROFILE": str(home), "PYTHONPATH": SOURCES, **variables}
    return subprocess.run(
        [sys.executable, "-c", code, *words],
        input=stdin,
        env=environment,
        cwd=home,
        capture_output=True,
        encoding="utf-8",
        timeout=60,
        check=False,
    )


def test_version(tmp_path):
    result = program(MORSE, "-v", home=tmp_path)
    assert (result.returncode, result.stdout) == (0, f"morse {__version__}\n")
    assert morse.__version__ == version("morse-simulator") == __version__


@pytest.mark.parametrize("command", ["create", "rm", "import", "-v", "-h"])
def test_small_commands_do_not_load_the_simulator(tmp_path, command):
    code = (
        f"{MORSE.split(';')[0]}; import sys; sys.argv[1:] = [{command!r}, '-h']\ntry: main()\nexcept SystemExit: pass\n"
    )
    code += "print(sorted({'numpy', 'mujoco', 'rich.table'} & set(sys.modules)))"
    if command == "-v":
        code = code.replace(", '-h'", "")
    result = program(code, home=tmp_path)
    loaded = eval(result.stdout.splitlines()[-1])
    assert not {"numpy", "mujoco"} & set(loaded)


def test_without_a_command_usage_is_shown(morse):
    answer = morse()
    assert answer.status == 0
    for command in ("create", "import", "rm", "add", "check", "run", "edit"):
        assert command in answer.out


@pytest.mark.parametrize("option", ["-h", "--help"])
def test_help(morse, option):
    for words in ([], ["create"], ["import"], ["rm"], ["add"], ["check"], ["run"], ["edit"]):
        answer = morse(*words, option)
        assert answer.status == 0
        assert "Usage: morse" in answer.out
        assert answer.err == ""


def test_narrow_help_has_whole_sentences(tmp_path):
    answer = program(MORSE, "-h", home=tmp_path, COLUMNS="40")
    assert "..." not in answer.stdout.replace("[ARGS]...", "")
    assert "Create a new simulation environment in the current directory" in " ".join(answer.stdout.split())


def test_narrow_check_has_whole_words(tmp_path):
    answer = program(MORSE, "check", home=tmp_path, COLUMNS="40")
    words = answer.stdout.split()
    assert {"msgspec:", "websockets:", "mapbox_earcut:"} <= set(words)


@pytest.mark.parametrize("command", ["verify", "render", "replay", "sweep", "export"])
def test_help_names_values_without_types_of_python(morse, command):
    text = morse(command, "-h").out
    assert "<" not in text
    assert "range" not in text


def test_narrow_help_has_whole_names(tmp_path):
    answer = program(MORSE, "-h", home=tmp_path, COLUMNS="40")
    assert answer.returncode == 0
    assert {"--reverse-color", "--install-completion"} <= set(answer.stdout.split())


@pytest.mark.parametrize(("typed", "meant"), [("crete", "create"), ("runn", "run"), ("chek", "check"), ("ad", "add")])
def test_a_mistyped_command_gives_the_nearest(morse, typed, meant):
    answer = morse(typed)
    assert answer.status == 2
    assert f"Did you mean '{meant}'?" in answer.err
    assert answer.err.count("\n") == 1


@pytest.mark.parametrize(
    "words",
    [["create"], ["rm"], ["import"], ["add", "robot"], ["create", "a", "b"], ["--foo"], ["create", "--foo", "a"]],
)
def test_wrong_words_get_one_line(morse, words):
    answer = morse(*words)
    assert answer.status == 2
    assert answer.err.startswith("* ")
    assert answer.err.count("\n") == 1
    assert "-h" in answer.err


def test_journey_of_a_project_through_processes(tmp_path):
    assert program(MORSE, "create", "sim", home=tmp_path).returncode == 0
    added = program(MORSE, "add", "sensor", "nose", "sim", home=tmp_path, stdin="Smells\n")
    assert added.returncode == 0, added.stderr
    assert '_short_desc = "Smells"' in (tmp_path / "sim/src/sim/sensors/nose.py").read_text()
    assert program(MORSE, "rm", "sim", home=tmp_path, stdin="y\n").returncode == 0
    assert not (tmp_path / "sim").exists()


def test_add_without_any_standard_input(tmp_path):
    program(MORSE, "create", "sim", home=tmp_path)
    code = f"import sys; sys.stdin = None; {MORSE}"
    assert program(code, "add", "sensor", "nose", "sim", home=tmp_path).returncode == 0


@pytest.mark.parametrize("locale", [{"PYTHONIOENCODING": "ascii"}, {"LC_ALL": "C"}], ids=["terminal", "locale"])
def test_an_ascii_terminal_is_no_obstacle(tmp_path, locale):
    directory = tmp_path / "Größe"
    directory.mkdir()
    result = program(MORSE, "import", str(directory), "sim", home=tmp_path, PYTHONUTF8="0", **locale)
    assert result.returncode == 0, result.stderr
    assert "Größe".encode() in (tmp_path / ".morse" / "config").read_bytes()
    again = program(MORSE, "import", "-f", str(directory), "other", home=tmp_path, PYTHONUTF8="0", **locale)
    assert again.returncode == 0, again.stderr


def test_morseexec_runs_a_script(tmp_path):
    result = program(MORSEEXEC, "nosuch.py", home=tmp_path)
    assert result.returncode == 1
    assert "'nosuch.py' is neither a registered environment nor a file" in result.stderr


def test_morseexec_without_a_script(tmp_path):
    result = program(MORSEEXEC, home=tmp_path)
    assert result.returncode == 2
    assert "morseexec SCRIPT" in result.stderr


@pytest.mark.parametrize(
    ("line", "completed"),
    [
        ("morse r", {"render", "replay", "rm", "run"}),
        ("morse run --he", {"--headless", "--help"}),
        ("morse verify --t", {"--ticks"}),
    ],
)
def test_the_shell_completes_commands_and_options(tmp_path, monkeypatch, line, completed):
    monkeypatch.setenv("_MORSE_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(line.count(" ")))
    result = program(MORSE, home=tmp_path)
    assert (result.returncode, set(result.stdout.split())) == (0, completed)


@pytest.mark.parametrize("words", [["run", "--headless"], ["check"], ["render"]])
@pytest.mark.parametrize("error", ["OSError('libmujoco.so: cannot open')", "ImportError('no symbol')"])
def test_a_mujoco_that_cannot_be_loaded_is_named_without_a_traceback(tmp_path, words, error):
    (tmp_path / "mujoco").mkdir()
    (tmp_path / "mujoco" / "__init__.py").write_text(f"raise {error}")
    (tmp_path / "scene.py").write_text("from morse.builder import *\nrobot = ATRV()\nEnvironment('empty')\n")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {MORSE}"
    result = program(code, *words, "scene.py", home=tmp_path)
    assert result.returncode == 1
    assert "MuJoCo cannot be loaded" in result.stderr
    assert "`morse check`" in result.stderr
    assert "Traceback" not in result.stderr
