"""Results of a comparison, and the words that all reports share."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, Final, Literal, NamedTuple

from dogbot_logtool.errors import DAMAGED
from dogbot_logtool.io.printable import printable
from dogbot_logtool.reader.containers.loss import Damage

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

    path: str = ""
    """``entities[0].arrows[0].pose.position.z``."""
    expected: str = ""
    actual: str = ""
    deviation: float | None = None
    """|expected - actual| where both are finite numbers."""
    kind: Kind = Kind.FIELD
    topic: str = ""
    """The topic; in a JSON document the key at its top."""
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
        if self.kind in {Kind.MISSING, Kind.EXTRA, Kind.TOPIC}:
            return f"{message}: {self.path or self.kind}"
        if self.index is None and self.kind is Kind.FIELD:
            message = ""
        where = " ".join(part for part in (message, printable(self.path)) if part)
        texts = f"expected {printable(self.expected)}, got {printable(self.actual)}"
        apart = "" if self.deviation is None else f" (|d| {self.deviation:.3g})"
        return f"{where or self.topic}: {texts}{apart}"


class Leaf(NamedTuple):
    """What two values come to: fields of messages, or of JSON documents."""

    outcome: Literal["equal", "within_tolerance", "different", "missing", "extra"]
    path: str = ""
    expected: str = ""
    actual: str = ""
    deviation: float = -math.inf
    """|expected - actual| of numbers."""
    values: int = 1
    """How many values it is so of."""


EQUAL: Final = Leaf("equal")


@dataclass(slots=True)
class Tally:
    """The counts of one topic, or of one part of a JSON document."""

    name: str = ""
    """The topic."""
    type_name: str = ""
    equal: int = 0
    """Messages (values of a JSON document) of the same bytes, or with every field equal."""
    within_tolerance: int = 0
    """Not equal, but no further apart than allowed, or quaternions of the other sign."""
    different: int = 0
    missing: int = 0
    """In the expected file only."""
    extra: int = 0
    """In the actual file only."""
    described_differently: int = 0
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
    def both(self) -> int:
        """What both files have."""
        return self.equal + self.within_tolerance + self.different

    @property
    def expected(self) -> int:
        """What the expected file has."""
        return self.both + self.missing

    @property
    def actual(self) -> int:
        """What the actual file has."""
        return self.both + self.extra

    @property
    def same(self) -> bool:
        """Whether nothing differs more than allowed."""
        return not (self.different or self.missing or self.extra or self.described_differently)

    def add(self, leaf: Leaf) -> None:
        """Count a pair of values."""
        setattr(self, leaf.outcome, getattr(self, leaf.outcome) + leaf.values)
        if self.deviation < leaf.deviation < math.inf:
            self.deviation, self.deviation_path = leaf.deviation, leaf.path

    def add_message(self, index: int, leaves: Sequence[Leaf]) -> None:
        """Count a message as one that is equal or not."""
        for leaf in (each for each in leaves if each.deviation > self.deviation):
            self.add(leaf._replace(path=f"[{index}] {leaf.path}", values=0))
        unequal = {leaf.outcome for leaf in leaves} - {"equal"}
        self.equal += not unequal
        self.within_tolerance += unequal == {"within_tolerance"}
        self.different += bool(unequal - {"within_tolerance"})


def counted(tallies: Sequence[Tally]) -> str:
    """Say how many of what is counted differ, and how."""
    names = "different", "missing", "extra", "described_differently"
    counts = {name: sum(getattr(each, name) for each in tallies) for name in names}
    return ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in counts.items() if count)


class Differences:
    """Differences between two files: all are counted, the first are kept."""

    def __init__(self, limit: int) -> None:
        """Begin with none, to keep so many."""
        self._limit = limit
        self.kept: list[Difference] = []
        self.count = 0
        """All differences; whatever is missing or extra at the end of an array is one."""

    def add(self, leaf: Leaf, **where: Any) -> None:  # noqa: ANN401 - fields of `Difference`
        """Count a pair of values if they differ, and keep the difference if there is room."""
        if leaf.outcome in {"equal", "within_tolerance"} or not leaf.values:
            return
        self.count += leaf.values if leaf.outcome == "different" else 1
        if len(self.kept) < self._limit:
            deviation = leaf.deviation if math.isfinite(leaf.deviation) else None
            texts = leaf.path, leaf.expected, leaf.actual
            self.kept.append(Difference(*texts, deviation, **where))


class Comparison(NamedTuple):
    """The result of comparing two files."""

    expected: Path
    actual: Path
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

    warnings: tuple[str, ...] = ()
    """Sentences on a call that may not be what was meant; they change no exit code."""

    @property
    def same(self) -> bool:
        """Whether nothing that could be read differs more than allowed."""
        return all(tally.same for tally in self.tallies)

    @property
    def verdict(self) -> str:
        """The result in a line."""
        topics = [tally for tally in self.tallies if tally.name != RECORDS]
        what = f"{len(topics)} {'topics' if self.unit == 'messages' else 'parts'}"
        of = f"{sum(tally.expected for tally in topics)} {self.unit}"
        text = (
            f"same: {what}, {of}"
            if self.same
            else f"different: {counted(self.tallies)}, of {what} and {of}"
        )
        if loose := sum(tally.within_tolerance for tally in self.tallies):
            text += f", {loose} within tolerance"
        return f"{text}; damaged, and compared as far as can be read" if self.damage else text

    @property
    def exit_code(self) -> int:
        """0: the same; 1: different; 3: the same as far as damaged files can be read."""
        if not self.same:
            return 1
        return DAMAGED if self.damage else 0
