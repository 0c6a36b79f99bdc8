"""The records that hold declarations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
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


def _merged(cls: type, attribute: str) -> dict[str, Any]:
    union: dict[str, object] = {}
    for base in reversed(cls.__mro__):
        union.update(vars(base).get(attribute, {}))
    return union


def data_fields(cls: type) -> dict[str, DataField]:
    """Return the data fields of a class and its bases, in the order of declaration, bases first."""
    return _merged(cls, "_data_fields")


def fields_of_component(component: object) -> dict[str, DataField]:
    """The data fields of a component: those of its class, and those that follow from its model."""
    return {**data_fields(type(component)), **getattr(component, "own_fields", {})}


def properties(cls: type) -> dict[str, Property]:
    """Return the properties of a class and its bases: Python name to declaration."""
    return _merged(cls, "_properties")


def state_variables(cls: type) -> dict[str, StateVariable]:
    """Return the declared state of a class and its bases: name of the attribute to declaration."""
    return _merged(cls, "_state_variables")


def levels(cls: type) -> dict[str, Level]:
    """Return the abstraction levels of a class and its bases."""
    return _merged(cls, "_levels")


def kinds(cls: type) -> tuple[KindUse, ...]:
    """Return the message kinds that a class declares, or those of its bases if it declares none."""
    for base in cls.__mro__:
        own = vars(base).get("_kinds")
        if own is not None:
            return tuple(own)
    return ()


def says_nothing(cls: type) -> bool:
    """Whether a class declares that it has no message kinds (``add_kind(None)``): no middleware carries its data."""
    own_kinds = (vars(base).get("_kinds") for base in cls.__mro__)
    return next((not own for own in own_kinds if own is not None), False)


class PropertyOf(NamedTuple):
    """A property of one component.

    Attributes:
        attribute: name of the attribute of the component that holds the value.
    """

    component: object
    attribute: str
    declaration: Property


class PropertyTable:
    """Finds the properties of components.

    Args:
        component: returns the component of a name; None if there is none.
        components: returns the names of the components whose properties are in the table.
    """

    def __init__(self, component: Callable[[str], object | None], components: Callable[[], Iterable[str]]) -> None:
        self._component, self._components = component, components

    def names(self) -> list[str]:
        """The names of all properties, component by component."""
        names: list[str] = []
        for name in self._components():
            component = self._component(name)
            if component is not None:
                names += [f"{name}.{one.name}" for one in properties(type(component)).values()]
        return names

    def find(self, name: str) -> PropertyOf | None:
        """The property of a name; None if there is none."""
        owner, _, attribute = name.rpartition(".")
        component = self._component(owner)
        if component is None or owner not in self._components():
            return None
        pairs = properties(type(component)).items()
        return next((PropertyOf(component, own, one) for own, one in pairs if one.name == attribute), None)
