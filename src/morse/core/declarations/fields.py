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
        reached: the values between which commands have an effect, which the page shows as a slider; None for all.
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
    reached: tuple[float, float] | None = None

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
        written_by: what of the class of scripts writes it; neither ``properties`` nor ``set_property`` may then.
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
    written_by: str = ""


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


class Euler(NamedTuple):
    """A quaternion from Euler angles (R = Rz·Ry·Rx), and back.

    Attributes:
        fields: the fields roll, pitch and yaw; or one field with all three angles.
    """

    fields: tuple[str | None, ...]


class Prop(NamedTuple):
    """A property of the component, by its name in Python.

    Attributes:
        name: e.g. ``_range``.
        scale: a factor, e.g. -0.5 for the first angle of a fan.
    """

    name: str
    scale: float = 1.0


class Scaled(NamedTuple):
    """A field times a factor, in both directions: colours 0..1 in the field, 0..255 in the message.

    Attributes:
        field: the field.
        factor: value in the message divided by the value in the field.
    """

    field: str
    factor: float


class Computed(NamedTuple):
    """A function of the data of the component.

    Attributes:
        function: takes the data fields by name and the properties, and uses nothing else: it may be called later, in
            any thread.
        properties: names of attributes of the component, in Python.
        by_rows: whether the function also takes the data of many ticks, whose fields have a first axis of rows.
        axes: for covariances: the fields whose noise is that of the axes of the slot.
    """

    function: Callable[..., Value]
    properties: tuple[str, ...] = ()
    by_rows: bool = False
    axes: tuple[str, ...] = ()


class Each(NamedTuple):
    """The fields whose names an attribute of the component lists, e.g. one for each joint of its model.

    Attributes:
        attribute: the name of the attribute, which holds a sequence of names of fields.
        among: name of an attribute that lists those fields to which the slot applies at present; empty for all.
    """

    attribute: str
    among: str = ""


class Mapped(NamedTuple):
    """Translation between the words of a field and the words of a slot, in both directions.

    Attributes:
        field: the field that contains the word.
        words: word of the field to word of the slot.
    """

    field: str
    words: Mapping[str, str]


def euler(*fields: str | None) -> Euler:
    """Return a source for a quaternion from the fields roll, pitch and yaw, or from one field with three angles.

    None stands for an angle that the component does not have; the angle is 0.
    """
    if len(fields) not in (1, 3):
        raise TypeError(f"euler() takes roll, pitch and yaw, or one field that contains all three, not {len(fields)}")
    return Euler(fields)


def prop(name: str, scale: float = 1.0) -> Prop:
    """Return a source for the value of a property times ``scale``; ``name`` is its attribute in Python."""
    return Prop(name, scale)


def scaled(field: str, factor: float) -> Scaled:
    """Return a source for a field times a factor: ``scaled("colours", 255.0)`` maps 0..1 to 0..255 and back."""
    return Scaled(field, factor)


def computed(
    function: Callable[..., object], *properties: str, by_rows: bool = False, axes: tuple[str, ...] = ()
) -> Computed:
    """Return a source for a function of the data fields, which uses nothing else of the component.

    Args:
        function: takes the data fields by name, and the properties.
        properties: names of properties in Python, whose values are the other arguments.
        by_rows: whether the function also takes the data of many ticks, whose fields have a first axis of rows.
        axes: for covariances: the fields whose noise is that of the axes of the slot.
    """
    return Computed(function, properties, by_rows, axes)


def each(attribute: str, among: str = "") -> Each:
    """The fields whose names an attribute of the component lists, side by side; as words, these names.

    Args:
        attribute: name of the attribute.
        among: name of an attribute that lists those fields to which the slot applies at present. The other fields are
            NaN in messages, and commands do not set them.
    """
    return Each(attribute, among)


def mapped(field: str, **words: str) -> Mapped:
    """Return a source that translates words: ``mapped("status", full="Charged")`` sends ``Charged`` as ``full``."""
    return Mapped(field, {own: of_kind for of_kind, own in words.items()})
