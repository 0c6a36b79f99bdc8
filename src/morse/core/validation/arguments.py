"""Validation of the arguments of a service call against the signature of the service.

An annotation declares the accepted values of an argument: ``float``, ``int``, ``str``, ``bool``, ``list``, ``dict``,
unions of them with None, ``Literal["a", "b"]`` for choices, and ``Annotated[float, Range(0.0, 10.0, "m/s")]`` for a
range with its unit. In ``Annotated[list[float], Range(-1.0, 1.0, shape=(3,))]`` the range applies to each item. Any
other annotation accepts any value.
"""

from __future__ import annotations

import types
import typing
from typing import TYPE_CHECKING, NamedTuple

from morse.core.exceptions import MorseRPCNbArgsError, MorseRPCTypeError
from morse.core.reports.quoting import shown
from morse.core.services import hints_of, signature_of
from morse.core.validation.spec import Spec

if TYPE_CHECKING:
    import inspect
    from collections.abc import Callable

    from morse.core.values import Value

_KINDS: dict[object, str] = {
    float: "number", int: "integer", str: "string", bool: "boolean", list: "list", dict: "dict",
}  # fmt: skip
_NAMES = {
    "number": "a number", "integer": "an integer", "string": "a string", "boolean": "a boolean", "list": "a list",
    "dict": "an object",
}  # fmt: skip


class Range(NamedTuple):
    """The range of an argument of a service: ``Annotated[float, Range(0.0, 10.0, "m/s")]``.

    Attributes:
        low, high: bounds, both included; None for no bound.
        unit: see `morse.core.units`.
        shape: shape of a list of numbers; None for any.
        allow: special values that are accepted in spite of the range: ``inf``, ``-inf``.
    """

    low: float | None = None
    high: float | None = None
    unit: str = ""
    shape: tuple[int | None, ...] | None = None
    allow: tuple[str, ...] = ()


class Arguments:
    """The accepted arguments of a service, computed once when the service is registered.

    Args:
        callback: the function that offers the service.
        service: name of the service.
    """

    def __init__(self, callback: Callable[..., object], service: str) -> None:
        self._service = service
        self._signature: inspect.Signature | None = None
        self._checks: list[tuple[str, Callable[[object], object]]] = []
        self._least, self._most = 0, 0.0
        try:
            self._signature = signature_of(callback)
        except (TypeError, ValueError):
            return
        hints = hints_of(callback)
        rest: Callable[[object], object] | None = None
        for parameter in self._signature.parameters.values():
            check = check_of(hints.get(parameter.name))
            if parameter.kind is parameter.VAR_POSITIONAL:
                self._most = float("inf")
                rest = check
            elif parameter.kind in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD):
                self._most += 1
                self._least += parameter.default is parameter.empty
                self._checks.append((parameter.name, check))
            elif parameter.kind is parameter.KEYWORD_ONLY and parameter.default is parameter.empty:
                self._most = -1.0  # the service does not accept a list of arguments
        self._rest = rest

    def check(self, arguments: list[object]) -> None:
        """Raise an error if a call with these arguments is not valid.

        Raises:
            MorseRPCNbArgsError: there are too few or too many arguments.
            MorseRPCTypeError: an argument has the wrong type, or is outside of its range.
        """
        if self._signature is None:
            return
        count = len(arguments)
        if not self._least <= count <= self._most:
            raise MorseRPCNbArgsError(self._wrong_number(count))
        for index, value in enumerate(arguments):
            name, check = self._checks[index] if index < len(self._checks) else ("...", self._rest or _anything)
            try:
                check(value)
            except ValueError as error:
                raise MorseRPCTypeError(f"{self._service}: '{name}' is {error}, not {shown(value)}") from None

    def _wrong_number(self, count: int) -> str:
        assert self._signature is not None
        if count == 0:
            return f"some parameters are expected: {self._service}{self._signature}"
        names = ", ".join(str(p).partition(":")[0].partition(" =")[0] for p in self._signature.parameters.values())
        return f"wrong # of parameters for service. {self._service} takes ({names}), got {count}"


def argument_ranges(method: Callable[..., object]) -> dict[str, str]:
    """Return the declared ranges and choices of the arguments of a service as text, by argument name."""
    ranges = {}
    for name, hint in hints_of(method).items():
        words = []
        for spec in specs_of(hint):
            words += [", ".join(map(str, spec.choices))] if spec.choices else [spec.range_text().strip()]
        if any(words) and name != "return":
            ranges[name] = " or ".join(filter(None, words))
    return ranges


def _anything(value: object) -> object:
    return value


def check_of(hint: object) -> Callable[[object], Value]:
    """Return the check for an annotation."""
    specs = specs_of(hint)
    if not specs:
        return _anything
    if len(specs) == 1:
        return specs[0].check()
    checks = [spec.check() for spec in specs]
    expectation = " or ".join(_NAMES[spec.kind] + spec.range_text() for spec in specs)

    def check(value: object) -> Value:
        for one in checks:
            try:
                return one(value)
            except ValueError:
                continue
        raise ValueError(expectation)

    return check


def specs_of(hint: object) -> list[Spec]:
    """Return the alternatives that an annotation accepts; empty if it accepts anything."""
    origin = typing.get_origin(hint)
    if origin is typing.Annotated:
        inner, *extras = typing.get_args(hint)
        ranges = [extra for extra in extras if isinstance(extra, Range)]
        return [_with_range(spec, ranges[0]) if ranges else spec for spec in specs_of(inner)]
    if origin is typing.Literal:
        return [Spec("string", choices=typing.get_args(hint))]
    if origin in (typing.Union, types.UnionType):
        parts = [part for part in typing.get_args(hint) if part is not types.NoneType]
        accepted = [specs_of(part) for part in parts]
        if not all(accepted):
            return []
        specs = [spec for part in accepted for spec in part]
        # an integer is also a number, so the narrower type comes first
        specs.sort(key=lambda spec: spec.kind == "number")
        if types.NoneType in typing.get_args(hint):
            specs = [spec._replace(allow=spec.allow | {"none"}) for spec in specs]
        return specs
    kind = _KINDS.get(origin or hint)
    if kind is None:
        return []
    numeric = kind == "list" and typing.get_args(hint) == (float,)
    return [Spec(kind, least=1 if numeric else 0, whole=True)]


def _with_range(spec: Spec, range_: Range) -> Spec:
    return spec._replace(
        low=range_.low,
        high=range_.high,
        unit=range_.unit,
        shape=range_.shape,
        allow=spec.allow | frozenset(range_.allow),
    )
