"""The pose of a component."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder.errors import checks
from morse.builder.errors.angles import hint_at_radians

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.blender.objects import SceneObject
    from morse.builder.blender.pose import LiveEuler, LiveVector


class Placement:
    """The part of `AbstractComponent` for its pose."""

    _bpy_object: SceneObject

    @property
    def location(self) -> LiveVector:
        """Position in the frame of the parent, m; can be changed in place."""
        return self._bpy_object.location

    @location.setter
    def location(self, value: Iterable[float]) -> None:
        self._bpy_object.location = value

    @property
    def rotation_euler(self) -> LiveEuler:
        """Euler angles, rad, XYZ order; can be changed in place."""
        return self._bpy_object.rotation_euler

    @rotation_euler.setter
    def rotation_euler(self, value: Iterable[float]) -> None:
        self._bpy_object.rotation_euler = value

    @property
    def scale(self) -> LiveVector:
        """Scale along each axis; can be changed in place."""
        return self._bpy_object.scale

    @scale.setter
    def scale(self, value: Iterable[float]) -> None:
        self._bpy_object.scale = value

    def translate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        """Translate it along the axes of the parent, m."""
        self._add(self._bpy_object.node.location, (x, y, z), "translate")

    def rotate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        """Add angles to its roll, pitch and yaw, rad."""
        hint_at_radians(f"{type(self).__name__}.rotate", (x, y, z))
        self._add(self._bpy_object.node.rotation_euler, (x, y, z), "rotate")

    def _add(self, target: list[float], values: tuple[object, object, object], method: str) -> None:
        what = f"{type(self).__name__}.{method}"
        steps = [checks.number(value, f"{what}({axis})") for axis, value in zip("xyz", values, strict=True)]
        target[:] = [old + step for old, step in zip(target, steps, strict=True)]
