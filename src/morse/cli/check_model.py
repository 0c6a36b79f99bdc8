"""``morse check robot.sdf``: what MORSE understands of a model file, and how it looks."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table
from rich.text import Text

from morse.cli.messages import CommandError, say, sentence
from morse.core.reports.printing import console
from morse.scene.armature import JointKind
from morse.system.regular_files import check_default_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.scene import Bone, Library, Node


def check_model(path: Path, picture: Path | None = None) -> int:
    """Print a table of the content of a model file, and what is left out.

    Args:
        picture: file for a picture of the model; None for ``<model>_check.png`` in the present folder.

    Returns:
        The exit status.

    Raises:
        CommandError: the file cannot be read, or not be drawn.
    """
    # imported on demand, because it loads numpy
    from morse.assets.formats import reader_of
    from morse.cli.model_picture import draw

    try:
        library = reader_of(path)(path)
    except (ValueError, OSError) as error:
        raise CommandError(sentence(error)) from None
    table = Table(box=box.SIMPLE_HEAD, show_header=False)
    for name, content in _rows(library):
        table.add_row(name, Text(content, overflow="fold"))
    console().print(table)
    target = picture or Path(f"{path.stem}_check.png")
    try:
        if picture is None:
            check_default_name(target)
        draw(path, library, target)
    except OSError as error:
        raise CommandError(f"the picture {target} could not be written: {error.strerror or error}") from None
    say(f"Picture: {target}")
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
        yield "joints", f"{len(bones)}: {_counted(map(_kind_of_joint, bones))}"
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
        yield "world", ", ".join(_settings(library.world))
    for warning in dict.fromkeys(library.warnings):
        yield "left out or changed", warning


def _settings(world: Mapping[str, object]) -> Iterator[str]:
    for key, value in world.items():
        if isinstance(value, dict):
            yield from _settings(value)
        else:
            yield f"{key} {value}"


def _kind_of_joint(bone: Bone) -> str:
    endless = bone.kind is JointKind.REVOLUTE and bone.dynamics is not None and not bone.dynamics.limited
    return "continuous" if endless else bone.kind.value


def _kind(root: Node) -> str:
    if root.light is not None:
        return "light"
    return "free" if root.body.moves else "fixed"


def _counted(words: Iterable[str]) -> str:
    return ", ".join(f"{number} {word}" for word, number in Counter(words).most_common())


def _more(items: list[Node], most: int) -> str:
    return f" and {len(items) - most} more" if len(items) > most else ""
