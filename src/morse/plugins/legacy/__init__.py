"""What exists for scene scripts and components of MORSE 1.4 and earlier, and for the Python of their time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.builder.compatibility import Compatibility, ScriptModules

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

__all__ = ["COMPATIBILITY"]


class _Legacy(Compatibility):
    """Each part is loaded when a script needs it."""

    purpose = "scene scripts and components of MORSE 1.4 and earlier"

    def arguments(self, script: Path, words: Sequence[str], directories: Iterable[str]) -> list[str] | None:
        from morse.plugins.legacy.imports import argv

        return argv(script, words, directories)

    def modules(self) -> ScriptModules:
        from morse.plugins.legacy.imports import script_modules

        return script_modules()

    def attributes(self, owner: object) -> Iterable[str]:
        from morse.plugins.legacy.names import attributes

        return attributes(owner)

    def attribute(self, owner: object, name: str) -> Callable[[], object] | None:
        from morse.plugins.legacy.names import attribute

        return attribute(owner, name)

    def set_attribute(self, owner: object, name: str, value: object) -> bool:
        from morse.plugins.legacy.names import set_attribute

        return set_attribute(owner, name, value)

    def call(self, owner: object, method: str, arguments: dict[str, object]) -> dict[str, Any]:
        from morse.plugins.legacy.earlier import call

        return call(owner, method, arguments)

    def value(self, kind: str, value: object, what: str) -> object:
        from morse.plugins.legacy.values import VALUES

        return VALUES[kind](value, what)

    def mend_of_syntax(self, error: SyntaxError) -> str:
        from morse.plugins.legacy.language import mend_of_syntax

        return mend_of_syntax(error)

    def mended_line(self, line: str) -> str:
        from morse.plugins.legacy.language import mended_line

        return mended_line(line)

    def mend_of_name(self, name: str) -> str:
        from morse.plugins.legacy.language import mend_of_name

        return mend_of_name(name)

    def name_of_today(self, name: str) -> str:
        from morse.plugins.legacy.language import NAMES

        return NAMES.get(name, "")

    def mended_text(self, text: str) -> str:
        from morse.plugins.legacy.language import mended_text

        return mended_text(text)


COMPATIBILITY = _Legacy()
