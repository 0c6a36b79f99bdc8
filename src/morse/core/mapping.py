"""The decorator that maps message kinds to methods of a middleware."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from morse.core.exceptions import MorseDeclarationError
from morse.core.kinds.table import GENERAL, KINDS, kind_named
from morse.core.reports.quoting import nearest, shown

if TYPE_CHECKING:
    from collections.abc import Callable

_F = TypeVar("_F", bound="Callable[..., object]")

OUT, IN = "OUT", "IN"
#: attribute of a method that gives messages their form
_MARK = "_morse_maps"


def maps(*kinds: str, direction: str = OUT, mark: str = _MARK) -> Callable[[_F], _F]:
    """Declare that a method of a `DatastreamManager` gives messages of some kinds their form.

    ``method(stream, message)``, for published messages: it returns the payload of the
    `morse.core.kinds.Message`, which `DatastreamManager.send` sends. If it returns None, nothing is sent; a method may
    also send the message itself.

    ``method(stream, kind, data)``, for commands (``direction="IN"``): it reads what `KindStream.receive` was called
    with, and returns the values of the slots of the `morse.core.kinds.BoundKind` by name; the method for ``general``
    returns the values of fields by name. None if the data are no command for the component.

    A method for ``general`` is required: it carries the kinds that no other method names, by the fields of the
    component (``message.fields``).

    Raises:
        MorseDeclarationError: there is no such kind or direction.
    """
    for kind in kinds:
        if kind_named(kind) is None:
            raise MorseDeclarationError(f"there is no message kind {shown(kind)}{nearest(kind, KINDS, limit=30)}")
    if direction not in (OUT, IN):
        raise MorseDeclarationError(f"a direction is '{OUT}' or '{IN}', not {shown(direction)}")

    def declare(method: _F) -> _F:
        setattr(method, mark, (kinds, direction))
        return method

    return declare


def mapped_kinds(cls: type, mark: str = _MARK, *, needs_general: bool = True) -> dict[tuple[str, str], str]:
    """Return the names of the methods of a class by kind and direction; a class takes precedence over its bases.

    Raises:
        MorseDeclarationError: a direction has no method for ``general``.
    """
    paths: dict[tuple[str, str], str] = {}
    for base in cls.__mro__:
        for name, member in vars(base).items():
            kinds, direction = getattr(member, mark, ((), ""))
            for kind in kinds:
                paths.setdefault((kind, direction), name)
    for direction in dict.fromkeys(direction for _, direction in paths):
        if needs_general and (GENERAL, direction) not in paths:
            raise MorseDeclarationError(
                f"{cls.__module__}.{cls.__name__} maps message kinds, but not '{GENERAL}': a method with "
                f"@maps('{GENERAL}', direction='{direction}') is needed for components of users without a kind"
            )
    return paths
