"""A project with its own components, in its own folder."""

import textwrap
from pathlib import Path

import pytest

SENSOR = """
    from morse.builder.creator import SensorCreator
    from morse.core.declarations import add_data
    from morse.core.sensor import Sensor

    ticks = []

    class Counter(Sensor):
        add_data("n", 0, "int", "Ticks of all simulations that share this module")
        add_data("late", 0, "int", "What modules say that are imported in the tick")

        def default_action(self):
            ticks.append(self.clock.tick)
            self.local_data["n"] = len(ticks)
            from mine.later import VALUE
            from . import later
            import mine.deep.inside
            import mine.deep.inside as inside
            from .deep import inside as same
            assert mine.deep.inside is inside is same
            self.local_data["late"] = VALUE + later.VALUE + inside.VALUE
"""

SCENE = """
    import sys
    from morse.builder import *
    from mine.parts import Counter

    robot = ATRV()
    motion, pose, counter = MotionVW(), Pose(), Counter()
    for part in (motion, pose, counter):
        robot.append(part)
    robot.properties(arguments=" ".join(sys.argv[1:]))
    env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Path of a scene script whose robot has a sensor from ``src/mine/parts.py``."""
    package = tmp_path / "src" / "mine"
    (package / "deep").mkdir(parents=True)
    files = {
        package / "__init__.py": "",
        package / "parts.py": SENSOR,
        package / "later.py": "VALUE = 20\n",
        package / "deep" / "__init__.py": "",
        package / "deep" / "inside.py": "VALUE = 2\n",
        tmp_path / "scene.py": SCENE,
    }
    for path, text in files.items():
        path.write_text(textwrap.dedent(text), encoding="utf-8")
    return tmp_path / "scene.py"
