"""Error messages for scene scripts."""

from morse.builder.errors.script_error import ScriptError, Step

__all__ = ["ScriptError", "Step"]
