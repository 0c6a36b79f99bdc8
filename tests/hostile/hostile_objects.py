"""Objects that raise whatever is asked of them."""

from typing import Any


class Mute:
    """No attribute can be read."""

    def __getattribute__(self, name: str) -> Any:
        raise ValueError(name)


class Disguised:
    """Its class cannot be asked for."""

    @property
    def __class__(self) -> Any:  # type: ignore[override]
        raise GeneratorExit


class Unsaved:
    """Its state cannot be taken."""

    def get_state(self) -> Any:
        raise RuntimeError("not now")

    def set_state(self, state: Any) -> None:
        raise AssertionError


class Unordered(dict[str, Any]):
    """Its items cannot be read."""

    def __iter__(self) -> Any:
        raise ValueError("order")

    items = keys = values = get = copy = __getitem__ = __len__ = __iter__  # type: ignore[assignment]


class Nameless(type):
    """The class cannot tell its name, and has no attributes."""

    def __getattribute__(cls, name: str) -> Any:
        raise ValueError(name)


class Anonymous(metaclass=Nameless):
    """An object of such a class."""
