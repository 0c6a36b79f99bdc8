"""The nodes of a scene as the objects of a script."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, Protocol, SupportsIndex, TypeVar, overload

from morse.builder import workspace
from morse.builder.errors import checks
from morse.builder.errors.checks import hint_at_radians
from morse.mathutils import Euler, Vector

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.values import Value
    from morse.mathutils import Matrix
    from morse.scene import Material, Node


class LiveVector(Vector):
    """Three numbers of a node, metres or factors; assigning items changes the node."""

    __slots__ = ("_what",)

    def __init__(self, numbers: list[float], what: str) -> None:
        self._items = numbers
        self._what = what

    def __setitem__(self, index: Any, value: Any) -> None:
        super().__setitem__(index, _checked(value, self._what))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, (Vector, Euler, list, tuple)) and list(self) == list(other)

    __hash__ = Vector.__hash__

    def copy(self) -> Vector:  # type: ignore[override]
        """A copy of the numbers, independent of the node."""
        return Vector(self._items)

    __copy__ = copy  # type: ignore[assignment]

    def __deepcopy__(self, memo: dict[int, object]) -> Vector:  # type: ignore[override]
        return self.copy()


class LiveEuler(Euler):
    """Angles of a node in radians, XYZ order; assigning items changes the node."""

    __slots__ = ("_what",)

    def __init__(self, numbers: list[float], what: str) -> None:
        self._items = numbers
        self._order = "XYZ"
        self._what = what

    def __setitem__(self, index: Any, value: Any) -> None:
        super().__setitem__(index, _checked(value, self._what))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, (Vector, Euler, list, tuple)) and list(self) == list(other)

    __hash__ = Euler.__hash__

    def copy(self) -> Euler:  # type: ignore[override]
        """A copy of the angles, independent of the node."""
        return Euler(self._items)

    __copy__ = copy  # type: ignore[assignment]

    def __deepcopy__(self, memo: dict[int, object]) -> Euler:  # type: ignore[override]
        return self.copy()


def _checked(value: object, what: str) -> Any:
    if hasattr(value, "__iter__") and not isinstance(value, str):
        return [checks.number(item, what) for item in value]
    return checks.number(value, what)


class Named(Protocol):
    """An item with a name."""

    @property
    def name(self) -> str:
        """The name."""


_T = TypeVar("_T", bound=Named)


class NamedList(list[_T]):
    """A list whose items can also be accessed by name; iteration yields the items.

    Args:
        items: the items.
        kind: name for an item in messages.
    """

    def __init__(self, items: Iterable[_T], kind: str) -> None:
        super().__init__(items)
        self._kind = kind

    @overload
    def __getitem__(self, key: SupportsIndex | str) -> _T: ...
    @overload
    def __getitem__(self, key: slice) -> list[_T]: ...
    def __getitem__(self, key: SupportsIndex | slice | str) -> _T | list[_T]:
        if not isinstance(key, str):
            return super().__getitem__(key)
        for item in self:
            if item.name == key:
                return item
        raise KeyError(f"no {self._kind} '{key}'{checks.suggestion(key, self.keys())}")

    def __contains__(self, item: object) -> bool:
        return self.get(item) is not None if isinstance(item, str) else super().__contains__(item)

    def get(self, name: str, default: object = None) -> Value:
        """Return the item of that name, or ``default``."""
        return next((item for item in self if item.name == name), default)

    def keys(self) -> list[str]:
        """The names."""
        return [item.name for item in self]

    def values(self) -> list[_T]:
        """The items."""
        return list(self)

    def items(self) -> list[tuple[str, _T]]:
        """Names and items."""
        return [(item.name, item) for item in self]


class timer(float):  # noqa: N801 (the name in scripts)
    """A property that counts seconds."""


def checked_property(name: str, value: object) -> object:
    """Return the value of a property as it is stored; numpy scalars are converted to Python scalars.

    Raises:
        ValueError: NaN.
    """
    if isinstance(value, Real) and not isinstance(value, (bool, int, float)):
        value = int(value) if isinstance(value, Integral) else float(value)
    if isinstance(value, float) and math.isnan(value):
        raise ValueError(f"property '{name}' takes a number, got NaN")
    return value


def material_slots(node: Node) -> list[Material | None]:
    """Return the materials of a node: its own, else those of its mesh."""
    defaults = list(node.mesh.materials) if node.mesh is not None else []
    slots = [*node.materials, *defaults[len(node.materials) :]]
    return [own if own is not None else defaults[i] if i < len(defaults) else None for i, own in enumerate(slots)]


class SceneObject:
    """A node of the scene, such as ``robot._bpy_object`` or ``bpymorse.get_object(name)``.

    Two objects are equal if they refer to the same node.
    """

    __slots__ = ("node",)

    def __init__(self, node: Node) -> None:
        self.node = node

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SceneObject) and other.node is self.node

    def __hash__(self) -> int:
        return hash(self.node)

    def __repr__(self) -> str:
        return f"<SceneObject '{self.node.name}'>"

    if not TYPE_CHECKING:  # lets type checkers find misspelt names

        def __getattr__(self, name: str) -> Any:
            return checks.missing_attribute(self, name)

        def __setattr__(self, name: str, value: object) -> None:
            if hasattr(type(self), name):
                object.__setattr__(self, name, value)
            else:
                checks.set_missing_attribute(self, name, value)

    @property
    def name(self) -> str:
        """The name, unique in the scene: ``.001``, ``.002``, ... is appended to an existing name."""
        return self.node.name

    @name.setter
    def name(self, name: str) -> None:
        workspace.current().rename(self.node, checks.text(name, "name"))

    @property
    def location(self) -> LiveVector:
        """Metres, in the frame of the parent."""
        return LiveVector(self.node.location, "location")

    @location.setter
    def location(self, value: Iterable[float]) -> None:
        self.node.location[:] = checks.triple(value, "location")

    @property
    def rotation_euler(self) -> LiveEuler:
        """Radians, XYZ order, in the frame of the parent."""
        return LiveEuler(self.node.rotation_euler, "rotation_euler")

    @rotation_euler.setter
    def rotation_euler(self, value: Iterable[float]) -> None:
        angles = checks.triple(value, "rotation_euler")
        hint_at_radians("rotation_euler", angles)
        self.node.rotation_euler[:] = angles

    @property
    def scale(self) -> LiveVector:
        """Factor along each axis."""
        return LiveVector(self.node.scale, "scale")

    @scale.setter
    def scale(self, value: Iterable[float]) -> None:
        self.node.scale[:] = checks.triple(value, "scale")

    @property
    def parent(self) -> SceneObject | None:
        """The parent object, or None for the world."""
        return None if self.node.parent is None else SceneObject(self.node.parent)

    @parent.setter
    def parent(self, parent: SceneObject | None) -> None:
        if parent is None:
            workspace.current().detach(self.node)
        elif isinstance(parent, SceneObject):
            workspace.current().attach(parent.node, self.node)
        else:
            raise TypeError(f"parent takes an object of the scene or None, got {checks.shown(parent)}")

    @property
    def children(self) -> NamedList[SceneObject]:
        """The child objects."""
        return NamedList([SceneObject(child) for child in self.node.children], "child")

    @property
    def matrix_world(self) -> Matrix:
        """Pose and scale in the world, 4x4; a copy."""
        return self.node.world_matrix()

    @property
    def matrix_local(self) -> Matrix:
        """Pose and scale in the frame of the parent, 4x4; a copy."""
        return self.node.basis_matrix()

    def __getitem__(self, name: str) -> Value:
        return self.node.properties[name]

    def __setitem__(self, name: str, value: object) -> None:
        self.node.properties[name] = checked_property(name, value)

    def __contains__(self, name: str) -> bool:
        return name in self.node.properties

    def get(self, name: str, default: object = None) -> Value:
        """The value of a property, or ``default``."""
        return self.node.properties.get(name, default)
