"""The rows of a study."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.core.reports.quoting import spreadsheet_cell
from morse.many.ledger import read_facts, read_rows
from morse.many.run import RESERVED, name_of
from morse.system.extras import install

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Iterator

    from morse.many.values import Row


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
            FileNotFoundError: it is no folder of results.
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
