"""A package that fails in any way is named and left out, whichever entry points it has; the scene goes on."""

from collections.abc import Callable
from itertools import count
from pathlib import Path

import pytest

import morse
from morse.assets import formats, search
from morse.builder.derive import installed_classes
from morse.builder.errors import ScriptError
from morse.builder.names.catalog import modifiers
from morse.cli.doctor import plugins
from morse.core.kinds.table import kinds_of_packages
from morse.middleware import registry

SCENE = """
from morse.builder import *
{line}
robot = FakeRobot()
robot.append(Pose("pose"))
Environment("empty")
"""
#: what the code of a package does when it is imported, or called
FAULTS = {
    "raises": 'raise ZeroDivisionError("the lab is closed")',
    "exits": 'raise SystemExit("the lab is closed")',
    "calls exit": 'import sys; sys.exit("the lab is closed")',
    "raises no Exception": 'raise BaseException("the lab is closed")',
    "recurses": "def deep():\n    deep()\ndeep()",
}
#: what is named beside the package, what asks for it if no scene does, and the words of the warning
GROUPS: dict[str, tuple[str, Callable[[], object] | None, str]] = {
    "services": (":Referee", None, "the services of the package {} are left out"),
    "checks": (":check", None, "the check 'lab' ({}) cannot be made"),
    "compatibility": (":OLD", None, "({}) are left out"),
    "kinds": (":KIND", kinds_of_packages, "the message kinds of {} cannot be loaded"),
    "middlewares": (":MIDDLEWARE", registry.installed, "({}) cannot be loaded"),
    "components": ("", lambda: installed_classes("lab"), "the components of the installed package '{}' are left out"),
    "modifiers": (".more", modifiers, "the modifiers of {} are left out"),
    "assets": (".models", search.component_dirs, "the models of the installed package '{}' are left out"),
}
OLD = """
from morse.builder.compatibility import Compatibility, ScriptModules


class Old(Compatibility):
    def {method}:
        {body}


OLD = Old()
"""
#: of a plug-in for old scripts, with a line of a script that asks for it
METHODS = {
    "modules(self)": "",
    "arguments(self, script, words, directories)": "",
    "attributes(self, owner)": "try:\n    FakeRobot().no_such_thing()\nexcept AttributeError:\n    pass",
    "attribute(self, owner, name)": "try:\n    FakeRobot().no_such_thing()\nexcept AttributeError:\n    pass",
    "call(self, owner, method, arguments)": "try:\n    FakeRobot('r').frequency(every=2)\nexcept TypeError:\n    pass",
    "value(self, kind, value, what)": "FakeRobot('r').translate(x='1')",
}
_numbers = count()


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., str]:
    """Return a function that installs a package with this code and this entry point, and returns its name."""

    def install(group: str, points: str, code: str) -> str:
        name = f"lab{next(_numbers)}"  # modules and entry points are loaded once in a process
        files = {
            f"{name}/__init__.py": "",
            f"{name}/broken/__init__.py": code,
            f"{name}-1.0.dist-info/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n",
            f"{name}-1.0.dist-info/entry_points.txt": f"[morse.{group}]\n{points.replace('LAB', f'{name}.broken')}\n",
        }
        site = tmp_path / "site"
        for file, text in files.items():
            (site / file).parent.mkdir(parents=True, exist_ok=True)
            (site / file).write_text(text)
        monkeypatch.syspath_prepend(str(site))
        return f"{name}.broken"

    return install


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., None]:
    """Return a function that runs a scene with this line."""

    def run(line: str = "") -> None:
        script = tmp_path / "default.py"
        script.write_text(SCENE.format(line=line))
        with morse.load(script) as sim:
            sim.step(2)
            assert sim.clock.tick == 2

    return run


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("group", GROUPS)
def test_a_package_that_cannot_be_imported_is_left_out(
    install: Callable[..., str],
    run: Callable[..., None],
    group: str,
    fault: str,
    caplog: pytest.LogCaptureFixture,
) -> None:
    what, ask, words = GROUPS[group]
    name = install(group, f"lab = LAB{what}", FAULTS[fault])
    if ask is not None:
        ask()
    run()
    texts = [one.getMessage() for one in caplog.records if words.format(f"{name}{what}") in one.getMessage()]
    assert texts, caplog.text
    assert ("the lab is closed" if fault != "recurses" else "RecursionError") in texts[0]


@pytest.mark.parametrize("fault", FAULTS)
def test_a_reader_that_cannot_be_imported_is_an_error_of_the_file(install: Callable[..., str], fault: str) -> None:
    name = install("formats", "crate = LAB:read", FAULTS[fault])
    with pytest.raises(formats.UnsupportedFormatError, match=f"{name}:read.* cannot be loaded"):
        formats.reader_of(Path("yard.crate"))


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("group", ["services", "checks"])
def test_what_is_called_may_fail_too(
    install: Callable[..., str], run: Callable[..., None], group: str, fault: str, caplog: pytest.LogCaptureFixture
) -> None:
    body = "\n".join(f"    {line}" for line in FAULTS[fault].splitlines())
    name = install(group, "lab = LAB:called", f"def called(_):\n{body}\n")
    run()
    assert f"{name}:called" in caplog.text


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("method", METHODS)
def test_a_plug_in_for_old_scripts_fails_alone(
    install: Callable[..., str], run: Callable[..., None], method: str, fault: str, caplog: pytest.LogCaptureFixture
) -> None:
    body = FAULTS[fault].replace("\n", "\n        ")
    name = install("compatibility", "lab = LAB:OLD", OLD.format(method=method, body=body))
    run(METHODS[method])
    (warning,) = [one.getMessage() for one in caplog.records if f"({name}:OLD)" in one.getMessage()]
    assert "are left out" in warning


@pytest.mark.parametrize(
    ("method", "body"),
    [
        ("modules(self)", "return 3"),
        ("modules(self)", "return None"),
        ("modules(self)", "return ScriptModules(finders=3)"),
        ("modules(self)", "return ScriptModules(offered=[1])"),
        ("modules(self)", "return ScriptModules(close=lambda: 1 / 0)"),
        ("modules(self)", "return ScriptModules(as_imported=lambda module: 3)"),
        ("arguments(self, script, words, directories)", "return 3"),
        ("attributes(self, owner)", "return 3"),
        ("call(self, owner, method, arguments)", "return 3"),
    ],
)
def test_an_answer_of_a_wrong_form_is_a_fault(
    install: Callable[..., str], run: Callable[..., None], method: str, body: str, caplog: pytest.LogCaptureFixture
) -> None:
    name = install("compatibility", "lab = LAB:OLD", OLD.format(method=method, body=body))
    run(METHODS[method])
    assert len([one for one in caplog.records if f"({name}:OLD) are left out" in one.getMessage()]) == 1


def test_a_mistake_of_a_script_is_no_fault_of_the_plug_in(
    install: Callable[..., str], run: Callable[..., None], caplog: pytest.LogCaptureFixture
) -> None:
    code = OLD.format(method="value(self, kind, value, what)", body='raise ValueError("no old number")')
    install("compatibility", "lab = LAB:OLD", code)
    with pytest.raises(ScriptError, match="no old number"):
        run("FakeRobot('r').translate(x='1')")
    assert "are left out" not in caplog.text


@pytest.mark.parametrize(
    "points",
    [
        "morse.core.lost = morse.core.lost",
        "morse.core.lost = morse.core.other\nmorse.core.other = morse.core.lost",
        "morse.core.lost = morse.core.lost.more",
        "morse.core.lost = .",
        "morse.core.lost = no_such_package.module",
        "morse.core.lost = LAB.module",
        "morse.core.lost = LAB:thing",
    ],
)
@pytest.mark.parametrize("fault", ["raises", "calls exit", "recurses"])
def test_an_old_module_that_leads_nowhere_is_named(
    install: Callable[..., str], run: Callable[..., None], points: str, fault: str, caplog: pytest.LogCaptureFixture
) -> None:
    install("old_modules", points, FAULTS[fault])
    run("try:\n    import morse.core.lost\nexcept ModuleNotFoundError as error:\n    assert 'lost' in str(error)")
    assert "the old module 'morse.core.lost' is left out" in caplog.text


@pytest.mark.parametrize("fault", FAULTS)
def test_the_list_of_plug_ins_names_what_is_broken(install: Callable[..., str], fault: str) -> None:
    name = install("middlewares", "lab = LAB:MIDDLEWARE", FAULTS[fault])
    (broken,) = [one for one in plugins() if one.is_broken]
    assert broken.place == f"{name}:MIDDLEWARE"
    assert "cannot be loaded" in broken.lacks


def test_a_middleware_may_need_what_is_below_a_package_that_is_not_there(install: Callable[..., str]) -> None:
    code = "from morse.middleware.registry import Middleware\n" + (
        "MIDDLEWARE = Middleware('lab', modules=('no_such_package.part', '', '.', 'math'))\n"
    )
    install("middlewares", "lab = LAB:MIDDLEWARE", code)
    (entry,) = [one for one in plugins() if one.name == "lab"]
    assert entry.lacks == "no_such_package.part, , . is not installed"
