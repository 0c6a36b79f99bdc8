"""What is wrong with the options and arguments that the parser rejects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.cli.messages import nearest

if TYPE_CHECKING:
    from collections.abc import Sequence

    import typer

_KINDS = {"int": "an integer", "float": "a number"}


def explain(error: typer.TyperException, words: Sequence[str], command: Any) -> str:
    """The reason, what was given, what was expected, and the nearest option.

    Args:
        error: of the parser.
        words: the command line after ``morse``.
        command: the parser of the command, whose classes are private to Typer; None before a command.
    """
    option, parameter = getattr(error, "option_name", None), getattr(error, "param", None)
    parameters = [] if command is None else command.params
    if hasattr(error, "possibilities") and option is not None:
        # without those of one letter, which are near to everything
        names = [name for one in parameters for name in (*one.opts, *one.secondary_opts) if name.startswith("--")]
        words_of_it = {name.lstrip("-"): name for name in [*names, "--help"]}
        near = nearest(option.lstrip("-"), words_of_it, 0.7).replace("'", "'--", 1)
        return f"There is no option '{option}'.{near}"
    if option is not None:
        (owner,) = [one for one in parameters if option in (*one.opts, *one.secondary_opts)] or [None]
        takes = owner is None or not owner.is_flag
        return f"{option} takes {_expected(owner)}: none was given." if takes else f"{option} takes no value."
    if hasattr(error, "param_type"):
        return error.format_message()  # of a missing argument, which names it
    if parameter is not None and kind_of(parameter) in _KINDS:
        value = _given(words, parameter.opts)
        return f"{parameter.opts[0]} takes {_expected(parameter)}{'' if value is None else f', not {value!r}'}."
    if "extra argument" in str(error):
        extra = str(error).rpartition("(")[2].rstrip(")")
        return (
            f"There is one argument too many: {extra}."
            if " " not in extra
            else f"There are too many arguments: {extra}."
        )
    return error.format_message()


def _expected(parameter: Any) -> str:
    kind = kind_of(parameter)
    if kind not in _KINDS:
        return "a value"
    what, (low, high) = _KINDS[kind], (parameter.min, parameter.max)
    if low is not None and high is not None:
        return f"{what} from {low:g} to {high:g}"
    return what if low is None else f"{what} of at least {low:g}"


def kind_of(parameter: Any) -> str:
    """The name of the type of a parameter; empty if this version of Typer does not tell it."""
    bare_type = getattr(parameter, "bare_type", None)
    return str(bare_type()) if callable(bare_type) else ""


def _given(words: Sequence[str], names: Sequence[str]) -> str | None:
    """The value of an option on the command line."""
    for word, following in zip(words, [*words[1:], None], strict=True):
        name, is_joined, value = word.partition("=")
        if name in names:
            return value if is_joined else following
    return None
