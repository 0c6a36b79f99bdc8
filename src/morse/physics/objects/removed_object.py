"""The placeholder for the world of a removed object."""

from __future__ import annotations

from typing import NoReturn


class RemovedError(LookupError):
    """An object was used that is no longer in the world."""


class Gone:
    """The world of a removed object; every access raises `RemovedError`."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> NoReturn:
        name = self.__dict__["_name"]
        raise RemovedError(f"'{name}' has been removed from the world")
