"""A kind of log, what happens in it, and how far what is measured may be off."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from tests.truth.recording import Disturbance, Recording, disturbed
from tests.truth.walking import Walk


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far a right figure may be from the truth."""

    event_s: float = 0.03
    duty: float = 0.03
    contact: float = 0.03
    force: float = 0.05
    """Of the force."""
    margin: float = 0.01
    """m"""


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happens in a log beside steps."""

    type: str
    onset_s: float
    within_s: float = 0.02
    """Of the onset and of the duration."""
    foot: str | None = None
    code: str | None = None
    """None: any."""
    duration_s: float | None = None
    value: tuple[float, float] | None = None
    """And how far it may be off."""

    def is_told_by(self, event: Mapping[str, Any]) -> bool:
        """Tell whether an event of the JSON is this one."""
        size, within = self.value or (event["value"], 0.0)
        lasts_s = event["duration_s"] if self.duration_s is None else self.duration_s
        return (
            (event["type"], event["foot"]) == (self.type, self.foot)
            and self.code in {None, event["code"]}
            and abs(event["onset_s"] - self.onset_s) <= self.within_s
            and abs(event["duration_s"] - lasts_s) <= self.within_s
            and (self.value is None or abs(event["value"] - size) <= within)
        )


class Recordable(Protocol):
    """A walk, a scene, or several of them."""

    def recorded(self, rate_hz: float) -> Recording:
        """Return the messages of perfect sensors."""


@dataclass(frozen=True, slots=True)
class Case:
    """A kind of log, and what may be made of it."""

    name: str
    walk: Recordable
    faults: tuple[Disturbance, ...] = ()
    says: str = ""
    """Pattern of a finding that there must be, even if all figures are right."""
    cause: str | None = None
    """Pattern of a finding that excuses nulls; empty: nothing does; None: as `says`."""
    tolerance: Tolerance = field(default_factory=Tolerance)
    skip: str = ""
    """Figures that are not judged, with commas: the truth of them is not known."""
    known: str = ""
    """Figures that must not be null, whatever is found, with commas."""
    rate_hz: float = 200.0
    silence_s: tuple[float, float] | None = None
    """Feet are silent between, or in stances that a silence cuts: events in it are not
    judged."""
    shifted: bool = False
    """Whether the feet's clock is another one: times of events may differ by a constant."""
    events: tuple[Event, ...] | None = None
    """Beside steps and falls; None: without faults there are none, else they are not judged."""

    @property
    def excuse(self) -> str:
        """Pattern of the findings that excuse nulls."""
        return self.says if self.cause is None else self.cause

    @property
    def happens(self) -> tuple[Event, ...] | None:
        """Events that must be found, and no others; None: any may be."""
        return () if self.events is None and not self.faults else self.events

    def record(self) -> Recording:
        """Return the messages; the odometry comes a hundred times a second at most."""
        if isinstance(self.walk, Walk):
            recording = self.walk.recorded(self.rate_hz, min(self.rate_hz, 100.0))
        else:
            recording = self.walk.recorded(self.rate_hz)
        return disturbed(recording, *self.faults)
