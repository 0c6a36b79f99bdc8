"""Names that clients, pages and files give in a running simulation, and names of files that are made of them.

Names become topics, keys of registries, words of requests, attributes of clients, and names of files. All of them allow
letters of ASCII, digits and ``_``; most of them allow little else.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseBuilderError, MorseRPCInvokationError
from morse.core.reports.quoting import quoted, short

if TYPE_CHECKING:
    from collections.abc import Iterable

LONGEST_NAME = 100
"""Maximum number of characters of the name of an object."""

DEVICES = frozenset({"aux", "con", "nul", "prn", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))})
"""Names of devices on Windows, in lower case: no files have these names."""

RESERVED = frozenset(
    {
        # pseudo components, which offer services
        *("simulation", "time", "communication"),
        # what middlewares publish besides the data of components: topics, ports, nodes, frames
        *("morse", "status", "services", "clock", "tf", "tf_static", "rosout", "rosapi", "robot_description"),
        *("parameter_events", "diagnostics", "map", "world", "odom", "base_link", "earth"),
        # an overlay of the live view
        "contacts",
        # attributes of the clients of MORSE 1.4, which would be hidden
        *("activate", "add_robot", "call", "cancel", "close", "deactivate", "executor", "get_publisher_streams"),
        *("get_stream_port", "host", "initialize_api", "is_up", "port", "quit", "reset", "robots", "rpc", "rpc_t"),
        *("simulation_service", "sleep", "spawn", "streams", "time_service"),
        # values and the object itself in languages of clients
        *("true", "false", "none", "null", "self"),
        *DEVICES,
    }
)
"""Names that no object can have, in lower case."""

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
#: of a component that the text of a robot declares
_PARTS = re.compile(r"\w+(?:\.\w+)*")
#: of what clients store: states and recordings
_FILE = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}")
#: maximum length of the name of a file without its suffix, bytes
_LONGEST_FILE = 200


def check_name(name: object, present: Iterable[str] = ()) -> None:
    """Check the name of an object that is spawned in a running simulation.

    Args:
        present: names of components and of other parts that clients can address; two names that differ only in case or
            in signs are the same for some clients and some file systems.

    Raises:
        MorseBuilderError: the name is not a word, is reserved, or is that of something else.
    """
    if not isinstance(name, str) or len(name) > LONGEST_NAME or not _WORD.fullmatch(name):
        mend = f"; write '{word_of(name)}'" if isinstance(name, str) and 0 < len(name) <= LONGEST_NAME else ""
        raise MorseBuilderError(
            f"the name of an object is a word of up to {LONGEST_NAME} letters (a to z), digits and '_' that does not "
            f"begin with a digit, not {quoted(name)}{mend}"
        )
    if name.lower() in RESERVED:
        raise MorseBuilderError(f"the name '{name}' is reserved; write '{name}_1', for example")
    for other in present:
        if _same(name, other):
            differs = "" if other == name else ": the names differ only in case or in signs"
            raise MorseBuilderError(f"there is already an object '{short(other)}' in the simulation{differs}")


def check_component_name(name: str, robot: str) -> None:
    """Check the name of a component of an object that a client spawns.

    Raises:
        MorseBuilderError: it is not below the name of the object, or is not made of words.
    """
    if name == robot or (name.startswith(f"{robot}.") and len(name) <= 4 * LONGEST_NAME and _PARTS.fullmatch(name)):
        return
    raise MorseBuilderError(
        f"a component of '{short(robot)}' has the name {quoted(name)}, expected words of letters, digits and '_' with "
        f"dots between them, of which the first one is '{short(robot)}'"
    )


def _same(name: str, other: str) -> bool:
    return len(name) == len(other) and re.sub(r"[^A-Za-z0-9_]", "_", other).lower() == name.lower()


def word_of(text: str) -> str:
    """A valid name that is similar to a text: ``front_camera`` for ``front-camera``, ``_3d`` for ``3d``."""
    word = re.sub(r"[^A-Za-z0-9_]", "_", text[:LONGEST_NAME])
    word = f"_{word}"[:LONGEST_NAME] if not word or word[0].isdigit() else word
    return f"{word[: LONGEST_NAME - 2]}_1" if word.lower() in RESERVED else word


def check_stored_name(name: str, what: str) -> None:
    """Check a name that a client gives to a state or a recording, and that may become that of a file.

    Raises:
        MorseRPCInvokationError: it is not a plain name of a file.
    """
    if not _FILE.fullmatch(name) or name.partition(".")[0].lower() in DEVICES:
        raise MorseRPCInvokationError(
            f"the name of a {what} is made of up to 64 letters, digits, '_', '-' and dots, not {quoted(name)}"
        )


def file_name(name: str) -> str:
    """The plain name of a file for any name: it stays in its folder, is not hidden, and fits into any file system.

    Letters and digits of any script, ``_``, ``-`` and dots are kept; other characters become ``_``. Two names may give
    the same result.
    """
    plain = "".join(c if c.isalnum() or c in "_.-" else "_" for c in name[:_LONGEST_FILE]).lstrip(".-")
    plain = plain.encode("utf-8", "replace")[:_LONGEST_FILE].decode("utf-8", "ignore") or "_"
    return f"_{plain}" if plain.partition(".")[0].lower() in DEVICES else plain
