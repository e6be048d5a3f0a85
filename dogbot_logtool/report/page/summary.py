"""The summary, to be read in ten seconds: the gait, a few numbers, and whether to trust them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.report.numbers import decimal
from dogbot_logtool.report.verdict import (
    UNNAMED,
    Quality,
    fall_headline,
    gait_headline,
    gait_name,
    quality_of,
)
from dogbot_logtool.results import Measurement

_FIRST = 3
"""Warnings that stand at the top of the page."""


class Tile(NamedTuple):
    """A number with its name."""

    name: str
    value: str
    aside: str


@dataclass(frozen=True, slots=True)
class Summary:
    """The head of the page."""

    headline: str
    """The fall or, without one, the gait."""
    is_sound: bool
    """Whether the headline is a gait that has a name, of a recording without doubt."""
    gait: str
    """The gait, where a fall is the headline."""
    quality: Quality
    first: tuple[str, ...]
    """The first warnings, each with its remedy."""
    tiles: tuple[Tile, ...]
    segments: tuple[str, ...]
    """The gaits in turn, where there are several."""


def summary(measured: Measurement) -> Summary:
    """Sum up a log."""
    metrics, quality = measured.metrics, quality_of(measured)
    fall, gait = fall_headline(metrics), gait_headline(metrics)
    return Summary(
        fall or gait,
        metrics.gait.name not in UNNAMED and not fall and quality.level != "bad",
        gait if fall else "",
        quality,
        tuple(f"{each.text}. {each.remedy}".strip() for each, *_ in quality.warnings[:_FIRST]),
        tuple(_tiles(metrics)),
        tuple(_segments(metrics)) if len(metrics.gait.segments) > 1 else (),
    )


def _tiles(metrics: WalkMetrics) -> Iterator[Tile]:
    base, gait = metrics.base, metrics.gait
    if base.path_length_m is not None:
        net = f"{decimal(base.net_displacement_m, 2)} m from start to end"
        yield Tile("distance", f"{base.path_length_m:.2f} m", net)
    if base.forward_speed_mps is not None:
        sideways = f"{decimal(base.lateral_speed_mps, 2)} m/s to the left"
        yield Tile("speed forward", f"{base.forward_speed_mps:z.3f} m/s", sideways)
    if gait.stride_frequency_hz is not None:
        frequency = f"{gait.stride_frequency_hz:.2f} Hz"
        yield Tile("stride frequency", frequency, f"{gait.strides} strides")
    if gait.duty_factor is not None:
        kind = "below one half" if gait.duty_factor < 0.5 else "one half or more"
        yield Tile("duty factor", f"{gait.duty_factor:.3f}", kind)
    peaks = [
        (foot.peak_force_n.max, name) for name, foot in metrics.feet.items() if foot.peak_force_n
    ]
    if peaks:
        highest, name = max(peaks)
        weight = metrics.settings.body_weight_n
        of = "" if weight is None else f", {highest / weight:.2f} body weights"
        yield Tile("highest load", f"{highest:.1f} N", f"{name}{of}")
    ratio = metrics.forces.vertical_impulse_over_weight
    if ratio is not None:
        yield Tile("load check", f"{ratio:.1%}", "of the body weight on the feet")
    margin = metrics.stability.static_margin_m
    if margin is not None:
        least = f"min {margin.min * 1e3:z.0f} mm"
        yield Tile("static margin", f"{margin.median * 1e3:z.0f} mm", least)


def _segments(metrics: WalkMetrics) -> Iterator[str]:
    for each in metrics.gait.segments:
        frequency = each.gait.stride_frequency_hz
        pace = "" if frequency is None else f", {frequency:.2f} strides/s"
        yield f"{each.start_s:.1f} to {each.end_s:.1f} s: {gait_name(each.gait)}{pace}"
