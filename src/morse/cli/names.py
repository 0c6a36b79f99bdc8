"""Names of environments and components: as file names and as names of Python modules and classes."""

from __future__ import annotations

import keyword
import sys
import unicodedata

from morse.cli.messages import CommandError
from morse.core.validation.names import DEVICES

_OWN_PACKAGES = {"morse", "pymorse", "numpy", "mujoco", "msgspec", "websockets", "typer", "rich"}


def environment_name(text: str) -> str:
    """Validate the name of an environment, which is also the name of its directory and of its Python package.

    Raises:
        CommandError: the name is a path, or not a valid name of a Python module, or the environment would hide a
            module.
    """
    name = text.rstrip("/\\") if text.strip("/\\") else text
    if any(separator in name for separator in "/\\") or name in ("", ".", "..") or ":" in name:
        raise CommandError(
            f"'{text}' is a path: give the plain name of the environment, which is created in the current directory."
        )
    package = _identifier(name, keep="_", replace="_")
    if package != name:
        raise CommandError(
            f"'{text}' cannot be the name of an environment, because it is not a valid name of a Python package. "
            + (f"Use '{package}', for example." if package.strip("_") else "Use letters, digits and underscores.")
        )
    if name in sys.stdlib_module_names or name in _OWN_PACKAGES:
        raise CommandError(
            f"'{text}' would hide the Python module '{name}' from your scripts. Use, for example, '{name}_sim'."
        )
    return name


def registered_name(text: str) -> str:
    """A name for an existing directory in the configuration file.

    Raises:
        CommandError: the configuration file cannot contain the name.
    """
    name = text.strip()
    if not name or not name.isprintable() or name[0] in "#;[" or any(c in "=:/\\" for c in name):
        raise CommandError(f"'{text}' cannot be the name of an environment: use letters, digits and underscores.")
    return name


def component_name(text: str) -> str:
    """The safe form of the name of a component: only its letters and digits.

    Raises:
        CommandError: the name is a path, has no letters and digits, or is a reserved word.
    """
    if any(separator in text for separator in "/\\") or text in (".", ".."):
        raise CommandError(f"'{text}' is a path: give the plain name of the component.")
    name = _identifier(text, keep="", replace="")
    if not name:
        raise CommandError(f"'{text}' cannot be the name of a component: use letters and digits.")
    word = name.removeprefix("_")
    if _is_reserved(word):
        raise CommandError(
            f"'{text}' cannot be the name of a component: the word is reserved. Use, for example, '{word}1'."
        )
    return name


def class_name(name: str) -> str:
    """The name of the class of a component, e.g. ``Ranger`` for ``ranger`` and ``Mybot`` for ``myBot``."""
    return unicodedata.normalize("NFKC", name.capitalize())


def _is_reserved(name: str) -> bool:
    """Whether a name, or that of its class, is a keyword of Python, or the name is that of a device on Windows."""
    return keyword.iskeyword(name) or keyword.iskeyword(name.capitalize()) or name.lower() in DEVICES


def _identifier(text: str, keep: str, replace: str) -> str:
    """A form of the text that is valid as the name of a Python module, of a class and of a file."""
    # Python normalises identifiers to this form, but file systems do not
    normal = unicodedata.normalize("NFKC", text)
    name = "".join(c if c in keep or (c.isalnum() and ("a" + c).isidentifier()) else replace for c in normal)
    if not name:
        return ""
    return "_" + name if _is_reserved(name) or not name.isidentifier() else name
