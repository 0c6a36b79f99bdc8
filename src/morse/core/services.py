"""Services: methods of components that clients call.

There are three kinds of service. A `service` ends when its method returns. An `async_service` continues over several
ticks and ends when the component calls ``self.completed(status, result)``; a component runs one of them at a time. A
`concurrent_service` also continues over several ticks, and may be called by many clients at the same time.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
import operator
import typing
from collections import ChainMap
from types import SimpleNamespace, UnionType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeAlias, TypeVar, overload

from morse.core import status, values
from morse.core.exceptions import MorseServiceAlreadyRunningError
from morse.core.values import Value

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


#: what a service has returned: ``SUCCESS``, ``FAILED`` or ``PREEMPTED``, and its result or an error
Outcome: TypeAlias = tuple[str, Value]

_F = TypeVar("_F", bound="Callable[..., object]")


class ServiceDeclaration(NamedTuple):
    """A service of a class.

    Attributes:
        name: name for clients.
        attribute: name of the method.
        asynchronous: whether the service ends with ``completed``.
        component: name of the pseudo component that offers the service, or None for its own component.
        changes: whether a call may change the simulation; other calls are not recorded in the journal.
    """

    name: str
    attribute: str
    asynchronous: bool
    component: str | None
    changes: bool = True


@overload
def service(fn: _F) -> _F: ...
@overload
def service(
    *, component: str | None = None, name: str | None = None, asynchronous: bool = False, changes: bool = True
) -> Callable[[_F], _F]: ...
def service(
    fn: Callable[..., object] | None = None,
    component: str | None = None,
    name: str | None = None,
    asynchronous: bool = False,
    changes: bool = True,
) -> object:
    """Declare a method as a service. The decorator is used with or without arguments.

    Args:
        component: name under which the service is offered instead of the name of its component.
        name: name of the service, if it differs from the name of the method.
        changes: whether a call may change the simulation; other calls are not recorded in the journal of inputs.
    """
    if fn is None:
        return functools.partial(service, component=component, name=name, asynchronous=asynchronous, changes=changes)
    method = _asynchronous(fn) if asynchronous else fn
    method._morse_service = ServiceDeclaration(name or fn.__name__, fn.__name__, asynchronous, component, changes)  # type: ignore[attr-defined]
    return method


def async_service(
    fn: Callable[..., object] | None = None, component: str | None = None, name: str | None = None
) -> Any:
    """Declare a method as a service that ends when the component calls ``completed``."""
    return service(fn, component=component, name=name, asynchronous=True)  # type: ignore[call-overload]


@overload
def concurrent_service(fn: _F) -> _F: ...
@overload
def concurrent_service(*, changes: bool = True) -> Callable[[_F], _F]: ...
def concurrent_service(fn: Callable[..., object] | None = None, *, changes: bool = True) -> object:
    """Declare a method as a service that continues over several ticks, with any number of simultaneous calls.

    The first argument of the method is a callback: ``ended((status, result))`` ends this call. The method may return a
    function that cancels the call; the call is then cancelled only by this function. A call ends when its client
    disconnects. For ``changes`` see `service`.
    """
    if fn is None:
        return functools.partial(concurrent_service, changes=changes)
    fn._morse_service = ServiceDeclaration(fn.__name__, fn.__name__, True, None, changes)  # type: ignore[attr-defined]
    fn._morse_concurrent = True  # type: ignore[attr-defined]
    return fn


def interruptible(fn: _F) -> _F:
    """Declare that a new call preempts the running call, whose client receives ``PREEMPTED``."""
    fn._morse_interruptible = True  # type: ignore[attr-defined]
    return fn


def noninterruptible(fn: _F) -> _F:
    """Declare that a new call is refused while another call is running."""
    fn._morse_interruptible = False  # type: ignore[attr-defined]
    return fn


class _Caller(Protocol):
    """What the call of an asynchronous service uses of `morse.core.abstractobject.AbstractObject`."""

    on_completion: Callable[[Outcome], object] | None
    running_service: str | None

    def name(self) -> str: ...

    def interrupt(self) -> None: ...


def _asynchronous(fn: Callable[..., object]) -> Callable[..., object]:
    @functools.wraps(fn)
    def call(self: _Caller, callback: Callable[[Outcome], object] | None, *args: object, **kwargs: object) -> object:
        if self.on_completion is not None:
            if not getattr(call, "_morse_interruptible", False):
                raise MorseServiceAlreadyRunningError(
                    f"{self.name()} is already running '{self.running_service}', which cannot be interrupted: "
                    f"call '{fn.__name__}' again when it is done, or cancel it first"
                )
            self.interrupt()
        self.on_completion = callback
        self.running_service = fn.__name__
        try:
            return fn(self, *args, **kwargs)
        except BaseException:
            self.on_completion = None
            self.running_service = None
            raise

    call._morse_callable = fn  # type: ignore[attr-defined]
    return call


def declared_services(cls: type) -> Iterator[ServiceDeclaration]:
    """The services of a class and its bases; a class overrides those of its bases."""
    names: set[str] = set()
    for base in cls.__mro__:
        for attribute, member in vars(base).items():
            if attribute in names:
                continue
            names.add(attribute)
            declaration = getattr(member, "_morse_service", None)
            if declaration is not None:
                yield declaration._replace(attribute=attribute)


def signature_of(method: Callable[..., object]) -> inspect.Signature:
    """Return the signature for clients: without ``self`` and the completion callback."""
    plain = getattr(method, "_morse_callable", None) or getattr(
        getattr(method, "__func__", None), "_morse_callable", None
    )
    parameters = list(inspect.signature(plain or method).parameters.values())
    asynchronous = plain is not None or getattr(method, "_morse_concurrent", False)
    if asynchronous:
        del parameters[0]
    hints = {name: hint for name, hint in hints_of(method).items() if _without_range(hint) is not hint}
    visible = [p.replace(annotation=_without_range(hints[p.name])) if p.name in hints else p for p in parameters]
    returns = inspect.Signature.empty if asynchronous else inspect.signature(method).return_annotation
    return inspect.Signature(visible, return_annotation=returns)


def hints_of(method: Callable[..., object]) -> dict[str, object]:
    """Return the annotations of a service that can be evaluated, including the metadata of `typing.Annotated`."""
    function = getattr(method, "_morse_callable", None) or getattr(method, "__func__", method)
    names = getattr(function, "__globals__", {})
    # names of types that are usually imported only for type checkers
    known = ChainMap(names, vars(values))
    hints = {}
    for name, annotation in getattr(function, "__annotations__", {}).items():
        alone = SimpleNamespace(__annotations__={name: annotation})
        # evaluated one by one, because an annotation may use names that are imported only for type checkers
        with contextlib.suppress(Exception):
            hints.update(typing.get_type_hints(alone, names, known, include_extras=True))
    return hints


def _without_range(hint: object) -> object:
    if typing.get_origin(hint) is typing.Annotated:
        return typing.get_args(hint)[0]
    if typing.get_origin(hint) in (typing.Union, UnionType):
        parts = [_without_range(part) for part in typing.get_args(hint)]
        if any(new is not old for new, old in zip(parts, typing.get_args(hint), strict=True)):
            return functools.reduce(operator.or_, parts)
    return hint


__all__ = [
    "ServiceDeclaration",
    "async_service",
    "concurrent_service",
    "declared_services",
    "interruptible",
    "noninterruptible",
    "service",
    "signature_of",
    "status",
]
