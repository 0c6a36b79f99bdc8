"""Models of robots, things and environments: where their files are, and what is in them."""

from morse.assets.formats import SUFFIXES, UnsupportedFormatError
from morse.assets.loader import instantiate, load
from morse.assets.search import AssetNotFoundError, find

__all__ = ["SUFFIXES", "AssetNotFoundError", "UnsupportedFormatError", "find", "instantiate", "load"]
