"""Events that were found against labelled ones: which are missed, invented, late?"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.comparison.walks.event_files import LabelledEvent
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.dataclass import dataclass

WITHIN_S: Final = 0.05
"""s that an event may be early or late: what people who label steps agree on."""


@dataclass(frozen=True, slots=True)
class EventMatch:
    """Events of one type and foot."""

    foot: str
    type: str
    labelled: int
    late_s: tuple[float, ...]
    """s that each event found is after its label."""
    missed_s: tuple[float, ...]
    """Labels without an event."""
    invented_s: tuple[float, ...]
    """Events without a label, between the first label of the file and the last."""


def match_labels(
    labelled: Sequence[LabelledEvent], found: Sequence[LabelledEvent], within_s: float
) -> list[EventMatch]:
    """Match each label with the event nearest to it, each event once.

    Args:
        labelled: what is true, of the types that were labelled.
        found: events under the same names of feet; other types are of no concern.
        within_s: s between them at most.
    """
    first = min((each.onset_s for each in labelled), default=0.0) - within_s
    last = max((each.onset_s for each in labelled), default=0.0) + within_s
    matches = []
    for kind, foot in sorted({(each.type, each.foot) for each in labelled}):
        true, times = (
            np.array(sorted(e.onset_s for e in events if (e.type, e.foot) == (kind, foot)))
            for events in (labelled, found)
        )
        times = times[(times >= first) & (times <= last)]
        pairs = _pairs(true, times, within_s)
        late = tuple(float(times[column] - true[row]) for row, column in pairs)
        missed = np.delete(true, [row for row, _ in pairs])
        invented = np.delete(times, [column for _, column in pairs])
        matches.append(
            EventMatch(
                foot, kind, len(true), late, tuple(missed.tolist()), tuple(invented.tolist())
            )
        )
    return matches


def _pairs(true: Floats, found: Floats, within_s: float) -> list[tuple[int, int]]:
    """Return rows of labels and of events that are each other's nearest."""
    if not len(true) or not len(found):
        return []
    nearest = _nearest(true, found)
    mutual = _nearest(found, true)[nearest] == np.arange(len(true))
    close = np.abs(found[nearest] - true) <= within_s
    return [(row, int(nearest[row])) for row in np.flatnonzero(mutual & close).tolist()]


def _nearest(times: Floats, others: Floats) -> Ints:
    """(n,) row of the nearest of other times; both ascend."""
    after = np.clip(np.searchsorted(others, times), 1, max(len(others) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(others) - 1)
    nearer: Ints = np.where(times - others[before] <= others[after] - times, before, after)
    return nearer
