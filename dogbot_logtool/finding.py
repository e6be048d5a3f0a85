"""What users should know about a log, one sentence each, with a code that scripts can match."""

from dataclasses import dataclass
from enum import IntEnum


class Severity(IntEnum):
    """How much a finding matters; the worst comes first."""

    ERROR = 0
    """Something asked for cannot be had."""
    WARNING = 1
    """Numbers or pictures may mislead."""
    NOTE = 2
    """Good to know."""


@dataclass(frozen=True, slots=True, order=True)
class Finding:
    """One fact about a log."""

    severity: Severity
    code: str
    """``W_ZERO_STAMPS`` ...: E, W or N for its severity, then what it is."""
    text: str
    """A sentence."""
    where: str = ""
    """The topic, if it is about one."""
    command: str = ""
    """What to type about it, if that is known; `text` ends with it."""

    @property
    def sentence(self) -> str:
        """The text without the command, which is printed in one piece to be pasted."""
        return self.text.removesuffix(self.command).rstrip()


def error(code: str, text: str, where: str = "") -> Finding:
    """Return an error; the code is given without its letter."""
    return Finding(Severity.ERROR, f"E_{code}", text, where)


def warning(code: str, text: str, where: str = "") -> Finding:
    """Return a warning; the code is given without its letter."""
    return Finding(Severity.WARNING, f"W_{code}", text, where)


def note(code: str, text: str, where: str = "") -> Finding:
    """Return a note; the code is given without its letter."""
    return Finding(Severity.NOTE, f"N_{code}", text, where)
