"""Images in another encoding than that of their camera, as options of the stream select."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseMiddlewareError
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.kinds import BoundKind
    from morse.rosmsgs.table import Carrier

    #: pixels and their encoding, converted
    Form = Callable[[Any, str], tuple[Any, str]]

#: order of the channels of an encoding, in pixels of red, green, blue, alpha
_ORDERS = {"rgb8": (0, 1, 2), "rgba8": (0, 1, 2, 3), "bgr8": (2, 1, 0), "bgra8": (2, 1, 0, 3)}
_COLOURS = ("rgb8", "rgba8")
#: luma of red, green and blue (ITU-R BT.601)
_LUMA = (0.299, 0.587, 0.114)
_MILLIMETRE, _FARTHEST = 1000.0, 65535


def form_of(stream: Carrier, bound: BoundKind) -> Form | None:
    """The conversion of the images of a stream; None for the images as they are.

    Raises:
        MorseMiddlewareError: the component has no images for an option of the stream.
    """
    options = stream.kwargs
    encoding, depth16 = options.get("encoding"), options.get("depth16", False)
    if not encoding and not depth16:
        return None
    own, unit = _own(bound)
    if encoding and own not in _COLOURS:
        raise MorseMiddlewareError(
            f"{stream.component_name}: encoding='{encoding}' converts colours, and these images are {own}"
            + ("; for whole millimetres, set depth16=True" if own == "32FC1" and unit == "m" else "")
        )
    if depth16 and (own != "32FC1" or unit != "m"):
        raise MorseMiddlewareError(
            f"{stream.component_name}: depth16=True converts depth in metres, and these images are {own}"
        )
    if depth16:
        return _millimetres
    return lambda pixels, own: (_coloured(pixels, own, str(encoding)), str(encoding))


def encoding_of(stream: Carrier, bound: BoundKind) -> tuple[str, str | None]:
    """The encoding of the images of a stream after their conversion, and the unit of the component's pixels."""
    (own, unit), options = _own(bound), stream.kwargs
    return "16UC1" if options.get("depth16") else str(options.get("encoding") or own), unit


def _own(bound: BoundKind) -> tuple[Any, Any]:
    """The encoding and the unit of the images of a component."""
    words = {slot.name: source.get(bound.component) for slot, source in bound.sources if slot.name != "pixels"}
    return words.get("encoding"), words.get("unit")


def _millimetres(pixels: Any, _encoding: str) -> tuple[object, str]:
    """Depth in mm, 0 where it is not known (REP 118)."""
    depth = np.rint(pixels * _MILLIMETRE)
    valid = (depth >= 0.0) & (depth <= _FARTHEST)  # false for NaN and infinity
    return np.where(valid, depth, 0.0).astype(np.uint16), "16UC1"


def _coloured(pixels: Any, own: str, encoding: str) -> Any:
    if encoding == "mono8":
        return np.rint(matmul(pixels[..., :3], np.array(_LUMA))).astype(np.uint8)
    order = _ORDERS[encoding]
    if len(order) > pixels.shape[-1]:
        opaque = np.full((*pixels.shape[:-1], 1), 255, np.uint8)
        pixels = np.concatenate([pixels, opaque], axis=-1)
    return np.ascontiguousarray(pixels[..., list(order)])
