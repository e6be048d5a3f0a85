"""Contact samples in the world: the frame of their forces, and turning and placing them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    all_finite,
    distinct,
    median_of,
    norms,
    percentiles_of,
)
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.transforms import Poses
from dogbot_logtool.core.rotations import rotate

PosesOf = Callable[[str, Samples], Poses]
"""Returns where a frame is in the world when samples were taken."""


@dataclass(frozen=True, slots=True)
class FramePoint:
    """A point of a link, given by its frame."""

    frame: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, in that frame."""
    recorded: bool = False
    """Whether each sample's own position is in that frame, instead of `offset`."""


def turn_forces(samples: Samples, link: str | None, poses_of: PosesOf) -> tuple[Samples, Flags]:
    """Turn forces of a foot from the frame of its link into the world.

    Args:
        samples: of the foot; forces that are in the world stay as they are.
        link: frame of the forces; None: they are not to be turned.
        poses_of: looks up where a frame is in the world when samples were taken.

    Returns:
        the samples, `in_world` where a force was turned, and whether each of those that were to
        be turned was.
    """
    rows = np.flatnonzero(samples.in_contact & ~samples.in_world)
    if link is None or not len(rows):
        return samples, np.empty(0, np.bool_)
    poses = poses_of(link, samples.pick(rows))
    found = rows[poses.known]
    force, in_world = samples.force.copy(), samples.in_world.copy()
    with np.errstate(invalid="ignore"):
        force[found] = rotate(poses.rotation[poses.known], force[found])
    in_world[found] = True
    return replace(samples, force=force, in_world=in_world), poses.known


def place_points(
    samples: Samples, point: FramePoint | None, poses_of: PosesOf
) -> tuple[Samples, Flags]:
    """Place samples of a foot that tell no contact point where a frame is at their time.

    Args:
        samples: of the foot; those with contact points stay as they are.
        point: position of the foot; None: not known.
        poses_of: looks up where a frame is in the world when samples were taken.

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
    poses = poses_of(point.frame, samples.pick(rows))
    found, points = rows[poses.known], samples.points.copy()
    inside = samples.position[found] if point.recorded else np.array([point.offset])
    position[found] = poses.translation[poses.known] + rotate(poses.rotation[poses.known], inside)
    points[found] = 1
    return replace(samples, position=position, points=points), poses.known


FRICTION: Final = 1.0
"""Highest tangential over normal force that a foot is expected to find."""
IN_CONE: Final = 0.95
"""Share of the load that must lie within the friction cone."""
NET_TILT: Final = 0.2
"""Highest horizontal over vertical part of all feet's summed force (11 degrees)."""
FOOT_TILT: Final = 0.35
"""The same of one foot (19 degrees), the median over feet: feet may push against each other."""
SAME_FORCE: Final = 0.02
"""Difference of the vertical sums up to which it does not matter which hypothesis is right."""
NEARER: Final = 0.05
"""By how much one hypothesis must be nearer to the weight, or to the vertical, to be preferred."""
LIGHT: Final = 0.1
"""Forces below this share of the usual high load say little about direction."""
HIGH_LOAD_PERCENT: Final = 95.0
TINY_N: Final = 1e-6
"""Lighter forces have no direction."""
FEWEST_SAMPLES: Final = 20


class WrenchFrame(StrEnum):
    """The frame of recorded wrenches."""

    WORLD = "world"
    LINK = "link"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class FrameFit:
    """How well forces obey physics if they are taken to be in the world frame."""

    samples: int
    """Loaded samples with a normal."""
    in_cone: float
    """Share of the load within the friction cone around the contact normals."""
    net_tilt: float
    """Horizontal over vertical part of the force summed over all feet and time."""
    foot_tilt: float
    """The same for each foot by itself, the median over feet."""
    vertical_n: float
    """N, sum over feet of the mean vertical force, swings included."""
    alignment: float
    """Median of |F.n| / |F|."""

    @property
    def in_world(self) -> bool:
        """Whether the forces can be in the world frame."""
        straight = self.net_tilt <= NET_TILT and self.foot_tilt <= FOOT_TILT
        return straight and self.in_cone >= IN_CONE


@dataclass(frozen=True, slots=True)
class WrenchFrameEvidence:
    """Evidence for the frame of the wrenches."""

    frame: WrenchFrame
    world: FrameFit | None = None
    """The forces as recorded; None where too few samples tell, or the message type decides."""
    link: FrameFit | None = None
    """The forces turned from the links' frames; None where no transforms turn them."""

    @property
    def is_inferred(self) -> bool:
        """Whether the world is taken for the frame since the forces as recorded may be in it."""
        return self.frame is WrenchFrame.WORLD and self.world is not None

    @property
    def samples(self) -> int:
        """Loaded samples that were looked at; 0 where the type of the messages decides."""
        return 0 if self.world is None else self.world.samples


def frame_fit(samples: Sequence[Samples], turned: Sequence[Flags] | None = None) -> FrameFit | None:
    """Measure how well forces obey physics if they are in the world frame.

    Samples read off the other body are in the world anyway: they count in the vertical sum only.

    Args:
        samples: parts of a log.
        turned: (n,) of each part, whether a force was turned from a link's frame into the world;
            None: the forces are as recorded.

    Returns:
        None with fewer than `FEWEST_SAMPLES` loaded samples that have a normal.
    """
    if turned is None:
        doubtful = [~part.in_world for part in samples]
        summed = [np.ones_like(part.in_world) for part in samples]
    else:
        doubtful, summed = list(turned), [part.in_world for part in samples]
    foot, force, normal = _loaded(samples, doubtful)
    if len(foot) < FEWEST_SAMPLES:
        return None
    magnitude = norms(force)
    heavy = magnitude >= max(LIGHT * percentiles_of(magnitude, HIGH_LOAD_PERCENT), TINY_N)
    heavy &= all_finite(normal)
    if int(heavy.sum()) < FEWEST_SAMPLES:
        return None
    return _fit(foot[heavy], force[heavy], normal[heavy], _vertical_sum_n(samples, summed))


def _loaded(samples: Sequence[Samples], rows: Sequence[Flags]) -> tuple[Ints, Floats, Floats]:
    """(n,) foot, (n, 3) N force and (n, 3) normal of the chosen samples that are in contact."""
    chosen = [
        part.pick(np.flatnonzero(some & part.in_contact & np.isfinite(norms(part.force))))
        for part, some in zip(samples, rows, strict=True)
    ]
    foot = np.concatenate([np.empty(0, np.int64), *(part.foot for part in chosen)])
    force, normal = (
        np.concatenate([np.empty((0, 3)), *(getattr(part, name) for part in chosen)])
        for name in ("force", "normal")
    )
    return foot, force, normal


def _vertical_sum_n(samples: Sequence[Samples], rows: Sequence[Flags]) -> float:
    """Return the sum over feet of the mean vertical force, N, from the chosen samples in contact.

    Each foot's mean over contact is weighted with the share of its samples that are in contact.
    """
    foot, force, _ = _loaded(samples, rows)
    everyone = np.concatenate([part.foot for part in samples])
    contact = np.concatenate([part.in_contact for part in samples])
    total = 0.0
    for each in distinct(foot).tolist():
        total += float(force[foot == each, 2].mean()) * float(contact[everyone == each].mean())
    return abs(total)


def _fit(foot: Ints, force: Floats, normal: Floats, vertical_n: float) -> FrameFit:
    """Return the fit of loaded samples; see `frame_fit`."""
    magnitude = norms(force)
    along = (force * normal).sum(axis=1)
    # Sources differ in the sign of normals; in one log it is the same throughout.
    along *= np.sign(along.sum()) or 1.0
    across = np.sqrt(np.maximum(magnitude**2 - along**2, 0.0))
    inside = across <= FRICTION * along
    tilts = [_tilt(force[foot == each].sum(axis=0)) for each in distinct(foot)]
    return FrameFit(
        samples=len(force),
        in_cone=float(magnitude[inside].sum() / magnitude.sum()),
        net_tilt=_tilt(force.sum(axis=0)),
        foot_tilt=float(median_of(tilts)),
        vertical_n=vertical_n,
        alignment=float(median_of(np.abs(along) / magnitude)),
    )


def _tilt(force: Floats) -> float:
    """Horizontal over vertical part of a force; infinite for one that is horizontal."""
    horizontal, vertical = float(np.hypot(force[0], force[1])), abs(float(force[2]))
    return horizontal / vertical if vertical > 0.0 else np.inf


def judge_wrench_frame(
    world: FrameFit | None, link: FrameFit | None = None, weight_n: float | None = None
) -> WrenchFrameEvidence:
    """Decide the wrench frame from samples taken all over the log.

    Without transforms the link's frame cannot be tried: then forces that break the rules in the
    world frame are in a link's, and those that neither break nor obey them are undecided.

    Args:
        world: fit of the forces as recorded.
        link: fit of the forces turned from the links' frames by the log's transforms.
        weight_n: N, the robot's weight; None: not known.
    """
    if world is None:
        return WrenchFrameEvidence(WrenchFrame.UNKNOWN, world, link)
    if link is None:
        return WrenchFrameEvidence(_without_transforms(world), world)
    if world.in_world and link.in_world:
        return WrenchFrameEvidence(_better(world, link, weight_n), world, link)
    if world.in_world or link.in_world:
        frame = WrenchFrame.WORLD if world.in_world else WrenchFrame.LINK
        return WrenchFrameEvidence(frame, world, link)
    return WrenchFrameEvidence(WrenchFrame.UNKNOWN, world, link)


def _without_transforms(world: FrameFit) -> WrenchFrame:
    """Decide by the forces as recorded alone."""
    if world.in_world:
        return WrenchFrame.WORLD
    broken = world.in_cone < IN_CONE or world.net_tilt > NET_TILT
    return WrenchFrame.LINK if broken else WrenchFrame.UNKNOWN


def _better(world: FrameFit, link: FrameFit, weight_n: float | None) -> WrenchFrame:
    """Decide between two hypotheses that both obey the rules."""
    if weight_n is not None:
        misses = [abs(fit.vertical_n / weight_n - 1.0) for fit in (world, link)]
        if abs(misses[0] - misses[1]) > NEARER:
            return WrenchFrame.WORLD if misses[0] < misses[1] else WrenchFrame.LINK
    tilts = [fit.net_tilt + fit.foot_tilt for fit in (world, link)]
    if abs(tilts[0] - tilts[1]) > NEARER:
        return WrenchFrame.WORLD if tilts[0] < tilts[1] else WrenchFrame.LINK
    if abs(world.vertical_n - link.vertical_n) <= SAME_FORCE * world.vertical_n:
        return WrenchFrame.WORLD
    return WrenchFrame.UNKNOWN
