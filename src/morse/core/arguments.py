"""Checks of the arguments of a service call against the signature of the service."""

from __future__ import annotations

import math
import types
import typing
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseRPCNbArgsError, MorseRPCTypeError
from morse.core.services import signature_of

if TYPE_CHECKING:
    import inspect
    from collections.abc import Callable

_NAMES = {float: "a number", int: "an integer", str: "a text", bool: "true or false", list: "a list", dict: "an object"}


class Arguments:
    """What a service takes, worked out once when it is registered.

    Only annotations with plain types (``float``, ``int``, ``str``, ``bool``, ``list``, ``dict``, and
    unions of them with None) are checked; anything else takes any value.
    """

    def __init__(self, callback: Callable[..., Any], service: str) -> None:
        self._service = service
        self._signature: inspect.Signature | None = None
        self._kinds: dict[str, tuple[type, ...]] = {}
        self._needs_nothing = False
        try:
            self._signature = signature_of(callback)
        except (TypeError, ValueError):
            return
        self._needs_nothing = _binds_nothing(self._signature)
        hints = _hints(callback)
        for name in self._signature.parameters:
            kinds = _plain_types(hints.get(name))
            if kinds:
                self._kinds[name] = kinds

    def check(self, arguments: list[Any]) -> None:
        """Raise if a call with these arguments cannot work.

        Raises:
            MorseRPCNbArgsError: too few or too many.
            MorseRPCTypeError: one of the wrong type.
        """
        if self._signature is None or (self._needs_nothing and not arguments):
            return
        try:
            bound = self._signature.bind(*arguments)
        except TypeError:
            raise MorseRPCNbArgsError(self._wrong_number(len(arguments))) from None
        for name, value in bound.arguments.items():
            kinds = self._kinds.get(name)
            if kinds and not _fits(value, kinds):
                expected = " or ".join(_NAMES[kind] for kind in kinds if kind in _NAMES)
                raise MorseRPCTypeError(f"{self._service}: '{name}' is {expected}, not {value!r}")

    def _wrong_number(self, given: int) -> str:
        assert self._signature is not None
        if given == 0:
            return f"some parameters are expected: {self._service}{self._signature}"
        names = ", ".join(str(p).partition(":")[0].partition(" =")[0] for p in self._signature.parameters.values())
        return f"wrong # of parameters for service. {self._service} takes ({names}), got {given}"


def _binds_nothing(signature: inspect.Signature) -> bool:
    try:
        signature.bind()
    except TypeError:
        return False
    return True


def _hints(callback: Callable[..., Any]) -> dict[str, Any]:
    function = getattr(callback, "_morse_callable", None) or getattr(callback, "__func__", callback)
    try:
        return typing.get_type_hints(function)
    except Exception:
        # annotations of user code may name anything
        return {}


def _plain_types(hint: Any) -> tuple[type, ...]:
    origin = typing.get_origin(hint)
    if origin in (typing.Union, types.UnionType):
        parts = [_plain_types(part) for part in typing.get_args(hint)]
        return tuple(kind for part in parts for kind in part) if all(parts) else ()
    kind = origin or hint
    return (kind,) if kind in _NAMES or kind is types.NoneType else ()


def _fits(value: Any, kinds: tuple[type, ...]) -> bool:
    if value is None:
        return types.NoneType in kinds
    if isinstance(value, bool):
        return bool in kinds
    if isinstance(value, float) and math.isnan(value):
        return False
    if isinstance(value, int) and (float in kinds or int in kinds or (bool in kinds and value in (0, 1))):
        return True
    return isinstance(value, kinds)
