"""The page itself: summary, figures and tables set in a template, with all that it needs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from markupsafe import Markup

from dogbot_logtool import __version__
from dogbot_logtool.core.metrics import Segment, Settings, WalkMetrics
from dogbot_logtool.core.scene.feet import foot_colour, short_names
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.assets import json_in_html, page_script, policy_of, rendered
from dogbot_logtool.report.page.chart import FINE, Drawing, foot_glyph, packed, seconds
from dogbot_logtool.report.page.feet_over_time import gait_diagram, load_curves
from dogbot_logtool.report.page.from_above import walk_from_above
from dogbot_logtool.report.page.over_cycle import force_over_cycle, legs_over_cycle
from dogbot_logtool.report.page.over_time import (
    MINOR,
    MOST_LISTED,
    mark_events,
    motion,
    tracked_commands,
)
from dogbot_logtool.report.page.tables import page_tables
from dogbot_logtool.report.tables import NOTHING, decimal, recorded_at, span_of
from dogbot_logtool.report.text.gait_diagram import default_window
from dogbot_logtool.report.verdict import (
    UNNAMED,
    fall_headline,
    gait_headline,
    gait_name,
    grouped,
    quality_of,
)
from dogbot_logtool.results import Measurement

FIGURES: Final[Mapping[str, Callable[[Walk], Drawing | None]]] = {
    "gait": gait_diagram,
    "loads": load_curves,
    "motion": motion,
    "commands": tracked_commands,
    "cycle": force_over_cycle,
    "legs": legs_over_cycle,
    "ground": walk_from_above,
}
"""What draws each figure, by the name that the template knows it by; a log may lack some."""


@dataclass(frozen=True, slots=True)
class Beside:
    """Files beside a page of several logs; none beside a page that stands alone."""

    script: str = ""
    """File name of the script that the pages share; empty: it is in the page."""
    index: str = ""
    """File name of the index."""


ALONE: Final = Beside()


def page(
    measured: Measurement,
    file_size: int,
    *,
    replay: Mapping[str, Any] | None = None,
    beside: Beside = ALONE,
) -> bytes:
    """Return the HTML page of one log.

    Args:
        measured: what was measured of it.
        file_size: bytes; 0 where it is not one file.
        replay: the walk in 3D; None: without it.
        beside: files beside the page.
    """
    walk, metrics, damage = measured.walk, measured.metrics, measured.damage
    events = metrics.events
    drawn = {name: draw(walk) for name, draw in FIGURES.items()}
    drawings = [drawing for drawing in drawn.values() if drawing is not None]
    mark_events(events, drawings, list(metrics.feet))
    script = "" if beside.script else page_script()
    return rendered(
        "page.html.j2",
        script,
        policy=policy_of(script) if script else Markup("'self' file:"),
        name=Path(metrics.log.path).name,
        about=_about(metrics),
        beside=beside,
        drawings=drawn,
        drawings_json=json_in_html([each.plain() for each in drawings]),
        times_json=json_in_html(_times(walk)),
        replay=replay,
        replay_json=json_in_html(replay),
        feet=_feet(walk),
        summary=_summary(measured),
        findings=grouped([each for each in measured.findings if each.code != "LOST"]),
        events=events[:MOST_LISTED],
        more_events=len(events[MOST_LISTED:]),
        minor=MINOR,
        damage=damage.text,
        losses=damage.losses,
        file_size=file_size,
        tables=page_tables(walk),
        settings=_settings(metrics.settings),
    )


def _times(walk: Walk) -> dict[str, Any]:
    """Return the log's end, its typical strides, and every stride of each foot."""
    return {
        "typical": default_window(walk),
        "end": (walk.end - walk.origin) / 1e9,
        "strides": [packed(seconds(walk, foot.strides.spans), FINE) for foot in walk.feet],
    }


def _feet(walk: Walk) -> list[dict[str, str]]:
    """Return how each foot is shown in text."""
    names = [foot.name for foot in walk.feet]
    return [
        {
            "name": name,
            "short": short,
            "colour": foot_colour(row),
            "symbol": foot_glyph(walk, row),
        }
        for row, (name, short) in enumerate(zip(names, short_names(names), strict=True))
    ]


def _about(metrics: WalkMetrics) -> list[tuple[str, str]]:
    """Return what the log is, by name."""
    log = metrics.log
    duration = NOTHING if log.duration_s is None else f"{log.duration_s:.2f} s"
    container = f"{log.container} ({log.profile})" if log.profile else log.container
    return [
        ("robot", metrics.settings.robot or "not known"),
        ("recorded", recorded_at(log.start_s)),
        ("log", f"{container}, {duration}, {log.messages:,} messages"),
        ("measured by", f"dogbot-logtool {__version__}"),
    ]


def _settings(settings: Settings) -> str:
    feet = settings.feet.values()
    on_n = span_of([each.contact_on_n for each in feet if each.contact_on_n is not None])
    debounce = span_of([each.debounce_s * 1e3 for each in feet if each.debounce_s is not None])
    mass = "not known" if settings.mass_kg is None else f"{settings.mass_kg:g} kg"
    return (
        f"Measured on {settings.clock} time; mass {mass}; contact from {on_n} N, debounced over "
        f"{debounce} ms; wrenches in the frame: {settings.wrench_frame}; forward axis "
        f"{settings.forward_axis}."
    )


_FIRST = 3
"""Warnings that stand at the top of the page."""


def _summary(measured: Measurement) -> dict[str, Any]:
    """Sum up a log: the fall or, without one, the gait; whether to trust it; a few numbers."""
    metrics, quality = measured.metrics, quality_of(measured)
    fall, gait = fall_headline(metrics), gait_headline(metrics)
    is_named = metrics.gait.name not in UNNAMED
    segments = metrics.gait.segments
    return {
        "headline": fall or gait,
        "is_sound": is_named and not fall and quality.level != "bad",
        "gait": gait if fall else "",
        "quality": quality,
        "first": [f"{each.text}. {each.remedy}" for each, *_ in quality.warnings[:_FIRST]],
        "tiles": list(_tiles(metrics)),
        "segments": list(_in_turn(segments)) if len(segments) > 1 else [],
    }


def _tiles(metrics: WalkMetrics) -> Iterator[tuple[str, str, str]]:
    """Yield names and values of a few numbers, and something aside."""
    base, gait = metrics.base, metrics.gait
    if base.path_length_m is not None:
        net = f"{decimal(base.net_displacement_m, 2)} m from start to end"
        yield "distance", f"{base.path_length_m:.2f} m", net
    if base.forward_speed_mps is not None:
        sideways = f"{decimal(base.lateral_speed_mps, 2)} m/s to the left"
        yield "speed forward", f"{base.forward_speed_mps:z.3f} m/s", sideways
    if gait.stride_frequency_hz is not None:
        frequency = f"{gait.stride_frequency_hz:.2f} Hz"
        yield "stride frequency", frequency, f"{gait.strides} strides"
    if gait.duty_factor is not None:
        kind = "below one half" if gait.duty_factor < 0.5 else "one half or more"
        yield "duty factor", f"{gait.duty_factor:.3f}", kind
    peaks = [
        (foot.peak_force_n.max, name) for name, foot in metrics.feet.items() if foot.peak_force_n
    ]
    if peaks:
        highest, name = max(peaks)
        weight = metrics.settings.body_weight_n
        of = "" if weight is None else f", {highest / weight:.2f} body weights"
        yield "highest load", f"{highest:.1f} N", f"{name}{of}"
    ratio = metrics.forces.vertical_impulse_over_weight
    if ratio is not None:
        yield "load check", f"{ratio:.1%}", "of the body weight on the feet"
    margin = metrics.stability.static_margin_m
    if margin is not None:
        least = f"min {margin.min * 1e3:z.0f} mm"
        yield "static margin", f"{margin.median * 1e3:z.0f} mm", least


def _in_turn(segments: Sequence[Segment]) -> Iterator[str]:
    for each in segments:
        frequency = each.gait.stride_frequency_hz
        pace = "" if frequency is None else f", {frequency:.2f} strides/s"
        yield f"{each.start_s:.1f} to {each.end_s:.1f} s: {gait_name(each.gait)}{pace}"
