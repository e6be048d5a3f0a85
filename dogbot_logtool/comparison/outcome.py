"""Results of a comparison, and the words that all reports share."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Final, Literal

from dogbot_logtool.comparison.fields import FieldDifference, Findings
from dogbot_logtool.errors import DAMAGED
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.loss import Damage

SAME: Final = 0
DIFFERENT: Final = 1
RECORDS: Final = "(records)"
"""Stands for a topic in differences of profile, metadata and attachments."""


class Kind(StrEnum):
    """Kinds of differences."""

    TOPIC = "topic"
    """A whole topic is missing or extra."""
    DESCRIPTION = "description"
    """A topic's type, encoding or definition, or a record beside the messages."""
    MISSING = "missing"
    """A message that only the expected file has."""
    EXTRA = "extra"
    """A message that only the actual file has."""
    FIELD = "field"
    """A field of a message, or of a JSON document."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One difference, and the message and field in which it is."""

    kind: Kind
    topic: str
    """The topic; in a JSON document the key at its top."""
    path: str = ""
    expected: str = ""
    actual: str = ""
    deviation: float | None = None
    """|expected - actual| where both are finite numbers."""
    index: int | None = None
    """Index of the message among the topic's, in time order from 0: in the actual file for an
    extra one, else in the expected file."""
    time_s: float | None = None
    """s, the message's log time since the first message of the expected log."""

    @property
    def line(self) -> str:
        """The difference in a line."""
        message = printable(self.topic)
        if self.index is not None:
            message += f"[{self.index}] t={self.time_s:.3f} s"
        match self.kind:
            case Kind.MISSING | Kind.EXTRA:
                return f"{message}: {self.kind}"
            case Kind.TOPIC:
                return f"{message}: {self.path}"
        if self.index is None and self.kind is Kind.FIELD:
            message = ""
        where = " ".join(part for part in (message, printable(self.path)) if part)
        texts = f"expected {printable(self.expected)}, got {printable(self.actual)}"
        apart = "" if self.deviation is None else f" (|d| {self.deviation:.3g})"
        return f"{where or self.topic}: {texts}{apart}"


@dataclass(slots=True)
class Tally:
    """The counts of one topic, or of one part of a JSON document."""

    name: str
    """The topic."""
    type_name: str = ""
    expected: int = 0
    """Messages (values of a JSON document) in the expected file."""
    actual: int = 0
    equal: int = 0
    """The same bytes, or every field equal."""
    within_tolerance: int = 0
    """Not equal, but no further apart than allowed, or quaternions of the other sign."""
    different: int = 0
    missing: int = 0
    extra: int = 0
    faults: int = 0
    """Differences of the topic itself: its being there, its type, encoding and definition."""
    deviation: float = 0.0
    """The largest between two finite numbers, within tolerance or not."""
    deviation_path: str = ""
    """The field or file in which it is."""
    only_in: Literal["", "expected", "actual"] = ""
    """The file that alone has the topic."""
    note: str = ""
    """A remark on the comparison: that it was one of bytes, for instance."""

    @property
    def same(self) -> bool:
        """Whether nothing differs more than allowed."""
        return not (self.different or self.missing or self.extra or self.faults)

    def summary(self, unit: str) -> str:
        """Say in a line how the topic differs; `unit` is what is counted."""
        name = printable(self.name)
        if self.only_in:
            what = "is missing" if self.only_in == "expected" else "is extra"
            return f"{name}: {what} ({self.missing + self.extra} {unit})"
        parts = [f"{self.different} of {self.expected} {unit} different"] if self.different else []
        parts += [f"{self.missing} missing"] if self.missing else []
        parts += [f"{self.extra} extra"] if self.extra else []
        parts += ["described differently"] if self.faults else []
        apart = f" (largest |d| {self.deviation:.3g})" if self.deviation else ""
        return f"{name}: {', '.join(parts) or 'the same'}{apart}"

    def count_leaves(self, findings: Findings) -> None:
        """Count the leaves of a tree that was compared as a whole."""
        self.expected += findings.compared + findings.missing
        self.actual += findings.compared + findings.extra
        self.equal += findings.compared - findings.loose - findings.different
        self.within_tolerance += findings.loose
        self.different += findings.different
        self.missing += findings.missing
        self.extra += findings.extra
        self.deviate(findings.deviation_path, findings.deviation)

    def deviate(self, path: str, deviation: float) -> None:
        """Note how far apart two numbers are."""
        if deviation > self.deviation:
            self.deviation, self.deviation_path = deviation, path


@dataclass(slots=True)
class Differences:
    """The first differences; all are counted."""

    limit: int
    kept: list[Difference] = field(default_factory=list)
    count: int = 0

    @property
    def room(self) -> int:
        """How many more are kept."""
        return self.limit - len(self.kept)

    def add(self, difference: Difference) -> None:
        """Count a difference, and keep it if there is room."""
        self.count += 1
        if self.room > 0:
            self.kept.append(difference)

    def take(
        self,
        findings: Findings,
        topic: str,
        kind: Kind,
        index: int | None = None,
        time_s: float | None = None,
    ) -> None:
        """Add differences of fields, with the message in which they are."""
        for found in findings.differences[: self.room]:
            self.kept.append(field_difference(found, topic, kind, index, time_s))
        self.count += findings.count


@dataclass(frozen=True, slots=True)
class Comparison:
    """The result of comparing two files."""

    expected: Location
    actual: Location
    unit: str
    """The unit of the tallies: ``messages`` or ``values``."""
    tallies: Sequence[Tally]
    """A topic each, sorted; topics without a message too."""
    differences: Sequence[Difference]
    """The first ones: of the topics themselves, then in the order of time."""
    difference_count: int
    """All of them. A message or an array with several differing fields counts each."""
    damage: Sequence[Damage] = ()
    """What was lost of which file; sound files are left out."""
    warnings: Sequence[str] = ()
    """Sentences on a call that may not be what was meant; they change no exit code."""

    @property
    def same(self) -> bool:
        """Whether nothing that could be read differs more than allowed."""
        return all(tally.same for tally in self.tallies)

    @property
    def verdict(self) -> str:
        """The result in a line."""
        differing = [tally for tally in self.tallies if not tally.same]
        compared = sum(tally.expected for tally in self.tallies if tally.name != RECORDS)
        topics = [tally for tally in self.tallies if tally.name != RECORDS]
        what = f"{len(topics)} {'topics' if self.unit == 'messages' else 'parts'}"
        loose = sum(tally.within_tolerance for tally in self.tallies)
        tail = f", {loose} within tolerance" if loose else ""
        text = f"same: {what}, {compared} {self.unit}{tail}"
        if differing:
            counts = [
                (sum(tally.different for tally in self.tallies), "different"),
                (sum(tally.missing for tally in self.tallies), "missing"),
                (sum(tally.extra for tally in self.tallies), "extra"),
                (sum(tally.faults for tally in self.tallies), "described differently"),
            ]
            listed = ", ".join(f"{count} {word}" for count, word in counts if count)
            text = f"different: {listed}, of {what} and {compared} {self.unit}{tail}"
        return f"{text}; damaged, and compared as far as can be read" if self.damage else text

    @property
    def exit_code(self) -> int:
        """0: the same; 1: different; 3: the same as far as damaged files can be read."""
        if not self.same:
            return DIFFERENT
        return DAMAGED if self.damage else SAME


def field_difference(
    found: FieldDifference,
    topic: str,
    kind: Kind,
    index: int | None = None,
    time_s: float | None = None,
) -> Difference:
    """Say in which topic, and in which message, a field differs."""
    return Difference(
        kind, topic, found.path, found.expected, found.actual, found.deviation, index, time_s
    )
