"""Images are bit-identical with any number of threads, with each build of the kernel, and without the kernel."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from morse.kernel import loading, targets

PROGRAM = """
import hashlib, math, sys
sys.path.insert(0, sys.argv[1])
import numpy as np
from studio import Studio, Tripod, box, floor
from morse.rendering import DistortedLens, Lens
from morse.rendering.flow import moment_of, optical_flow
from morse.rendering.picture import Chip, exposed
studio = Studio(floor(half=2.0), box("A", (3, 0.4, 0.5), (0.5, 0.5, 0.5), rotation=(0.2, 0.3, 0.4)),
                box("B", (2, -1, 0.3), (0.2, 0.3, 0.3)))
tripod, before = Tripod((0, 0, 1), (3, 0, 0.4)), None
size = (44, 33) if len(sys.argv) > 2 else (160, 120)
middle = (size[0] / 2, size[1] / 2)
lenses = [
    Lens(*size, 0.8 * size[0], 0.8 * size[0], *middle, 0.1, 20.0),
    DistortedLens(*size, 0.8 * size[0], 0.8 * size[0], *middle, 0.1, 20.0, "plumb_bob", (-0.25, 0.06, 0.001, 0, 0)),
    DistortedLens.of_fisheye_angle(*size, math.radians(200), (0.01, 0, 0, 0), 0.1, 20.0),
]
for lens in lenses:
    digest = hashlib.sha256()
    first = studio.look(Tripod((0.05, 0.1, 1), (3, 0, 0.4)), lens)
    picture = studio.look(tripod, lens)
    random, flaws = np.random.default_rng(3), np.random.default_rng(4)
    made = exposed(Chip(500.0, 0.01, 0.01), picture.rgb, random, flaws)
    flow = optical_flow(picture, lens, moment_of(first))
    for array in (picture.rgb, picture.depth, picture.ids, made, np.nan_to_num(flow)):
        digest.update(np.ascontiguousarray(array).tobytes())
    assert (picture.ids >= 0).mean() > 0.2
    print(digest.hexdigest())
"""


def digests(*small, **variables):
    words = [sys.executable, "-c", PROGRAM, str(Path(__file__).parent), *small]
    made = subprocess.run(words, env={**os.environ, **variables}, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr[-2000:]
    return made.stdout.split()


@pytest.fixture(scope="module")
def levels():
    """The builds that this machine can run."""
    host = targets.host()
    if host is None:
        pytest.skip("the kernel was not built: python -m morse.kernel.build")
    best = loading.load(host, host.levels[0]).morse_processor_level()
    return [level for level in host.levels if not level or level <= best]


def test_threads_and_builds_and_processes(levels):
    choices = [{"MORSE_KERNEL": f"v{level}"} for level in levels] if levels != [0] else [{}]
    found = [digests(**choice, MORSE_THREADS=threads) for choice in choices for threads in ("1", "2")]
    assert len(found[0]) == 3
    assert all(one == found[0] for one in found)
