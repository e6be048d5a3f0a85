"""What a log's frames tell of its robot: those below the base, feet, shape, and limbs over time."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, median_of
from dogbot_logtool.core.frames.transforms import FrameTrack, chain_of_frames, lookup
from dogbot_logtool.core.known_frames import KnownFrames, Point
from dogbot_logtool.core.legs.joints import LegChain
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.names import name_feet
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.words import SOLES, Part, texts_of

_INSIDE: Final = 0.75
"""Hips over feet: how much nearer to the middle of the body they are assumed to be."""
_DENSITY: Final = 500.0
"""kg/m3 of a body whose legs are not known; half of water's, as robots have."""
_USUAL_MASS_KG: Final = 12.0
_ORIGIN: Final = (0.0, 0.0, 0.0)
_GRID_M: Final = 0.02
"""m, to which points of soles are rounded: a picture needs no more."""
MOST_FRAMES: Final = 64
"""Frames of a robot that are followed."""


class Skeleton(NamedTuple):
    """The frames below the base."""

    base: str
    frames: Mapping[str, FrameTrack]
    """By name, parents before children."""
    legs: Mapping[int, tuple[str, ...]]
    """The frames from that of a foot up to the child of the base, by foot, where they are known."""
    soles: Mapping[int, Point]
    """m, where these feet touch the ground in their frames."""

    @property
    def limbs(self) -> list[str]:
        """The frames of legs, and others that move."""
        legs = {frame for leg in self.legs.values() for frame in leg}
        return [name for name, own in self.frames.items() if name in legs or not own.static]


class RobotShape(NamedTuple):
    """The known shape of the robot."""

    forward_axis: str
    """The body axis that points forward, ``+x`` ..."""
    hips: Mapping[int, Point]
    """m, base frame: where legs are assumed to begin, by foot."""
    height_m: float
    """Height of the base above the feet."""
    size_m: float
    """Length of the body, or its height above the feet if that is more."""


def skeleton(selection: Selection, probe: KnownFrames, links: Mapping[str, FrameTrack]) -> Skeleton:
    """Return the frames of a log that hang below the base; those with two parents do not.

    Args:
        selection: the robot's feet.
        probe: the frames that the log's transforms place.
        links: those that joint states place.
    """
    base, known = probe.base, {**links, **probe.tracks(probe.parent_of)}
    parents = {child: track.parent for child, track in known.items()}
    chains = {child: chain_of_frames(parents, child, base) or () for child in known}
    below = sorted((len(chain), child) for child, chain in chains.items() if chain)
    frames = {child: known[child] for _, child in below}
    legs, soles = dict[int, tuple[str, ...]](), dict[int, Point]()
    for number, leg in enumerate(leg_chains(selection, probe, parents)):
        if leg is not None:
            is_given = selection.robot.feet[number].frame is not None
            legs[number] = leg.frames
            soles[number] = leg.point if is_given else _rounded(leg.point)
    return Skeleton(base, frames, legs, soles)


def _rounded(point: Point) -> Point:
    x, y, z = (np.round(np.array(point) / _GRID_M) * _GRID_M + 0.0).tolist()
    return x, y, z


def leg_chains(
    selection: Selection, probe: KnownFrames, parents: Mapping[str, str]
) -> list[LegChain | None]:
    """Return how feet hang on the base by the parents of frames.

    Each does by its own frame, or by one that is named so.
    """
    feet, chains = selection.robot.feet, list[LegChain | None]()
    named = named_frames(feet, parents)
    for number, foot in enumerate(feet):
        frame, point = _place_of_foot(selection, probe, number) or (None, None)
        if frame and point:
            places = [(frame, point, foot.frame is None or any(point))]
        else:
            places = [(each, _ORIGIN, False) for each in (named.get(number), frame) if each]
        found = (
            LegChain(frames, probe.base.lstrip("/"), point, touches)
            for frame, point, touches in places
            if (frames := chain_of_frames(parents, frame, probe.base))
        )
        chains.append(next(found, None))
    return chains


def named_frames(feet: Sequence[Foot], frames: Iterable[str]) -> dict[int, str]:
    """Return the frame of each foot among frames that are named like the feet of all legs.

    A frame of the sole comes before others, which may as well be at the ankle or the knee.
    """
    names = list(frames)
    soles = [name for name in names if texts_of(name) & SOLES]
    found, _ = name_feet(soles, contacts_only=False)
    found = found or name_feet(names, contacts_only=False)[0]
    if found is None or found.part is not Part.FOOT:
        return {}
    named = {each.leg_position or each.name: each.topic for each in found.feet}
    keys = (foot.leg_position if foot.leg_position in named else foot.name for foot in feet)
    return {number: named[key] for number, key in enumerate(keys) if key in named}


def _place_of_foot(
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


def robot_shape(walk: Walk) -> RobotShape:
    """Return what the positions of standing feet, else the mass, tell of a robot's shape."""
    stances = {foot: _rounded(point) for foot, point in walk.frames.stances.items()}
    length = height = body_size_m(walk.settings.mass_kg)[0]
    if stances:
        points = np.array(list(stances.values()))
        height = max(-float(median_of(points[:, 2])), 0.0) or length
        length = max(float(np.ptp(points[:, :2], axis=0).max()), 0.5 * length)
    hips = {foot: (_INSIDE * x, _INSIDE * y, 0.0) for foot, (x, y, _) in stances.items()}
    return RobotShape(walk.settings.forward_axis, hips, height, max(length, height))


def body_size_m(mass_kg: float | None) -> tuple[float, float, float]:
    """Return length, width and height, m, of a body of some mass; None: a usual one."""
    third = ((mass_kg or _USUAL_MASS_KG) / _DENSITY / 6.0) ** (1.0 / 3.0)
    return 3.0 * third, 2.0 * third, third


class Limbs(NamedTuple):
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
    known = skeleton(selection, walk.frames, walk.legs.links if walk.legs else {})
    drawn, base = known.limbs, known.base
    if not drawn or len(drawn) > MOST_FRAMES:
        return None
    parents = {child: track.parent for child, track in known.frames.items()}
    feet = {foot: (frames[0], known.soles[foot]) for foot, frames in known.legs.items()}
    points: list[Floats] = []
    for frame, point in (*((frame, _ORIGIN) for frame in drawn), *feet.values()):
        pose = lookup(known.frames, frame, base, time, _recorded(known.frames, frame, time))
        points.append(pose.translation + rotate(pose.rotation, np.array([point])))
    above = [*(parents[frame] for frame in drawn), *(frame for frame, _ in feet.values())]
    sole = {foot: len(drawn) + index for index, foot in enumerate(feet)}
    return Limbs(
        np.stack(points, axis=1).astype(np.float32),
        tuple(_nearest(drawn, parents, base, frame) for frame in above),
        tuple(sole.get(foot) for foot in range(len(selection.robot.feet))),
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
