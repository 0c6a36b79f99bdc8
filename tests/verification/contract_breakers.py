"""Components that each violate one rule of the contract, and one that violates none."""

# ruff: noqa: E501

SOUND = '''
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.helpers.components import add_data, add_property


class Sonar(Sensor):
    """Distance to the wall."""

    _name = "Sonar"

    add_data("distance", 0.0, "float", "To the echo", unit="m", low=0.0)
    add_property("_gain", 1.0, "Gain", "float", "Factor of the distance", low=0.0, high=10.0)

    @service
    def double(self, value: float) -> float:
        """Twice a number."""
        return 2.0 * value

    def default_action(self):
        self.local_data["distance"] = self._gain * abs(self.position_3d.x)
'''


def changed(*pairs):
    """The valid component with some lines replaced."""
    text = SOUND
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


_DISTANCE = '"To the echo", unit="m", low=0.0'
_ACTION = 'self.local_data["distance"] = self._gain * abs(self.position_3d.x)'
#: rule, the text of a file, and the line of the file in the report, if there is one
BREAKERS = {
    "unit": ("data are declared", changed((_DISTANCE, '"To the echo"')), '"distance", 0.0'),
    "frame": ("data are declared", changed(('"distance"', '"x"'), (", low=0.0)\n    add_p", ")\n    add_p")), '"x", 0.0'),
    "shape": (
        "data are declared",
        changed(("def double", "def double"), ("    add_property", '    add_data("v", [0.0, 1.0], "list", "V", unit="m")\n    add_property')),
        'add_data("v"',
    ),
    "doc": ("documented", changed(('"To the echo"', '""')), '"distance", 0.0'),
    "service doc": ("documented", changed(('        """Twice a number."""\n', "")), "def double"),
    "property doc": ("documented", changed(('"Factor of the distance"', '""')), '"_gain"'),
    "range": ("data fit their declarations", changed((_ACTION, 'self.local_data["distance"] = -1.0')), '"distance", 0.0'),
    "type": ("data fit their declarations", changed((_ACTION, 'self.local_data["distance"] = "far"')), '"distance", 0.0'),
    "undeclared": ("data fit their declarations", changed((_ACTION, 'self.local_data["echo"] = 1.0')), "class Sonar"),
    "raises": ("data fit their declarations", changed((_ACTION, "1 / 0")), "class Sonar"),
    "no JSON": ("data are JSON", changed((_ACTION, 'self.local_data["distance"] = object()')), "class Sonar"),
    "NaN": ("data are JSON", changed((_ACTION, 'self.local_data["distance"] = float("nan")')), '"distance", 0.0'),
    "random": (
        "deterministic under a seed",
        changed((_ACTION, 'import random; self.local_data["distance"] = random.random()')),
        "class Sonar",
    ),
    "unsaved": (
        "saved and restored",
        changed((_ACTION, 'self._file = open(__file__); self._file.close()')),
        "class Sonar",
    ),
    "hidden state": (
        "saved and restored",
        changed(("    def default", "    not_state = ('_n',)\n    _n = 0\n\n    def default"),
                (_ACTION, 'self._n += 1; self.local_data["distance"] = float(self._n)')),
        "class Sonar",
    ),
    "state of the class": (
        "a reset makes it new",
        changed(("    def default", "    count = []\n\n    def default"),
                (_ACTION, 'self.count.append(1); self.local_data["distance"] = float(len(self.count))')),
        "class Sonar",
    ),
    "brittle property": (
        "survives bad calls",
        changed((", low=0.0, high=10.0", ""), (_ACTION, 'self.local_data["distance"] = 1e-300 ** self._gain if self._gain < 0 else 0.0')),
        '"_gain"',
    ),
    "brittle service": (
        "survives bad calls",
        changed(("value: float", "value"), ("return 2.0 * value", "return value.real")),
        "def double",
    ),
    "no robot": ("can be put on a robot", SOUND + "\n    def __init__(self, obj, parent=None):\n        raise OSError('no')\n", ""),
}  # fmt: skip

BRITTLE_ACTUATOR = '''
from morse.core.actuator import Actuator
from morse.helpers.components import add_data


class Divider(Actuator):
    """Divides by what it is told."""

    _name = "Divider"

    add_data("number", 1.0, "float", "What to divide by", unit="m")

    def default_action(self):
        1.0 / self.local_data["number"]
'''
