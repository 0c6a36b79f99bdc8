"""The structures of a saved state of the physics, used to validate plain data."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta, Struct

#: version of the format; states of other versions are refused
VERSION = 3

Vector3 = tuple[float, float, float]
Quaternion4 = tuple[float, float, float, float]
Rotation9 = tuple[float, float, float, float, float, float, float, float, float]
Array = np.ndarray
_Ticks = Annotated[int, Meta(ge=-1, le=2**62)]


class _Part(Struct, forbid_unknown_fields=True):
    """A part of a state; angles in rad, lengths in m, masses in kg, times in ticks."""


class SavedPose(_Part):
    """The pose of a slot that the engine does not move, or that was moved by an explicit call since the last tick."""

    slot: str
    position: Vector3
    rotation: Rotation9
    quaternion: Quaternion4


class SavedStale(_Part):
    """The old pose, still stored in the engine, of a slot that was moved by an explicit call since the last tick."""

    slot: str
    position: Vector3
    quaternion: Quaternion4


class SavedTwist(_Part):
    """The velocity, world axes, of a slot that moves kinematically."""

    slot: str
    linear: Vector3
    angular: Vector3


class SavedCommand(_Part):
    """A velocity command for the next tick; see `morse.physics.driving.command.Command`."""

    slot: str
    linear: Vector3
    angular: Vector3
    shift: bool
    ground: bool


class SavedDrives(_Part):
    """The commands for the next tick, and the slots that slide without friction."""

    commands: list[SavedCommand]
    sliding: list[str]


class SavedGrip(_Part):
    """A slot that is attached to an object."""

    slot: str
    holder: str
    position: Vector3
    rotation: Rotation9


class SavedSuspension(_Part):
    """A slot whose dynamics are suspended."""

    slot: str
    position: Vector3
    rotation: Rotation9


class SavedAttachments(_Part):
    """The held slots, in the order in which they were attached."""

    held: list[SavedGrip]
    suspended: list[SavedSuspension]


class SavedGlide(_Part):
    """A gliding robot; see `morse.physics.gliding.stances.Glide`. ``floor`` is the bit of its floor."""

    slot: str
    floor: int
    up: Vector3
    look: _Ticks
    speed: float
    since: _Ticks
    margin: float


class SavedStand(_Part):
    """The stance of a robot; see `morse.physics.gliding.stances.Stances`."""

    slot: str
    tick: _Ticks
    height: float
    up: Vector3
    wait: _Ticks
    until: _Ticks


class SavedGliding(_Part):
    """The gliding robots and the ticks of their next checks."""

    glides: list[SavedGlide]
    stands: list[SavedStand]
    tick: _Ticks
    look: _Ticks


class SavedLamp(_Part):
    """What may change of a lamp; see `morse.scene.mesh.Light`."""

    color: Vector3
    energy: float
    distance: float
    spot_size: float


class SavedTexture(_Part):
    """A texture; see `morse.scene.mesh.Image`."""

    name: str
    mime: Literal["image/png", "image/jpeg"]
    data: bytes


class SavedObject(_Part, omit_defaults=True):
    """The differences of an object from the scene: properties, looks, pose relative to its parent."""

    properties: dict[str, Any] | None = None
    visible: bool | None = None
    color: tuple[float, float, float, float] | None = None
    texture: SavedTexture | None = None
    lamp: SavedLamp | None = None
    position: Vector3 | None = None
    rotation: Rotation9 | None = None


class SavedEngine(_Part):
    """The values of the engine.

    Attributes:
        integration: MuJoCo's ``mjSTATE_INTEGRATION``.
        asleep: MuJoCo's ``tree_asleep``.
        model: the arrays of the model that change while it runs.
        contacts: (N, 2) geoms in contact.
        forces: whether forces are set for the next tick.
        stirred: whether a body that does not glide was changed by an explicit call.
    """

    integration: Array
    asleep: Array
    model: dict[str, Array]
    contacts: Array
    forces: bool
    stirred: bool


class SavedWorld(_Part):
    """The whole state of a world."""

    version: int
    slots: tuple[str, ...]
    engine: SavedEngine
    placed: list[SavedPose]
    stale: list[SavedStale]
    loose: list[str]
    kinematic: list[SavedTwist]
    objects: dict[str, SavedObject]
    drives: SavedDrives
    attachments: SavedAttachments
    gliding: SavedGliding


def checked(state: object) -> SavedWorld:
    """Convert a state into structures and check that its numbers are finite; names and sizes are not checked.

    Raises:
        ValueError: the state does not have the format of this version; the message names the location.
    """
    if isinstance(state, dict) and state.get("version", VERSION) != VERSION:
        raise ValueError(f"this state has version {state['version']!r}, this MORSE reads version {VERSION}")
    try:
        world = msgspec.convert(state, SavedWorld, dec_hook=_array)
    except (msgspec.ValidationError, TypeError, RecursionError) as error:
        raise ValueError(f"this is not a state of a world: {error}") from None
    assert isinstance(state, dict)
    for name in SavedWorld.__struct_fields__:
        if name != "objects":
            _demand_finite(state[name], f"$.{name}")
    return world


def _array(_kind: type, value: object) -> np.ndarray:
    # arrays are the only type that msgspec does not support
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return value
    raise ValueError(f"expected an array of numbers, got {type(value).__name__}")


def _demand_finite(value: object, path: str) -> None:
    if isinstance(value, dict):
        for key, item in value.items():
            _demand_finite(item, f"{path}.{key}")
    elif isinstance(value, (list, tuple)):
        for number, item in enumerate(value):
            _demand_finite(item, f"{path}[{number}]")
    elif isinstance(value, (float, np.ndarray)) and not np.isfinite(value).all():
        raise ValueError(f"this is not a state of a world: a number is not finite - at `{path}`")
