"""The peer: reads poses on many topics, and prints for each line of its input the number of messages of each topic."""

import json
import os
import selectors
import sys

from cyclonedds.domain import DomainParticipant
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from morse.middleware.ros2.backends.cyclone import _LOOPBACK, sample_type

os.environ["CYCLONEDDS_URI"] = _LOOPBACK


def main() -> None:
    domain, *topics = sys.argv[1:]
    participant = DomainParticipant(int(domain))
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(1000))
    kind = sample_type("geometry_msgs/msg/PoseStamped")
    readers = {name: DataReader(participant, Topic(participant, f"rt{name}", kind), qos=qos) for name in topics}
    counts = dict.fromkeys(topics, 0)
    print("ready", flush=True)
    selector = selectors.DefaultSelector()
    selector.register(sys.stdin, selectors.EVENT_READ)
    ended = False
    while not ended:
        asked = sys.stdin.readline() if selector.select(0.05) else None
        ended = asked in ("", "end\n")
        for name, reader in readers.items():
            counts[name] += sum(1 for sample in reader.take(1000) if sample.sample_info.valid_data)
        if asked is not None:
            print(json.dumps(counts), flush=True)


main()
