"""The records that hold declarations."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import UnionType

    from morse.core.values import Value

#: a shape: the length of each axis, None for any length
Shape = tuple["int | None", ...]


class DataField(NamedTuple):
    """A field of ``local_data``, which a sensor publishes or an actuator reads.

    Attributes:
        default: the value before the first measurement or command.
        type: type shown in the documentation: ``float``, ``vec3``.
        level: the levels that have the field, or ``all``.
        unit: see `morse.core.units`; empty for none.
        frame: see `FRAMES`; empty if the field is not given in a frame.
        shape: shape of a list or array; None for a single value, or for any shape.
        dtype: dtype of the numpy array in the field; empty if the field is not an array.
        low: smallest value of each item.
        high: largest value of each item.
        angle: whether it is kept in (-pi, pi]; noise wraps around.
        quaternion: whether it is w, x, y, z with length 1.
        allow: allowed values outside of low..high: ``inf``, ``-inf``, ``nan``, ``none``.
        follows: the fields from which `Sensor.report` computes this field; no noise is added to it.
    """

    default: Value
    type: str = ""
    doc: str = ""
    level: str | tuple[str, ...] = "all"
    unit: str = ""
    frame: str = ""
    shape: Shape | None = None
    dtype: str = ""
    low: float | None = None
    high: float | None = None
    angle: bool = False
    quaternion: bool = False
    allow: tuple[str, ...] = ()
    follows: tuple[str, ...] = ()

    def on_level(self, level: str | None) -> bool:
        """Whether a component at that level has the field."""
        return self.level == "all" or level is None or level == self.level or level in _words(self.level)


def _words(level: str | tuple[str, ...]) -> tuple[str, ...]:
    return (level,) if isinstance(level, str) else level


class Property(NamedTuple):
    """A parameter that scripts set with ``properties(Name=...)`` and clients with ``set_property``.

    Attributes:
        default: the value if a script sets none.
        name: name for scripts and clients.
        type: type shown in the documentation; ``int`` accepts integers only.
        low, high: the range of numbers, or None.
        choices: the only allowed values; empty for any.
        unit: see `morse.core.units`.
        allow: allowed special values: ``inf``, ``-inf``, ``nan``, ``none``.
    """

    default: Value
    name: str
    type: str = ""
    doc: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[Value, ...] = ()
    unit: str = ""
    allow: tuple[str, ...] = ()


class StateVariable(NamedTuple):
    """An attribute that a component keeps from tick to tick.

    Attributes:
        type: the class or classes of its values; ``float`` includes integers.
        unit: see `morse.core.units`.
    """

    type: type | UnionType
    doc: str = ""
    unit: str = ""

    @property
    def type_name(self) -> str:
        """The type as in a declaration, such as ``tuple | None``."""
        return getattr(self.type, "__name__", None) or str(self.type).replace("NoneType", "None")

    def accepts(self, value: object) -> bool:
        """Whether a value has the declared type."""
        return isinstance(value, self.type) or (isinstance(value, int) and isinstance(0.0, self.type))


class OptionFields(NamedTuple):
    """The fields of a `morse.core.declarations.Option`, which are described there."""

    type: type | tuple[type, ...] = object
    default: Value = None
    doc: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[Value, ...] = ()
    unit: str = ""
    allow: tuple[str, ...] = ()
    shape: Shape | None = None


class Level(NamedTuple):
    """An abstraction level; ``classpath`` is the class that implements it, if it is another class."""

    classpath: str | None
    doc: str
    default: bool


class KindUse(NamedTuple):
    """The use of a message kind by a component: the sources of the values of its slots.

    Attributes:
        kind: see `morse.core.kinds`.
        slots: slot name to field, fields, property, constant or function (see `add_kind`).
        level: the levels that use the kind, or ``all``.
        when: function of the component that returns whether it uses the kind; None if it always does.
        topic: sub-topic of the topic of the component; empty for the topic itself.
        on_request: whether the kind is used only if the script asks for it.
        where: file and line of the declaration.
    """

    kind: str
    slots: Mapping[str, Value]
    level: str | tuple[str, ...] = "all"
    when: Callable[..., bool] | None = None
    topic: str = ""
    on_request: bool = False
    where: str = ""

    def on_level(self, level: str | None) -> bool:
        """Whether a component at that level uses the kind."""
        return self.level == "all" or level is None or level in _words(self.level)
