"""All figures of a walk: fed batch by batch, finished once.

    settings = StatsSettings(feet, mass_kg=19.2, wrench_frame=WrenchFrame.WORLD)
    accumulator = StatsAccumulator(settings)
    for batch in log:
        accumulator.add_odometry(odometry)
        accumulator.add_contacts(samples)
    stats = accumulator.finish()

Figures do not depend on where batches end. If header stamps turn out to be unusable, `add_...`
raises `UnusableStamps`: then a second pass with ``time_source=TimeSource.LOG`` measures on log
time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from dogbot_logtool.core.base.base_motion import BaseMotion, base_motion
from dogbot_logtool.core.base.base_record import BaseRecord, BaseRecorder
from dogbot_logtool.core.base.falls import fallen_spans
from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.curves import CurveDetail
from dogbot_logtool.core.contact.foot_history import FootRecord, FootRecorder
from dogbot_logtool.core.gait.foot_statistics import (
    FootFigures,
    contact_time_without_pose_s,
    foot_figures,
    overlap,
)
from dogbot_logtool.core.gait.segments import Segment, find_segments, main_segment, stands
from dogbot_logtool.core.gait.support_pattern import Support, support
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Ints, rows_by_group
from dogbot_logtool.core.geometry.clock import StampWatch
from dogbot_logtool.core.leg_position import quadruped
from dogbot_logtool.core.load.load_figures import LoadFigures, dead_feet, load_figures
from dogbot_logtool.core.quality.quality import TopicQuality, TopicWatch, with_gaps
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.stability.stability import Stability, stability


@dataclass(frozen=True, slots=True)
class Stats:
    """All figures of one log."""

    settings: StatsSettings
    origin: int
    """ns on the clock used: the earliest time of any used message; what times are counted from."""
    end: int
    """ns, the latest."""
    feet: tuple[FootFigures, ...]
    reference: int
    """The foot that phases are measured against: the first that has strides."""
    corners: tuple[int, int, int, int] | None
    """Which foot is front left, front right, back left, back right; None: no quadruped, or
    not known."""
    base_record: BaseRecord
    base: BaseMotion | None
    segments: tuple[Segment, ...]
    main: Segment | None
    """The longest segment: its class is the log's."""
    support: Support | None
    loads: LoadFigures
    stability: Stability | None
    fallen: Ints
    """(f, 2) ns, spans in which the robot lies."""
    topics: tuple[TopicQuality, ...]
    overlap_s: float
    """s, time known to all feet that have messages and to the base."""
    contact_without_pose_s: tuple[float, ...]
    """s a foot, time in contact further than 0.1 s from every pose."""

    def seconds(self, time: Ints) -> list[float]:
        """Return times as seconds since the origin, to the nanosecond."""
        return [each / 1e9 for each in (time - self.origin).tolist()]


class StatsAccumulator:
    """Measures a walk while its log streams past.

    Args:
        settings: what decides the figures.
        curves: keep load curves for drawing, in this detail; None keeps none, and costs nothing.
    """

    def __init__(self, settings: StatsSettings, curves: CurveDetail | None = None) -> None:
        self._settings = settings
        self._feet = [
            FootRecorder(
                settings.rule,
                settings.clock,
                force_in_world=settings.force_in_world,
                has_force=foot.has_force,
                curves=curves,
            )
            for foot in settings.feet
        ]
        self._base = BaseRecorder(settings.clock)
        self._stamps = [StampWatch(foot.topic) for foot in settings.feet]
        self._base_stamps = StampWatch(settings.odometry_topic or "the odometry")
        self._topics: dict[str, TopicWatch] = {}

    def add_contacts(self, samples: Samples) -> None:
        """Take in contact samples of any feet; each foot's in the order of the log.

        Raises:
            UnusableStamps: a header stamp is zero or goes backwards, and nobody chose a clock.
        """
        for foot, rows in rows_by_group(samples.foot):
            of_foot = samples.pick(rows)
            if self._settings.time_source is None:
                self._stamps[foot].watch(of_foot.stamp)
            self._feet[foot].add(of_foot)

    def add_odometry(self, odometry: Odometry) -> None:
        """Take in odometry in the order of the log.

        Raises:
            UnusableStamps: as `add_contacts`.
        """
        if self._settings.time_source is None:
            self._base_stamps.watch(odometry.stamp)
        self._base.add(odometry)

    def add_message_times(
        self, topic: str, log_time: Ints, stamp: Ints | None, frame_ids: Sequence[str] = ()
    ) -> None:
        """Take in the times of a topic's messages, in the order of the log, for its quality.

        Args:
            topic: any topic of the log.
            log_time: (n,) ns.
            stamp: (n,) ns, header stamps; None for messages without a header.
            frame_ids: header frame ids seen among them.
        """
        watch = self._topics.setdefault(topic, TopicWatch(topic))
        watch.add(log_time, stamp, tuple(frame_ids))

    def finish(self) -> Stats:
        """End the log and work out all figures."""
        settings = self._settings
        records = [recorder.finish() for recorder in self._feet]
        base = self._base.finish()
        fallen = fallen_spans(base, records)
        loads = load_figures(records, settings.body_weight_n)
        dead = dead_feet(records, loads)
        feet = tuple(
            foot_figures(
                foot.name,
                foot.topic,
                foot.place,
                record,
                base,
                fallen=fallen,
                foot_rolling_m=settings.foot_rolling_m,
                is_dead=is_dead,
            )
            for foot, record, is_dead in zip(settings.feet, records, dead, strict=True)
        )
        reference = next((row for row, foot in enumerate(feet) if len(foot.strides.stance)), 0)
        corners = quadruped([foot.place for foot in settings.feet])
        # Where one foot's state is not known, it is not known which feet are down.
        supported = None if any(dead) else support(records)
        segments = _segments(feet, reference, corners, supported, fallen)
        origin, end = _extent(records, base)
        return Stats(
            settings=settings,
            origin=origin,
            end=end,
            feet=feet,
            reference=reference,
            corners=corners,
            base_record=base,
            base=base_motion(base, settings.forward_axis),
            segments=segments,
            main=main_segment(segments),
            support=supported,
            loads=replace(loads, share_of=None, shares=None) if any(dead) else loads,
            stability=None if any(dead) else self._stability(records, base, loads),
            fallen=fallen,
            topics=self._topic_qualities(records),
            overlap_s=timespans.total(overlap(records, base)) / 1e9,
            contact_without_pose_s=tuple(
                contact_time_without_pose_s(record, base) for record in records
            ),
        )

    def _topic_qualities(self, records: Sequence[FootRecord]) -> tuple[TopicQuality, ...]:
        """Return the timing of all topics; a swing is no gap of a sensor that is silent in swing.

        Such a topic has a gap where none of its feet is known to swing or to stand.
        """
        found = {name: watch.finish(self._settings.clock) for name, watch in self._topics.items()}
        gaps: dict[str, list[Ints]] = {}
        for foot, record in zip(self._settings.feet, records, strict=True):
            if foot.silent_in_swing and record.start is not None:
                gaps.setdefault(foot.topic, []).append(record.gaps)
        for topic, spans in gaps.items():
            if topic in found:
                found[topic] = with_gaps(found[topic], timespans.intersect(spans))
        return tuple(quality for _, quality in sorted(found.items()))

    def _stability(
        self, records: Sequence[FootRecord], base: BaseRecord, loads: LoadFigures
    ) -> Stability | None:
        known = loads.share_of == "vertical_impulse"
        return stability(records, base, self._settings.forward_axis, vertical_known=known)


def _segments(
    feet: Sequence[FootFigures],
    reference: int,
    corners: tuple[int, int, int, int] | None,
    supported: Support | None,
    fallen: Ints,
) -> tuple[Segment, ...]:
    if not feet:
        return ()
    period = feet[reference].stride_period_s
    all_down = supported.all_down if supported else timespans.no_spans()
    # A robot that lies with its feet on the ground does not stand.
    upright = timespans.subtract(all_down, fallen)
    standing = stands(upright, period.median if period else None)
    return find_segments([foot.events for foot in feet], reference, corners, standing)


def _extent(feet: Sequence[FootRecord], base: BaseRecord) -> tuple[int, int]:
    """First and last time of any used message, ns; zeros in an empty log."""
    starts = [foot.start for foot in feet if foot.start is not None]
    ends = [foot.end for foot in feet if foot.end is not None]
    if len(base.time):
        starts.append(int(base.time[0]))
        ends.append(int(base.time[-1]))
    return min(starts, default=0), max(ends, default=0)
