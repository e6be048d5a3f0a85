"""Metrics of how the load is shared, and of stability."""

from collections.abc import Mapping
from typing import Final

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.load.load_figures import grouped_shares, symmetry_index_percent
from dogbot_logtool.core.metrics import Forces, LoadShare, Stability, Symmetry
from dogbot_logtool.core.records import Number, unknown
from dogbot_logtool.core.walk_metrics.span import Span

_PAIRS: Final[Mapping[str, tuple[int, int]]] = {"fore": (0, 1), "hind": (2, 3)}
"""Corners, left and right, of the pairs of a quadruped."""


def forces_metrics(span: Span) -> Forces:
    """Return the loads of the whole robot over a span."""
    return Forces(
        vertical_impulse_over_weight=span.loads.vertical_impulse_over_weight,
        load_share=_load_share(span),
        symmetry_index_percent={
            name: _symmetry(span.feet[corners[left]], span.feet[corners[right]])
            for name, (left, right) in _PAIRS.items()
            if (corners := span.stats.corners) is not None
        },
    )


def _load_share(span: Span) -> LoadShare:
    shares = span.loads.shares
    if shares is None:
        return unknown(LoadShare)
    groups = grouped_shares(shares, [foot.leg_position for foot in span.feet])
    return LoadShare(
        feet=dict(zip(span.names, shares, strict=True)), fore=groups["fore"], left=groups["left"]
    )


def _symmetry(left: FootStatistics, right: FootStatistics) -> Symmetry:
    return Symmetry(
        stance_s=_index(left.stance_s, right.stance_s),
        duty_factor=_index(left.duty_factor, right.duty_factor),
        peak_force_n=_index(left.peak_force_n, right.peak_force_n),
    )


def _index(left: Aggregate | None, right: Aggregate | None) -> Number:
    """Return the symmetry index of two means, percent."""
    means = [None if each is None else each.mean for each in (left, right)]
    return symmetry_index_percent(*means)


def stability_metrics(span: Span) -> Stability:
    """Return the stability over a span."""
    found = span.stability
    if found is None:
        return unknown(Stability)
    return Stability(
        static_margin_m=found.static_margin_m,
        energy_margin_m=found.energy_margin_m,
        unstable_fraction=found.unstable_fraction,
        undefined_fraction=found.undefined_fraction,
        unknown_fraction=found.unknown_fraction,
        centre_of_pressure_forward_m=found.pressure_forward_m,
        centre_of_pressure_left_m=found.pressure_left_m,
    )
