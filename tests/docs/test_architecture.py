"""The first page of the architecture fits a screen, and the files and functions that it names exist."""

import ast
import re
from pathlib import Path

import pytest

import morse

PAGE = (Path(__file__).parents[2] / "docs/architecture.md").read_text(encoding="utf-8")
WAYS = PAGE.partition("## Three ways")[2].partition("\n## ")[0]
SOURCES = Path(morse.__file__).parent
#: lines and columns of a usual window
_LINES, _COLUMNS = 50, 125
#: a file, and the names after it until the next file or the end of the row
_STEP = re.compile(r"\[`([\w/]+\.py)`\]\(\.\./src/morse/([\w/]+\.py)\)")


def names(path: Path) -> set[str]:
    """All classes, functions and methods of a file, as `Class.method`."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    kinds = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    found = {node.name for node in tree.body if isinstance(node, kinds)}
    for owner in (node for node in tree.body if isinstance(node, ast.ClassDef)):
        found |= {f"{owner.name}.{node.name}" for node in owner.body if isinstance(node, kinds)}
    return found


def steps() -> list[tuple[list[str], list[str]]]:
    """The files and the names of functions of each row, and of each sentence below a table."""
    texts = [line for line in WAYS.splitlines() if line.startswith("| ")] + re.split(r"(?<=\.)\s", WAYS)[-3:]
    found = []
    for text in texts:
        files = [label for label, _ in _STEP.findall(text)]
        functions = re.findall(r"`((?:[A-Z_]\w*\.)?[a-z_]\w*|[A-Z]\w+(?:\.\w+)?)`", re.sub(r"\[`[^`]*`\]", "", text))
        if files:
            found.append((files, [name for name in functions if name != "local_data"]))
    return found


def test_the_first_page_fits_a_screen() -> None:
    first = PAGE.partition("\n## ")[0].splitlines()
    assert len(first) <= _LINES
    picture = PAGE.partition("```text\n")[2].partition("```")[0].splitlines()
    assert max(map(len, picture)) <= _COLUMNS


def test_there_are_three_ways_of_few_files() -> None:
    ways = WAYS.split("\n**")[1:]
    assert [len(set(_STEP.findall(way.partition("\n\nA [rec")[0].partition("\n\nRobots")[0]))) for way in ways] == [
        pytest.approx(length, abs=2) for length in (12, 8, 13)
    ]


@pytest.mark.parametrize(("files", "functions"), steps())
def test_the_functions_of_a_step_exist_in_its_files(files: list[str], functions: list[str]) -> None:
    assert functions
    known = set().union(*(names(SOURCES / file) for file in files))
    assert set(functions) <= known


@pytest.mark.parametrize(("label", "target"), _STEP.findall(PAGE))
def test_a_link_goes_to_the_file_that_it_names(label: str, target: str) -> None:
    assert label == target
    assert (SOURCES / target).is_file()
