"""The peer: a participant of the domain with its own types. It prints the received data as JSON.

The annotations are read by Cyclone DDS: they must not be strings.
"""

import json
import os
import sys
import time
from dataclasses import asdict, dataclass

os.environ["CYCLONEDDS_URI"] = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<MaxAutoParticipantIndex>99</MaxAutoParticipantIndex><Peers><Peer Address="127.0.0.1"/></Peers></Discovery>'
    "</Domain></CycloneDDS>"
)

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, sequence, uint32
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

_LIMIT = 90.0


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


def main() -> None:
    participant = DomainParticipant(int(sys.argv[1]))
    got: dict[str, list[dict[str, object]]] = {}
    readers = {}
    for topic, latched in (("/tf", False), ("/tf_static", True)):
        qos = Qos(
            Policy.Reliability.Reliable(duration(seconds=1)),
            Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
            Policy.History.KeepLast(100),
        )
        readers[topic] = DataReader(participant, Topic(participant, f"rt{topic}", TFMessage), qos=qos)
        got[topic] = []
    end = time.monotonic() + _LIMIT
    while time.monotonic() < end and not (len(got["/tf"]) > 3 and got["/tf_static"]):
        for topic, reader in readers.items():
            got[topic] += [asdict(sample) for sample in reader.take(10) if sample.sample_info.valid_data]
        time.sleep(0.01)
    print(json.dumps(got))


main()
