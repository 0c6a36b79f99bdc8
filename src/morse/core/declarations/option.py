"""The declaration of an option."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from morse.core.declarations.fields import OptionFields
from morse.core.declarations.refused import check_option
from morse.core.exceptions import MorseDeclarationError


class Option(OptionFields):
    """An option of a modifier, a stream or a middleware; scripts pass it as a keyword argument.

    Attributes:
        type: ``float``, ``int``, ``bool``, ``str``, ``list``, ``dict``, or several in a tuple; ``object`` for anything.
        default: the value if the script gives none.
        shape: shape of a list of numbers.

    Raises:
        MorseDeclarationError: the option contradicts itself; the message contains file and line.
    """

    __slots__ = ()

    if not TYPE_CHECKING:  # type checkers shall see the parameters of the tuple

        def __new__(cls, *args: object, **kwargs: object) -> Option:
            """Check the option, because a class with an option that no value fits must not be created."""
            option = super().__new__(cls, *args, **kwargs)
            try:
                check_option(option)
            except MorseDeclarationError as error:
                caller = sys._getframe(1)
                where = f"{caller.f_code.co_filename}:{caller.f_lineno}"
                raise MorseDeclarationError(f"{where}: option {option.doc!r:.80}: {error}") from None
            return option
