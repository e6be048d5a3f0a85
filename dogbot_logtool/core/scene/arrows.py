"""The arrow at a foot for each contact sample; `styles.py` lists the styles.

``classic``   the markers of the live script `arrows_rviz.py`, bit for bit;
``pressure``  the same picture corrected: newest physics step, all states, straight up;
``force``     ground-reaction forces, along the force, coloured by body weights.
"""

import math
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Float32s,
    Floats,
    Ints,
    all_finite,
    header_time,
    norms,
)
from dogbot_logtool.core.contact.contacts import Contacts, Samples
from dogbot_logtool.core.scene.colour import LONGEST_NM, SHORTEST_NM, wavelength_to_rgba
from dogbot_logtool.dataclass import dataclass

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
_NEGLIGIBLE: Final = 1e-100
"""Part of a unit vector that cannot matter, but whose square is no longer a number."""


@dataclass(frozen=True, slots=True)
class ArrowScale:
    """How long arrows are, and how they are coloured."""

    newtons_per_metre: float = NEWTONS_PER_METRE
    full_scale_n: float = 100.0 * CLASSIC_FULL_SCALE
    """N at the red end of the colour map."""


@dataclass(frozen=True, slots=True)
class ArrowInput:
    """Samples that a style computes arrows of."""

    samples: Samples
    """In the world frame as far as the log's frames are known, with swings added for sensors that
    are silent in swing."""
    contacts: Contacts | None
    """The contact states of the same messages; None: their type has none."""
    force_in_world: bool
    """Whether all forces are in the world frame."""
    body_weight_n: float | None
    scale: ArrowScale


@dataclass(frozen=True, slots=True)
class Arrows:
    """Arrows to draw or remove at the feet, one row a written message."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    shown: Flags
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


@dataclass(frozen=True, slots=True)
class ArrowCounts:
    """Samples that could not become an arrow, by reason."""

    not_finite: int = 0
    """A number that the arrow needs is NaN or infinite: its foot's arrow is removed."""
    no_position: int = 0
    """In contact, but the message gives no contact point."""
    no_direction: int = 0
    """Only the magnitude is known and the message gives no contact normal."""
    overflow: int = 0
    """`classic`: a finite force component whose square overflows (the live script raised)."""

    def __add__(self, other: "ArrowCounts") -> "ArrowCounts":
        return ArrowCounts(
            self.not_finite + other.not_finite,
            self.no_position + other.no_position,
            self.no_direction + other.no_direction,
            self.overflow + other.overflow,
        )


def no_arrows() -> Arrows:
    """Return no arrows, for messages that lack what an arrow needs."""
    none = np.empty(0, np.int64)
    return Arrows(
        foot=none,
        log_time=none,
        stamp=none,
        shown=np.empty(0, np.bool_),
        position=np.empty((0, 3)),
        orientation=np.empty((0, 4)),
        length=np.empty(0),
        colour=np.empty((0, 4), np.float32),
    )


def removals(samples: Samples) -> Arrows:
    """Return the removal of the arrows of samples without contact."""
    count = len(samples.log_time)
    unused = np.empty((0, 4))
    return Arrows(
        foot=samples.foot,
        log_time=samples.log_time,
        stamp=samples.time,
        shown=np.zeros(count, np.bool_),
        position=unused,
        orientation=unused,
        length=unused[:, 0],
        colour=unused.astype(np.float32),
    )


def classic_arrows(contacts: Contacts) -> tuple[Arrows, ArrowCounts]:
    """Compute the markers of `arrows_rviz.py`.

    Force and point are the first state's first, whatever step or body they belong to. Without
    contact nothing is written. What is not finite is copied. Where the script raised (a first
    state without contact points; a square that overflows) nothing is written either.
    """
    message, force, position, has_point = _first_states(contacts)
    with np.errstate(over="ignore", invalid="ignore"):
        overflow = (np.isfinite(force) & ~np.isfinite(force * force)).any(axis=1)
    drawn = has_point & ~overflow
    message, force, position = message[drawn], force[drawn], position[drawn]

    length = norms(force) / 100.0
    with np.errstate(invalid="ignore"):
        wavelength = 380.0 + ((length - 0.0) / (CLASSIC_FULL_SCALE - 0.0)) * (750.0 - 380.0)
    count = len(message)
    arrows = Arrows(
        foot=contacts.foot[message],
        log_time=contacts.log_time[message],
        stamp=header_time(contacts.stamp[message], contacts.log_time[message]),
        shown=np.ones(count, np.bool_),
        position=position,
        orientation=np.tile(np.array(CLASSIC_TILT), (count, 1)),
        length=length,
        colour=wavelength_to_rgba(wavelength),
    )
    skipped = ArrowCounts(
        no_position=int((~has_point).sum()), overflow=int((has_point & overflow).sum())
    )
    return arrows, skipped


def _first_states(contacts: Contacts) -> tuple[Ints, Floats, Floats, Flags]:
    """Return the first state of every message that has one.

    Returns:
        message row (m,), its total force (m, 3), its first point (m, 3), whether it has one (m,).
    """
    message, state = np.unique(contacts.state_message, return_index=True)
    states = len(contacts.state_message)
    first_point = np.full((states, 3), np.nan)
    has_point = np.zeros(states, np.bool_)
    point_state, row = np.unique(contacts.point_state, return_index=True)
    first_point[point_state] = contacts.point[row]
    has_point[point_state] = True
    return message, contacts.total_force[state], first_point[state], has_point[state]


def arrow_scale(given: float | None, weight_n: float | None, height_m: float) -> ArrowScale:
    """Return the scale for a robot.

    Args:
        given: N per metre of the robot's file; colours are then those of the live script.
        weight_n: N, the robot's; None: not known.
        height_m: of the base over the feet: an arrow of one weight is as long.
    """
    if given is not None:
        return ArrowScale(given)
    if weight_n is None:
        return ArrowScale()
    return ArrowScale(weight_n / height_m, FORCE_FULL_SCALE_BW * weight_n)


def pressure_arrows(
    samples: Samples, scale: ArrowScale = ArrowScale()
) -> tuple[Arrows, ArrowCounts]:
    """Compute arrows straight up from the mean contact point, as long as the force is large.

    No arrow is longer than `LONGEST_M`; so it is with `force_arrows`.
    """
    magnitude = norms(samples.force)
    orientation = np.tile(np.array(STRAIGHT_UP), (len(magnitude), 1))
    colour = _clamped_colour(magnitude / scale.full_scale_n)
    known = np.ones(len(magnitude), np.bool_)
    return _arrows(samples, magnitude / scale.newtons_per_metre, orientation, known, colour)


def force_arrows(
    samples: Samples,
    *,
    force_in_world: bool,
    body_weight_n: float | None,
    scale: ArrowScale = ArrowScale(),
) -> tuple[Arrows, ArrowCounts]:
    """Compute arrows along the ground-reaction force from the mean contact point.

    Args:
        samples: contact samples.
        force_in_world: whether the wrenches are in the world frame. Where they are not, only the
            magnitude is known, and it is drawn along the mean contact normal.
        body_weight_n: N; None colours by the scale of `pressure`.
        scale: of the arrows.
    """
    magnitude = norms(samples.force)
    known = samples.in_world | force_in_world
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        along_force = samples.force / magnitude[:, None]
    direction = np.where(known[:, None], along_force, samples.normal)
    loaded = magnitude > 0.0
    has_direction = all_finite(direction) | ~loaded | ~np.isfinite(magnitude)
    full_scale = scale.full_scale_n
    if body_weight_n is not None:
        full_scale = FORCE_FULL_SCALE_BW * body_weight_n
    return _arrows(
        samples,
        magnitude / scale.newtons_per_metre,
        turn_x_to(direction),
        has_direction,
        _clamped_colour(magnitude / full_scale),
    )


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
        quaternion = np.stack([np.zeros_like(x), -z, y, w], axis=1)
        quaternion /= np.sqrt((quaternion * quaternion).sum(axis=1))[:, None]
    # So near to -x the squares above vanish.
    opposite = (x < 0.0) & (np.abs(y) < _NEGLIGIBLE) & (np.abs(z) < _NEGLIGIBLE)
    quaternion[opposite] = (0.0, 0.0, 1.0, 0.0)
    return quaternion


def _clamped_colour(share: Floats) -> Float32s:
    """Map [0, 1] to the range of visible light, clamped at its ends; (n, 4)."""
    with np.errstate(invalid="ignore"):
        wavelength = SHORTEST_NM + share * (LONGEST_NM - SHORTEST_NM)
    return wavelength_to_rgba(np.clip(wavelength, SHORTEST_NM, LONGEST_NM))


def _arrows(
    samples: Samples, length: Floats, orientation: Floats, has_direction: Flags, colour: Float32s
) -> tuple[Arrows, ArrowCounts]:
    """Return the arrows that can be drawn; every other sample removes its foot's arrow."""
    touching = samples.in_contact
    has_position = samples.points > 0
    finite = np.isfinite(length) & (all_finite(samples.position) | ~has_position)
    shown = touching & finite & has_position & has_direction & (length > 0.0)
    counts = ArrowCounts(
        not_finite=int((touching & ~finite).sum()),
        no_position=int((touching & finite & ~has_position).sum()),
        no_direction=int((touching & finite & has_position & ~has_direction).sum()),
    )
    arrows = Arrows(
        foot=samples.foot,
        log_time=samples.log_time,
        stamp=samples.time,
        shown=shown,
        position=samples.position,
        orientation=orientation,
        length=np.minimum(length, LONGEST_M),
        colour=colour,
    )
    return arrows, counts
