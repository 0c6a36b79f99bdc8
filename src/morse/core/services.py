"""Services: methods of components that clients call.

A service is either done when the method returns (`service`) or goes on over several ticks and
ends when the component calls ``self.completed(status, result)`` (`async_service`), one at a time
for each component; or it may be called by many clients at the same time (`concurrent_service`).
"""

from __future__ import annotations

import functools
import inspect
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from morse.core import status
from morse.core.exceptions import MorseServiceAlreadyRunningError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.abstractobject import AbstractObject

_F = TypeVar("_F", bound="Callable[..., Any]")


class ServiceDeclaration(NamedTuple):
    """A service of a class.

    Attributes:
        name: as clients call it.
        attribute: name of the method.
        asynchronous: ends by ``completed``.
        component: name of the pseudo component that offers it, or None for its own component.
    """

    name: str
    attribute: str
    asynchronous: bool
    component: str | None


def service(
    fn: Callable[..., Any] | None = None,
    component: str | None = None,
    name: str | None = None,
    asynchronous: bool = False,
) -> Any:
    """Declare a method as a service. Use with or without arguments.

    Args:
        component: offer it under this name instead of that of its component.
        name: offer it under another name than that of the method.
    """
    if fn is None:
        return functools.partial(service, component=component, name=name, asynchronous=asynchronous)
    method = _asynchronous(fn) if asynchronous else fn
    method._morse_service = ServiceDeclaration(name or fn.__name__, fn.__name__, asynchronous, component)  # type: ignore[attr-defined]
    return method


def async_service(fn: Callable[..., Any] | None = None, component: str | None = None, name: str | None = None) -> Any:
    """Declare a method as a service that ends when the component calls ``completed``."""
    return service(fn, component, name, asynchronous=True)


def concurrent_service(fn: _F) -> _F:
    """Declare a method as a service that goes on over several ticks, any number of calls at the same time.

    The method takes, before the arguments of the client, a function: ``ended((status, result))`` ends this call.
    """
    fn._morse_service = ServiceDeclaration(fn.__name__, fn.__name__, True, None)  # type: ignore[attr-defined]
    fn._morse_concurrent = True  # type: ignore[attr-defined]
    return fn


def interruptible(fn: _F) -> _F:
    """A new call preempts the running one: its caller gets ``PREEMPTED``."""
    fn._morse_interruptible = True  # type: ignore[attr-defined]
    return fn


def noninterruptible(fn: _F) -> _F:
    """A new call is refused while one is running."""
    fn._morse_interruptible = False  # type: ignore[attr-defined]
    return fn


def _asynchronous(fn: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(fn)
    def call(self: AbstractObject, callback: Callable[[Any], None] | None, *args: Any, **kwargs: Any) -> Any:
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
    seen: set[str] = set()
    for base in cls.__mro__:
        for attribute, member in vars(base).items():
            if attribute in seen:
                continue
            seen.add(attribute)
            declaration = getattr(member, "_morse_service", None)
            if declaration is not None:
                yield declaration._replace(attribute=attribute)


def signature_of(method: Callable[..., Any]) -> inspect.Signature:
    """The signature that clients see: without ``self`` and without the completion callback."""
    plain = getattr(method, "_morse_callable", None) or getattr(
        getattr(method, "__func__", None), "_morse_callable", None
    )
    if plain is None:
        signature = inspect.signature(method)
        if not getattr(method, "_morse_concurrent", False):
            return signature
        return signature.replace(parameters=list(signature.parameters.values())[1:])
    parameters = list(inspect.signature(plain).parameters.values())[1:]
    return inspect.Signature(parameters)


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
