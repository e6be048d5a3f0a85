"""Findings about a log: one kind for the whole program.

Every code is declared once, in ``findings.toml``, with its meaning and what to do about it.
"""

import tomllib
from collections.abc import Mapping, Sequence
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import Final

from dogbot_logtool.dataclass import dataclass


class Severity(IntEnum):
    """How much a finding matters; the worst comes first."""

    ERROR = 0
    """Something asked for cannot be had."""
    WARNING = 1
    """Numbers or pictures may mislead."""
    NOTE = 2
    """Good to know."""

    @property
    def word(self) -> str:
        """``error``, ``warning`` or ``note``."""
        return self.name.lower()


_SEVERITIES: Final = {"E": Severity.ERROR, "W": Severity.WARNING, "N": Severity.NOTE}


@dataclass(frozen=True, slots=True)
class FindingKind:
    """The meaning of a code in any log."""

    code: str
    """E (error), W (warning) or N (note), then what it is."""
    subject: str
    meaning: str
    """A sentence."""
    remedy: str = ""
    """A sentence on what to do about it; empty: nothing."""
    fails: Sequence[str] | None = None
    """Names of the checks of a recording that fail with it; None: it is not about figures."""


@cache
def finding_kinds() -> Mapping[str, FindingKind]:
    """Return every kind of finding by its code, in the order of the subjects."""
    return _kinds(_declarations())


@cache
def _declarations() -> str:
    return Path(__file__).with_name("findings.toml").read_text(encoding="utf-8")


def _kinds(declarations: str) -> Mapping[str, FindingKind]:
    return {
        code: FindingKind(code, subject, **words)
        for subject, kinds in tomllib.loads(declarations).items()
        for code, words in kinds.items()
    }


@cache
def _kind(code: str) -> FindingKind | None:
    """Return a kind of finding by its code; parsing the table of all takes long."""
    start = f".{code}]\n"
    own = (each for each in _declarations().split("\n\n") if start in each)
    return _kinds(next(own, "")).get(code)


@dataclass(frozen=True, slots=True)
class Finding:
    """One fact about a log."""

    code: str
    """``W_ZERO_STAMPS`` ...: one of the `finding_kinds`."""
    text: str
    """A sentence."""
    where: str = ""
    """The topic or the figure, if it is about one."""
    command: str = ""
    """A command to type, if one is known; `text` ends with it."""
    voids: Sequence[str] = ()
    """Patterns of the metrics that are not to be relied on because of it: they become null."""

    @property
    def severity(self) -> Severity:
        """How much it matters."""
        return _SEVERITIES[self.code[0]]

    @property
    def remedy(self) -> str:
        """The remedy; empty for a code that is not declared."""
        kind = _kind(self.code)
        return kind.remedy if kind else ""

    @property
    def fails(self) -> Sequence[str]:
        """Names of the checks of a recording that fail with it."""
        kind = _kind(self.code)
        return (kind.fails or ()) if kind else ()

    @property
    def sentence(self) -> str:
        """The text without the command, which is printed in one piece to be pasted."""
        return self.text.removesuffix(self.command).rstrip()


def by_severity(finding: Finding) -> tuple[int, str, str, str]:
    """Return the key that sorts findings: the worst first, then by code."""
    return finding.severity, finding.code, finding.text, finding.where
