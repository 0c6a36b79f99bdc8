"""The commands of ``morse`` and its global options."""

from __future__ import annotations

import contextlib
import importlib
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
import typer.core
import typer.main

from morse.cli.messages import CommandError, complain, nearest, sentence
from morse.core.classes.plugins import PluginError, entry_points, load, use_project_here
from morse.core.exceptions import MorseError
from morse.core.reports.faults import ENDINGS, describe
from morse.core.reports.printing import echo
from morse.version import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence


# What is wrong with the options and arguments that the parser rejects.

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


def kind_of(parameter: object) -> str:
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


#: files with the functions that call those of commands
_CALLERS = (str(Path(typer.__file__).parent), __file__)
#: entry points of packages that add commands: a function, whose annotations declare arguments and options as in Typer
_GROUP = "morse.commands"
#: the module of each command, and the function there if it is not called `command`
_MODULES = {
    "create": "morse.cli.environments:create",
    "import": "morse.cli.environments:import_environment",
    "import-world": "morse.cli.environments:import_world",
    "rm": "morse.cli.environments:remove",
    "add": "morse.cli.environments:add",
    "check": "morse.cli.check",
    "doctor": "morse.cli.doctor",
    "run": "morse.cli.run",
    "demo": "morse.cli.demo",
    "verify": "morse.cli.verify",
    "replay": "morse.cli.replay",
    "export": "morse.cli.export",
    "render": "morse.cli.render",
    "view": "morse.cli.view",
    "sweep": "morse.cli.sweep",
    "edit": "morse.cli.edit",
}


def _names() -> list[str]:
    """The names of all commands: those of MORSE, then those of plug-ins and of the project in this folder, sorted."""
    use_project_here()
    return [*_MODULES, *dict.fromkeys(point.name for point in entry_points(_GROUP) if point.name not in _MODULES)]


def _command(name: str) -> Any:
    """The parser of a command.

    That of a plug-in that cannot be loaded, or whose function has annotations that Typer refuses, says so when it is
    called: the help lists it, and the other commands.
    """
    if name in _MODULES:
        place, _, function = _MODULES[name].partition(":")
        module = importlib.import_module(place)
        return _parser(name, getattr(module, function or "command"), getattr(module, "CONTEXT_SETTINGS", None))

    def use(found: object) -> Any:
        if not callable(found):
            raise TypeError(f"it is {found!r:.80}, expected a function")
        return _parser(name, found, kind=_PackageCommand)

    point = next(point for point in entry_points(_GROUP) if point.name == name)
    try:
        return load(point, use)
    except PluginError as error:
        return _parser(name, _broken(f"The command '{name}' ({point.value}) cannot be loaded: {error}"))


def _parser(
    name: str,
    function: Callable[..., object],
    settings: dict[str, object] | None = None,
    kind: type[_Command] | None = None,
) -> Any:
    text = function.__doc__
    text = _without_line_breaks(text) if isinstance(text, str) else ""
    application = typer.Typer(add_completion=False, rich_markup_mode=_MARKUP)
    application.command(
        name,
        cls=kind or _Command,
        help=text,
        short_help=text.partition("\n\n")[0],  # the whole sentence, which the parser would cut
        context_settings=settings,
    )(function)
    return typer.main.get_command(application)


@contextlib.contextmanager
def _messages_of(name: str) -> Iterator[None]:
    """Turn the errors of a plug-in into messages."""
    try:
        yield
    except MorseError as error:
        raise CommandError(sentence(error)) from None
    except (CommandError, typer.TyperException, typer.Abort, typer.Exit, OSError, *ENDINGS):
        raise
    except BaseException as error:  # the package is third-party code
        trace = error.__traceback__
        # the lines of the parser, through which every command is called, say nothing
        while trace and trace.tb_next and trace.tb_frame.f_code.co_filename.startswith(_CALLERS):
            trace = trace.tb_next
        raise CommandError(f"The command '{name}' has failed: {describe(error.with_traceback(trace))}") from None


def _broken(reason: str) -> Callable[..., object]:
    def call(words: Annotated[list[str] | None, typer.Argument(hidden=True)] = None) -> None:
        raise CommandError(reason)

    call.__doc__ = f"(broken) {reason}"
    return call


#: the tables of Rich cut the names of options on narrow terminals; plain help wraps its lines
_MARKUP: Any = "rich" if shutil.get_terminal_size().columns >= 80 else None


@dataclass(frozen=True, slots=True)
class GlobalOptions:
    """The options before the subcommand."""

    color: bool = False
    reverse_color: bool = False


#: what a number is called in the help, where the option does not say what it is
_NUMBERS = {"int": "N", "float": "X"}


def _plain_types(parameters: list[Any]) -> list[object]:
    """Parameters whose help names what they take, and not the types and ranges of Python."""
    for parameter in parameters:
        kind = kind_of(parameter)
        if getattr(parameter, "is_flag", False):
            parameter.metavar = ""
        elif parameter.param_type_name == "argument":
            parameter.display_type = lambda ctx: ""  # its name says it
        elif parameter.metavar is None and kind in _NUMBERS:
            parameter.metavar = _NUMBERS[kind]
            parameter._get_number_range_help_str = lambda: None  # a wrong number gets the range in words
    return parameters


class _Command(typer.core.TyperCommand):
    def get_params(self, ctx: Any) -> list[Any]:
        return _plain_types(super().get_params(ctx))


class _PackageCommand(_Command):
    """A command of a plug-in, whose function, defaults and checks of options may raise anything."""

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        with _messages_of(str(self.name)):
            return super().make_context(*arguments, **options)

    def invoke(self, ctx: Any) -> object:
        with _messages_of(str(self.name)):
            return super().invoke(ctx)


class _Commands(typer.core.TyperGroup):
    """Imports the module of a subcommand only when it is needed, so that ``morse -v`` responds at once.

    (The type of a parser's context is private to Typer, hence ``Any``.)
    """

    def get_params(self, ctx: Any) -> list[Any]:
        return _plain_types(super().get_params(ctx))

    def invoke(self, ctx: Any) -> object:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            # newer versions of Typer end the program without a word
            raise CommandError("Interrupted.", status=130) from None

    def list_commands(self, ctx: object) -> list[str]:
        return _names()

    def get_command(self, ctx: object, cmd_name: str) -> Any:
        if cmd_name not in _MODULES and cmd_name not in _names():
            return None
        return _command(cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        if args and args[0] not in _MODULES and not args[0].startswith("-") and args[0] not in (names := _names()):
            if args[0] == "help":
                raise CommandError("Help: `morse -h`, and `morse COMMAND -h`.", status=2)
            raise CommandError(
                f"There is no command '{args[0]}'.{nearest(args[0], names)} The commands are: {', '.join(names)}.",
                status=2,
            )
        return super().resolve_command(ctx, args)


def _without_line_breaks(text: str) -> str:
    """Paragraphs as one line each, which the help wraps at the width of the terminal."""
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))


app = typer.Typer(
    cls=_Commands,
    name="morse",
    help="MORSE, the Modular OpenRobots Simulation Engine.",
    epilog="Start with: morse create my_simulation && morse run my_simulation",
    add_completion=True,
    rich_markup_mode=_MARKUP,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def global_options(
    context: typer.Context,
    noaudio: Annotated[
        bool, typer.Option("-n", "--noaudio", help="Accepted for old scripts: only the live view plays sounds.")
    ] = False,
    color: Annotated[bool, typer.Option("-c", "--color", help="Colour the log of the simulation.")] = False,
    reverse_color: Annotated[
        bool, typer.Option("--reverse-color", help="Colours for a terminal with a light background.")
    ] = False,
    version: Annotated[bool, typer.Option("-v", "--version", help="Print the version.")] = False,
    verbose: Annotated[bool, typer.Option("--verbose", help="With --version: also the plug-ins.")] = False,
) -> None:
    """MORSE, the Modular OpenRobots Simulation Engine."""
    context.obj = GlobalOptions(color, reverse_color)
    if version and verbose:
        from morse.cli.doctor import version_lines

        echo("\n".join(version_lines()))
        raise typer.Exit
    if version:
        echo(f"morse {__version__}")
        raise typer.Exit
    if verbose:
        raise CommandError("--verbose before a command belongs to `morse --version`.", status=2)
    if context.invoked_subcommand is None:
        echo(context.get_help())


def execute(arguments: Sequence[str]) -> int:
    """Run a command line.

    Args:
        arguments: the words after ``morse``.

    Returns:
        The exit status: 0, 1 for a failed command, 2 for an error on the command line, 130 after Ctrl+C, or the status
        that the simulation returned.
    """
    try:
        status = typer.main.get_command(app).main(args=list(arguments), prog_name="morse", standalone_mode=False)
    except CommandError as error:
        complain(str(error))
        return error.status
    except typer.TyperException as error:
        # options and arguments that the parser rejects
        name = next((word for word in arguments if not word.startswith("-")), "")
        group: Any = typer.main.get_command(app)
        is_command = name in _MODULES or name in _names()
        parser = group.get_command(None, name) if is_command else group
        line = f"morse {name} -h" if is_command else "morse -h"
        complain(f"{explain(error, arguments, parser)} (`{line}` lists all options.)")
        return error.exit_code
    except (typer.Abort, KeyboardInterrupt):
        complain("Interrupted.")
        return 130
    except ImportError as error:
        if error.name != "mujoco":
            raise
        complain(sentence(error))
        return 1
    except OSError as error:
        complain(f"{error.strerror or error}: {error.filename or ''}".rstrip(": "))
        return 1
    return status if isinstance(status, int) else 0
