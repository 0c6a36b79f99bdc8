"""The peer of MAVLink with pymavlink: receives telemetry, sends commands, prints the received messages."""

import json
import os
import sys
import time

if "gimbal" in " ".join(sys.argv):
    os.environ["MAVLINK20"] = "1"  # version 1 has no messages with numbers above 255

from pymavlink import mavutil

link = mavutil.mavlink_connection(sys.argv[1], source_system=255, dialect="common")
wanted = set(sys.argv[2].split(","))
command = sys.argv[3] if len(sys.argv) > 3 else ""
seen: dict = {}
end = time.monotonic() + 50
while not wanted <= seen.keys() and time.monotonic() < end:
    message = link.recv_match(blocking=True, timeout=0.05)
    if message is not None and message.get_type() != "BAD_DATA":
        record = message.to_dict()
        record["system"] = message.get_srcSystem()
        seen[message.get_type()] = record
    if command and (seen or "out" in sys.argv[1]):
        values = json.loads(command)
        getattr(link.mav, values[0])(*values[1:])
print(json.dumps(seen))
