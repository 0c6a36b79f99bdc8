"""Errors of model files."""

from __future__ import annotations

from pathlib import Path


class AssetError(ValueError):
    """A model file cannot be used.

    Attributes:
        path: the file.
        message: one sentence for the user that describes the error.
    """

    def __init__(self, path: str | Path, message: str) -> None:
        super().__init__(f"{path}: {message}")
        self.path = Path(path)
        self.message = message
