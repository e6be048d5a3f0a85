"""Forces and positions of feet turned into the world by the log's own frames."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dogbot_logtool.core.base.poses import Odometry, usable_poses
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import (
    Poses,
    RecordedTransforms,
    TransformBuffer,
    chain_of_frames,
    frame_track,
    moving_tracks,
)
from dogbot_logtool.core.frames.wrench_frame import FramePoint, place_points, turn_forces

Parents = Mapping[str, str]
"""Parent by frame, without leading slashes."""


@dataclass(frozen=True, slots=True)
class PlacedCounts:
    """How often frames told what was asked of them: how often they did, and did not."""

    forces: tuple[int, int] = (0, 0)
    """Forces that were turned from a link's frame into the world, and that were not."""
    points: tuple[int, int] = (0, 0)
    """The same of samples without a contact point, for which the position of a frame stands in."""


@dataclass(frozen=True, slots=True)
class WorldFrames:
    """How frames of feet hang in the world."""

    links: tuple[str | None, ...]
    """Frame of each foot's forces; None: not to be turned, or not connected to the world."""
    points: tuple[FramePoint | None, ...]
    """Place of each foot's sensor; None: it tells contact points, or is not connected."""
    world: str
    base: str
    odometry_places_base: bool
    moving: Parents
    """Of the frames on the way to the world that the log's own transforms move."""
    statics: TransformBuffer
    clock: TimeSource

    def tracks(self, transforms: RecordedTransforms, poses: Odometry) -> TransformBuffer:
        """Return what transforms and poses tell of the frames that are needed."""
        tracks = TransformBuffer()
        if self.odometry_places_base:
            poses = poses.pick(usable_poses(poses))
            time = self.clock.of(poses)
            track = frame_track(self.world, time, poses.log_time, poses.position, poses.orientation)
            tracks = TransformBuffer({self.base: track} if track else {})
        return tracks.then(moving_tracks(transforms, self.moving, self.clock))

    def place(
        self, feet: Sequence[Samples], around: TransformBuffer
    ) -> tuple[tuple[Samples, ...], PlacedCounts]:
        """Turn forces into the world and give sensors their positions, where frames tell.

        Args:
            feet: samples of each foot.
            around: the frames that move.
        """
        buffer = self.statics.then(around)

        def poses_of(frame: str, samples: Samples) -> Poses:
            return buffer.lookup(frame, self.world, self.clock.of(samples), samples.log_time)

        turned = [turn_forces(*each, poses_of) for each in zip(feet, self.links, strict=True)]
        placed = [
            place_points(samples, point, poses_of)
            for (samples, _), point in zip(turned, self.points, strict=True)
        ]
        told = (np.concatenate([known for _, known in each]) for each in (turned, placed))
        counts = [(int(known.sum()), int((~known).sum())) for known in told]
        return tuple(samples for samples, _ in placed), PlacedCounts(*counts)


def follow_frames(
    parents: Parents,
    statics: TransformBuffer,
    links: Sequence[str | None],
    points: Sequence[FramePoint | None],
    names: tuple[str, str],
    clock: TimeSource,
    *,
    has_base: bool,
) -> WorldFrames | None:
    """Decide which frames are needed, and how they hang together.

    Args:
        parents: by the log's own transforms.
        statics: transforms that hold for ever.
        links: frame of each foot's forces, which are wanted in the world; None: they are not.
        points: where each foot is that tells no contact points; None: it is not wanted.
        names: the world's frame and the base's.
        clock: the clock of samples and transforms.
        has_base: odometry places the base.

    Returns:
        None where no foot's frame is needed and connected.
    """
    world, base = names
    if has_base:
        # Odometry places the base; a second opinion would only contradict it.
        parents = {**parents, base: world}
    links = tuple(
        link if link and chain_of_frames(parents, link, world) is not None else None
        for link in links
    )
    # The world itself is no frame of a foot.
    points = tuple(
        point if point and chain_of_frames(parents, point.frame, world) else None
        for point in points
    )
    frames = {link for link in links if link} | {point.frame for point in points if point}
    if not frames:
        return None
    needed = {each for frame in frames for each in chain_of_frames(parents, frame, world) or ()}
    if has_base:
        needed.discard(base)
    return WorldFrames(
        links=links,
        points=points,
        world=world,
        base=base,
        odometry_places_base=has_base,
        moving={each: parents[each] for each in needed - statics.frames.keys()},
        statics=statics.only(needed),
        clock=clock,
    )
