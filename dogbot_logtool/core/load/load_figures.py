"""How the load is shared, and whether it adds up to the robot's weight."""

from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Final

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.dataclass import dataclass

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
CLEARLY: Final = 0.002
"""Share of the weight by which the vertical sum must be nearer to it than that of |F|: only so
the vertical is one."""
ENOUGH: Final = 0.99
"""Share of the loaded time in which the vertical force must be known for totals to be given."""
CARRIED: Final = 0.05
"""By how much the impulse of the other feet may miss the weight when one is lifted."""
STUCK: Final = 0.99
"""Share of neighbouring loaded samples that are equal in a sensor that is stuck."""
STUCK_SAMPLES: Final = 40


class WeightSource(StrEnum):
    """The origin of the weight that forces are compared with."""

    MASS = "mass"
    ESTIMATED = "estimated"


@dataclass(frozen=True, slots=True)
class LoadFigures:
    """Loads of all feet over one and the same time."""

    known_s: float
    """s, the time that the figures are over: whole strides in which all feet are known, or all
    time known to all feet where there are no such strides."""
    over_strides: bool
    """Whether that time is whole strides."""
    mean_vertical_n: float | None
    """N, mean of the feet's summed vertical force over that time; None where it is not known."""
    vertical_impulse_over_weight: float | None
    """Sum over feet of the vertical impulse / (m g x time): 1 for a sound recording. None without
    a mass, or with an assumed one that the forces refute."""
    weight_n: float | None
    """N, the weight for figures in body weights: from the mass, else estimated from whole strides;
    None where neither is known, or where all feet's forces miss the weight by over `REFUTED`."""
    weight_source: WeightSource | None
    share_of: str | None
    """The quantity that is shared: ``vertical_impulse``, or ``force_impulse`` (the integral of |F|)
    where the direction of the force is not known."""
    shares: tuple[float, ...] | None
    """(feet) share of each foot; they add up to 1. None also where the sum misses the weight: a
    sensor of one foot may be why."""
    magnitude_over_weight: float | None = None
    """Mean of the feet's summed |F| over m g, where only that is known, over whole strides: hardly
    below 1, and little above it. None where vertical forces are known, or a foot's is missing."""
    direction_refuted: bool = False
    """Whether it misses 1 by so much that the direction of the forces is doubtful: by
    `WEIGHT_TOLERANCE`, or by `REFUTED` where the mass is only assumed. The load on a foot that is
    never seen to touch may be missing instead."""
    weight_refuted: bool = False
    """Whether it misses 1 by over `REFUTED`, so that the weight itself is doubtful."""
    magnitude_misses_weight: bool = False
    """Whether the sum of |F| is below the weight, or far above it: a wrong mass or sensor."""
    other_units: bool = False
    """Whether the sum of |F| is so far from the weight that forces are not in N of this robot."""

    @property
    def vertical_refuted(self) -> bool:
        """Whether the feet's vertical force is so far below the weight that it is another one."""
        if self.vertical_impulse_over_weight is None:
            return self.mean_vertical_n is not None and self.mean_vertical_n < 0.0
        return self.direction_refuted and self.vertical_impulse_over_weight < NOT_THE_WEIGHT

    mean_magnitude_n: float | None = None
    """N, mean of the feet's summed |F|; None where vertical forces are not known."""

    @property
    def may_be_tilted(self) -> bool:
        """Whether the forces lean, and the weight does not tell that their vertical is one."""
        vertical, magnitude = self.mean_vertical_n, self.mean_magnitude_n
        if not vertical or magnitude is None or magnitude <= (1.0 + LEANS) * vertical:
            return False
        if self.vertical_impulse_over_weight is None or self.weight_source is not WeightSource.MASS:
            return True
        magnitude_misses = abs(magnitude / vertical * self.vertical_impulse_over_weight - 1.0)
        return magnitude_misses < abs(self.vertical_impulse_over_weight - 1.0) + CLEARLY

    @property
    def misses_weight(self) -> bool:
        """Whether the feet's vertical impulse is not the weight: a wrong frame, sensor or mass."""
        ratio = self.vertical_impulse_over_weight
        return ratio is not None and abs(ratio - 1.0) > WEIGHT_TOLERANCE


def vertical_is_known(foot: FootHistory) -> bool:
    """Tell whether the vertical force is known for as good as all of the time under load."""
    if not foot.has_force:
        return False
    loaded = timespans.total(foot.in_contact)
    unknown = timespans.intersect([foot.in_contact, foot.track.vertical_unknown])
    return loaded > 0 and timespans.total(unknown) <= (1.0 - ENOUGH) * loaded


def vertical_impulse_ns(foot: FootHistory, within: Ints | None = None) -> float | None:
    """Return the integral of a foot's vertical force over the time known, N s.

    Trapezoid over real sample times, gaps left out. None where the direction of the force is not
    known, or nothing is known at all.

    Args:
        foot: its history.
        within: (w, 2) ns, a part of the log; None: all of it.
    """
    if timespans.total(foot.known) == 0 or not foot.has_force:
        return None
    if timespans.total(foot.in_contact) and not vertical_is_known(foot):
        return None
    known = foot.vertical_known
    return foot.track.vertical_within(
        known if within is None else timespans.intersect([known, within])
    )


def whole_strides(strides: Ints, feet: Sequence[FootHistory], *, vertical: bool) -> Ints:
    """Return the time of the strides during which every foot is known throughout.

    Args:
        strides: (s, 2) ns, each from a touchdown of one foot to its next.
        feet: histories of all feet.
        vertical: whether the vertical force must be known, too.

    Returns:
        (n, 2) ns, neighbouring strides joined.
    """
    if len(strides) == 0:
        return timespans.no_spans()
    known = _known_to_all(feet, vertical=vertical)
    unknown = timespans.subtract(timespans.merge(strides), known)
    broken = timespans.touches(unknown, strides[:, 0] + 1, strides[:, 1] - 1)
    return timespans.merge(strides[~broken])


def mean_vertical_n(feet: Sequence[FootHistory], spans: Ints) -> float | None:
    """Return the mean of the feet's summed vertical force, N: over whole strides, the weight.

    Args:
        feet: histories of all feet.
        spans: (n, 2) ns, time in which all of them are known.

    Returns:
        None where the vertical force of a loaded foot is not known, or there is no time.
    """
    duration_s = timespans.total(spans) / 1e9
    if duration_s == 0.0 or not _vertical_of_all(feet):
        return None
    return sum(foot.track.vertical_within(spans) for foot in feet) / duration_s


def _mean_magnitude_n(feet: Sequence[FootHistory], spans: Ints) -> float:
    """Return the mean of the feet's summed |F| over some time, N."""
    return sum(foot.track.force_within(spans) for foot in feet) / (timespans.total(spans) / 1e9)


def load_figures(
    feet: Sequence[FootHistory],
    body_weight_n: float | None,
    strides: Ints | None = None,
    within: Ints | None = None,
    *,
    mass_is_assumed: bool = False,
) -> LoadFigures:
    """Compare the feet's impulses with each other and with the weight.

    All feet are measured over the same time: whole strides of one foot during which all feet are
    known. A part of a stride would count one foot's stance and another's swing, and a foot whose
    sensor was silent for a while would seem to carry less.

    Args:
        feet: histories of all feet.
        body_weight_n: N, from the robot's mass; None: not known.
        strides: (s, 2) ns, strides of one foot; without any, all known time counts, and of feet
            that step there are no shares.
        within: (w, 2) ns, a segment; its strides are given. None: the whole log.
        mass_is_assumed: whether the weight is that of a robot that was only guessed.
    """
    vertical = _vertical_of_all(feet)
    strides = timespans.no_spans() if strides is None else strides
    spans = whole_strides(strides, feet, vertical=vertical)
    over_strides = len(spans) > 0
    if not over_strides:
        spans = _known_to_all(feet, vertical=vertical)
        spans = spans if within is None else timespans.intersect([spans, within])
    mean_n = mean_vertical_n(feet, spans)
    ratio = None if mean_n is None or body_weight_n is None else mean_n / body_weight_n
    # The load on a foot that is never seen to touch may be missing from the sum.
    complete = all(len(foot.in_contact) for foot in feet)
    refuted = ratio is not None and (ratio > 1.0 + REFUTED or (ratio < 1.0 - REFUTED and complete))
    estimated_n = mean_n if over_strides and complete else None
    magnitude = None
    mean_magnitude = _mean_magnitude_n(feet, spans) if mean_n is not None else None
    has_forces = all(foot.has_force for foot in feet)
    if body_weight_n and over_strides and complete and has_forces and not vertical:
        magnitude = _mean_magnitude_n(feet, spans) / body_weight_n
        refuted = abs(magnitude - 1.0) > REFUTED
    weight_n, source = _trusted_weight(body_weight_n, estimated_n, refuted=refuted)
    tolerance = REFUTED if mass_is_assumed else WEIGHT_TOLERANCE
    direction_refuted = ratio is not None and (complete or ratio > 1.0)
    direction_refuted &= abs((ratio or 1.0) - 1.0) > tolerance
    falls_short = magnitude is not None and magnitude < 1.0 - max(tolerance, FALLS_SHORT)
    magnitude_misses = falls_short or (magnitude is not None and magnitude > 1.0 + REFUTED)
    share_of, shares = _shares(feet, spans, vertical=vertical)
    # A part of a stride counts one foot's stance and another's swing.
    in_part = not over_strides and any(len(foot.stances.touchdown) > 1 for foot in feet)
    if in_part:
        shares = None
    return LoadFigures(
        known_s=timespans.total(spans) / 1e9,
        over_strides=over_strides,
        mean_vertical_n=mean_n,
        vertical_impulse_over_weight=ratio,
        weight_n=weight_n,
        weight_source=source,
        share_of=share_of,
        shares=shares,
        magnitude_over_weight=magnitude,
        mean_magnitude_n=mean_magnitude,
        direction_refuted=direction_refuted,
        weight_refuted=refuted,
        magnitude_misses_weight=magnitude_misses,
        other_units=complete
        and over_strides
        and _is_no_weight(magnitude, mean_magnitude, body_weight_n),
    )


def _is_no_weight(
    magnitude: float | None, mean_magnitude_n: float | None, weight_n: float | None
) -> bool:
    """Tell whether the feet's summed |F|, over the weight or in N, is that of no such mass."""
    if magnitude is None and mean_magnitude_n is not None and weight_n:
        magnitude = mean_magnitude_n / weight_n
    return magnitude is not None and not NOT_THE_WEIGHT <= magnitude <= 1.0 / NOT_THE_WEIGHT


def _vertical_of_all(feet: Sequence[FootHistory]) -> bool:
    """Tell whether some foot is loaded, and the vertical force of every loaded one is known."""
    loaded = [foot for foot in feet if len(foot.in_contact)]
    return bool(loaded) and all(vertical_is_known(foot) for foot in loaded)


def _known_to_all(feet: Sequence[FootHistory], *, vertical: bool) -> Ints:
    return timespans.intersect([foot.vertical_known if vertical else foot.known for foot in feet])


def _trusted_weight(
    body_weight_n: float | None, estimated_n: float | None, *, refuted: bool
) -> tuple[float | None, WeightSource | None]:
    """Return the weight that figures in body weights may rest on, and its source."""
    if body_weight_n is None:
        usable = estimated_n is not None and estimated_n > NEAR_ZERO
        return (estimated_n, WeightSource.ESTIMATED) if usable else (None, None)
    return (None, None) if refuted else (body_weight_n, WeightSource.MASS)


def _shares(
    feet: Sequence[FootHistory], spans: Ints, *, vertical: bool
) -> tuple[str | None, tuple[float, ...] | None]:
    """Return what the shares are of, and each foot's."""
    if not all(foot.has_force for foot in feet):
        return None, None
    impulses = [
        foot.track.vertical_within(spans) if vertical else foot.track.force_within(spans)
        for foot in feet
    ]
    total = sum(impulses)
    if abs(total) < NEAR_ZERO:
        return None, None
    kind = "vertical_impulse" if vertical else "force_impulse"
    return kind, tuple(each / total for each in impulses)


def grouped_shares(
    shares: Sequence[float], leg_positions: Sequence[LegPosition | None]
) -> Mapping[str, float | None]:
    """Add up the shares of fore, hind, left and right feet; None where these are not known."""
    groups = {"fore": "front", "hind": "back", "left": "left", "right": "right"}
    known = [each for each in leg_positions if each is not None]
    if len(known) < len(leg_positions):
        return dict.fromkeys(groups)
    return {
        name: sum(share for share, each in zip(shares, known, strict=True) if word in each)
        for name, word in groups.items()
    }


def symmetry_index_percent(left: float | None, right: float | None) -> float | None:
    """Return 100 (R - L) / ((R + L) / 2), percent: 0 for equal sides, positive if right is more.

    Source: Robinson, Herzog and Nigg 1987, J. Manipulative Physiol. Ther. 10:172.
    None where a side is not known or the denominator is near 0.
    """
    if left is None or right is None:
        return None
    half = (right + left) / 2.0
    if abs(half) < NEAR_ZERO:
        return None
    return 100.0 * (right - left) / half


def dead_feet(feet: Sequence[FootHistory], loads: LoadFigures) -> tuple[bool, ...]:
    """Tell which feet have a sensor that seems dead: one that never reports a contact.

    A foot may also be lifted throughout. That is believed where the other feet are seen to carry
    the whole weight; otherwise nothing is known about the foot.
    """
    ratio = loads.vertical_impulse_over_weight
    carried = ratio is not None and abs(ratio - 1.0) <= CARRIED
    return tuple(
        foot.start is not None and not len(foot.in_contact) and not carried for foot in feet
    )


def _is_constant(foot: FootHistory) -> bool:
    """Tell whether a foot's force never varies while it is loaded."""
    enough = foot.loaded >= STUCK_SAMPLES
    return enough and foot.repeated >= STUCK * (foot.loaded - len(foot.stances.touchdown))


def _varies(foot: FootHistory) -> bool:
    """Tell whether a foot is loaded at times, with forces that vary."""
    return foot.loaded > 0 and not _is_constant(foot)


def is_stuck(foot: FootHistory, others: Sequence[FootHistory]) -> bool:
    """Tell whether a sensor shows one constant value under load while other feet's vary.

    Where no force varies the robot stands still, in a simulator without noise.
    """
    return _is_constant(foot) and any(_varies(other) for other in others)
