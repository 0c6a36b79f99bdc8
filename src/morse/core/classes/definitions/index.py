"""An index of the classes in the files of the package.

Reading the definitions from the text of a hundred files takes as long as importing numpy. The index is written when the
package is built. Its keys are digests of the files: a file that was changed later is not in the index, and is read
itself.
"""

from __future__ import annotations

import hashlib
import marshal
from dataclasses import astuple
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from morse.core.classes.definitions import reading
from morse.core.classes.definitions.reading import Definition, definitions
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable

#: file name of the index, in the directory of this file
FILE = Path(__file__).with_name("classes.index")
#: version of the format of `marshal`, which Python 3.4 and later read
_VERSION = 4


def indexed(file: Path) -> list[Definition]:
    """The public classes in a file, from the index if it contains the file.

    Raises:
        OSError: the file cannot be read.
        SyntaxError: the file is not valid Python.
    """
    text = read_regular(file)
    entry = _index().get(_digest(text))
    if entry is None:
        return definitions(text, str(file))
    return [Definition(*fields) for fields in marshal.loads(entry)]


def write(files: Iterable[Path], index: Path = FILE) -> None:
    """Write the index of files.

    Raises:
        OSError: a file cannot be read, or the index cannot be written.
        SyntaxError: a file is not valid Python.
    """
    texts = [(file, file.read_bytes()) for file in sorted(files)]
    entries = {_digest(text): _packed(definitions(text, str(file))) for file, text in texts}
    index.write_bytes(marshal.dumps(entries, _VERSION))


@cache
def _index() -> dict[bytes, bytes]:
    try:
        data = marshal.loads(FILE.read_bytes())
    except (OSError, ValueError, EOFError, TypeError):
        # before the package is built there is no index, and each file is read
        return {}
    return data if isinstance(data, dict) else {}


def _packed(entries: list[Definition]) -> bytes:
    return marshal.dumps([astuple(one) for one in entries], _VERSION)


def _digest(text: bytes) -> bytes:
    return hashlib.blake2b(text, digest_size=16, key=_program()).digest()


@cache
def _program() -> bytes:
    """A digest of the program that writes and reads the index, because another program may define other entries."""
    files = (Path(__file__), Path(reading.__file__))
    return hashlib.blake2b(b"".join(file.read_bytes() for file in files)).digest()
