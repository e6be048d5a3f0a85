"""How the load is shared, and whether it adds up to the robot's weight."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.foot_history import FootRecord
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.leg_position import LegPosition

NEAR_ZERO: Final = 1e-9
ENOUGH: Final = 0.99
"""Share of the loaded time in which the vertical force must be known for totals to be given."""
CARRIED: Final = 0.05
"""By how much the impulse of the other feet may miss the weight when one is lifted."""
STUCK: Final = 0.99
"""Share of neighbouring loaded samples that are equal to the bit in a sensor that is stuck."""
STUCK_SAMPLES: Final = 100
SATURATED_SAMPLES: Final = 3
"""Samples at the very same highest force that make a flat top."""
SATURATED_STANCES: Final = 3
"""Stances with the same flat top that make a saturated sensor."""


@dataclass(frozen=True, slots=True)
class LoadFigures:
    """Loads of all feet over the time known to all of them."""

    known_s: float
    """s, the time known to all feet, vertical force included where that is used."""
    vertical_impulse_over_weight: float | None
    """Sum over feet of the vertical impulse / (m g x known time): 1 for a sound recording."""
    share_of: str | None
    """What the shares are of: ``vertical_impulse``, or ``force_impulse`` (the integral of |F|)
    where the direction of the force is not known."""
    shares: tuple[float, ...] | None
    """(feet) share of each foot; they add up to 1."""


def vertical_is_known(foot: FootRecord) -> bool:
    """Tell whether the vertical force is known for as good as all of the time under load."""
    if not foot.has_force:
        return False
    loaded = timespans.total(foot.in_contact)
    unknown = timespans.intersect([foot.in_contact, foot.track.vertical_unknown])
    return loaded > 0 and timespans.total(unknown) <= (1.0 - ENOUGH) * loaded


def vertical_impulse_ns(foot: FootRecord) -> float | None:
    """Return the integral of a foot's vertical force over the time known, N s.

    Trapezoid over real sample times, gaps left out. None where the direction of the force is not
    known, or nothing is known at all.
    """
    if timespans.total(foot.known) == 0 or not foot.has_force:
        return None
    if timespans.total(foot.in_contact) and not vertical_is_known(foot):
        return None
    return foot.track.vertical_within(foot.vertical_known)


def load_figures(feet: Sequence[FootRecord], body_weight_n: float | None) -> LoadFigures:
    """Compare the feet's impulses with each other and with the weight.

    Only the time known to all feet counts: a foot whose sensor was silent for a while would
    otherwise seem to carry less.

    Args:
        feet: records of all feet.
        body_weight_n: N; None leaves the comparison with it out.
    """
    vertical = all(vertical_is_known(foot) or not len(foot.in_contact) for foot in feet)
    vertical &= any(len(foot.in_contact) for foot in feet)
    known = timespans.intersect([foot.vertical_known if vertical else foot.known for foot in feet])
    known_s = timespans.total(known) / 1e9
    if not all(foot.has_force for foot in feet):
        return LoadFigures(known_s, None, None, None)
    impulses = [
        foot.track.vertical_within(known) if vertical else foot.track.force_within(known)
        for foot in feet
    ]
    total = sum(impulses)
    over_weight = None
    if vertical and body_weight_n is not None and known_s > 0.0:
        over_weight = total / (body_weight_n * known_s)
    if abs(total) < NEAR_ZERO:
        return LoadFigures(known_s, over_weight, None, None)
    kind = "vertical_impulse" if vertical else "force_impulse"
    return LoadFigures(known_s, over_weight, kind, tuple(each / total for each in impulses))


def grouped_shares(
    shares: Sequence[float], places: Sequence[LegPosition | None]
) -> Mapping[str, float | None]:
    """Add up the shares of fore, hind, left and right feet; None where places are not known."""
    groups = {"fore": "front", "hind": "back", "left": "left", "right": "right"}
    known = [place for place in places if place is not None]
    if len(known) < len(places):
        return dict.fromkeys(groups)
    return {
        name: sum(share for share, place in zip(shares, known, strict=True) if word in place)
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


def dead_feet(feet: Sequence[FootRecord], loads: LoadFigures) -> tuple[bool, ...]:
    """Tell which feet have a sensor that seems dead: one that never reports a contact.

    A foot may also be lifted throughout. That is believed where the other feet are seen to carry
    the whole weight; otherwise nothing is known about the foot.
    """
    ratio = loads.vertical_impulse_over_weight
    carried = ratio is not None and abs(ratio - 1.0) <= CARRIED
    return tuple(
        foot.start is not None and not len(foot.in_contact) and not carried for foot in feet
    )


def is_stuck(foot: FootRecord) -> bool:
    """Tell whether a sensor shows one constant value while it is loaded."""
    enough = foot.loaded >= STUCK_SAMPLES
    return enough and foot.repeated >= STUCK * (foot.loaded - len(foot.stances.touchdown))


def is_saturated(foot: FootRecord) -> bool:
    """Tell whether several stances end in the same flat top: the sensor's limit, it seems."""
    stances = foot.stances
    peak, flat = stances.figures.peak_n, stances.figures.peak_samples
    known = np.isfinite(peak)
    if not known.any() or is_stuck(foot):
        return False
    at_limit = (peak == peak[known].max()) & (flat >= SATURATED_SAMPLES)
    return int(at_limit.sum()) >= SATURATED_STANCES
