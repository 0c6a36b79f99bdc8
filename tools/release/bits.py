"""Prints digests of what has the same bits on all machines: images, depths, labels and scans of sensors at rest.

Run as a program by the Python of each machine; the lines are then compared.
"""

from __future__ import annotations

import hashlib
import tempfile
from pathlib import Path

import numpy as np

import morse

SCENE = """
from morse.builder import *
watcher = FakeRobot("watcher")
watcher.translate(-4.0, 1.0, 1.2)
watcher.rotate(z=-0.2)
for camera in (VideoCamera("video"), DepthCamera("depth"), SegmentationCamera("labels")):
    camera.properties(cam_width=160, cam_height=120, cam_far=60.0)
    watcher.append(camera)
watcher.append(Sick("scanner"))
env = Environment("sandbox")
"""
#: the array of each sensor, and the ticks: scans see that moving bodies are rounded by the engine, images do not
FIELDS = {"video": ("image", 2), "depth": ("points", 2), "labels": ("image", 2), "scanner": ("range_list", 1)}


def main() -> None:
    """Print one line for each field and moment."""
    with tempfile.TemporaryDirectory() as temporary:
        script = Path(temporary) / "scene.py"
        script.write_text(SCENE, encoding="utf-8")
        with morse.load(script, seed=1) as sim:
            for moment in range(2):
                sim.step(1 + 29 * moment)
                for name, (field, moments) in FIELDS.items():
                    if moment < moments:
                        value = np.ascontiguousarray(getattr(sim.watcher, name).data[field]).tobytes()
                        print(name, field, moment, hashlib.sha256(value).hexdigest())


if __name__ == "__main__":
    main()
