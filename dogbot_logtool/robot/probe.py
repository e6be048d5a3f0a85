"""What a recording tells of its frames, wrenches and sensors."""

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints, all_finite, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import TransformBuffer, static_tracks
from dogbot_logtool.core.frames.wrench_frame import (
    FrameFit,
    WrenchFrame,
    WrenchFrameEvidence,
    frame_fit,
    judge_wrench_frame,
)
from dogbot_logtool.core.recording import Recording, is_stamped
from dogbot_logtool.core.rotations import normalised, roll_pitch_yaw
from dogbot_logtool.core.settings import body_weight_n
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.robot.frames.world_frames import WorldFrames, follow_frames
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.robot_model.skeleton import (
    STANCE_SPREAD_M,
    FramePose,
    Point,
    find_soles,
    first_poses,
    rounded,
)
from dogbot_logtool.robot.topics.selection import Selection

DEFAULT_WORLD: Final = "world"
DEFAULT_BASE: Final = "base_link"
_BURST: Final = 0.5
"""Messages that are logged in less than this part of the time between their stamps come in
bursts."""
_ENOUGH_SAMPLES: Final = 10_000
"""Contact samples of a foot that decide the frame of its wrenches, at most."""
_USUAL_INTERVAL_NS: Final = 10_000_000
"""ns, assumed of a sensor that sent hardly any message."""


@dataclass(frozen=True, slots=True)
class Probe:
    """What a recording tells of its frames, wrenches and sensors."""

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
    touching: frozenset[int]
    """Feet that were seen in contact."""
    feet: tuple[Samples, ...]
    """Contact samples of each foot, as recorded."""
    zero_stamps: frozenset[str]
    """Topics whose header stamps are all zero."""
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
        return frozenset(
            foot
            for foot in self.touching
            if not self.feet[foot].force[self.feet[foot].in_contact].any()
        )


def probe_recording(
    recording: Recording, selection: Selection, *, with_soles: bool = False
) -> Probe:
    """Return what a recording tells.

    Args:
        recording: its columns.
        selection: what they are read of.
        with_soles: find `soles` and `stances`, too, which pictures of the robot need.
    """
    transforms = recording.transforms
    parents: dict[str, set[str]] = {}
    names = {*recording.world_frames, *recording.base_frames}
    for parent, child in recording.transforms.pairs():
        names |= {parent, child}
        parents.setdefault(child.lstrip("/"), set()).add(parent.lstrip("/"))
    steps = _silent_steps(recording, selection)
    silence_clock = _silence_clock(steps)
    static = selection.static_transforms
    probe = Probe(
        wrench_frame=WrenchFrameEvidence(WrenchFrame.UNKNOWN),
        world_frames=recording.world_frames,
        base_frames=recording.base_frames,
        parents={child: frozenset(found) for child, found in sorted(parents.items())},
        statics=static_tracks(transforms, static),
        slashed_frames=tuple(sorted(name for name in names if name.startswith("/"))),
        links=tuple(
            next(iter(links)) if len(links := recording.links.get(foot, frozenset())) == 1 else None
            for foot in range(len(selection.robot.feet))
        ),
        intervals={foot: _interval(each, silence_clock) for foot, each in steps.items()},
        silence_clock=silence_clock,
        touching=frozenset(
            foot for foot, samples in enumerate(recording.feet) if samples.in_contact.any()
        ),
        feet=recording.feet,
        zero_stamps=_zero_stamps(recording, selection),
        frame_poses=first_poses(transforms, static),
    )
    probe = replace(probe, wrench_frame=_wrench_frame(recording, selection, probe))
    return _with_soles(recording, selection, probe) if with_soles else probe


def _silent_steps(recording: Recording, selection: Selection) -> dict[int, Ints]:
    """(n, 2) ns, log time and stamp from message to message, of feet that are silent in swing."""
    return {
        foot: np.stack([np.diff(samples.log_time), np.diff(samples.stamp)], axis=1)
        for foot, samples in enumerate(recording.feet)
        if len(samples.log_time)
        and any(source.silent_in_swing for source in selection.sources_of(foot))
    }


def _zero_stamps(recording: Recording, selection: Selection) -> frozenset[str]:
    """Return the used topics whose header stamps are all zero."""
    base = selection.base
    if is_stamped(recording):
        return frozenset()
    found = {
        topic
        for topic in {channel.topic for channel in selection.contacts}
        if (stamp := recording.topics[topic].stamp if topic in recording.topics else None)
        is not None
        and not stamp.any()
    }
    if base is not None and base.source.has_header and len(recording.base.stamp):
        found |= set() if recording.base.stamp.any() else {selection.odometry[0].topic}
    return frozenset(found)


def _wrench_frame(recording: Recording, selection: Selection, probe: Probe) -> WrenchFrameEvidence:
    """Decide by what the types of messages promise, else by evidence."""
    promised = {source.frame for source in selection.sources}
    (frame,) = promised if len(promised) == 1 else (None,)
    if frame is not None:
        return WrenchFrameEvidence(frame)
    some = [_thinned(samples) for samples in recording.feet]
    weight_n = body_weight_n(selection.robot.mass_kg)
    turned = _turned(recording, selection, probe, some)
    return judge_wrench_frame(frame_fit(some), turned, weight_n)


def _thinned(samples: Samples) -> Samples:
    """Return some samples of a foot, evenly spread, as many as the frame of wrenches needs."""
    count = len(samples.log_time)
    return samples.pick(np.arange(0, count, count // _ENOUGH_SAMPLES + 1))


def _turned(
    recording: Recording, selection: Selection, probe: Probe, some: Sequence[Samples]
) -> FrameFit | None:
    """Fit the forces turned from the links' frames into the world by the log's transforms."""
    frames = _frames(selection, probe)
    if frames is None:
        return None
    tracks = frames.tracks(recording.transforms, recording.base)
    turned = frames.place(some, tracks).samples
    pairs = zip(turned, some, strict=True)
    return frame_fit(turned, [after.in_world & ~before.in_world for after, before in pairs])


def _frames(selection: Selection, probe: Probe) -> WorldFrames | None:
    """Return how the links of feet hang in the world."""
    return follow_frames(
        selection,
        probe,
        *frame_names(selection.robot, probe),
        usable_clock(selection, probe),
        turn_forces=True,
        place_sensors=False,
    )


def _with_soles(recording: Recording, selection: Selection, probe: Probe) -> Probe:
    """Return the probe with the points where feet touch the ground."""
    stances = _stances(recording, selection, probe)
    probe = replace(probe, stances=stances, turned_deg=_turned_deg(recording))
    placed = _frames(selection, probe)
    if placed is None:
        return probe
    tracks = placed.tracks(recording.transforms, recording.base)
    exact = find_soles(recording.feet, placed, tracks)
    return replace(probe, soles=rounded(exact), exact_soles=exact)


def _turned_deg(recording: Recording) -> float:
    """Return the yaw of the base's first usable pose; 0 where none was seen."""
    turns = recording.base.orientation
    usable = np.flatnonzero(all_finite(turns) & (turns != 0.0).any(axis=1))[:1]
    if not len(usable):
        return 0.0
    return float(np.degrees(roll_pitch_yaw(normalised(turns[usable]))[0, 2]))


def _stances(recording: Recording, selection: Selection, probe: Probe) -> Mapping[int, Point]:
    """Return where feet touch the ground in the frame of the base that odometry places."""
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
    tracks = frames.tracks(recording.transforms, recording.base)
    return rounded(find_soles(recording.feet, frames, tracks, STANCE_SPREAD_M, in_base))


def usable_clock(selection: Selection, probe: Probe) -> TimeSource:
    """Return the clock of samples and transforms: header stamps, where all have them."""
    all_stamped = not selection.without_header
    return TimeSource.HEADER if all_stamped and not probe.zero_stamps else TimeSource.LOG


def _silence_clock(steps: Mapping[int, Ints]) -> TimeSource:
    """Return the log's clock, or header stamps where messages are logged in bursts."""
    log, stamp = np.concatenate([np.empty((0, 2), np.int64), *steps.values()]).T
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
