"""ROS 2 without ROS: topics over Cyclone DDS, with the names that ROS nodes use.

There are no services, actions or parameters. Nodes on Fast DDS address the answer of a service by a parameter of its
packet (OMG DDS-RPC, related sample identity) that the Python library of Cyclone DDS can neither read nor write.
"""

from __future__ import annotations

import dataclasses
import os
import socket
import types
from collections import deque
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cache
from time import monotonic
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

from cyclonedds import idl
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import types as dds
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as DdsQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from morse.core.exceptions import MorseMiddlewareError
from morse.middleware.ros2 import NODE
from morse.middleware.ros2.backends import Confined, confined, described
from morse.rosmsgs import cdr
from morse.rosmsgs.definitions import SEQUENCE, SINGLE, fields_of
from morse.rosmsgs.table import Qos
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription

if TYPE_CHECKING:
    from morse.core.values import Options


@cache
def sample_type(type_name: str) -> type[Any]:
    """The type of the samples of a topic: `data` contains an encoded message with its header.

    The description of the type, which other participants may compare with their own, has all fields.
    """
    fields = _described(type_name)

    class Sample(fields):  # type: ignore[valid-type, misc]
        __slots__ = ("data", "sample_info")
        data: bytes

        def __init__(self) -> None:
            """Leave all fields unset: see `data`."""

        def serialize(self, *_args: object, **_options: object) -> bytes:
            return self.data

        @classmethod
        def deserialize(cls, data: bytes, *_args: object, **_options: object) -> Any:
            sample = cls()
            sample.data = data
            return sample

        deserialize_key = deserialize

    Sample.__idl__ = fields.__idl__
    return Sample


@cache
def _described(type_name: str) -> type[Any]:
    package, _, name = type_name.partition("/msg/")
    annotations = {field.name: _type(field.type, field.size) for field in fields_of(type_name)}
    new_type: type = types.new_class(
        f"{name}_",
        (idl.IdlStruct,),
        {"typename": f"{package}::msg::dds_::{name}_"},
        lambda namespace: namespace["__annotations__"].update(annotations),
    )
    return dataclasses.dataclass(new_type)


def _type(name: str, size: int) -> Any:
    item: object = {"string": str, "bool": bool}.get(name)
    if item is None:
        item = getattr(dds, name, None) or _described(name)
    if size == SINGLE:
        return item
    return dds.sequence[item] if size == SEQUENCE else dds.array[item, size]


_TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_TOPIC = "ros_discovery_info"
#: where the participant, its number of nodes, and the namespace and name of the first one are in a message
_GID, _NODES, _FIRST = 4, 20, 24
#: maximum number of messages of other participants that wait, and that are read at once
_MOST_NODES = 100


class GraphNode:
    """A node with all readers and writers of its participant.

    Args:
        name: of the node, in the namespace ``/``.
        qos: reliable, one message, kept for late readers.

    Attributes:
        changed: whether readers or writers were added or removed since `tell`.
    """

    def __init__(self, participant: DomainParticipant, name: str, qos: DdsQos) -> None:
        kind = sample_type(_TYPE)
        self._participant, self._name = participant, name
        topic = Topic(participant, _TOPIC, kind)
        self._writer: Any = DataWriter(participant, topic, qos=qos)
        several = DdsQos(Policy.History.KeepLast(_MOST_NODES), base=qos)
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
        gid = {"data": self._participant.guid.bytes}
        self._sample.data = data = cdr.encode(_TYPE, {"gid": gid, "node_entities_info_seq": [node]})
        end = self._name.encode() + b"\0"
        self._first = data[_FIRST : data.index(end, _FIRST) + len(end)]
        self._writer.write(self._sample)

    def has_namesake(self) -> bool:
        """Whether the first node of another participant had the same name in a message since the last call."""
        own = self._sample.data[_GID:_NODES]
        return any(
            sample.data[_FIRST:].startswith(self._first) and sample.data[_GID:_NODES] != own
            for sample in self._others.take(_MOST_NODES)
            if sample.sample_info.valid_data
        )


#: time for which a reliable writer waits for a reader with a full queue; the simulation must not wait
_NO_TIME = 0.0
#: size of the fragments of images, bytes
_FRAGMENT = 14000
#: time for which a message is kept for readers that have not received all of it, s of the wall clock, and the number of
#: messages that are kept if their size is unknown: those of a second at 30 Hz
_PATIENCE, _KEPT = 1.0, 30
#: maximum number of messages that are read in one tick
_MOST = 64
#: number of publishers of a domain that are inspected at once: to read the description of one takes 0.2 ms
_ENDPOINTS = 16
#: Sockets of readers have room for a fifth of an image of 640 x 480 pixels: on a busy machine, the rest is sent again
#: after the next heartbeat. A reader asks for at most 256 fragments at once.
_IMAGES = f"<FragmentSize>{_FRAGMENT}B</FragmentSize>"
_INTERNAL = "<Internal><HeartbeatInterval>10ms</HeartbeatInterval></Internal>"
#: Fast DDS and Cyclone DDS announce themselves by multicast, which nodes with default settings also send to `lo`, and
#: with the discovery range LOCALHOST to the ports of 127.0.0.1. Few systems mark `lo` as an interface with multicast,
#: but all of them deliver it there.
_LOOPBACK = f"""<CycloneDDS><Domain><General>
<Interfaces><NetworkInterface address="127.0.0.1" multicast="true"/></Interfaces><AllowMulticast>spdp</AllowMulticast>
{_IMAGES}</General>{_INTERNAL}<Discovery><SPDPInterval>3s</SPDPInterval>
<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>99</MaxAutoParticipantIndex>
<Peers><Peer Address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""
_INTERFACE = f"""<CycloneDDS><Domain><General>
<Interfaces><NetworkInterface {{}} multicast="default"/></Interfaces>{_IMAGES}</General>{_INTERNAL}
</Domain></CycloneDDS>"""


@dataclass
class _Joined:
    """A domain with participants of this process: Cyclone DDS has one configuration for all of them."""

    domain: Domain
    settings: str
    participants: int = 0


_domains: dict[int, _Joined] = {}


def _configuration(interface: str) -> tuple[str, str]:
    """The configuration for an interface, and its name in the log."""
    if os.environ.get("CYCLONEDDS_URI"):
        return "", "as set by CYCLONEDDS_URI"
    if interface in ("", "lo", "127.0.0.1", "localhost"):
        return _LOOPBACK, "127.0.0.1"
    attribute = "autodetermine='true'" if interface == "any" else f"name={quoteattr(interface)}"
    if interface.replace(".", "").isdigit():
        attribute = f"address={quoteattr(interface)}"
    return _INTERFACE.format(attribute), interface


def _join(domain: int, interface: str) -> tuple[DomainParticipant, str]:
    settings, place = _configuration(interface)
    try:
        if not settings:
            return DomainParticipant(domain), place
        former = _domains.get(domain)
        if former is not None and former.settings != settings:
            raise MorseMiddlewareError(
                f"ros2: another simulation of this process uses the domain {domain} on another interface; "
                "set another domain_id for this one"
            )
        with confined() if settings == _LOOPBACK else nullcontext(Confined()) as sockets:
            share = former or _Joined(Domain(domain, settings), settings)
            participant = DomainParticipant(domain)
    except DDSException as error:
        present = ", ".join(name for _, name in socket.if_nameindex())
        raise MorseMiddlewareError(
            f"ros2: Cyclone DDS cannot join the domain {domain} on {place} (interfaces: {present}): {error}"
        ) from None
    share.participants += 1
    _domains[domain] = share
    return participant, described(sockets) if settings == _LOOPBACK else f"on {place}"


def _leave(domain: int) -> None:
    share = _domains.get(domain)
    if share is not None:
        share.participants -= 1
        if not share.participants:
            del _domains[domain]


def _qos(qos: Qos) -> DdsQos:
    return DdsQos(
        Policy.Reliability.Reliable(duration(seconds=_NO_TIME)) if qos.reliable else Policy.Reliability.BestEffort,
        Policy.History.KeepLast(qos.depth),
        Policy.Durability.TransientLocal if qos.latched else Policy.Durability.Volatile,
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )


class _Writer(Publisher):
    def __init__(self, backend: CycloneBackend, topic: Any, qos: Qos) -> None:
        self._graph = backend.graph
        kept = qos.depth if qos.latched else max(qos.depth, qos.history or _KEPT)
        self._writer = DataWriter(backend.participant, topic, qos=_qos(qos._replace(depth=kept)))
        self._graph.add(self._writer)
        self._reliable = qos.reliable
        #: when messages were sent that some reader has not received, as far as they are kept
        self._sent: deque[float] = deque(maxlen=kept)
        self._sample = topic.data_type()

    def publish(self, data: bytes) -> bool:
        is_image = self._reliable and len(data) > _FRAGMENT
        if is_image and not self._has_room():
            return False
        sample = self._sample
        sample.data = data
        try:
            self._writer.write(sample)
        except DDSException:  # reliable readers have not received the previous messages
            return False
        if is_image:
            self._sent.append(monotonic())
        return True

    def _has_room(self) -> bool:
        """Whether a new message drops no message of which a reader may have received a part.

        Readers on Fast DDS 2.14 that hear that the other parts do not exist any more take the incomplete message for
        a complete one, and never return from taking it. One that does not answer must not do this to the others: each
        message stays for a while.
        """
        try:
            is_complete = self._writer.wait_for_acks(0)
        except AttributeError:  # cyclonedds 11.0.1 has no name for the time-out that it reports
            is_complete = False
        if is_complete:
            self._sent.clear()
        return len(self._sent) < (self._sent.maxlen or 0) or monotonic() - self._sent[0] >= _PATIENCE

    def wanted(self) -> bool:
        return bool(self._writer.get_publication_matched_status().current_count)

    def close(self) -> None:
        if self._writer is not None:
            self._graph.remove(self._writer)
        self._writer = None


class _Reader(Subscription):
    def __init__(self, backend: CycloneBackend, topic: Any, qos: Qos) -> None:
        self._backend, self._topic = backend, topic
        self._reader = DataReader(backend.participant, topic, qos=_qos(qos))
        backend.graph.add(self._reader)

    def other_types(self) -> set[str]:
        names = self._backend.take_types(self._topic.name) - {self._topic.typename}
        return {name.replace("::msg::dds_::", "/msg/").removesuffix("_") for name in names}

    def take(self) -> list[bytes]:
        # a writer that is deleted leaves a sample without data
        return [sample.data for sample in self._reader.take(_MOST) if sample.sample_info.valid_data]

    def close(self) -> None:
        if self._reader is not None:
            self._backend.graph.remove(self._reader)
        self._reader = None


class CycloneBackend(Backend):
    """A participant of Cyclone DDS."""

    name = "cyclonedds"
    takes_threads = True

    def __init__(self, options: Options, node: str = NODE) -> None:
        self._domain = domain = options["domain_id"]
        self.participant, place = _join(domain, options["interface"])
        self.opens = f"domain {domain}, UDP {place}"
        self.graph = GraphNode(self.participant, node, _qos(Qos(1, latched=True)))
        self.graph.tell()
        self._topics: dict[tuple[str, str], object] = {}
        self._endpoints: Any = None
        #: types of discovered publishers by the DDS names of the topics of this participant
        self._types: dict[str, set[str]] = {}

    def _topic(self, topic: str, type_name: str) -> object:
        key = (topic, type_name)
        if key not in self._topics:
            self._topics[key] = Topic(self.participant, f"rt{topic}", sample_type(type_name))
        return self._topics[key]

    def take_types(self, topic: str) -> set[str]:
        """The types with which a topic, by its DDS name, was published since the last call.

        Each call inspects some publishers of the domain, which may have thousands; each publisher is inspected once.
        """
        if self._endpoints is None:
            self._endpoints = BuiltinDataReader(self.participant, BuiltinTopicDcpsPublication)
        own = {name for name, _ in self._topics}
        for one in self._endpoints.take(_ENDPOINTS):
            if one.sample_info.valid_data and one.topic_name.removeprefix("rt") in own:
                self._types.setdefault(one.topic_name, set()).add(one.type_name)
        return self._types.pop(topic, set())

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """See `Backend.publisher`."""
        return _Writer(self, self._topic(topic, type_name), qos)

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription:
        """See `Backend.subscription`."""
        return _Reader(self, self._topic(topic, type_name), qos)

    def tell_graph(self) -> None:
        """See `Backend.tell_graph`."""
        if self.graph.changed:
            self.graph.tell()

    def has_namesake(self) -> bool:
        """See `Backend.has_namesake`."""
        return self.graph.has_namesake()

    def close(self) -> None:
        """See `Backend.close`."""
        self._endpoints = None
        del self.graph
        self._topics.clear()
        del self.participant
        _leave(self._domain)
