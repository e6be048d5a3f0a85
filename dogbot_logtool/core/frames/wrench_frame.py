"""The frame of recorded forces, by what physics says of them."""

from collections.abc import Sequence
from enum import StrEnum
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    all_finite,
    distinct,
    median_of,
    norms,
)
from dogbot_logtool.core.contact.contacts import Samples


class FramePoint(NamedTuple):
    """A point of a link, given by its frame."""

    frame: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m, in that frame."""
    recorded: bool = False
    """Whether each sample's own position is in that frame, instead of `offset`."""


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
TINY_N: Final = 1e-6
"""Lighter forces have no direction."""
FEWEST_SAMPLES: Final = 20


class WrenchFrame(StrEnum):
    """The frame of recorded wrenches."""

    WORLD = "world"
    LINK = "link"
    UNKNOWN = "unknown"


class FrameFit(NamedTuple):
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

    @property
    def in_world(self) -> bool:
        """Whether the forces can be in the world frame."""
        straight = self.net_tilt <= NET_TILT and self.foot_tilt <= FOOT_TILT
        return straight and self.in_cone >= IN_CONE


class WrenchFrameEvidence(NamedTuple):
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
    forces, normals, vertical_n = [np.empty((0, 3))], [np.empty((0, 3))], 0.0
    for row, part in enumerate(samples):
        size_n = norms(part.force)
        loaded = part.in_contact & np.isfinite(size_n)
        summed = loaded if turned is None else loaded & part.in_world
        if summed.any():
            # The mean over contact, by the share of contact in all samples.
            vertical_n += float(part.force[summed, 2].mean()) * float(part.in_contact.mean())
        doubtful = loaded & (~part.in_world if turned is None else turned[row])
        doubtful &= (size_n >= TINY_N) & all_finite(part.normal)
        forces.append(part.force[doubtful])
        normals.append(part.normal[doubtful])
    foot = np.repeat(np.arange(len(forces)), [len(each) for each in forces])
    force, normal = (np.concatenate(each, dtype=np.float64) for each in (forces, normals))
    if len(force) < FEWEST_SAMPLES:
        return None
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
        vertical_n=abs(vertical_n),
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
    frame = WrenchFrame.UNKNOWN
    if world is not None and link is None:
        broken = world.in_cone < IN_CONE or world.net_tilt > NET_TILT
        frame = WrenchFrame.LINK if broken else frame
        frame = WrenchFrame.WORLD if world.in_world else frame
    elif world is not None and link is not None and (world.in_world or link.in_world):
        frame = WrenchFrame.WORLD if world.in_world else WrenchFrame.LINK
        if world.in_world and link.in_world:
            frame = _better(world, link, weight_n)
    return WrenchFrameEvidence(frame, world, link)


def _better(world: FrameFit, link: FrameFit, weight_n: float | None) -> WrenchFrame:
    """Decide between two hypotheses that both obey the rules."""
    misses = [
        [abs(fit.vertical_n / (weight_n or np.nan) - 1.0) for fit in (world, link)],
        [fit.net_tilt + fit.foot_tilt for fit in (world, link)],
    ]
    for of_world, of_link in misses:
        if abs(of_world - of_link) > NEARER:
            return WrenchFrame.WORLD if of_world < of_link else WrenchFrame.LINK
    alike = abs(world.vertical_n - link.vertical_n) <= SAME_FORCE * world.vertical_n
    return WrenchFrame.WORLD if alike else WrenchFrame.UNKNOWN
