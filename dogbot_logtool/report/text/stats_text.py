"""The figures of `stats` for people: the verdict first, then the feet, loads, and what to doubt."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final, TypeVar

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.checks.engine import first_of
from dogbot_logtool.core.events.event import STEPS as STEP_EVENTS
from dogbot_logtool.core.gait.classes import STAND
from dogbot_logtool.core.metrics import Legs, Symmetry, WalkMetrics
from dogbot_logtool.core.records import Number
from dogbot_logtool.core.scene.foot_style import short_names
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding, Severity
from dogbot_logtool.io.printable import printable
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.numbers import NOTHING, decimal
from dogbot_logtool.report.tables import (
    JOINTS,
    LEGS,
    LOADS,
    STEPS,
    Column,
    FootRow,
    cells_of,
    foot_rows,
    grouped_load,
    headers,
)
from dogbot_logtool.report.text.console import print_command, print_damage, print_sentence
from dogbot_logtool.report.text.gait_diagram import (
    ASCII,
    UNICODE,
    default_window,
    gait_diagram,
    support_line,
)
from dogbot_logtool.report.text.legs_text import work_words
from dogbot_logtool.report.text.side_text import command_lines, imu_lines
from dogbot_logtool.report.text.stats_summary import SUMMARY_HEADERS
from dogbot_logtool.report.text.text_layout import HangingIndent, NameTable, Row
from dogbot_logtool.report.verdict import evidence, fall_headline, gait_name, how_sure, is_known
from dogbot_logtool.results import LogFacts, Measurement

S = TypeVar("S")
_INDENT: Final = 4
"""Indent of further lines of a text that does not fit into one."""
_STYLES: Final[Mapping[Severity, str]] = {
    Severity.ERROR: "bold red",
    Severity.WARNING: "yellow",
    Severity.NOTE: "dim",
}

_INDICES: Final[Mapping[str, Callable[[Symmetry], Number]]] = {
    "peak force": lambda pair: pair.peak_force_n,
    "duty factor": lambda pair: pair.duty_factor,
}


def print_report(console: Console, measured: Measurement, *, verbose: bool = False) -> None:
    """Print the report of one log.

    Args:
        console: where to; its width decides the layout.
        measured: what was measured of it.
        verbose: say also what is merely good to know, foot by foot.
    """
    stats, log, walk = measured.stats, measured.facts, measured.metrics
    feet = foot_rows(walk, stats)
    glyphs = ASCII if console.options.ascii_only else UNICODE
    start, end = default_window(stats)
    diagram = gait_diagram(stats, console.width - 2, window=(start, end), glyphs=glyphs)
    legend = "filled: foot down"
    if any(glyphs.unknown in line.plain for line in diagram):
        legend += f"; {glyphs.unknown}: not known"
    # The damage has a line of its own, at the top.
    findings = [each for each in measured.findings if each.code != "LOST"]
    parts: list[RenderableType] = [
        Text(),
        verdict(stats, walk),
        *_segments(stats),
        *_first(findings),
        Text(),
        *_events(walk),
        _heading("Gait diagram", f"{start:.2f} to {end:.2f} s; {legend}"),
        Padding(Group(*diagram), (0, 0, 0, 2), expand=False),
        Text(),
        _heading("Steps", "medians over whole strides"),
        _metrics(console, STEPS, feet),
        _support(stats),
        Text(),
        _heading("Loads", _load_unit(stats)),
        _metrics(console, LOADS, feet),
        *_load_lines(stats, walk),
        Text(),
        *_legs(console, feet, walk.legs, verbose=verbose),
        _heading("Base"),
        *_base(stats),
        *_beside(stats, walk),
        Text(),
        _heading("Findings"),
        *_findings(findings, verbose=verbose),
    ]
    # A report keeps its width where no terminal shows it.
    console.print(_title(log), highlight=False, soft_wrap=False, crop=False)
    print_damage(console, log.damage)
    console.print(Group(*parts), highlight=False, soft_wrap=False, crop=False)
    for each in log.findings:
        if each.command:
            print_command(console, each.command, 2)


def _title(log: LogFacts) -> HangingIndent:
    duration = NOTHING if log.duration_s is None else f"{log.duration_s:.2f} s"
    facts = f"  {log.container}, {duration}, {log.messages} messages"
    return HangingIndent(Text.assemble((printable(log.path), "bold"), facts), 2)


def _heading(words: str, aside: str = "") -> Text:
    return Text.assemble((words, "bold"), (f"  {aside}" if aside else "", "dim"))


def verdict(stats: Stats, walk: WalkMetrics) -> Text:
    """Say in a line or two which gait it is, and how sure that is."""
    fall = fall_headline(stats)
    return (
        Text.assemble((f"{fall}\n", "bold red"), _gait(stats, walk)) if fall else _gait(stats, walk)
    )


def _gait(stats: Stats, walk: WalkMetrics) -> Text:
    main = stats.main
    if main is None:
        return Text("Gait not known: no foot makes a whole stride.", style="bold yellow")
    if main.gait.name is not None and walk.gait.name is None:
        cause = walk.null_because.get("gait.name", "")
        return Text(f"Gait not known ({cause}).", style="bold yellow")
    if main.gait.name == STAND:
        extent = "throughout" if len(stats.segments) == 1 else "for the longest time"
        return Text.assemble(("Stand", "bold green"), f": all feet are down {extent}.")
    style = "bold green" if is_known(stats) else "bold yellow"
    sure = how_sure(main)
    line = Text.assemble((gait_name(main), style), f", {sure}" if sure else "")
    line.append(f"\n{evidence(main)}")
    if main.duty_factor is not None:
        line.append(f"\nduty factor {main.duty_factor:.3f}")
    if main.stride_frequency_hz is not None:
        line.append(f", {main.stride_frequency_hz:.3f} strides a second")
    speed = walk.base.forward_speed_mps
    if speed is not None:
        # Rounded first: -0.0001 is no -0.000.
        line.append(f", {round(speed, 3) + 0.0:.3f} m/s forward")
    return line


def _segments(stats: Stats) -> list[RenderableType]:
    if len(stats.segments) < 2:
        return []
    parts = []
    for segment in stats.segments:
        start, end = ((each - stats.origin) / 1e9 for each in (segment.start, segment.end))
        frequency = segment.stride_frequency_hz
        pace = "" if frequency is None else f", {frequency:.2f} strides/s"
        parts.append(f"{start:.1f}-{end:.1f} s {gait_name(segment).lower()}{pace}")
    return [HangingIndent(Text("in turn: " + "; ".join(parts)), _INDENT)]


def _table(console: Console, headings: Sequence[str], rows: Sequence[Row]) -> NameTable:
    gap = 1 if console.width < 100 else 3
    return NameTable(headings, rows, margin=2, gap=gap, heading_style="dim")


def _metrics(
    console: Console, columns: Sequence[Column[S]], sources: Mapping[str, S], of: str = "foot"
) -> NameTable:
    """Return the metrics of feet or joints, a row each."""
    rows = [Row([printable(name)], cells_of(columns, each)) for name, each in sources.items()]
    return _table(console, (of, *headers(columns)), rows)


def _load_unit(stats: Stats) -> str:
    unit = "newtons" if stats.loads.weight_n is None else "body weights"
    return f"medians over whole stances; forces in {unit}, travel and slip in mm"


def _support(stats: Stats) -> HangingIndent:
    names = short_names([printable(foot.name) for foot in stats.feet])
    line = Text("  feet down: ", style="dim")
    if stats.support is not None:
        shares = [
            f"{number}: {share:.0%}"
            for number, share in enumerate(stats.support.feet_down)
            if share >= 0.005
        ]
        line.append(", ".join(shares) + f"  ({support_line(stats, names)})", style="default")
    else:
        line.append("not known")
    return HangingIndent(line, _INDENT)


def _load_lines(stats: Stats, walk: WalkMetrics) -> list[RenderableType]:
    loads = stats.loads
    lines: list[RenderableType] = []
    ratio = walk.forces.vertical_impulse_over_weight
    if ratio is not None:
        lines.append(_line("vertical impulse over weight", f"{ratio:.4f}  (1 is right)"))
    if walk.forces.load_share.feet is not None:
        words = [f"{name} {share:.1%}" for name, share in grouped_load(walk.forces.load_share)]
        of = "vertical impulse" if loads.share_of == "vertical_impulse" else "impulse of |F|"
        if words:
            lines.append(_line(f"share of {of}", ", ".join(words)))
    for name, of_pair in _INDICES.items():
        indices = {pair: of_pair(each) for pair, each in walk.forces.symmetry_index_percent.items()}
        words = [f"{pair} {index:+.1f} %" for pair, index in indices.items() if index is not None]
        if words:
            lines.append(_line(f"right over left, {name}", ", ".join(words)))
    margin = walk.stability.static_margin_m
    if margin is not None:
        undefined = walk.stability.undefined_fraction or 0.0
        lines.append(
            _line(
                "static margin",
                f"median {margin.median * 1e3:.0f} mm, least {margin.min * 1e3:.0f} mm, "
                f"no polygon for {undefined:.0%} of the time",
            )
        )
    return lines


def _legs(
    console: Console, feet: Mapping[str, FootRow], legs: Legs, *, verbose: bool
) -> list[RenderableType]:
    """Return the legs, if verbose their joints, too; nothing where the log tells of none."""
    parts: list[RenderableType] = []
    if any(row.leg is not None and row.leg.frame for row in feet.values()):
        parts += [
            _heading("Legs", "medians over whole strides; heights in mm"),
            _metrics(console, LEGS, feet),
        ]
    if legs.joints and verbose:
        of_legs = {name: joint for name, joint in legs.joints.items() if joint.foot}
        parts += [
            _heading("Joints", "rad and N m (m and N of those that slide)"),
            _metrics(console, JOINTS, of_legs or legs.joints, "joint"),
        ]
    lines = [_line(name, words) for name, words in work_words(legs)]
    if lines and not parts:
        parts = [_heading("Legs", "medians over whole strides")]
    return [*parts, *lines, Text()] if parts else []


def _line(name: str, value: str) -> HangingIndent:
    return HangingIndent(Text.assemble(("  " + name + ": ", "dim"), printable(value)), _INDENT)


def _base(stats: Stats) -> list[RenderableType]:
    base = stats.base
    if base is None:
        return [_line("odometry", "none that can be used")]
    path_m, seconds = base.path_length_m, base.duration_s
    speeds = [
        f"{decimal(value, 3)} m/s {name}"
        for name, value in (
            ("along the path", path_m / seconds if seconds and path_m is not None else None),
            ("forward", base.forward_speed_mps),
            ("to the left", base.lateral_speed_mps),
        )
        if value is not None
    ]
    return [
        _line(
            "path",
            f"{decimal(base.path_length_m, 3)} m, net {decimal(base.net_displacement_m, 3)} m, "
            f"turned {decimal(base.yaw_change_rad, 3)} rad",
        ),
        _line("speed", ", ".join(speeds)),
        _line("height", f"{_spread(base.height_m, 'm')}, Froude number {decimal(base.froude, 3)}"),
        _line(
            "attitude",
            f"roll {_spread(base.roll_rad, 'rad')}, pitch {_spread(base.pitch_rad, 'rad')}",
        ),
    ]


def _beside(stats: Stats, walk: WalkMetrics) -> list[RenderableType]:
    """Return the lines on commands and accelerometer of logs that have them."""
    parts: list[RenderableType] = []
    track = stats.command_track
    if track is not None:
        words = f"{printable(track.history.topic)}, means over {track.window_ns / 1e9:.2f} s"
        parts += [Text(), _heading("Commands", words)]
        parts += [_line(*line) for line in command_lines(walk.commands, track.drifts)]
    if walk.imu.topic is not None:
        parts += [Text(), _heading("Accelerometer", printable(walk.imu.topic))]
        parts += [_line(*line) for line in imu_lines(walk.imu)]
    return parts


def _first(findings: Sequence[Finding]) -> list[RenderableType]:
    """Return what to look at first, each with its remedy; nothing where nothing is grave."""
    lines: list[RenderableType] = []
    for each in first_of(findings):
        text = Text.assemble(("  " + printable(each.sentence) + ". ", "yellow"), each.remedy)
        lines.append(HangingIndent(text, _INDENT))
    return [Text(), _heading("What to look at first"), *lines] if lines else []


def _events(walk: WalkMetrics) -> list[RenderableType]:
    """Return how often each event happened, and when first; touchdowns and lift-offs left out."""
    happened = [each for each in walk.events if each.type not in STEP_EVENTS]
    if not happened:
        return []
    first = {each.type: each.onset_s for each in reversed(happened)}
    counts = Counter(each.type for each in happened)
    words = [
        f"{kind.replace('_', ' ')} {counts[kind]} (at {at:.2f} s)"
        if counts[kind] == 1
        else f"{kind.replace('_', ' ')} {counts[kind]} (first at {at:.2f} s)"
        for kind, at in sorted(first.items(), key=lambda item: item[1])
    ]
    return [
        _heading("Events", "export --table events writes all"),
        _line("happened", ", ".join(words)),
        Text(),
    ]


def _findings(findings: Sequence[Finding], *, verbose: bool) -> list[RenderableType]:
    """Return the findings, the worst first; of those with one code the first, unless verbose."""
    lines: list[RenderableType] = []
    alike = Counter(each.code for each in findings)
    for each in findings if verbose else _first_of_each(findings):
        more = "" if verbose or alike[each.code] == 1 else f" (and {alike[each.code] - 1} more)"
        lines.append(_finding(each, more))
    return lines or [Text("  nothing to complain about", style="green")]


def _first_of_each(findings: Sequence[Finding]) -> list[Finding]:
    """Return the first finding of each code."""
    return list({each.code: each for each in reversed(findings)}.values())[::-1]


def _finding(finding: Finding, more: str) -> RenderableType:
    label = f"  {finding.severity.word:<7} ", _STYLES[finding.severity]
    text = printable(finding.sentence + more)
    sentence = Text.assemble(label, text, (f"  {printable(finding.code)}", "dim"))
    return HangingIndent(sentence, len(label[0]))


def print_summary(
    console: Console, rows: Sequence[Sequence[str]], damage: Sequence[Damage] = ()
) -> None:
    """Print what was lost of which log, then a `summary_row` a log.

    Whether a log is damaged stands in the table only where some are.
    """
    for each in damage:
        if each.losses:
            print_sentence(console, (" damage  ", "red"), printable(each.line))
    is_damaged = [row[-1] != NOTHING for row in rows]
    count = len(SUMMARY_HEADERS) if any(is_damaged) else len(SUMMARY_HEADERS) - 1
    lines = [
        Row([row[0]], row[1:count], "yellow" if damaged else "")
        for row, damaged in zip(rows, is_damaged, strict=True)
    ]
    table = replace(_table(console, SUMMARY_HEADERS[:count], lines), margin=0)
    console.print(table, crop=False)


def _spread(value: Aggregate | None, unit: str) -> str:
    if value is None:
        return NOTHING
    std = "" if value.std is None else f" (sd {value.std:.3f})"
    return f"{decimal(value.mean, 3)} {unit}{std}"
