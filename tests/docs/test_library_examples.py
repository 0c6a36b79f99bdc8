"""The examples on the pages of the component library run, with their clients, and their pictures are on the pages."""

import re
import runpy
import threading
from importlib import import_module

import pytest
from doc_pages import DOCS

import morse

pytestmark = pytest.mark.long

_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def _names():
    return [
        f"{kind}/{name}"
        for kind in ("sensors", "actuators")
        for name in sorted(import_module(f"morse.builder.{kind}").__all__)
        if not name.endswith("Creator")
    ]


@pytest.fixture(scope="module")
def examples(library):
    """Kind and name of a component to the blocks of code on its page."""
    made = {**library.component_pages.pages("sensors"), **library.component_pages.pages("actuators")}
    return {page: _BLOCK.findall(text) for page, text in made.items()}


@pytest.mark.parametrize("name", _names())
def test_the_example_runs_with_its_client(name, examples, tmp_path, monkeypatch, capsys):
    scene, *clients = examples[name.lower()]
    script = tmp_path / "scene.py"
    script.write_text(scene, encoding="utf-8")
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(script, sockets=bool(clients), strict=True, speed=float("inf")) as simulation:
        if clients:
            thread = threading.Thread(target=simulation.run)
            thread.start()
            try:
                (manager,) = simulation.context.services.request_managers().values()
                monkeypatch.setenv("MORSE_SOCKET_PORT", str(manager.port))
                program = tmp_path / "client.py"
                program.write_text(clients[0], encoding="utf-8")
                # a Collision publishes nothing until it touches something
                if name != "sensors/Collision":
                    runpy.run_path(str(program))
            finally:
                simulation.stop()
                thread.join(60.0)
        simulation.step(30)
        assert simulation.context.failed == set()


def test_pictures_are_small_and_show_what_there_is(library):
    there = {path.name for path in library.pictures.FOLDER.iterdir()}
    pages = [name.rpartition("/")[2] for name in library.page_names() if not name.endswith("index")]
    known = {f"{name}{ending}" for name in pages for ending in library.pictures._KINDS}
    assert there <= known, "pictures of what is not there any more"
    assert all((DOCS / "pictures" / "library" / name).stat().st_size < 60_000 for name in there)
