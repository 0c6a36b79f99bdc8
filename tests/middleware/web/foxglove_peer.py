"""A client of the published protocol of Foxglove; messages are decoded by the schemas of the server.

Prints the received data as JSON.
"""

import json
import struct
import sys

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from websockets.sync.client import connect
from websockets.typing import Subprotocol

WANTED = {"/robot/odometry", "/robot/scan", "/tf_static"}
seen: dict = {"channels": {}, "time": 0}
store = get_typestore(Stores.EMPTY)

with connect(
    f"ws://127.0.0.1:{sys.argv[1]}", subprotocols=[Subprotocol(sys.argv[2])], proxy=None, max_size=None
) as socket:
    seen["subprotocol"] = socket.subprotocol
    subscriptions: dict = {}
    services: dict = {}
    calls: dict = {}
    faster = False

    def call(number: int, name: str, arguments: object) -> None:
        payload = json.dumps(arguments).encode()
        socket.send(struct.pack("<BIII", 2, services[name], number, 4) + b"json" + payload)

    while len(calls) < 3 or not seen.keys() >= WANTED or seen["way"] < 0.3 or seen["speed"] < 0.49:
        frame = socket.recv(timeout=50)
        if isinstance(frame, str):
            message = json.loads(frame)
            if message["op"] == "serverInfo":
                seen["info"] = message
            elif message["op"] == "advertise":
                for channel in message["channels"]:
                    seen["channels"][channel["topic"]] = [
                        channel[key] for key in ("encoding", "schemaName", "schemaEncoding")
                    ]
                    if channel["topic"] in WANTED:
                        store.register(get_types_from_msg(channel["schema"], channel["schemaName"]))
                        subscriptions[100 + channel["id"]] = channel
                asked = [{"id": number, "channelId": c["id"]} for number, c in subscriptions.items()]
                socket.send(json.dumps({"op": "subscribe", "subscriptions": asked}))
                channels = [
                    {"id": 7, "topic": "/robot/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/msg/Twist"},
                    {"id": 8, "topic": "/robot/motion", "encoding": "cdr", "schemaName": "geometry_msgs/Twist"},
                ]
                socket.send(json.dumps({"op": "advertise", "channels": channels}))
                socket.send(struct.pack("<BI", 1, 7) + b'{"linear": {"x": 0.25}}')
            elif message["op"] == "advertiseServices":
                services.update({one["name"]: one["id"] for one in message["services"]})
                seen["services"] = message["services"]
                call(1, "/robot/waypoint/goto", {"x": 0.0, "y": 0.0, "z": 0.0, "tolerance": 5.0})
                call(2, "/robot/motion/set_speed", {"somewhere": 1})
                call(3, "/robot/odometry/get_local_data", {})
            elif message["op"] == "serviceCallFailure":
                calls[message["callId"]] = message["message"]
            else:
                seen.setdefault("others", []).append(message)
        elif frame[0] == 1:
            _, number, stamp = struct.unpack_from("<BIQ", frame)
            channel = subscriptions[number]
            message = store.deserialize_cdr(frame[13:], channel["schemaName"])
            if channel["topic"] == "/robot/odometry":
                seen["way"] = message.pose.pose.position.x
                seen["child"] = message.child_frame_id
                seen["stamps"] = [stamp, message.header.stamp.sec * 10**9 + message.header.stamp.nanosec]
                seen["speed"] = message.twist.twist.linear.x
                if seen["way"] > 0.1 and not faster:
                    faster = True
                    # as CDR: six numbers after the encapsulation header of four bytes
                    socket.send(struct.pack("<BI", 1, 8) + b"\0\1\0\0" + struct.pack("<6d", 0.5, 0, 0, 0, 0, 0))
                seen["/robot/odometry"] = True
            elif channel["topic"] == "/robot/scan":
                angles = [message.angle_min, message.angle_max, message.angle_increment]
                seen["/robot/scan"] = [*angles, len(message.ranges)]
            else:
                seen["/tf_static"] = [one.child_frame_id for one in message.transforms]
        elif frame[0] == 2:
            (now,) = struct.unpack_from("<Q", frame, 1)
            assert now >= seen["time"]
            seen["time"] = now
        elif frame[0] == 3:
            _, service, number, length = struct.unpack_from("<BIII", frame)
            calls[number] = json.loads(frame[13 + length :])
    seen["calls"] = calls
print(json.dumps(seen))
