"""Loads files, each in a process of its own with limits of processor time and memory.

A program: ``python court.py SECONDS BYTES PLACE``; names of files come on the standard input, one a line. For each, a
line of JSON is written. Processes are forked from one that has imported everything, so that a file takes no time but
its own.
"""

import json
import os
import resource
import sys
import warnings
from typing import Any

#: a second of processor time more, before the system ends a process
_SPARE = 1


def judge(path: str, seconds: int, most: int) -> dict[str, Any]:
    """Load a file in a child process."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + _SPARE))
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        answer = load(path)
        with os.fdopen(write, "w") as out:
            out.write(answer)
        os._exit(0)
    os.close(write)
    with os.fdopen(read) as answers:
        answer = answers.read()
    _, status, usage = os.wait4(child, 0)
    return {
        "answer": answer, "signal": os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0,
        "seconds": usage.ru_utime + usage.ru_stime, "memory": usage.ru_maxrss << 10,
    }  # fmt: skip


def load(path: str) -> str:
    """Load a model as the environment of a scene, or as its robot; returns what the user would see."""
    from morse import load as morse_load
    from morse.builder import Environment, Robot

    def scene() -> None:
        if path.endswith((".urdf", ".xml")):
            hostile = Robot(path)
            hostile.translate(0.0, 0.0, 2.0)
            Environment("empty")
        else:
            Environment(path)

    try:
        if path.endswith((".mcap", ".state")):
            return read(path)
        with morse_load(scene) as simulation:
            simulation.step(2)
        return "loaded"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"


def read(path: str) -> str:
    """Read a recording or a saved state as ``morse replay`` does."""
    from morse.launch.recorded_run import inputs_of
    from morse.recording.made.reading import RecordedMade
    from morse.recording.recording import Recording
    from morse.simulation.states.state import State

    if path.endswith(".state"):
        State.read(path)
        return "loaded"
    with Recording(path) as recording:
        recording.length()
        for _ in recording:
            pass
        RecordedMade(recording, tuple, exact=True).check()
        inputs_of(recording)
    return "loaded"


def main() -> None:
    """Judge the files."""
    seconds, most = int(sys.argv[1]), int(sys.argv[2])
    # what a first load imports and caches
    import collada  # noqa: F401
    import mujoco  # noqa: F401
    import PIL.Image
    import trimesh.exchange.load  # noqa: F401

    PIL.Image.init()
    warnings.simplefilter("ignore")
    first = sys.argv[3]
    load(first)
    for line in sys.stdin:
        print(json.dumps(judge(line.strip(), seconds, most)), flush=True)


if __name__ == "__main__":
    main()
