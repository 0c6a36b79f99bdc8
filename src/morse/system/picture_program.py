"""The program that decodes pictures whose headers do not tell the cost: ``python -m morse.system.picture_program``.

A small TIFF file can contain gigabytes of tags, a GIF comments that take quadratic time; JPEG 2000 takes 130 ns for a
pixel. The question is the content of a file, the answer a byte 1 and the same picture as PNG (or TIFF, which has more
kinds of pixels), or a byte 0 and the reason in UTF-8.
"""

from __future__ import annotations

import io

from morse.system.pictures import load_readers, opened
from morse.system.regular_files import MOST_MEMORY, MOST_SECONDS
from morse.system.workers import Server, limit_resources, serve_program

#: pixels of a picture
_MOST_PIXELS = 1 << 26
#: modes that a PNG file has, and those of numbers, which are heights
_PNG, _TIFF = ("1", "L", "LA", "I;16", "P", "RGB", "RGBA"), ("I", "F", "I;16B")


class Decoder(Server):
    """Decodes pictures."""

    def answer(self, question: bytes) -> bytes:
        """Decode a picture."""
        try:
            with opened(question) as picture:
                if picture.width * picture.height > _MOST_PIXELS:
                    raise ValueError(f"it has {picture.width} x {picture.height} pixels, more than {_MOST_PIXELS}")
                picture.load()
                plain = picture
                if picture.mode not in (*_PNG, *_TIFF):
                    plain = picture.convert("RGBA" if "A" in picture.getbands() else "RGB")
                for name in ("icc_profile", "exif", "xmp", "comment"):
                    plain.info.pop(name, None)
                result = io.BytesIO()
                if plain.mode in _TIFF:
                    plain.save(result, "TIFF")
                else:
                    plain.save(result, "PNG", compress_level=1)
                return b"\1" + result.getvalue()
        except Exception as error:  # Pillow's readers raise many kinds of errors for damaged pictures
            return b"\0" + f"{error!s:.100}".encode()


def main() -> None:
    """Decode the pictures of the process that has started this one."""
    load_readers()
    limit_resources(MOST_SECONDS, MOST_MEMORY)
    serve_program(Decoder, watches=False)


if __name__ == "__main__":
    main()
