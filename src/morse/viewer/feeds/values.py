"""Sends the data of components to the pages that show them."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from morse.core.rows.lazy_data import present_data
from morse.viewer.view_messages import Values

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import JsonObject, Value
    from morse.viewer.server import ViewServer

#: maximum number of displayed values of an array: a scan, but not an image
_MOST = 4096


class ValuesFeed:
    """Sends the data of components."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server

    def update(self) -> None:
        """Send the data that pages show."""
        now = self._context.clock.time
        for name in sorted(self._server.wishes.values):
            component = self._context.component(name)
            if component is not None:
                data = self._context.guard.run(partial(_data_of, component), _not_shown)
                self._server.send(Values(name, now, data or {}, "The data cannot be read." if data is None else ""))


def _data_of(component: Object) -> JsonObject:
    return {str(field): shown(value) for field, value in present_data(component).items()}


def _not_shown(_error: BaseException) -> None:
    """A component that fails is named when it acts."""


def shown(value: Value) -> Value:
    """Return the value, or a short description if the value is too large to be shown."""
    size = getattr(value, "size", None)
    if isinstance(size, int) and size > _MOST:
        return f"{tuple(value.shape)} of {value.dtype}"
    if isinstance(value, (bytes, bytearray, memoryview)):
        return f"{len(value)} bytes"
    if isinstance(value, (str, list, tuple, dict)) and len(value) > _MOST:
        return f"{len(value)} {'characters' if isinstance(value, str) else 'values'}"
    return value
