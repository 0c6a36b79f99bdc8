"""The results of a study: on disk, where they survive the death of any process, and as a table."""

from __future__ import annotations

import contextlib
import csv
import errno
import json
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.core.reports.quoting import spreadsheet_cell
from morse.many.run import RESERVED as RESERVED
from morse.many.run import is_row, name_of
from morse.system.extras import install
from morse.system.regular_files import RefusedFileError, is_regular, open_regular, read_regular
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from types import TracebackType
    from typing import BinaryIO

    from morse.many.values import Row


#: the rows; each is a line of JSON
ROWS = "rows.jsonl"
#: what the folder contains, and how many runs there will be
STUDY = "study.json"
#: longest time for which rows are not forced to the disk, s
_FLUSH = 1.0
#: longest line that is read, and largest file of facts, bytes
_LONGEST = 64 << 20


def read_rows(folder: str | os.PathLike[str]) -> dict[str, Row]:
    """Return the rows by name; of several rows of a run the last one, which has the recording."""
    rows: dict[str, Row] = {}
    for row in _lines(Path(folder) / ROWS):
        rows[row["run"]] = row
    return rows


def read_facts(folder: str | os.PathLike[str]) -> Row:
    """Return what `Ledger.describe` has written; ``axes`` is a dictionary, ``runs`` a number.

    Raises:
        FileNotFoundError: it is not a folder of results.
        ValueError: the file is damaged.
    """
    path = Path(folder) / STUDY
    try:
        facts = json.loads(read_regular(path, _LONGEST))
    except (FileNotFoundError, NotADirectoryError):
        raise FileNotFoundError(f"{folder} contains no results of a study: there is no {STUDY}") from None
    except (ValueError, RecursionError):
        facts = None
    match facts:
        case {"axes": dict(), "runs": int()}:
            return dict(facts)
    raise ValueError(f"{path} is damaged: start the study again with the same folder, which writes it anew")


def _lines(path: Path) -> Iterator[Row]:
    with contextlib.suppress(FileNotFoundError), open_regular(path) as file:
        while line := file.readline(_LONGEST):
            if line.endswith(b"\n"):  # else the process died while it wrote
                with contextlib.suppress(ValueError, RecursionError):
                    row = json.loads(line)
                    if is_row(row):
                        yield row


class Ledger:
    """Appends rows to a folder. Only one process at a time may have it.

    Raises:
        RuntimeError: another process has it.
        OSError: a file in it is a link or no regular file.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        for name in (".lock", ROWS):
            _check_own(folder / name)
        self._lock = open(folder / ".lock", "a+b")  # noqa: SIM115 # held until the end
        if not _locked(self._lock):
            self._lock.close()
            raise RuntimeError(f"another process is running a study in {folder}: wait for it, or use another folder")
        self.rows = read_rows(folder)
        _repair(folder / ROWS)
        self._file = open(folder / ROWS, "ab")  # noqa: SIM115
        self._last_sync = time.monotonic()

    def add(self, row: Row) -> None:
        """Append a row."""
        self.rows[row["run"]] = row
        self._file.write(json.dumps(row).encode() + b"\n")
        self._file.flush()
        if time.monotonic() - self._last_sync > _FLUSH:
            self._force()

    def _force(self) -> None:
        os.fsync(self._file.fileno())
        self._last_sync = time.monotonic()

    def describe(self, facts: Row) -> None:
        """Write the facts about the study; the file appears whole or not at all."""
        write_whole(self.folder / STUDY, json.dumps(facts, indent=1))

    def close(self) -> None:
        """Force everything to the disk, and release the folder."""
        self._force()
        self._file.close()
        self._lock.close()

    def __enter__(self) -> Ledger:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _check_own(path: Path) -> None:
    """Refuse what is not a regular file of the folder itself: a link would have other files changed."""
    with contextlib.suppress(FileNotFoundError):
        if not is_regular(path.lstat()):
            raise RefusedFileError(errno.EINVAL, "it is a link or a special file, expected a regular file", str(path))


def _repair(path: Path) -> None:
    """Remove the part of a line at the end, so that the next row begins a line."""
    with contextlib.suppress(FileNotFoundError), open(path, "r+b") as file:
        content = file.read()
        if content and not content.endswith(b"\n"):
            file.truncate(content.rfind(b"\n") + 1)


def _locked(file: BinaryIO) -> bool:
    try:
        if os.name == "nt":
            import msvcrt

            getattr(msvcrt, "locking")(file.fileno(), getattr(msvcrt, "LK_NBLCK"), 1)  # noqa: B009
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


class Table:
    """Rows of runs: dictionaries with the parameters, the results, and the facts about each run.

    Attributes:
        rows: the rows, in the order of the runs.
        folder: where they are stored.
    """

    def __init__(self, rows: Iterable[Row], folder: str | os.PathLike[str], axes: Iterable[str] = ()) -> None:
        self.rows, self.folder, self.axes = list(rows), Path(folder), list(axes)

    @classmethod
    def read(cls, folder: str | os.PathLike[str]) -> Table:
        """Read the rows of the study that a folder describes: of the one that was last begun there.

        Raises:
            FileNotFoundError: it is not a folder of results.
            ValueError: its description is damaged.
        """
        facts = read_facts(folder)
        axes, identity = facts["axes"], facts.get("identity")
        rows: Iterable[Row] = read_rows(folder).values()
        if isinstance(identity, dict):  # else an earlier version has written it
            rows = [
                row
                for row in rows
                if row["run"] == name_of(identity, {name: row.get(name) for name in axes}, row["seed"])
            ]
        return cls(rows, folder, axes)

    @property
    def failures(self) -> list[Row]:
        """The rows of runs that have failed."""
        return [row for row in self.rows if row["error"]]

    @property
    def columns(self) -> list[str]:
        """The names of all columns: the parameters, the seed, the results, the facts."""
        names = dict.fromkeys(name for row in self.rows for name in row)
        results = [name for name in names if name not in RESERVED and name not in self.axes]
        return [*self.axes, "seed", *results, *(name for name in RESERVED if name != "seed")]

    def find(self, name: str) -> Row:
        """Return the row of a run, given the first letters of its name.

        Raises:
            LookupError: there is none, or there are several.
        """
        rows = [row for row in self.rows if row["run"].startswith(name)]
        if len(rows) != 1:
            problem = f"{len(rows)} runs begin with" if rows else "there is no run"
            raise LookupError(f"{problem} '{name}' in {self.folder}, which contains {len(self.rows)} runs")
        return rows[0]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __getitem__(self, key: int | str) -> Any:
        """A row, given its number; a column as a list, given its name."""
        if isinstance(key, int):
            return self.rows[key]
        if key not in self.columns:
            raise KeyError(f"no column '{key}': there are {', '.join(self.columns)}")
        return [row.get(key) for row in self.rows]

    def __repr__(self) -> str:
        return f"<Table of {len(self)} runs, {len(self.failures)} failed; columns: {', '.join(self.columns)}>"

    # -- other formats ---------------------------------------------------------------------

    def to_dict(self) -> dict[str, list[object]]:
        """Return the columns as lists by name: ``polars.DataFrame(table.to_dict())``."""
        return {name: [row.get(name) for row in self.rows] for name in self.columns}

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a file of comma-separated values; a text that a spreadsheet would compute begins with ``'``."""
        with open(path, "w", newline="", encoding="utf-8", errors="backslashreplace") as file:
            lines = csv.writer(file)
            lines.writerow([spreadsheet_cell(name) for name in self.columns])
            lines.writerows([spreadsheet_cell(row.get(name)) for name in self.columns] for row in self.rows)

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write a file in the Parquet format, with the extra ``parquet``.

        Raises:
            ImportError: pyarrow is not installed.
        """
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            raise ImportError(f"Parquet needs pyarrow: {install('parquet')}") from None
        parquet.write_table(pyarrow.table(self.to_dict()), path)

    def to_pandas(self) -> object:
        """Return a `pandas.DataFrame`; pandas has to be installed."""
        import pandas

        return pandas.DataFrame(self.to_dict())
