"""The files that a model of a robot may refer to: those of its package, and of folders that the user lists."""

from __future__ import annotations

import contextlib
import os
import re
from functools import partial
from itertools import chain, pairwise
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from morse.assets import search
from morse.system import variables
from morse.system.regular_files import BudgetError, folders_above, once_for_file, open_regular, take_search

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    #: folders that may contain a file in addition to the usual ones
    Owners = tuple[Path, ...]

#: files that mark the folder of a package
_MARKS = ("package.xml", "model.config", "manifest.xml")
#: the model of a folder of Gazebo, which may have no other mark
_MODEL = "model.sdf"
#: variables of ROS and Gazebo that list folders of packages and models
_VARIABLES = ("ROS_PACKAGE_PATH", *search.MODEL_PATHS)
#: all variables that say where files are
FOLDERS = (*_VARIABLES, "AMENT_PREFIX_PATH", "MORSE_RESOURCE_PATH", "MORSE_ROOT")
#: files that mark the folder of a project whose models share meshes
_PYTHON = "__init__.py"
_PROJECT_MARKS = (".git", "pyproject.toml", "setup.py", _PYTHON)
_NAME = re.compile(rb"<name[^<>]*>([^<]+)</name>")
#: maximum number of folders that are searched for packages, and size of the beginning of a ``package.xml``, bytes
_MOST_FOLDERS, _MOST_BYTES = 1000, 1 << 16
#: maximum number of folders above a model that are searched for its package
_LEVELS = 6
#: folders of packages that hold models; the package is the folder above
_MODEL_FOLDERS = ("urdf", "xacro", "mjcf", "xml", "xmls", "sdf")


class FileRefusedError(ValueError):
    """A file is missing or must not be read; the message contains the reason."""


def find_near(name: str, model: Path) -> Path:
    """Return the file that a model refers to: ``package://robot/meshes/arm.stl``, ``file:///...`` or a path.

    A package is a folder above the model, a folder beside one of these folders, or a folder in ROS_PACKAGE_PATH,
    GZ_SIM_RESOURCE_PATH and the like, or directly below one of them. If no package has that name, the file is searched
    in the folders above the model: the package was renamed. A relative path that does not exist is searched there, too.
    After symbolic links are resolved, a file must be in the package of the model, or in a folder of these variables, of
    MORSE_RESOURCE_PATH or of the project. If no file marks the package of the model, the folder of the model and its
    parent are used, the folder above one such as ``urdf``, and the Python package or the repository that contains them.
    The models of a world may also be in a folder ``models`` beside its own. URIs may contain ``%20`` and the like. A
    file whose name differs in capitals is used if there is no other.

    Raises:
        FileRefusedError: the file does not exist, or is in another folder.
    """
    return _found(name, model, os.path.isfile)


def find_folder_near(name: str, model: Path) -> Path:
    """Return the folder that a model refers to; see `find_near`.

    Raises:
        FileRefusedError: the folder does not exist, or is in another folder.
    """
    return _found(name, model, os.path.isdir)


def _found(name: str, model: Path, exists: Callable[[Path], bool]) -> Path:
    """Search what a model refers to, once; a file may refer to it thousands of times."""

    def found() -> Path | str:
        take_search()
        try:
            return _find(name, model, exists)
        except FileRefusedError as error:  # not the error itself, which holds its frames
            return str(error)

    try:
        result = once_for_file(found, _found, name, model, exists)
    except BudgetError as error:
        raise FileRefusedError(str(error)) from None
    if isinstance(result, str):
        raise FileRefusedError(result)
    return result


def _find(name: str, model: Path, exists: Callable[[Path], bool]) -> Path:
    is_package = name.startswith(("package://", "model://"))
    elsewhere = other_kind = None
    names = [name]
    if "://" in name and "%" in name:
        # spaces in URIs
        names.append(unquote(name))
    candidates = [partial(_candidates, one, model) for one in names]
    for candidate, own in chain(*(one() for one in candidates), *(_in_other_capitals(one()) for one in candidates)):
        if not exists(candidate):
            if other_kind is None and exists is os.path.isfile and os.path.exists(candidate):
                other_kind = candidate
            continue
        real = Path(os.path.realpath(candidate))
        if any(map(real.is_relative_to, (*map(os.path.realpath, own), *_readable(model)))):
            return candidate
        elsewhere = elsewhere or real
    if elsewhere is not None:
        raise FileRefusedError(
            f"it is at {elsewhere}, outside of the package of the model; "
            "to allow it, add the folder to MORSE_RESOURCE_PATH"
        )
    if other_kind is not None:
        raise FileRefusedError("it is a folder" if other_kind.is_dir() else "it is not a regular file")
    path = "GZ_SIM_RESOURCE_PATH" if name.startswith("model://") else "ROS_PACKAGE_PATH"
    hint = f"; add more folders with {path}" if is_package else ""
    raise FileRefusedError(f"the file does not exist{hint}")


def find_package(name: str, model: Path) -> Path:
    """Return the folder of a package that a model refers to: by the name in its ``package.xml``, or of the folder.

    Raises:
        FileRefusedError: there is no such package.
    """
    for folder in _packages(name, model):
        return folder
    for candidate, _ in _candidates(f"package://{name}/.", model):
        if candidate.is_dir():
            return candidate
    if not _marked(model) and (unmarked := _above_models(model)):
        # it was renamed
        return unmarked[0]
    raise FileRefusedError(f"there is no package '{name:.60}'; add its folder to ROS_PACKAGE_PATH")


def _packages(name: str, model: Path) -> Iterator[Path]:
    """The folders whose ``package.xml`` has a name: above the model, beside these folders, and in listed folders."""
    above = list(model.absolute().parents)[:_LEVELS]
    for folder in [*above, *_listed()]:
        if once_for_file(partial(_name_of, folder), _name_of, folder) == name:
            yield folder
        yield from once_for_file(partial(_packages_in, folder), _packages_in, folder).get(name, ())


def _packages_in(folder: Path) -> dict[str, list[Path]]:
    """The packages directly below a folder, by name."""
    packages: dict[str, list[Path]] = {}
    # the user may not list the folders of others, such as /home
    with contextlib.suppress(OSError):
        for one in sorted(folder.iterdir())[:_MOST_FOLDERS] if folder != Path(folder.anchor) else ():
            if (name := _name_of(one)) is not None:
                packages.setdefault(name, []).append(one)
    return packages


def _name_of(folder: Path) -> str | None:
    """Return the name of a package, which may differ from that of its folder."""
    try:
        with open_regular(folder / "package.xml") as file:
            text = file.read(_MOST_BYTES)
    except OSError:
        return None
    match = _NAME.search(text)
    return match[1].decode("utf-8", "replace").strip() if match else None


def _in_other_capitals(candidates: Iterator[tuple[Path, Owners]]) -> Iterator[tuple[Path, Owners]]:
    """The same files as on systems that ignore the case of names."""
    for candidate, own in candidates:
        with contextlib.suppress(OSError, ValueError):
            folder = candidate.parent
            for name in once_for_file(partial(_by_folded_name, folder), _by_folded_name, folder).get(
                candidate.name.casefold(), ()
            ):
                if name != candidate.name:
                    yield candidate.with_name(name), own


def _by_folded_name(folder: Path) -> dict[str, list[str]]:
    names: dict[str, list[str]] = {}
    with contextlib.suppress(OSError):
        for name in sorted(os.listdir(folder))[:_MOST_FOLDERS]:
            names.setdefault(name.casefold(), []).append(name)
    return names


def _readable(model: Path) -> list[str]:
    """The folders whose files may all be read, without symbolic links."""
    return once_for_file(lambda: [os.path.realpath(folder) for folder in _folders(model)], _readable, model)


def _folders(model: Path) -> Iterator[Path]:
    """The folders whose files may all be read."""
    folder = model.absolute().parent
    yield folder
    above = _marked(model)
    if above:
        yield above[0]
    else:
        yield from folders_above(model)[1:2]
        yield from _above_models(model)
        yield from _project(model)
    yield from search.resource_dirs()
    yield from search.component_dirs()
    yield from _listed()


def _marked(model: Path) -> list[Path]:
    """The folders above a model that are marked as packages, the nearest first."""
    return [one for one in folders_above(model) if _is_marked(one)]


def _is_marked(folder: Path) -> bool:
    return any((folder / mark).is_file() for mark in _MARKS)


def _above_models(model: Path) -> list[Path]:
    """The package of a model by the usual names of its folders: ``lab`` of ``lab/urdf/arm/arm.urdf``; nearest first."""
    above = folders_above(model)[: _LEVELS + 1]
    return [package for one, package in pairwise(above) if one.name in _MODEL_FOLDERS]


def _project(model: Path) -> Iterator[Path]:
    """The folders of the Python packages around a model, or of the repository, if they are a few folders above."""
    inside = False
    for one in folders_above(model)[1 : _LEVELS + 1]:
        marks = [mark for mark in _PROJECT_MARKS if (one / mark).exists()]
        if inside and _PYTHON not in marks:
            return
        if marks:
            yield one
            if _PYTHON not in marks:
                return
            inside = True


def _listed() -> list[Path]:
    folders = [Path(entry) for variable in _VARIABLES for entry in variables.paths(variable)]
    return folders + [Path(entry) / "share" for entry in variables.paths("AMENT_PREFIX_PATH")]


def _candidates(name: str, model: Path) -> Iterator[tuple[Path, Owners]]:
    """Yield possible paths of the file, each with a folder that may contain it in addition to the usual folders."""
    if "\0" in name:
        return
    scheme, separator, rest = name.partition("://")
    if not separator:
        plain = name.replace("\\", "/")
        yield model.parent / plain, ()
        yield model.parent / plain.lstrip("/"), ()
        # Macros of another folder write paths from their own file, and some files write them from the package.
        inside = re.sub(r"^(?:\.{0,2}/)+", "", plain)
        for folder in folders_above(model)[1:_LEVELS]:
            yield folder / inside, ()
        return
    if scheme == "file":
        yield Path(rest), ()
        yield model.parent / rest.lstrip("/"), ()
        # Gazebo searches it in its folders of resources, where models are, or a folder of models is
        for folder in [*_listed(), *search.resource_dirs()]:
            yield folder / rest.lstrip("/"), ()
        yield from _candidates(f"model://{rest.lstrip('/').removeprefix('models/')}", model)
        return
    # package:///robot/meshes/arm.stl has an empty host before the path, like file:///
    package, _, inside = rest.removeprefix("/").partition("/")
    if not package or package in (".", ".."):
        return
    for folder in _packages(package, model):
        yield folder / inside, (folder,)
    above = folders_above(model)
    for folder in list(model.absolute().parents)[:_LEVELS]:
        if folder.name == package and folder in above:
            yield folder / inside, (folder,)
        if folder in above or _is_marked(folder / package) or (folder / package / _MODEL).is_file():
            yield folder / package / inside, (folder / package,)
            if scheme == "model":
                yield folder / "models" / package / inside, (folder / "models" / package,)
    for folder in [*_listed(), *search.resource_dirs()]:
        yield folder / package / inside, ()
        if folder.name == package:
            yield folder / inside, ()
    for folder in list(model.absolute().parents)[:_LEVELS] if inside != "." else ():
        yield folder / inside, ()
