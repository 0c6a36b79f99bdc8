"""The properties of components as parameters of Foxglove: ``robot.motion.ControlType``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.declarations.fields import PropertyTable
from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest, short
from morse.middleware.web.requests import encoded

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.context import Context
    from morse.core.values import JsonObject

#: maximum number of parameters that a request sets: a tick waits for it; and of refusals that it explains
MOST, _MOST_REFUSALS = 64, 10
#: what a client has asked for
GET, SET, WATCH = "getParameters", "setParameters", "subscribeParameterUpdates"


class Parameters:
    """Reads and changes properties; in the simulation thread.

    Args:
        context: of the simulation.
        components: returns the names of the components whose properties may be set.
        change: calls the service ``set_property`` of a component with name and value; the journal contains it.
    """

    def __init__(
        self, context: Context, components: Callable[[], Iterable[str]], change: Callable[[str, list[object]], object]
    ) -> None:
        self._properties, self._change = PropertyTable(context.component, components), change

    def read(self, names: Iterable[str]) -> list[JsonObject]:
        """Name, value and type of parameters, of all if there are no names; unknown ones are left out."""
        return [one for name in self._present(names) if (one := self._read(name)) is not None]

    def _present(self, names: Iterable[str]) -> Iterable[str]:
        """The names of parameters that exist, each once: a client may send any number."""
        present = dict.fromkeys(self._properties.names())
        return [name for name in dict.fromkeys(names) if name in present] if names else present

    def _read(self, name: str) -> JsonObject | None:
        one = self._properties.find(name)
        value = None if one is None else getattr(one.component, one.attribute)
        if value is None:
            return None
        try:
            encoded(value)
        except (TypeError, ValueError, OverflowError, RecursionError):
            return None  # an object of the component is not a parameter
        parameter = {"name": name, "value": list(value) if isinstance(value, tuple) else value}
        # without the type, Foxglove shows 1.0 as an integer and sends it back as one
        if isinstance(value, float):
            parameter["type"] = "float64"
        elif isinstance(value, (list, tuple)) and value and all(type(item) in (int, float) for item in value):
            parameter["type"] = "float64_array"
        return parameter

    def write(self, entries: Iterable[Any]) -> tuple[list[str], list[str]]:
        """Change parameters.

        Args:
            entries: objects with name and value.

        Returns:
            The names of the parameters that exist, and why changes are refused.
        """
        names, refusals = list[str](), list[str]()
        for number, one in enumerate(entries):
            if number == MOST or len(refusals) == _MOST_REFUSALS:
                refusals.append(f"the rest of the parameters of this request: it sets more than {MOST}, or many fail")
                break
            name = one.get("name") if isinstance(one, dict) else None
            if not isinstance(name, str) or self._read(name) is None:
                refusals.append(
                    f"there is no parameter {short(name)}{nearest(str(name)[:256], self._properties.names())}"
                )
                continue
            names.append(name)
            owner, _, attribute = name.rpartition(".")
            try:
                if "value" not in one:
                    raise ValueError("a property of a component cannot be removed")
                self._change(owner, [attribute, one["value"]])
            except (MorseError, ValueError) as error:
                refusals.append(f"{name}: {error}")
        return names, refusals
