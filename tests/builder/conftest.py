from pathlib import Path

import pytest

from script_fixtures import _fresh_builder, load  # noqa: F401 (fixtures)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """The source folder of a project with the component ``sonars.sonar.Sonar``."""
    package = tmp_path / "src" / "sonars"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "sonar.py").write_text(
        "from morse.core.sensor import Sensor\n"
        "from morse.core.declarations import BuilderDefaults, Visual\n"
        "from morse.helpers.components import add_data, add_level, add_property\n"
        "class Sonar(Sensor):\n"
        "    _name = 'Sonar'\n"
        "    _short_desc = 'Measures a distance by sound'\n"
        "    _builder = BuilderDefaults(frequency=12.0, properties={'Range': 4.0},\n"
        "                               visual=Visual('cylinder', (0.1, 0.1, 0.2), (1.0, 0.0, 0.0)))\n"
        "    add_level('near', None, doc='short range', default=True)\n"
        "    add_level('far', None, doc='long range')\n"
        "    add_data('distance', 0.0, 'float', 'Distance', unit='m')\n"
        "    add_property('_range', 2.0, 'Range', 'float', 'Largest distance, m')\n"
        "    add_property('_mode', 'single', 'Mode', 'string', 'single or continuous')\n"
    )
    (package / "builder.py").write_text(
        "from morse.builder.creator import SensorCreator\n"
        "class Sonar(SensorCreator):\n"
        "    _classpath = 'sonars.sonar.Sonar'\n"
        "    _blendname = 'sonar'\n"
        "    def __init__(self, name=None):\n"
        "        SensorCreator.__init__(self, name)\n"
    )
    return tmp_path / "src"
