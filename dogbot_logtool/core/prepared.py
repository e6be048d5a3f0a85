"""A recording prepared to be measured: one clock, poses of the base, no number beyond all robots.

A simulation at a quarter of real time stamps a second while the recorder's clock goes four. What
comes without a stamp happened when the stamped clock read what it did at that log time.

The bound beyond which a number is no measurement is far beyond what any robot reaches, and low
enough that no metric made of numbers within it overflows.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import AnyColumns, Flags, Floats, all_finite
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.corrections.clock import TimeSource, advancing, clock_at
from dogbot_logtool.core.frames.transforms import lookup, track_of
from dogbot_logtool.core.recording import Recording, has_own_stamps
from dogbot_logtool.core.rotations import conjugate, multiply, normalised, rotate
from dogbot_logtool.finding import Finding, found

SAME_SPEED: Final = 0.02
"""Difference of a clock's speed from that of log time that does not matter."""
FEWEST: Final = 20
LONG_NS: Final = 1_000_000_000


def on_one_clock(recording: Recording, topic: str) -> tuple[Recording, tuple[Finding, ...]]:
    """Stamp unstamped feet by the clock of the base, or an unstamped base by that of the feet.

    Only where that clock runs at another speed than log time.

    Args:
        recording: the columns of a log.
        topic: of the base's poses.

    Returns:
        the recording, and what was done.
    """
    feet = [each for each in recording.feet if len(each.log_time)]
    base, stamped = recording.base, {has_own_stamps(each) for each in feet}
    base_is_stamped = has_own_stamps(base)
    if not len(base.log_time) or stamped != {not base_is_stamped}:
        return recording, ()
    source = base if base_is_stamped else max(feet, key=lambda each: len(each.log_time))
    rows = np.flatnonzero((source.stamp > 0) & advancing(source.stamp) & advancing(source.log_time))
    log_time, stamp = source.log_time[rows], source.stamp[rows]
    if len(rows) < FEWEST or log_time[-1] - log_time[0] < LONG_NS:
        return recording, ()
    speed = float(stamp[-1] - stamp[0]) / float(log_time[-1] - log_time[0])
    if abs(speed - 1.0) <= SAME_SPEED:
        return recording, ()

    def stamped_alike(columns: AnyColumns) -> AnyColumns:
        own: Any = columns
        return replace(own, stamp=clock_at(own.log_time, log_time, stamp))  # type: ignore[no-any-return]

    if base_is_stamped:
        changed = replace(recording, feet=tuple(stamped_alike(each) for each in recording.feet))
    else:
        changed = replace(recording, base=stamped_alike(base))
    others, stamped_ones = ("feet", "odometry")[:: 1 if base_is_stamped else -1]
    finding = found(
        "CLOCK_OFFSET",
        "little",
        say="others",
        where=topic,
        stamped=stamped_ones,
        others=others,
        speed=speed,
    )
    return changed, (finding,)


_SENSORS: Final = frozenset(
    {"imu", "camera", "cam", "lidar", "laser", "gps", "gnss", "livox", "velodyne", "ouster"}
    | {"os", "sensor", "t265", "zed", "realsense", "optical", "marker", "antenna"}
)
"""Words of links that are no base."""
_FLOOR: Final = "base_footprint"


def poses_of_base(
    recording: Recording,
    topic: str,
    named: str | None,
    bases: Sequence[str],
) -> tuple[Recording, tuple[Finding, ...]]:
    """Move poses of another link to the base, where static transforms tell how.

    Args:
        recording: the columns of a log.
        topic: of the poses.
        named: the base's frame, if the robot's file tells it.
        bases: usual names of a base's frame, the best first.

    Returns:
        the recording, and what was done, or could not be.
    """
    frames = [name.lstrip("/") for name in recording.base_frames if name.strip("/")]
    if len(frames) != 1:
        return recording, ()
    statics = {
        child: track
        for (parent, child), own in recording.transforms.items()
        if own.static.any() and (track := track_of(parent, own, TimeSource.LOG))
    }
    parents = {child: track.parent for child, track in statics.items()}
    above = [frames[0]]
    while above[-1] in parents and parents[above[-1]] not in above:
        above.append(parents[above[-1]])
    base = _base_of(above, named and named.lstrip("/"), bases, parents)
    if base == above[0]:
        return recording, ()
    now = np.zeros(1, np.int64)
    own, other = (lookup(statics, each, above[-1], now, now) for each in (above[0], base or ""))
    if not (own.known[0] and other.known[0]):
        return recording, (found("POSE_FRAME", "unknown", topic=topic, frame=above[0]),)
    displacement, back = other.translation - own.translation, conjugate(own.rotation)
    slash = "/" if recording.base_frames[0].startswith("/") else ""
    moved = replace(
        recording,
        base=_moved(recording.base, rotate(back, displacement), multiply(back, other.rotation)),
        base_frames=(f"{slash}{base}",),
    )
    metres = float(np.linalg.norm(displacement))
    moving = found("POSE_FRAME", topic=topic, frame=above[0], base=base, metres=metres)
    return moved, (moving,)


def _base_of(
    above: Sequence[str], named: str | None, bases: Sequence[str], parents: Mapping[str, str]
) -> str | None:
    """Return the base that a link belongs to; itself, where it may be one; None: not known.

    Args:
        above: the link, its parent, its parent's parent, and so on.
        named: the base's frame by the robot's file.
        bases: usual names of bases.
        parents: by frame.
    """
    child = above[0]
    if named is not None and named != child:
        return named if named in {*parents, *parents.values()} else child
    for base in bases:
        if base in above and base != _FLOOR:
            return base
        if child == _FLOOR and parents.get(base) == child:
            return base
    words = frozenset(re.findall(r"[a-z0-9]+", child.lower()))
    return child if words.isdisjoint(_SENSORS) else None


def _moved(base: Odometry, translation: Floats, rotation: Floats) -> Odometry:
    """Return the poses of a point of the same body, whose own turn is part of it."""
    turned = base.orientation.any(axis=1)
    orientation, position = base.orientation.copy(), base.position.copy()
    unit = normalised(base.orientation[turned])
    position[turned] += rotate(unit, translation)
    orientation[turned] = multiply(unit, rotation)
    return replace(base, position=position, orientation=orientation)


LARGEST: Final = 1e9
"""m, m/s, rad/s or N: beyond the moon, faster than light, stronger than any rocket."""
_BOUNDED: Final = ("position", "linear_velocity", "force")


def _beyond(vectors: Floats) -> Flags:
    """(n,) which rows of (n, k) are finite but have a number beyond the bound."""
    if not len(vectors) or (vectors.min() >= -LARGEST and vectors.max() <= LARGEST):
        return np.zeros(len(vectors), np.bool_)
    return np.asarray((np.abs(vectors) > LARGEST).any(axis=1)) & all_finite(vectors)


def plausible(columns: AnyColumns) -> tuple[AnyColumns, int]:
    """Take poses, forces and places that no robot reaches for NaN; count the rows with one."""
    own: Any = columns
    far = {name: _beyond(getattr(own, name)) for name in _BOUNDED if hasattr(own, name)}
    changes = {
        name: np.where(rows[:, None], np.nan, getattr(own, name))
        for name, rows in far.items()
        if rows.any()
    }
    if not changes:
        return columns, 0
    return replace(own, **changes), int(np.any(list(far.values()), axis=0).sum())


def plausible_translations(translation: Floats) -> Floats:
    """Take translations that no robot reaches for NaN; (n, 3) m."""
    return np.where(_beyond(translation)[:, None], np.nan, translation)
