"""The hook that turns the call of a component class in a scene script into a component of the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

#: function that creates the builder object of a component class that a scene script calls; it returns None if no scene
#: script runs. The builder sets this hook.
describe: Callable[..., Any] | None = None
