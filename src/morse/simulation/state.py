"""A saved state of a simulation."""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import msgspec

from morse.core.state import StateError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_HEAD = b"MORSE state 1\n"
#: bytes of a file; a state of hundreds of robots with scanners has a few
_LARGEST = 1 << 30
_encoder = msgspec.msgpack.Encoder()


class State:
    """All that determines the future of a simulation, at one tick; it does not change.

    Attributes:
        parts: by name, as `morse.core.state.Writer` writes them: ``clock``, ``physics``, each robot and component.
        unsaved: what could not be saved, such as threads and open files of the user's components.
        makers: the functions that made robots and things that came since the launch; files do not hold them.
    """

    def __init__(
        self,
        parts: dict[str, Any],
        unsaved: tuple[str, ...] = (),
        makers: Mapping[str, Callable[[], Any]] = MappingProxyType({}),
    ) -> None:
        self.parts = parts
        self.unsaved = unsaved
        self.makers = makers

    @property
    def tick(self) -> int:
        """Number of ticks that were done."""
        return int(dict(self.parts["clock"][1])["tick"])

    def fingerprints(self) -> dict[str, str]:
        """SHA-256 of each part, in hexadecimal digits."""
        return {name: hashlib.sha256(_encoder.encode(part)).hexdigest() for name, part in self.parts.items()}

    def hash(self) -> str:
        """SHA-256 of all, in hexadecimal digits."""
        return hashlib.sha256(_encoder.encode(list(self.parts.items()))).hexdigest()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, State) and self.hash() == other.hash()

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"<state at tick {self.tick}, {self.hash()[:12]}>"

    # -- files -----------------------------------------------------------------------------

    def to_bytes(self) -> bytes:
        """The state as a file holds it."""
        return _HEAD + _encoder.encode(self.parts)

    @classmethod
    def from_bytes(cls, content: bytes) -> State:
        """The state in a file.

        Raises:
            StateError: it is none, or damaged.
        """
        if not content.startswith(_HEAD):
            raise StateError("this is not a saved state of MORSE, or one of another version")
        try:
            parts = msgspec.msgpack.decode(content[len(_HEAD) :], type=dict[str, Any])
            state = cls(parts)
            _ = state.tick
        except (ArithmeticError, LookupError, RecursionError, TypeError, ValueError) as error:
            raise StateError(f"the saved state is damaged: {error}") from None
        return state

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a file; an old one of that name is there until the new one is complete.

        Raises:
            OSError: it cannot be written.
        """
        target = Path(path)
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(self.to_bytes())
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> State:
        """Read a file.

        Raises:
            OSError: it cannot be read.
            StateError: it is not a saved state, or damaged.
        """
        file = Path(path)
        if file.stat().st_size > _LARGEST:
            raise StateError(f"{file} is larger than any saved state")
        return cls.from_bytes(file.read_bytes())
