"""Did the robot fall? What its feet do while it lies is not walking."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_record import BaseRecord
from dogbot_logtool.core.contact.foot_history import FootRecord
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints

TILT_RAD: Final = np.pi / 3.0
"""A base that leans further has fallen over."""
COLLAPSED: Final = 0.4
"""A base below this share of its usual height over the feet has gone down."""
_CHUNK: Final = 1_000_000
"""Poses that are worked on at once, to spare memory."""
LASTING_S: Final = 0.3
"""A fall lasts; a single wrong pose does not make one."""


def fallen_spans(base: BaseRecord, feet: Sequence[FootRecord]) -> Ints:
    """Find the spans in which the robot lies: leaning over 60 degrees, or collapsed.

    The height over ground is that over the feet's mean contact point; its usual value is the
    third quartile, since a robot that fell early lies for most of the log.

    Returns:
        (f, 2) ns.
    """
    if len(base.time) < 2:
        return timespans.no_spans()
    parts = [slice(start, start + _CHUNK) for start in range(0, len(base.time), _CHUNK)]
    height = np.concatenate([_height_over_feet(base, feet, part) for part in parts])
    tilted = np.concatenate([_tilted(base.angles[part]) for part in parts])
    spans = timespans.spans_where(base.time, (tilted | _collapsed(height))[:-1])
    return spans[spans[:, 1] - spans[:, 0] >= LASTING_S * 1e9]


def _tilted(angles: Floats) -> Flags:
    """(n,) whether the body's z axis leans further than `TILT_RAD` from the vertical."""
    tilted: Flags = np.cos(angles[:, 0]) * np.cos(angles[:, 1]) < np.cos(TILT_RAD)
    return tilted


def _collapsed(height: Floats) -> Flags:
    known = height[np.isfinite(height)]
    if len(known) == 0:
        return np.zeros(len(height), np.bool_)
    usual = float(np.quantile(known, 0.75))
    with np.errstate(invalid="ignore"):
        collapsed: Flags = (height < COLLAPSED * usual) & (usual > 0.0)
    return collapsed


def _height_over_feet(base: BaseRecord, feet: Sequence[FootRecord], part: slice) -> Floats:
    """(n,) m: base above the mean of the feet's latest contact points; NaN before any."""
    at = base.time[part]
    total = np.zeros(len(at))
    number = np.zeros(len(at), np.int64)
    for foot in feet:
        known = np.isfinite(foot.track.point[:, 2])
        time, z = foot.track.time[known], foot.track.point[known, 2]
        if len(time) == 0:
            continue
        row = np.searchsorted(time, at, side="right") - 1
        seen = row >= 0
        total += np.where(seen, z[np.maximum(row, 0)], 0.0)
        number += seen
    with np.errstate(invalid="ignore", divide="ignore"):
        height: Floats = base.position[part, 2] - np.where(number > 0, total / number, np.nan)
    return height
