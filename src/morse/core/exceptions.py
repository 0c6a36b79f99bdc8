"""Exceptions of MORSE. Their names are part of the interface for user code."""


class MorseError(Exception):
    """Base of all errors of MORSE."""

    def __init__(self, value: object = "") -> None:
        super().__init__(value)
        self.value = value

    def __str__(self) -> str:
        return str(self.value)


class MorseEnvironmentError(MorseError):
    """A simulation environment (project directory) is missing or broken, or already exists."""


class MorseMiddlewareError(MorseError):
    """A middleware is missing or does not respond."""


class MorseMultinodeError(MorseError):
    """Several simulation nodes cannot connect to each other."""


class MorseServiceError(MorseError):
    """A service cannot be offered or called."""


class MorseRPCInvokationError(MorseServiceError):
    """A service call failed; the message is sent to the caller."""


class MorseServiceAlreadyRunningError(MorseRPCInvokationError):
    """The asynchronous service of this component is busy and may not be interrupted."""


class MorseMethodNotFoundError(MorseRPCInvokationError):
    """The component has no such service."""


class MorseWrongArgsError(MorseRPCInvokationError):
    """The arguments of a call are not valid."""


class MorseRPCNbArgsError(MorseWrongArgsError):
    """Too few or too many arguments."""


class MorseRPCTypeError(MorseWrongArgsError):
    """An argument has the wrong type."""


class MorseDeclarationError(MorseError):
    """A declaration of a component class is invalid."""


class MorseBuilderError(MorseError):
    """A scene script is invalid."""


class MorseBuilderNoComponentError(MorseBuilderError, KeyError):
    """The requested component, or object of the scene, does not exist."""


class MorseBuilderBadSyntaxError(MorseBuilderError):
    """A name or an expression of the script is not valid."""


class MorseBuilderUnexportableError(MorseBuilderError):
    """This component has no data to export."""


# the short names
NoComponentError = MorseBuilderNoComponentError
BadSyntaxError = MorseBuilderBadSyntaxError
UnexportableError = MorseBuilderUnexportableError
