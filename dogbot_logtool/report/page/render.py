"""The page itself: figures and tables set in a template, with all that it needs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from markupsafe import Markup

from dogbot_logtool import __version__
from dogbot_logtool.core.checks.voids import void_patterns
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.scene.foot_style import foot_colour, short_names
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.report.numbers import NOTHING, span_of
from dogbot_logtool.report.page.assets import json_in_html, own, page_script, policy_of, rendered
from dogbot_logtool.report.page.charts.cycle_figures import force_over_cycle, legs_over_cycle
from dogbot_logtool.report.page.charts.drawing import Drawing, drawn_seconds, foot_glyph, packed
from dogbot_logtool.report.page.charts.ground_figure import walk_from_above
from dogbot_logtool.report.page.charts.motion_figures import motion, tracked_commands
from dogbot_logtool.report.page.charts.time_figures import gait_diagram, load_curves
from dogbot_logtool.report.page.curves import with_curves
from dogbot_logtool.report.page.event_list import band_labels, event_list, marks
from dogbot_logtool.report.page.summary import grouped, recorded_at, summary
from dogbot_logtool.report.page.tables import (
    joint_table,
    leg_table,
    load_table,
    step_table,
    stride_table,
    symmetry_table,
    topic_table,
)
from dogbot_logtool.report.tables import foot_rows
from dogbot_logtool.report.text.gait_diagram import default_window
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
    stats, log, walk = with_curves(measured.walk), measured.metrics.log, measured.metrics
    feet = foot_rows(walk, stats)
    events = event_list(stats)
    drawn = {name: draw(stats) for name, draw in FIGURES.items()}
    drawings = {name: drawing for name, drawing in drawn.items() if drawing is not None}
    for drawing in drawings.values():
        if drawing.over_time:
            drawing.figure.layout["shapes"] = marks(events, drawing)
    if "gait" in drawings:
        drawings["gait"].figure.layout["annotations"] = band_labels(events)
    script = "" if beside.script else page_script()
    return rendered(
        "page.html.j2",
        version=__version__,
        name=Path(log.path).name,
        about=_about(walk),
        beside=beside,
        css=Markup(own("page.css")),  # noqa: S704 - our own file
        script=Markup(script),  # noqa: S704 - Plotly's and ours
        policy=Markup(policy_of(script) if script else "'self' file:"),  # noqa: S704 - a hash
        drawings=drawn,
        drawings_json=json_in_html([_plain(each) for each in drawings.values()]),
        times_json=json_in_html(_times(stats)),
        replay=replay,
        replay_json=json_in_html(replay),
        feet=_feet(stats),
        summary=summary(measured),
        findings=grouped([each for each in measured.findings if each.code != "LOST"]),
        events=events,
        damage=measured.damage.text,
        losses=[loss.what for loss in measured.damage.losses],
        file_marks=_file_marks(measured.damage.losses, file_size),
        tables={
            "steps": step_table(feet),
            "loads": load_table(feet, stats.loads),
            "symmetry": symmetry_table(walk.forces),
            "legs": leg_table(feet),
            "joints": joint_table(walk),
            "strides": stride_table(stats, void_patterns(measured.findings)),
            "topics": topic_table(walk),
        },
        settings=_settings(stats),
    )


def _plain(drawing: Drawing) -> dict[str, Any]:
    return {"name": drawing.name, "over_time": drawing.over_time, **drawing.figure.plain()}


def _times(stats: Walk) -> dict[str, Any]:
    """Return the log's end, its typical strides, and every stride of each foot."""
    return {
        "typical": default_window(stats),
        "end": (stats.end - stats.origin) / 1e9,
        "weight": stats.loads.weight_n,
        "strides": [packed(drawn_seconds(stats, foot.strides.spans)) for foot in stats.feet],
    }


def _feet(stats: Walk) -> list[dict[str, str]]:
    """Return how each foot is shown in text."""
    names = [foot.name for foot in stats.feet]
    return [
        {
            "name": name,
            "short": short,
            "colour": foot_colour(row),
            "symbol": foot_glyph(stats, row),
        }
        for row, (name, short) in enumerate(zip(names, short_names(names), strict=True))
    ]


def _about(walk: WalkMetrics) -> list[tuple[str, str]]:
    """Return what the log is, by name."""
    log = walk.log
    duration = NOTHING if log.duration_s is None else f"{log.duration_s:.2f} s"
    container = f"{log.container} ({log.profile})" if log.profile else log.container
    return [
        ("robot", walk.settings.robot or "not known"),
        ("recorded", recorded_at(log.start_s)),
        ("log", f"{container}, {duration}, {log.messages:,} messages"),
        ("measured by", f"dogbot-logtool {__version__}"),
    ]


def _file_marks(losses: Sequence[Loss], file_size: int) -> list[dict[str, Any]]:
    """Return where damage lies along the file, in percent."""
    if not file_size:
        return []
    marks = []
    for loss in losses:
        left = min(loss.offset / file_size, 1.0) * 100.0
        width = min(loss.bytes / file_size * 100.0, 100.0 - left)
        marks.append({"left": f"{left:.3f}", "width": f"{width:.3f}", "what": loss.what})
    return marks


def _settings(stats: Walk) -> str:
    settings = stats.settings
    rules = [settings.sensor(row).rule for row in range(len(settings.feet))]
    on_n = span_of([rule.on_n for rule in rules])
    debounce_ms = span_of([rule.debounce_s * 1e3 for rule in rules])
    mass = "not known" if settings.mass_kg is None else f"{settings.mass_kg:g} kg"
    return (
        f"Measured on {settings.clock} time; mass {mass}; contact from {on_n} N, "
        f"debounced over {debounce_ms} ms; wrenches in the frame: "
        f"{settings.wrench_frame}; forward axis {settings.forward_axis}."
    )
