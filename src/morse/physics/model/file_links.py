"""Constraints and pairs of shapes of an MJCF file whose bodies are different objects of the scene.

A weld between a hand and a body that shows where it is to go is an example. What joins the bodies of one robot comes
with the robot.
"""

from __future__ import annotations

from itertools import zip_longest
from typing import TYPE_CHECKING

import mujoco

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.physics.model.file_models import Part

_WELD, _TENDON = mujoco.mjtEq.mjEQ_WELD, mujoco.mjtEq.mjEQ_TENDON
_BODY, _SITE = mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_SITE
_OF_PAIRS = ("condim", "friction", "solref", "solimp", "solreffriction", "margin", "gap")


def add_links(spec: mujoco.MjSpec, parts: Sequence[Part]) -> None:
    """Add what joins the parts of each file.

    Args:
        spec: the model of the scene, to which the parts are attached.
    """
    for together in _of_one_file(parts):
        if len(together) > 1 and any(
            word in text for text in together[0].model.file.texts for word in ("<equality", "<pair", "<exclude")
        ):
            _Links(spec, together).add()


def _of_one_file(parts: Sequence[Part]) -> Iterator[list[Part]]:
    """Return the parts that come from one file; of several robots of a file, the first has the first object of each."""
    files: dict[int, dict[tuple[str, ...], list[Part]]] = {}
    for part in parts:
        files.setdefault(id(part.model.file), {}).setdefault(part.model.tops, []).append(part)
    for by_tops in files.values():
        for together in zip_longest(*by_tops.values()):
            yield [part for part in together if part is not None]


class _Links:
    def __init__(self, spec: mujoco.MjSpec, parts: list[Part]) -> None:
        self._spec = spec
        self._source = parts[0].model.file.spec()
        self._prefixes = {name: part.prefix for part in parts for name in part.model.links.values()}

    def add(self) -> None:
        data = None
        for number, equality in enumerate(self._source.equalities):
            places = [self._of_element(equality, name) for name in (equality.name1, equality.name2)]
            if equality.type == _TENDON or not self._is_between(places):
                continue
            data = self._source.compile().eq_data if data is None else data
            self._spec.add_equality(
                name=f"{places[0]}{equality.name or number}",
                type=equality.type,
                objtype=equality.objtype,
                name1=places[0] + equality.name1,
                name2=places[1] + equality.name2,
                # without a relative pose, that of the file
                data=data[number] if equality.type == _WELD else equality.data,
                active=equality.active,
                solref=equality.solref,
                solimp=equality.solimp,
            )
        for pair in self._source.pairs:
            geoms = [self._source.geom(name) for name in (pair.geomname1, pair.geomname2)]
            places = [None if geom is None else self._prefixes.get(geom.parent.name) for geom in geoms]
            if self._is_between(places):
                copy = self._spec.add_pair(geomname1=places[0] + geoms[0].name, geomname2=places[1] + geoms[1].name)
                for name in _OF_PAIRS:
                    setattr(copy, name, getattr(pair, name))
        for pair in self._source.excludes:
            places = [self._prefixes.get(name) for name in (pair.bodyname1, pair.bodyname2)]
            if self._is_between(places):
                self._spec.add_exclude(bodyname1=places[0] + pair.bodyname1, bodyname2=places[1] + pair.bodyname2)

    def _of_element(self, equality: mujoco.MjsEquality, name: str) -> str | None:
        """The prefix of the part to which one of the two elements of a constraint belongs."""
        if equality.objtype == _BODY and equality.type in (_WELD, mujoco.mjtEq.mjEQ_CONNECT):
            return self._prefixes.get(name)
        element = self._source.site(name) if equality.objtype == _SITE else self._source.joint(name)
        return None if element is None else self._prefixes.get(element.parent.name)

    @staticmethod
    def _is_between(places: Sequence[str | None]) -> bool:
        return None not in places and len(set(places)) == 2
