"""The files, commands, options and environment variables in the documentation exist."""

import configparser
import importlib
import re
import shlex
from functools import cache

import pytest
import typer.main
from doc_pages import DOCS, PAGES, PICTURES, ROOT, Block, anchors, blocks, links
from PIL import Image

from morse.cli.app import app

START = (
    "python3 -m venv .venv && . .venv/bin/activate && pip install . && morse create ranger_sim && morse run ranger_sim"
)
TEST = (
    "python3 -m venv .venv && . .venv/bin/activate && pip install -q -U pip && pip install -q . --group dev && pytest"
)
#: options of old scripts that have no effect
_SILENT = {"--help", "--geometry", "--name"}
# paths of the machine of an author
_FOREIGN = re.compile(r"(?<![\w.])/(?:home|root|work|tmp|Users|usr/local|opt(?!/ros/)|mnt)/|[A-Z]:\\\\")
_VARIABLE = re.compile(r"\bMORSE_[A-Z_]+\b")


def test_the_readme_has_the_two_commands():
    readme = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert START in readme
    assert TEST in readme
    assert TEST.removesuffix(" && pytest") in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_links_lead_somewhere():
    wrong, anchors_of = [], cache(anchors)
    for link in links():
        path, _, anchor = link.target.partition("#")
        target = (link.page.parent / path).resolve() if path else link.page
        if not target.exists() or (anchor and anchor not in anchors_of(target)):
            wrong.append(f"{link.page.name} points to {link.target}")
    assert wrong == []


def test_pictures_are_there_and_small():
    used = {(link.page.parent / link.target).resolve() for link in links() if link.picture}
    used |= {PICTURES / "robots.webp"}  # on the first page of the component library
    folders = (
        PICTURES,
        PICTURES / "examples",
        PICTURES / "recipes",
        PICTURES / "joints",
        PICTURES / "lessons",
        PICTURES.parent / "measured",
    )
    there = {path for folder in folders for path in folder.iterdir() if path.suffix in (".webp", ".png", ".svg")}
    assert used == there
    for path in there:
        # the film of the front page has many frames
        assert path.stat().st_size < (900_000 if path.stem == "tour" else 250_000)
        if path.suffix != ".svg":
            with Image.open(path) as picture:
                # the films of the lessons stand in a table
                assert picture.width >= (400 if path.parent.name == "lessons" else 600)


def test_pictures_are_described_for_those_who_do_not_see_them():
    assert all(len(link.text) >= 8 for link in links() if link.picture)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_no_page_knows_the_machine_it_was_written_on(page):
    found = [line for line in page.read_text(encoding="utf-8").splitlines() if _FOREIGN.search(line)]
    assert not found


def _command_lines() -> list[tuple[str, list[str]]]:
    """The `morse` commands in shell blocks and tables: page and words."""
    found = []
    for block in blocks("sh"):
        for line in block.text.splitlines():
            for part in line.split("&&"):
                words = shlex.split(part, comments=True)
                words = [word for word in words if word != "&"]
                if words[:1] == ["morse"]:
                    found.append((block.page.name, words[1:]))
    return found


@pytest.mark.parametrize(("page", "words"), _command_lines(), ids=lambda value: str(value)[:60])
def test_commands_are_understood(page: str, words: list[str]):
    group = typer.main.get_command(app)
    context = group.make_context("morse", [words[0]], resilient_parsing=True)
    command = group.get_command(context, words[0])
    assert command is not None, f"{page}: morse {words[0]}"
    # raises for unknown options and arguments
    command.make_context(words[0], list(words[1:]), parent=context)


def test_every_option_of_run_is_documented():
    table = (DOCS / "command-line.md").read_text(encoding="utf-8")
    group = typer.main.get_command(app)
    context = group.make_context("morse", ["run"], resilient_parsing=True)
    parameters = group.get_command(context, "run").params
    names = [[*parameter.opts, *parameter.secondary_opts] for parameter in parameters if parameter.opts[0][0] == "-"]
    missing = [own for own in names if not any(f"`{name}" in table for name in own) and not _SILENT & set(own)]
    assert not missing


def test_every_command_is_documented():
    table = (DOCS / "command-line.md").read_text(encoding="utf-8")
    group = typer.main.get_command(app)
    for name in group.list_commands(group.make_context("morse", ["run"], resilient_parsing=True)):
        assert f"| `morse {name} " in table or f"| `morse {name}` |" in table


def test_environment_variables_exist():
    # the variables of a MOOS database have such names, too
    pages = [page for page in PAGES if page.name != "moos.md"]
    said = {name for page in pages for name in _VARIABLE.findall(page.read_text(encoding="utf-8"))}
    sources = [*(ROOT / "src").rglob("*.py"), ROOT / "hatch_build.py"]
    known = {name for path in sources for name in _VARIABLE.findall(path.read_text(encoding="utf-8"))}
    assert said
    assert said <= known


@pytest.mark.parametrize("block", blocks("python"), ids=lambda block: block.page.stem)
def test_python_is_valid(block: Block):
    compile(block.text, str(block.page), "exec")


def test_the_tutorial_is_the_one_that_is_tested():
    """Its code is identical to that in `tests/journey`."""
    shown = {block.text.strip() for block in blocks("python") if block.page.stem == "tutorial"}
    followed = {path.read_text(encoding="utf-8").strip() for path in (ROOT / "tests/journey/blocks").glob("*.py")}
    assert shown == followed


@pytest.mark.parametrize("page", ["scenes", "physics", "socket"])
def test_methods_in_tables_exist(page: str):
    """Names that look like calls are attributes of one of the classes for scripts or clients."""
    builder = importlib.import_module("morse.builder")
    pymorse = importlib.import_module("pymorse")
    owners = [
        builder,
        pymorse,
        builder.Environment,
        builder.Robot,
        builder.Cube,
        builder.Sick,
        pymorse.Morse,
        pymorse.MorseFuture,
        pymorse.StreamJSON,
    ]
    text = (DOCS / f"{page}.md").read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line.startswith("| `")]
    calls = {name for row in rows for name in re.findall(r"`\.?(?:env\.|robot\.|simu\.)?(\w+)\(", row)}
    unknown = {name for name in calls if not any(hasattr(owner, name) for owner in owners)}
    assert not unknown


def test_the_table_of_packages_has_all_packages_from_top_to_bottom():
    """As the layers that `lint-imports` checks."""
    rooms = configparser.ConfigParser()
    rooms.read(ROOT / ".importlinter", encoding="utf-8")
    layers = rooms["importlinter:contract:rooms"]["layers"].split("\n")
    place = {name: i for i, layer in enumerate(layers) for name in re.findall(r"\w+", layer)}
    table = (DOCS / "architecture.md").read_text(encoding="utf-8").partition("## Packages\n")[2].partition("\n## ")[0]
    rows = [re.findall(r"`(\w+)`", row.split("|")[1]) for row in table.splitlines() if row.startswith("| `")]
    assert {name for row in rows for name in row} == set(place)
    places = [place[name] for row in rows for name in row]
    assert places == sorted(places)
