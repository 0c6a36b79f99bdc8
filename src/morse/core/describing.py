"""What the call of a component class means in a scene script."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

#: makes what stands in the scene for a component class that a script calls, or None if no script calls; the builder
#: sets it
describe: Callable[..., Any] | None = None
