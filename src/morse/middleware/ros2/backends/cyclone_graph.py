"""The node of a participant in the graph of ROS.

Nodes are no part of DDS: each participant tells the others on a topic which nodes it has, and which readers and writers
belong to them (package rmw_dds_common, since ROS 2 Iron).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from morse.middleware.ros2.backends.cyclone_types import sample_type
from morse.rosmsgs import cdr

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant

_TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_TOPIC = "ros_discovery_info"
#: where the participant, its number of nodes, and the namespace and name of the first one are in a message
_GID, _NODES, _FIRST = 4, 20, 24
#: maximum number of messages of other participants that wait, and that are read at once
_MOST = 100


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
        topic = Topic(participant, _TOPIC, kind)
        self._writer: Any = DataWriter(participant, topic, qos=qos)
        several = Qos(Policy.History.KeepLast(_MOST), base=qos)
        self._others: Any = DataReader(participant, topic, qos=several)
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
        self._sample.data = data = cdr.encode(_TYPE, message)
        end = self._name.encode() + b"\0"
        self._first = data[_FIRST : data.index(end, _FIRST) + len(end)]
        self._writer.write(self._sample)

    def has_namesake(self) -> bool:
        """Whether the first node of another participant had the same name in a message since the last call."""
        own = self._sample.data[_GID:_NODES]
        return any(
            sample.data[_FIRST:].startswith(self._first) and sample.data[_GID:_NODES] != own
            for sample in self._others.take(_MOST)
            if sample.sample_info.valid_data
        )
