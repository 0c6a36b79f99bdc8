"""Sources of slots: they read the value of a slot from a component and write commands to its fields."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

from morse.core.declarations.fields import Computed, Euler, Mapped, Prop, Scaled
from morse.core.exceptions import MorseDeclarationError
from morse.core.kinds.turning import angles_of, normalized, quaternion_of
from morse.core.reports.quoting import closest, nearest, shown
from morse.core.units import UnitError, conversion

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

    from morse.core.declarations import DataField
    from morse.core.kinds.table import Slot
    from morse.core.object import Object
    from morse.core.values import Fields, Value

#: what the conversion between frames leaves of a zero
_ROUNDING = 1e-9


class DataOwner(Protocol):
    """A component, or what stands for it: its data, and its properties as attributes."""

    local_data: Fields


class Source:
    """The source of one slot.

    Attributes:
        fields: names of its fields along the axes of the slot; None for an axis without a field.
        frame: the frame of these fields, or an empty string if they declare none.
    """

    fields: tuple[str | None, ...] = ()
    frame = ""
    #: whether `get` uses nothing of the component but ``local_data``
    is_of_data = False
    #: attributes of the component that `get` uses besides ``local_data``, if it uses only these
    properties: tuple[str, ...] = ()

    @property
    def is_present(self) -> bool:
        """Whether the source has a value at present."""
        return True

    @property
    def axes(self) -> tuple[str | None, ...]:
        """The fields whose noise is that of the axes of the slot."""
        return self.fields

    def get(self, component: DataOwner) -> Value:
        """The value, in the unit of the slot; None if there is no value at present."""
        raise NotImplementedError

    def rows(self, columns: Mapping[str, object], component: DataOwner) -> Value:
        """The values of many messages, with a first axis of rows.

        Args:
            columns: of the fields of ``local_data``.
            component: an object with the `properties` of the component.

        Raises:
            TypeError: the values have to be read one by one.
        """
        raise TypeError(f"{type(self).__name__} is read one by one")

    def put(self, value: object, fields: Fields) -> str | None:
        """Convert a value of the slot into values of fields.

        Returns:
            A message for the sender if a part of the value has no effect, else None.

        Raises:
            ValueError: the message contains the expected value.
        """
        return None


class Constant(Source):
    """A constant value."""

    is_of_data = True

    def __init__(self, value: object) -> None:
        self._value = value

    def get(self, component: DataOwner) -> Value:
        """The constant."""
        return self._value

    def rows(self, columns: Mapping[str, object], component: DataOwner) -> Value:
        """The constant."""
        return self._value


class FromProperty(Source):
    """The value of a property, which may change during the simulation."""

    def __init__(self, source: Prop, factor: float, offset: float) -> None:
        self._name, self._factor, self._offset = source.name, factor * source.scale, offset
        self.properties = (source.name,)

    def get(self, component: DataOwner) -> Value:
        """The property, in the unit of the slot."""
        value = getattr(component, self._name)
        return value if isinstance(value, (str, bool)) else value * self._factor + self._offset

    def rows(self, columns: Mapping[str, object], component: DataOwner) -> Value:
        """The property, in the unit of the slot."""
        return self.get(component)


class FromFunction(Source):
    """A function of the component; its frame is the frame of the field with the name of the slot, if there is one."""

    def __init__(self, function: Callable[..., object], frame: str) -> None:
        self._function, self.frame = function, frame

    def get(self, component: DataOwner) -> Value:
        """The return value of the function."""
        return self._function(component)


class FromData(Source):
    """A function of the data; its frame is the frame of the field with the name of the slot, if there is one."""

    def __init__(self, source: Computed, frame: str) -> None:
        self._function, self.properties, self._by_rows, self._axes = source
        self.frame = frame
        self.is_of_data = not self.properties

    @property
    def axes(self) -> tuple[str | None, ...]:
        """See `Source.axes`."""
        return self._axes

    def _call(self, data: object, component: DataOwner) -> Value:
        return self._function(data, *[getattr(component, name) for name in self.properties])

    def get(self, component: DataOwner) -> Value:
        """The return value of the function."""
        return self._call(component.local_data, component)

    def rows(self, columns: Mapping[str, object], component: DataOwner) -> Value:
        """The return value of the function."""
        return self._call(columns, component) if self._by_rows else super().rows(columns, component)


class FromField(Source):
    """The value of a field, converted into the unit of the slot."""

    is_of_data = True

    def __init__(self, name: str, field: DataField, factor: float, offset: float) -> None:
        self.fields, self.frame = (name,), field.frame
        self._name, self._factor, self._offset = name, factor, offset
        self._plain = factor == 1.0 and offset == 0.0

    def get(self, component: DataOwner) -> Value:
        """The field, in the unit of the slot."""
        value = component.local_data[self._name]
        if self._plain:
            return value
        if type(value) is list and value and type(value[0]) is float:
            # the same bits as by numpy, which takes ten times as long for three numbers
            return [number * self._factor + self._offset for number in value]
        return (
            _array(value) * self._factor + self._offset
            if hasattr(value, "__len__")
            else (value * self._factor + self._offset)
        )

    def rows(self, columns: Mapping[str, object], component: DataOwner) -> Value:
        """The column of the field, in the unit of the slot."""
        column = columns[self._name]
        return column if self._plain else numeric(column) * self._factor + self._offset

    def put(self, value: Value, fields: Fields) -> str | None:
        """The value in the unit of the field."""
        if not self._plain:
            value = ((_array(value) if hasattr(value, "__len__") else value) - self._offset) / self._factor
        fields[self._name] = value
        return None


class Stack(Source):
    """Several numbers, stacked into an array."""

    is_of_data = True

    def __init__(self, names: tuple[str | None, ...], frame: str, scales: tuple[tuple[float, float], ...]) -> None:
        self.fields, self.frame = names, frame
        self._parts = tuple(zip(names, scales, strict=True))

    def get(self, component: DataOwner) -> Value:
        """The numbers, 0 where there is no field."""
        data = component.local_data
        return [0.0 if name is None else data[name] * a + b for name, (a, b) in self._parts]

    def rows(self, columns: Mapping[str, object], component: DataOwner) -> Value:
        """The columns side by side."""
        import numpy as np

        parts = [0.0 if name is None else numeric(columns[name]) * a + b for name, (a, b) in self._parts]
        return np.stack(np.broadcast_arrays(*parts), axis=-1)

    def put(self, value: Value, fields: Fields) -> str | None:
        """Write each number to its field; numbers without a field have no effect."""
        rest = []
        for index, ((name, (factor, offset)), number) in enumerate(zip(self._parts, value, strict=True)):
            if name is not None:
                fields[name] = (float(number) - offset) / factor
            elif not abs(number) <= _ROUNDING:
                rest.append(index)
        return f"item {', '.join(map(str, rest))} has no effect" if rest else None


class Among(Source):
    """Several numbers; the slot applies only to some of them at present.

    Args:
        stack: all numbers.
        component: component with the attribute.
        attribute: name of the attribute that lists the fields to which the slot applies.
    """

    def __init__(self, stack: Source, component: Object, attribute: str) -> None:
        self.fields, self.frame = stack.fields, stack.frame
        self._stack, self._component, self._attribute = stack, component, attribute

    def _chosen(self) -> Collection[str | None]:
        names: Collection[str | None] = getattr(self._component, self._attribute)
        return names

    @property
    def is_present(self) -> bool:
        """Whether the slot applies to any of the fields."""
        return bool(self._chosen())

    def get(self, component: DataOwner) -> Value:
        """The numbers, NaN for fields to which the slot does not apply; None if it applies to none."""
        if not self.is_present:
            return None
        names, values = self._chosen(), self._stack.get(component)
        return [value if name in names else math.nan for name, value in zip(self.fields, values, strict=True)]

    def put(self, value: object, fields: Fields) -> str | None:
        """Write the numbers of the fields to which the slot applies; NaN stands for no command."""
        names, numbers = self._chosen(), dict[str, object]()
        remark = self._stack.put(value, numbers)
        set_now = {name: number for name, number in numbers.items() if name in names and number == number}
        fields.update(set_now)
        rest = [name for name, number in numbers.items() if name not in names and number and number == number]
        if rest:
            return f"{', '.join(rest)}: another control mode; the value has no effect"
        return remark


class FromEuler(Source):
    """A quaternion from Euler angles."""

    is_of_data = True

    def __init__(self, names: tuple[str | None, ...], frame: str, factor: float) -> None:
        self.fields, self.frame = names, frame
        self._factor = factor

    def get(self, component: DataOwner) -> Value:
        """The quaternion w, x, y, z."""
        data, names, factor = component.local_data, self.fields, self._factor
        angles = data[names[0] or ""] if len(names) == 1 else [0.0 if name is None else data[name] for name in names]
        roll, pitch, yaw = angles
        return quaternion_of(roll * factor, pitch * factor, yaw * factor)

    def rows(self, columns: Mapping[str, object], component: DataOwner) -> Value:
        """The quaternions (R, 4)."""
        import numpy as np

        names, factor = self.fields, self._factor
        if len(names) == 1:
            angles = np.moveaxis(numeric(columns[str(names[0])]), -1, 0)
        else:
            present = [None if name is None else numeric(columns[name]) for name in names]
            some = next(column for column in present if column is not None)
            angles = [np.zeros_like(some) if column is None else column for column in present]
        from morse.mathutils.rotation_rows import quaternions_of  # commands of the shell work without numpy

        roll, pitch, yaw = angles
        return np.stack(quaternions_of(roll * factor, pitch * factor, yaw * factor), axis=-1)

    def put(self, value: Value, fields: Fields) -> str | None:
        """Write the angles; nothing if the quaternion is zero."""
        unit = normalized(value)
        if unit is None:
            return None
        angles = [angle / self._factor for angle in angles_of(unit)]
        if len(self.fields) == 1 and self.fields[0] is not None:
            fields[self.fields[0]] = angles
            return None
        fields.update((name, angle) for name, angle in zip(self.fields, angles, strict=True) if name is not None)
        return None


class FromWord(Source):
    """A string field, translated into the words of the kind."""

    def __init__(self, source: Mapped) -> None:
        self.fields = (source.field,)
        self._name = source.field
        self._words = dict(source.words)
        self._own = {word: own for own, word in source.words.items()}

    def get(self, component: DataOwner) -> Value:
        """The word of the kind."""
        word = component.local_data[self._name]
        return self._words.get(word, word)

    def put(self, value: Value, fields: Fields) -> str | None:
        """The word of the component."""
        fields[self._name] = self._own.get(value, value)
        return None


def source_of(slot: Slot, value: object, fields: Mapping[str, DataField], units: Mapping[str, str]) -> Source | None:
    """Return the source of a slot; None if the slot is optional and the component does not have its fields.

    Args:
        value: the argument of `add_kind` for the slot.
        fields: declarations of the fields of the component at its level, after its modifiers.
        units: units of its properties, by name in Python.

    Raises:
        MorseDeclarationError: the source does not fit the slot.
    """
    if isinstance(value, Euler):
        return _euler(value.fields, fields)
    if isinstance(value, Prop):
        if value.name not in units:
            raise MorseDeclarationError(f"there is no property {shown(value.name)}{nearest(value.name, units)}")
        factor, offset = _converted(f"property '{value.name}'", units[value.name], slot)
        return FromProperty(value, factor, offset)
    if isinstance(value, Scaled):
        field = _field(value.field, fields)
        _check_shape(slot, value.field, field)
        return FromField(value.field, field, value.factor, 0.0)
    if isinstance(value, Computed):
        return FromData(value, fields[slot.name].frame if slot.name in fields else "")
    if isinstance(value, Mapped):
        _field(value.field, fields)
        unknown = [word for word in value.words.values() if slot.choices and word not in slot.choices]
        if unknown:
            raise MorseDeclarationError(
                f"{shown(unknown[0])} is not one of its words{nearest(unknown[0], slot.choices)}"
            )
        return FromWord(value)
    if callable(value):
        return FromFunction(value, fields[slot.name].frame if slot.name in fields else "")
    if isinstance(value, str):
        return (
            _word(slot, value, fields) if slot.dtype == "str" and value not in fields else _single(slot, value, fields)
        )
    if isinstance(value, (tuple, list)) and slot.dtype != "str" and any(isinstance(n, str) for n in value):
        return _stack(slot, tuple(value), fields)
    return Constant(value)


def _field(name: Value, fields: Mapping[str, DataField]) -> DataField:
    field = fields.get(name)
    if field is None:
        raise MorseDeclarationError(f"there is no field {shown(name)}{nearest(name, fields)}")
    return field


def _word(slot: Slot, word: str, fields: Mapping[str, DataField]) -> Source:
    if slot.choices and word not in slot.choices:
        candidates = [*slot.choices, *fields]
        raise MorseDeclarationError(f"{shown(word)} is neither a field nor one of its words{nearest(word, candidates)}")
    if not slot.choices and (near := closest(word, fields)) is not None:
        raise MorseDeclarationError(f"there is no field {shown(word)}; did you mean '{near}'?")
    return Constant(word)


def _single(slot: Slot, name: str, fields: Mapping[str, DataField]) -> Source:
    field = _field(name, fields)
    _check_shape(slot, name, field)
    factor, offset = _converted(f"field '{name}'", field.unit, slot)
    return FromField(name, field, factor, offset)


def _check_shape(slot: Slot, name: str, field: DataField) -> None:
    from morse.core.declarations.refused import shape_of

    if slot.dtype in ("str", "object", "bool"):
        return
    shape = field.shape if field.shape is not None else shape_of(field.default)
    # the default is a text that describes the value, or an empty list
    if shape is None or (0 in shape and field.shape is None):
        return
    for slot_shape in (slot.shape, *slot.shapes):
        if len(slot_shape) == len(shape) and all(
            a is None or b is None or a == b for a, b in zip(slot_shape, shape, strict=True)
        ):
            return
    raise MorseDeclarationError(f"it takes the shape {slot.shape}, field '{name}' has {shape}")


def _stack(slot: Slot, names: tuple[Value, ...], fields: Mapping[str, DataField]) -> Source:
    fields_of_slot = [None if name is None else _field(name, fields) for name in names]
    if len(slot.shape) != 1 or (slot.shape[0] is not None and slot.shape[0] != len(names)):
        raise MorseDeclarationError(f"it takes the shape {slot.shape}, {len(names)} fields are given")
    scales = tuple(
        (1.0, 0.0) if field is None else _converted(f"field '{name}'", field.unit, slot)
        for name, field in zip(names, fields_of_slot, strict=True)
    )
    return Stack(names, _common_frame(names, fields_of_slot), scales)


def _euler(names: tuple[str | None, ...], fields: Mapping[str, DataField]) -> Source:
    angles = [None if name is None else _field(name, fields) for name in names]
    factors = set()
    for name, field in zip(names, angles, strict=True):
        if field is not None:
            if not field.unit:
                raise MorseDeclarationError(f"an angle needs the unit rad or deg; field '{name}' has no unit")
            factors.add(conversion(field.unit, "rad")[0])
    if len(factors) > 1:
        raise MorseDeclarationError(f"the angles {shown(names)} have different units")
    return FromEuler(names, _common_frame(names, angles), factors.pop() if factors else 1.0)


def _common_frame(names: tuple[object, ...], fields: list[DataField | None]) -> str:
    frames = {field.frame: name for name, field in zip(names, fields, strict=True) if field is not None}
    if len(frames) > 1:
        pairs = ", ".join(f"'{name}' in {frame or 'none'}" for frame, name in frames.items())
        raise MorseDeclarationError(f"its fields are in different frames: {pairs}")
    return next(iter(frames), "")


def _converted(what: str, unit: str, slot: Slot) -> tuple[float, float]:
    if not slot.unit or unit == slot.unit:
        return 1.0, 0.0
    if not unit:
        if slot.unit == "1":
            return 1.0, 0.0
        raise MorseDeclarationError(f"it takes {slot.unit}; {what} has no unit")
    try:
        return conversion(unit, slot.unit)
    except UnitError as error:
        units = str(error).partition("; known: ")[2]
        raise MorseDeclarationError(
            f"it takes {slot.unit}; {what} has {unit}" + (f"; known: {units}" if units else "")
        ) from None


def numeric(column: Value) -> Value:
    """A column of numbers of double precision.

    Raises:
        TypeError: it contains other values than numbers.
    """
    if getattr(column, "dtype", None) is None or column.dtype.kind not in "iufb":
        raise TypeError("a column of other values than numbers is read one by one")
    return column.astype("float64", copy=False)


def _array(value: object) -> Value:
    import numpy as np

    return np.asarray(value, dtype=np.float64)
