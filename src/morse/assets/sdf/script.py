"""A world as the text of a scene script."""

from __future__ import annotations

import keyword
import math
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError
from morse.assets.gazebo.values import version_of
from morse.assets.sdf.includes import Includes
from morse.assets.sdf.reader import read_sdf
from morse.assets.sdf.scope import links_of
from morse.system.free_names import free_name
from morse.system.source_text import one_line, quoted

if TYPE_CHECKING:
    from morse.assets.sdf.scope import Scope
    from morse.scene import Library, Node

_RESERVED = {"env", "Robot", "PassiveObject", "Environment"}


def scene_script(path: Path, folder: Path) -> str:
    """Return a scene script with the models of a world as robots and objects.

    Models with sensors or plugins are robots; the floor of the world is that of the environment ``empty``.

    Args:
        folder: that of the script: models are named relative to it where possible.

    Raises:
        AssetError: the file is broken, or contains no world.
        OSError: it cannot be opened.
    """
    library, includes = read_sdf(path), Includes(path)
    root = includes.root(path)
    element = root.find("world")
    if element is None:
        raise AssetError(
            path, "it contains no <world>; use its model in a scene script: Robot(file) or PassiveObject(file)"
        )
    return _Script(path, folder, library).text(includes.world(element, path, version_of(root)))


class _Script:
    def __init__(self, path: Path, folder: Path, library: Library) -> None:
        self._path, self._folder, self._library = path, folder, library
        self._names = set(_RESERVED)

    def text(self, world: Scope) -> str:
        nodes = {root.name: root for root in self._library.roots}
        objects: list[str] = []
        robots: list[str] = []
        for model in world.models.values():
            node = nodes.get(model.name)
            if node is None or _is_floor(model):
                continue
            target = robots if _is_robot(model) else objects
            target += self._lines(model, node, is_robot=target is robots)
        settings = self._settings()
        title = one_line(f"The world '{world.name}' of {self._path.name}.")
        lines = [f'"""{title}"""', "", "from morse.builder import *", ""]
        for heading, part in (("robots", robots), ("objects", objects)):
            if part:
                lines += [f"# {heading}", *part, ""]
        lines += ['env = Environment("empty")', *settings]
        left_out = [f"the actor '{one.name}' moves only in Environment(...)" for one in self._library.walkers]
        remarks = [f"# {one_line(warning)}" for warning in dict.fromkeys([*self._library.warnings, *left_out])]
        return "\n".join([*lines, *([""] if remarks else []), *remarks]) + "\n"

    def _lines(self, model: Scope, node: Node, *, is_robot: bool) -> list[str]:
        name = self._variable(model.name)
        kind = "Robot" if is_robot else "PassiveObject"
        if model.path != self._path:
            lines = [f"{name} = {kind}({self._shown(model.path)})"]
        else:
            option = "blender_object_name" if is_robot else "object_name"
            lines = [f"{name} = {kind}({self._shown(self._path)}, {option}={quoted(node.name)})"]
        if model.static and not all(link.is_static for link in links_of(model)):
            lines.append(f"# {name} is static in the world, but not in its file")
        lines.append(f"{name}.location = ({', '.join(map(_number, node.location))})")
        if any(node.rotation_euler):
            lines.append(f"{name}.rotation_euler = ({', '.join(map(_number, node.rotation_euler))})")
        return lines

    def _settings(self) -> list[str]:
        world, lines = self._library.world, []
        gravity, properties = world.get("gravity"), world.get("properties")
        if isinstance(gravity, float) and abs(gravity - 9.81) > 0.05:
            lines.append(f"env.set_gravity({gravity:g})")
        if isinstance(properties, dict):
            lines.append(f"env.properties({', '.join(f'{name}={value!r}' for name, value in properties.items())})")
        color = world.get("horizon_color")
        if isinstance(color, tuple):
            lines.append(f"env.set_horizon_color(({', '.join(f'{part:.3g}' for part in color)}))")
        return lines

    def _variable(self, name: str) -> str:
        base = re.sub(r"\W", "_", name, flags=re.ASCII).strip("_") or "model"
        base = f"model_{base}" if base[0].isdigit() or keyword.iskeyword(base) else base
        variable = free_name(base, self._names.__contains__)
        self._names.add(variable)
        return variable

    def _shown(self, path: Path) -> str:
        """The name of a file, relative to the folder of the script if it is below."""
        path = path.resolve()
        relative = Path(os.path.relpath(path, self._folder.resolve()))
        return quoted(str(path) if ".." in relative.parts else str(relative))


def _is_floor(model: Scope) -> bool:
    """Whether a model is a plane at height 0."""
    shapes = [shape for link in links_of(model) for shape in link.part.element.findall("collision")]
    return model.static and bool(shapes) and all(shape.find("geometry/plane") is not None for shape in shapes)


def _is_robot(model: Scope) -> bool:
    if model.static:
        return False
    has_sensor = any(link.part.element.find("sensor") is not None for link in links_of(model))
    return has_sensor or bool(model.plugins) or any(map(_is_robot, model.models.values()))


def _number(value: float) -> str:
    return repr(0.0 if math.isclose(value, 0.0, abs_tol=1e-15) else value)
