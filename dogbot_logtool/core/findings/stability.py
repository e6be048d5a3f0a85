"""Findings about stability."""

from collections.abc import Iterator

from dogbot_logtool.core.findings.contradictions import why_feet_and_base_are_apart
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding


def stability_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is missing in the figures of stability."""
    if stats.stability is None:
        text = (
            why_feet_and_base_are_apart(stats)
            or "there is no time in which the base and the state of every foot are known"
        )
        yield Finding("N_NO_STABILITY", text, "stability")
    elif stats.stability.undefined_fraction is None:
        text = "no foot that is down tells where it stands: no support polygon"
        yield Finding("N_NO_MARGIN", text, "stability.static_margin_m")
    elif stats.stability.static_margin_m is None:
        text = "there are never three feet with a contact point down at once: no static margin"
        yield Finding("N_NO_MARGIN", text, "stability.static_margin_m")
    if stats.stability is not None and stats.stability.pressure_forward_m is None:
        text = "vertical forces are not known: no centre of pressure"
        yield Finding("N_NO_CENTRE_OF_PRESSURE", text, "stability.centre_of_pressure_forward_m")
