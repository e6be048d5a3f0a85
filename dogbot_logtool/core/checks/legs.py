"""Checks of joints and of the feet's frames."""

from collections.abc import Iterator

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

_MOST_NAMED = 6


def foot_frames(stats: Stats) -> Iterator[Finding]:
    """Yield frames that move while their feet stand."""
    for leg in stats.legs.feet if stats.legs else ():
        if leg.moves:
            text, where = f"{leg.name}: {leg.reason}", f"legs.feet.{leg.name}.clearance_m"
            yield Finding("FOOT_FRAME", text, where, feet=(leg.name,))


def sampled_slowly(stats: Stats) -> Iterator[Finding]:
    """Yield what is sampled too slowly for touchdown velocities, or for the work of joints."""
    legs = stats.legs
    if legs is None:
        return
    slow = tuple(leg.name for leg in legs.feet if leg.swings.is_slow)
    if slow:
        text = (
            f"legs or contacts of {', '.join(slow)} are sampled below 100 Hz: "
            "the velocity of their touchdowns is not known"
        )
        yield Finding("SAMPLED_SLOWLY", text, "legs.feet", cases=("touchdown",), feet=slow)
    if legs.joints_slow and not legs.clocks_apart:
        text = f"no work is known: {legs.work_unknown}"
        yield Finding("SAMPLED_SLOWLY", text, "legs.absolute_work_j", cases=("work",))


def joint_clocks(stats: Stats) -> Iterator[Finding]:
    """Yield joint states on another clock than the feet."""
    for topic, clock in stats.legs.clocks_apart.items() if stats.legs else ():
        text = (
            f"the clock of {topic} differs by {1e3 * clock.most_s:.0f} ms from that of the feet: "
            "joints over strides are not known"
        )
        yield Finding("CLOCK_OFFSET", text, topic, cases=("joints",))


def joints_missing(stats: Stats) -> Iterator[Finding]:
    """Yield joints or efforts that joint states leave out."""
    legs, where = stats.legs, "legs.absolute_work_j"
    if legs is None or legs.clocks_apart or legs.work_refuted or legs.joints_slow:
        return
    if legs.work_unknown:
        text = f"no work is known: {legs.work_unknown}"
        yield Finding("JOINTS_MISSING", text, where, cases=("work",))
    elif legs.without_effort:
        named = ", ".join(legs.without_effort[:_MOST_NAMED])
        more = len(legs.without_effort) - _MOST_NAMED
        text = f"joints that move without an effort, whose work is missing: {named}"
        yield Finding("JOINTS_MISSING", text + (f" and {more} more" if more > 0 else ""), where)


def joint_values(stats: Stats) -> Iterator[Finding]:
    """Yield joint states that contradict themselves or the forces on the feet."""
    legs = stats.legs
    if legs is not None and legs.work_refuted and not legs.clocks_apart:
        text = f"no work is known: {legs.work_unknown}"
        yield Finding("JOINT_VALUES", text, "legs.absolute_work_j")


def effort_signs(stats: Stats) -> Iterator[Finding]:
    """Yield efforts of the wrong sign."""
    for doubt in stats.legs.sign_doubts if stats.legs else ():
        text = f"{doubt.text}; absolute work does not depend on signs"
        yield Finding("EFFORT_SIGN", text, doubt.key)
