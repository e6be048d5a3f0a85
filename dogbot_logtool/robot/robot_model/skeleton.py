"""The frames of a robot below its base, and where its feet touch the ground in them."""

from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from dogbot_logtool.core.frames.frame_tree import DEEPEST
from dogbot_logtool.core.frames.transforms import chain_of_frames
from dogbot_logtool.core.soles import FramePose, Point


@dataclass(frozen=True, slots=True)
class ModelFoot:
    """A foot of the robot that is drawn."""

    name: str
    frame: str
    point: Point
    """m, where it touches the ground, in the frame."""
    colour: str
    """As ``#rrggbb``."""


@dataclass(frozen=True, slots=True)
class Skeleton:
    """The frames below the base."""

    base: str
    frames: Mapping[str, FramePose]
    """By name, parents before children."""
    feet: tuple[ModelFoot, ...]
    """Those whose frames are among the frames."""

    @property
    def legs(self) -> tuple[tuple[str, ...], ...]:
        """For each foot, the frames from its own up to the child of the base."""
        parents = {child: pose.parent for child, pose in self.frames.items()}
        chains = (chain_of_frames(parents, foot.frame, self.base) for foot in self.feet)
        return tuple(chain for chain in chains if chain)

    @property
    def limbs(self) -> Iterator[tuple[str, FramePose]]:
        """Yield the frames that end a limb: those of legs, and others that move."""
        legs = {frame for leg in self.legs for frame in leg}
        hips = {leg[-1] for leg in self.legs}
        for frame, pose in self.frames.items():
            if frame not in hips and (frame in legs or not pose.static):
                yield frame, pose


def skeleton(
    base: str,
    poses: Mapping[str, FramePose],
    ambiguous: AbstractSet[str],
    feet: tuple[ModelFoot, ...],
) -> Skeleton:
    """Return the frames that hang below the base.

    Args:
        base: the base's frame.
        poses: of all frames of the log, by child.
        ambiguous: frames with several parents, which are left out with all below them.
        feet: of the robot; those with unconnected frames are left out.
    """
    children: dict[str, list[str]] = {}
    for child, pose in poses.items():
        if child not in ambiguous:
            children.setdefault(pose.parent, []).append(child)
    frames: dict[str, FramePose] = {}
    level = [base]
    for _ in range(DEEPEST):
        below = (child for parent in level for child in children.get(parent, ()))
        level = sorted(child for child in below if child != base and child not in frames)
        frames.update((child, poses[child]) for child in level)
    return Skeleton(base, frames, tuple(foot for foot in feet if foot.frame in {base, *frames}))
