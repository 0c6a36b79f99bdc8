"""The models that can be added to a scene, with pictures: ``python -m morse.launch.model_pictures FOLDERS SOURCES``.

The arguments are the folders of models and of packages of the project, each a list in JSON.

A process of its own draws them, so that a running simulation does not wait. Each line that it writes is a JSON value:
the first one has the models that are known without their files, the second one lists all models, each other one has the
picture of one model. What the classes of a project print goes to the standard error. Pictures are kept in the cache of
the user.
"""

from __future__ import annotations

import base64
import contextlib
import hashlib
import inspect
import io
import json
import logging
import math
import os
import re
import sys
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
import numpy as np

from morse.assets import find, load, search
from morse.assets.cache import Cache
from morse.builder.components.robot import Robot
from morse.builder.components.solids import BlenderObject
from morse.builder.creator import ComponentCreator
from morse.builder.names import catalog
from morse.builder.own_classes import own_classes
from morse.core.classes.project_imports import ProjectImports
from morse.core.declarations import data_fields, kinds
from morse.core.reports.printing import echo
from morse.scene.extent import visible_extent
from morse.system.workers import own_output
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path


SIZE = (144, 108)
#: m between two models of one scene
_SPACING = 60.0
#: models that are drawn by one simulation
_TOGETHER = 12
#: direction from which models are seen, and the Euler angles of a camera that looks along it
_FROM = (0.75, -0.95, 0.6)
_ROTATION = (math.acos(_FROM[2] / math.hypot(*_FROM)), 0.0, math.atan2(_FROM[0], -_FROM[1]))
#: bases of others, and frames, which nobody sees
_NO_SOLIDS = ("Mesh", "Empty", "Coordsys")
_ON_ROBOTS = ("sensors", "actuators")
#: m; larger parts of worlds are grounds and buildings
_LARGEST_PART = 5.0
#: names that a program gave, such as v1.node10.visual, say nothing to people; Door.L does
_NO_WORDS = re.compile(r"\.(?![LMR]$)|^origin$", re.IGNORECASE)
#: what people say for words of descriptions
_SYNONYMS = {
    "drive": "wheels wheel move motion steer speed velocity go",
    "laser": "lidar scanner range scan distance obstacle",
    "ray": "lidar distance obstacle",
    "distance": "range sonar obstacle proximity",
    "camera": "eye see image picture photo video vision",
    "image": "camera eye picture",
    "pose": "position where location place localization ground truth",
    "position": "location place where",
    "imu": "inertial acceleration gyroscope orientation",
    "accelerometer": "acceleration inertial",
    "gyroscope": "angle orientation heading tilt",
    "magnetometer": "compass heading north",
    "barometer": "pressure altitude height",
    "armature": "arm manipulator joint robot-arm",
    "arm": "manipulator joint",
    "gripper": "hand grasp pick hold claw",
    "collision": "touch bump contact",
    "bumper": "touch contact collision",
    "keyboard": "keys arrows drive teleop wasd",
    "gamepad": "joystick drive teleop controller",
    "quadrotor": "drone uav copter multirotor fly flying",
    "rotorcraft": "drone uav quadrotor helicopter fly",
    "helicopter": "uav fly rotorcraft",
    "submarine": "underwater auv rov boat",
    "person": "human people pedestrian man",
    "human": "person people pedestrian walk",
    "lamp": "light headlight torch",
    "lights": "led lamp",
    "loudspeaker": "sound speaker audio noise",
    "temperature": "heat thermal thermometer",
    "battery": "energy charge power",
    "waypoint": "navigate goto goal target path",
    "destination": "navigate goto goal target",
    "path": "trajectory route",
    "gps": "satellite gnss latitude longitude",
    "odometry": "encoder ticks travelled distance",
    "encoders": "odometry wheel ticks",
    "vehicle": "car truck jeep",
    "cube": "box block wall obstacle",
    "sphere": "ball",
    "cylinder": "post pillar column",
}
_cache = Cache("pictures", 2000)


class Model(NamedTuple):
    """A model that can be added.

    Attributes:
        kind: as for the service ``spawn``, or the name of a sensor class.
        name: for people.
        group: ``robots``, ``sensors``, ``actuators``, or the name of the file.
        doc: what it is, in a sentence.
        words: more words by which people look for it.
    """

    kind: str
    name: str
    group: str
    doc: str = ""
    words: str = ""


def models(sources: Sequence[str] = ()) -> list[Model]:
    """All robots, components and objects of models, those of the project included.

    Args:
        sources: folders of packages of the project.
    """
    known = described(sources)
    return [*known, *objects({item.name for item in known})]


def described(sources: Sequence[str] = ()) -> list[Model]:
    """The robots, components and solids: what is known without the files of the models."""
    from morse import builder

    own = own_classes(sources)
    items: list[Model] = []
    for group in ("robots", *_ON_ROBOTS):
        entries = catalog.components(f"morse.{group}")
        items += [Model(kind, name, group) for kind, name in own if kind.rpartition(":")[0].endswith(f".{group}")]
        for name in (*getattr(builder, group).__all__, *_of_plugins(group)):
            cls = getattr(builder, name)
            if _is_component(cls, group):
                items.append(Model(name, name, group, *described_class(cls, entries.get(name))))
    for name in builder.__all__:
        cls = getattr(builder, name)
        if isinstance(cls, type) and issubclass(cls, BlenderObject) and name not in _NO_SOLIDS:
            doc = (inspect.getdoc(cls) or "").partition("\n")[0]
            items.append(Model(name, name, "solids, lamps and cameras", doc, _SYNONYMS.get(name.lower(), "")))
    return items


def objects(names: Iterable[str]) -> list[Model]:
    """The objects of props, and those of worlds that have other names than these and the given ones."""
    items: list[Model] = []
    for name in search.available("props"):
        items += _objects(name, "props")
    labels = {*names, *(item.name for item in items)}
    for name in search.available("environments"):
        parts = [part for part in _objects(name, "environments") if part.name not in labels]
        labels |= {part.name for part in parts}
        items += parts
    return items


def _objects(name: str, category: str) -> list[Model]:
    """The objects of a model, which are read from its file only if that has changed."""
    path = find(name, category)
    if path.is_relative_to(search.component_dirs()[0]):
        name = f"{category}/{name}"
    elif category != "props" or ("/" not in name and "." not in name):
        return []  # a model of the project belongs to no category
    key = _hashed(f"objects of {category} {name}", path)
    if kept := _cache.get(key, 1 << 20):
        with contextlib.suppress(msgspec.MsgspecError):
            return msgspec.json.decode(kept, type=list[Model])
    models = [*_read_objects(path, name, category)]
    _cache.put(key, msgspec.json.encode(models))
    return models


def _read_objects(path: Path, name: str, category: str) -> Iterator[Model]:
    """The objects of a file; of a world, one of each kind, without its ground and its buildings."""
    kinds: set[str] = set()
    for root in load(path).roots:
        corners = visible_extent(root)
        if corners is None or root.name.startswith("_"):
            continue
        if category == "environments" and _NO_WORDS.search(root.plain_name):
            continue
        if category == "environments" and (root.plain_name in kinds or max(corners[1] - corners[0]) > _LARGEST_PART):
            continue
        kinds.add(root.plain_name)
        # the first of several chairs is a chair
        label = root.plain_name if category == "environments" else root.name
        yield Model(f"{name}#{root.name}", label.replace("_", " "), path.stem.replace("_", " "))


def _of_plugins(group: str) -> list[str]:
    """The names in the builder of the sensors or actuators of plug-ins."""
    from morse import builder

    names = []
    for name in builder.__all__:
        cls = getattr(builder, name)
        path = (getattr(cls, "_classpath", None) or "") if isinstance(cls, type) else ""
        if group in path.split(".") and not path.startswith(f"morse.{group}."):
            names.append(name)
    return names


def _is_component(cls: object, group: str) -> bool:
    """Whether a name of the builder is a robot or a component that can be added as it is."""
    if not isinstance(cls, type) or cls.__name__ == "FakeRobot":
        return False
    if group == "robots":
        return issubclass(cls, Robot)
    needed = (p for p in inspect.signature(cls).parameters.values() if p.kind < p.VAR_POSITIONAL)
    is_complete = all(p.default is not p.empty for p in needed)
    return issubclass(cls, ComponentCreator) and cls._classpath is not None and is_complete


def described_class(cls: type[Robot | ComponentCreator], entry: catalog.Entry | None) -> tuple[str, str]:
    """What a robot or a component is, in a sentence, and the words of its declaration and their synonyms."""
    doc = (inspect.getdoc(cls) or "").partition("\n")[0] if entry is None else entry.doc
    classpath = cls._classpath if entry is None else entry.classpath
    component = catalog.load_class(str(classpath))
    fields = [f"{name} {field.doc}" for name, field in data_fields(component).items() if name != "timestamp"]
    kinds_of_messages = [one.kind.replace("_", " ") for one in kinds(component)]
    # what it is for stands first
    base = f"drive {_SYNONYMS['drive']} " if getattr(component, "commands_speed", False) else ""
    text = f"{base}{' '.join(kinds_of_messages)} {' '.join(fields)}"
    own = set(re.findall("[a-z]+", f"{text} {doc} {cls.__name__}".lower()))
    own |= {word.lower() for word in re.findall("[A-Z][a-z]+", cls.__name__)}
    return doc, " ".join([text, *(words for word, words in _SYNONYMS.items() if word in own)])


def _part(model: Model) -> Any:
    """What is drawn of a model; a component is on a robot without a body."""
    from morse.builder import FakeRobot
    from morse.builder.assembly.spawning import component_of

    part = component_of(model.kind)
    if model.group not in _ON_ROBOTS:
        return part
    robot = FakeRobot()
    robot.append(part)
    return robot


def drawn(several: list[Model]) -> Iterator[tuple[Model, bytes]]:
    """Models with their pictures (WebP); without those that have nothing to show."""
    from PIL import Image

    from morse.builder import Environment
    from morse.launch.load import load as load_simulation

    parts: list[tuple[Model, Any]] = []
    folders = search.resource_dirs()

    def describe() -> None:
        with search.project_dirs([str(folder) for folder in folders]):
            arrange()

    def arrange() -> None:
        for number, model in enumerate(several):
            part = _part(model)
            part.name = f"model{number}"
            # components reach below the origins of their robots: above the ground
            part.translate(number * _SPACING, 0.0, 2.0 if model.group in _ON_ROBOTS else 0.0)
            parts.append((model, part.scene_node))
        Environment("empty").properties(longitude=0.0, latitude=0.0, altitude=0.0)

    with load_simulation(describe) as simulation:
        for model, node in parts:
            corners = visible_extent(node)
            if corners is None:
                continue
            low, high = corners
            centre = (low + high) / 2
            reach = max(math.dist(high, low), 0.02)
            # small things from farther away, so that nothing is nearer than a camera sees
            away = max(reach, 0.5)
            eye = centre + np.array(_FROM) * away
            place: dict[str, Any] = {"location": tuple(map(float, eye)), "rotation": _ROTATION}
            pixels = simulation.picture(2 * SIZE[0], 2 * SIZE[1], **place, focal_length=38.0 * away / reach)
            stream = io.BytesIO()
            Image.fromarray(pixels).resize(SIZE, Image.Resampling.BOX).save(stream, "WEBP", quality=80)
            yield model, stream.getvalue()


def _key(model: Model) -> str:
    file = find(model.kind.partition("#")[0]) if "#" in model.kind else None
    return _hashed(f"{model.kind} {SIZE}", file)


def _hashed(what: str, file: Path | None) -> str:
    stamp = "" if file is None else f"{file} {file.stat().st_mtime_ns}"
    return hashlib.sha256(f"{__version__} {what} {stamp}".encode()).hexdigest()


def main() -> None:
    """Write the list, then the pictures."""
    pipe = own_output()

    def write(value: object) -> None:
        pipe.write(json.dumps(value).encode() + b"\n")

    folders, sources = map(json.loads, sys.argv[1:])
    with search.project_dirs(folders), ProjectImports(sources):
        # what the pictures of models lack says nothing about the scene, in whose log it would stand
        logging.getLogger().addHandler(logging.NullHandler())
        known = described(sources)
        write({"first": [model._asdict() for model in known]})
        everything = [*known, *objects({model.name for model in known})]
        write([model._asdict() for model in everything])
        missing = []
        for model in everything:
            # a class of the project may have changed
            picture = None if ":" in model.kind else _cache.get(_key(model), 1 << 20)
            if picture is None:
                missing.append(model)
            elif picture:
                write(_message(model, picture))
        if missing and hasattr(os, "nice"):
            os.nice(10)  # the simulation comes first
        for begin in range(0, len(missing), _TOGETHER):
            _draw(missing[begin : begin + _TOGETHER], write)


def _message(model: Model, picture: bytes) -> object:
    return {"kind": model.kind, "picture": base64.b64encode(picture).decode()}


def _draw(several: list[Model], write: Callable[[object], None]) -> None:
    nothing = {model.kind: model for model in several}
    try:
        for model, picture in drawn(several):
            del nothing[model.kind]
            _cache.put(_key(model), picture)
            write(_message(model, picture))
    except Exception as error:  # a model of the user
        if len(several) > 1:
            for model in list(nothing.values()):
                _draw([model], write)
            return
        if not several[0].kind.isidentifier():  # a class of MORSE may need a part that carries it, or arguments
            text = f"{several[0].kind} has no picture: {error}"
            if several[0].group in _ON_ROBOTS:  # it may need parts that only its own robot has
                text = (
                    f"{several[0].kind} has no picture, because it does not work without a robot: {error}".splitlines()[
                        0
                    ]
                )
            echo(text, err=True)
    for model in nothing.values():
        _cache.put(_key(model), b"")


if __name__ == "__main__":
    main()
