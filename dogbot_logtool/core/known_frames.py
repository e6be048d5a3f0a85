"""What a recording tells of its frames, and of the frame of its wrenches."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import all_finite
from dogbot_logtool.core.frames.transforms import TransformBuffer, chain_of_frames, static_tracks
from dogbot_logtool.core.frames.wrench_frame import (
    FramePoint,
    WrenchFrame,
    WrenchFrameEvidence,
    frame_fit,
    judge_wrench_frame,
)
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import normalised, roll_pitch_yaw
from dogbot_logtool.core.settings import WalkSettings
from dogbot_logtool.core.soles import (
    STANCE_SPREAD_M,
    FramePose,
    Point,
    find_soles,
    first_poses,
    rounded,
)
from dogbot_logtool.core.world_frames import WorldFrames

DEFAULT_WORLD: Final = "world"
DEFAULT_BASE: Final = "base_link"
_ENOUGH_SAMPLES: Final = 10_000
"""Contact samples of a foot that decide the frame of its wrenches, at most."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class KnownFrames:
    """What a recording tells of its frames."""

    world: str
    """The world's frame: the robot's, else the odometry's, else ROS'. Also `base`."""
    base: str
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
    frame_poses: Mapping[str, FramePose]
    """The first pose that was seen of each frame, by name without a leading slash."""
    wrench_frame: WrenchFrameEvidence = field(
        default_factory=lambda: WrenchFrameEvidence(WrenchFrame.UNKNOWN)
    )
    soles: Mapping[int, Point] = field(default_factory=dict)
    """m, where feet touch the ground in the frames of their `links`, as far as it is known."""
    stances: Mapping[int, Point] = field(default_factory=dict)
    """m, the same in the base's frame: the median while the foot stands."""
    turned_deg: float = 0.0
    """Yaw of the base in the world when it was first seen."""

    def in_base(self, settings: WalkSettings) -> list[FramePoint | None]:
        """Return where feet are whose messages tell places in the base's frame."""
        point = FramePoint(self.base, recorded=True)
        return [point if foot.in_base else None for foot in settings.feet]

    def follow(
        self,
        settings: WalkSettings,
        links: Sequence[str | None],
        points: Sequence[FramePoint | None],
    ) -> WorldFrames | None:
        """Decide which frames of feet are needed, and how they hang in the world.

        Args:
            settings: the clock, and whether odometry places the base.
            links: frame of each foot's forces, which are wanted in the world; None: they are not.
            points: where each foot is that tells no contact points; None: it is not wanted.

        Returns:
            None where no foot's frame is needed and connected.
        """
        world, base, has_base = self.world, self.base, bool(settings.odometry_topic)
        parents = {
            child: next(iter(each)) for child, each in self.parents.items() if len(each) == 1
        }
        if has_base:
            # Odometry places the base; a second opinion would only contradict it.
            parents[base] = world
        links = [
            link if link and chain_of_frames(parents, link, world) is not None else None
            for link in links
        ]
        # The world itself is no frame of a foot.
        points = [
            point if point and chain_of_frames(parents, point.frame, world) else None
            for point in points
        ]
        frames = {link for link in links if link} | {point.frame for point in points if point}
        if not frames:
            return None
        needed = {each for frame in frames for each in chain_of_frames(parents, frame, world) or ()}
        needed -= {base} if has_base else set()
        return WorldFrames(
            links=tuple(links),
            points=tuple(points),
            world=world,
            base=base,
            odometry_places_base=has_base,
            moving={each: parents[each] for each in needed - self.statics.frames.keys()},
            statics=self.statics.only(needed),
            clock=settings.clock,
        )


def known_frames(recording: Recording, settings: WalkSettings) -> KnownFrames:
    """Return what a recording tells of its frames.

    Args:
        recording: its columns, as recorded.
        settings: with the clock that is measured on.
    """
    transforms = recording.transforms
    parents: dict[str, set[str]] = {}
    names = {*recording.world_frames, *recording.base_frames}
    for parent, child in transforms.pairs():
        names |= {parent, child}
        parents.setdefault(child.lstrip("/"), set()).add(parent.lstrip("/"))
    links = [recording.links.get(foot, frozenset[str]()) for foot in range(len(settings.feet))]
    frames = KnownFrames(
        world=settings.world_frame or _frame(recording.world_frames, DEFAULT_WORLD),
        base=settings.base_frame or _frame(recording.base_frames, DEFAULT_BASE),
        world_frames=recording.world_frames,
        base_frames=recording.base_frames,
        parents={child: frozenset(found) for child, found in sorted(parents.items())},
        statics=static_tracks(transforms, settings.static_channels),
        slashed_frames=tuple(sorted(name for name in names if name.startswith("/"))),
        links=tuple(next(iter(each)) if len(each) == 1 else None for each in links),
        frame_poses=first_poses(transforms, settings.static_channels),
    )
    followed = frames.follow(settings, frames.links, frames.in_base(settings))
    tracks, soles = None, dict[int, Point]()
    if followed is not None:
        tracks = followed.tracks(transforms, recording.base)
        soles = find_soles(recording.feet, followed, tracks)
    return replace(
        frames,
        soles=soles,
        wrench_frame=_wrench_frame(recording, settings, followed, tracks),
        stances=_stances(recording, settings, frames),
        turned_deg=_turned_deg(recording),
    )


def world_frames(frames: KnownFrames, settings: WalkSettings) -> WorldFrames | None:
    """Return the frames that turn feet's forces and positions into the world, where needed.

    Positions of sensors are left out: the origin of a foot's frame is no contact point, so neither
    slip nor the support polygon may be measured with it.
    """
    turns = settings.wrench_frame is WrenchFrame.LINK
    links = frames.links if turns else (None,) * len(frames.links)
    return frames.follow(settings, links, frames.in_base(settings))


def imu_mounting(
    recording: Recording, frames: KnownFrames
) -> tuple[float, float, float, float] | None:
    """Return how an inertial unit sits on the base, by recorded static transforms.

    Returns:
        x, y, z, w of its frame in the base's; None: not recorded, or it is the base's.
    """
    named = recording.accelerations.frames if recording.accelerations else ()
    if len(named) != 1 or named[0].lstrip("/") == frames.base or not frames.statics.frames:
        return None
    now = np.zeros(1, np.int64)
    pose = frames.statics.lookup(named[0].lstrip("/"), frames.base, now, now)
    if not pose.known[0]:
        return None
    x, y, z, w = pose.rotation[0].tolist()
    return x, y, z, w


def _frame(recorded: tuple[str, ...], default: str) -> str:
    names = [name.lstrip("/") for name in recorded if name.strip("/")]
    return names[0] if names else default


def _wrench_frame(
    recording: Recording,
    settings: WalkSettings,
    followed: WorldFrames | None,
    tracks: TransformBuffer | None,
) -> WrenchFrameEvidence:
    """Decide by what the types of messages promise, else by evidence.

    Args:
        recording: contact samples.
        settings: what is known of the feet.
        followed: how their links hang in the world.
        tracks: the transforms of these.
    """
    if settings.promised_frame is not None:
        return WrenchFrameEvidence(settings.promised_frame)
    # Evenly spread, as many as the frame needs.
    counts = [len(own.log_time) for own in recording.feet]
    rows = [np.arange(0, count, count // _ENOUGH_SAMPLES + 1) for count in counts]
    some, link = [own.pick(each) for own, each in zip(recording.feet, rows, strict=True)], None
    if followed is not None and tracks is not None:
        turned, _ = followed.place(some, tracks)
        pairs = zip(turned, some, strict=True)
        link = frame_fit(turned, [after.in_world & ~before.in_world for after, before in pairs])
    return judge_wrench_frame(frame_fit(some), link, settings.body_weight_n)


def _turned_deg(recording: Recording) -> float:
    """Return the yaw of the base's first usable pose; 0 where none was seen."""
    turns = recording.base.orientation
    usable = np.flatnonzero(all_finite(turns) & (turns != 0.0).any(axis=1))[:1]
    if not len(usable):
        return 0.0
    return float(np.degrees(roll_pitch_yaw(normalised(turns[usable]))[0, 2]))


def _stances(
    recording: Recording, settings: WalkSettings, frames: KnownFrames
) -> Mapping[int, Point]:
    """Return where feet touch the ground in the frame of the base that odometry places."""
    nowhere = (None,) * len(settings.feet)
    followed = frames.follow(settings, (frames.base,) * len(nowhere), nowhere)
    if followed is None or not settings.odometry_topic:
        return {}
    in_base = {row for row, foot in enumerate(settings.feet) if foot.in_base}
    tracks = followed.tracks(recording.transforms, recording.base)
    return rounded(find_soles(recording.feet, followed, tracks, STANCE_SPREAD_M, in_base))
