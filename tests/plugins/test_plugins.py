"""Plug-ins: the core knows none of them, they know its public modules alone, and everything else works without them."""

import ast
import importlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from morse.core.classes.classpath import load_class
from morse.core.classes.plugins import entry_points
from morse.middleware import registry
from morse.version import __version__
from tests.kit.programs import python

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "src"
ROOM = SOURCES / "morse" / "plugins"
PLUGINS = sorted(path.name for path in ROOM.iterdir() if (path / "__init__.py").is_file())
#: what the core must not say of plug-ins whose names are also words of the field, such as /opt/ros
WORDS = {
    "blend": r"plugins[./]blend|read_blend",
    "people": r"plugins[./]people|\bCrowd\b",
    "legacy": r"plugins[./]legacy|builder[./]legacy",
    "senses": r"plugins[./]senses",  # a verb, too
    "sun": r"plugins[./]sun",  # the light of pictures
    "traffic": r"plugins[./]traffic",  # what networks carry
    "twin": r"plugins[./]twin|\bTwin\b",  # two parts that are alike
    "weather": r"plugins[./]weather",  # the weather of data sheets and of cables
    "ros": r"(?<!find\()[\"']ros[\"']|plugins\.ros\b",
}
POINTS = {
    name: value
    for points in tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["entry-points"].values()
    for name, value in points.items()
}


def imported(file: Path) -> set[str]:
    """The modules that a file imports."""
    names = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "absolute imports"
            names.add(str(node.module))
    return names


@pytest.mark.parametrize("plugin", PLUGINS)
def test_a_plugin_imports_public_modules_alone(plugin: str):
    """Those of the table in docs/architecture.md."""
    page = (
        (ROOT / "docs/architecture.md").read_text(encoding="utf-8").partition("Public modules")[2].partition("\n## ")[0]
    )
    public = {
        name
        for row in re.findall(r"^\| (`morse[^|]*)\|", page, re.MULTILINE)
        for name in re.findall(r"`([\w.]+)`", row)
    }
    assert len(public) > 10
    for name in public:
        importlib.import_module(name)
    for file in (ROOM / plugin).rglob("*.py"):
        used = {name for name in imported(file) if name.partition(".")[0] in ("morse", "pymorse")}
        private = {name for name in used if not name.startswith(f"morse.plugins.{plugin}") and name not in public}
        assert private == set(), file.relative_to(ROOT)


@pytest.mark.parametrize("plugin", PLUGINS)
def test_the_core_does_not_know_the_names_of_plugins(plugin: str):
    # the base classes of tests of users' scenes have the names of 1.4
    files = [
        path for path in (SOURCES / "morse").rglob("*.py") if ROOM not in path.parents and path.parent.name != "testing"
    ]
    word = WORDS.get(plugin, rf"\b{plugin}")
    # a script of 1.4 may name its modules: examples in comments
    found = [
        f"{path.relative_to(ROOT)}: {line.strip()}"
        for path in files
        for line in path.read_text(encoding="utf-8").splitlines()
        if re.search(word, line) and not line.lstrip().startswith("#") and "data/" not in path.as_posix()
    ]
    assert found == []


@pytest.mark.parametrize("plugin", PLUGINS)
def test_a_plugin_has_its_text_its_tests_and_its_entry_points(plugin: str):
    text = (ROOM / plugin / "README.md").read_text(encoding="utf-8")
    assert 5 <= text.count("\n") <= 14
    assert list((ROOT / "tests" / "plugins" / plugin).glob("test_*.py"))
    assert any(re.match(rf"morse\.plugins\.{plugin}([.:]|$)", value) for value in POINTS.values())


@pytest.mark.parametrize("name", sorted(registry.installed()))
def test_the_class_paths_of_a_description_are_those_of_classes(name: str):
    entry = registry.installed()[name]
    for path in (entry.stream_manager, entry.request_manager, entry.default_publisher, entry.default_reader):
        assert path is None or isinstance(load_class(path), type)


@pytest.mark.parametrize(
    ("old", "present"),
    [(point.name, point.value) for point in entry_points("morse.old_modules")],
)
def test_old_paths_lead_to_the_same_modules(old: str, present: str):
    module = importlib.import_module(old)
    assert module is importlib.import_module(present)
    assert module.__name__ == module.__spec__.name == present


def test_a_folder_that_an_older_checkout_has_left_hides_no_plugin(tmp_path: Path):
    (tmp_path / "moos" / "__pycache__").mkdir(parents=True)
    program = (
        "import morse.middleware\n"
        f"morse.middleware.__path__.append({str(tmp_path)!r})\n"
        "from morse.middleware.moos.database import Database\n"
        "print(Database.__module__)\n"
    )
    done = python("-c", program)
    assert done.stdout.strip() == "morse.plugins.moos.database", done.stderr


def test_modules_below_an_old_path_are_loaded_once():
    old = importlib.import_module("morse.middleware.yarp.bottle")
    assert old is importlib.import_module("morse.plugins.yarp.bottle")
    with pytest.raises(ModuleNotFoundError, match=r"morse\.middleware\.yarp\.nothing"):
        importlib.import_module("morse.middleware.yarp.nothing")
    with pytest.raises(ModuleNotFoundError, match=r"morse\.middleware\.nothing"):
        importlib.import_module("morse.middleware.nothing")


def run(*words: str, folder: Path, path: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(path)}
    return subprocess.run(
        [sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sources without the plug-ins, but for the reader of the models of MORSE, and without their entry points."""
    place = tmp_path_factory.mktemp("bare")
    shutil.copytree(SOURCES, place / "src", ignore=shutil.ignore_patterns("__pycache__", "data"))
    for name in PLUGINS:
        if name != "blend":
            shutil.rmtree(place / "src" / "morse" / "plugins" / name)
    (place / "src" / "morse" / "data").symlink_to(SOURCES / "morse" / "data")
    return place


def test_without_plugins_their_names_are_unknown_and_everything_else_is_there(bare: Path):
    program = (
        "import morse; from morse.middleware import registry; print(morse.__file__); print(*registry.installed());"
        "registry.middleware('yarp')"
    )
    done = run("-c", program, folder=bare, path=bare / "src")
    file, names = done.stdout.splitlines()
    assert file == str(bare / "src" / "morse" / "__init__.py")
    assert set(names.split()) == set(registry.installed()) - set(POINTS)
    # an installation still has their entry points; a copy of the sources whose pyproject.toml lacks them has nothing
    assert re.search(r"there is no middleware 'yarp'|'yarp' .* cannot be loaded", done.stderr.splitlines()[-1])


@pytest.mark.long
def test_without_plugins_the_rest_passes(bare: Path):
    """Tests of what the registry serves: streams, interfaces of scripts, recordings."""
    chosen = [
        "tests/middleware/test_text_files.py",
        "tests/middleware/test_socket_streams.py",
        "tests/builder/test_interfaces.py",
        "tests/recording/test_recorded_fields.py",
    ]
    words = ["-m", "pytest", "-q", "-n0", "-p", "no:cacheprovider", "-m", "not slow and not browser and not soak"]
    done = run(*words, *(str(ROOT / name) for name in chosen), folder=ROOT, path=bare / "src")
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    assert " passed" in done.stdout


def test_without_the_reader_of_its_own_models_scenes_in_other_formats_run(bare: Path, tmp_path: Path):
    shutil.copytree(bare / "src", tmp_path / "src", ignore=shutil.ignore_patterns("plugins"), symlinks=True)
    world = (
        '<sdf version="1.9"><world name="w"><model name="wall"><static>true</static><link name="l"><collision name="c">'
    )
    world += "<geometry><box><size>1 4 2</size></box></geometry></collision></link></model></world></sdf>"
    (tmp_path / "wall.sdf").write_text(world, encoding="utf-8")
    program = (
        "import morse\n"
        "from morse.builder import *\n"
        "def scene(world):\n"
        "    robot = FakeRobot()\n"
        "    robot.translate(x=-3.0, z=0.5)\n"
        "    finder = RangeFinder()\n"
        "    robot.append(finder)\n"
        "    Environment(world)\n"
        "with morse.load(lambda: scene('wall.sdf'), sockets=False) as simulation:\n"
        "    simulation.step()\n"
        "    print(round(simulation.robot.finder.get()['distance'], 6))\n"
        "morse.load(lambda: scene(morse.assets.search.MORSE_COMPONENTS + '/environments/empty.blend'))\n"
    )
    done = run("-c", program, folder=tmp_path, path=tmp_path / "src")
    assert done.stdout.strip() == "2.5", done.stderr
    assert re.search(r"cannot read files of type '.blend'|\(morse.plugins.blend:FORMAT\) cannot be loaded", done.stderr)


def test_doctor_lists_plugins_and_what_each_needs(simulated_packages: Path):
    done = run("-m", "morse", "doctor", folder=simulated_packages.parent, path=simulated_packages)
    assert "moos (middleware, morse.plugins.moos:MIDDLEWARE): variables of a MOOS database" in done.stdout
    assert "needs pymoos2; " in done.stdout
    assert "senses (ROS messages, morse.plugins.senses.ros:MESSAGES)\n    needs nothing else; ready" in done.stdout
    needy = done.stdout.partition("zenoh (middleware, lab.zenoh:MIDDLEWARE): routers of Zenoh\n")[2].splitlines()
    assert needy[:2] == [
        "    needs no_such_zenoh; no_such_zenoh is not installed",
        "    to install it: pip install no-such-zenoh",
    ]
    assert (
        "broken (model format, lab.nothing:read)\n    needs nothing else; cannot be loaded: ModuleNotFoundError"
        in done.stdout
    )
    assert done.returncode == 1
    assert "Traceback" not in done.stdout + done.stderr
    told = run("-m", "morse", "--version", "--verbose", folder=simulated_packages.parent, path=simulated_packages)
    assert (told.returncode, told.stdout) == (0, done.stdout)
    assert told.stdout.startswith(f"morse {__version__}\n")


def test_doctor_lists_the_project_in_this_folder(simulated_packages: Path):
    done = run("-m", "morse", "doctor", folder=simulated_packages.parent, path=SOURCES)
    assert "zenoh (middleware, lab.zenoh:MIDDLEWARE): routers of Zenoh\n" in done.stdout


@pytest.mark.parametrize(
    ("group", "point", "said"),
    [
        ("formats", 'urdf = "lab:read"', "is left out: files .urdf are MORSE's"),
        ("formats", '".grid" = "lab:read"', "is left out: '.grid' is not a suffix of files; write it without a point"),
        ("formats", 'grid = "lab:NUMBER"', "cannot be loaded: TypeError: it is 3, expected a function"),
        ("middlewares", 'pigeon = "lab:NUMBER"', "cannot be loaded: TypeError: it is 3, expected a morse.middleware"),
    ],
)
def test_doctor_calls_nothing_ready_that_is_not_used(tmp_path: Path, group: str, point: str, said: str):
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "lab.py").write_text("NUMBER = 3\ndef read(path):\n    return None\n")
    (tmp_path / "pyproject.toml").write_text(f'[project.entry-points."morse.{group}"]\n{point}\n')
    done = run("-m", "morse", "doctor", folder=tmp_path, path=SOURCES)
    assert f"needs nothing else; {said}" in done.stdout
    assert done.returncode == 1


@pytest.fixture
def simulated_packages(tmp_path: Path) -> Path:
    """A project with a middleware that lacks a package, and a reader that cannot be loaded."""
    package = tmp_path / "src" / "lab"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "zenoh.py").write_text(
        "from morse.middleware.registry import Middleware\n"
        "MIDDLEWARE = Middleware('zenoh', modules=('no_such_zenoh',), install='pip install no-such-zenoh',\n"
        "                        purpose='routers of Zenoh')\n"
    )
    (tmp_path / "pyproject.toml").write_text(
        '[project.entry-points."morse.middlewares"]\nzenoh = "lab.zenoh:MIDDLEWARE"\n'
        '[project.entry-points."morse.formats"]\nbroken = "lab.nothing:read"\n'
    )
    return tmp_path / "src"
