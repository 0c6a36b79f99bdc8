"""MJCF models as data: the text for the engine, with all files that it requires."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

#: name of the frames in whose place the bodies of other models are attached
MARKER = "attached model "
#: contact parameters of a geom without settings, in the order of `MjcfModel.ground`
DEFAULT_CONTACT = (1.0, 0.005, 0.0001, 0.02, 1.0, 0.9, 0.95, 0.001, 0.5, 2.0, 1.0, 0.0, 0.0, 3.0, 0.0)
#: elements by which a text reads files
_READS_FILES = re.compile(r"<\s*(include|model|plugin)\b")


@dataclass(frozen=True, slots=True)
class AttachedModel:
    """The place of a body of another model.

    Attributes:
        frame: name of the frame in the text; copies that ``replicate`` makes have a suffix.
        text: number of the text of the other model.
        body: its body; empty for all bodies.
        prefix: of the names.
    """

    frame: str
    text: int
    body: str
    prefix: str


@dataclass(frozen=True, slots=True)
class MjcfFile:
    """An MJCF file.

    Attributes:
        texts: the text of the file, then those of the models that it attaches.
        files: name in the texts to the content of the file; other files are not read.
        attached: the places of the attached models, for each text.
        bound: smallest mass, kg, and moment of inertia, kg m^2, of bodies, unless a text says one; 0 for none.
    """

    texts: tuple[str, ...]
    files: dict[str, bytes] = field(default_factory=dict)
    attached: tuple[tuple[AttachedModel, ...], ...] = ()
    bound: float = 0.0

    def spec(self) -> Any:
        """Return the `mujoco.MjSpec` of the file, in which every body, joint, geom, actuator and mesh has a name.

        Raises:
            ValueError: the text is not MJCF, or names a file that is not part of the model.
        """
        return self._spec(0, 0)

    def _spec(self, number: int, depth: int) -> Any:
        import mujoco

        text = self.texts[number]
        if _READS_FILES.search(text) or depth > 8:
            raise ValueError("the model reads other files")
        spec = mujoco.MjSpec.from_string(text, assets=self.files)
        spec.compiler.boundmass = spec.compiler.boundmass or self.bound
        spec.compiler.boundinertia = spec.compiler.boundinertia or self.bound
        for asset in (*spec.meshes, *spec.hfields, *spec.textures):
            if asset.file and asset.file not in self.files:
                raise ValueError(f"the model reads the file {asset.file!r}")
        # the options of attached models do not apply
        spec.option = mujoco.MjSpec().option if number else spec.option
        for one in self.attached[number] if self.attached else ():
            for frame in [frame for frame in spec.frames if frame.name.startswith(one.frame)]:
                suffix = frame.name.removeprefix(one.frame)
                other = self._spec(one.text, depth + 1)
                if one.body:
                    frame.attach_body(other.body(one.body), one.prefix, suffix)
                else:
                    spec.attach(other, frame=frame, prefix=one.prefix, suffix=suffix)
        if number == 0:
            name_all(spec)
        return spec


@dataclass(frozen=True, slots=True)
class MjcfModel:
    """The part of an MJCF file that becomes one robot or object.

    Attributes:
        tops: its bodies below the world; ``world`` stands for the shapes of the world.
        base: the body with the free joint, or empty.
        links: name of a node in the model to the name of the body.
        shapes: name of a node in the model to the name of the geom.
        step: time step of the file, s.
        motors: name of a joint to the name of its actuator, if that is a motor for a position, a velocity or an effort.
        ground: friction (3), ``solref`` (2), ``solimp`` (5), ``solmix``, ``margin``, ``gap``, ``condim`` and
            ``priority`` of the plane that is the floor of the file, or of a plane without settings.
        is_joined: whether a constraint of the file joins it with another part.
        flexes: name of a node in the model to the name of the deformable body (flex).
        has_floor: whether the file has a plane that is the floor, on which its robot is placed.
        floors: names of the nodes of level planes below height 0, in a file without one at height 0.
    """

    file: MjcfFile
    tops: tuple[str, ...]
    base: str = ""
    links: dict[str, str] = field(default_factory=dict)
    shapes: dict[str, str] = field(default_factory=dict)
    step: float = 0.002
    motors: dict[str, str] = field(default_factory=dict)
    ground: tuple[float, ...] = DEFAULT_CONTACT
    is_joined: bool = False
    has_floor: bool = False
    floors: tuple[str, ...] = ()
    flexes: dict[str, str] = field(default_factory=dict)


def name_all(spec: Any) -> None:
    """Name the elements of a `mujoco.MjSpec` that have no names: ``body3``, ``joint0`` ..."""
    for word, elements in (
        ("body", spec.bodies),
        ("joint", spec.joints),
        ("geom", spec.geoms),
        ("actuator", spec.actuators),
        ("camera", spec.cameras),
        ("site", spec.sites),
    ):
        names = {element.name for element in elements}
        for number, element in enumerate(elements):
            if not element.name:
                name = f"{word}{number}"
                while name in names:
                    name += "_"
                names.add(name)
                element.name = name
