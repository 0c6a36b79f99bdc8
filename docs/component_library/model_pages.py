"""A page on the environments and props: the objects in each file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from component_library import pictures
from component_library.markdown import block, code, page, section, table
from component_library.sizes import extent
from morse.assets import find, load, search
from morse.builder.assembly.selection import pick
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.assembly.selection import Role
    from morse.scene import Library, Node

_PROP = """from morse.builder import *

robot = Morsy()

crate = PassiveObject('props/crates', 'small_crate')
crate.translate(x=3.0)

env = Environment('empty')
"""


def pages() -> dict[str, str]:
    """Name of a page, below the folder of the library, to its text."""
    environments = (
        section(name, pictures.of_world(name), _objects(_library(name, "environments"), "environment"), depth=3)
        for name in _models("environments")
    )
    props = (section(f"props/{name}", _objects(_library(name, "props"), "prop"), depth=3) for name in _models("props"))
    return {
        "models": page(
            "Environments and objects",
            "The models of MORSE, with the objects in them. Sizes are in metres, along X, Y and Z.",
            section("Environments", "`Environment('sandbox')` takes the name of one of them.\n", *environments),
            section(
                "Things",
                "`PassiveObject` takes the file, and the name of an object or of a group in it:\n",
                block("python", _PROP),
                *props,
            ),
        )
    }


def _models(category: str) -> list[str]:
    """The names of the models that are installed with MORSE."""
    own = search.component_dirs()[0] / category
    return [name for name in search.available(category) if (own / f"{name}.blend").is_file()]


def _library(name: str, category: str) -> Library:
    return load(find(name, category))


def _objects(library: Library, role: Role) -> str:
    groups = {member: name for name, members in library.collections.items() for member in members}
    roots = pick(library, role)
    # copies of one object that are turned in another way have its size
    first: dict[tuple[object, ...], list[str]] = {}
    rows = []
    for root in roots:
        facts = _facts(root)
        if root.mesh is not None and not root.children:
            facts = first.setdefault((id(root.mesh), *root.scale, root.body.mass, root.body.type), facts)
        rows.append([code(root.name), *facts, code(groups.get(root.source_name or root.name, ""))])
    lamps = sum(root.light is not None for root in roots)
    shown = [row for row, root in zip(rows, roots, strict=True) if root.light is None and root.camera is None]
    note = f"\nAnd {lamps} lamp{'s' if lamps > 1 else ''}.\n" if lamps else ""
    return table(["object", "size", "physics", "mass", "group"], _folded(shown)) + note


def _facts(root: Node) -> list[str]:
    size = extent(root)
    moves = root.body.moves
    return [
        "" if size is None else " × ".join(f"{length:.2f}" for length in size),
        code(_physics(root)),
        f"{root.body.mass:g} kg" if moves else "",
    ]


def _physics(root: Node) -> str:
    """The physics type of an object, or of its parts."""
    if not root.body.moves and any(part.body.collides for part in root.walk()):
        return str(PhysicsType.STATIC)
    return str(root.body.type)


def _folded(rows: Iterable[list[str]]) -> list[list[str]]:
    """Merge rows that differ only in the object into one row."""
    folded: dict[tuple[str, ...], list[str]] = {}
    for name, *facts in rows:
        folded.setdefault(tuple(facts), []).append(name)
    return [[_several(names), *facts] for facts, names in folded.items()]


def _several(names: list[str]) -> str:
    """Names in one cell; of more than four, the first and the last."""
    return ", ".join(names) if len(names) <= 4 else f"{names[0]} … {names[-1]} ({len(names)})"
