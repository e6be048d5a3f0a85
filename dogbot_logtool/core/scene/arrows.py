"""The arrow at a foot for each contact sample, and its colour.

``classic``   the markers of the live script `arrows_rviz.py`, bit for bit;
``pressure``  the same picture corrected: newest physics step, all states, straight up;
``force``     ground-reaction forces, along the force, coloured by body weights.

Load is the colour of light, by the wavelength map of the live script: the widely used
piecewise-linear approximation, with intensity falling off towards the ends of the visible range and
a gamma of 0.8. It is exact: equal, as float32, to the plain Python formulas with the C library's
``pow``.
"""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Float32s, Floats, Ints, all_finite, header_time, norms
from dogbot_logtool.core.contact.contacts import Contacts, Samples

EDGES_NM: Final = np.array([380.0, 440.0, 490.0, 510.0, 580.0, 645.0, 750.0])
"""nm, between which colours change evenly; an edge belongs to the range below it."""
SHORTEST_NM: Final = 380.0
LONGEST_NM: Final = 750.0
_GAMMA: Final = 0.8
_POW_ULPS: Final = 8
"""numpy's vectorised pow is within 4 units in the last place of the C library's; twice that."""


def wavelength_to_rgba(wavelength_nm: Floats) -> Float32s:
    """Return the colours of wavelengths of light.

    Args:
        wavelength_nm: (n,). Outside [380, 750], and NaN, is black.

    Returns:
        (n, 4) red, green, blue in [0, 1] and alpha 1.
    """
    part = np.searchsorted(EDGES_NM, wavelength_nm)
    part[wavelength_nm == SHORTEST_NM] = 1
    seen = np.flatnonzero((part > 0) & (part < len(EDGES_NM)))
    v, part = wavelength_nm[seen], part[seen]
    low, high = EDGES_NM[part - 1], EDGES_NM[part]
    rise, fall = (v - low) / (high - low), -(v - high) / (high - low)
    violet = 0.3 + 0.7 * (v - 380.0) / (440.0 - 380.0)
    deep_red = 0.3 + 0.7 * (750.0 - v) / (750.0 - 645.0)
    none, full = np.zeros(len(v)), np.ones(len(v))
    rgba = np.zeros((len(wavelength_nm), 4), np.float32)
    rgba[:, 3] = 1.0
    for channel, ranges in enumerate(
        (
            (fall * violet, none, none, rise, full, deep_red),
            (none, rise, full, full, fall, none),
            (violet, full, fall, none, none, none),
        )
    ):
        rgba[seen, channel] = _gamma(np.choose(part - 1, ranges))
    return rgba


def _gamma(intensity: Floats) -> Float32s:
    """Raise to the power 0.8 and round to float32, exactly as scalar code would.

    numpy may compute pow with a vector instruction set whose last bit differs from the C
    library's. That matters only for results beside a float32 rounding boundary: those few are
    computed one by one.
    """
    power = np.power(intensity, _GAMMA)
    slack = _POW_ULPS * np.spacing(power)
    rounded: Float32s = power.astype(np.float32)
    doubtful = (power - slack).astype(np.float32) != (power + slack).astype(np.float32)
    for row in np.flatnonzero(doubtful):
        rounded[row] = math.pow(intensity[row], _GAMMA)
    return rounded


NEWTONS_PER_METRE: Final = 100.0
"""An arrow of one metre is this many newtons, unless the robot's file says otherwise."""
CLASSIC_FULL_SCALE: Final = 2.0
"""Arrow length (hundreds of newtons) at the red end of the colour map."""
FORCE_FULL_SCALE_BW: Final = 1.5
"""Body weights at the red end of the colour map in the `force` style."""
STRAIGHT_UP: Final = (0.0, -math.sqrt(0.5), 0.0, math.sqrt(0.5))
"""Turns the +x axis, along which arrows are drawn, to +z."""
CLASSIC_TILT: Final = (0.0, math.sin(-0.785), 0.0, math.cos(-0.785))
"""The live script's pitch of -1.57."""
LONGEST_M: Final = 2.0
"""m: longer arrows would hide the robot; colours have ended by then."""


LIFETIME_S: Final = 0.5
"""An arrow disappears after this silence of its sensor."""


class ArrowStyle(NamedTuple):
    """One way to show contact samples as arrows."""

    name: str
    needs_contact_states: bool = False
    """Arrows are made of the recorded contact states, not of contact samples."""
    along_force: bool = False
    """Arrows point along the force, coloured by body weights where the mass is known: link-frame
    forces are turned into the world frame, and contact normals are read for forces of which only
    the magnitude is known."""
    lifetime_s: float = LIFETIME_S
    """0: for ever."""
    shaft_diameter_m: float | None = None
    """None: the robot's."""


ARROW_STYLES: Final[Mapping[str, ArrowStyle]] = {
    "classic": ArrowStyle(
        "classic",
        needs_contact_states=True,
        lifetime_s=0.0,
        shaft_diameter_m=0.1,
    ),
    "pressure": ArrowStyle("pressure"),
    "force": ArrowStyle("force", along_force=True),
}
"""By name."""


class ArrowScale(NamedTuple):
    """How long arrows are, and how they are coloured."""

    newtons_per_metre: float = NEWTONS_PER_METRE
    full_scale_n: float = 100.0 * CLASSIC_FULL_SCALE
    """N at the red end of the colour map."""


def arrow_scale(
    given: float | None, weight_n: float | None, height_m: float, *, by_weight: bool
) -> ArrowScale:
    """Return the scale for a robot.

    Args:
        given: N per metre of the robot's file.
        weight_n: N, the robot's; None: not known.
        height_m: of the base over the feet: an arrow of one weight is as long.
        by_weight: whether a scale that is given is coloured by the weight, too.
    """
    if weight_n is None or not (given is None or by_weight):
        return ArrowScale(given or NEWTONS_PER_METRE)
    return ArrowScale(given or weight_n / height_m, FORCE_FULL_SCALE_BW * weight_n)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Arrows:
    """Arrows to draw or remove at the feet, one row a written message."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    visible: Flags
    """(n,) whether to draw this arrow; else the foot's arrow is removed and the rest of the row is
    unused."""
    position: Floats
    """(n, 3) m, tail of the arrow, world frame."""
    orientation: Floats
    """(n, 4) quaternion x, y, z, w that turns +x to the arrow's direction."""
    length: Floats
    """(n,) m."""
    colour: Float32s
    """(n, 4) red, green, blue, alpha in [0, 1]."""


def classic_arrows(contacts: Contacts) -> tuple[Arrows, Counter[str]]:
    """Compute the markers of `arrows_rviz.py`.

    Force and point are the first state's first, whatever step or body they belong to. Without
    contact nothing is written. What is not finite is copied. Where the script raised (a first
    state without contact points; a finite number whose square overflows) nothing is written either.

    Returns:
        arrows, and how many samples have none by ``no_position`` and ``overflow``.
    """
    message, state = np.unique(contacts.state_message, return_index=True)
    point_state, point = np.unique(contacts.point_state, return_index=True)
    has_point = np.isin(state, point_state)
    force = contacts.total_force[state]
    with np.errstate(over="ignore", invalid="ignore"):
        overflow = (np.isfinite(force) & ~np.isfinite(force * force)).any(axis=1)
    drawn = has_point & ~overflow
    message, state, force = message[drawn], state[drawn], force[drawn]
    length = norms(force) / 100.0
    with np.errstate(invalid="ignore"):
        wavelength = 380.0 + ((length - 0.0) / (CLASSIC_FULL_SCALE - 0.0)) * (750.0 - 380.0)
    log_time = contacts.log_time[message]
    arrows = Arrows(
        foot=contacts.foot[message],
        log_time=log_time,
        stamp=header_time(contacts.stamp[message], log_time),
        visible=np.ones(len(message), np.bool_),
        position=contacts.point[point[np.searchsorted(point_state, state)]],
        orientation=np.tile(np.array(CLASSIC_TILT), (len(message), 1)),
        length=length,
        colour=wavelength_to_rgba(wavelength),
    )
    skipped = {"no_position": (~has_point).sum(), "overflow": (has_point & overflow).sum()}
    return arrows, Counter({why: int(count) for why, count in skipped.items()})


def turn_x_to(direction: Floats) -> Floats:
    """Return the shortest rotation that turns the +x axis to each direction.

    Half-angle form of the rotation between two unit vectors, (1 + a.b, a x b) normalised, with
    1 + x taken as (y^2 + z^2) / (1 - x) where x is negative, to keep its digits.

    Args:
        direction: (n, 3) unit vectors.

    Returns:
        (n, 4) unit quaternions x, y, z, w; half a turn about z for -x itself.
    """
    x, y, z = direction.T
    with np.errstate(invalid="ignore", divide="ignore"):
        w = np.where(x < 0.0, (y * y + z * z) / (1.0 - x), 1.0 + x)
        length = np.hypot(w, np.hypot(y, z))
        turns = np.stack([np.zeros_like(x), -z, y, w], axis=1)
        quaternion: Floats = turns / length[:, None]
    quaternion[length == 0.0] = (0.0, 0.0, 1.0, 0.0)
    return quaternion


def _along_force(samples: Samples, magnitude: Floats) -> tuple[Floats, Flags]:
    """Return orientations along the ground-reaction force, and which are known where there is one.

    Where forces are not in the world frame, only the magnitude, (n,) N, is known, and it is drawn
    along the mean contact normal.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        unit = samples.force / magnitude[:, None]
    direction = np.where(samples.in_world[:, None], unit, samples.normal)
    has_force = (magnitude > 0.0) & np.isfinite(magnitude)
    return turn_x_to(direction), all_finite(direction) | ~has_force


def sample_arrows(
    samples: Samples, scale: ArrowScale, *, along_force: bool
) -> tuple[Arrows, Counter[str]]:
    """Compute arrows from the mean contact point, as long as the force is large.

    No arrow is longer than `LONGEST_M`. A sample whose arrow cannot be drawn removes its foot's.

    Args:
        samples: of a foot.
        scale: of their lengths and colours.
        along_force: whether they point along the force; else straight up.

    Returns:
        arrows, and how many samples in contact have none, by ``not_finite``, ``no_position`` and
        ``no_direction``.
    """
    magnitude, count = norms(samples.force), len(samples.log_time)
    orientation, has_direction = np.tile(STRAIGHT_UP, (count, 1)), np.ones(count, np.bool_)
    if along_force:
        orientation, has_direction = _along_force(samples, magnitude)
    length = magnitude / scale.newtons_per_metre
    with np.errstate(invalid="ignore"):
        load = magnitude / scale.full_scale_n
        wavelength = SHORTEST_NM + load * (LONGEST_NM - SHORTEST_NM)
    has_position = samples.points > 0
    finite = np.isfinite(length) & (all_finite(samples.position) | ~has_position)
    needs = {"not_finite": finite, "no_position": has_position, "no_direction": has_direction}
    drawn, skipped = samples.in_contact, Counter[str]()
    for why, holds in needs.items():
        skipped[why] = int((drawn & ~holds).sum())
        drawn = drawn & holds
    visible = drawn & (length > 0.0)
    colour = np.zeros((len(visible), 4), np.float32)
    colour[visible] = wavelength_to_rgba(np.clip(wavelength[visible], SHORTEST_NM, LONGEST_NM))
    arrows = Arrows(
        foot=samples.foot,
        log_time=samples.log_time,
        stamp=samples.time,
        visible=visible,
        position=samples.position,
        orientation=orientation,
        length=np.minimum(length, LONGEST_M),
        colour=colour,
    )
    return arrows, skipped
