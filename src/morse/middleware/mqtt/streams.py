"""The streams of components: publishers send JSON, readers receive JSON."""

from __future__ import annotations

import logging
import re
from typing import TYPE_CHECKING, Any

from morse.core.datastream import AbstractDatastream
from morse.core.exceptions import MorseMiddlewareError
from morse.core.kinds import bind
from morse.core.reports.quoting import shown
from morse.core.validation import ClientCommands
from morse.middleware.mqtt.mapping import STREAM_OPTIONS
from morse.wire.encoding import from_json
from morse.wire.inbox import Inbox

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.core.object import Object

logger = logging.getLogger(__name__)

#: maximum size of a message, bytes
_LONGEST = 1 << 20
#: maximum size of the name of a topic, bytes
_LONGEST_TOPIC = 1024


class MqttStream(AbstractDatastream):
    """A stream with a topic."""

    options = STREAM_OPTIONS

    def initialize(self) -> None:
        """Determine the name of the topic.

        Raises:
            MorseMiddlewareError: MQTT does not allow it.
        """
        given = self.kwargs["topic"]
        path = self.component_name.replace(".", "/")
        self.topic = f"{self.manager.options['prefix']}/{path}" if given is None else given
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
        """Determine the format of the data."""
        super().initialize()
        self.kinds = bind(self.component_instance)
        main = next((bound for bound in self.kinds if not bound.topic), None)
        self._form = self.manager.mapping(main.kind.name if main is not None else "general")
        self.manager.claim(self.topic, self.component_name)

    def default(self, ci: Object | None = None) -> bool:
        """Publish the data if a broker is connected."""
        if self.manager.broker.connected:
            for below, data in self._form(self):
                topic = f"{self.topic}/{below}" if below else self.topic
                self.manager.broker.publish(topic, data, self.kwargs["qos"], self.kwargs["retain"])
        return False


class MqttReader(MqttStream):
    """Writes JSON objects from the topic ``<component>/set`` into the data of a component.

    Missing fields keep their values. An invalid object is refused as a whole.
    """

    def initialize(self) -> None:
        """Listen."""
        super().initialize()
        self._inbox = Inbox()
        self._commands = ClientCommands(self.component_instance, logger)
        self.topic = f"{self.topic}/set" if self.kwargs["topic"] is None else self.topic
        self.manager.claim(self.topic, self.component_name)
        self.manager.broker.listen(self.topic, self.kwargs["qos"], self._arrived)

    def _arrived(self, data: bytes) -> None:
        """A message has arrived; in the thread of the connection."""
        if len(data) > _LONGEST:
            self._commands.complain("large", f"a message is refused: {len(data)} bytes are more than {_LONGEST}")
        else:
            self._inbox.put(data)

    def finalize(self) -> None:
        """End the subscription."""
        self.manager.broker.ignore(self.topic)

    @property
    def waiting(self) -> Collection[Any]:
        """Messages that have arrived."""
        return self._inbox.arrived

    def default(self, ci: Object | None = None) -> bool:
        """Process received messages; True if there were any."""
        if not self._inbox or self._commands.rest:
            return False
        messages, dropped = self._inbox.take()
        if dropped:
            self._commands.complain("dropped", f"{dropped} messages arrived too fast: newer messages replace them")
        taken = False
        for data in messages:
            taken = self._commands.take(from_json, data) or taken
        return taken
