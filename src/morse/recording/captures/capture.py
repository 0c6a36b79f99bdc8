"""The base class of captures."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.kernel.recording import Rows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.kernel.recording import Batch, NativeRecords
    from morse.recording.captures.template import Template


class Capture(ABC):
    """The messages of one tick, which differ from those of another tick only in their times and numbers.

    Attributes:
        template: the records of one tick.
        size: size of these records, bytes.
        held: approximate memory of a tick until it is encoded, without poses, bytes.
        is_taken: whether it has a method ``take(group)``, which returns the data of a tick to store, or None if the
            streams have to encode the messages.
    """

    held = 0
    is_taken = False

    def __init__(self, native: NativeRecords, template: Template) -> None:
        self._native = native
        self.template = template
        self.size = len(template.bytes)

    def encode(
        self, batch: Batch, begins: NDArray[np.int64], moments: NDArray[np.int64], data: Any, chunk: NDArray[np.uint8]
    ) -> None:
        """Write the records of R ticks.

        Args:
            batch: receives the steps.
            begins: (R,) offset of the records of each tick in the chunk.
            moments: (R, 3) number of the tick, log time (ns), simulated time (ns).
            data: the stored data of R ticks.
            chunk: receives the records.
        """
        template = self.template
        rows = Rows(begins, moments, template.bytes, template.heads, template.stamps, chunk)
        batch.rows(rows)
        self._fill(batch, rows, data)

    @abstractmethod
    def _fill(self, batch: Batch, rows: Rows, data: Any) -> None:
        """Add the steps that write the numbers into the records."""

    def agrees(self, data: Any, wanted: Sequence[bytes]) -> bool:
        """Whether the messages of a tick are bit-identical to those of the streams.

        Args:
            data: the stored data of the tick.
            wanted: the messages of the same tick, in order.
        """
        chunk = np.empty(self.size, dtype=np.uint8)
        rows = self._of_template(chunk)
        batch = self._native.batch()
        self._fill(batch, rows, data)
        batch.run()
        found = chunk.tobytes()
        return all(
            found[begin : begin + len(message)] == message
            for begin, message in zip(self.template.begins.tolist(), wanted, strict=True)
        )

    def _of_template(self, chunk: NDArray[np.uint8]) -> Rows:
        """One row: the template with its own times."""
        chunk[:] = self.template.bytes
        begins, moments = np.zeros(1, dtype=np.int64), np.zeros((1, 3), dtype=np.int64)
        return Rows(begins, moments, self.template.bytes, self.template.heads, self.template.stamps, chunk)
