"""Binds a component to its message kinds: messages are created from its fields and read into them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import fields_of_component, kinds, properties, says_nothing
from morse.core.declarations.fields import Each
from morse.core.exceptions import MorseDeclarationError
from morse.core.kinds.covariance import covariances
from morse.core.kinds.sources import Among, source_of
from morse.core.kinds.table import GENERAL, ORIENTATION, PICTURES, Message, kind_named
from morse.core.kinds.turning import NED_AS_WORLD, TURNABLE, turned
from morse.core.reports.quoting import nearest, shown
from morse.core.rows.marks import known_data
from morse.core.validation.spec import CommandError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from morse.core.declarations import DataField, KindUse
    from morse.core.kinds.sources import Source
    from morse.core.kinds.table import Kind, Slot
    from morse.core.object import Object
    from morse.core.values import Fields, Value


_SCALAR: dict[str, Callable[[Value], Value]] = {"bool": bool, "str": str, "int32": int}


def as_slot_rows(slot: Slot, value: Value) -> Value:
    """Return the values of many messages in the form of `as_slot`, with a first axis of rows; words are shared.

    Raises:
        TypeError: they are neither numbers nor words.
    """
    value_dtype = getattr(value, "dtype", None)
    if value_dtype is None:
        return as_slot(slot, value)
    if slot.dtype in ("str", "object") or value_dtype.kind not in "iufb":
        raise TypeError(f"slot '{slot.name}' is read one by one")
    dtype = "bool" if slot.dtype == "bool" else "int64" if slot.dtype in _SCALAR else "float64"
    if slot.shape:
        dtype = str(value_dtype) if str(value_dtype) in slot.dtypes else slot.dtype
    return value.astype(dtype, copy=False)


def as_slot(slot: Slot, value: Value) -> Value:
    """Return a value in the form that readers get: a C-contiguous read-only array, or a plain Python value."""
    if slot.shape == ():
        return _SCALAR.get(slot.dtype, float)(value)
    if slot.dtype in ("str", "object"):
        return tuple(value)
    import numpy as np

    value_dtype = getattr(value, "dtype", None)
    if value_dtype is None:
        result = np.array(value, slot.dtype, order="C")
        result.setflags(write=False)  # three times as fast as assigning flags.writeable
        return result
    dtype = str(value_dtype) if str(value_dtype) in slot.dtypes else slot.dtype
    array = np.ascontiguousarray(value, dtype=dtype).view()
    array.flags.writeable = False
    return array


def uses_after_modifiers(uses: Iterable[KindUse], fields: Mapping[str, DataField]) -> Iterator[KindUse]:
    """Return the kinds after the modifiers have been applied.

    A pose whose position is longitude, latitude and altitude becomes a ``fix``, with an ``attitude`` on the sub-topic
    ``attitude`` if it has an orientation. A pose in geocentric coordinates has no specific kind.
    """
    for use in uses:
        frame = _frame_of_position(use, fields) if use.kind == "pose" else ""
        if frame == "wgs84":
            yield from _as_fix(use)
        elif frame != "geocentric":
            yield use


def _frame_of_position(use: KindUse, fields: Mapping[str, DataField]) -> str:
    position = use.slots["position"]
    first = position[0] if isinstance(position, (tuple, list)) else None
    field = fields.get(str(first))
    return "" if field is None else field.frame


def _as_fix(use: KindUse) -> Iterator[KindUse]:
    longitude, latitude, altitude = use.slots["position"]
    slots = {"latitude": latitude, "longitude": longitude, "altitude": altitude}
    yield use._replace(kind="fix", slots=slots)
    if "orientation" in use.slots:
        slots = {"orientation": use.slots["orientation"]}
        yield use._replace(kind="attitude", slots=slots, topic=f"{use.topic}/attitude".strip("/"))


#: parts of the declaration of a field that a modifier can change
_CHANGEABLE = ("unit", "frame", "low", "high", "shape", "dtype", "angle", "allow")


class KindError(MorseDeclarationError):
    """Message kinds of a component do not match its fields.

    Attributes:
        findings: all mistakes, one sentence each.
    """

    def __init__(self, findings: list[str]) -> None:
        super().__init__("; ".join(findings))
        self.findings = findings


class BoundKind:
    """A message kind of one component.

    Attributes:
        component: the component.
        kind: the kind.
        topic: sub-topic of the topic of the component; empty for the topic itself.
        frame: frame of the first slot of the messages.
        on_request: whether the kind is used only if the script asks for it.
        rest: the fields that do not belong to a slot.
        is_picture: whether it is a kind of cameras.
    """

    def __init__(
        self, component: Object, use: KindUse, fields: Mapping[str, DataField], units: Mapping[str, str]
    ) -> None:
        self.component = component
        kind = kind_named(use.kind)
        assert kind is not None, "the class was checked when it was created"
        self.kind: Kind = kind
        self.topic, self.on_request = use.topic, use.on_request
        self._sources: list[tuple[Slot, Source]] = []
        findings = []
        data_fields = fields_of_component(component)
        for name, argument in use.slots.items():
            slot = self.kind.slots[name]
            among = ""
            if isinstance(argument, Each):
                among, argument = argument.among, tuple(getattr(component, argument.attribute))
            if slot.optional and _names(argument) - fields.keys() and _names(argument) <= data_fields.keys():
                continue  # the field may belong to another level
            try:
                source = source_of(slot, argument, fields, units)
            except MorseDeclarationError as error:
                findings.append(f"{component.name()}: slot '{name}' of kind '{use.kind}': {error}")
                continue
            if source is not None:
                self._sources.append((slot, Among(source, component, among) if among else source))
        if findings:
            raise KindError(findings)
        names = {name for _, source in self._sources for name in source.fields}
        self.rest = tuple(name for name in fields if name not in names and name != "timestamp")
        self._turns = self._find_turns()
        self.is_picture = kind.name in PICTURES
        self.frame = next((_frame_in_message(slot, s) for slot, s in self._sources if slot.frame), "own")
        self._covariances, changing = covariances(component, self.kind, self._sources, fields)
        self._sources += changing

    def _find_turns(self) -> dict[str, tuple[str, str]]:
        """Find slots whose fields are in a different frame from the first slot with the same frame in the kind."""
        leading: dict[str, str] = {}
        turns = {}
        for slot, source in self._sources:
            frame = source.frame or slot.frame
            target_frame = leading.setdefault(slot.frame, _frame_in_message(slot, source))
            if not slot.moves or frame == target_frame:
                continue
            if frame not in TURNABLE or target_frame not in TURNABLE:
                raise KindError(
                    [
                        f"{self.component.name()}: slot '{slot.name}' of kind '{self.kind.name}' is in the frame "
                        f"'{frame}', and cannot be converted into '{target_frame}', the frame of its first slot"
                    ]
                )
            turns[slot.name] = (frame, target_frame)
        return turns

    def has(self, slot: str) -> bool:
        """Whether the component has fields for a slot at present, or declared noise for a covariance slot."""
        return slot in self._covariances or any(
            entry.name == slot and source.is_present for entry, source in self._sources
        )

    @property
    def is_silent(self) -> bool:
        """Whether there is no message at present, because a camera does not capture."""
        return self.is_picture and self.component.capturing is False

    def gather(self) -> Message:
        """Return the message with the present values of the fields; its slots are computed when they are read."""
        component = self.component
        data = component.local_data
        slots = data if self.kind.name == GENERAL else self._present
        return Message(self.kind, self._stamp, self.frame, slots, data, self.topic)

    def _stamp(self) -> int:
        """The simulated time of the measurement, even if the data are delivered later."""
        return int(self.component.clock.stamp(self.component.local_data.get("timestamp")))

    def _present(self) -> Fields:
        return self._slots_of(self.values(self.component))

    @property
    def sources(self) -> Sequence[tuple[Slot, Source]]:
        """The slots with a source, in the order of `values`."""
        return self._sources

    def values(self, component: Object) -> list[Value]:
        """Return the present value of each slot with a source, None if there is none, in the order of `message_of`.

        Args:
            component: the component, or an object with its ``local_data`` if `needs` is not None.
        """
        if not self._turns:
            return [source.get(component) for _, source in self._sources]
        return [self.value_of(index, component) for index in range(len(self._sources))]

    def value_of(self, index: int, component: Object) -> Value:
        """Return one of the `values`."""
        slot, source = self._sources[index]
        value = source.get(component)
        if slot.name in self._turns and value is not None:
            return turned(value, slot.moves, *self._turns[slot.name], component)
        return value

    def message_of(self, values: Sequence[object], stamp: int) -> Message:
        """Return the message with the `values` of the slots at a time, whole ns."""
        return Message(self.kind, stamp, self.frame, self._slots_of(values))

    def _slots_of(self, values: Sequence[object]) -> Fields:
        slots: Fields = {
            slot.name: as_slot(slot, value)
            for (slot, _), value in zip(self._sources, values, strict=True)
            if value is not None
        }
        slots.update(self._covariances)
        return slots

    def is_live(self, slot: Slot, source: Source) -> bool:
        """Whether the value of a slot depends on more than the data of the component."""
        return slot.name in self._turns or not (source.is_of_data or source.properties)

    def message_of_rows(self, values: Sequence[object], stamps: Value) -> Message:
        """Return many messages as one, whose slots have a first axis of rows.

        Args:
            values: of the slots, in the order of `sources`; words are the same in all rows.
            stamps: (R,) whole ns.

        Raises:
            TypeError: the messages have to be made one by one.
        """
        slots: Fields = {
            slot.name: as_slot_rows(slot, value)
            for (slot, _), value in zip(self._sources, values, strict=True)
            if value is not None
        }
        slots.update(self._covariances)
        return Message(self.kind, stamps, self.frame, slots)

    def scatter(self, slots: Mapping[str, object], frame: str = "") -> tuple[Fields, str | None]:
        """Return the fields that a command sets, for `morse.core.validation.Commands`; other fields stay unchanged.

        Args:
            slots: values by slot name; None, a quaternion of zeros and missing slots set nothing.
            frame: frame of the first slot; empty for the frame of the fields.

        Returns:
            Field to value, and a message for the sender if a part of the command has no effect, else None.

        Raises:
            CommandError: a slot does not exist, or a value is not valid for it.
        """
        if self.kind.name == GENERAL:
            return dict(slots), None
        fields: Fields = {}
        remarks = []
        by_name = {slot.name: (slot, source) for slot, source in self._sources}
        for name, value in slots.items():
            if value is None:
                continue
            if name not in by_name:
                if name in self.kind.slots:
                    remarks.append(f"slot '{name}' has no effect")
                    continue
                raise CommandError(
                    shown(name), f"kind '{self.kind.name}' has no slot {shown(name)}{nearest(name, self.kind.slots)}"
                )
            slot, source = by_name[name]
            try:
                remark = source.put(self._given(slot, source, value, frame), fields)
            except (TypeError, ValueError, AttributeError) as error:
                problem = str(error) if isinstance(error, ValueError) and str(error) else f"the shape {slot.shape}"
                raise CommandError(name, f"slot '{name}' is {shown(value)}, expected {problem}") from None
            if remark is not None:
                remarks.append(f"{remark} in slot '{name}'")
        return fields, "; ".join(remarks) or None

    def _given(self, slot: Slot, source: Source, value: Value, frame: str) -> Value:
        if slot.shape and slot.dtype not in ("str", "object"):
            value = _checked_array(slot, value)
        if slot.name in self._turns:
            # all slots of the sender are in the frame of its first slot
            own_frame, message_frame = self._turns[slot.name][1], self._turns[slot.name][0]
        else:
            own_frame = message_frame = source.frame or slot.frame
        leading = next((s.frame for s, _ in self._sources if s.frame), "")
        if frame and slot.frame == leading:
            own_frame = frame
        if not slot.moves or own_frame == message_frame:
            return value
        if own_frame not in TURNABLE or message_frame not in TURNABLE:
            raise ValueError(f"the frame '{message_frame}', into which '{own_frame}' cannot be converted")
        if slot.moves == ORIENTATION and not any(value):
            return value
        return turned(value, slot.moves, own_frame, message_frame, self.component)


def _frame_in_message(slot: Slot, source: Source) -> str:
    """Return the frame of a slot in messages, if it is the first slot: that of its field."""
    return slot.frame if source.frame == NED_AS_WORLD else source.frame or slot.frame


def _checked_array(slot: Slot, value: object) -> Value:
    import numpy as np

    array = np.asarray(value)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"numbers of the shape {slot.shape}")
    for shape in (slot.shape, *slot.shapes):
        if array.ndim == len(shape) and all(
            expected_size is None or expected_size == size
            for expected_size, size in zip(shape, array.shape, strict=True)
        ):
            return array
    raise ValueError(f"the shape {slot.shape}")


def _names(entry: object) -> set[str]:
    return {entry} if isinstance(entry, str) else set()


def fields_of(component: Object) -> dict[str, DataField]:
    """Return the declarations of the fields of a component, as changed by its properties and modifiers."""
    fields = {name: f for name, f in fields_of_component(component).items() if name in known_data(component)}
    modifiers = [*component.output_modifiers, *component.input_modifiers]
    for changes in [component.field_changes, *(getattr(modifier, "changes", {}) for modifier in modifiers)]:
        for name, change in changes.items():
            if name in fields:
                own_changes: Fields = {key: value for key, value in change.items() if key in _CHANGEABLE}
                fields[name] = fields[name]._replace(**own_changes)
    return fields


def bind(component: Object, *, on_request: bool = False) -> tuple[BoundKind, ...]:
    """Return the message kinds of a component; ``general`` if it declares none, and none if it has no data.

    Args:
        component: an instance with its level and modifiers.
        on_request: whether to include the kinds that are used only if the script asks for them.

    Raises:
        KindError: the message lists all mistakes.
    """
    fields = fields_of(component)
    units = {name: declaration.unit for name, declaration in properties(type(component)).items()}
    bound_kinds, findings = [], []
    for use in uses_after_modifiers(_uses(component, on_request), fields):
        try:
            bound_kinds.append(BoundKind(component, use, fields, units))
        except KindError as error:
            findings += error.findings
    bound_kinds += _of_members(component, on_request)
    topics = [one.topic for one in bound_kinds]
    for topic in dict.fromkeys(topic for topic in topics if topics.count(topic) > 1):
        names = ", ".join(f"'{one.kind.name}'" for one in bound_kinds if one.topic == topic)
        findings.append(f"{component.name()}: the kinds {names} have the same topic; set topic=... in add_kind")
    if findings:
        raise KindError(findings)
    if bound_kinds or not fields or says_nothing(type(component)):
        return tuple(bound_kinds)
    return (general_kind(component),)


def general_kind(component: Object) -> BoundKind:
    """Return the kind ``general`` of a component, whatever kinds it declares: all of its fields."""
    from morse.core.declarations import KindUse

    return BoundKind(component, KindUse(GENERAL, {}), fields_of(component), {})


def _of_members(component: Object, on_request: bool) -> Iterator[BoundKind]:
    """Iterate over the kinds of the components in `Object.kind_members`, each with its sub-topic."""
    for name, member in component.kind_members.items():
        for one in bind(member, on_request=on_request):
            one.topic = f"{name}/{one.topic}".rstrip("/")
            yield one


def _uses(component: Object, on_request: bool) -> Iterable[KindUse]:
    for use in kinds(type(component)):
        applies = use.on_level(component.level) and (on_request or not use.on_request)
        if applies and (use.when is None or use.when(component)):
            yield use


def findings_of(components: Iterable[Object]) -> list[tuple[Object, str]]:
    """Return all mistakes in the kinds of some components: component and sentence.

    Of components with the same declarations only the first is checked.
    """
    findings = []
    slots_so_far = set()
    for component in components:
        modifiers = tuple(type(m) for m in [*component.output_modifiers, *component.input_modifiers])
        by_properties = any(use.when is not None for use in kinds(type(component)))
        alike = type(component), component.level, modifiers, component if by_properties else None
        if alike in slots_so_far:
            continue
        slots_so_far.add(alike)
        try:
            bind(component, on_request=True)
        except KindError as error:
            findings += [(component, finding) for finding in error.findings]
    return findings
