"""Records a run."""

from __future__ import annotations

import contextlib
import logging
import os
from collections import ChainMap
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from morse.core.guard import Failure
from morse.core.observer import Observer
from morse.recording.disk import Disk
from morse.recording.errors import RecordingError
from morse.recording.inputs import Inputs
from morse.recording.made.writing import MadeObjects
from morse.recording.mcap.writer import McapWriter
from morse.recording.streams import RecordedStreams, TopicFile

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping
    from io import FileIO

    from morse.core.context import Context
    from morse.core.journal import Entry
    from morse.recording.made.made import Made
    from morse.scene import Scene

logger = logging.getLogger(__name__)

#: names of metadata tables
BEGINNING, END = "morse", "morse end"
#: the fact that is the format of a recording; those without that fact have the format 1
FORMAT = "format"
#: the present format; the first one that contains what a page needs. Before 3, inputs had no outcomes
PRESENT, FIRST_SHOWN = 3, 2
MEDIA_TYPE = "application/octet-stream"


class Beginning(NamedTuple):
    """The data that determine a run, in addition to its inputs.

    Attributes:
        facts: versions, seed, script, ...
        files: by name: the scene script, modules of the project, the state at the beginning of the recording.
        pack: encodes an entry of the journal as bytes.
        ending: returns facts about the end, called when the recording stops.
        made: returns the present objects that were spawned, by name.
        scene: the scene at the launch.
    """

    facts: Mapping[str, str]
    files: Mapping[str, bytes]
    pack: Callable[[Entry], bytes]
    ending: Callable[[], Mapping[str, str]]
    made: Callable[[], Mapping[str, Made]]
    scene: Scene


class Recorder(Observer):
    """Records the messages of the sensors, the frames, the log and all inputs until `stop` or the end of the run.

    It is an observer: the simulation is bit-identical with and without it. When the disk is full or fails, the
    recording ends, and the simulation continues. While the disk is slow, the simulation waits.

    Args:
        context: of the simulation.
        path: of the file, which must not exist.
        beginning: see `Beginning`.
        sensors: names of the recorded sensors; None for all, empty for only inputs and the log.

    Attributes:
        path: of the file.
        error: the reason for an early end of the recording; None if there was none.

    Raises:
        RecordingError: the file exists or cannot be written.
    """

    def __init__(
        self, context: Context, path: str | os.PathLike[str], beginning: Beginning, sensors: Collection[str] | None
    ) -> None:
        try:
            self.path = os.path.abspath(path)
        except OSError:
            raise RecordingError(f"{path} cannot be written: the present folder of the process was deleted") from None
        self.error: str | None = None
        self._context, self._clock = context, context.clock
        self._ending = beginning.ending
        #: called when the recording ends, for any reason
        self.on_end: Callable[[], object] = _nothing
        try:
            self._disk = Disk(_created(self.path))
        except OSError as error:
            raise RecordingError(f"{self.path} cannot be written: {error.strerror or error}") from None
        self._open = True
        self._last_flush = context.clock.tick
        self._has_warned = False
        self._ticks = 0
        try:
            self._start(beginning, sensors)
        except BaseException:
            self._disk.close()
            raise

    def _start(self, beginning: Beginning, sensors: Collection[str] | None) -> None:
        disk, context = self._disk, self._context
        disk.other(lambda file: file.metadata(BEGINNING, {FORMAT: str(PRESENT), **beginning.facts}))
        for name, data in beginning.files.items():
            disk.other(partial(McapWriter.attachment, name=name, media_type=MEDIA_TYPE, data=data))
        self._topic_file = TopicFile(context, disk)
        self._inputs = Inputs(context.journal, self._topic_file, beginning.pack)
        self._objects = MadeObjects(
            self._topic_file,
            disk,
            beginning.made,
            lambda: self._inputs.count,
            beginning.scene,
            ChainMap(context.robots, context.components, context.external_robots),
        )
        self._streams = RecordedStreams(context, self._topic_file, sensors)

    @property
    def running(self) -> bool:
        """Whether it is recording."""
        return self._open

    @property
    def ticks(self) -> int:
        """Recorded ticks."""
        return self._ticks

    def after_tick(self) -> None:
        """Write the data of the tick as a whole."""
        if not self._open:
            return
        tick = self._clock.tick
        if tick != self._last_flush:  # no tick ends while the simulation is paused
            self._last_flush = tick
            self._ticks += 1
            self._streams.flush()
            self._topic_file.end_tick()
        disk = self._disk
        if disk.waits and not self._has_warned:
            self._has_warned = True
            logger.warning("the disk is slower than the simulation, which waits for the recording %s", self.path)
        if disk.error is not None:
            self._fail(disk.error)

    def restarted(self) -> None:
        """The components were created again."""
        self._last_flush = self._context.clock.tick
        self._objects.follow()
        self._streams.follow()

    def rearranged(self) -> None:
        """Components were added or removed, or another state was restored."""
        self._last_flush = self._context.clock.tick
        self._objects.follow()
        self._streams.follow()

    def stop(self) -> None:
        """Stop recording: write the remaining data and the index, and close the file.

        Raises:
            RecordingError: the end could not be written.
        """
        if not self._open:
            return
        self._streams.write_log()
        self._topic_file.finish()
        ending = {**self._ending(), "ticks": str(self._ticks)}
        self._disk.other(lambda file: file.metadata(END, ending))
        self._let_go()
        if self._disk.error is not None:
            self.error = self._refusal(self._disk.error)
            raise RecordingError(self.error)

    def close(self) -> None:
        """The end of the simulation."""
        with contextlib.suppress(RecordingError):
            self.stop()
        if self.error is not None:
            self._report(self.error)

    def _report(self, text: str) -> None:
        logger.error("[ERROR][MORSE] %s", text)
        part = f"the recording {self.path}"
        self._context.guard.note(Failure("fault", part, "is incomplete", self._context.clock.time, text))

    def _refusal(self, error: OSError) -> str:
        until = self._disk.until
        what = "no data" if until is None else f"the data up to {until / 1e9:.3f} s of the recording"
        return (
            f"the recording {self.path} ends at {self._context.clock.time:.3f} s: {error.strerror or error}; "
            f"the file contains {what}, later data are lost"
        )

    def _fail(self, error: OSError) -> None:
        self.error = self._refusal(error)
        self._let_go()
        self._report(f"{self.error}. The simulation continues.")

    def _let_go(self) -> None:
        self._open = False
        self._inputs.close()
        self._streams.finalize()
        self._disk.close()
        self.on_end()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def _created(path: str) -> FileIO:
    """Create a new file.

    Raises:
        RecordingError: a file of that name exists.
        OSError: the file cannot be created.
    """
    # devices and pipes may exist
    is_device = os.path.exists(path) and not os.path.isfile(path)
    try:
        return open(path, "wb", buffering=0) if is_device else open(path, "xb", buffering=0)
    except FileExistsError:
        raise RecordingError(
            f"{path} exists already: remove it, or give the recording another name; recordings overwrite nothing"
        ) from None


def _nothing() -> None:
    """Ignore the notification."""
