"""Restores objects from plain data, into existing objects where possible."""

from __future__ import annotations

import inspect
import random
from collections import Counter, OrderedDict, defaultdict, deque
from enum import Enum
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from morse.core.abstractobject import AbstractObject
from morse.core.reports.faults import is_a
from morse.core.state import values as arrays
from morse.core.state.attributes import (
    MISSING,
    check_name,
    fits,
    fits_roughly,
    is_data,
    is_of_morse,
    is_routine,
    misfit,
    new_types,
    own_attributes,
    reorder,
    word_of,
)
from morse.core.state.values import PUT_TOGETHER, Extents, StateError
from morse.core.state.writing import (
    AS_IS,
    DEEPEST,
    FACTORIES,
    ITEMS,
    Entry,
    attributes_of,
    class_path,
    is_apparatus,
    is_made_of_attributes,
)
from morse.core.streams.local_data import LocalData
from morse.helpers.transformation import Transformation3d
from morse.mathutils import Color, Euler, Matrix, Quaternion, Vector

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.state.values import References
    from morse.core.values import StateData

_T = TypeVar("_T")

#: words of values whose items do not count for the values that contain them
_OBJECTS = frozenset(("own", "object", "namespace", "global", "part", "method"))
_PLAIN = frozenset((type(None), bool, int, float, str, bytes))
_VALUES: dict[str, Callable[[Any], object]] = {cls.__name__: cls for cls in (Vector, Quaternion, Euler, Color, Matrix)}
_DICTS: dict[str, type[dict[Any, Any]]] = {
    "dict": dict,
    "ordered dict": OrderedDict,
    "local data": LocalData,
    "counter": Counter,
    "default dict": defaultdict,
}


class Reader:
    """Restores the parts of one simulation, in the order in which a `Writer` saved them.

    A state may come from a stranger. Attributes that classes of MORSE have set keep their kind (`kinds`), and hold
    data, or objects of the classes that they hold at present. Attributes of classes of the user may hold objects of the
    project too. Methods are those of the object that has the attribute, or that the attribute holds at present.

    Args:
        fresh: whether to create only new objects and change none, to check whether a state can be read.
        trusted: whether this simulation itself has just written the state, so that kinds need not be checked.
    """

    def __init__(self, references: References, *, fresh: bool = False, trusted: bool = False) -> None:
        self._references = references
        self._fresh = fresh
        self._trusted = trusted
        self._strict = not trusted
        #: whether the items of lists and dictionaries keep their kinds, too
        self._deep = False
        #: the classes of objects that may take the place of None
        self._types: frozenset[type] = frozenset()
        self._holder: object = None
        self._extents = Extents()
        self._objects_so_far: list[object] = []
        self._numbers_in_use: set[int] = set()
        self._numbers_with_name: set[int] = set()
        self._depth = 0
        self._readers: dict[str, Callable[[Entry, Any], object]] = {
            "list": self._list,
            "tuple": lambda data, now: tuple(self._items(data[1], now)),
            "named tuple": self._named_tuple,
            "set": self._set,
            "frozenset": lambda data, _: frozenset(Extents.spread(self._items(data[1], MISSING))),
            "deque": self._deque,
            "bytearray": lambda data, _: self._keep(bytearray(data[1])),
            "namespace": self._namespace,
            **dict.fromkeys(_DICTS, self._dict),
            "array": lambda data, _: self._keep(arrays.array_of(arrays.dtype(data[1]), *data[2:])),
            "view": self._view,
            "objects": self._objects,
            "scalar": lambda data, _: np.frombuffer(data[2], dtype=arrays.dtype(data[1]))[0],
            "random": self._generator,
            "legacy random": self._legacy_random,
            "python random": self._python_random,
            "values": lambda data, _: self._keep(_VALUES[data[1]](data[2])),
            "simple": lambda data, _: PUT_TOGETHER[data[1]](*(self.value(part) for part in data[2:])),
            "pose": self._pose,
            "enum": self._enum,
            "own": self._own,
            "object": self._object,
            "method": self._method,
            "global": self._global,
            "part": lambda data, _: references.find(data[1]),
            "again": self._again,
            "as is": lambda _, now: None if now is MISSING else now,
            "integer": lambda data, _: int(data[1], 16),
            "text": lambda data, _: data[1].decode("utf-8", "surrogatepass"),
        }

    def objects(self, first: int = 0) -> list[object]:
        """The objects that were read so far, from a number on: later parts refer to them by their numbers."""
        return self._objects_so_far[first:]

    def leave_out(self, objects: list[object]) -> None:
        """Leave out a part of which another reader has made these objects."""
        self._objects_so_far += objects

    def part(self, name: str, data: object, now: object, holder: object = None) -> Any:
        """Return the restored state of a part of the simulation.

        Args:
            name: name of the part in messages.
            now: the present state of the part.
            holder: the object whose attributes the state contains; None for a state that is data.

        Raises:
            StateError: the saved state is damaged, or refers to something that does not exist.
        """
        self._holder = holder
        self._strict = not self._trusted and (holder is None or is_of_morse(type(holder)))
        try:
            if holder is not None and type(now) is dict and type(data) is list and data[0] == "dict":
                target: StateData = self._keep({})
                target.update(self._attributes(type(holder), data[1], now))
                return target
            value = self.value(data, now)
            self._check(value, now)
            return value
        except StateError as error:
            raise StateError(f"{name}: {error}") from None
        except Exception as error:  # a damaged state may cause any exception, also in `set_state` of a user's class
            raise StateError(f"{name}: the saved state is damaged ({type(error).__name__}: {error!s:.200})") from None

    def value(self, data: object, now: object = MISSING) -> Any:
        """Return a restored value.

        Args:
            now: the present value.
        """
        if type(data) is not list:
            if type(data) not in _PLAIN:
                raise StateError(f"the saved state is damaged: it contains a {type(data).__name__}")
            if self._deep and self._strict and now is not MISSING and type(now) is not type(data):
                self._check(data, now)
            return data
        reader = self._readers.get(data[0])
        if reader is None:
            raise StateError(f"the saved state is damaged: there is no type {data[0]!r:.40}")
        self._depth += 1
        if self._depth > DEEPEST + 20:
            raise StateError("the saved state is nested too deeply")
        outer = self._extents.begin()
        try:
            value = reader(data, now)
        finally:
            self._depth -= 1
        self._extents.end(outer, value, counts=data[0] not in _OBJECTS)
        if self._strict and (not is_data(value) or (self._deep and now is not MISSING)):
            self._check(value, now)
        return value

    def _keep(self, value: _T) -> _T:
        self._objects_so_far.append(value)
        return value

    def _again(self, data: list[object], _now: object) -> object:
        if type(data[1]) is not int or data[1] < 0:
            raise StateError("the saved state is damaged: it refers to an object that was not saved before")
        value = self._objects_so_far[data[1]]
        self._extents.refer(value, self._depth)
        return value

    def _target(self, now: object, cls: type[_T], make: Callable[[], _T]) -> _T:
        """Return the present object if it has the right class and is not used for another value, else a new one."""
        if self._fresh or type(now) is not cls or id(now) in self._numbers_in_use:
            return self._keep(make())
        if id(now) not in self._numbers_with_name and self._references.global_name(now) is not None:
            # the present object is a constant of the project, and another object may have been saved
            return self._keep(make())
        self._numbers_in_use.add(id(now))
        return self._keep(now)

    def _items(self, data: Entry, now: object) -> list[object]:
        present = list(now) if is_a(now, (list, tuple, deque)) else []
        self._extents.count(len(data))
        return [self.value(item, present[i] if i < len(present) else MISSING) for i, item in enumerate(data)]

    def _list(self, data: Entry, now: object) -> list[object]:
        target: list[object] = self._target(now, list, list)
        target[:] = self._items(data[1], now)
        return target

    def _set(self, data: Entry, now: object) -> set[object]:
        target: set[object] = self._target(now, set, set)
        items = self._items(data[1], MISSING)
        target.clear()
        target.update(Extents.spread(items))
        return target

    def _deque(self, data: Entry, now: object) -> deque[object]:
        fits = is_a(now, deque) and now.maxlen == data[1]
        target: deque[object] = self._target(now if fits else MISSING, deque, lambda: deque(maxlen=data[1]))
        items = self._items(data[2], now)
        target.clear()
        target.extend(items)
        return target

    def _dict(self, data: Entry, now: object) -> dict[object, object]:
        cls = _DICTS[data[0]]
        target: dict[Any, Any] = self._target(now, cls, cls)
        items = self._pairs(data[1], dict.copy(now) if is_a(now, dict) else {})
        target.clear()
        target.update(items)
        if isinstance(target, defaultdict) and data[2] is not None:
            target.default_factory = FACTORIES[data[2]]
        return target

    def _pairs(self, data: Entry, present: dict[object, object]) -> dict[object, object]:
        items = {}
        self._extents.count(len(data))
        # the keys are read one by one, because later ones may refer to the values of earlier ones
        keys = Extents.spread(self.value(key) for key, _ in data)
        for restored_key, (_, item) in zip(keys, data, strict=True):
            items[restored_key] = self.value(item, present.get(restored_key, MISSING))
        return items

    def _namespace(self, data: Entry, now: object) -> SimpleNamespace:
        present = dict(vars(now)) if type(now) is SimpleNamespace else {}
        target: SimpleNamespace = self._target(now, SimpleNamespace, SimpleNamespace)
        self._assign(target, data[1], present)
        return target

    def _named_tuple(self, data: Entry, now: object) -> tuple[object, ...]:
        cls = self._class(data[1], now)
        items = self._items(data[2], now)
        if not issubclass(cls, tuple) or len(getattr(cls, "_fields", ())) != len(items):
            raise StateError(f"{data[1]} is not a tuple of {len(items)} items")
        return tuple.__new__(cls, items)

    # -- numpy -----------------------------------------------------------------------------

    def _view(self, data: Entry, _now: object) -> arrays.Array:
        place = len(self._objects_so_far)
        self._keep(None)
        root = self.value(data[1])
        if type(root) is not np.ndarray or root.dtype.hasobject:
            raise StateError("an array shares the memory of something that is not an array")
        self._objects_so_far[place] = view = arrays.view_of(root, arrays.dtype(data[2]), *data[3:])
        if view.nbytes > root.nbytes:
            raise StateError("an array is larger than the array whose memory it shares")
        self._extents.repeat(view.size)
        return view

    def _objects(self, data: Entry, _now: object) -> arrays.Array:
        # the shape is used only if the number of items matches
        if any(type(n) is not int or n < 0 for n in data[1]) or np.prod(data[1], dtype=object) != len(data[2]):
            raise StateError("the number of items of an array does not match its shape")
        array = self._keep(np.empty(data[1], dtype=object))
        flat = array.ravel()
        for place, item in enumerate(self._items(data[2], MISSING)):
            flat[place] = item
        return array

    def _generator(self, data: Entry, now: object) -> np.random.Generator:
        name = data[1]
        fits = is_a(now, np.random.Generator) and type(now.bit_generator).__name__ == name
        target = self._target(now if fits else MISSING, np.random.Generator, lambda: arrays.generator(name))
        state = self.value(data[2])
        arrays.check_generator(name, state)
        target.bit_generator.state = state
        return target

    def _legacy_random(self, data: list[object], now: object) -> np.random.RandomState:
        target = self._target(now, np.random.RandomState, lambda: np.random.RandomState(0))
        state = self.value(data[1])
        arrays.check_place(state[2], 624)
        target.set_state(state)
        return target

    def _python_random(self, data: list[object], now: object) -> random.Random:
        target = self._target(now, random.Random, random.Random)
        target.setstate(self.value(data[1]))
        return target

    def _pose(self, data: Entry, now: object) -> Transformation3d:
        cls = type(now) if is_a(now, Transformation3d) else Transformation3d
        target = self._target(now, cls, Transformation3d)
        _, position, rotation = data
        if len(position) != 3 or len(rotation) != 9:
            raise StateError("a pose is 3 and 9 numbers")
        target.set_pose(tuple(map(float, position)), tuple(map(float, rotation)))
        return target

    # -- objects ---------------------------------------------------------------------------

    def _enum(self, data: Entry, now: object) -> Enum:
        cls = self._class(data[1], now)
        if not issubclass(cls, Enum):
            raise StateError(f"{data[1]} is not an enumeration")
        return cls(self.value(data[3])) if data[2] is None else cls[data[2]]

    def _own(self, data: Entry, now: object) -> object:
        cls = self._attributed(data[1], now)
        target: Any = self._target(now, cls, lambda: object.__new__(cls))
        state = self.value(data[2])
        if not self._fresh:
            target.set_state(state)
        return target

    def _object(self, data: Entry, now: object) -> object:
        cls = self._attributed(data[1], now)
        base = next((base for base in ITEMS if issubclass(cls, base)), object)
        target: Any = self._target(now, cls, lambda: base.__new__(cls))
        self._assign(target, data[2], attributes_of(now) if type(now) is cls else {})
        if base is dict:
            pairs = self._pairs(data[3], {})
            dict.clear(target)
            dict.update(target, pairs)
        elif base is list:
            list.__setitem__(target, slice(None), self._items(data[3], MISSING))
        elif base is set:
            items = self._items(data[3], MISSING)
            set.clear(target)
            set.update(target, Extents.spread(items))
        return target

    def _assign(self, target: object, data: Entry, present: StateData) -> None:
        for name, _ in data:
            check_name(type(target), name)
        for name, value in self._attributes(type(target), data, present):
            object.__setattr__(target, name, value)
        if not self._fresh:
            for name in present.keys() - {name for name, _ in data}:
                object.__delattr__(target, name)
            reorder(getattr(target, "__dict__", {}), [name for name, _ in data])

    def _attributes(self, cls: type, data: Entry, present: StateData) -> Iterator[tuple[str, object]]:
        """Iterate over the names and the values of the attributes of an object of a class."""
        outer, of_morse = (self._strict, self._deep, self._types), own_attributes(cls)
        for name, item in data:
            before = present.get(name, MISSING)
            if item == AS_IS and before is MISSING:
                continue
            self._strict = not self._trusted and (of_morse is None or name in of_morse)
            self._deep = of_morse is None
            self._types = new_types(cls, name)
            try:
                value = self.value(item, before)
                self._check(value, before)
                if name == "local_data" and of_morse is None and is_a(before, dict) and is_a(value, dict):
                    for field, present_field in dict.items(before):
                        self._check(dict.get(value, field, present_field), present_field)
            except StateError as error:
                raise StateError(f"{name:.80}: {error}") from None
            finally:
                self._strict, self._deep, self._types = outer
            yield name, value

    def _check(self, value: object, present: object) -> None:
        if value is present or self._trusted:
            return
        if not (fits(value, present, self._types) if self._strict else fits_roughly(value, present)):
            raise misfit(value, present)

    def _method(self, data: Entry, now: Any) -> object:
        present = getattr(now, "__self__", MISSING) if is_routine(now) else MISSING
        owner, name = self.value(data[1], present), data[2]
        cls = type(owner)
        if name.startswith("__") or not inspect.isroutine(getattr(cls, name, None)):
            raise StateError(f"a {cls.__name__} has no method {name!r:.40}")
        same = type(present) is cls and (now.__name__ == name or name.endswith(f"{cls.__name__}{now.__name__}"))
        own = owner is self._holder or (type(present) is cls and not is_data(owner) and not is_of_morse(cls))
        if not (same or own or self._trusted):
            raise StateError(
                f"the saved state contains the method '{name:.40}' of {word_of(owner)}, which is not in use"
            )
        return getattr(owner, name)

    def _global(self, data: Entry, now: object) -> object:
        target = self._references.find_global(data[1])
        if inspect.isroutine(target):
            if not (is_routine(now) or self._trusted):
                raise StateError(f"the saved state contains the function {data[1]!r:.80} in place of {word_of(now)}")
            return target
        place = len(self._objects_so_far)
        if self._fresh:
            return target if data[2] == AS_IS else self.value(data[2])
        self._numbers_with_name.add(id(target))
        value = self.value(data[2], target)
        if (
            value is not target
            and type(target) is np.ndarray
            and value.shape == target.shape
            and value.dtype == target.dtype
        ):
            if target.flags.writeable:
                target[...] = value
            self._objects_so_far[place] = value = target
        return value

    def _class(self, path: str, now: object) -> type:
        if now is not MISSING and class_path(type(now)) == path:
            return type(now)
        cls = self._references.find_class(path)
        if cls is None:
            raise StateError(f"the saved state contains a {path!r:.80}, which the simulation does not know")
        return cls

    def _attributed(self, path: str, now: object) -> type:
        """Return a class whose objects are created without calling it."""
        cls = self._class(path, now)
        is_new = type(now) is not cls and not self._trusted
        if (
            is_apparatus(cls)
            or (is_new and issubclass(cls, AbstractObject))
            or not is_made_of_attributes(cls, next((base for base in ITEMS if issubclass(cls, base)), object))
        ):
            raise StateError(f"a {path!r:.80} cannot be created from a saved state")
        return cls
