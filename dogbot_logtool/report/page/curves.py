"""The load curves of a page: coarse over the whole log, every sample over the typical strides."""

from dataclasses import replace
from typing import Final

from dogbot_logtool.core.contact.curves import Curve, CurveDetail, LoadCurves
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.text.gait_diagram import default_window

DETAIL: Final = CurveDetail(most_bins=1536)
"""As many bins as the page has columns of pixels."""


def with_curves(stats: Walk, detail: CurveDetail = DETAIL) -> Walk:
    """Return figures with the load curves that a page draws.

    Args:
        stats: the figures.
        detail: of the curves outside the typical strides.
    """
    first, last = (stats.origin + round(each * 1e9) for each in default_window(stats))
    feet = tuple(
        replace(foot, record=_with_curves(foot.record, detail, first, last)) for foot in stats.feet
    )
    return replace(stats, feet=feet)


def _with_curves(foot: FootHistory, detail: CurveDetail, first: int, last: int) -> FootHistory:
    coarse = foot.load_curves(detail)
    if coarse is None:
        return foot
    # The dotted line lies beneath the other one; the typical strides have all of it.
    coarser = foot.load_curves(CurveDetail(detail.most_bins // 2)) or coarse
    # Whole bins, so that each is either replaced or kept.
    bin_ns = coarser.bin_ns
    window = first // bin_ns * bin_ns, -(-last // bin_ns) * bin_ns - 1
    fine = foot.load_curves(CurveDetail(window=window)) or coarse
    curves = LoadCurves(
        _refined(coarse.force, fine.force, window),
        _refined(coarser.vertical, fine.vertical, window),
    )
    return replace(foot, curves=curves)


def _refined(coarse: Curve | None, fine: Curve | None, window: tuple[int, int]) -> Curve | None:
    return coarse if coarse is None or fine is None else coarse.refined(fine, window)
