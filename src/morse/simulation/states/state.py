"""A saved state of a simulation."""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

import msgspec

from morse.core.state import StateError
from morse.system.packed_keys import check_keys
from morse.system.regular_files import read_regular
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping

    from morse.core.values import StateData

_HEAD = b"MORSE state 1\n"
#: maximum size of a file, bytes; the state of hundreds of robots with scanners is much smaller
_LARGEST = 1 << 30
#: begins the names of the states of middlewares in files
_MIDDLEWARE = "middleware "
_encoder = msgspec.msgpack.Encoder()


class State:
    """The state of a simulation at one tick; the object is immutable.

    Attributes:
        parts: states by name, in the format of `morse.core.state.Writer`: ``clock``, ``physics``, each robot and
            component.
        unsaved: values that could not be saved, such as threads and open files of components of the user.
        makers: the functions that created spawned robots and objects; they are not written to files.
        middlewares: what middlewares do by themselves, such as the autopilots of MAVLink, by name. It is not part of
            the hash, because a run that is repeated from its inputs has no middlewares: their commands are inputs.
    """

    def __init__(
        self,
        parts: StateData,
        unsaved: tuple[str, ...] = (),
        makers: Mapping[str, Callable[[], object]] = MappingProxyType({}),
        middlewares: Mapping[str, object] = MappingProxyType({}),
    ) -> None:
        self.parts = parts
        self.unsaved = unsaved
        self.makers = makers
        self.middlewares = middlewares

    @property
    def tick(self) -> int:
        """Number of ticks done."""
        _kind, clock = cast("tuple[str, list[tuple[str, int]]]", self.parts["clock"])
        return int(dict(clock)["tick"])

    def fingerprints(self) -> dict[str, str]:
        """Return the SHA-256 of each part, in hexadecimal digits."""
        return {name: hashlib.sha256(_encoder.encode(part)).hexdigest() for name, part in self.parts.items()}

    def hash(self) -> str:
        """Return the SHA-256 of all parts, in hexadecimal digits."""
        return hashlib.sha256(_encoder.encode(list(self.parts.items()))).hexdigest()

    def __eq__(self, other: object) -> bool:
        return self is other or (isinstance(other, State) and self.hash() == other.hash())

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"<state at tick {self.tick}, {self.hash()[:12]}>"

    # -- files -----------------------------------------------------------------------------

    def to_bytes(self) -> bytes:
        """Return the content of a file with this state."""
        others = {f"{_MIDDLEWARE}{name}": state for name, state in self.middlewares.items()}
        return _HEAD + _encoder.encode({**self.parts, **others})

    @classmethod
    def from_bytes(cls, content: bytes) -> State:
        """Return the state from the content of a file.

        Raises:
            StateError: the content is not a saved state, or is damaged.
        """
        if not content.startswith(_HEAD):
            raise StateError("this is not a saved state of MORSE, or it has another version")
        try:
            check_keys(content, len(_HEAD))
            parts = msgspec.msgpack.decode(content[len(_HEAD) :], type=dict[str, object])
            names = [name for name in parts if name.startswith(_MIDDLEWARE)]
            middlewares = {name.removeprefix(_MIDDLEWARE): parts.pop(name) for name in names}
            state = cls(parts, middlewares=middlewares)
            _ = state.tick
        except LookupError:
            raise StateError("the saved state is cut off") from None
        except RecursionError:
            raise StateError("the saved state is damaged: it is nested too deeply") from None
        except (ArithmeticError, TypeError, ValueError) as error:
            raise StateError(f"the saved state is damaged: {error}") from None
        return state

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a file; an existing file of that name is replaced when the new file is complete.

        Raises:
            OSError: the file cannot be written.
        """
        write_whole(path, self.to_bytes())

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> State:
        """Read a file.

        Raises:
            OSError: the file cannot be read.
            StateError: the file is not a saved state, or is damaged.
        """
        file = Path(path)
        if file.stat().st_size > _LARGEST:
            raise StateError(f"{file} is too large for a saved state")
        try:
            return cls.from_bytes(read_regular(file, _LARGEST))
        except StateError as error:
            raise StateError(f"{file}: {error}") from None
