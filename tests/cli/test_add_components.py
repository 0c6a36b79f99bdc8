"""add: the files of your own robot, sensor and actuator."""

import ast
import importlib
import keyword
import re
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.cli.environments import Values, class_name, component_name, templates_directory, write_component
from morse.cli.messages import CommandError
from morse.core.declarations import data_fields
from morse.core.services import declared_services
from tests.kit.effort import examples


def files_below(directory):
    return {str(p.relative_to(directory)) for p in directory.rglob("*") if p.is_file()}


@pytest.fixture
def project(morse):
    morse("create", "ranger_sim")
    return morse.directory / "ranger_sim"


@pytest.fixture
def sources(project, monkeypatch):
    """Makes the packages of the project importable; they are removed afterwards."""
    monkeypatch.syspath_prepend(str(project / "src"))
    before = set(sys.modules)
    yield project / "src"
    for name in set(sys.modules) - before:
        if name.split(".")[0] == "ranger_sim":
            del sys.modules[name]


def test_robot(morse, project):
    before = files_below(project)
    answer = morse("add", "robot", "ranger", "ranger_sim")
    assert answer.status == 0, answer.err
    assert files_below(project) - before == {
        "data/ranger_sim/robots/ranger.blend",
        "src/ranger_sim/robots/ranger.py",
        "src/ranger_sim/robots/__init__.py",
        "src/ranger_sim/builder/robots/ranger.py",
        "src/ranger_sim/builder/robots/__init__.py",
    }
    assert "from ranger_sim.builder.robots import Ranger" in answer.out
    builders = (project / "src/ranger_sim/builder/robots/__init__.py").read_text()
    assert builders == "from .ranger import Ranger\n"
    body = (project / "data/ranger_sim/robots/ranger.blend").read_bytes()
    assert body == (templates_directory() / "robot.blend").read_bytes()


def test_how_to_of_a_robot_says_where_the_models_of_morse_are(morse, project):
    answer = morse("add", "robot", "ranger", "ranger_sim")
    line = next(line for line in answer.out.splitlines() if line.endswith("props"))
    assert (Path(line.split()[-1]).parent / "templates").is_dir()


@pytest.mark.parametrize("kind", ["sensor", "actuator"])
def test_sensor_and_actuator(morse, project, kind):
    before = files_below(project)
    answer = morse("add", kind, "eyes", "ranger_sim", stdin=b"Controls the eyes\n")
    assert answer.status == 0, answer.err
    assert files_below(project) - before == {
        f"src/ranger_sim/{kind}s/eyes.py",
        f"src/ranger_sim/{kind}s/__init__.py",
        f"src/ranger_sim/builder/{kind}s/eyes.py",
        f"src/ranger_sim/builder/{kind}s/__init__.py",
    }
    assert "description" in answer.out
    assert f"from ranger_sim.builder.{kind}s import Eyes" in answer.out
    assert '_short_desc = "Controls the eyes"' in (project / f"src/ranger_sim/{kind}s/eyes.py").read_text()
    builder = (project / f"src/ranger_sim/builder/{kind}s/eyes.py").read_text()
    assert f'_classpath = "ranger_sim.{kind}s.eyes.Eyes"' in builder
    assert '_blendname = "eyes"' in builder


def test_actuator_declares_what_the_documentation_says(morse, sources):
    morse("add", "actuator", "eyes", "ranger_sim", stdin=b"Controls the eyes\n")
    eyes = importlib.import_module("ranger_sim.actuators.eyes").Eyes
    field = data_fields(eyes)["counter"]
    assert (field.default, field.type) == (0, "int")
    services = {service.name: service.asynchronous for service in declared_services(eyes)}
    assert services["get_counter"] is False
    assert services["async_test"] is True
    assert eyes._short_desc == "Controls the eyes"


def test_sensor_declares_what_the_documentation_says(morse, sources):
    morse("add", "sensor", "nose", "ranger_sim", stdin=b"Smells\n")
    nose = importlib.import_module("ranger_sim.sensors.nose").Nose
    fields = data_fields(nose)
    assert fields["distance"].default == 0.0
    assert fields["color"].default == "none"
    assert "get_current_distance" in {service.name for service in declared_services(nose)}


def test_robot_behaviour_has_its_name(morse, sources):
    morse("add", "robot", "ranger", "ranger_sim")
    ranger = importlib.import_module("ranger_sim.robots.ranger").Ranger
    assert ranger._name == "ranger robot"


def test_second_component_is_appended(morse, project):
    morse("add", "robot", "one", "ranger_sim")
    init = project / "src/ranger_sim/robots/__init__.py"
    init.write_text("# mine\n")
    assert morse("add", "robot", "two", "ranger_sim").status == 0
    lines = (project / "src/ranger_sim/builder/robots/__init__.py").read_text().splitlines()
    assert lines == ["from .one import One", "from .two import Two"]
    assert init.read_text() == "# mine\n"


def test_a_last_line_without_newline_is_not_glued(morse, project):
    target = project / "src/ranger_sim/builder/robots/__init__.py"
    target.parent.mkdir(parents=True)
    target.write_text("import math")
    morse("add", "robot", "one", "ranger_sim")
    assert target.read_text() == "import math\nfrom .one import One\n"


def test_an_existing_component_is_kept_unless_forced(morse, project):
    morse("add", "actuator", "eyes", "ranger_sim")
    edited = project / "src/ranger_sim/actuators/eyes.py"
    edited.write_text("# my work\n")
    answer = morse("add", "actuator", "eyes", "ranger_sim", stdin=b"again\n")
    assert answer.status == 1
    assert str(edited) in answer.err
    assert "-f" in answer.err
    assert "description" not in answer.out
    assert edited.read_text() == "# my work\n"
    assert morse("add", "-f", "actuator", "eyes", "ranger_sim").status == 0
    assert "class Eyes" in edited.read_text()
    lines = (project / "src/ranger_sim/builder/actuators/__init__.py").read_text().splitlines()
    assert lines == ["from .eyes import Eyes"]


@pytest.mark.parametrize(
    "description",
    [
        b"",
        b'says "hello"\n',
        b"ends with a backslash \\\n",
        b'"""\n',
        b"it's\n",
        b"\xff\xfe not UTF-8\n",
        b"with \x00 and \x1b[31m\n",
        "@name@ Größe → ∞\n".encode(),
        b"x" * 100_000,
    ],
)
def test_any_description_gives_valid_python(morse, project, description):
    assert morse("add", "sensor", "nose", "ranger_sim", stdin=description).status == 0
    for path in ("sensors/nose.py", "builder/sensors/nose.py"):
        source = (project / "src/ranger_sim" / path).read_text(encoding="utf-8")
        ast.parse(source)


def test_description_is_taken_literally(morse, sources):
    morse("add", "sensor", "nose", "ranger_sim", stdin=b'a "@name@" \\ it\'s\n')
    module = importlib.import_module("ranger_sim.sensors.nose")
    assert module.Nose._short_desc == 'a "@name@" \\ it\'s'
    assert module.Nose.__doc__ == module.Nose._short_desc


def test_class_name_has_one_capital(morse, project):
    answer = morse("add", "robot", "myBot", "ranger_sim")
    assert answer.status == 0
    assert "import Mybot" in answer.out
    assert (project / "src/ranger_sim/robots/myBot.py").exists()


def test_underscores_are_dropped_with_a_warning(morse, project):
    answer = morse("add", "robot", "my_bot", "ranger_sim")
    assert answer.status == 0
    assert "Warning" in answer.err
    assert "'mybot'" in answer.err
    assert "import Mybot" in answer.out


def test_a_digit_in_front_gets_an_underscore(morse, project):
    answer = morse("add", "robot", "3po", "ranger_sim")
    assert answer.status == 0
    assert "import _3po" in answer.out


@pytest.mark.parametrize("name", ["class", "_class", "none", "con"])
def test_reserved_words_are_refused_with_a_free_name(morse, project, name):
    answer = morse("add", "sensor", name, "ranger_sim")
    assert answer.status == 1
    assert f"Use, for example, '{name.strip('_')}1'" in answer.err


@pytest.mark.parametrize("name", ["../evil", "/evil", "a/b", "..\\evil", ".", "..", "", "_", "--", "!?"])
def test_bad_names_are_refused(morse, project, name):
    before = files_below(morse.directory.parent)
    answer = morse("add", "robot", "--", name, "ranger_sim")
    assert answer.status == 1
    assert answer.err.startswith("* ")
    assert files_below(morse.directory.parent) == before


@pytest.mark.parametrize("name", ["pose", "Keyboard"])
def test_a_robot_cannot_hide_its_own_equipment(morse, project, name):
    answer = morse("add", "robot", name, "ranger_sim")
    assert answer.status == 1
    assert name.capitalize() in answer.err


def test_a_name_too_long_for_the_disk(morse, project):
    answer = morse("add", "robot", "a" * 300, "ranger_sim")
    assert answer.status == 1
    assert "too long" in answer.err
    assert answer.err.count("\n") == 1


def test_unknown_environment_gives_the_nearest(morse, project):
    answer = morse("add", "robot", "ranger", "rangersim")
    assert answer.status == 1
    assert "Did you mean 'ranger_sim'?" in answer.err


def test_vanished_environment(morse, project):
    project.rename(morse.directory / "moved")
    answer = morse("add", "robot", "ranger", "ranger_sim")
    assert answer.status == 1
    assert "morse import -f" in answer.err


def test_unknown_kind_gives_the_nearest(morse, project):
    answer = morse("add", "sensors", "nose", "ranger_sim")
    assert answer.status == 2
    assert "Did you mean 'sensor'?" in answer.err


def test_an_environment_with_capitals_keeps_one_package(morse):
    morse("create", "MySim")
    answer = morse("add", "robot", "one", "mysim")
    assert answer.status == 0
    assert "from MySim.builder.robots import One" in answer.out
    assert (morse.directory / "MySim/src/MySim/robots/one.py").exists()


names = st.text(min_size=1, max_size=30) | st.from_regex(r"[\w .-]{1,20}", fullmatch=True)
FORBIDDEN = {"con", "prn", "aux", "nul", *(word.lower() for word in keyword.kwlist)} | {
    f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)
}
reserved = st.sampled_from([*keyword.kwlist, *(word.lower() for word in keyword.kwlist), "con", "NUL", "lpt1"])


@given(names | reserved)
def test_safe_names_can_be_imported(text):
    try:
        name = component_name(text)
    except CommandError:
        return
    for identifier in (name, class_name(name)):
        assert identifier.isidentifier()
        assert not keyword.iskeyword(identifier)
    assert not any(character in name for character in "/\\.\0")
    # Python looks up the normalised form of an identifier
    namespace: dict[str, object] = {}
    exec(f"class {class_name(name)}: pass", namespace)
    assert class_name(name) in namespace


@given(st.from_regex(r"[A-Za-z][A-Za-z0-9]{0,20}", fullmatch=True).filter(lambda t: t.lower() not in FORBIDDEN))
def test_letters_and_digits_stay_as_they_are(text):
    assert component_name(text) == text


@settings(max_examples=examples(30), deadline=None)
@given(names | reserved, st.text(max_size=40), st.sampled_from(["sensor", "actuator"]))
def test_generated_files_are_valid_python(text, description, kind):
    try:
        name = component_name(text)
    except CommandError:
        return
    with tempfile.TemporaryDirectory() as folder:
        for path in write_component(Path(folder), kind, Values("sim", name, class_name(name), description)):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            assert not re.search("@(env|name|classname)@", ast.unparse(tree).replace(repr(description), ""))


def test_templates_leave_no_placeholder(morse, project):
    morse("add", "robot", "ranger", "ranger_sim")
    morse("add", "actuator", "eyes", "ranger_sim", stdin=b"Controls the eyes\n")
    for path in project.rglob("*.py"):
        assert not re.search(r"@\w+@", path.read_text()), path
        compile(path.read_text(), str(path), "exec")
