"""Fingerprints of the state of a simulation, to the bit."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

if TYPE_CHECKING:
    from morse.core.context import Context


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return [str(value.dtype), value.shape, value.tobytes()]
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "__iter__"):
        return list(value)
    return repr(value)


_encoder = msgspec.msgpack.Encoder(enc_hook=_plain)


def fingerprints(context: Context) -> dict[str, str]:
    """SHA-256 of the physics and of the data of every component, by name (``physics`` first)."""
    parts = {"physics": hashlib.sha256(context.world.state().tobytes()).hexdigest()}
    for name, component in {**context.robots, **context.components}.items():
        parts[name] = hashlib.sha256(_encoder.encode(component.local_data)).hexdigest()
    return parts


def state_hash(context: Context) -> str:
    """SHA-256 of everything: tick, physics, and the data of every robot, sensor and actuator."""
    digest = hashlib.sha256(str(context.clock.tick).encode())
    for name, value in fingerprints(context).items():
        digest.update(f"{name}={value};".encode())
    return digest.hexdigest()
