"""Euler angles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self

from morse.mathutils import matrix as matrices
from morse.mathutils import quaternion as quaternions
from morse.mathutils import rotations
from morse.mathutils.sequence import FloatSequence, floats, rounded

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.mathutils.matrix import Matrix
    from morse.mathutils.quaternion import Quaternion


class Euler(FloatSequence):
    """Angles x, y, z in radians about fixed axes, applied in `order`: ``XYZ`` is ``Rz @ Ry @ Rx``.

    With ``XYZ`` x is roll, y pitch and z yaw.
    """

    __slots__ = ("_order",)
    _sizes: ClassVar[tuple[int, int]] = (3, 3)
    _order: str

    def __init__(self, angles: Iterable[Any] = (0.0, 0.0, 0.0), order: str = "XYZ") -> None:
        self._items = floats(angles, "Euler", 3, 3)
        self.order = order

    @property
    def order(self) -> str:
        """The order of the rotations: first to last."""
        return self._order

    @order.setter
    def order(self, order: str) -> None:
        self._order = checked_order(order)

    def __repr__(self) -> str:
        return f"Euler(({', '.join(map(rounded, self._items))}), '{self._order}')"

    @property
    def x(self) -> float:
        """Angle about X."""
        return self._items[0]

    @x.setter
    def x(self, value: float) -> None:
        self[0] = value

    @property
    def y(self) -> float:
        """Angle about Y."""
        return self._items[1]

    @y.setter
    def y(self, value: float) -> None:
        self[1] = value

    @property
    def z(self) -> float:
        """Angle about Z."""
        return self._items[2]

    @z.setter
    def z(self, value: float) -> None:
        self[2] = value

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Euler):
            return NotImplemented
        return self._order == other._order and list(self._items) == list(other._items)

    __hash__ = FloatSequence.__hash__

    def as_rotation(self) -> rotations.Rotation9:
        """The rotation matrix, row by row."""
        return rotations.rotation_from_euler(self._items, self._order)

    def to_matrix(self) -> Matrix:
        """3x3 rotation matrix."""
        return matrices.Matrix._wrap(rotations.rows_of(self.as_rotation()))

    def to_quaternion(self) -> Quaternion:
        """The same rotation as a unit quaternion with w >= 0."""
        return quaternions.Quaternion._wrap(list(rotations.quaternion_from_rotation(self.as_rotation())))

    def rotate(self, other: Euler | Quaternion | Matrix) -> None:
        """Turn by another rotation, about the fixed axes."""
        turned = rotations.product(other.as_rotation(), self.as_rotation())
        self._assign(rotations.compatible_euler(turned, self._order, self._items))

    def rotate_axis(self, axis: str, angle: float) -> None:
        """Turn by an angle (radians) about one of the own axes: ``X``, ``Y`` or ``Z``."""
        if axis not in ("X", "Y", "Z"):
            raise ValueError(f"Euler.rotate_axis: the axis is 'X', 'Y' or 'Z', given {axis!r}")
        own = [0.0, 0.0, 0.0]
        own["XYZ".index(axis)] = angle
        turned = rotations.product(self.as_rotation(), rotations.rotation_from_euler(own, "XYZ"))
        self._assign(rotations.compatible_euler(turned, self._order, self._items))

    def make_compatible(self, other: Iterable[float]) -> None:
        """Add whole turns so that each angle comes within half a turn of another Euler's."""
        self._assign(rotations.unwrapped(self._items, floats(other, "Euler.make_compatible", 3, 3)))

    def zero(self) -> None:
        """Set all angles to 0."""
        self._assign([0.0, 0.0, 0.0])

    def copy(self) -> Self:
        """A copy that is not frozen."""
        made = self._wrap(list(self._items))
        made._order = self._order
        return made

    __copy__ = copy

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return type(self), (tuple(self._items), self._order)


def checked_order(order: str) -> str:
    """The order, if it is one.

    Raises:
        ValueError: it is not one of the six.
    """
    if order not in rotations.ORDERS:
        raise ValueError(f"an Euler order is one of {', '.join(rotations.ORDERS)}, given {order!r}")
    return order
