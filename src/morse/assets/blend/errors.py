"""Errors of ``.blend`` files."""

from __future__ import annotations

from morse.assets.errors import AssetError


class BlendError(AssetError):
    """A ``.blend`` file cannot be read at all."""


class Excess(Exception):
    """Reading the file would take longer than for any real scene; it is not read further."""


class Damage(Exception):
    """A part of the file is inconsistent; the caller decides what is left out."""
