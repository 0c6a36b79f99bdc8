"""A client of a broker that drives and observes a robot; prints the received data as JSON."""

import json
import sys
import threading

from paho.mqtt import client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

seen: dict = {}
arrived = threading.Event()


def received(client, userdata, message):
    if message.topic.endswith("/image"):
        seen["image"] = len(message.payload)
    elif message.topic == "morse/status":
        seen["status"] = message.payload.decode()
    else:
        seen[message.topic] = json.loads(message.payload)
    enough = {"image", "status", "morse/robot/camera", "morse/robot/scan"} <= seen.keys()
    if enough and seen.get("morse/robot/pose", {"x": 0.0})["x"] > 0.3:
        arrived.set()


client = mqtt.Client(CallbackAPIVersion.VERSION2)
client.on_message = received
client.connect("127.0.0.1", int(sys.argv[1]))
client.subscribe("morse/#")
client.loop_start()
while not arrived.wait(0.1):
    client.publish("morse/robot/motion/set", json.dumps({"v": 0.5, "w": 0.0}))
client.disconnect()
print(json.dumps(seen))
