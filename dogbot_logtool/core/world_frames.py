"""Forces and positions of feet turned into the world by the log's own frames, and their soles."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, all_finite, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import FrameTrack, Poses, lookup
from dogbot_logtool.core.frames.wrench_frame import FramePoint
from dogbot_logtool.core.rotations import conjugate, rotate

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
    tracks: Mapping[str, FrameTrack]
    """Of the frames on the way from these to the world."""
    clock: TimeSource

    def place(self, feet: Sequence[Samples]) -> tuple[tuple[Samples, ...], PlacedCounts]:
        """Turn forces of each foot into the world and place its sensor, where frames tell."""
        turned = [self._turn(*each) for each in zip(feet, self.links, strict=True)]
        placed = [
            self._put(samples, point)
            for (samples, _), point in zip(turned, self.points, strict=True)
        ]
        parts = (np.concatenate([known for _, known in each]) for each in (turned, placed))
        counts = [(int(known.sum()), int((~known).sum())) for known in parts]
        return tuple(samples for samples, _ in placed), PlacedCounts(*counts)

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

    def soles(
        self, feet: Sequence[Samples], spread_m: float, in_base: AbstractSet[int] = frozenset()
    ) -> dict[int, Point]:
        """Return the median contact point, m, of each foot whose points agree in its link's frame.

        Args:
            feet: contact samples of each.
            spread_m: m, median distance from the median beyond which a foot has no sole.
            in_base: feet whose points are in the base's frame as they are recorded.
        """
        found: dict[int, Point] = {}
        for foot, (samples, link) in enumerate(zip(feet, self.links, strict=True)):
            rows = np.flatnonzero(samples.in_contact & all_finite(samples.position))
            rows = rows[:: len(rows) // _MOST_SAMPLES + 1]
            if link is None or not len(rows):
                continue
            points = samples.position[rows]
            if foot not in in_base:
                poses = self._poses(link, samples.pick(rows))
                offset = (points - poses.translation)[poses.known]
                points = rotate(conjugate(poses.rotation[poses.known]), offset)
            if len(points) < _FEWEST:
                continue
            middle = median_of(points, axis=0)
            spread = float(median_of(np.sqrt(((points - middle) ** 2).sum(axis=1))))
            if spread <= spread_m and float(np.sqrt((middle**2).sum())) <= _FARTHEST_M:
                found[foot] = tuple(middle.tolist())
        return found
