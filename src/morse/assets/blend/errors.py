"""What goes wrong with ``.blend`` files."""

from __future__ import annotations

from morse.assets.errors import AssetError


class BlendError(AssetError):
    """A ``.blend`` file cannot be read at all."""


class Excess(Exception):
    """The file asks for more time than any scene does; it is not read further."""


class Damage(Exception):
    """A part of the file is inconsistent; the reader of that part decides what is left out."""
