"""run: the scene, the options, and their effect on the simulation."""

import math
import os
import socket
import sys
import types
from datetime import date

import pytest

from morse.cli.app import GlobalOptions
from morse.cli.run import color_scheme


@pytest.fixture
def started(monkeypatch):
    """Replaces the simulation: records its arguments; its exit status is 7."""
    runs = []
    module = types.ModuleType("morse.launch.run")

    def run(options, **_):
        runs.append(options)
        return 7

    module.run = run
    monkeypatch.setitem(sys.modules, "morse.launch.run", module)
    return runs


@pytest.fixture
def project(morse):
    morse("create", "ranger_sim")
    return morse.directory / "ranger_sim"


def test_the_environment_of_the_tutorial(morse, project, started):
    assert morse("run", "ranger_sim").status == 7
    (options,) = started
    assert options.script == str(project / "default.py")
    assert options.arguments == []
    assert options.source_paths == [str(project / "src")]
    assert options.host == "127.0.0.1"
    assert options.view == "web"
    assert (options.speed, options.duration, options.seed) == (None, None, None)
    assert options.open_browser
    assert not options.profile


@pytest.mark.parametrize("word", ["max", "inf"])
def test_as_fast_as_possible(morse, project, started, word):
    assert morse("run", "--speed", word, "ranger_sim").status == 7
    assert started[0].speed == math.inf


@pytest.mark.parametrize("command", ["run", "verify"])
@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--ticks", "0"], "--ticks takes an integer of at least 1, such as 600; got 0"),
        (["--ticks", "-5"], "got -5"),
        (["--ticks", "many"], "--ticks takes an integer, not 'many'"),
        (["--duration", "0"], "--duration takes a number greater than 0"),
        (["--duration", "1e10"], "at most 1e+09 simulated seconds"),
        (["--duration", "1", "--ticks", "60"], "give one of them"),
    ],
)
def test_lengths_that_are_none(morse, project, started, command, options, said):
    answer = morse(command, *options, "ranger_sim")
    assert answer.status == 2
    assert said in answer.err
    assert not started


def test_a_number_of_ticks(morse, project, started):
    morse("run", "--ticks", "600", "ranger_sim")
    assert (started[0].duration, started[0].ticks) == (None, 600)


@pytest.mark.parametrize(("options", "said"), [(["--duration", "0.05"], "0.05 s"), (["--ticks", "3"], "3 ticks")])
def test_verify_for_a_while(morse, options, said):
    (morse.directory / "scene.py").write_text(
        "from morse.builder import *\nrobot = ATRV()\nenv = Environment('empty')\n"
    )
    answer = morse("verify", "scene.py", *options)
    assert answer.status == 0
    assert answer.out.splitlines()[-1] == f"* Repeatable: {said} are equal to the bit."


def test_models_of_the_project_are_found(morse, project, started):
    (project / "data").mkdir()
    morse("run", "ranger_sim")
    assert started[0].resource_paths == [str(project / "data")]


def test_from_anywhere(morse, project, started, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    morse("run", "ranger_sim")
    assert started[0].script == str(project / "default.py")


@pytest.mark.parametrize("spelling", ["ranger_sim/", "Ranger_Sim"])
def test_names_as_completed_by_a_shell_or_in_capitals(morse, project, started, spelling):
    assert morse("run", spelling).status == 7
    assert started[0].script == str(project / "default.py")


def test_another_file_of_the_environment(morse, project, started):
    (project / "night.py").write_text("")
    morse("run", "ranger_sim", "night.py", "a")
    assert started[0].script == str(project / "night.py")
    assert started[0].arguments == ["a"]


def test_a_file_of_the_current_directory_with_an_environment(morse, project, started):
    (morse.directory / "here.py").write_text("")
    morse("run", "ranger_sim", "here.py")
    assert started[0].script == str(morse.directory / "here.py")
    assert started[0].source_paths == [str(project / "src")]


def test_what_follows_the_scene_is_the_scripts(morse, project, started):
    rest = ["arg1", "--foo", "-g", "--", "--speed=3", "-h", "--help", "", "x y"]
    (project / "default.py").write_text("import sys\nprint(sys.argv)\n")
    assert morse("run", "--speed", "2", "ranger_sim", "default.py", *rest).status == 7
    assert started[0].arguments == rest
    assert started[0].speed == 2.0


def test_options_may_follow_the_environment_at_once(morse, project, started):
    morse("run", "ranger_sim", "--foo", "default.py")
    assert started[0].script == str(project / "default.py")
    assert started[0].arguments == ["--foo", "default.py"]


@pytest.mark.parametrize(
    ("rest", "expected"),
    [
        (["--headless"], {"view": "none", "duration": None, "arguments": []}),
        (["--headless", "--duration", "5"], {"view": "none", "duration": 5.0}),
        (["default.py", "a b", "--duration=5", "-g", "80x60"], {"view": "web", "duration": 5.0, "arguments": ["a b"]}),
        (["--no-browser", "--speed", "3"], {"open_browser": False, "speed": 3.0}),
    ],
)
def test_own_options_may_follow_a_scene_that_reads_no_arguments(morse, project, started, rest, expected):
    assert morse("run", "--seed", "9", "--speed", "2", "ranger_sim", *rest).status == 7
    wanted = {"seed": 9, "speed": 2.0} | expected
    assert {name: getattr(started[0], name) for name in wanted} == wanted


@pytest.mark.parametrize(("rest", "what"), [(["--duration"], "--duration"), (["--duration", "soon"], "soon")])
def test_mistakes_in_own_options_behind_a_scene_are_named(morse, project, started, rest, what):
    answer = morse("run", "ranger_sim", *rest)
    assert answer.status == 2
    assert what in answer.err
    assert started == []


@pytest.mark.parametrize(
    "reader",
    [
        "import sys\nprint(sys.argv)\n",
        "from sys import argv as given\n",
        "import argparse\n",
        "from click.core import Command\n",
        "import night\n",
        "from ranger_sim import night\n",
        "from ranger_sim.night import *\n",
    ],
)
def test_own_options_behind_a_scene_that_reads_its_arguments_are_its_own(morse, project, started, reader):
    (project / "default.py").write_text(reader)
    for folder in (project, project / "src" / "ranger_sim"):
        (folder / "night.py").write_text("import sys\nhere = sys.argv[1:]\n")
    answer = morse("run", "ranger_sim", "--headless")
    assert answer.status == 7
    assert "before the scene" in answer.err
    assert started[0].view == "web"
    assert started[0].arguments == ["--headless"]


def test_other_options_that_nobody_reads_get_a_warning(morse, project, started):
    answer = morse("run", "ranger_sim", "--wind", "3")
    assert answer.status == 7
    assert "--wind: the script does not read its arguments" in answer.err


@pytest.mark.parametrize("duration", ["1e308", "inf", "nan", "0", "-1", "soon"])
def test_durations_that_cannot_be(morse, project, started, duration):
    answer = morse("run", "--duration", duration, "ranger_sim")
    assert answer.status == 2
    assert len(answer.err.strip().splitlines()) == 1
    assert "--duration takes" in answer.err
    assert started == []


@pytest.mark.parametrize("broken", ["[sites", "[sites]\nname\n", "\xff\xfe", None])
def test_a_broken_configuration_stops_no_scene_that_is_given_by_its_path(morse, project, started, broken, monkeypatch):
    morse.config.unlink()
    if broken is None:
        morse.config.mkdir()
    else:
        morse.config.write_text(broken, encoding="latin-1")
    for words in (["ranger_sim/default.py"], ["ranger_sim"]):
        answer = morse("run", *words)
        assert answer.status == 7
        assert "is not a valid configuration file" in answer.err
    answer = morse("run", "other_sim")
    assert answer.status == 1
    assert "is not a valid configuration file" in answer.err
    monkeypatch.chdir(project)
    assert morse("run").status == 7


@pytest.mark.parametrize("name", ["scene.py", "scene", "scene.txt", "scene.blend"])
def test_a_path_may_have_any_suffix(morse, started, name):
    (morse.directory / name).write_text("")
    assert morse("run", name, "a", "--b").status == 7
    assert started[0].script == str(morse.directory / name)
    assert started[0].arguments == ["a", "--b"]
    assert started[0].source_paths == []
    assert started[0].resource_paths == []


def test_a_script_run_by_its_path_finds_its_registered_project(morse, project, started):
    (project / "data").mkdir()
    (project / "scenes").mkdir()
    (project / "scenes" / "night.py").write_text("")
    morse("run", "ranger_sim/scenes/night.py")
    assert started[0].source_paths == [str(project / "src")]
    assert started[0].resource_paths == [str(project / "data")]


def test_a_script_run_by_its_path_finds_an_unregistered_project(morse, started):
    for folder in ("src", "data"):
        (morse.directory / "old" / folder).mkdir(parents=True)
    (morse.directory / "old" / "default.py").write_text("")
    morse("run", "./old/default.py")
    assert started[0].source_paths == [str(morse.directory / "old" / "src")]
    assert started[0].resource_paths == [str(morse.directory / "old" / "data")]


def test_a_directory_that_is_not_registered(morse, started):
    (morse.directory / "old" / "src").mkdir(parents=True)
    (morse.directory / "old" / "default.py").write_text("")
    assert morse("run", "./old/").status == 7
    assert started[0].script == str(morse.directory / "old" / "default.py")
    assert started[0].source_paths == [str(morse.directory / "old" / "src")]


def test_in_the_project_itself_no_name_is_needed(morse, project, started, monkeypatch):
    monkeypatch.chdir(project)
    assert morse("run").status == 7
    assert started[0].script == str(project / "default.py")


def test_without_default_py_the_first_scene_runs_with_a_warning(morse, project, started):
    (project / "default.py").unlink()
    for name in ("b.blend", "c.py", "a.txt"):
        (project / name).write_text("")
    answer = morse("run", "ranger_sim")
    assert answer.status == 7
    assert "b.blend" in answer.err
    assert started[0].script == str(project / "b.blend")


def test_clients_beside_a_scene_are_no_scenes(morse, tmp_path, started):
    folder = tmp_path / "laser"
    folder.mkdir()
    (folder / "client.py").write_text("from pymorse import Morse\n")
    (folder / "scene.py").write_text("from morse.builder import *\n")
    answer = morse("run", str(folder))
    assert "running scene.py" in answer.err
    assert started[0].script == str(folder / "scene.py")


def test_an_environment_without_scenes(morse, project, started):
    (project / "default.py").unlink()
    answer = morse("run", "ranger_sim")
    assert answer.status == 1
    assert str(project) in answer.err
    assert started == []


def test_no_scene_at_all(morse, started):
    answer = morse("run")
    assert answer.status == 2
    assert "morse create" in answer.err
    assert started == []


def test_an_unknown_name_gives_the_nearest_and_lists_all(morse, project, started):
    answer = morse("run", "rangersim")
    assert answer.status == 1
    assert "Did you mean 'ranger_sim'?" in answer.err
    assert answer.err.count("\n") == 1
    assert started == []


def test_a_mistyped_path_gives_the_nearest(morse, started):
    (morse.directory / "scene.py").write_text("")
    assert "Did you mean 'scene.py'?" in morse("run", "scnee.py").err


def test_a_mistyped_file_of_an_environment_gives_the_nearest(morse, project, started):
    answer = morse("run", "ranger_sim", "defualt.py")
    assert answer.status == 1
    assert "Did you mean 'default.py'?" in answer.err
    assert started == []


def test_all_options(morse, project, started, monkeypatch):
    monkeypatch.setenv("MORSE_NODE", "other")
    words = "--name node1 -g 800x600+10,20 --view studio --view-port 0 --view-token secret --host 127.0.0.1"
    words += " --view-origin http://localhost:8080 --view-origin https://Example.org/"
    words += " --speed max --duration 2.5 --seed 3 --profile --no-browser ranger_sim"
    assert morse("run", *words.split()).status == 7
    (options,) = started
    assert options.node_name == "node1"
    assert options.view == "studio"
    assert options.view_port == 0
    assert options.view_token == "secret"
    assert options.view_origins == ["http://localhost:8080", "https://example.org"]
    assert options.speed == math.inf
    assert options.duration == 2.5
    assert options.seed == 3
    assert options.profile
    assert not options.open_browser


@pytest.mark.parametrize(
    ("words", "watched"),
    [
        ("", True),
        ("--no-watch", False),
        ("--headless", False),
        ("--headless --watch", True),
        ("--view studio", False),
        ("--view studio --watch", True),
    ],
)
def test_files_are_watched_with_the_live_view_unless_said_otherwise(morse, project, started, words, watched):
    assert morse("run", *words.split(), "ranger_sim").status == 7
    assert started[0].watch is watched


def test_name_of_the_node_from_the_environment(morse, project, started, monkeypatch):
    monkeypatch.setenv("MORSE_NODE", "node2")
    morse("run", "ranger_sim")
    assert started[0].node_name == "node2"


def test_scripts_find_the_name_of_the_node_where_1_4_put_it(morse, project, started, monkeypatch):
    morse("run", "ranger_sim")
    assert os.environ["MORSE_NODE"] == started[0].node_name == socket.gethostname()
    morse("run", "--name", "node3", "ranger_sim")
    assert os.environ["MORSE_NODE"] == started[1].node_name == "node3"


def test_headless_means_no_view(morse, project, started):
    morse("run", "--headless", "ranger_sim")
    morse("run", "--view", "none", "ranger_sim")
    assert [options.view for options in started] == ["none", "none"]


@pytest.mark.parametrize(
    "words",
    [
        *(["--speed", value] for value in ("0", "-1", "nan", "-inf", "fast", "", "1e999", "MAX ")),
        *(["--duration", value] for value in ("0", "-1", "nan", "inf", "max", "", "1e-999")),
        *(["--seed", value] for value in ("-1", "1.5", "x", "")),
        *(["--view-port", value] for value in ("-1", "65536", "http", "")),
        *(["--view", value] for value in ("", "Web", "window")),
        *(["--host", value] for value in ("", "192.0.2.1", "no such host", "a\u0000b", "x" * 300)),
        *(["-g", value] for value in ("", "800", "800x", "800x600+1", "-800x600")),
        ["--headless", "--view", "web"],
        ["--view-token", ""],
        ["--view-origin", "*"],
        ["--sped", "1"],
        ["--speed"],
    ],
)
def test_bad_options_get_one_line(morse, project, started, words):
    answer = morse("run", *words, *(["ranger_sim"] if words != ["--speed"] else []))
    assert answer.status == 2
    assert answer.out == ""
    assert answer.err.startswith("* ")
    assert answer.err.count("\n") == 1
    assert words[0].lstrip("-")[:1] in answer.err
    assert started == []


def test_a_crash_of_the_simulator_leaves_its_mark_in_the_log(morse, project, started, monkeypatch):
    def crash(options, **_):
        raise RuntimeError("the world has ended")

    monkeypatch.setattr(sys.modules["morse.launch.run"], "run", crash)
    answer = morse("run", "ranger_sim")
    assert answer.status == 1
    assert "[ERROR][MORSE] Uncaught exception" in answer.out
    assert "RuntimeError: the world has ended" in answer.out


@pytest.mark.parametrize(
    ("color", "reverse", "day", "scheme"),
    [
        (False, False, date(2024, 12, 26), "mono"),
        (True, False, date(2024, 12, 24), "bright"),
        (True, True, date(2024, 6, 1), "dark"),
        (False, True, date(2024, 6, 1), "dark"),
        (True, False, date(2024, 12, 25), "xmas"),
        (True, True, date(2024, 12, 31), "xmas"),
        (True, False, date(2025, 1, 1), "bright"),
    ],
)
def test_colors(color, reverse, day, scheme):
    assert color_scheme(GlobalOptions(color, reverse), day) == scheme


@pytest.mark.parametrize("words", [["-c"], ["-n", "-c"], ["--reverse-color"], ["--noaudio"]])
def test_global_options_stand_before_the_command(morse, project, started, words):
    assert morse(*words, "run", "ranger_sim").status == 7
