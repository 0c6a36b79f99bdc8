"""What Python has to know of the C files: the structures, and the arguments of the functions.

Its digest is compiled into the library, and compared with that of the C files here when the library is loaded. With
other structures, the kernel would read and write anywhere.
"""

from __future__ import annotations

import hashlib
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

SOURCES = Path(__file__).parent / "c"
#: beginnings of what is compared, and how it ends; ``clang-format`` has put these at the beginnings of lines
_ENDS = {"typedef struct": "}", "typedef union": "}", "typedef ": ";", "enum {": ";", "MORSE_EXPORT ": ";"}
_CONSTANT = re.compile(r"#define (\w+) (.+)")


@cache
def layout(folder: Path = SOURCES) -> int:
    """Return the digest of the structures and of the functions that Python calls, 64 bits."""
    return digest(path.read_text(encoding="utf-8") for path in sorted(folder.iterdir()) if path.suffix in (".c", ".h"))


def digest(texts: Iterable[str]) -> int:
    """Return the digest of the contents of C files; comments, spaces and the bodies of functions do not matter."""
    declarations: list[str] = []
    constants: dict[str, str] = {}
    for text in texts:
        declarations += _declarations(text)
        constants.update(match.groups() for match in map(_CONSTANT.match, text.splitlines()) if match)  # type: ignore[misc]
    whole = " ".join(declarations)
    named = [f"{name} {constants[name]}" for name in sorted({*re.findall(r"\w+", whole)} & constants.keys())]
    return int.from_bytes(hashlib.sha256("\n".join([*declarations, *named]).encode()).digest()[:8], "little")


def _declarations(text: str) -> Iterator[str]:
    lines = iter(text.splitlines())
    for line in lines:
        end = next((end for begin, end in _ENDS.items() if line.startswith(begin)), None)
        if end is None:
            continue
        found = [line.partition("//")[0]]
        while not (found[-1].startswith("}") if end == "}" else found[-1].rstrip().endswith(end)):
            found.append(next(lines, "}" if end == "}" else end).partition("//")[0])
        yield " ".join(" ".join(found).split())
