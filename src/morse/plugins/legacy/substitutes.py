"""Functions that Python has removed, among them those of the module ``imp``, with the results that old code expects."""

from __future__ import annotations

import importlib.util
import inspect
import platform
import sys
from importlib import reload
from types import ModuleType
from typing import NamedTuple

__all__ = ["distribution", "getargspec", "load_source", "new_module", "reload"]


class ArgSpec(NamedTuple):
    """The result of ``inspect.getargspec``."""

    args: list[str]
    varargs: str | None
    keywords: str | None
    defaults: tuple[object, ...] | None


def getargspec(function: object) -> ArgSpec:
    """The parameters of a function."""
    return ArgSpec(*inspect.getfullargspec(function)[:4])


def distribution(*_args: object, **_kwargs: object) -> tuple[str, str, str]:
    """Name, version and code name of the Linux distribution; empty if unknown."""
    try:
        release = platform.freedesktop_os_release()
    except OSError:
        return ("", "", "")
    return (release.get("NAME", ""), release.get("VERSION_ID", ""), release.get("VERSION_CODENAME", ""))


def new_module(name: str) -> ModuleType:
    """``imp.new_module``: an empty module."""
    return ModuleType(name)


def load_source(name: str, pathname: str) -> ModuleType:
    """``imp.load_source``: the module of a file.

    Raises:
        ImportError: the file is not one of Python.
    """
    spec = importlib.util.spec_from_file_location(name, pathname)
    if spec is None or spec.loader is None:
        raise ImportError(f"'{pathname}' is not a file of Python", name=name, path=pathname)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
