"""Findings about the legs."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.leg_figures import LegFigures

_MOST_NAMED = 6


def leg_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is missing or doubtful in the figures of the legs; nothing without legs."""
    legs = stats.legs
    if legs is None:
        return
    yield from _unknown_swings(legs)
    slow = [leg.name for leg in legs.feet if leg.swings.is_slow]
    if slow:
        text = (
            f"legs or contacts of {', '.join(slow)} are told less often than 100 times a second: "
            "the velocity of their touchdowns is not known"
        )
        yield Finding("N_LEGS_SLOW", text, "legs.feet")
    yield from _work(legs)


def _unknown_swings(legs: "LegFigures") -> Iterator[Finding]:
    """Say of which feet no swings are known, one finding a reason."""
    reasons: dict[str, list[str]] = {}
    for leg in legs.feet:
        if leg.moves:
            text = f"{leg.name}: {leg.reason}; its swings are not measured"
            yield Finding("N_FOOT_FRAME", text, f"legs.feet.{leg.name}.clearance_m")
        elif leg.reason:
            reasons.setdefault(leg.reason, []).append(leg.name)
    for reason, feet in reasons.items():
        text = f"the swings of {', '.join(feet)} are not known: {reason}"
        yield Finding("N_NO_SWINGS", text, "legs.feet")


def _work(legs: "LegFigures") -> Iterator[Finding]:
    """Say why no work is known, or what is missing in it."""
    for topic, clock in legs.clocks_apart.items():
        text = (
            f"the clock of {topic} differs by {1e3 * clock.most_s:.0f} ms from that of the feet: "
            "joints over strides are not known"
        )
        yield Finding("W_JOINT_CLOCK", text, topic)
    if legs.work_unknown and not legs.clocks_apart:
        other = "N_LEGS_SLOW" if legs.joints_slow else "N_NO_EFFORT"
        code = "W_JOINT_VALUES" if legs.work_refuted else other
        text = f"no work is known: {legs.work_unknown}"
        yield Finding(code, text, "legs.absolute_work_j")
    elif legs.without_effort and not legs.work_unknown:
        named = ", ".join(legs.without_effort[:_MOST_NAMED])
        more = len(legs.without_effort) - _MOST_NAMED
        text = f"joints that move without an effort, whose work is missing: {named}"
        text += f" and {more} more" if more > 0 else ""
        yield Finding("N_NO_EFFORT", text, "legs.absolute_work_j")
    for doubt in legs.sign_doubts:
        text = f"{doubt.text}; positive work is null, absolute work does not depend on signs"
        yield Finding("W_EFFORT_SIGN", text, doubt.key)
