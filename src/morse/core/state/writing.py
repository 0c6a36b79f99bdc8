"""Converts objects into plain data.

Numbers, strings, bytes and None are written unchanged. Everything else is a list that begins with a word:

=========== =====================================================================
``list`` …  items (also ``tuple``, ``set``, ``frozenset``, ``deque`` with its length)
``dict`` …  pairs of key and value
``array`` … type, shape, bytes (``scalar`` for a number of numpy)
``view``    an array that shares the memory of another one
``random``  state of a generator of random numbers (numpy's or Python's)
``values``  class and numbers of a vector, matrix, quaternion, ...
``simple``  word and parts of a path, a range, a duration, ... (see `simple`)
``own``     class, and what its ``get_state()`` gave
``object``  class, its attributes, and its items if it is a list, a dictionary or a set as well
``method``  an object, and the name of the method
``global``  name of a variable of the user's project, and the object that it holds
``part``    name of a part of the simulation (see `references`)
``again``   number of a list, dictionary or object that was met before
``as is``   something that is not saved, and stays as it is: a function, a thread, ...
=========== =====================================================================
"""

from __future__ import annotations

import inspect
import logging
import random
import sys
from collections import Counter, OrderedDict, defaultdict, deque
from enum import Enum
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from morse.core.reports.faults import ENDINGS, class_name
from morse.core.state import values as arrays
from morse.core.state.values import TAKEN_APART
from morse.core.streams.local_data import Later, LocalData
from morse.helpers.transformation import FollowingPose, Transformation3d
from morse.mathutils import Color, Euler, Matrix, Quaternion, Vector

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.state.values import References
    from morse.core.values import StateData

#: a value that is not plain data: the word for its kind, and the plain data of which `Reader` makes it
Entry: TypeAlias = list[Any]
AS_IS = ["as is"]
#: maximum nesting depth of lists, dictionaries and objects; `Reader` accepts a little more
DEEPEST = 150
#: largest array: a number that is broadcast stands for any number of bytes
_MOST_BYTES = 1 << 30
_PLAIN = frozenset((type(None), bool, float, bytes))
_LARGEST = 2**63
_DICTS: dict[type, str] = {dict: "dict", OrderedDict: "ordered dict", LocalData: "local data", Counter: "counter"}
#: factories of a `defaultdict` that are saved; others stay unchanged
FACTORIES: dict[str, type] = {cls.__name__: cls for cls in (list, dict, set, int, float, str, bool, tuple, deque)}
_VALUES = (Vector, Quaternion, Euler, Color)
#: subclasses of these have their items saved
ITEMS = (list, dict, set)
#: immutable types, for which sharing between attributes does not matter
_CONSTANT = frozenset((tuple, frozenset, *TAKEN_APART))
#: packages of MORSE whose objects are saved with components; others have separate parts in a state, or no state
_WITH_STATE = ("core", "helpers", "mathutils", "sensors", "actuators", "robots", "modifiers", "services")
#: classes with that attribute are created from declarations and have no state
APPARATUS = "is_apparatus"


def class_path(cls: type) -> str:
    """``module:name`` of a class."""
    return f"{cls.__module__}:{cls.__qualname__}"


class Writer:
    """Converts the parts of one simulation into plain data; objects that several parts share stay shared.

    Attributes:
        unsaved: paths of values that cannot be saved, such as ``robot.lidar._thread (Thread)``.
    """

    def __init__(self, references: References) -> None:
        self._references = references
        self._numbers: dict[int, int] = {}
        self._objects_so_far: list[object] = []
        self.unsaved: list[str] = []
        self._path: list[str] = []
        self._depth = 0
        self._writers: dict[type, Callable[[Any], object]] = {
            int: _integer,
            str: _text,
            list: lambda v: ["list", [self.value(item) for item in v]],
            tuple: lambda v: ["tuple", [self.value(item) for item in v]],
            set: lambda v: ["set", self._sorted(v)],
            frozenset: lambda v: ["frozenset", self._sorted(v)],
            deque: lambda v: ["deque", v.maxlen, [self.value(item) for item in v]],
            bytearray: lambda v: ["bytearray", bytes(v)],
            SimpleNamespace: lambda v: ["namespace", self._pairs(vars(v).items())],
            np.ndarray: self._array,
            random.Random: lambda v: ["python random", self.value(v.getstate())],
            np.random.Generator: self._generator,
            np.random.RandomState: lambda v: ["legacy random", self.value(v.get_state())],
            Later: lambda v: self.value(v.make()),
            Matrix: lambda v: ["values", "Matrix", [list(row) for row in v]],
            Transformation3d: _pose,
            defaultdict: lambda v: ["default dict", self._items(v), _factory(v)],
            FollowingPose: _pose,
        }
        for cls in _DICTS:
            self._writers[cls] = lambda v: [_DICTS[type(v)], self._items(v)]
        for cls in _VALUES:
            self._writers[cls] = lambda v: ["values", type(v).__name__, list(v)]
        for cls in TAKEN_APART:
            self._writers[cls] = self._simple

    def release(self) -> None:
        """Release the values that were written.

        A writer refers to itself. Without this call, the values would exist until the next garbage collection, and data
        of sensors that are referenced have to be filled in every tick.
        """
        self._objects_so_far.clear()
        self._numbers.clear()

    def part(self, name: str, state: object) -> object:
        """The state of a part of the simulation, as returned by its ``get_state()``."""
        self._path = [name]
        # a state that was created for this call is not shared
        if type(state) is dict:
            self._number(state)
            return ["dict", self._pairs(state.items())]
        return self.value(state)

    def value(self, value: object) -> object:
        """Return a value as plain data."""
        cls = type(value)
        if cls in _PLAIN:
            return value
        if cls is int or cls is str:
            return self._writers[cls](value)
        number = self._numbers.get(id(value))
        if number is not None:
            return ["again", number]
        if self._depth >= DEEPEST:
            return self._cannot_be_saved(value, f"nested more than {DEEPEST} deep")
        self._depth += 1
        numbers, path = len(self._objects_so_far), len(self._path)
        try:
            name = None if cls in _CONSTANT else self._references.global_name(value)
            if name is not None:
                return ["global", name, AS_IS if inspect.isroutine(value) else self._written(value, cls)]
            return self._written(value, cls)
        except (*ENDINGS, MemoryError):
            raise
        except BaseException as error:  # an object of the user may raise whatever is asked of it
            self._forget(numbers)
            del self._path[path:]
            return self._cannot_be_saved(value, f"{class_name(cls)} raises {class_name(type(error))}")
        finally:
            self._depth -= 1

    def _written(self, value: object, cls: type) -> object:
        write = self._writers.get(cls)
        if write is None:
            return self._other(value)
        if cls not in _CONSTANT and cls is not Later:
            self._number(value)
        return write(value)

    def _number(self, value: object) -> None:
        self._numbers[id(value)] = len(self._objects_so_far)
        self._objects_so_far.append(value)  # keeps the object alive, so that its id is not reused

    def _forget(self, numbers: int) -> None:
        """Withdraw the numbers of values whose owner is not written."""
        for value in self._objects_so_far[numbers:]:
            del self._numbers[id(value)]
        del self._objects_so_far[numbers:]

    def _cannot_be_saved(self, value: object, why: str = "") -> object:
        why = why or class_name(type(value))
        self.unsaved.append(f"{'.'.join(self._path)} ({why})")
        return AS_IS

    def _other(self, value: Any) -> object:
        name = self._references.name_of(value)
        if name is not None:
            return ["part", name]
        cls = type(value)
        if isinstance(value, Enum):
            member = cls.__members__.get(value.name or "") is value
            return ["enum", class_path(cls), value.name if member else None, self.value(value.value)]
        if isinstance(value, np.generic):
            return ["scalar", arrays.type_of(value.dtype), value.tobytes()]
        if inspect.ismethod(value) or inspect.isbuiltin(value):
            return self._method(value)
        if is_apparatus(cls) or _is_code(value):
            return AS_IS
        if isinstance(value, tuple) and hasattr(value, "_fields"):
            return ["named tuple", class_path(cls), [self.value(item) for item in value]]
        own = callable(getattr(cls, "get_state", None)) and callable(getattr(cls, "set_state", None))
        base = next((base for base in ITEMS if isinstance(value, base)), object)
        if not is_made_of_attributes(cls, base):
            return self._cannot_be_saved(value)
        self._number(value)
        self._references.met_class(cls)
        if own:
            return ["own", class_path(cls), self.value(value.get_state())]
        entry: Entry = ["object", class_path(cls), self._pairs(attributes_of(value).items())]
        if base is dict:
            entry.append([[self.value(key), self.value(item)] for key, item in dict.items(value)])
        elif base is set:
            entry.append(self._sorted(value))
        elif base is list:
            entry.append([self.value(item) for item in list.__iter__(value)])
        return entry

    def _method(self, value: Any) -> object:
        owner = getattr(value, "__self__", None)
        if owner is None or inspect.ismodule(owner) or inspect.isclass(owner):
            return AS_IS
        names = [value.__name__, *(f"_{cls.__name__.lstrip('_')}{value.__name__}" for cls in type(owner).__mro__)]
        name = next((name for name in names if getattr(owner, name, None) == value), None)
        entry = AS_IS if name is None else self.value(owner)
        return AS_IS if entry == AS_IS else ["method", entry, name]

    def _simple(self, value: object) -> object:
        word, apart = TAKEN_APART[type(value)]
        return ["simple", word, *(self.value(part) for part in apart(value))]

    def _pairs(self, items: Iterable[tuple[str, object]]) -> list[list[object]]:
        pairs = []
        for name, value in items:
            self._path.append(str(name))
            pairs.append([name, self.value(value)])
            self._path.pop()
        return pairs

    def _items(self, value: dict[object, object]) -> list[list[object]]:
        return [[self.value(key), self.value(item)] for key, item in value.items()]

    def _sorted(self, values: Iterable[object]) -> list[object]:
        count = len(self._objects_so_far)
        entries = [self.value(value) for value in values]
        # sets are unordered, but objects are numbered in the order in which they are restored
        return sorted(entries, key=repr) if len(self._objects_so_far) == count else entries

    def _array(self, value: arrays.Array) -> object:
        if value.dtype.hasobject:
            if value.dtype.names is not None:
                return self._cannot_be_saved(value, "array of structures that hold objects")
            return ["objects", list(value.shape), [self.value(item) for item in value.ravel().tolist()]]
        if value.nbytes > _MOST_BYTES:
            return self._cannot_be_saved(value, f"an array of {value.nbytes:,} bytes; at most {_MOST_BYTES:,}")
        kind, root = arrays.type_of(value.dtype), arrays.root_of(value)
        # a small view of a large array without other references is saved without its root
        is_view = root is not value and (id(root) in self._numbers or root.nbytes == value.nbytes)
        if is_view and arrays.can_be_shared(root):
            return ["view", self.value(root), kind, list(value.shape), *arrays.place_in(root, value)]
        return ["array", kind, *arrays.content(value)]

    def _generator(self, value: np.random.Generator) -> object:
        return ["random", type(value.bit_generator).__name__, self.value(value.bit_generator.state)]


def _pose(value: Transformation3d) -> list[object]:
    return ["pose", *(list(part) for part in value.get_pose())]


def attributes_of(value: object) -> StateData:
    """The attributes of an object, from its dictionary and its slots."""
    attributes: StateData = {}
    for cls in type(value).__mro__:
        slots = vars(cls).get("__slots__", ())
        for name in (slots,) if isinstance(slots, str) else slots:
            if name.startswith("__") and not name.endswith("__"):
                name = f"_{cls.__name__.lstrip('_')}{name}"
            if name not in ("__dict__", "__weakref__") and hasattr(value, name):
                attributes[name] = getattr(value, name)
    attributes.update(getattr(value, "__dict__", {}))
    return attributes


def is_apparatus(cls: type) -> bool:
    """Whether objects of a class are created from declarations and have no state: all of MORSE below its components."""
    room, _, rest = cls.__module__.partition(".")
    return getattr(cls, APPARATUS, False) or (room == "morse" and rest.partition(".")[0] not in _WITH_STATE)


def is_made_of_attributes(cls: type, base: type = object) -> bool:
    """Whether the state of an object consists of its attributes, and the items of a list, dict or set.

    Threads, files and similar objects of the standard library have more state, and so do objects with ``__del__``.
    """
    if cls.__module__.partition(".")[0] in sys.stdlib_module_names or hasattr(cls, "__del__"):
        return False
    try:
        base.__new__(cls)  # type: ignore[call-overload]
    except TypeError:  # implemented in C, or abstract
        return False
    return True


def _factory(value: defaultdict[object, object]) -> str | None:
    name = getattr(value.default_factory, "__name__", None)
    return name if name is not None and FACTORIES.get(name) is value.default_factory else None


def _is_code(value: object) -> bool:
    return inspect.isroutine(value) or inspect.isclass(value) or isinstance(value, (type(inspect), logging.Logger))


def _integer(value: int) -> object:
    return value if -_LARGEST <= value < _LARGEST else ["integer", hex(value)]


def _text(value: str) -> object:
    try:
        value.encode()
    except UnicodeEncodeError:
        return ["text", value.encode("utf-8", "surrogatepass")]
    return value
