"""The component library contains the declarations of the components, and its examples run."""

from __future__ import annotations

import importlib
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from doc_pages import DOCS, ROOT

from morse.assets import search
from morse.builder import actuators, robots, sensors, workspace
from morse.builder.names import catalog
from morse.builder.script import load_scene
from morse.core import declarations
from morse.simulation.options import RunOptions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser

pytestmark = pytest.mark.long

_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.fixture(autouse=True)
def _fresh_builder(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setattr(sys, "argv", list(sys.argv))
    yield
    workspace.reset()
    search.set_project_dirs([])


@pytest.fixture(scope="module")
def pages(library, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """All pages by name."""
    folder = tmp_path_factory.mktemp("pages") / "library"
    written = library.write(folder)
    return {path.relative_to(folder).with_suffix("").as_posix(): path.read_text(encoding="utf-8") for path in written}


def test_the_pages_in_the_repository_are_those_of_the_declarations(pages: dict[str, str]):
    """They can be read in a copy of the repository in which nothing was built.

    The page `coverage` is there only in the documentation that was built: it changes with each test.
    """
    folder = DOCS / "library"
    pages = {name: text for name, text in pages.items() if name != "coverage"}
    there = {path.relative_to(folder).with_suffix("").as_posix(): path for path in folder.rglob("*.md")}
    old = sorted(name for name, text in pages.items() if name not in there or there[name].read_text("utf-8") != text)
    assert (old, set(there) - set(pages) - {"coverage"}) == ([], set()), "run: python -m tools library"


def test_every_component_has_a_page(pages: dict[str, str], library):
    names = {"robots": robots.__all__, "sensors": sensors.__all__, "actuators": actuators.__all__}
    plugins = ROOT / "src" / "morse" / "plugins"
    for kind, members in names.items():
        folders = [] if kind == "robots" else [path.parent.name for path in plugins.glob(f"*/{kind}")]
        of_plugins = [name for folder in folders for name in catalog.components(f"morse.plugins.{folder}.{kind}")]
        members = [*members, *of_plugins]
        expected = {f"{kind}/{name.lower()}" for name in members if not name.endswith("Creator")} | {f"{kind}/index"}
        assert expected == {name for name in pages if name.startswith(f"{kind}/")}
    assert set(library.page_names()) == set(pages)


@pytest.mark.parametrize("kind", ["sensors", "actuators"])
def test_pages_show_what_is_declared(pages: dict[str, str], kind: str, library):
    module = {"sensors": sensors, "actuators": actuators}[kind]
    for name in module.__all__:
        if name.endswith("Creator"):
            continue
        cls = library.component_pages.component_class(getattr(module, name))
        text = pages[f"{kind}/{name.lower()}"]
        # a property may have the name of a field
        data = text.partition("## Data")[2].partition("\n## ")[0]
        for field, entry in declarations.data_fields(cls).items():
            (row,) = re.findall(rf"^\| `{re.escape(field)}` \|.*$", data, re.MULTILINE)
            assert entry.unit in row
            assert " ".join(entry.doc.split()) in row
        for entry in declarations.properties(cls).values():
            assert f"| `{entry.name}` |" in text
        for level in declarations.levels(cls):
            assert f"| `{level}` |" in text


def test_a_unit_is_known_for_every_length_and_angle(pages: dict[str, str]):
    """Fields called x or yaw are metres or radians: the page has to state which."""
    for name, text in pages.items():
        for field, unit in re.findall(r"^\| `(\w+)` \| float \| ([^|]*) \|", text, re.MULTILINE):
            if field in ("x", "y", "z", "yaw", "pitch", "roll", "v", "w", "timestamp"):
                assert unit, f"{field} of {name} has no unit"


def test_services_are_shown_with_their_arguments(pages: dict[str, str]):
    assert "`set_speed(v: float, w: float)`" in pages["actuators/motionvw"]
    assert "`sleep(seconds: float)`" in pages["services"]
    assert "callback" not in "".join(pages.values())


def test_examples_load(pages: dict[str, str], tmp_path: Path):
    script = tmp_path / "example.py"
    for name, text in pages.items():
        for block in _BLOCK.findall(text):
            if "pymorse" in block:
                compile(block, name, "exec")
                continue
            script.write_text(block, encoding="utf-8")
            scene = load_scene(RunOptions(str(script)))
            assert scene.components, name


@pytest.mark.parametrize("name", ["atrv", "pioneer3dx", "quad2012", "fakerobot"])
def test_robots_do_what_their_examples_say(pages: dict[str, str], name: str, simulate, tmp_path: Path):
    script = tmp_path / "robot.py"
    (example,) = _BLOCK.findall(pages[f"robots/{name}"])
    script.write_text(example, encoding="utf-8")
    simu = simulate(script)
    simu.rpc("simulation", "pause")
    start = simu.rpc("simulation", "get_scene_objects")["robot"][1][0]
    if hasattr(simu.robot.motion, "set_speed"):
        simu.robot.motion.set_speed(1.0, 0.0)
    else:
        simu.robot.motion.translate(1.0)
    simu.rpc("simulation", "step", 60)
    moved = simu.rpc("simulation", "get_scene_objects")["robot"][1][0] - start
    assert moved == pytest.approx(1.0, abs=0.1)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pages of the documentation, built without a warning."""
    folder = tmp_path_factory.mktemp("site")
    sphinx = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-d", str(folder / "cache")]
    done = subprocess.run(
        [*sphinx, str(DOCS), str(folder / "html")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=1200,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return folder / "html"


@pytest.mark.slow
def test_the_documentation_builds_without_a_warning(built: Path):
    assert (built / "library" / "sensors" / "pose.html").is_file()
    assert (built / "api.html").read_text(encoding="utf-8").count('id="morse.gym.') > 20


@pytest.mark.slow
def test_the_search_finds_pages_by_synonyms(built: Path):
    text = (built / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(text[text.index("{") : text.rindex("}") + 1])

    def pages(word: str) -> set[str]:
        found = index["terms"].get(word, [])
        return {index["docnames"][number] for number in (found if isinstance(found, list) else [found])}

    assert {"library/sensors/hokuyo", "library/sensors/sick"} <= pages("lidar")
    assert "library/actuators/motionvw" in pages("wheel")  # the stem of wheels
    assert "installation" in pages("docker")
    assert "live-view" in pages("jupyt")


def test_words_for_the_search_are_of_pages_that_exist(library, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(DOCS)
    search_words = importlib.import_module("search_words")
    names = {path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")}
    assert set(search_words.WORDS) <= names
    assert set(search_words.component_words()) <= names
    for name in library.page_names():
        if name.startswith(("sensors/", "actuators/")) and not name.endswith("/index"):
            assert f"library/{name}" in search_words.component_words()


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)])
def test_runs_in_the_pages_do_not_move_them(built: Path, browser: Browser, width: int, height: int):
    page = browser.new_page(viewport={"width": width, "height": height})
    try:
        page.goto((built / "examples.html").as_uri())
        runs = page.locator(".run")
        assert runs.count() > 3
        for number in range(runs.count()):
            place = "e => { scrollTo({ top: e.getBoundingClientRect().top + scrollY - 50, behavior: 'instant' }); }"
            runs.nth(number).evaluate(place)
            before = page.evaluate("scrollY")
            if width > 640:
                shown = runs.nth(number).locator("iframe[src]")
                shown.wait_for(state="attached")
                frame = shown.element_handle().content_frame()
                frame.wait_for_function("!!globalThis.morse?.world.value")
                # those out of sight are not loaded
                assert page.locator(".run iframe[src]").count() < runs.count()
            else:  # the picture opens the run
                assert runs.nth(number).locator("a").get_attribute("href").startswith("_static/runs/")
                assert not runs.nth(number).locator("iframe").is_visible()
            assert page.evaluate("scrollY") == before
        assert page.evaluate("document.documentElement.scrollWidth") == width
    finally:
        page.close()


def test_every_picture_is_on_a_page(pages: dict[str, str], library):
    used = {file for text in pages.values() for file in re.findall(r"pictures/library/([\w.-]+)", text)}
    assert used == {path.name for path in library.pictures.FOLDER.iterdir()}


def test_a_component_without_a_picture_is_named(library, monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    everything = {name.rpartition("/")[2] for name in library.page_names() if "/" in name} - {"index", "fakerobot"}
    monkeypatch.setattr(library.pictures, "FOLDER", tmp_path)
    assert set(library.without_picture()) == everything
    (tmp_path / "pose.webp").touch()
    assert set(library.without_picture()) == everything - {"pose"}


def test_formulas_name_their_source(pages: dict[str, str]):
    assert "ISO 2533:1975" in pages["sensors/barometer"]
    # the values of a product come from its data sheet, its formulas from the class
    assert "data sheet of the BMI088" in pages["sensors/bmi088"]
    assert "data sheet" not in pages["sensors/imu"].partition("formula after")[2].partition("\n")[0]


#: features of MORSE 1.4 that are not available; remove an entry when it becomes available
MISSING = {"MocapControl"}
MISSING_MIDDLEWARES = {"hla", "mavlink", "pocolibs", "pprzlink", "ros", "text"}


def test_the_coverage_of_1_4_is_told(pages: dict[str, str], library):
    text = pages["coverage"]
    absent = set(library.coverage_page.missing())
    # others may have been added in the meantime: nothing else is missing
    assert absent <= MISSING | MISSING_MIDDLEWARES
    for kind in ("sensors", "actuators", "robots"):
        for name in re.findall(rf"^\| \[(\w+)\]\({kind}/", text, re.MULTILINE):
            assert f"{kind}/{name.lower()}" in pages
    assert "| [Pose](sensors/pose.md) | yes | " in text
    # an available component is used by its own test
    untested = re.findall(r"^\| \[(\w+)\]\((?:sensors|actuators)/\S+ \| yes \|  \|$", text, re.MULTILINE)
    assert untested == []
