"""Fingerprints of the state of a simulation, to the bit."""

from __future__ import annotations

import hashlib
import re
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

if TYPE_CHECKING:
    from morse.core.context import Context

#: where an object without a text of its own lies in memory
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return [str(value.dtype), value.shape, value.tobytes()]
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "__iter__"):
        return list(value)
    return _text(value)


def _text(value: Any, around: tuple[int, ...] = ()) -> str:
    """What `repr` says, but without addresses, and sets in an order of their own; data may hold itself."""
    if id(value) in around:
        return "..."
    inside = (*around, id(value))
    if isinstance(value, dict):
        return "{" + ",".join(f"{_text(key, inside)}:{_text(item, inside)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ",".join(_text(item, inside) for item in value) + "]"
    if isinstance(value, (set, frozenset)):
        return "(" + ",".join(sorted(_text(item, inside) for item in value)) + ")"
    return _ADDRESS.sub("", repr(value))


# sets have no order of their own
_encoder = msgspec.msgpack.Encoder(enc_hook=_plain, order="deterministic")


def _fingerprint(data: dict[str, Any]) -> str:
    try:
        encoded = _encoder.encode(data)
    except Exception:  # data of users may hold anything
        encoded = _text(data).encode("utf-8", "surrogatepass")
    return hashlib.sha256(encoded).hexdigest()


def fingerprints(context: Context) -> dict[str, str]:
    """SHA-256 of the physics and of the data of every component, by name (``physics`` first)."""
    parts = {"physics": hashlib.sha256(context.world.state().tobytes()).hexdigest()}
    for name, component in {**context.robots, **context.components}.items():
        parts[name] = _fingerprint(dict(component.local_data))
    return parts


def state_hash(context: Context) -> str:
    """SHA-256 of everything: tick, physics, and the data of every robot, sensor and actuator."""
    digest = hashlib.sha256(str(context.clock.tick).encode())
    for name, value in fingerprints(context).items():
        digest.update(f"{name}={value};".encode())
    return digest.hexdigest()
