"""What a log's frames tell of its robot: those below the base, feet, shape, and limbs over time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, median_of
from dogbot_logtool.core.base.axes import nearest_axis
from dogbot_logtool.core.frames.transforms import FrameTrack, chain_of_frames, lookup
from dogbot_logtool.core.known_frames import KnownFrames, Point
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.selection import Selection

_INSIDE: Final = 0.75
"""Hips over feet: how much nearer to the middle of the body they are assumed to be."""

_DENSITY: Final = 500.0
"""kg/m3 of a body whose legs are not known; half of water's, as robots have."""
_USUAL_MASS_KG: Final = 12.0
_ORIGIN: Final = (0.0, 0.0, 0.0)
_GRID_M: Final = 0.02
"""m, to which points of soles are rounded: a picture needs no more."""


@dataclass(frozen=True, slots=True)
class FramePose:
    """The first recorded pose of a frame in its parent."""

    parent: str
    """Frame ids have no leading slash."""
    translation: Point
    """m."""
    rotation: tuple[float, float, float, float]
    """Unit quaternion x, y, z, w."""
    static: bool


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


@dataclass(frozen=True, slots=True)
class RobotShape:
    """The known shape of the robot."""

    forward_axis: str
    """The body axis that points forward, ``+x`` ..."""
    hips: Mapping[int, Point]
    """m, base frame: where legs are assumed to begin, by foot."""
    height_m: float
    """Height of the base above the feet."""
    size_m: float
    """Length of the body, or its height above the feet if that is more."""


def skeleton(selection: Selection, probe: KnownFrames, base: str) -> Skeleton:
    """Return the frames of a log that hang below the base; those with two parents do not."""
    parents = probe.parent_of
    known = probe.tracks(parents)
    chains = {child: chain_of_frames(parents, child, base) or () for child in known}
    below = sorted((len(chain), child) for child, chain in chains.items() if chain)
    frames = {child: _first_pose(known[child]) for _, child in below}
    feet = (foot for foot in model_feet(selection, probe) if foot.frame in {base, *frames})
    return Skeleton(base, frames, tuple(feet))


def _first_pose(track: FrameTrack) -> FramePose:
    shift, turn = tuple(track.translation[0].tolist()), tuple(track.rotation[0].tolist())
    return FramePose(track.parent, shift, turn, track.static)


def _rounded(point: Point) -> Point:
    x, y, z = (np.round(np.array(point) / _GRID_M) * _GRID_M + 0.0).tolist()
    return x, y, z


def model_feet(selection: Selection, probe: KnownFrames) -> Iterator[ModelFoot]:
    """Yield the feet whose frames are known, with the points where they touch the ground."""
    for number, foot in enumerate(selection.robot.feet):
        if place := place_of_foot(selection, probe, number):
            frame, point = place
            if foot.frame is None:
                point = _rounded(point or _ORIGIN)
            yield ModelFoot(foot.name, frame, point or _ORIGIN, foot_colour(number))


def place_of_foot(
    selection: Selection, probe: KnownFrames, number: int
) -> tuple[str, Point | None] | None:
    """Return the frame of a foot and where it touches, m in that frame; None: not known.

    By the robot's file, else by the link of its contacts. A foot that reports no contact is on a
    link that is named as another foot's, but for the foot's name, and is made like that one.
    """
    foot = selection.robot.feet[number]
    names = [each.name for each in selection.robot.feet]
    if foot.frame is not None:
        return foot.frame.lstrip("/"), foot.contact_point_m
    for like, link in sorted(enumerate(probe.links), key=lambda each: each[0] != number):
        if link is not None and (like == number or names[like] in link):
            named = link.lstrip("/").replace(names[like], foot.name)
            if like == number or named in probe.parents:
                return named, probe.soles.get(number, probe.soles.get(like))
    return None


def robot_shape(selection: Selection, probe: KnownFrames) -> RobotShape:
    """Return what the positions of standing feet, else the mass, tell of a robot's shape."""
    robot = selection.robot
    stances = {foot: _rounded(point) for foot, point in probe.stances.items()}
    length = height = body_size_m(robot.mass_kg)[0]
    if stances:
        points = np.array(list(stances.values()))
        height = max(-float(median_of(points[:, 2])), 0.0) or length
        length = max(float(np.ptp(points[:, :2], axis=0).max()), 0.5 * length)
    hips = {foot: (_INSIDE * x, _INSIDE * y, 0.0) for foot, (x, y, _) in stances.items()}
    axis = _axis_by_feet(robot, stances) if selection.robot_is_guessed else None
    return RobotShape(axis or robot.forward_axis, hips, height, max(length, height))


def _axis_by_feet(robot: Robot, stances: Mapping[int, Point]) -> str | None:
    """Return the axis from hind to fore feet; None: their positions are not known."""
    ends: dict[str, list[Point]] = {"front": [], "back": []}
    for number, point in stances.items():
        position = robot.feet[number].leg_position
        if position is not None and position[0] in ends:
            ends[position[0]].append(point)
    if not all(ends.values()):
        return None
    fore, hind = (np.mean(points, axis=0) for points in ends.values())
    return nearest_axis((fore - hind)[:2])


def body_size_m(mass_kg: float | None) -> tuple[float, float, float]:
    """Return length, width and height, m, of a body of some mass; None: a usual one."""
    third = ((mass_kg or _USUAL_MASS_KG) / _DENSITY / 6.0) ** (1.0 / 3.0)
    return 3.0 * third, 2.0 * third, third


MOST_FRAMES: Final = 64
"""Frames of a robot that are followed."""


@dataclass(frozen=True, slots=True)
class Limbs:
    """The origins of frames below the base, and the feet's soles, over time."""

    point: Float32s
    """(n, k, 3) m, in the base's frame; NaN where not known."""
    parents: tuple[int, ...]
    """(k,) index of the point that each hangs on; -1: the base."""
    soles: tuple[int | None, ...]
    """Index of each foot's sole; None: its frame is not known."""


def find_limbs(walk: Walk, selection: Selection, time: Ints) -> Limbs | None:
    """Follow the frames of a robot; None where nothing connects any with its base.

    The log's transforms place them, or its joint states with its robot description.

    Args:
        walk: what was measured.
        selection: the robot's feet.
        time: (n,) ns on the walk's clock, increasing.
    """
    probe, links = walk.frames, walk.legs.links if walk.legs else {}
    known = skeleton(selection, probe, probe.base)
    legs = {frame for leg in known.legs for frame in leg}
    parents = {name: pose.parent for name, pose in known.frames.items()}
    drawn = [name for name, pose in known.frames.items() if name in legs or not pose.static]
    for child, track in links.items():
        drawn += [child] if child not in parents and not track.static else []
        parents.setdefault(child, track.parent)
    drawn = [frame for frame in drawn if chain_of_frames(parents, frame, probe.base) is not None]
    if not drawn or len(drawn) > MOST_FRAMES:
        return None
    tracks = {**links, **probe.tracks(known.frames)}
    feet = [foot for foot in model_feet(selection, probe) if foot.frame in parents]
    points: list[Floats] = []
    for frame, point in (
        *((frame, (0.0, 0.0, 0.0)) for frame in drawn),
        *((foot.frame, foot.point) for foot in feet),
    ):
        pose = lookup(tracks, frame, probe.base, time, _recorded(tracks, frame, time))
        points.append(pose.translation + rotate(pose.rotation, np.array([point])))
    above = [*(parents[frame] for frame in drawn), *(foot.frame for foot in feet)]
    sole = {foot.name: len(drawn) + index for index, foot in enumerate(feet)}
    return Limbs(
        np.stack(points, axis=1).astype(np.float32),
        tuple(_nearest(drawn, parents, probe.base, frame) for frame in above),
        tuple(sole.get(foot.name) for foot in selection.robot.feet),
    )


def _recorded(tracks: Mapping[str, FrameTrack], frame: str, time: Ints) -> Ints:
    """(n,) ns, log times of some times: about when a frame's transforms were recorded."""
    track = tracks.get(frame)
    if track is None or track.static:
        return time
    since = np.interp(time - time[0], track.time - time[0], track.log_time - track.log_time[0])
    recorded: Ints = track.log_time[0] + np.rint(since).astype(np.int64)
    return recorded


def _nearest(drawn: Sequence[str], parents: Mapping[str, str], base: str, frame: str) -> int:
    """Return the index of a frame or, where it is not drawn, of the next above; -1: the base."""
    while frame != base and frame not in drawn:
        frame = parents[frame]
    return -1 if frame == base else drawn.index(frame)
