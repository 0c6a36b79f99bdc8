"""The decorator that maps message kinds to methods of a middleware."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from morse.core.exceptions import MorseDeclarationError
from morse.core.kinds.table import GENERAL, KINDS
from morse.core.reports.hints import nearest
from morse.core.reports.quoting import shown

if TYPE_CHECKING:
    from collections.abc import Callable

_F = TypeVar("_F", bound="Callable[..., Any]")

OUT, IN = "OUT", "IN"


def maps(*kinds: str, direction: str = OUT) -> Callable[[_F], _F]:
    """Declare that a method of a `DatastreamManager` carries messages of some kinds.

    A method for published messages is called with the stream and the `morse.core.kinds.Message`, and sends the message.
    A method for commands (``direction="IN"``) is called with the stream, the `morse.core.kinds.BoundKind` and the
    received data, and returns slots by name, for `KindStream.receive`.

    A method for ``general`` is required: it carries the kinds that no other method names.

    Raises:
        MorseDeclarationError: there is no such kind or direction.
    """
    for kind in kinds:
        if kind not in KINDS:
            raise MorseDeclarationError(f"there is no message kind {shown(kind)}{nearest(kind, KINDS, limit=30)}")
    if direction not in (OUT, IN):
        raise MorseDeclarationError(f"a direction is '{OUT}' or '{IN}', not {shown(direction)}")

    def declare(method: _F) -> _F:
        method._morse_maps = (kinds, direction)  # type: ignore[attr-defined]
        return method

    return declare


def mapped_kinds(cls: type) -> dict[tuple[str, str], str]:
    """Return the names of the methods of a class by kind and direction; a class takes precedence over its bases.

    Raises:
        MorseDeclarationError: a direction has no method for ``general``.
    """
    found: dict[tuple[str, str], str] = {}
    for base in cls.__mro__:
        for name, member in vars(base).items():
            kinds, direction = getattr(member, "_morse_maps", ((), ""))
            for kind in kinds:
                found.setdefault((kind, direction), name)
    for direction in dict.fromkeys(direction for _, direction in found):
        if (GENERAL, direction) not in found:
            raise MorseDeclarationError(
                f"{cls.__module__}.{cls.__name__} maps message kinds, but not '{GENERAL}': a method with "
                f"@maps('{GENERAL}', direction='{direction}') is needed for components of users without a kind"
            )
    return found
