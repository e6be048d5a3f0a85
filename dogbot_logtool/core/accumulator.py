"""All figures of a walk: fed batch by batch, finished once.

    settings = StatsSettings(feet, mass_kg=19.2, wrench_frame=WrenchFrame.WORLD)
    accumulator = StatsAccumulator(settings)
    for batch in log:
        accumulator.add_odometry(odometry)
        accumulator.add_contacts(samples)
    stats = accumulator.finish()

Figures do not depend on where batches end. If header stamps turn out to be unusable, `finish`
raises `UnusableStamps`: then a second pass with ``time_source=TimeSource.LOG`` measures on log
time.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from dogbot_logtool.core.base.base_history import BaseRecorder
from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.checked_walk import Recorded
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.curves import CurveDetail
from dogbot_logtool.core.contact.foot_history import FootHistory, FootRecorder
from dogbot_logtool.core.evaluation import work_out
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Ints, rows_by_group
from dogbot_logtool.core.geometry.clock import TimeSource, UnusableStamps
from dogbot_logtool.core.quality.clocks import (
    ClockDifference,
    OffsetTrack,
    clock_differences,
    why_clocks_cannot_be_joined,
)
from dogbot_logtool.core.quality.quality import TopicQuality, TopicWatch, with_gaps
from dogbot_logtool.core.quality.stamps import StampFilter, set_spans, why_unusable
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.statistics import Stats

if TYPE_CHECKING:
    from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
    from dogbot_logtool.core.legs.joint_track import JointTable
    from dogbot_logtool.core.legs.leg_history import LegRecorder
    from dogbot_logtool.core.legs.settings import LegSettings
    from dogbot_logtool.core.recorded.vectors import VectorRecorder, VectorSamples

OnSamples = Callable[[int, Samples], None]
"""Receives a foot's number, and the next of its samples in the order of the log."""


class StatsAccumulator:
    """Measures a walk while its log streams past.

    Args:
        settings: what decides the figures.
        curves: keep load curves for drawing, in this detail; None keeps none, and costs nothing.
        on_samples: called with the samples of each foot as they are taken in.
        legs: where the log tells of its legs; None: nowhere.
    """

    def __init__(
        self,
        settings: StatsSettings,
        curves: CurveDetail | None = None,
        on_samples: OnSamples | None = None,
        legs: "LegSettings | None" = None,
    ) -> None:
        self._settings = settings
        self._on_samples = on_samples
        self._feet = [
            FootRecorder(
                settings.sensor(row).rule,
                settings.clock,
                force_in_world=settings.force_in_world,
                has_force=foot.has_force,
                curves=curves,
            )
            for row, foot in enumerate(settings.feet)
        ]
        self._base = BaseRecorder(settings.clock)
        self._samples: list[StampFilter[Samples]] = [
            StampFilter(foot.topic, settings.clock) for foot in settings.feet
        ]
        self._odometry: StampFilter[Odometry] = StampFilter(
            settings.odometry_topic or "the odometry", settings.clock
        )
        self._topics: dict[str, TopicWatch] = {}
        self._commands: VectorRecorder | None = None
        self._inertial: VectorRecorder | None = None
        self._legs = None if legs is None else _leg_recorder(legs, settings.clock)

    def add_contacts(self, samples: Samples) -> None:
        """Take in contact samples of any feet; each foot's in the order of the log."""
        for foot, rows in rows_by_group(samples.foot):
            for checked in self._samples[foot].add(samples.pick(rows)):
                self._add(foot, checked)

    def add_odometry(self, odometry: Odometry) -> None:
        """Take in odometry in the order of the log."""
        for checked in self._odometry.add(odometry):
            self._base.add(checked)

    def add_commands(self, commands: "VectorSamples", frames: Sequence[str]) -> None:
        """Take in velocity commands in the order of the log.

        Args:
            commands: linear x and y in m/s, angular z in rad/s.
            frames: header frame ids among them.
        """
        if self._commands is None:
            self._commands = _recorder(self._settings.command_topic, averages=False)
        self._commands.add(commands, frames)

    def add_accelerations(self, sensed: "VectorSamples", frames: Sequence[str]) -> None:
        """Take in what an accelerometer reads, in the order of the log.

        Args:
            sensed: m/s^2 in the sensor's frame.
            frames: header frame ids among them.
        """
        if self._inertial is None:
            self._inertial = _recorder(self._settings.imu_topic, averages=True)
        self._inertial.add(sensed, frames)

    def add_legs(
        self, joints: "Sequence[JointTable]", frames: "TransformBuffer", end: int | None
    ) -> None:
        """Take in what a batch tells of the legs; see `LegRecorder.add`."""
        if self._legs is not None:
            self._legs.add(joints, frames, end)

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
        """End the log and work out all figures.

        Raises:
            UnusableStamps: header stamps cannot be the clock of the log, and no option chose it.
        """
        breaks = self._check_stamps()
        feet = tuple(recorder.finish(breaks) for recorder in self._feet)
        on_stamps = self._settings.clock is TimeSource.HEADER
        clock, base_clock = self._settings.clock, self._base_clock()
        recorded = Recorded(
            feet=feet,
            base=self._base.finish(breaks),
            clocks=self._clocks() if on_stamps else (),
            topics=self._topic_qualities(feet),
            commands=self._commands.finish(clock, base_clock) if self._commands else None,
            inertial=self._inertial.finish(clock, base_clock) if self._inertial else None,
        )
        stats = work_out(self._settings, recorded)
        return stats if self._legs is None else self._with_legs(stats, self._legs)

    def _with_legs(self, stats: Stats, legs: "LegRecorder") -> Stats:
        from dogbot_logtool.core.leg_evaluation import with_legs  # noqa: PLC0415

        history = legs.finish()
        on_stamps = self._settings.clock is TimeSource.HEADER
        clocks = self._clocks(history.offsets) if on_stamps else ()
        return with_legs(stats, history, clocks)

    def _add(self, foot: int, samples: Samples) -> None:
        """Take in samples of a foot whose stamps are sound."""
        self._feet[foot].add(samples)
        if self._on_samples is not None:
            self._on_samples(foot, samples)

    def _check_stamps(self) -> Ints:
        """Check all header stamps; return the spans in which the clock was set.

        Returns:
            (s, 2) ns. Empty on header stamps, whose own steps show.
        """
        for foot, samples in enumerate(self._samples):
            for checked in samples.finish():
                self._add(foot, checked)
        for rest in self._odometry.finish():
            self._base.add(rest)
        checks = [*(each.check for each in self._samples), self._odometry.check]
        if self._settings.time_source is None:
            reason = why_unusable(checks) or why_clocks_cannot_be_joined(self._clocks())
            if reason:
                raise UnusableStamps(reason)
        on_log_time = self._settings.clock is TimeSource.LOG
        return timespans.merge(set_spans(checks)) if on_log_time else timespans.no_spans()

    def _clocks(
        self, others: "Mapping[str, OffsetTrack] | None" = None
    ) -> tuple[ClockDifference, ...]:
        """Compare the clocks of the topics that are measured, and of others, at the log's end."""
        feet = {foot.topic for foot in self._settings.feet}
        tracks = {}
        for topic in sorted({*feet, self._settings.odometry_topic} & self._topics.keys()):
            self._topics[topic].end()
            if self._topics[topic].has_stamps:
                tracks[topic] = self._topics[topic].offset_track()
        return clock_differences({**(others or {}), **tracks}, tuple(feet))

    def _base_clock(self) -> OffsetTrack | None:
        """Return how far the base's stamps lie behind log time; None without stamps."""
        watch = self._topics.get(self._settings.odometry_topic)
        if watch is None:
            return None
        watch.end()
        return watch.offset_track() if watch.has_stamps else None

    def _topic_qualities(self, records: Sequence[FootHistory]) -> tuple[TopicQuality, ...]:
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


def _recorder(topic: str, *, averages: bool) -> "VectorRecorder":
    """Return what keeps the vectors of a topic; loaded for logs that have such a topic."""
    from dogbot_logtool.core.recorded.vectors import VectorRecorder  # noqa: PLC0415

    return VectorRecorder(topic, averages=averages)


def _leg_recorder(legs: "LegSettings", clock: TimeSource) -> "LegRecorder":
    """Return what records the legs."""
    from dogbot_logtool.core.legs.leg_history import LegRecorder  # noqa: PLC0415

    return LegRecorder(legs, clock)
