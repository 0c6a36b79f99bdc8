"""A value of Blender that MORSE does not have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.builder.legacy.notices import notice

if TYPE_CHECKING:
    from collections.abc import Iterator


class Ignored:
    """Stands for a part of Blender that MORSE does not have: it can be used in any way, without effect.

    It is empty, false, and zero. The log names it once for each line of the script.

    Args:
        path: its name, e.g. ``bpy.context.user_preferences``.
        said: whether the log has named it already.
    """

    _path: str

    def __init__(self, path: str, *, silent: bool = False) -> None:
        object.__setattr__(self, "_path", path)
        if not silent:
            notice(f"{path} has no effect: MORSE does not have it")

    def __repr__(self) -> str:
        return f"<{self._path}>"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Ignored:
            if name.startswith("__"):
                raise AttributeError(name)
            return Ignored(f"{self._path}.{name}", silent=True)

    def __setattr__(self, name: str, value: object) -> None:
        pass

    def __call__(self, *args: object, **kwargs: object) -> Ignored:
        """Another ignored value."""
        return Ignored(f"{self._path}()", silent=True)

    def __getitem__(self, key: object) -> Ignored:
        return Ignored(f"{self._path}[{key!r}]", silent=True)

    def __setitem__(self, key: object, value: object) -> None:
        pass

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __len__(self) -> int:
        return 0

    def __contains__(self, item: object) -> bool:
        return False

    def _false(self, _other: object) -> bool:
        return False

    __lt__ = __le__ = __gt__ = __ge__ = _false

    def _other(self, other: object) -> object:
        return other

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __matmul__ = __truediv__ = __rtruediv__ = _other

    def __float__(self) -> float:
        return 0.0

    def __int__(self) -> int:
        return 0

    __index__ = __int__

    def __enter__(self) -> tuple[Ignored, Ignored]:
        # ``with bpy.data.libraries.load(path) as (source, target)``
        return self, self

    def __exit__(self, *error: object) -> None:
        pass


class Facade:
    """Some settings of MORSE under Blender's names: the properties of a subclass; all other names are ignored.

    Attributes:
        _path: its name in messages.
    """

    _path = "bpy"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Ignored:
            if name.startswith("__"):
                raise AttributeError(name)
            return Ignored(f"{self._path}.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        if hasattr(type(self), name) or name.startswith("_"):
            object.__setattr__(self, name, value)
        else:
            notice(f"{self._path}.{name} has no effect: MORSE does not have it")
