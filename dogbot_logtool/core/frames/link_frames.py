"""Contact samples placed in the world by the frames of the robot's links."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, all_finite
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transform_buffer import Poses, TransformBuffer
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class FramePoint:
    """A point of a link, given by its frame."""

    frame: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, in that frame."""
    recorded: bool = False
    """Whether each sample's own position is in that frame, instead of `offset`."""


@dataclass(frozen=True, slots=True)
class FrameCounts:
    """Samples in contact for which transforms told something, or did not."""

    turned: int = 0
    """Force turned from a link's frame into the world."""
    not_turned: int = 0
    placed: int = 0
    """Without a contact point; the position of a frame stands in for it."""
    not_placed: int = 0

    def __add__(self, other: "FrameCounts") -> "FrameCounts":
        return FrameCounts(
            self.turned + other.turned,
            self.not_turned + other.not_turned,
            self.placed + other.placed,
            self.not_placed + other.not_placed,
        )


def forces_in_world(
    samples: Samples,
    links: Sequence[str | None],
    buffer: TransformBuffer,
    world: str,
    clock: TimeSource,
) -> tuple[Samples, FrameCounts]:
    """Turn link-frame forces into the world.

    Args:
        samples: forces of feet without a link, and those that are in the world, stay as they are.
        links: frame of each foot's forces; None: not to be turned.
        buffer: transforms around the samples.
        world: frame to turn to.
        clock: the clock of the samples and of the buffer.

    Returns:
        the samples, `in_world` where a force was turned, and their numbers.
    """
    wanted = samples.in_contact & ~samples.in_world
    force, in_world = samples.force.copy(), samples.in_world.copy()
    counts = FrameCounts()
    for foot, link in enumerate(links):
        rows = np.flatnonzero(wanted & (samples.foot == foot))
        if link is None or not len(rows):
            continue
        poses = _poses(samples.pick(rows), link, buffer, world, clock)
        known = poses.known
        with np.errstate(invalid="ignore"):
            force[rows[known]] = rotate(poses.rotation[known], force[rows[known]])
        in_world[rows[known]] = True
        turned = int(known.sum())
        counts += FrameCounts(turned=turned, not_turned=len(rows) - turned)
    return replace(samples, force=force, in_world=in_world), counts


def points_from_frames(
    samples: Samples,
    points: Sequence[FramePoint | None],
    buffer: TransformBuffer,
    world: str,
    clock: TimeSource,
) -> tuple[Samples, FrameCounts]:
    """Place samples that tell no contact point where a frame is at their time.

    Args:
        samples: those with contact points stay as they are.
        points: position of each foot; None: not known.
        buffer: transforms around the samples.
        world: frame of the positions.
        clock: the clock of the samples and of the buffer.

    Returns:
        the samples, with one point each where they were placed, and their numbers.
    """
    wanted: Flags = samples.in_contact & (samples.points == 0)
    # Without contact points, a position is that of a foot in the base's frame.
    position = np.where((samples.points > 0)[:, None], samples.position, np.nan)
    number = samples.points.copy()
    counts = FrameCounts()
    for foot, point in enumerate(points):
        rows = np.flatnonzero(wanted & (samples.foot == foot))
        if point is None or not len(rows):
            continue
        if point.recorded:
            rows = rows[all_finite(samples.position[rows])]
        poses = _poses(samples.pick(rows), point.frame, buffer, world, clock)
        found = rows[poses.known]
        inside = samples.position[found] if point.recorded else np.array([point.offset])
        offset: Floats = rotate(poses.rotation[poses.known], inside)
        position[found] = poses.translation[poses.known] + offset
        number[found] = 1
        placed = int(poses.known.sum())
        counts += FrameCounts(placed=placed, not_placed=len(rows) - placed)
    return replace(samples, position=position, points=number), counts


def _poses(
    samples: Samples, frame: str, buffer: TransformBuffer, world: str, clock: TimeSource
) -> Poses:
    return buffer.lookup(frame, world, clock.of(samples), samples.log_time)
