"""What stands for the world of an object that has been removed from it."""

from __future__ import annotations

from typing import Any, NoReturn


class RemovedError(LookupError):
    """An object was used that is no longer in the world."""


class Gone:
    """The world that a removed object has: asked for anything, it says that the object is gone."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> NoReturn:
        name: Any = self.__dict__["_name"]
        raise RemovedError(f"'{name}' has been removed from the world")
