"""The streams of components: publishers send bottles, readers receive bottles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.streams.kind_stream import KindStream
from morse.plugins.yarp import STREAM_OPTIONS
from morse.plugins.yarp.waiting import WaitingBottles

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sized

    from morse.plugins.yarp.datastream import YarpDatastreamManager

#: number of bottles that wait for the next action of an actuator
_MOST_WAITING = 64


class YarpStream(KindStream):
    """A stream with a port."""

    options = STREAM_OPTIONS
    manager: YarpDatastreamManager
    _end = ""

    def initialize(self) -> None:
        """Open the port.

        Raises:
            MorseMiddlewareError: its name is not one of YARP, or another component has it.
        """
        super().initialize()
        path = f"{self.component_name.replace('.', '/')}/{self._end}"
        name = self.kwargs["port"] or self.manager.ports.name(path)
        self.port = self.manager.ports.open(name, self.component_name, self.taker())

    def taker(self) -> Callable[[list[object], int], object] | None:
        """The function that takes the bottles that arrive."""
        return None

    def finalize(self) -> None:
        """Close the port."""
        self.manager.ports.close(self.port)


class YarpPublisher(YarpStream):
    """Sends the values of a component as a bottle at each of its actions; pixels as an image."""

    _end = "out"


class YarpReader(YarpStream):
    """Writes the values of bottles into the data of an actuator, in the order of its fields.

    A bottle may have fewer values than the actuator has fields; the others keep their values. A bottle with a wrong
    value is refused as a whole.
    """

    _end = "in"
    what = "bottle"

    def initialize(self) -> None:
        """Listen."""
        #: fields that bottles set, in their order
        self.fields = [name for name in self.data if name != "timestamp"]
        super().initialize()

    def taker(self) -> Callable[[list[object], int], object]:
        """See `YarpStream.taker`."""
        self._bottles: WaitingBottles[list[object]] = WaitingBottles(
            _MOST_WAITING, self.complaints, f"{self.component_name}: bottles"
        )
        return self._bottles.append

    @property
    def waiting(self) -> Sized:
        """Bottles that have arrived."""
        return self._bottles

    def arrived(self) -> Iterable[list[object]]:
        """The bottles that have arrived, as many as there is time for."""
        while self._bottles and not self.rests:
            yield self._bottles.popleft()
