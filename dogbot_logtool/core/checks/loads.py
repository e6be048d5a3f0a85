"""Checks of loads: forces, their direction, and the weight."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.core.loads import is_stuck
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

WHOLE_TOLERANCE: Final = 0.05
"""By how much the ratio may miss a whole number of summed physics steps, relative to it."""
MOST_STEPS: Final = 100
"""Physics steps that one message may hold."""
NOT_VERTICAL: Final = 0.1
"""Ratio below which the force is hardly along the world's z."""
MOST_PUSH: Final = 0.05
"""Share of the weight that feet may push a robot on, over whole stances, that does not speed up."""
_RATIO: Final = "forces.vertical_impulse_over_weight"


def no_force(stats: Stats) -> Iterator[Finding]:
    """Yield feet whose sensors tell contact only."""
    if stats.settings.contact_from:
        return
    for foot in stats.feet:
        others = [each.record for each in stats.feet if each is not foot]
        touches = len(foot.stances.touchdown) > 0
        if touches and not foot.record.has_force and not is_stuck(foot.record, others):
            text = f"the sensor of {foot.name} tells contact, not force"
            yield Finding("NO_FORCE", text, f"feet.{foot.name}.peak_force_n")


def mass_unknown(stats: Stats) -> Iterator[Finding]:
    """Yield what stands for the weight of a robot whose mass is not given."""
    if stats.settings.mass_kg is not None:
        return
    weight_n, thresholds_n = stats.loads.weight_n, stats.settings.estimated_weight_n
    words = ["the robot's mass is not known: "]
    if weight_n is None:
        words.append("nothing is given in body weights")
    else:
        words.append(
            f"its weight is taken as {weight_n:.4g} N, the mean vertical force of all feet over "
            "whole strides; impulse over weight is not given"
        )
    if thresholds_n is not None:
        words.append(
            f"; contact thresholds rest on {thresholds_n:.3g} N, the mean sum of the feet's loads"
        )
    yield Finding("MASS_UNKNOWN", "".join(words), _RATIO)


def impulse_is_not_weight(stats: Stats) -> Iterator[Finding]:
    """Yield that the feet's forces do not add up to the weight, and what that refutes."""
    loads = stats.loads
    cases = _refuted(stats)
    magnitude, ratio = loads.magnitude_over_weight, loads.vertical_impulse_over_weight
    if magnitude is not None and loads.magnitude_misses_weight:
        text = f"the mean sum of the feet's |F| is {magnitude:.2f} of the weight: "
        text += _likely_cause(stats, magnitude)
        yield Finding("IMPULSE_IS_NOT_WEIGHT", text, _RATIO, cases=cases)
    if ratio is None and loads.vertical_refuted:
        text = (
            f"the feet's vertical forces add up to {loads.mean_vertical_n:.4g} N, downwards: the "
            "wrenches are in another frame, or those of the feet on the ground"
        )
        yield Finding("IMPULSE_IS_NOT_WEIGHT", text, _RATIO, cases=cases)
    if ratio is not None and loads.misses_weight:
        text = f"the feet's vertical impulse is {ratio:.2f} of the weight: "
        text += _likely_cause(stats, ratio)
        yield Finding("IMPULSE_IS_NOT_WEIGHT", text, _RATIO, cases=cases)


def _refuted(stats: Stats) -> tuple[str, ...]:
    """Return the cases of what forces that miss the weight refute."""
    loads = stats.loads
    cases = {
        "direction": loads.direction_refuted,
        "shares": loads.direction_refuted or loads.magnitude_misses_weight,
        "vertical": loads.vertical_refuted or loads.other_units,
        "weight": loads.weight_refuted,
        "assumed": loads.weight_refuted and stats.settings.mass_is_assumed,
        "units": loads.other_units,
    }
    return tuple(case for case, holds in cases.items() if holds)


def forces_lean(stats: Stats) -> Iterator[Finding]:
    """Yield that forces may be in the frames of legs that swing."""
    loads = stats.loads
    if _may_lean(stats):
        text = (
            f"the sum of |F| is {loads.mean_magnitude_n:.4g} N, that of vertical forces "
            f"{loads.mean_vertical_n:.4g} N: these lean, and nothing tells a push along the "
            "ground from wrenches in the frames of swinging legs"
        )
        yield Finding("DIRECTION_UNKNOWN", text, "feet")


def forces_push(stats: Stats) -> Iterator[Finding]:
    """Yield that the forces along the ground do not add up to nothing."""
    push = _refuted_push(stats)
    if push is not None:
        text = (
            f"over whole stances, the feet push the robot {'on' if push > 0.0 else 'back'} "
            f"with {abs(push):.0%} of its weight, and it does not change its speed so: the "
            "wrenches are in another frame than transforms or evidence say, or something pulls at "
            "the robot"
        )
        yield Finding("DIRECTION_UNKNOWN", text, "feet")


def direction_is_doubtful(stats: Stats) -> bool:
    """Tell whether the feet's forces are refuted, or their direction is."""
    loads = stats.loads
    refuted = loads.direction_refuted or loads.vertical_refuted or loads.other_units
    return refuted or _may_lean(stats) or _refuted_push(stats) is not None


def _may_lean(stats: Stats) -> bool:
    return stats.settings.wrench_frame_is_inferred and stats.loads.may_be_tilted


def _refuted_push(stats: Stats) -> float | None:
    """Return the share of the weight that the feet push on; None: no more than motion explains."""
    push, base = stats.push, stats.base
    if push is None or base is None or not base.duration_s:
        return None
    if stats.loads.direction_refuted or _may_lean(stats):
        return None
    speeds = abs(base.forward_speed_mps or 0.0) / (GRAVITY_MPS2 * base.duration_s)
    return push if abs(push) > MOST_PUSH + 2.0 * speeds else None


def _likely_cause(stats: Stats, ratio: float) -> str:
    """Return the most likely reason why the feet's vertical impulse misses the weight."""
    mass_kg = stats.settings.mass_kg or 0.0
    silent = [foot.name for foot in stats.feet if foot.is_dead or foot.record.start is None]
    steps = round(ratio)
    if ratio < NOT_VERTICAL:
        return "the wrenches seem to be in a link's frame, or the sensors in other units"
    if silent and ratio < 1.0:
        return f"the load on {' and '.join(silent)} is missing"
    if 2 <= steps <= MOST_STEPS and abs(ratio - steps) <= WHOLE_TOLERANCE * steps:
        return f"{steps} physics steps seem to be added up in each message, or the mass is wrong"
    origin = "assumed for the guessed robot" if stats.settings.mass_is_assumed else "given"
    return f"the feet carry {ratio * mass_kg:.3g} kg, and the mass {origin} is {mass_kg:.4g} kg"
