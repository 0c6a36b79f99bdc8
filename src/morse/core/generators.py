"""The state of generators of random numbers as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

_WIDE = 16


def generator_state(generator: np.random.Generator) -> dict[str, Any]:
    """What determines all numbers that a generator of `Context.random` will give."""
    state = generator.bit_generator.state
    return {
        # integers of 128 bits are more than most formats carry
        "state": state["state"]["state"].to_bytes(_WIDE, "little"),
        "increment": state["state"]["inc"].to_bytes(_WIDE, "little"),
        "half_used": int(state["has_uint32"]),
        "half": int(state["uinteger"]),
    }


def set_generator_state(generator: np.random.Generator, state: dict[str, Any]) -> None:
    """Have a generator go on from a state that `generator_state` gave."""
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {
            "state": int.from_bytes(state["state"], "little"),
            "inc": int.from_bytes(state["increment"], "little"),
        },
        "has_uint32": state["half_used"],
        "uinteger": state["half"],
    }
