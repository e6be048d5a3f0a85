"""A quick look into a log: what a few of its chunks, spread over it, show.

Some decisions must be made before the first message is written: in which frame the wrenches are,
what the frames are called, whether the base has a parent already. They are made here, the same way
for every command.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.base.odometry import Odometry
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.frames.transform_buffer import TransformBuffer
from dogbot_logtool.core.frames.wrench_frame import (
    FrameFit,
    WrenchFrame,
    WrenchFrameEvidence,
    frame_fit,
    judge_wrench_frame,
)
from dogbot_logtool.core.geometry.arrays import Flags, Ints, all_finite
from dogbot_logtool.core.geometry.blocks import concatenated
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.geometry.order_statistics import distinct, median_of
from dogbot_logtool.core.geometry.rotations import normalised, roll_pitch_yaw
from dogbot_logtool.core.load.loads import body_weight_n
from dogbot_logtool.core.plausible import plausible_odometry
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.pipeline.chunks import spread_chunks
from dogbot_logtool.pipeline.frames.world_frames import WorldFrames, follow_frames
from dogbot_logtool.pipeline.robot_model.skeleton import FramePose, Point
from dogbot_logtool.pipeline.robot_model.soles import STANCE_SPREAD_M, SoleFinder, first_poses
from dogbot_logtool.pipeline.topics.selection import Selection
from dogbot_logtool.reader.containers.log import Batch, Chunk, Log
from dogbot_logtool.reader.messages.bases.registry import joined_poses
from dogbot_logtool.reader.messages.bases.source import BasePoses
from dogbot_logtool.reader.messages.contacts.registry import read_contacts
from dogbot_logtool.reader.messages.contacts.source import StepTiming
from dogbot_logtool.reader.messages.frame_tracks import static_tracks
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.reader.messages.transforms import (
    decode_transforms,
    frame_pairs,
    transform_columns,
)
from dogbot_logtool.robot import Robot

DEFAULT_WORLD: Final = "world"
DEFAULT_BASE: Final = "base_link"
_REGULAR: Final = 0.75
"""Share of messages that must have the usual lag. Only the last of each stance should not."""
_BURST: Final = 0.5
"""Messages that are logged in less than this part of the time between their stamps come in
bursts."""
_USUAL_INTERVAL_NS: Final = 10_000_000
"""ns, assumed of a sensor that sent hardly any message."""


@dataclass(frozen=True, slots=True)
class Probe:
    """The results of the probe."""

    wrench_frame: WrenchFrameEvidence
    world_frames: tuple[str, ...]
    """Header frame ids of the odometry, as recorded, sorted; also `base_frames`, its children."""
    base_frames: tuple[str, ...]
    parents: Mapping[str, frozenset[str]]
    """Parents that the log's own transforms give each frame, without leading slashes."""
    statics: TransformBuffer
    """The log's transforms that hold for ever; of each frame the last one does."""
    slashed_frames: tuple[str, ...]
    """Frame ids that begin with a slash, which no viewer of today accepts."""
    links: tuple[str | None, ...]
    """Link that each foot's collision belongs to, in whose frame its wrenches may be."""
    intervals: Mapping[int, int]
    """ns between messages in contact, by foot, of the feet that are silent in swing."""
    silence_clock: TimeSource
    """Clock on which their silences are seen."""
    left_after_ns: int | None
    """See `FootChannels.left_after_ns`."""
    touching: frozenset[int]
    """Feet that were seen in contact."""
    contacts: Samples
    """All contact samples that were seen, as recorded."""
    zero_stamps: frozenset[str]
    """Topics whose header stamps are all zero."""
    chunks_seen: int
    chunks: int
    frame_poses: Mapping[str, FramePose] = field(default_factory=dict)
    """The first pose that was seen of each frame, by name without a leading slash."""
    soles: Mapping[int, Point] = field(default_factory=dict)
    """m, where feet touch the ground in the frames of their `links`, as far as it is known, and
    asked for."""
    exact_soles: Mapping[int, Point] = field(default_factory=dict)
    """m, the same, not rounded."""
    stances: Mapping[int, Point] = field(default_factory=dict)
    """m, the same in the base's frame: the median while the foot stands."""
    turned_deg: float = 0.0
    """Yaw of the base in the world when it was first seen; asked for like `soles`."""

    @property
    def forceless(self) -> frozenset[int]:
        """Feet whose wrenches are zero in every contact: some physics engines tell none."""
        touching = self.contacts.pick(self.contacts.in_contact)
        loaded = touching.foot[(touching.force != 0.0).any(axis=1)]
        return frozenset(touching.foot.tolist()) - frozenset(loaded.tolist())


def probe_log(log: Log, selection: Selection, *, with_soles: bool = False) -> Probe:
    """Look into chunks from the start to the end of a log.

    Args:
        log: an open log.
        selection: its topics.
        with_soles: find `soles` and `stances`, too, which pictures of the robot need.
    """
    look = _Prober(selection)
    chosen = _spread(log, selection)
    for span in log.grouped(chosen):
        look.take(log.read(span).in_time_order())
    probe = look.probe(len(chosen), len(log.chunks))
    return look.with_soles(probe) if with_soles else probe


def _spread(log: Log, selection: Selection) -> list[Chunk]:
    """Choose chunks: evenly spaced among those that hold used topics, and all static frames."""
    used = {c.id for c in (*selection.odometry, *selection.contacts, *selection.transforms)}
    static = selection.static_transforms
    chosen = {chunk.offset for chunk in spread_chunks(log, used)}
    chosen |= {c.offset for c in log.chunks if c.counts and not static.isdisjoint(c.counts)}
    return [chunk for chunk in log.chunks if chunk.offset in chosen]


@dataclass(frozen=True, slots=True)
class _Look:
    """Samples, poses and transforms of a batch."""

    samples: Sequence[Samples]
    base: Odometry
    """Plausible poses."""
    transforms: Sequence[DecodedMessages]


class _Prober:
    def __init__(self, selection: Selection) -> None:
        self._selection = selection
        self._looks: list[_Look] = []
        self._world: set[str] = set()
        self._base: set[str] = set()
        self._parents: dict[str, set[str]] = {}
        self._statics = TransformBuffer()
        self._slashed: set[str] = set()
        self._stamped: dict[str, bool] = {}
        self._links: dict[int, set[str]] = {}
        self._steps: dict[int, list[Ints]] = {}
        self._timings: list[StepTiming] = []
        self._touching: set[int] = set()
        self._frame_poses: dict[str, FramePose] = {}
        self._contacts: list[Samples] = [no_samples()]

    def take(self, batch: Batch) -> None:
        """Look at the messages of a batch."""
        selection = self._selection
        base = selection.read_base(batch)
        contacts = read_contacts(batch, selection.contacts, selection.foot_channels())
        transforms = decode_transforms(batch, selection.transforms)
        poses, _ = plausible_odometry(joined_poses(base))
        self._looks.append(_Look([read.reduced.samples for read in contacts], poses, transforms))
        self._take_base(base)
        for read in contacts:
            samples = read.reduced.samples
            self._contacts.append(samples)
            if (timing := read.timing) is not None:
                self._timings.append(timing)
            self._touching.update(distinct(samples.foot[samples.in_contact]).tolist())
            for foot, names in read.links.items():
                self._links.setdefault(foot, set()).update(names)
            if read.source.has_header:
                stamps = read.messages.table.nanoseconds("header.stamp")
                self._see_stamps(read.messages.channel, stamps)
            if read.source.silent_in_swing:
                for foot in distinct(samples.foot).tolist():
                    steps = _steps(samples.pick(samples.foot == foot), _begins(batch))
                    self._steps.setdefault(foot, []).append(steps)
        for messages in transforms:
            self._see_frames(messages)

    def _see_frames(self, messages: DecodedMessages) -> None:
        """Note parents, first poses, and transforms that hold for ever."""
        static = self._selection.static_transforms
        for parent, child in frame_pairs(messages):
            self._slashed.update(name for name in (parent, child) if name.startswith("/"))
            self._parents.setdefault(child.lstrip("/"), set()).add(parent.lstrip("/"))
        columns = transform_columns(messages)
        for child, pose in first_poses(columns, static).items():
            self._frame_poses.setdefault(child, pose)
        if static:
            self._statics = self._statics.then(static_tracks(columns, static))

    def _take_base(self, base: Sequence[BasePoses]) -> None:
        chosen = self._selection.base
        for poses in base:
            self._world.update(poses.worlds)
            self._base.update(poses.bases)
            if chosen is not None and chosen.source.has_header:
                self._see_stamps(poses.channel, poses.poses.stamp)

    def _see_stamps(self, channel: Ints, stamp: Ints) -> None:
        topics = {c.id: c.topic for c in (*self._selection.odometry, *self._selection.contacts)}
        for number in distinct(channel).tolist():
            stamped = bool((stamp[channel == number] != 0).any())
            topic = topics[number]
            self._stamped[topic] = self._stamped.get(topic, False) or stamped

    def probe(self, seen: int, chunks: int) -> Probe:
        """Sum up."""
        frames = self._world | self._base
        steps = {foot: np.concatenate(parts) for foot, parts in sorted(self._steps.items())}
        silence_clock = _silence_clock(steps.values())
        self._slashed.update(name for name in frames if name.startswith("/"))
        probe = Probe(
            wrench_frame=WrenchFrameEvidence(WrenchFrame.UNKNOWN),
            world_frames=tuple(sorted(self._world)),
            base_frames=tuple(sorted(self._base)),
            parents={child: frozenset(names) for child, names in sorted(self._parents.items())},
            statics=self._statics,
            slashed_frames=tuple(sorted(self._slashed)),
            links=tuple(
                next(iter(names)) if len(names := self._links.get(foot, set())) == 1 else None
                for foot in range(len(self._selection.robot.feet))
            ),
            intervals={foot: _interval(each, silence_clock) for foot, each in steps.items()},
            silence_clock=silence_clock,
            left_after_ns=left_after(self._timings),
            touching=frozenset(self._touching),
            contacts=concatenated(self._contacts),
            zero_stamps=frozenset(topic for topic, stamped in self._stamped.items() if not stamped),
            chunks_seen=seen,
            chunks=chunks,
            frame_poses=self._frame_poses,
        )
        return replace(probe, wrench_frame=self._wrench_frame(probe))

    def with_soles(self, probe: Probe) -> Probe:
        """Return the probe with the points where feet touch the ground."""
        probe = replace(probe, stances=self._stances(probe), turned_deg=self._turned_deg())
        placed = self._frames(probe)
        if placed is None:
            return probe
        soles = self._filled(SoleFinder(placed), placed)
        return replace(probe, soles=soles.points(), exact_soles=soles.exact_points())

    def _turned_deg(self) -> float:
        """Return the yaw of the base's first usable pose; 0 where none was seen."""
        for look in self._looks:
            turns = look.base.orientation
            usable = turns[all_finite(turns) & (turns != 0.0).any(axis=1)]
            if len(usable):
                return float(np.degrees(roll_pitch_yaw(normalised(usable[:1]))[0, 2]))
        return 0.0

    def _stances(self, probe: Probe) -> Mapping[int, Point]:
        """Return where feet touch the ground in the frame of the base that odometry places."""
        selection = self._selection
        if not selection.odometry:
            return {}
        feet = range(len(selection.robot.feet))
        world, base = frame_names(selection.robot, probe)
        frames = WorldFrames(
            links=(base,) * len(feet),
            points=(None,) * len(feet),
            world=world,
            base=base,
            odometry_places_base=True,
            moving={},
            statics=TransformBuffer(),
            clock=usable_clock(selection, probe),
        )
        in_base = {f for f in feet if any(one.in_base for one in selection.sources_of(f))}
        return self._filled(SoleFinder(frames, STANCE_SPREAD_M, in_base), frames).points()

    def _filled(self, finder: SoleFinder, frames: WorldFrames) -> SoleFinder:
        """Return a finder that has taken in everything that was seen."""
        for look in self._looks:
            finder.add(look.samples, frames.tracks(look.transforms, look.base))
        return finder

    def _wrench_frame(self, probe: Probe) -> WrenchFrameEvidence:
        """Decide by what the types of messages promise, else by evidence."""
        promised = {source.frame for source in self._selection.sources}
        (frame,) = promised if len(promised) == 1 else (None,)
        if frame is not None:
            return WrenchFrameEvidence(frame)
        recorded = [samples for look in self._looks for samples in look.samples]
        weight_n = body_weight_n(self._selection.robot.mass_kg)
        return judge_wrench_frame(frame_fit(recorded), self._turned(probe), weight_n)

    def _frames(self, probe: Probe) -> WorldFrames | None:
        """Return how the frames of the feet's links hang in the world."""
        return follow_frames(
            self._selection,
            probe,
            *frame_names(self._selection.robot, probe),
            usable_clock(self._selection, probe),
            turn_forces=True,
            place_sensors=False,
        )

    def _turned(self, probe: Probe) -> FrameFit | None:
        """Fit the forces turned from the links' frames into the world by the log's transforms."""
        frames = self._frames(probe)
        if frames is None:
            return None
        samples: list[Samples] = []
        turned: list[Flags] = []
        for look in self._looks:
            tracks = frames.tracks(look.transforms, look.base)
            for before, after in zip(
                look.samples, frames.place(look.samples, tracks).samples, strict=True
            ):
                samples.append(after)
                turned.append(after.in_world & ~before.in_world)
        return frame_fit(samples, turned)


def usable_clock(selection: Selection, probe: Probe) -> TimeSource:
    """Return the clock of samples and transforms: header stamps, where all have them."""
    all_stamped = not selection.without_header
    return TimeSource.HEADER if all_stamped and not probe.zero_stamps else TimeSource.LOG


def left_after(timings: list[StepTiming]) -> int | None:
    """Return the lag, ns, beyond which a foot has left the ground; None where that is not known.

    While a foot stands, each step has a contact. So the newest step of a message lies as far from
    its stamp as in any other, unless the foot left in between. Where lags vary for other reasons,
    as with a simulation that runs ahead of its sensors, a lag tells nothing.
    """
    lag = np.concatenate([np.empty(0, np.int64), *(timing.lag for timing in timings)])
    step = np.concatenate([np.empty(0, np.int64), *(timing.step for timing in timings)])
    if not len(step):
        return None
    usual, half_a_step = float(median_of(lag)), float(median_of(step)) / 2.0
    regular = np.abs(lag - usual) < half_a_step
    return round(usual + half_a_step) if regular.mean() >= _REGULAR else None


def _begins(batch: Batch) -> Ints:
    """(c,) ns, log time of the first message of each chunk, ascending."""
    first = [chunk.rows.start for chunk in batch.chunks if chunk.rows.start < chunk.rows.stop]
    return np.sort(batch.messages.log_time[first])


def _steps(samples: Samples, begins: Ints) -> Ints:
    """(n, 2) ns, the log time and the stamp's time from message to message within chunks.

    What lies between chunks is unseen.
    """
    chunk = np.searchsorted(begins, samples.log_time, side="right")
    steps = np.diff(np.column_stack([samples.log_time, samples.stamp]), axis=0)
    seen: Ints = steps[np.diff(chunk) == 0]
    return seen


def _silence_clock(steps: Iterable[Ints]) -> TimeSource:
    """Return the log's clock, or header stamps where messages are logged in bursts."""
    log, stamp = np.concatenate([np.empty((0, 2), np.int64), *steps]).T
    apart = stamp > 0
    if not apart.any() or median_of(log[apart]) >= _BURST * median_of(stamp[apart]):
        return TimeSource.LOG
    return TimeSource.HEADER


def _interval(steps: Ints, clock: TimeSource) -> int:
    """Return the median interval on a clock, ns."""
    on_clock = steps[:, 1 if clock is TimeSource.HEADER else 0]
    known = on_clock[on_clock > 0]
    return int(median_of(known)) if len(known) else _USUAL_INTERVAL_NS


def frame_names(robot: Robot, probe: Probe) -> tuple[str, str]:
    """Return the world's and the base's frame: the robot's, else the odometry's, else ROS'."""
    return (
        robot.world_frame or _frame(probe.world_frames, DEFAULT_WORLD),
        robot.base_frame or _frame(probe.base_frames, DEFAULT_BASE),
    )


def _frame(recorded: tuple[str, ...], default: str) -> str:
    names = [name.lstrip("/") for name in recorded if name.strip("/")]
    return names[0] if names else default
