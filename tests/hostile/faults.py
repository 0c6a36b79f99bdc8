"""Errors that the code of users may raise, from plain ones to those whose own methods fail."""

import asyncio
from typing import Any

#: the size of a message that would fill a log
HUGE = 5_000_000


class Strange(BaseException):
    """Not an `Exception`: nobody should raise it, and everybody can."""


class Mute(Exception):
    def __str__(self) -> str:
        raise ValueError("no text")


class MuteBase(BaseException):
    def __str__(self) -> str:
        raise MuteBase

    __repr__ = __str__


class Wordless(Exception):
    def __repr__(self) -> str:
        raise ValueError("no representation")


class Numeric(Exception):
    def __str__(self) -> Any:
        return 42


class Endless(Exception):
    def __str__(self) -> str:
        return "endless " * (HUGE // 8)


class Leaver(Exception):
    def __str__(self) -> str:
        raise SystemExit(7)


class Closed(Exception):
    """It hides its attributes."""

    def __getattribute__(self, name: str) -> Any:
        if name in ("args", "name", "add_note", "__notes__"):
            raise LookupError(name)
        return super().__getattribute__(name)


class Equal(Exception):
    def __eq__(self, other: object) -> bool:
        raise ArithmeticError("equal")

    __hash__ = None  # type: ignore[assignment]


class Misnamed(AttributeError):
    def __init__(self) -> None:
        super().__init__("no attribute", name="posiiton", obj=self)

    def __dir__(self) -> Any:
        raise Strange


class Silent(Exception):
    def __bool__(self) -> bool:
        raise Strange


class Sealed(Exception):
    """No attribute can be read."""

    def __getattribute__(self, name: str) -> Any:
        raise ValueError(name)


class Nameless(type):
    """The class cannot tell its name."""

    @property
    def __name__(cls) -> str:  # type: ignore[override]
        raise ValueError("no name")

    def __repr__(cls) -> str:
        raise ValueError("no representation")


class Anonymous(Exception, metaclass=Nameless):
    """An error of such a class."""


def deep() -> None:
    deep()


def _raise(error: BaseException) -> None:
    raise error


#: by name, a function that raises the error
FAULTS: dict[str, Any] = {
    "ValueError": lambda: _raise(ValueError("a plain error")),
    "ZeroDivisionError": lambda: 1 // 0,
    "AttributeError": lambda: object().positon,  # type: ignore[attr-defined]
    "AssertionError": lambda: _raise(AssertionError()),
    "OSError": lambda: _raise(OSError(5, "cable pulled")),
    "MemoryError": lambda: _raise(MemoryError()),
    "StopIteration": lambda: next(iter(())),
    "StopAsyncIteration": lambda: _raise(StopAsyncIteration()),
    "GeneratorExit": lambda: _raise(GeneratorExit()),
    "CancelledError": lambda: _raise(asyncio.CancelledError()),
    "group": lambda: _raise(BaseExceptionGroup("several", [Strange(), ValueError("one")])),
    "RecursionError": deep,
    "SyntaxError": lambda: compile("a b", "<text>", "exec"),
    "UnicodeError": lambda: "\udc80".encode(),
    "control characters": lambda: _raise(ValueError("\x1b[2J\udc80\x00")),
    "Strange": lambda: _raise(Strange("strange")),
    "Mute": lambda: _raise(Mute()),
    "MuteBase": lambda: _raise(MuteBase()),
    "Wordless": lambda: _raise(Wordless(Wordless())),
    "Numeric": lambda: _raise(Numeric()),
    "Endless": lambda: _raise(Endless()),
    "Leaver": lambda: _raise(Leaver()),
    "Closed": lambda: _raise(Closed("closed")),
    "Equal": lambda: _raise(Equal("equal")),
    "Misnamed": lambda: _raise(Misnamed()),
    "Sealed": lambda: _raise(Sealed("sealed")),
    "Anonymous": lambda: _raise(Anonymous("anonymous")),
    "Silent": lambda: _raise(Silent("silent")),
}
