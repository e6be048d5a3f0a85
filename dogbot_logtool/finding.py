"""Findings about a log: one kind for the whole program.

Every code is declared once, in ``findings.toml``, with its severity, its meaning, what to do about
it and the metrics that it voids.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cache
from pathlib import Path
from string import Formatter
from typing import Any, Final


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


@dataclass(frozen=True, slots=True)
class FindingCase:
    """What is otherwise in one case of a finding; None: nothing is."""

    severity: Severity | None = None
    fails: Sequence[str] | None = None
    voids: Sequence[str] = ()
    """Beside those of the finding."""


@dataclass(frozen=True, slots=True)
class FindingKind:
    """The meaning of a code in any log."""

    code: str
    subject: str
    severity: Severity
    meaning: str
    """A sentence."""
    remedy: str
    """A sentence on what to do about it."""
    rank: int | None = None
    """Of those that make metrics doubtful; 1 is of most consequence. None: it does not."""
    fails: Sequence[str] | None = None
    """Questions about a recording that fail with it; None: it is not about metrics."""
    voids: Sequence[str] = ()
    """Patterns of the metrics that it sets to null; ``{foot}`` stands for a foot's name."""
    cases: Mapping[str, FindingCase] = field(default_factory=dict)
    texts: Mapping[str, str] = field(default_factory=dict)
    """Its sentences, by what is found; ``plain`` is the usual one."""


@cache
def finding_kinds() -> Mapping[str, FindingKind]:
    """Return every kind of finding by its code, in the order of the subjects."""
    return _kinds(_declarations())


@cache
def _declarations() -> str:
    return Path(__file__).with_name("findings.toml").read_text(encoding="utf-8")


def _kinds(declarations: str) -> Mapping[str, FindingKind]:
    return {
        code: FindingKind(code, subject, **_with_types(words))
        for subject, kinds in tomllib.loads(declarations).items()
        for code, words in kinds.items()
    }


def _with_types(words: Mapping[str, Any]) -> dict[str, Any]:
    """Return the words of a declaration, with records for its severity and its cases."""
    found = dict(words)
    if "severity" in found:
        found["severity"] = Severity[found["severity"].upper()]
    if "cases" in found:
        cases = found["cases"].items()
        found["cases"] = {name: FindingCase(**_with_types(each)) for name, each in cases}
    return found


@cache
def _kind(code: str) -> FindingKind:
    """Return a kind of finding by its code; parsing the table of all takes long."""
    start = f".{code}]\n"
    own = (each for each in _declarations().split("\n\n") if start in each)
    return _kinds(next(own))[code]


@dataclass(frozen=True, slots=True)
class Finding:
    """One fact about a log."""

    code: str
    """One of the `finding_kinds`."""
    text: str
    """A sentence."""
    where: str = ""
    """The topic or the metric, if it is about one."""
    command: str = ""
    """A command to type, if one is known; `text` ends with it."""
    cases: tuple[str, ...] = ()
    """Cases of its kind that it is."""
    feet: tuple[str, ...] = ()
    """Names of the feet whose metrics it voids."""

    @property
    def kind(self) -> FindingKind:
        """Its declaration."""
        return _kind(self.code)

    @property
    def severity(self) -> Severity:
        """How much it matters."""
        severities = [self.kind.cases[case].severity for case in self.cases]
        return next((each for each in severities if each is not None), self.kind.severity)

    @property
    def remedy(self) -> str:
        """What to do about it."""
        return self.kind.remedy

    @property
    def fails(self) -> Sequence[str]:
        """Questions about a recording that fail with it; a note fails none."""
        if self.severity is Severity.NOTE:
            return ()
        declared = [self.kind.cases[case].fails for case in self.cases]
        return next((each for each in declared if each is not None), self.kind.fails) or ()

    @property
    def voids(self) -> tuple[str, ...]:
        """Patterns of the metrics that it sets to null."""
        patterns = [*self.kind.voids]
        for case in self.cases:
            patterns += self.kind.cases[case].voids
        found: dict[str, None] = {}
        for pattern in patterns:
            names = self.feet if "{foot}" in pattern else ("",)
            found |= dict.fromkeys(pattern.replace("{foot}", name) for name in names)
        return tuple(found)

    @property
    def rank(self) -> int | None:
        """Its consequence among findings that make metrics doubtful; None: it does not."""
        return None if self.severity is Severity.NOTE else self.kind.rank

    @property
    def sentence(self) -> str:
        """The text without the command, which is printed in one piece to be pasted."""
        return self.text.removesuffix(self.command).rstrip()


class _Words(Formatter):
    """Formats values as usual, and numbers with a noun: ``{gaps:gap}``."""

    def format_field(self, value: Any, format_spec: str) -> Any:  # noqa: ANN401 - as the parent has it
        if format_spec.replace(" ", "").isalpha():
            return counted(value, format_spec)
        return super().format_field(value, format_spec)


Words = dict[str, Any]
"""What a sentence names."""


def counted(number: int, thing: str) -> str:
    """Return a number with its noun, in the plural where it is not one."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


_WORDS: Final = _Words()


def found(
    code: str,
    *cases: str,
    where: str = "",
    say: str = "",
    feet: Sequence[str] = (),
    **values: object,
) -> Finding:
    """Return a finding with the sentence that `findings.toml` has for it.

    Args:
        code: one of the `finding_kinds`.
        cases: of its kind that it is.
        where: the topic or the metric that it is about; if not given, the foot or topic that its
            sentence names.
        say: which of its sentences; if not given, that of its first case, or the plain one.
        feet: names of the feet whose metrics it voids; the first is ``foot`` in its sentence.
        values: what the sentence names.
    """
    texts = _kind(code).texts
    named = [each for each in (say, *cases[:1], "plain") if each in texts]
    words = {"foot": feet[0], **values} if feet else values
    about = f"feet.{words['foot']}" if "foot" in words else str(words.get("topic", ""))
    text = _WORDS.vformat(texts[named[0]], (), words)
    return Finding(code, text, where or about, cases=cases, feet=tuple(feet))


def by_severity(finding: Finding) -> tuple[int, str, str, str]:
    """Return the key that sorts findings: the worst first, then by code."""
    return finding.severity, finding.code, finding.text, finding.where
