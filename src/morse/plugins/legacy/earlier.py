"""Classes and forms of MORSE 1.0 to 1.2: components by the names of their files, and class paths as arguments."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

import morse.builder
from morse.assets import search
from morse.builder import actuators, sensors
from morse.builder.creator import ComponentCreator
from morse.builder.environment import Environment
from morse.builder.errors import checks
from morse.builder.workspace import notice
from morse.core.exceptions import MorseBuilderNoComponentError

if TYPE_CHECKING:
    from types import ModuleType

    from morse.builder.components.component import Component

logger = logging.getLogger("morse.builder.script")

__all__ = ["Actuator", "Arm", "Sensor"]

#: names of files of that time that no class of today resembles
_RENAMED = {
    "camera": "VideoCamera",
    "depthvideocamera": "DepthVideoCamera",
    "xywcontrol": "MotionXYW",
    "kukaarm": "KukaLWR",
}


def _class_of(file: str, modules: tuple[ModuleType, ...], what: str) -> str:
    """The class of a component from the name of its file: ``v_omega``, ``kuka_lwr``."""
    plain = checks.text(file, what).rpartition("/")[2].replace("_", "").replace("-", "").lower()
    classes = {name: getattr(module, name) for module in modules for name in module.__all__}
    by_file: dict[str, str] = {}
    for name, cls in classes.items():
        path = str(getattr(cls, "_classpath", None) or "").rpartition(".")[0].rpartition(".")[2]
        if path:
            by_file.setdefault(path, name)
    by_plain_file = {path.replace("_", ""): name for path, name in by_file.items()}
    names = {name.lower(): name for name in classes}
    found = _RENAMED.get(plain) or names.get(plain) or by_plain_file.get(plain)
    if found is None or found not in classes:
        raise MorseBuilderNoComponentError(
            f"{what}: there is no component {checks.shown(file)}{checks.suggestion(file, by_file)}"
        )
    return found


class _Maker:
    """A component by the name of its file: ``Sensor('...')``.

    Args:
        word: its name in scripts.
        modules: modules of the builder with the classes.
    """

    def __init__(self, word: str, modules: tuple[ModuleType, ...]) -> None:
        self.__name__ = self.__qualname__ = self._word = word
        self._modules = modules

    def __call__(self, filename: str | None = None) -> Component:
        """Return a new component."""
        word = self._word
        if filename is None:
            kind = "a sensor" if word == "Sensor" else "an actuator"
            example = {"Sensor": "gps", "Actuator": "v_omega", "Arm": "kuka_lwr"}[word]
            raise MorseBuilderNoComponentError(
                f"{word}() needs the name of {kind}: {word}('{example}'), or write its class, such as "
                f"{_class_of(example, self._modules, word)}()"
            )
        name = _class_of(filename, self._modules, f"{word}(name)")
        old = "|".join(f"{word}({quote}{filename}{quote})" for quote in "'\"")
        notice(f"{word}('{filename}') is a form of MORSE 1.0, write {name}()", old, f"{name}()")
        component: Component = getattr(morse.builder, name)()
        return component

    def __mro_entries__(self, bases: tuple[object, ...]) -> tuple[type, ...]:
        """Refuse to be a base class: the file of a component lacks the import of the base class."""
        raise NameError(f"name '{self._word}' is not defined: from morse.core.{self._word.lower()} import {self._word}")


Actuator = _Maker("Actuator", (actuators,))
Arm = _Maker("Arm", (actuators,))
Sensor = _Maker("Sensor", (sensors,))


def call(owner: object, method: str, arguments: dict[str, object]) -> dict[str, Any]:
    """The arguments of a call in the form of today."""
    if isinstance(owner, ComponentCreator) and method == "__init__":
        return _creator(arguments, f"{getattr(owner, '_kind', '')}s")
    if method == "frequency":
        return _frequency(arguments)
    if isinstance(owner, Environment) and method == "simulator_frequency" and (fps := arguments.pop("fps", None)):
        notice("env.simulator_frequency(fps) is an old name, write base_frequency", "fps", "base_frequency")
        arguments["base_frequency"] = fps
    return arguments


def _creator(arguments: dict[str, object], category: str) -> dict[str, object]:
    """``SensorCreator(name, 'class.path', 'model')``."""
    path = arguments["action"]
    if not isinstance(path, str) or "." not in path:
        return arguments
    model = arguments["blendfile"]
    if isinstance(model, str) and model and not _is_there(model, category):
        # components without a shape of their own had one in files of that time
        logger.warning("there is no model %s any more: the component has no shape", checks.shown(model))
        model = None
    new = {**arguments, "classpath": path, "action": ComponentCreator.USE_BLEND if model else "APPEND_EMPTY"}
    if not model:
        new["blendfile"] = None
    today = f"classpath='{path}'"
    after = f", '{arguments['blendfile']}'" if arguments["blendfile"] else ""
    if model:
        after, today = f", '{model}'", f"action='{ComponentCreator.USE_BLEND}', blendfile='{model}', {today}"
    old = f"'{path}'{after}"
    notice(f"a class path as the second argument is a form of MORSE 1.0, write {today}", f"{old}|{_double(old)}", today)
    return new


def _is_there(model: str, category: str) -> bool:
    try:
        search.find(model, category)
    except search.AssetNotFoundError:
        return False
    return True


def _double(text: str) -> str:
    return text.replace("'", '"')


def _frequency(arguments: dict[str, object]) -> dict[str, object]:
    """``frequency(delay=n)``: n ticks, of 60 in a second, between two actions."""
    delay = arguments.pop("delay", None)
    if delay is not None:
        rate = 60.0 / (checks.integer(delay, "frequency(delay)", minimum=0) + 1)
        if arguments.get("frequency") is None:
            old = f"delay={delay!r}|delay = {delay!r}"
            notice(f"frequency(delay={delay!r}) is a form of MORSE 1.0, write frequency({rate:g})", old, f"{rate:g}")
            arguments["frequency"] = rate
    return arguments
