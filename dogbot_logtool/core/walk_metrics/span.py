"""A part of a walk that is measured: the whole log, or a segment of it."""

from collections.abc import Mapping, Sequence

from dogbot_logtool.core.base.motion import BaseMotion
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.gait.support_pattern import Support
from dogbot_logtool.core.load.load_figures import LoadFigures
from dogbot_logtool.core.stability.stability import Stability
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Span:
    """What was worked out of the whole log, or of a segment."""

    stats: Stats
    """Of the whole log."""
    segment: Segment | None
    """Whose phases make the gait: of the whole log the longest; None: there is none."""
    is_whole: bool
    base: BaseMotion | None
    feet: Sequence[FootStatistics]
    support: Support | None
    loads: LoadFigures
    stability: Stability | None

    @property
    def names(self) -> list[str]:
        """Names of the feet."""
        return [foot.name for foot in self.stats.feet]

    def by_name(self, values: Sequence[object]) -> Mapping[str, object]:
        """Return a value a foot by the names of the feet."""
        return dict(zip(self.names, values, strict=True))


def whole_log(stats: Stats) -> Span:
    """Return the whole log."""
    return Span(
        stats=stats,
        segment=stats.main,
        is_whole=True,
        base=stats.base,
        feet=stats.feet,
        support=stats.support,
        loads=stats.loads,
        stability=stats.stability,
    )


def segments(stats: Stats) -> list[Span]:
    """Return the segments in the order of time."""
    return [
        Span(
            stats=stats,
            segment=segment,
            is_whole=False,
            base=figures.base,
            feet=figures.feet,
            support=figures.support,
            loads=figures.loads,
            stability=figures.stability,
        )
        for segment, figures in zip(stats.segments, stats.segment_figures, strict=True)
    ]
