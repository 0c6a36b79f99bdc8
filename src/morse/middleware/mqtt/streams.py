"""The streams of components: publishers send JSON, readers receive JSON."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError
from morse.core.reports.quoting import shown
from morse.core.streams.kind_stream import KindStream
from morse.middleware.mqtt import STREAM_OPTIONS
from morse.wire.inbox import Inbox

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from morse.middleware.mqtt.datastream import MqttDatastreamManager

#: maximum size of a message, bytes
_LONGEST = 1 << 20
#: maximum size of the name of a topic, bytes
_LONGEST_TOPIC = 1024


class MqttStream(KindStream):
    """A stream with a topic."""

    options = STREAM_OPTIONS
    manager: MqttDatastreamManager

    def initialize(self) -> None:
        """Determine the name of the topic.

        Raises:
            MorseMiddlewareError: MQTT does not allow it.
        """
        super().initialize()
        option = self.kwargs["topic"]
        path = self.component_name.replace(".", "/")
        self.topic = f"{self.manager.options['prefix']}/{path}" if option is None else option
        if not self.topic or re.search("[+#\0]", self.topic) or len(self.topic.encode()) > _LONGEST_TOPIC:
            raise MorseMiddlewareError(
                f"{self.component_name}: the topic is {shown(self.topic)}, expected a name without '+' and '#', such "
                "as 'lab/robot/pose'"
            )


class MqttPublisher(MqttStream):
    """Sends the data of a component as a JSON object at each of its actions.

    Pixels and points are sent as bytes to topics below that of the component.
    """

    def initialize(self) -> None:
        """Reserve the topic."""
        super().initialize()
        self.manager.claim(self.topic, self.component_name)


class MqttReader(MqttStream):
    """Writes JSON objects from the topic ``<component>/set`` into the data of a component.

    Missing fields keep their values. An invalid object is refused as a whole.
    """

    def initialize(self) -> None:
        """Listen."""
        super().initialize()
        self._inbox = Inbox()
        self.topic = f"{self.topic}/set" if self.kwargs["topic"] is None else self.topic
        self.manager.claim(self.topic, self.component_name)
        self.manager.broker.listen(self.topic, self.kwargs["qos"], self.receive)

    def receive(self, data: bytes, slots: object = None, frame: str = "") -> None:
        """Queue a message; called in the thread of the connection."""
        if len(data) > _LONGEST:
            self.complain("large", f"a message is refused: {len(data)} bytes are more than {_LONGEST}")
        else:
            self._inbox.put(data)

    def finalize(self) -> None:
        """End the subscription."""
        self.manager.broker.ignore(self.topic)

    @property
    def waiting(self) -> Collection[object]:
        """Messages that have arrived."""
        return self._inbox.arrived

    def arrived(self) -> Iterable[bytes]:
        """The messages that have arrived since the last action."""
        if not self._inbox or self.rests:
            return ()
        messages, losses = self._inbox.take()
        if losses:
            self.complain("dropped", f"{losses} messages arrived too fast: newer messages replace them")
        return messages
