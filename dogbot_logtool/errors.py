"""The errors that reach a user: each is a sentence and knows its exit code."""

from typing import ClassVar, Final

DAMAGED: Final = 3
"""Exit code of what was done, though some of the input could not be read."""


class LogtoolError(Exception):
    """Something could not be done. The message says what, where, and what to do about it."""

    exit_code: ClassVar[int] = 1


class CallError(LogtoolError):
    """The call itself was wrong: no such file, an option that does not fit, a bad robot file."""

    exit_code: ClassVar[int] = 2


class ExtraMissingError(LogtoolError):
    """Something needs packages that the base install leaves out."""

    def __init__(self, what: str, extra: str) -> None:
        from dogbot_logtool.extras import install_command  # noqa: PLC0415 - seldom needed

        command = install_command(extra)
        super().__init__(f"{what}: needs packages that are not installed: {command}")


class LogError(LogtoolError):
    """The log is not one that can be read, or nothing in it can be used."""


class DefinitionError(LogError):
    """A message definition recorded in the log cannot be understood; its channel is unread."""


class StoreError(LogtoolError):
    """A store of logs or results fails."""
