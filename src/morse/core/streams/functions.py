"""What a component calls in its action to publish its data or to read commands: the functions of its streams.

``input_functions`` and ``output_functions`` of a component are lists of functions, as in MORSE 1.4: middlewares and
programs append to them. These are the only calls in a tick whose target is not told by a type. A function is one of

===============================================  ===================================================================
`KindStream.default`                             a stream of a middleware (`morse.core.streams.kind_stream`)
`CommandTimeout.default`, `Paced.default`        a stream with the option ``timeout`` or ``period``
                                                 (`morse.core.datastream`), which call the stream
`PendingCommands.default`                        commands of this process and of the live view
                                                 (`morse.core.actuator`)
``ComponentHandle``, ``Replay``                  a program that reads a sensor; a recording that is repeated
                                                 (`morse.simulation`)
anything else                                    a function of a user
===============================================  ===================================================================

The methods of MORSE belong to an `Endpoint`, which tells whether it has something to do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.reports.faults import ENDINGS, attribute

if TYPE_CHECKING:
    from collections.abc import Callable, MutableSequence, Sequence, Sized

    from morse.core.interfaces import Component

    Function = Callable[..., object]

_NOTHING = object()


class Endpoint:
    """A stream, or something like one, whose method ``default`` a component calls in its action."""

    @property
    def waiting(self) -> Sized | None:
        """Return a collection that is empty while `default` has nothing to do; None if this is not known.

        The collection is the same object at each call. `default` need not be called while the collection is empty.
        """
        return None


def waiting(function: Function) -> Sized | None:
    """Return `Endpoint.waiting` of a function of a component; None for a function of a user."""
    owner = getattr(function, "__self__", None)
    return owner.waiting if isinstance(owner, Endpoint) else None


def stream_of(function: object) -> object:
    """The stream whose method a component calls; the function itself if it does not belong to a stream."""
    owner = attribute(function, "__self__", function)
    if attribute(owner, "component_instance", _NOTHING) is _NOTHING:
        return function
    return attribute(owner, "stream", owner)


def manager_of(function: object) -> object:
    """The middleware of the stream whose method a component calls; None without one."""
    return attribute(stream_of(function), "manager")


def publish(component: Component, functions: MutableSequence[Function]) -> None:
    """Call the output functions of a component; a stream that raises is closed."""
    failures = None
    for function in functions:
        try:
            function(component)
        except ENDINGS:
            raise
        except BaseException as error:
            failures = [*(failures or ()), (function, error)]
    if failures is not None:
        _close(component, functions, failures)


def read(component: Component, functions: MutableSequence[Function]) -> bool:
    """Call the input functions of a component, and return whether data arrived; a stream that raises is closed."""
    has_input, failures = False, None
    for function in functions:
        try:
            has_input = bool(function(component)) or has_input
        except ENDINGS:
            raise
        except BaseException as error:
            failures = [*(failures or ()), (function, error)]
    if failures is not None:
        _close(component, functions, failures)
    return has_input


def _close(
    component: Component, functions: MutableSequence[Function], failures: Sequence[tuple[Function, BaseException]]
) -> None:
    for function, failure in failures:
        component.context.guard.close(component, functions, function, failure)
