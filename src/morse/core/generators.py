"""The state of generators of random numbers as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

    from morse.core.values import StateData

_WIDE = 16


def generator_state(generator: np.random.Generator) -> dict[str, object]:
    """Return the state that determines all future numbers of a generator from `Context.random`."""
    state = generator.bit_generator.state
    return {
        # most formats cannot carry integers of 128 bits
        "state": state["state"]["state"].to_bytes(_WIDE, "little"),
        "increment": state["state"]["inc"].to_bytes(_WIDE, "little"),
        "half_used": int(state["has_uint32"]),
        "half": int(state["uinteger"]),
    }


def set_generator_state(generator: np.random.Generator, state: StateData) -> None:
    """Restore a state that `generator_state` returned."""
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {
            "state": int.from_bytes(state["state"], "little"),
            "inc": int.from_bytes(state["increment"], "little"),
        },
        "has_uint32": state["half_used"],
        "uinteger": state["half"],
    }
