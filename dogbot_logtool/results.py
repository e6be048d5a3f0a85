"""What is measured of a log, as commands return it and reports print it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from dogbot_logtool.reader.containers.loss import SOUND, Damage

# A command needs not load what only other commands' records are made of.
if TYPE_CHECKING:
    from dogbot_logtool.core.arrays import Floats
    from dogbot_logtool.core.metrics import WalkMetrics
    from dogbot_logtool.core.walk import Walk
    from dogbot_logtool.finding import Finding


@dataclass(frozen=True, slots=True)
class Measurement:
    """The walk of a log, and what was lost of the log."""

    walk: "Walk"
    damage: Damage = SOUND
    """What could not be read of the log."""

    @property
    def findings(self) -> "tuple[Finding, ...]":
        """On the log and its metrics, the worst first."""
        return self.walk.findings

    @property
    def metrics(self) -> "WalkMetrics":
        """Those of the walk; what findings void is null."""
        return self.walk.metrics


class StrideTable(NamedTuple):
    """Strides foot by foot, each foot's in order."""

    foot: tuple[str, ...]
    """(n,) names."""
    columns: "Mapping[str, Floats]"
    """(n,) by name, the unit at its end; NaN where not known. `start_s` counts from the log's
    first message of use."""


@dataclass(frozen=True, slots=True)
class Figures:
    """The metrics of one log, small enough to send and store."""

    summary: tuple[str, ...]
    """Its row among several logs."""
    json: dict[str, Any]
    """Its `stats --json`; empty where that was not asked for."""
    strides: "StrideTable"
    interval_s: float
    """s, the longest sampling interval of its feet: no time is known more finely."""
    damage: Damage
    whole: "Measurement | None" = None
    """All there is, if it was asked for."""
