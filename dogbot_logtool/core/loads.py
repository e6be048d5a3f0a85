"""How the load is shared, whether it adds up to the weight, and what faults of sensors do to it."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Integral, Ints, integral
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.sensor import varies
from dogbot_logtool.core.settings import LegPosition, WalkSettings

NEAR_ZERO: Final = 1e-9
WEIGHT_TOLERANCE: Final = 0.05
"""By how much the vertical impulse may miss the weight before figures of direction are left out."""
REFUTED: Final = 0.20
"""By how much the feet's vertical force may miss the weight before nothing rests on the weight."""
FALLS_SHORT: Final = 0.1
"""The same of the sum of |F|, which is never below the weight; what is estimated of sensors without
load may leave some per cent."""
NOT_THE_WEIGHT: Final = 0.5
"""Share of the weight below which the feet's vertical force is none: no mass is so far off. Above
its inverse, and below it, the sum of |F| is in other units."""
LEANS: Final = 0.006
"""Share by which the sum of |F| exceeds that of vertical forces, from which these lean so much (6
degrees) that those of legs that swing, in their links' frames, could look alike."""
ENOUGH: Final = 0.99
"""Share of the loaded time in which the vertical force must be known for totals to be given."""
CARRIED: Final = 0.05
"""By how much the impulse of the other feet may miss the weight when one is lifted."""


class WalkLoads(NamedTuple):
    """Loads of all feet over one and the same time."""

    over_strides: bool
    """Whether that time is whole strides in which all feet are known; else it is all time known to
    all feet."""
    complete: bool
    """Whether every foot is seen to touch: else load may be missing from the sum."""
    mean_vertical_n: float | None
    """N, mean of the feet's summed vertical force over that time; None where it is not known."""
    mean_magnitude_n: float | None
    """N, mean of the feet's summed |F|; None where not all tell forces, or there is no time."""
    body_weight_n: float | None
    """N, from the mass; None: not known."""
    mass_is_assumed: bool
    """Whether the mass is that of a robot that was only guessed."""
    share_of: str | None
    """The quantity that is shared: ``vertical_impulse``, or ``force_impulse`` (the integral of |F|)
    where the direction of the force is not known."""
    shares: tuple[float, ...] | None
    """(feet) share of each foot; they add up to 1."""

    @property
    def vertical_impulse_over_weight(self) -> float | None:
        """Sum over feet of the vertical impulse / (m g x time): 1 for a sound recording."""
        if self.mean_vertical_n is None or self.body_weight_n is None:
            return None
        return self.mean_vertical_n / self.body_weight_n

    @property
    def magnitude_over_weight(self) -> float | None:
        """Mean of the feet's summed |F| over m g, where only that is known, over whole strides.

        Hardly below 1, and little above it. None where vertical forces are known, or a foot's is
        missing.
        """
        return self._size_over_weight if self.mean_vertical_n is None else None

    @property
    def _size_over_weight(self) -> float | None:
        comparable = self.complete and self.over_strides and self.body_weight_n
        if not comparable or not self.body_weight_n or self.mean_magnitude_n is None:
            return None
        return self.mean_magnitude_n / self.body_weight_n

    @property
    def refuted(self) -> tuple[str, ...]:
        """What forces that miss the weight refute, as the cases of the finding that says so.

        ``direction``: the ratio misses 1; but the load on a foot that is never seen to touch may be
        missing. ``shares``: likewise, or the sum of |F| is below the weight, or far above it.
        ``vertical``: the feet's vertical force is so far below the weight that it is another one.
        ``weight``: the mass is wrong, so that nothing rests on it; ``assumed``: that of a guessed
        robot. ``units``: the sum of |F| is so far from the weight that forces are not in N.
        """
        ratio, magnitude = self.vertical_impulse_over_weight, self.magnitude_over_weight
        size = self._size_over_weight
        tolerance = REFUTED if self.mass_is_assumed else WEIGHT_TOLERANCE
        off = abs(ratio - 1.0) if ratio is not None and (self.complete or ratio > 1.0) else 0.0
        least = 1.0 - max(tolerance, FALLS_SHORT)
        misses = magnitude is not None and not least <= magnitude <= 1.0 + REFUTED
        weight = off > REFUTED or (magnitude is not None and abs(magnitude - 1.0) > REFUTED)
        units = size is not None and not NOT_THE_WEIGHT <= size <= 1.0 / NOT_THE_WEIGHT
        is_little = off > tolerance and (ratio or 0.0) < NOT_THE_WEIGHT
        downwards = ratio is None and (self.mean_vertical_n or 0.0) < 0.0
        cases = {
            "direction": off > tolerance,
            "shares": off > tolerance or misses,
            "vertical": is_little or downwards or units,
            "weight": weight,
            "assumed": weight and self.mass_is_assumed,
            "units": units,
        }
        return tuple(case for case, holds in cases.items() if holds)

    @property
    def weight_n(self) -> float | None:
        """N, the weight for forces in body weights: from the mass, else from whole strides.

        None where neither is known, or where all feet's forces miss the weight by over `REFUTED`.
        """
        if self.body_weight_n is not None:
            return None if "weight" in self.refuted else self.body_weight_n
        estimated = self.mean_vertical_n if self.over_strides and self.complete else None
        return estimated if estimated is not None and estimated > NEAR_ZERO else None

    @property
    def weight_source(self) -> str | None:
        """The origin of that weight, ``mass`` or ``estimated``."""
        if self.weight_n is None:
            return None
        return "estimated" if self.body_weight_n is None else "mass"

    @property
    def may_be_tilted(self) -> bool:
        """Whether the forces lean, and the weight does not tell that their vertical is one."""
        vertical, magnitude = self.mean_vertical_n, self.mean_magnitude_n
        if not vertical or magnitude is None or magnitude <= (1.0 + LEANS) * vertical:
            return False
        ratio = self.vertical_impulse_over_weight
        if ratio is None or self.weight_source != "mass":
            return True
        return abs(magnitude / vertical * ratio - 1.0) < abs(ratio - 1.0)


def vertical_is_known(foot: FootHistory) -> bool:
    """Tell whether the vertical force is known for as good as all of the time under load."""
    if not foot.has_force:
        return False
    loaded = timespans.total(foot.in_contact)
    unknown = timespans.intersect([foot.in_contact, foot.track.vertical_unknown])
    return loaded > 0 and timespans.total(unknown) <= (1.0 - ENOUGH) * loaded


def fore_aft_ns(foot: FootHistory, heading: Floats) -> Floats:
    """Integrate the braking and the propulsive part of the force over each stance.

    Each sample counts by its own sign.

    Args:
        foot: its history.
        heading: (stances,) rad, of the robot's forward axis in the middle of each stance.

    Returns:
        (2, stances) N s, at least 0, what slows the robot, and what drives it forward; NaN where
        direction or heading is not known, or the force has lone spikes.
    """
    track, stances = foot.track, foot.stances
    impulses = np.full((2, len(heading)), np.nan)
    known = np.isfinite(heading) & np.isfinite(stances.figures.mean_vertical_force_n)
    # A spike may be as large as all that brakes.
    spikes = track.time[foot.spikes]
    known &= np.searchsorted(spikes, stances.touchdown) == np.searchsorted(spikes, stances.liftoff)
    if not known.any():
        return impulses
    before = np.maximum(np.searchsorted(track.time, stances.touchdown[known]) - 1, 0)
    # A foot that stopped to speak in a stance has no sample at its end.
    behind = np.searchsorted(track.time, stances.liftoff[known]).clip(max=len(track.time) - 1)
    begin, end = track.time[before], track.time[behind]
    stance = np.maximum(np.searchsorted(begin, track.time, side="right") - 1, 0)
    x, y = np.nan_to_num(track.horizontal_force).T
    along = x * np.cos(heading[known])[stance] + y * np.sin(heading[known])[stance]
    parts = np.stack([np.maximum(-along, 0.0), np.maximum(along, 0.0)], axis=1)
    impulses[:, known] = integral(track.time, parts).added(begin, end).T
    return impulses


def vertical_impulse_ns(foot: FootHistory, within: Ints) -> float | None:
    """Return the integral of a foot's vertical force over the time known, N s.

    Trapezoid over real sample times, gaps left out. None where the direction of the force is not
    known, or nothing is known at all.

    Args:
        foot: its history.
        within: (w, 2) ns, a part of the log.
    """
    if timespans.total(foot.known) == 0 or not foot.has_force:
        return None
    if timespans.total(foot.in_contact) and not vertical_is_known(foot):
        return None
    spans = timespans.intersect([foot.vertical_known, within])
    return float(foot.track.vertical_impulse.within(spans)[0])


def whole_strides(strides: Ints, feet: Sequence[FootHistory], *, vertical: bool) -> Ints:
    """Return the time of the strides during which every foot is known throughout.

    Args:
        strides: (s, 2) ns, each from a touchdown of one foot to its next.
        feet: histories of all feet.
        vertical: whether the vertical force must be known, too.

    Returns:
        (n, 2) ns, neighbouring strides joined.
    """
    known = _known_to_all(feet, vertical=vertical)
    unknown = timespans.subtract(timespans.merge(strides), known)
    broken = timespans.touches(unknown, strides[:, 0] + 1, strides[:, 1] - 1)
    return timespans.merge(strides[~broken])


def loads_of(
    feet: Sequence[FootHistory],
    settings: WalkSettings,
    strides: Ints,
    within: Ints = timespans.ALWAYS,
) -> WalkLoads:
    """Compare the feet's impulses with each other and with the weight.

    All feet are measured over the same time: whole strides of one foot during which all feet are
    known. A part of a stride would count one foot's stance and another's swing, and a foot whose
    sensor was silent for a while would seem to carry less.

    Args:
        feet: histories of all feet.
        settings: with the mass, and whether the robot has other feet, too.
        strides: (s, 2) ns, strides of one foot; without any, all known time counts, and of feet
            that step there are no shares.
        within: (w, 2) ns, a segment; its strides are given.
    """
    loaded = [foot for foot in feet if len(foot.in_contact)]
    vertical = bool(loaded) and all(vertical_is_known(foot) for foot in loaded)
    spans = whole_strides(strides, feet, vertical=vertical)
    over_strides = len(spans) > 0
    if not over_strides:
        spans = timespans.intersect([_known_to_all(feet, vertical=vertical), within])
    seconds = timespans.total(spans) / 1e9
    tracks = [foot.track for foot in feet]
    magnitude = [float(track.force_impulse.within(spans)[0]) for track in tracks]
    upward = [float(track.vertical_impulse.within(spans)[0]) for track in tracks]
    has_forces = all(foot.has_force for foot in feet)
    shared = upward if vertical else magnitude
    # A part of a stride counts one foot's stance and another's swing.
    in_part = not over_strides and any(len(foot.stances.touchdown) > 1 for foot in feet)
    shares = abs(sum(shared)) >= NEAR_ZERO and has_forces
    return WalkLoads(
        over_strides=over_strides,
        complete=len(loaded) == len(feet) and not settings.lacks_feet,
        mean_vertical_n=sum(upward) / seconds if vertical and seconds else None,
        mean_magnitude_n=sum(magnitude) / seconds if (vertical or has_forces) and seconds else None,
        body_weight_n=settings.body_weight_n,
        mass_is_assumed=settings.mass_is_assumed,
        share_of=("vertical_impulse" if vertical else "force_impulse") if shares else None,
        shares=tuple(each / sum(shared) for each in shared)
        if shares and not (in_part or settings.lacks_feet)
        else None,
    )


def _known_to_all(feet: Sequence[FootHistory], *, vertical: bool) -> Ints:
    return timespans.intersect([foot.vertical_known if vertical else foot.known for foot in feet])


def share_of(
    word: str, shares: Sequence[float], positions: Sequence[LegPosition | None]
) -> float | None:
    """Add up the shares of feet at an end or a side; None where positions are not known."""
    if any(position is None for position in positions):
        return None
    pairs = zip(shares, positions, strict=True)
    return sum(share for share, position in pairs if word in (position or ()))


def symmetry_index_percent(left: float | None, right: float | None) -> float | None:
    """Return 100 (R - L) / ((R + L) / 2), percent: 0 for equal sides, positive if right is more.

    Source: Robinson, Herzog and Nigg 1987, J. Manipulative Physiol. Ther. 10:172.
    None where a side is not known or the denominator is near 0.
    """
    if left is None or right is None or abs(right + left) < 2.0 * NEAR_ZERO:
        return None
    return 100.0 * (right - left) / ((right + left) / 2.0)


def dead_feet(feet: Sequence[FootHistory], loads: WalkLoads) -> tuple[bool, ...]:
    """Tell which feet have a sensor that seems dead: one that never reports a contact.

    A foot may also be lifted throughout. That is believed where the other feet are seen to carry
    the whole weight; otherwise nothing is known about the foot.
    """
    ratio = loads.vertical_impulse_over_weight
    carried = ratio is not None and abs(ratio - 1.0) <= CARRIED
    return tuple(
        foot.start is not None and not len(foot.in_contact) and not carried for foot in feet
    )


def is_stuck(foot: FootHistory, feet: Sequence[FootHistory]) -> bool:
    """Tell whether a sensor shows one constant value under load while those of other feet vary.

    Where no force varies the robot stands still, in a simulator without noise.
    """
    return foot.is_constant and any(
        not each.is_constant and varies(each.track.force[each.down]) for each in feet
    )


CELL_RATE_HZ: Final = 25.0
"""Forces are compared with other sensors by their means over so many cells a second."""


def mean_impulses(feet: Sequence[FootHistory], impulse: str, time: Ints, half_ns: int) -> Floats:
    """(m, feet) N, means over a window about each time.

    Args:
        feet: histories of all feet.
        impulse: ``vertical_impulse`` or ``force_impulse`` of their tracks.
        time: (m,) ns.
        half_ns: half of the window.
    """
    totals: list[Integral] = [getattr(foot.track, impulse) for foot in feet]
    return np.concatenate([each.mean(time, 2 * half_ns) for each in totals], axis=1)


LARGEST_FOOT_M: Final = 0.3
"""m: the contact point of no foot that stays in place travels further in a stance."""


def slip_m(contact_travel_m: Floats, rolling_m: float | None) -> Floats:
    """Return how far a foot slips in each stance, m.

    A round foot that rolls, or a flat one on which the pressure moves, moves its contact point
    without slipping. Where that way is not known, neither is the slip.

    Args:
        contact_travel_m: (n,) m, way of the contact point; NaN where there is none.
        rolling_m: m, way of the contact point of a foot that does not slip; None: not known.
    """
    slip: Floats = np.maximum(contact_travel_m - (np.nan if rolling_m is None else rolling_m), 0.0)
    return slip
