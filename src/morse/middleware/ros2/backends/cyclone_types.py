"""Types of messages for Cyclone DDS.

Samples contain bytes that are already encoded: encoding an image field by field is some hundred times slower.
"""

from __future__ import annotations

import dataclasses
import types
from functools import cache
from typing import Any

from cyclonedds import idl
from cyclonedds.idl import types as dds

from morse.rosmsgs.definitions import SEQUENCE, SINGLE, fields_of


@cache
def sample_type(type_name: str) -> type[Any]:
    """The type of the samples of a topic: `data` contains an encoded message with its header.

    The description of the type, which other participants may compare with their own, has all fields.
    """
    fields = _described(type_name)

    class Sample(fields):  # type: ignore[valid-type, misc]
        __slots__ = ("data", "sample_info")
        data: bytes

        def __init__(self) -> None:
            """Leave all fields unset: see `data`."""

        def serialize(self, *_args: object, **_options: object) -> bytes:
            return self.data

        @classmethod
        def deserialize(cls, data: bytes, *_args: object, **_options: object) -> Any:
            sample = cls()
            sample.data = data
            return sample

        deserialize_key = deserialize

    Sample.__idl__ = fields.__idl__
    return Sample


@cache
def _described(type_name: str) -> type[Any]:
    package, _, name = type_name.partition("/msg/")
    annotations = {field.name: _type(field.type, field.size) for field in fields_of(type_name)}
    new_type: type = types.new_class(
        f"{name}_",
        (idl.IdlStruct,),
        {"typename": f"{package}::msg::dds_::{name}_"},
        lambda namespace: namespace["__annotations__"].update(annotations),
    )
    return dataclasses.dataclass(new_type)


def _type(name: str, size: int) -> Any:
    item: object = {"string": str, "bool": bool}.get(name)
    if item is None:
        item = getattr(dds, name, None) or _described(name)
    if size == SINGLE:
        return item
    return dds.sequence[item] if size == SEQUENCE else dds.array[item, size]
