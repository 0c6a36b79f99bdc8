"""A program with the bindings of YARP that reads, commands and calls a simulation; prints what it saw as JSON."""

from __future__ import annotations

import ctypes
import json
import struct
import sys
import time
from typing import Any

import yarp

LIMIT = 50.0


def port_of(kind: Any, name: str) -> Any:
    made = kind()
    assert made.open(name)
    return made


def main() -> None:
    yarp.Network.init()
    network = yarp.Network
    end = time.monotonic() + LIMIT
    names = [f"/morse/robot/{name}/out" for name in ("pose", "scan", "camera", "depth", "ids")]
    while not all(network.exists(name, True) for name in names):
        assert time.monotonic() < end
        time.sleep(0.02)
    seen: dict[str, Any] = {}

    pose = port_of(yarp.BufferedPortBottle, "/peer/pose")
    seen["connected"] = network.connect(names[0], "/peer/pose")
    seen["is connected"] = network.isConnected(names[0], "/peer/pose")
    seen["over udp"] = network.connect(names[0], "/peer/pose", "udp")
    first = pose.read(True)
    seen["pose"] = [first.get(i).asFloat64() for i in range(first.size())]

    scan = port_of(yarp.BufferedPortBottle, "/peer/scan")
    assert network.connect(names[1], "/peer/scan", "fast_tcp")
    points = scan.read(True)
    seen["points"] = points.size()
    seen["point"] = [points.get(540).asList().get(i).asFloat64() for i in range(3)]

    kinds = {
        "camera": (yarp.BufferedPortImageRgba, "B", 4),
        "depth": (yarp.BufferedPortImageFloat, "f", 1),
        "ids": (yarp.BufferedPortImageMono16, "H", 1),
    }
    for name, (kind, letter, channels) in kinds.items():
        port = port_of(kind, f"/peer/{name}")
        assert network.connect(f"/morse/robot/{name}/out", f"/peer/{name}")
        image = port.read(True)
        # the bindings have pointers to pixels only
        data = ctypes.string_at(int(image.getRawImage()), image.getRawImageSize())
        row, size = image.getRowSize(), struct.calcsize(letter) * channels * image.width()
        seen[name] = [
            struct.unpack(f"{channels * image.width()}{letter}", data[row * y : row * y + size])
            for y in range(image.height())
        ]

    requests = port_of(yarp.Port, "/peer/requests")
    replies = port_of(yarp.BufferedPortBottle, "/peer/replies")
    replies.setStrict()
    assert network.connect("/peer/requests", "/morse/services/robot.goal/request")
    assert network.connect("/morse/services/robot.goal/reply", "/peer/replies")

    def ask(*words: str) -> str:
        request = yarp.Bottle()
        for word in words:
            request.addString(word)
        requests.write(request)
        return str(replies.read(True).get(0).asString())

    seen["replies"] = [
        ask("a1", "robot.goal", "get_status"),
        ask("a2", "robot.goal", "goto", "[1.0, 0.0, 0.0]"),
        ask("a3", "robot.goal", "goto", "[1.0"),
        ask("a4", "robot.goal", "gato", "[]"),
    ]

    motion = port_of(yarp.Port, "/peer/motion")
    assert network.connect("/peer/motion", "/morse/robot/turret/in")
    command = yarp.Bottle()
    command.addFloat64(0.5)
    motion.write(command)
    answer, empty = yarp.Bottle(), yarp.Bottle()
    seen["replied"] = [motion.write(command, answer), answer.size() == empty.size()]
    seen["disconnected"] = [network.disconnect(names[0], "/peer/pose"), network.isConnected(names[0], "/peer/pose")]
    print(json.dumps(seen))
    sys.stdout.flush()
    yarp.Network.fini()


main()
