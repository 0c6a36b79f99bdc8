"""What a model file contains, in words: for `morse check` and for the page of the live view."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from morse.scene.articulation import JointKind

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.scene import Bone, Library, Node


def class_of(library: Library) -> str:
    """The class of scene scripts for a model file."""
    if library.world or (len(library.roots) > 1 and not library.robot):
        return "Environment"
    return "Robot" if any(node.bones for node in library.nodes()) else "PassiveObject"


def contents(library: Library) -> Iterator[tuple[str, str]]:
    """What the file has, and what of it is left out or changed, as pairs of a title and a text."""
    nodes = library.nodes()
    bones = [bone for node in nodes for bone in node.bones]
    links = [node for node in nodes if node.inertial is not None]
    yield "objects", ", ".join(f"{root.name} ({_kind(root)})" for root in library.roots[:20]) + _more(library.roots, 20)
    mass = sum(node.inertial.mass for node in links if node.inertial is not None)
    if links:
        yield "links", f"{len(links)}, together {mass:g} kg"
    if not mass and bones and (root := next((root for root in library.roots if root.body.moves), None)):
        yield "mass", f"{root.body.mass:g} kg, because the file has no masses: robot.set_mass(kg) sets another one"
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
