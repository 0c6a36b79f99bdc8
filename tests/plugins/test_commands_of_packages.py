"""Commands of packages by entry points of `morse.commands`: what is broken is named, and the other commands work."""

from __future__ import annotations

from pathlib import Path

import pytest

import morse
from tests.kit.programs import commands, python

SOURCES = str(Path(morse.__file__).parents[1])

LAB = '''
import sys
from typing import Annotated

import typer

from morse.core.exceptions import MorseError

no_function = 3


def greet(
    who: Annotated[str, typer.Argument(help="Who is greeted.")],
    times: Annotated[int, typer.Option("--times", min=1, help="How often.")] = 1,
) -> int:
    """Greet a robot."""
    print(" ".join([f"Hello {who}!"] * times))
    return 7


def refuse() -> None:
    """Refuse."""
    raise MorseError("the robot is asleep")


def crash() -> None:
    """Crash."""
    return 1 / 0


def leave() -> None:
    """Leave with a status."""
    sys.exit(5)


def deep() -> None:
    """Call itself."""
    deep()


def unknown(file: "Path") -> None:
    """Take a file."""


def unreadable() -> None: ...


unreadable.__signature__ = 5


class Described(type):
    @property
    def __doc__(cls):
        raise SystemExit(3)


class Undescribed(metaclass=Described): ...


def positive(value: int) -> int:
    raise ValueError("out of order")


def checked(number: Annotated[int, typer.Option("--number", callback=positive)] = 1) -> None:
    """Check a number."""


def numbered() -> None:
    print("numbered")


numbered.__doc__ = 5
'''

ENTRIES = {
    "greet": "lab:greet",
    "refuse": "lab:refuse",
    "crash": "lab:crash",
    "leave": "lab:leave",
    "deep": "lab:deep",
    "number": "lab:no_function",
    "absent": "lab:there_is_none",
    "nowhere": "no_such_module:command",
    "ends": "ends:command",
    "run": "lab:crash",
    "unknown": "lab:unknown",
    "unreadable": "lab:unreadable",
    "undescribed": "lab:Undescribed",
    "checked": "lab:checked",
    "numbered": "lab:numbered",
}


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    (folder / "src").mkdir()
    (folder / "src/lab.py").write_text(LAB)
    (folder / "src/ends.py").write_text("import sys\nsys.exit(0)\n")
    lines = "\n".join(f'{name} = "{place}"' for name, place in ENTRIES.items())
    (folder / "pyproject.toml").write_text(
        f'[project]\nname = "lab"\nversion = "1"\n\n[project.entry-points."morse.commands"]\n{lines}\n'
    )
    return folder


@pytest.fixture
def home(tmp_path):
    return {"HOME": str(tmp_path), "USERPROFILE": str(tmp_path), "PYTHONPATH": SOURCES}


@pytest.fixture
def command(project, home):
    return lambda *words: python("-m", "morse", *words, folder=project, **home)


def test_a_command_takes_its_arguments_and_gives_its_status(command):
    result = command("greet", "Morsy", "--times", "2")
    assert (result.returncode, result.stdout) == (7, "Hello Morsy! Hello Morsy!\n")


def test_its_options_are_checked_and_shown_as_those_of_morse(command):
    wrong = command("greet", "Morsy", "--times", "0")
    assert wrong.returncode == 2
    assert "--times takes an integer of at least 1, not '0'" in wrong.stderr
    assert "Who is greeted." in command("greet", "-h").stdout


def test_the_help_lists_commands_of_packages_and_says_which_are_broken(command):
    result = command("-h")
    assert result.returncode == 0
    assert "Greet a robot." in result.stdout
    assert result.stdout.count("(broken)") == 7


def test_a_faulty_command_ends_with_a_message_and_status_1(project, home):
    messages = {
        "number": "expected a function",
        "absent": "there_is_none",
        "nowhere": "no_such_module",
        "ends": "cannot be loaded",
        "refuse": "* The robot is asleep.",
        "crash": 'lab.py", line 28, in crash',
        "deep": "RecursionError",
        "unknown": "(lab:unknown) cannot be loaded: NameError: name 'Path' is not defined",
        "unreadable": "(lab:unreadable) cannot be loaded: TypeError",
        "undescribed": "(lab:Undescribed) cannot be loaded: SystemExit",
        "checked": "has failed: ValueError: out of order",
    }
    outcomes = commands([(project, [name]) for name in messages], **home)
    for (name, message), outcome in zip(messages.items(), outcomes, strict=True):
        assert outcome.status == 1, name
        assert message.lower() in outcome.err.lower()
        assert "Traceback" not in outcome.err


def test_the_text_of_a_command_may_be_none(command):
    assert command("numbered").stdout == "numbered\n"


def test_a_command_may_end_with_a_status_of_its_own(command):
    assert command("leave").returncode == 5


def test_a_package_does_not_replace_a_command_of_morse(command):
    result = command("run", "-h")
    assert result.returncode == 0
    assert "Crash." not in result.stdout


def test_a_mistyped_name_gets_the_nearest_command_of_a_package(command):
    result = command("gret")
    assert result.returncode == 2
    assert "Did you mean 'greet'?" in result.stderr
