"""SDF files as libraries of nodes."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError
from morse.assets.gazebo.values import version_of
from morse.assets.sdf.geometry import Geometry
from morse.assets.sdf.includes import Includes
from morse.assets.sdf.materials import Materials
from morse.assets.sdf.robots import Models
from morse.assets.sdf.scope import MODEL, SEPARATOR, WORLD, FrameMistakeError, Part, Scope, end_of, joints_of, links_of
from morse.assets.sdf.worlds import add_world
from morse.scene import Library
from morse.system.free_names import free_name

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_ENDS = ("parent", "child")


def move_into_models(world: Scope) -> None:
    """Move these joints into their models, where a joint to the world means the same."""
    for name, part in list(world.joints.items()):
        ends = {tag: end_of(part, tag) for tag in _ENDS}
        others = [tag for tag in _ENDS if ends[tag] != WORLD]
        if len(others) != 1:
            continue
        try:
            head, separator, link = world.link_of(ends[others[0]]).partition(SEPARATOR)
            pose = world.pose_of(head).inverted() @ world.pose_of(name)
        except FrameMistakeError:
            continue
        if not separator:
            continue
        element = deepcopy(part.element)
        end = element.find(others[0])
        if end is None:
            continue
        end.text = link
        joints = world.models[head].joints
        own = free_name(name, joints.__contains__)
        joints[own] = replace(part, name=own, element=element, home=MODEL, pose=pose, base=MODEL)
        del world.joints[name]


def join_models(world: Scope) -> set[str]:
    """Put models that joints of the world connect into one model each; return the names of these.

    Links keep their names: those of nested models.
    """
    ends: dict[str, tuple[str, str]] = {}
    group = {name: name for name in world.models}

    def first(name: str) -> str:
        while group[name] != name:
            name = group[name]
        return name

    for name, part in world.joints.items():
        try:
            parent, child = (world.link_of(end_of(part, tag)) for tag in _ENDS)
            world.pose_of(name)
        except FrameMistakeError:
            continue
        heads = [end.partition(SEPARATOR)[0] for end in (parent, child)]
        if all(head in group for head in heads):
            ends[name] = parent, child
            group[first(heads[1])] = first(heads[0])
    members: dict[str, list[str]] = {}
    for name in world.models:
        members.setdefault(first(name), []).append(name)
    wholes: set[str] = set()
    for head in dict.fromkeys(first(child.partition(SEPARATOR)[0]) for _, child in ends.values()):
        models = {name: world.models[name] for name in members[head]}
        # a robot has the name of its first part that moves
        name = next((name for name, model in models.items() if not model.static), head)
        whole = Scope(name, world.path, models=models, self_collide=any(one.self_collide for one in models.values()))
        for joint in [joint for joint, (_, child) in ends.items() if child.partition(SEPARATOR)[0] in models]:
            part = world.joints.pop(joint)
            element = _between(part.element, *ends[joint])
            pose = world.pose_of(joint)
            whole.joints[joint] = replace(part, element=element, home=MODEL, pose=pose, base=MODEL)
        for own, model in models.items():
            model.pose, model.base, model.placement = world.pose_of(own), "", ""
            for link in links_of(model, f"{own}{SEPARATOR}") if model.static else ():
                fixed = link.part.element.makeelement("joint", {"type": "fixed"})
                joint = free_name(f"{link.name}_fixed", whole.joints.__contains__)
                whole.joints[joint] = Part(joint, _between(fixed, WORLD, link.name), world.path, link.part.version)
        world.replace_models(models, whole)
        wholes.add(name)
    return wholes


def _between(joint: Element, parent: str, child: str) -> Element:
    """A copy of a joint with other ends."""
    element = deepcopy(joint)
    for tag, link in zip(_ENDS, (parent, child), strict=True):
        end = element.find(tag)
        if end is None:
            end = element.makeelement(tag, {})
            element.append(end)
        end.text = link
    return element


def read_sdf(path: str | Path) -> Library:
    """Read a model or a world.

    The links of a model become nodes with the same names below the armature ``<model>_joints``, whose bones are the
    joints, as those of URDF files. Links of nested models are called ``<model>::<link>``.

    Raises:
        AssetError: the file is broken or contradicts itself.
        OSError: it cannot be opened.
    """
    path = Path(path)
    includes = Includes(path)
    try:
        return _read(path, includes)
    except FrameMistakeError as error:
        raise AssetError(path, str(error)) from None
    except RecursionError:
        raise AssetError(path, "its frames depend on each other in a chain that is too long") from None


def _read(path: Path, includes: Includes) -> Library:
    root = includes.root(path)
    models = Models(path, includes, Geometry(Materials(includes.warn), includes.warn))
    library = Library(str(path), warnings=includes.warnings, has_free_joints=True)
    world = root.find("world")
    scope = includes.world(world if world is not None else _as_world(root), path, version_of(root))
    move_into_models(scope)
    joined = join_models(scope)
    main = _robot_of(scope)
    for model in scope.models.values():
        try:
            node = models.node(
                model,
                scope.pose_of(model.name),
                prefix="" if model is main or model.name in joined else f"{model.name}::",
            )
        except FrameMistakeError as error:
            if len(scope.models) == 1:
                raise
            includes.warn(f"the model '{model.name:.80}' is left out: {error}")
            continue
        if node is None:
            continue
        library.roots.append(node)
        library.sensors += models.sensors
        library.actuators += models.actuators
        library.robot = node.name if model is main else library.robot
    add_world(library, scope, world if world is not None else root, includes)
    if not library.roots and world is None:
        raise AssetError(path, "it contains no <world>, and no <model> with a <link>")
    return library


def _robot_of(scope: Scope) -> Scope | None:
    """The model that is the robot: the one with the most joints of those that move."""
    joints = {id(model): sum(1 for _ in joints_of(model, _ignore)) for model in scope.models.values()}
    return max(scope.models.values(), key=lambda one: (not one.static, joints[id(one)]), default=None)


def _ignore(warning: str) -> None:
    del warning


def _as_world(root: Element) -> Element:
    """The world around the models of a file without one."""
    element = root.makeelement("world", {"name": "world"})
    element.extend(child for child in root if child.tag in ("model", "include", "light", "actor"))
    return element
