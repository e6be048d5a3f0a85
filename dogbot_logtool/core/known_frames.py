"""What a recording tells of its frames, and the forces, places and soles that they turn."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Ints, all_finite, median_of
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.transforms import (
    Edge,
    FrameTrack,
    Poses,
    Transforms,
    chain_of_frames,
    fixed_turn,
    lookup,
    track_of,
)
from dogbot_logtool.core.frames.wrench_frame import (
    FramePoint,
    WrenchFrame,
    WrenchFrameEvidence,
    frame_fit,
    judge_wrench_frame,
)
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import conjugate, rotate
from dogbot_logtool.core.settings import WalkSettings

_MOST_SAMPLES: Final = 2000
"""Contacts of a foot that tell its sole, evenly spread over the recording."""
_FEWEST: Final = 5
SOLE_SPREAD_M: Final = 0.05
"""m, median distance from the median beyond which points tell no sole."""
STANCE_SPREAD_M: Final = 0.3
"""m, the same in the base's frame, in which a foot moves back while it stands."""
_FARTHEST_M: Final = 1.5
"""m, from a link's origin; contact points farther away lie in another world than the link."""
Point = tuple[float, float, float]


Counts = dict[str, Ints]
"""How many ``forces`` were turned from a link's frame into the world, and were not; likewise
``positions`` in a frame, and contacts without a point, put at the ``origins`` of frames."""


class WorldFrames(NamedTuple):
    """How frames of feet hang in the world."""

    links: tuple[str | None, ...]
    """Frame of each foot's forces; None: not to be turned, or not connected to the world."""
    points: tuple[FramePoint | None, ...]
    """Place of each foot's sensor; None: it tells contact points, or is not connected."""
    world: str
    tracks: Mapping[str, FrameTrack]
    """Of the frames on the way from these to the world."""
    clock: TimeSource

    def place(self, feet: Sequence[Samples]) -> tuple[tuple[Samples, ...], Counts]:
        """Turn forces of each foot into the world and place its sensor, where frames tell."""
        placed, counts = [], Counts()
        for each, link, point in zip(feet, self.links, self.points, strict=True):
            own, turned = self._turn(each, link)
            own, put = self._put(own, point)
            placed.append(own)
            at = point and ("positions" if point.recorded else "origins")
            for what, known in ((link and "forces", turned), (at, put)):
                if what:
                    number = np.array([known.sum(), (~known).sum()])
                    counts[what] = counts.get(what, 0) + number
        return tuple(placed), counts

    def _poses(self, frame: str, samples: Samples) -> Poses:
        """Return where a frame is in the world when samples were taken."""
        time = self.clock.of(samples)
        return lookup(self.tracks, frame, self.world, time, samples.log_time)

    def _turn(self, samples: Samples, link: str | None) -> tuple[Samples, Flags]:
        """Turn the forces of a foot that are not in the world already.

        Returns:
            the samples, `in_world` where a force was turned, and whether each of those that were
            to be turned was.
        """
        rows = np.flatnonzero(samples.in_contact & ~samples.in_world)
        if link is None or not len(rows):
            return samples, np.empty(0, np.bool_)
        poses = self._poses(link, samples.pick(rows))
        found = rows[poses.known]
        force, in_world = samples.force.copy(), samples.in_world.copy()
        with np.errstate(invalid="ignore"):
            force[found] = rotate(poses.rotation[poses.known], force[found])
        in_world[found] = True
        return replace(samples, force=force, in_world=in_world), poses.known

    def _put(self, samples: Samples, point: FramePoint | None) -> tuple[Samples, Flags]:
        """Place the samples of a foot that tell no contact point where a frame is at their time.

        Returns:
            the samples, with one point each where they were placed, and whether each of those that
            were to be placed was.
        """
        # Without contact points, a position is that of a foot in the base's frame.
        position = np.where((samples.points > 0)[:, None], samples.position, np.nan)
        rows = np.flatnonzero(samples.in_contact & (samples.points == 0))
        if point is None or not len(rows):
            return replace(samples, position=position), np.empty(0, np.bool_)
        if point.recorded:
            rows = rows[all_finite(samples.position[rows])]
        poses = self._poses(point.frame, samples.pick(rows))
        found, points = rows[poses.known], samples.points.copy()
        inside = samples.position[found] if point.recorded else np.array([point.offset])
        shift, turn = poses.translation[poses.known], poses.rotation[poses.known]
        position[found] = shift + rotate(turn, inside)
        points[found] = 1
        return replace(samples, position=position, points=points), poses.known

    def soles(self, feet: Sequence[Samples], spread_m: float) -> dict[int, Point]:
        """Return the median contact point, m, of each foot whose points agree in its link's frame.

        Args:
            feet: contact samples of each.
            spread_m: m, median distance from the median beyond which a foot has no sole.
        """
        found: dict[int, Point] = {}
        for foot, (samples, link) in enumerate(zip(feet, self.links, strict=True)):
            rows = np.flatnonzero(samples.in_contact & all_finite(samples.position))
            rows = rows[:: len(rows) // _MOST_SAMPLES + 1]
            if link is None or not len(rows):
                continue
            poses = self._poses(link, samples.pick(rows))
            offset = (samples.position[rows] - poses.translation)[poses.known]
            points = rotate(conjugate(poses.rotation[poses.known]), offset)
            if len(points) < _FEWEST:
                continue
            middle = median_of(points, axis=0)
            near = np.linalg.norm(middle) <= _FARTHEST_M
            if near and median_of(np.linalg.norm(points - middle, axis=1)) <= spread_m:
                found[foot] = tuple(middle.tolist())
        return found


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
    parents: Mapping[str, frozenset[str]]
    """Parents that the log's own transforms give each frame, without leading slashes."""
    parent_of: Mapping[str, str]
    """The parent of each frame that has one, as far as it is known which holds."""
    links: tuple[str | None, ...]
    """Link that each foot's collision belongs to, in whose frame its wrenches may be."""
    transforms: Mapping[Edge, Transforms]
    """The log's own; and of the base in the world its poses, to which a second opinion would only
    contradict."""
    clock: TimeSource
    """The clock that frames are placed on."""
    wrench_frame: WrenchFrameEvidence = field(
        default_factory=lambda: WrenchFrameEvidence(WrenchFrame.UNKNOWN)
    )
    soles: Mapping[int, Point] = field(default_factory=dict)
    """m, where feet touch the ground in the frames of their `links`, as far as it is known."""

    def tracks(self, frames: Iterable[str]) -> dict[str, FrameTrack]:
        """Return those of some frames that are known, each in its one parent."""
        edges = [(self.parent_of.get(child, ""), child) for child in frames]
        known = [(edge, self.transforms[edge]) for edge in edges if edge in self.transforms]
        tracks = {child: track_of(up, own, self.clock) for (up, child), own in known}
        return {child: track for child, track in tracks.items() if track is not None}

    def in_base(self, settings: WalkSettings) -> list[FramePoint | None]:
        """Return where feet are whose messages tell places in the base's frame."""
        point = FramePoint(self.base, recorded=True)
        return [point if foot.in_base else None for foot in settings.feet]

    def mounting(self, named: Sequence[str]) -> tuple[float, float, float, float] | None:
        """Return x, y, z, w of the only one of some frames in the base's; None: not known."""
        if len(named) != 1:
            return None
        chain = chain_of_frames(self.parent_of, named[0], self.base)
        return fixed_turn(self.tracks(chain or ()), named[0], self.base)

    def stances(self, feet: Sequence[Samples]) -> dict[int, Point]:
        """Return where feet stand in the base's frame, by samples that are in the world."""
        at_base = self.follow((self.base,) * len(feet), (None,) * len(feet))
        return at_base.soles(feet, STANCE_SPREAD_M) if at_base else {}

    def follow(
        self, links: Sequence[str | None], points: Sequence[FramePoint | None]
    ) -> WorldFrames | None:
        """Return how frames of feet hang in the world; None where none is needed and connected.

        Args:
            links: frame of each foot's forces, which are wanted in the world; None: they are not.
            points: where each foot is that tells no contact points; None: it is not wanted.
        """
        parents, world = self.parent_of, self.world
        frames = filter(None, (*links, *(point.frame for point in points if point)))
        chains = {frame: chain_of_frames(parents, frame, world) for frame in frames}
        links = tuple(link if link and chains[link] is not None else None for link in links)
        # The world itself is no frame of a foot.
        points = tuple(point if point and chains[point.frame] else None for point in points)
        if not any((*links, *points)):
            return None
        tracks = self.tracks({each for chain in chains.values() for each in chain or ()})
        return WorldFrames(links, points, world, tracks, self.clock)


def known_frames(recording: Recording, settings: WalkSettings) -> KnownFrames:
    """Return what a recording tells of its frames.

    Args:
        recording: its columns, as recorded.
        settings: with the clock that is measured on.
    """
    world = settings.world_frame or _frame(recording.world_frames, DEFAULT_WORLD)
    base = settings.base_frame or _frame(recording.base_frames, DEFAULT_BASE)
    parents: dict[str, set[str]] = {}
    for parent, child in recording.transforms:
        parents.setdefault(child, set()).add(parent)
    of_one = (each for each in sorted(parents.items()) if len(each[1]) == 1)
    parent_of = {child: next(iter(found)) for child, found in of_one}
    transforms = dict(recording.transforms)
    if settings.odometry_topic:
        parent_of[base], transforms[world, base] = world, _of_poses(recording.base)
    links = [recording.links.get(foot, frozenset[str]()) for foot in range(len(settings.feet))]
    frames = KnownFrames(
        world=world,
        base=base,
        parents={child: frozenset(found) for child, found in sorted(parents.items())},
        parent_of=parent_of,
        links=tuple(next(iter(each)) if len(each) == 1 else None for each in links),
        transforms=transforms,
        clock=settings.clock,
    )
    followed = frames.follow(frames.links, frames.in_base(settings))
    soles = followed.soles(recording.feet, SOLE_SPREAD_M) if followed else {}
    wrench_frame = _wrench_frame(recording, settings, followed)
    return replace(frames, soles=soles, wrench_frame=wrench_frame)


def _of_poses(base: Odometry) -> Transforms:
    """Return the transforms of the base by its poses."""
    never, nowhere = np.zeros(len(base.stamp), np.bool_), np.broadcast_to(0, len(base.stamp))
    return Transforms(nowhere, never, base.log_time, base.stamp, base.position, base.orientation)


def _frame(recorded: tuple[str, ...], default: str) -> str:
    names = [name.lstrip("/") for name in recorded if name.strip("/")]
    return names[0] if names else default


def _wrench_frame(
    recording: Recording, settings: WalkSettings, followed: WorldFrames | None
) -> WrenchFrameEvidence:
    """Decide by what the types of messages promise, else by evidence.

    Args:
        recording: contact samples.
        settings: what is known of the feet.
        followed: how their links hang in the world.
    """
    if settings.promised_frame is not None:
        return WrenchFrameEvidence(settings.promised_frame)
    # Evenly spread, as many as the frame needs.
    counts = [len(own.log_time) for own in recording.feet]
    rows = [np.arange(0, count, count // _ENOUGH_SAMPLES + 1) for count in counts]
    some, link = [own.pick(each) for own, each in zip(recording.feet, rows, strict=True)], None
    if followed is not None:
        turned, _ = followed.place(some)
        pairs = zip(turned, some, strict=True)
        link = frame_fit(turned, [after.in_world & ~before.in_world for after, before in pairs])
    return judge_wrench_frame(frame_fit(some), link, settings.body_weight_n)
