"""What a scene script does to the process, or raises, is a message that names its line."""

import ast
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import morse
from morse.assets.sdf.script import scene_script
from morse.builder.errors import ScriptError
from morse.system.source_text import inside_quotes, one_line, quoted
from pymorse.component import Component
from pymorse.stubs import stubs
from tests.kit.effort import examples

HEAD, END = "from morse.builder import *\nimport sys\n", '\nFakeRobot("r")\nenv = Environment("empty")\n'
ERRORS = {
    "no_exception": ("class Odd(BaseException): pass\nraise Odd('boo')", r":4: Odd: boo"),
    "generator_exit": ("raise GeneratorExit", r":3: GeneratorExit"),
    "without_a_message": (
        "class Odd(Exception):\n    def __str__(self): raise self\nraise Odd()",
        r":5: Odd: \(its message cannot be read\)",
    ),
    "type_error_without_a_message": (
        "class Odd(TypeError):\n    def __str__(self): return 7\nraise Odd()",
        r":5: Odd: \(its message cannot be read\)",
    ),
    "modifier": ("FakeRobot('x').alter(1.5, 2.5)", r":3: alter\(classpath\) takes a string, got 2.5"),
    "sensors": ("CompoundSensor(1)", r":3: CompoundSensor\(sensors\) takes a list of sensors, got 1"),
    "armature": ("Armature({})", r":3: Armature\(name\) takes a string, got {}"),
}


@pytest.mark.parametrize(("text", "expected"), ERRORS.values(), ids=ERRORS)
def test_an_error_of_any_class_names_its_line(text: str, expected: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    path.write_text(HEAD + text + END)
    with pytest.raises(ScriptError, match=expected):
        morse.load(path)


@pytest.mark.parametrize("text", ["sys.stdout.close()", "sys.stdout = sys.stderr = None"])
def test_a_script_without_a_standard_output_runs_to_its_end(text: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.py"
    path.write_text(HEAD + text + END)
    command = [sys.executable, "-m", "morse", "run", "--headless", "--duration", "0.05", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    if "close()" in text:
        assert "* the log can no longer be written: the standard output was closed" in done.stderr


# -- names of others never become statements of the Python files that MORSE writes -----------------

#: ends a docstring, a string or a comment, and goes on with a statement
ENDS = ['"""', "'", '"', "\r", "\n", "\x0c", "\u2028", "\x85", "\\", "\x1c", ":", ",", ")", "#"]
names = st.lists(st.sampled_from([*ENDS, "x", "\nowned()\n", "; owned(); ", "owned()"]), min_size=1, max_size=8).map(
    "".join
)
quick = settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def _calls(text: str) -> set[str]:
    """The names of all functions that a module calls."""
    tree = ast.parse(text)
    return {ast.unparse(one.func) for one in ast.walk(tree) if isinstance(one, ast.Call)}


@quick
@given(st.text())
@example("\ud800")
def test_a_text_in_quotes_has_the_value_of_the_text(text: str) -> None:
    for literal in (
        quoted(text),
        f"'{inside_quotes(text)}'",
        f'"{inside_quotes(text)}"',
        f'"""{inside_quotes(text)}"""',
    ):
        assert ast.literal_eval(literal) == text


@quick
@given(names)
@example('"""')
@example('""""')
def test_a_comment_and_a_docstring_stay_what_they_are(text: str) -> None:
    assert ast.parse(f"# {one_line(text)}\n").body == []
    (only,) = ast.parse(f'"""{one_line(text)}."""').body
    assert isinstance(only, ast.Expr)
    assert isinstance(only.value, ast.Constant)


@quick
@given(names, names, names)
@example('"""; owned(); """', 'a\rowned()\r"', "p\rowned()\r")
def test_names_of_a_world_stay_names(tmp_path: Path, world: str, model: str, part: str) -> None:
    def attribute(text: str) -> str:
        return quoteattr(
            "".join(c for c in text if c.isprintable() or c in "\r\n\u2028"), {"\r": "&#13;", "\n": "&#10;"}
        )

    box = "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>"
    path = tmp_path / "some.world"
    path.write_text(
        f"<sdf version='1.6'><world name={attribute(world)}><model name={attribute('m' + model)}><link name='l'>{box}"
        f"<sensor name={attribute(part)} type={attribute(part)}/></link>"
        f"<plugin name={attribute(part)} filename={attribute(part)}/></model></world></sdf>",
        encoding="utf-8",
    )
    assert _calls(scene_script(path, tmp_path)) <= {"Robot", "PassiveObject", "Environment"}


class _Server:
    """What a hostile server tells a client about its robots."""

    def __init__(self, name: str) -> None:
        self.robots = [name, "robot"]
        self._name = name

    def __getitem__(self, fqn: str) -> Component:
        client: Any = self
        robot = Component(client, fqn, fqn, ["OUT"], None, [self._name, "get_local_data"])
        robot._parts[self._name] = Component(client, self._name, f"{fqn}.{self._name}", ["IN"], None, [])
        return robot

    def rpc_t(self, *_arguments: object) -> dict[str, object]:
        return {self._name: self._name}


@quick
@given(names)
@example("x: owned()\n    y")
@example("class")
@example("²")
def test_names_of_a_server_stay_names(name: str) -> None:
    server: Any = _Server(name)
    assert _calls(stubs(server)) <= {"TypedDict"}
