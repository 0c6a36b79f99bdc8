"""Checks MessagePack data of unknown origin before they are decoded.

A decoder turns an array that is a key into a tuple. The hashes of tuples of numbers are known to everybody: a small
file could contain a map whose keys have one hash, and each key would be compared with all others.
"""

from __future__ import annotations

_ARRAY, _MAP = "array", "map"
#: sizes of the tokens without a length, bytes
_SIZES = [1] * 256
#: token to what it begins, the width of its length and the number of bytes after the length that do not count
_BEGIN: dict[int, tuple[str, int, int]] = {
    **dict.fromkeys(range(0x80, 0x90), (_MAP, 0, 0)),
    **dict.fromkeys(range(0x90, 0xA0), (_ARRAY, 0, 0)),
    **{0xC4 + step: ("bytes", 1 << step, 0) for step in range(3)},
    **{0xC7 + step: ("extension", 1 << step, 1) for step in range(3)},
    **{0xD9 + step: ("text", 1 << step, 0) for step in range(3)},
    **{0xDC + step: (_ARRAY, 2 << step, 0) for step in range(2)},
    **{0xDE + step: (_MAP, 2 << step, 0) for step in range(2)},
}
_SIZES[0xA0:0xC0] = range(1, 33)
_SIZES[0xCA:0xD9] = [5, 9, 2, 3, 5, 9, 2, 3, 5, 9, 3, 4, 6, 10, 18]
for _token in _BEGIN:
    _SIZES[_token] = 0


def check_keys(data: bytes, begin: int = 0) -> None:
    """Raise an error if a key of a map is an array or a map.

    Args:
        data: MessagePack data; other damage is left to the decoder.
        begin: where they begin.

    Raises:
        ValueError: there is such a key.
        LookupError: the data end too early.
    """
    place = begin
    outer: list[tuple[int, bool]] = []
    left, in_map = 1, False
    while True:
        while not left:
            if not outer:
                return
            left, in_map = outer.pop()
        left -= 1
        token = data[place]
        if size := _SIZES[token]:
            place += size
            continue
        kind, width, more = _BEGIN[token]
        place += 1 + width
        length = int.from_bytes(data[place - width : place], "big") if width else token & 0x0F
        if kind not in (_ARRAY, _MAP):
            place += length + more
            continue
        # key and value alternate
        if in_map and left % 2:
            raise ValueError(f"a key is not a text, but {'an array' if kind is _ARRAY else 'a map'}")
        outer.append((left, in_map))
        left, in_map = length * (2 if kind is _MAP else 1), kind is _MAP
