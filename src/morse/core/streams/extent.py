"""The size of data: a few bytes of Python may stand for more than a tick, a client or the memory can bear.

``range(10**12)``, a number that is broadcast to a large array, and a list that contains another list many times cost
nothing until somebody writes them down.
"""

from __future__ import annotations

from collections import deque
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from morse.core.reports.faults import class_name, is_a
from morse.core.reports.quoting import escaped

if TYPE_CHECKING:
    from morse.core.interfaces import Component
    from morse.core.values import Value

#: largest number of items of a field, those of the lists in its lists included
MOST_ITEMS = 500_000
#: largest number of fields of a component
MOST_FIELDS = 10_000
#: largest text, characters; and largest array, bytes: a picture of 7680 x 4320 pixels has half as many
MOST_CHARACTERS, MOST_BYTES = 1 << 24, 1 << 28
#: largest number of lists in lists
DEEPEST = 150
#: numbers of an array that are written one by one, as text
MOST_NUMBERS = 1 << 22
_SMALL = frozenset((type(None), bool, int, float, complex))
_PLAIN = frozenset((list, tuple))
_ITERABLE = (list, tuple, set, frozenset, deque, range)
#: levels of nesting by which `_estimate` looks
_LEVELS = 20


class TooLarge(ValueError):
    """A value is larger than data may be."""


def check_fields(component: Component) -> None:
    """Remove fields that are too large from the data of a component, so that nothing reads them, and name them.

    The items of lists in lists are counted when a field is twice as large as it was when they were last counted.
    """
    attributes = vars(component)
    data = attributes.get("local_data")
    if not is_a(data, dict):
        return
    refusals: list[tuple[object, str]] = []
    counts: dict[object, int] | None = attributes.get("_counted")
    for number, (name, value) in enumerate(dict.items(data)):
        if number >= MOST_FIELDS:
            refusals = [(one, "") for one in list(data)[MOST_FIELDS:]]
            _refuse(component, f"it has {dict.__len__(data):,} data fields; at most {MOST_FIELDS:,} are published")
            break
        if type(value) in _SMALL:
            continue
        size = _estimate(value)
        if counts is None:
            counts = attributes["_counted"] = {}
        if size > counts.get(name, -1):
            text = excess(value)
            if text:
                refusals.append((name, text))
            else:
                counts[name] = 2 * size
    for name, text in refusals:
        dict.__delitem__(data, name)
        if text:
            _refuse(component, f"the data field '{escaped(str(name)[:80])}' is {text}: it is not published")


def _refuse(component: Component, text: str) -> None:
    text = f"{component.name()} ({class_name(type(component))}): {text}"
    component.context.complaints.warn(text, text)


def check_result(owner: object, result: object) -> None:
    """Check the size of what a service of a user returns.

    Args:
        owner: the object that has the service.

    Raises:
        TooLarge: it is too large.
    """
    if type(result) in _SMALL or type(owner).__module__.startswith("morse."):
        return
    text = excess(result)
    if text:
        raise TooLarge(f"the result is {text}")


def excess(value: Value) -> str:
    """Return what is too large about a value, and the limit; empty for a value that may be sent."""
    level, items, depth = [value], 0, 0
    while level:
        kind = class_name(type(level[0]))
        if not _PLAIN.issuperset(map(type, level)):
            for one in level:
                text = _excess_alone(one)
                if text:
                    return text
            level = [inner for one in level if (inner := _items_of(one)) is not None]
        items += sum(map(len, level))
        if items > MOST_ITEMS:
            text = f"a {kind} of {items:,} items" if depth == 0 else "nested lists of too many items"
            return f"{text}; at most {MOST_ITEMS:,}"
        depth += 1
        if depth > DEEPEST:
            return f"nested too deeply, or contains itself; at most {DEEPEST} lists in lists"
        inner = list(chain.from_iterable(level))
        level = [] if _SMALL.issuperset(map(type, inner)) else [one for one in inner if type(one) not in _SMALL]
    return ""


def listed(value: Value) -> Value:
    """Return the numbers of an array as lists, for those who write them one by one.

    Args:
        value: an object with `tolist`.

    Raises:
        TooLarge: there are too many.
    """
    size = getattr(value, "size", 0)
    if is_a(size, int) and size > MOST_NUMBERS:
        raise TooLarge(f"an array of {size:,} numbers cannot be written as text; at most {MOST_NUMBERS:,}")
    return value.tolist()


def _estimate(value: Value) -> int:
    """Multiply the lengths along the first items of lists in lists: the number of items of a table."""
    size = 1
    for _ in range(_LEVELS):
        kind = type(value)
        if kind is not list and kind is not tuple:
            break
        size *= len(value) or 1
        if not value:
            break
        value = value[0]
    if type(value) is str or type(value) is dict:
        return size * (len(value) or 1)
    return size * value.nbytes if type(value) is np.ndarray else size


def _excess_alone(value: object) -> str:
    if is_a(value, str):
        return _over(str.__len__(value), MOST_CHARACTERS, "a text of {:,} characters")
    if is_a(value, (bytes, bytearray)):
        return _over(len(value), MOST_BYTES, "{:,} bytes")
    if is_a(value, memoryview):
        return _over(value.nbytes, MOST_BYTES, "{:,} bytes")
    if is_a(value, np.ndarray):
        return _over(value.nbytes, MOST_BYTES, "an array of {:,} bytes")
    if is_a(value, range):
        return _over(_length(value), MOST_ITEMS, "a range of {:,} items")
    return f"a {class_name(type(value))}, which can be read only once" if _is_iterator(value) else ""


def _is_iterator(value: object) -> bool:
    return any("__next__" in vars(cls) for cls in type.mro(type(value)))


def _over(size: int, most: int, text: str) -> str:
    return f"{text.format(size)}; at most {most:,}" if size > most else ""


def _length(numbers: range) -> int:
    # `len` refuses more than 2**63
    return max(0, -((numbers.start - numbers.stop) // numbers.step))


def _items_of(value: object) -> object:
    """The items of a container, those of a dictionary without its keys; None for another object."""
    if is_a(value, dict):
        return list(dict.values(value))
    if is_a(value, range):
        return ()
    for cls in _ITERABLE:
        if is_a(value, cls):
            return value if type(value) is cls else list(cls.__iter__(value))  # type: ignore[arg-type] # cls is a class of the value
    if is_a(value, np.ndarray) and value.dtype.hasobject:
        return value.ravel().tolist()
    return None
