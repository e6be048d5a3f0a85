"""In which frame are the recorded wrenches? Decided by evidence.

On ground, a world-frame contact force lies near the contact normal. A force that was rotated
into the leg's link (as Gazebo classic does) lies anywhere. So the median of |F.n| / |F| over
loaded samples tells the two apart, except for legs that stand nearly upright.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.geometry.arrays import Floats, norms

LOADED_N: Final = 10.0
"""Lighter samples say little about direction."""
ALIGNED: Final = 0.95
"""Median alignment from which wrenches count as world-frame (a friction angle of 18 degrees)."""
FEWEST_SAMPLES: Final = 20


class WrenchFrame(StrEnum):
    """The frame of recorded wrenches."""

    WORLD = "world"
    LINK = "link"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class WrenchFrameEvidence:
    """How well recorded forces point along the contact normals."""

    frame: WrenchFrame
    median_alignment: float | None = None
    """Median of |F.n| / |F|; None without loaded samples that have normals."""
    samples: int = 0
    """Loaded samples that were looked at; 0 too where the type of the messages decides."""


def alignment(samples: Samples) -> Floats:
    """Return |F.n| / |F| of the samples that are loaded and have a normal.

    Samples read off the other body are in the world frame anyway and say nothing.
    """
    magnitude = norms(samples.force)
    usable = samples.in_contact & ~samples.in_world & np.isfinite(magnitude)
    usable &= (magnitude >= LOADED_N) & np.isfinite(samples.normal).all(axis=1)
    chosen = samples.pick(usable)
    along: Floats = np.abs((chosen.force * chosen.normal).sum(axis=1)) / magnitude[usable]
    return along


def judge_wrench_frame(alignments: Floats) -> WrenchFrameEvidence:
    """Decide the wrench frame from `alignment` of samples taken all over the log."""
    if len(alignments) == 0:
        return WrenchFrameEvidence(WrenchFrame.UNKNOWN, None, 0)
    median = float(np.median(alignments))
    if len(alignments) < FEWEST_SAMPLES:
        frame = WrenchFrame.UNKNOWN
    else:
        frame = WrenchFrame.WORLD if median >= ALIGNED else WrenchFrame.LINK
    return WrenchFrameEvidence(frame, median, len(alignments))
