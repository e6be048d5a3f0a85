"""Findings about loads."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.core.load.load_figures import LoadFigures
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

WHOLE_TOLERANCE: Final = 0.05
"""By how much the ratio may miss a whole number of summed physics steps, relative to it."""
MOST_STEPS: Final = 100
"""Physics steps that one message may hold."""
NOT_VERTICAL: Final = 0.1
"""Ratio below which the force is hardly along the world's z."""


def load_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is missing or doubtful in the figures of loads."""
    loads = stats.loads
    yield from _weight_findings(stats)
    if stats.push is not None:
        yield _push_finding(stats.push)
    if loads.share_of == "force_impulse" and loads.shares is not None:
        text = (
            "load shares are of the integral of |F|, since vertical forces are not known; "
            "the impulse over weight is not known either"
        )
        yield Finding("N_SHARES_OF_MAGNITUDE", text, "forces.load_share")
    if loads.shares is None:
        text = (
            "not every foot's load is known, there is none, they miss the weight, or no whole "
            "stride is seen: no load shares"
        )
        yield Finding("N_NO_SHARES", text, "forces.load_share")


def _weight_findings(stats: Stats) -> Iterator[Finding]:
    """Yield where the weight comes from, and whether the feet's forces agree with it."""
    loads, where = stats.loads, "forces.vertical_impulse_over_weight"
    if stats.settings.mass_kg is None:
        yield _without_mass(loads.weight_n, stats.settings.estimated_weight_n, where)
    if loads.magnitude_over_weight is not None and loads.magnitude_misses_weight:
        yield _magnitude_finding(stats, loads.magnitude_over_weight, where)
    ratio = loads.mean_over_weight
    if ratio is None and loads.vertical_refuted:
        text = (
            f"the feet's vertical forces add up to {loads.mean_vertical_n:.4g} N, downwards: the "
            "wrenches are in another frame, or those of the feet on the ground; no vertical forces"
        )
        yield Finding("W_IMPULSE_IS_NOT_WEIGHT", text, where)
    if ratio is not None and loads.misses_weight:
        cause = _likely_cause(stats, ratio)
        text = f"the feet's vertical impulse is {ratio:.2f} of the weight: {cause}"
        if loads.vertical_refuted:
            text += "; no vertical forces"
        if loads.direction_refuted:
            text += "; no braking and propulsive impulses"
        yield Finding("W_IMPULSE_IS_NOT_WEIGHT", text + _left_out(loads), where)
    if stats.settings.wrench_frame_is_inferred and loads.may_be_tilted:
        yield _tilt_finding(loads.mean_magnitude_n, loads.mean_vertical_n)


def _tilt_finding(magnitude_n: float | None, vertical_n: float | None) -> Finding:
    """Return that the forces may be in the frames of legs that swing; sums over feet, N."""
    text = (
        f"the sum of |F| is {magnitude_n:.4g} N, that of vertical forces {vertical_n:.4g} N: these "
        "lean, and nothing tells a push along the ground from wrenches in the frames of swinging "
        "legs; no braking and propulsive impulses, no friction"
    )
    return Finding("W_DIRECTION_UNKNOWN", text, "feet")


def _push_finding(push: float) -> Finding:
    """Return that the forces along the ground do not add up to nothing; a share of the weight."""
    text = (
        f"over whole stances, the feet push the robot {'on' if push > 0.0 else 'back'} with "
        f"{abs(push):.0%} of its weight, and it does not change its speed so: the wrenches are in "
        "another frame than transforms or evidence say, or something pulls at the robot; no "
        "braking and propulsive impulses, no friction"
    )
    return Finding("W_DIRECTION_UNKNOWN", text, "feet")


def _magnitude_finding(stats: Stats, ratio: float, where: str) -> Finding:
    """Return that the sum of |F| is far from the weight, where no more is known of forces."""
    text = (
        f"the mean sum of the feet's |F| is {ratio:.2f} of the weight: "
        f"{_likely_cause(stats, ratio)}"
    )
    return Finding("W_IMPULSE_IS_NOT_WEIGHT", text + _left_out(stats.loads), where)


def _left_out(loads: LoadFigures) -> str:
    """Return what is not given where forces do not add up to the weight."""
    words = ["no forces in N"] * loads.other_units + ["no load shares"] * (loads.shares is None)
    words += ["nothing is given in body weights"] * (loads.weight_n is None)
    return "".join(f"; {each}" for each in words)


def _without_mass(weight_n: float | None, thresholds_n: float | None, where: str) -> Finding:
    """Return what stands for the weight of a robot whose mass is not given.

    Args:
        weight_n: N, of figures in body weights; None: there are none.
        thresholds_n: N, of contact thresholds; None: each rests on its foot's usual load.
        where: the figure that is missing.
    """
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
    is_estimated = weight_n is not None or thresholds_n is not None
    return Finding("N_WEIGHT_ESTIMATED" if is_estimated else "N_NO_MASS", "".join(words), where)


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
