"""The simulation environments that this user has registered, in ``~/.morse/config``."""

from __future__ import annotations

import configparser
import io
import os
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from morse.cli.messages import CommandError, nearest
from morse.system.regular_files import read_regular
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def exclusive(path: Path) -> Iterator[None]:
    """Acquire the lock file, and wait for other processes; it is released when the process ends, if not before.

    Raises:
        OSError: the file cannot be created or locked.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        _lock(descriptor)
        yield
    finally:
        os.close(descriptor)


if sys.platform == "win32":

    def _lock(descriptor: int) -> None:
        import msvcrt

        # the system call fails after ten attempts, one second apart
        msvcrt.locking(descriptor, msvcrt.LK_LOCK, 1)

else:

    def _lock(descriptor: int) -> None:
        import fcntl

        fcntl.flock(descriptor, fcntl.LOCK_EX)


_SECTION = "sites"


def config_path() -> Path:
    """The configuration file (``HOME`` is honoured).

    Raises:
        CommandError: the user has no home directory.
    """
    try:
        return Path.home() / ".morse" / "config"
    except RuntimeError as error:
        raise CommandError(f"MORSE keeps its configuration in your home directory: {error}") from error


class Sites:
    """Names of environments and their directories; names are not case-sensitive.

    Args:
        path: the configuration file.

    Raises:
        CommandError: the configuration file cannot be read.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path = config_path() if path is None else path
        self._config = self._read()

    @classmethod
    def or_none_registered(cls) -> tuple[Sites, CommandError | None]:
        """Return the registered environments; if the configuration file is broken, none and the error."""
        try:
            return cls(), None
        except CommandError as error:
            return cls(Path(os.devnull)), error

    def _read(self) -> configparser.ConfigParser:
        config = configparser.ConfigParser(interpolation=None)
        try:
            content = b"" if str(self.path) == os.devnull else read_regular(self.path)
            config.read_string(os.fsdecode(content), str(self.path))
        except FileNotFoundError:
            pass
        except (configparser.Error, UnicodeDecodeError, OSError) as error:
            reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
            raise CommandError(
                f"{self.path} is not a valid configuration file ({reason}). "
                "Correct it, or remove it and register your environments again with `morse import PATH`."
            ) from error
        if not config.has_section(_SECTION):
            config.add_section(_SECTION)
        return config

    def __contains__(self, name: str) -> bool:
        return self._config.has_option(_SECTION, name)

    def names(self) -> list[str]:
        """The registered names, in alphabetical order."""
        return sorted(self._config.options(_SECTION))

    def find(self, name: str) -> Path | None:
        """Return the directory of an environment (which may not exist any more), or None if it is not registered."""
        return Path(self._config.get(_SECTION, name)) if name in self else None

    def directory(self, name: str) -> Path:
        """The existing directory of a registered environment.

        Raises:
            CommandError: the name is not registered, or the directory does not exist any more.
        """
        path = self.find(name)
        if path is None:
            raise CommandError(f"There is no environment '{name}'.{nearest(name, self.names())} {self.known()}")
        if not path.is_dir():
            raise CommandError(
                f"The environment '{name}' is registered at {path}, but this directory does not exist any more. If "
                f"it was moved, `morse import -f NEW_PATH {name}`; to remove it from the list, `morse rm {name}`."
            )
        return path

    def directories(self) -> list[str]:
        """The registered directories, which may not exist any more."""
        return [self._config.get(_SECTION, name) for name in self.names()]

    def known(self) -> str:
        """A sentence that lists the registered environments, for error messages."""
        if names := self.names():
            return f"Registered are: {', '.join(names)}."
        return (
            "No environment is registered: `morse create NAME` creates one, `morse import PATH` registers a directory."
        )

    def owner(self, path: Path) -> Path | None:
        """The registered directory that contains a file (the innermost one), or None."""
        registered = {Path(self._config.get(_SECTION, name)).resolve() for name in self.names()}
        return next((directory for directory in path.resolve().parents if directory in registered), None)

    def register(self, name: str, directory: Path) -> None:
        """Add an environment or change its directory, and save."""
        with self._locked():
            self._config.set(_SECTION, name, os.path.abspath(directory))
            self._save()

    def forget(self, name: str) -> None:
        """Remove an environment, and save."""
        with self._locked():
            self._config.remove_option(_SECTION, name)
            self._save()

    @contextmanager
    def _locked(self) -> Iterator[None]:
        """Lock the file for the block, and read the registrations of other processes."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with exclusive(self.path.with_name("config.lock")):
            self._config = self._read()
            yield

    def _save(self) -> None:
        # whole, so that an interrupted command does not lose the other environments
        text = io.StringIO()
        self._config.write(text)
        # the bytes of paths, also those that are not text in the locale of this process
        write_whole(self.path, os.fsencode(text.getvalue()))


def registered() -> list[str]:
    """The directories of all registered environments; none if the configuration file is broken."""
    sites, _ = Sites.or_none_registered()
    return sites.directories()
