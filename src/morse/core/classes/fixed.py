"""Attributes that the simulation still needs after a component has failed.

Their descriptors have no ``__get__``: reading such an attribute takes no longer than reading any other.
"""

from __future__ import annotations

from morse.core.reports.faults import class_name


class OfOneClass:
    """An attribute that keeps the class of its first value, apart from None."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __set__(self, part: object, value: object) -> None:
        check_class(part, self._name, value)
        vars(part)[self._name] = value


class ReadOnly:
    """An attribute that only its own object changes, by its dictionary."""

    def __init__(self, name: str, mend: str) -> None:
        self._name, self._mend = name, mend

    def __set__(self, part: object, value: object) -> None:
        raise AttributeError(f"'{self._name}' cannot be set: {self._mend}")


def check_class(part: object, name: str, value: object) -> None:
    """Raise `TypeError` for a value of another class than that of the present value of an attribute."""
    before = vars(part).get(name)
    if before is not None and type(value) is not type(before):
        kind, expectation = class_name(type(value)), class_name(type(before))
        raise TypeError(f"'{name}' is of the class {expectation}, and cannot become {kind}: the simulation needs it")
