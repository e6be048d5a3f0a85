"""Forces and positions of feet turned into the world by the log's own frames."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dogbot_logtool.core.arrays import Flags, all_finite
from dogbot_logtool.core.base.poses import Odometry, usable_poses
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import (
    Poses,
    RecordedTransforms,
    TransformBuffer,
    frame_track,
    moving_tracks,
)
from dogbot_logtool.core.frames.wrench_frame import FramePoint
from dogbot_logtool.core.rotations import rotate


@dataclass(frozen=True, slots=True)
class PlacedCounts:
    """How often frames told what was asked of them: how often they did, and did not."""

    forces: tuple[int, int] = (0, 0)
    """Forces that were turned from a link's frame into the world, and that were not."""
    points: tuple[int, int] = (0, 0)
    """The same of samples without a contact point, for which the position of a frame stands in."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class WorldFrames:
    """How frames of feet hang in the world."""

    links: tuple[str | None, ...]
    """Frame of each foot's forces; None: not to be turned, or not connected to the world."""
    points: tuple[FramePoint | None, ...]
    """Place of each foot's sensor; None: it tells contact points, or is not connected."""
    world: str
    base: str
    odometry_places_base: bool
    moving: Mapping[str, str]
    """Parent of each frame on the way to the world that the log's own transforms move."""
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
        turned = [self._turn(*each, buffer) for each in zip(feet, self.links, strict=True)]
        placed = [
            self._put(samples, point, buffer)
            for (samples, _), point in zip(turned, self.points, strict=True)
        ]
        told = (np.concatenate([known for _, known in each]) for each in (turned, placed))
        counts = [(int(known.sum()), int((~known).sum())) for known in told]
        return tuple(samples for samples, _ in placed), PlacedCounts(*counts)

    def _poses(self, buffer: TransformBuffer, frame: str, samples: Samples) -> Poses:
        """Return where a frame is in the world when samples were taken."""
        return buffer.lookup(frame, self.world, self.clock.of(samples), samples.log_time)

    def _turn(
        self, samples: Samples, link: str | None, buffer: TransformBuffer
    ) -> tuple[Samples, Flags]:
        """Turn the forces of a foot that are not in the world already.

        Returns:
            the samples, `in_world` where a force was turned, and whether each of those that were
            to be turned was.
        """
        rows = np.flatnonzero(samples.in_contact & ~samples.in_world)
        if link is None or not len(rows):
            return samples, np.empty(0, np.bool_)
        poses = self._poses(buffer, link, samples.pick(rows))
        found = rows[poses.known]
        force, in_world = samples.force.copy(), samples.in_world.copy()
        with np.errstate(invalid="ignore"):
            force[found] = rotate(poses.rotation[poses.known], force[found])
        in_world[found] = True
        return replace(samples, force=force, in_world=in_world), poses.known

    def _put(
        self, samples: Samples, point: FramePoint | None, buffer: TransformBuffer
    ) -> tuple[Samples, Flags]:
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
        poses = self._poses(buffer, point.frame, samples.pick(rows))
        found, points = rows[poses.known], samples.points.copy()
        inside = samples.position[found] if point.recorded else np.array([point.offset])
        shift, turn = poses.translation[poses.known], poses.rotation[poses.known]
        position[found] = shift + rotate(turn, inside)
        points[found] = 1
        return replace(samples, position=position, points=points), poses.known
