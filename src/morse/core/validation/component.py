"""The part of a component that the validation needs."""

from __future__ import annotations

from typing import Any, Protocol


class Checked(Protocol):
    """A component whose data and properties are validated.

    Attributes:
        local_data: the data fields, by name.
        context: the simulation, which may be ``strict``.
    """

    local_data: dict[str, Any]
    context: Any

    def name(self) -> str:
        """The fully qualified name."""
