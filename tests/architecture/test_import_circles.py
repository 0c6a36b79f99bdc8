"""Circular imports between files of MORSE; imports for type checking count, too."""

import ast
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import pytest

import morse

pytestmark = pytest.mark.quick

ROOT = Path(morse.__file__).parent


def files(root: Path) -> dict[str, Path]:
    """Every file below a package, by the name of its module."""
    found = {}
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports(module: str, path: Path, known: Iterable[str]) -> set[str]:
    """The known modules that a file imports, anywhere in the file."""
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    return {name for name in _named(package, path) if name in set(known) and name != module}


def _named(package: str, path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def circles(graph: Mapping[str, set[str]]) -> list[set[str]]:
    """The strongly connected sets of modules (Tarjan, 1972)."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[set[str]] = []

    def visit(module: str) -> None:
        order[module] = low[module] = len(order)
        stack.append(module)
        for other in graph[module]:
            if other not in order:
                visit(other)
            if other in stack:
                low[module] = min(low[module], low[other])
        if low[module] == order[module]:
            circle = set(stack[stack.index(module) :])
            del stack[stack.index(module) :]
            found.append(circle)

    for module in graph:
        if module not in order:
            visit(module)
    return [circle for circle in found if len(circle) > 1]


def graph(root: Path) -> dict[str, set[str]]:
    """Each module below a package with the modules that it imports; `from package import module` means the module."""
    known = files(root)
    drawn = {}
    for module, path in known.items():
        named = imports(module, path, known)
        # `from morse.core import sensor` imports the file sensor.py; the package does not count
        drawn[module] = {name for name in named if not any(other.startswith(name + ".") for other in named)}
    return drawn


def test_the_check_sees_circles(tmp_path: Path) -> None:
    package = tmp_path / "ring"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "a.py").write_text("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ring import b\n")
    (package / "b.py").write_text("def late():\n    import ring.c\n")
    (package / "c.py").write_text("from .a import A\n")
    (package / "d.py").write_text("import ring.a\n")
    assert circles(graph(package)) == [{"ring.a", "ring.b", "ring.c"}]


def without_owners(drawn: Mapping[str, set[str]], root: Path) -> dict[str, set[str]]:
    """The graph without the annotations by which a part names the class of its owner.

    The owner imports the part and creates it; the part imports the owner for type checking only. This is a pair of
    files, also if the owner has several parts that know each other.
    """
    known = files(root)
    return {
        module: {
            name
            for name in named
            if not (module in drawn.get(name, ()) and name in _for_annotations(known[module], set(known)))
        }
        for module, named in drawn.items()
    }


def _for_annotations(path: Path, known: set[str]) -> set[str]:
    """The known modules that a file imports for type checking and not otherwise."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    blocks = [node for node in ast.walk(tree) if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"]
    within = {id(inner) for block in blocks for inner in ast.walk(block)}
    froms = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    typed = {node.module for node in froms if id(node) in within}
    executed = {node.module for node in froms if id(node) not in within}
    return {name for name in typed - executed if name in known}


def test_a_part_may_name_its_owner_in_annotations_alone(tmp_path: Path) -> None:
    package = tmp_path / "ring"
    package.mkdir()
    (package / "__init__.py").write_text("")
    owner = "from ring.left import Left\nfrom ring.right import Right\nclass Owner: pass\n"
    typed = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ring.owner import Owner\n"
    (package / "owner.py").write_text(owner)
    (package / "left.py").write_text("from ring.right import Right\n" + typed)
    (package / "right.py").write_text(typed)
    assert circles(without_owners(graph(package), package)) == []
    (package / "right.py").write_text("def late():\n    from ring.owner import Owner\n")
    assert circles(without_owners(graph(package), package)) == [{"ring.owner", "ring.left", "ring.right"}]
    (package / "right.py").write_text(typed)
    (package / "owner.py").write_text("from ring.left import Left\n")  # it does not create the other part
    assert circles(without_owners(graph(package), package)) == [{"ring.owner", "ring.left", "ring.right"}]


def test_no_circle_of_more_than_two_files() -> None:
    drawn = without_owners(graph(ROOT), ROOT)
    large = [sorted(circle) for circle in circles(drawn) if len(circle) > 2]
    assert large == [], "these files import each other in a circle: move what they share into a file below them"
