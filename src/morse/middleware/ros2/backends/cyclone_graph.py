"""The node of a participant in the graph of ROS.

Nodes are no part of DDS: each participant tells the others on a topic which nodes it has, and which readers and writers
belong to them (package rmw_dds_common, since ROS 2 Iron).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

from morse.middleware.ros2.backends.cyclone_types import sample_type
from morse.rosmsgs import cdr

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.qos import Qos

_TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_TOPIC = "ros_discovery_info"


class GraphNode:
    """A node with all readers and writers of its participant.

    Args:
        name: of the node, in the namespace ``/``.
        qos: reliable, one message, kept for late readers.

    Attributes:
        changed: whether readers or writers were added or removed since `tell`.
    """

    def __init__(self, participant: DomainParticipant, name: str, qos: Qos) -> None:
        kind = sample_type(_TYPE)
        self._participant, self._name = participant, name
        self._writer: Any = DataWriter(participant, Topic(participant, _TOPIC, kind), qos=qos)
        self._sample = kind()
        self._readers: dict[bytes, None] = {}
        self._writers: dict[bytes, None] = {}
        self.changed = True

    def add(self, entity: Any) -> None:
        """Add a reader or a writer."""
        self._side(entity)[entity.guid.bytes] = None
        self.changed = True

    def remove(self, entity: Any) -> None:
        """Remove a reader or a writer."""
        self._side(entity).pop(entity.guid.bytes, None)
        self.changed = True

    def _side(self, entity: object) -> dict[bytes, None]:
        return self._writers if isinstance(entity, DataWriter) else self._readers

    def tell(self) -> None:
        """Send the node with its readers and writers."""
        self.changed = False
        node = {
            "node_namespace": "/",
            "node_name": self._name,
            "reader_gid_seq": [{"data": number} for number in self._readers],
            "writer_gid_seq": [{"data": number} for number in self._writers],
        }
        message = {"gid": {"data": self._participant.guid.bytes}, "node_entities_info_seq": [node]}
        self._sample.data = cdr.encode(_TYPE, message)
        self._writer.write(self._sample)
