"""A page on what a component may call of the world: the protocols of `morse.core.world`."""

from __future__ import annotations

import ast
import inspect
import sys
from typing import Any

from component_library.markdown import code, page, prose, section, table
from morse.core.world import (
    Body,
    BodyNames,
    Fleet,
    Joints,
    Linkage,
    PoseTable,
    RayBundle,
    Rays,
    Sight,
    Snapshot,
    Snapshots,
    Wheel,
    World,
    WorldPoses,
)

_INTRODUCTION = (
    "What a component may call of the world. `self.bge_object` and `self.robot_parent.bge_object` are bodies, "
    "`self.context.world` is the world, and `self.add_rays(...)` returns a bundle of rays. Editors and type checkers "
    "know the same protocols as `morse.core.world`. How to write a component: [architecture](../architecture.md)."
)
_PLACES = {
    Body: "`self.bge_object`",
    BodyNames: "the same bodies, by the names of MORSE 1.4",
    Joints: "`body.joints()`",
    Wheel: "`body.wheels()`",
    RayBundle: "`self.add_rays(directions, reach)`",
    Sight: "`self.rays`, which has all of it, and `self.rays.sight`",
    World: "`self.context.world`",
    WorldPoses: "`self.context.world`, for observers",
    PoseTable: "`self.context.world.positions`, `.rotations`",
    Snapshots: "`self.context.world.snapshots(bodies)`",
    Snapshot: "`snapshots.now()`",
    Fleet: "`self.context.world.fleet(bodies)`, `.wheel_fleet(bodies)`",
    Rays: "`self.context.world.rays`",
    Linkage: "`self.context.world.linkage(...)`",
}


def pages() -> dict[str, str]:
    """Name of the page, below the folder of the library, to its text."""
    return {"world": page("The world of a component", _INTRODUCTION, *(_protocol(cls) for cls in _PLACES))}


def _protocol(cls: type[Any]) -> str:
    rows = [(code(_call(node)), prose(ast.get_docstring(node)).partition("\n\n")[0]) for node in _members(cls)]
    return section(cls.__name__, f"{_PLACES[cls]}.\n", prose(cls.__doc__) + "\n", table(["", ""], rows))


def _members(cls: type[Any]) -> list[ast.FunctionDef]:
    """The public functions and properties of a protocol; a setter belongs to its property."""
    tree = ast.parse(inspect.getsource(sys.modules[cls.__module__]))
    own = next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == cls.__name__)
    functions = [node for node in own.body if isinstance(node, ast.FunctionDef)]
    return [
        node
        for node in functions
        if not node.name.startswith("_") and not any(ast.unparse(one).endswith("setter") for one in node.decorator_list)
    ]


def _call(node: ast.FunctionDef) -> str:
    result = f" -> {ast.unparse(node.returns)}" if node.returns is not None else ""
    if any(ast.unparse(one) == "property" for one in node.decorator_list):
        return f"{node.name}{result.replace(' ->', ':')}"
    arguments = node.args
    arguments.args = [argument for argument in arguments.args if argument.arg != "self"]
    arguments.posonlyargs = [argument for argument in arguments.posonlyargs if argument.arg != "self"]
    return f"{node.name}({ast.unparse(arguments)}){result}"
