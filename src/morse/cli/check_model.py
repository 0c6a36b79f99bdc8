"""``morse check robot.sdf``: what MORSE understands of a model file."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from morse.cli.messages import CommandError, say

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from morse.scene import Library, Node


def check_model(path: Path) -> int:
    """Print a table of the content of a model file, and what is left out.

    Returns:
        The exit status.

    Raises:
        CommandError: the file cannot be read.
    """
    # imported on demand, because it loads numpy
    from morse.assets.formats import reader_of

    try:
        library = reader_of(path)(path)
    except (ValueError, OSError) as error:
        raise CommandError(f"{error}.") from None
    table = Table(box=box.SIMPLE_HEAD, show_header=False)
    for name, content in _rows(library):
        table.add_row(name, Text(content, overflow="fold"))
    Console().print(table)
    for warning in dict.fromkeys(library.warnings):
        say(f"Left out or changed: {warning}")
    say(f"{path.name} can be loaded.")
    return 0


def _rows(library: Library) -> Iterator[tuple[str, str]]:
    nodes = library.nodes()
    bones = [bone for node in nodes for bone in node.bones]
    links = [node for node in nodes if node.inertial is not None]
    yield "objects", ", ".join(f"{root.name} ({_kind(root)})" for root in library.roots[:20]) + _more(library.roots, 20)
    if links:
        yield "links", f"{len(links)}, together {sum(n.inertial.mass for n in links if n.inertial is not None):g} kg"
    if bones:
        yield "joints", f"{len(bones)}: {_counted(bone.kind.value for bone in bones)}"
    meshes = [node for node in nodes if node.mesh is not None]
    triangles = sum(len(node.mesh.triangles) for node in meshes if node.mesh is not None and node.visible)
    yield "shown", f"{sum(node.visible for node in meshes)} meshes, {triangles} triangles"
    yield "solid", f"{sum(node.body.collides for node in meshes)} shapes"
    if library.sensors:
        yield "sensors", ", ".join(f"{one.name} ({one.product})" for one in library.sensors)
    if library.actuators:
        yield "actuators", ", ".join(f"{one.name} ({one.product})" for one in library.actuators)
    if lights := [node for node in nodes if node.light is not None]:
        yield "lights", _counted(node.light.type.lower() for node in lights if node.light is not None)
    if library.world:
        yield "world", ", ".join(f"{key} {value}" for key, value in library.world.items())


def _kind(root: Node) -> str:
    if root.light is not None:
        return "light"
    return "free" if root.body.moves else "fixed"


def _counted(words: Iterable[str]) -> str:
    return ", ".join(f"{number} {word}" for word, number in Counter(words).most_common())


def _more(items: list[Node], most: int) -> str:
    return f" and {len(items) - most} more" if len(items) > most else ""
