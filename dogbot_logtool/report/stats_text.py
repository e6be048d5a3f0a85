"""The figures of `stats` for people: the verdict first, then the feet, loads, and what to doubt."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from dogbot_logtool.core.gait.gait import STAND
from dogbot_logtool.core.geometry.aggregates import Aggregate
from dogbot_logtool.core.load.load_figures import grouped_shares
from dogbot_logtool.core.remarks import remarks
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.console import print_command
from dogbot_logtool.report.foot_pens import short_names
from dogbot_logtool.report.gait_diagram import (
    ASCII,
    UNICODE,
    default_window,
    gait_diagram,
    support_line,
)
from dogbot_logtool.report.numbers import NOTHING, decimal, percent
from dogbot_logtool.report.stats_json import symmetry
from dogbot_logtool.report.text_layout import Hanging, NameTable, Row
from dogbot_logtool.report.verdict import evidence, gait_name, how_sure, is_known
from dogbot_logtool.results import LogFacts

_STEPS: Final = (
    "foot",
    "contact",
    "strides",
    "stance s",
    "swing s",
    "duty",
    "phase",
    "R",
    "length m",
)
_LOADS: Final = (
    "foot",
    "share",
    "peak |F|",
    "mean |F|",
    "peak Fz",
    "impact",
    "friction",
    "travel",
    "slip",
)
_SUMMARY: Final = (
    "log",
    "gait",
    "duty",
    "strides/s",
    "m/s",
    "impulse/weight",
    "warnings",
    "damage",
)
_INDENT: Final = 4
"""Of the further lines of what does not fit one."""
_SEVERITIES: Final[Mapping[str, tuple[str, str]]] = {
    "E": ("error", "bold red"),
    "W": ("warning", "yellow"),
    "N": ("note", "dim"),
}


def print_report(
    console: Console,
    stats: Stats,
    log: LogFacts,
    *,
    window: tuple[float, float] | None = None,
    verbose: bool = False,
) -> None:
    """Print the report of one log.

    Args:
        console: where to; its width decides the layout.
        stats: figures of the log.
        log: what the reader knows of it.
        window: s since the log's start, from and to, of the gait diagram; None chooses one.
        verbose: say also what is merely good to know, foot by foot.
    """
    glyphs = ASCII if console.options.ascii_only else UNICODE
    start, end = window or default_window(stats)
    diagram = gait_diagram(stats, console.width - 2, window=(start, end), glyphs=glyphs)
    legend = "filled: foot down"
    if any(glyphs.unknown in line.plain for line in diagram):
        legend += f"; {glyphs.unknown}: not known"
    parts: list[RenderableType] = [
        _title(log),
        Text(),
        verdict(stats),
        *_segments(stats),
        Text(),
        _heading("Gait diagram", f"{start:.2f} to {end:.2f} s; {legend}"),
        Padding(Group(*diagram), (0, 0, 0, 2), expand=False),
        Text(),
        _heading("Steps", "medians over whole strides"),
        _steps(console, stats),
        _support(stats),
        Text(),
        _heading("Loads", _load_unit(stats)),
        _loads(console, stats),
        *_load_lines(stats),
        Text(),
        _heading("Base"),
        *_base(stats),
        Text(),
        _heading("Findings"),
        *_findings([*remarks(stats), *log.findings], log, verbose=verbose),
    ]
    # A report keeps its width where no terminal shows it.
    console.print(Group(*parts), highlight=False, soft_wrap=False, crop=False)
    for each in log.findings:
        if isinstance(each, Finding) and each.command:
            print_command(console, each.command, 2)


def _title(log: LogFacts) -> Hanging:
    duration = NOTHING if log.duration_s is None else f"{log.duration_s:.2f} s"
    facts = f"  {log.container}, {duration}, {log.messages} messages"
    return Hanging(Text.assemble((printable(log.path), "bold"), facts), 2)


def _heading(words: str, aside: str = "") -> Text:
    return Text.assemble((words, "bold"), (f"  {aside}" if aside else "", "dim"))


def verdict(stats: Stats) -> Text:
    """Say in a line or two which gait it is, and how sure that is."""
    main = stats.main
    if main is None:
        return Text("Gait not known: no foot makes a whole stride.", style="bold yellow")
    if main.gait.name == STAND:
        extent = "throughout" if len(stats.segments) == 1 else "for the longest time"
        return Text.assemble(("Stand", "bold green"), f": all feet are down {extent}.")
    style = "bold green" if is_known(stats) else "bold yellow"
    sure = how_sure(main)
    line = Text.assemble((gait_name(main), style), f", {sure}" if sure else "")
    line.append(f"\n{evidence(main)}")
    if main.duty_factor is not None:
        kind = "running" if main.duty_factor < 0.5 else "not running"
        line.append(f"\nduty factor {main.duty_factor:.3f} ({kind})")
    if main.stride_frequency_hz is not None:
        line.append(f", {main.stride_frequency_hz:.3f} strides a second")
    if stats.base is not None and stats.base.forward_speed_mps is not None:
        line.append(f", {stats.base.forward_speed_mps:.3f} m/s forward")
    return line


def _segments(stats: Stats) -> list[RenderableType]:
    if len(stats.segments) < 2:
        return []
    parts = []
    for segment in stats.segments:
        start, end = (each / 1e9 for each in (segment.spans[0] - stats.origin).tolist())
        frequency = segment.stride_frequency_hz
        pace = "" if frequency is None else f", {frequency:.2f} strides/s"
        parts.append(f"{start:.1f}-{end:.1f} s {gait_name(segment).lower()}{pace}")
    return [Hanging(Text("in turn: " + "; ".join(parts)), _INDENT)]


def _table(console: Console, headings: Sequence[str], rows: Sequence[Row]) -> NameTable:
    gap = 1 if console.width < 100 else 3
    return NameTable(headings, rows, margin=2, gap=gap, heading_style="dim")


def _steps(console: Console, stats: Stats) -> NameTable:
    rows = []
    for number, foot in enumerate(stats.feet):
        phase = stats.main.phases[number] if stats.main else None
        cells = [
            percent(foot.contact_fraction),
            str(len(foot.strides.stance)),
            _median(foot.stance_s, 3),
            _median(foot.swing_s, 3),
            _median(foot.duty_factor, 3),
            NOTHING if phase is None else f"{phase.mean:.3f}",
            NOTHING if phase is None else f"{phase.consistency:.2f}",
            _median(foot.stride_length_m, 3),
        ]
        rows.append(Row([printable(foot.name)], cells))
    return _table(console, _STEPS, rows)


def _loads(console: Console, stats: Stats) -> NameTable:
    weight = stats.settings.body_weight_n
    rows = []
    for number, foot in enumerate(stats.feet):
        share = stats.loads.shares[number] if stats.loads.shares else None
        cells = [
            percent(share),
            _force(foot.peak_force_n, weight),
            _force(foot.mean_force_n, weight),
            _force(foot.peak_vertical_force_n, weight),
            _median(foot.impact_ratio, 2),
            _median(foot.friction_use, 2),
            _millimetres(foot.contact_travel_m),
            _millimetres(foot.slip_distance_m),
        ]
        rows.append(Row([printable(foot.name)], cells))
    return _table(console, _LOADS, rows)


def _load_unit(stats: Stats) -> str:
    unit = "newtons" if stats.settings.body_weight_n is None else "body weights"
    return f"medians over whole stances; forces in {unit}, travel and slip in mm"


def _support(stats: Stats) -> Hanging:
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
    return Hanging(line, _INDENT)


def _load_lines(stats: Stats) -> list[RenderableType]:
    loads = stats.loads
    lines: list[RenderableType] = []
    if loads.vertical_impulse_over_weight is not None:
        ratio = loads.vertical_impulse_over_weight
        lines.append(_line("vertical impulse over weight", f"{ratio:.4f}  (1 is right)"))
    if loads.shares is not None:
        grouped = grouped_shares(loads.shares, [foot.place for foot in stats.feet])
        words = [f"{name} {share:.1%}" for name, share in grouped.items() if share is not None]
        of = "vertical impulse" if loads.share_of == "vertical_impulse" else "impulse of |F|"
        if words:
            lines.append(_line(f"share of {of}", ", ".join(words)))
    indices = symmetry(stats)
    if indices is not None:
        words = [
            f"{pair} {value:+.1f} %"
            for pair, index in indices.items()
            if (value := index["peak_force_n"]) is not None
        ]
        duty = [
            f"{pair} {value:+.1f} %"
            for pair, index in indices.items()
            if (value := index["duty_factor"]) is not None
        ]
        if words:
            lines.append(_line("right over left, peak force", ", ".join(words)))
        if duty:
            lines.append(_line("right over left, duty factor", ", ".join(duty)))
    stability = stats.stability
    if stability is not None and stability.static_margin_m is not None:
        margin = stability.static_margin_m
        lines.append(
            _line(
                "static margin",
                f"median {margin.median * 1e3:.0f} mm, least {margin.min * 1e3:.0f} mm, "
                f"no polygon for {stability.undefined_fraction or 0.0:.0%} of the time",
            )
        )
    return lines


def _line(name: str, value: str) -> Hanging:
    return Hanging(Text.assemble(("  " + name + ": ", "dim"), printable(value)), _INDENT)


def _base(stats: Stats) -> list[RenderableType]:
    base = stats.base
    if base is None:
        return [_line("odometry", "none that can be used")]
    speeds = [
        f"{decimal(value, 3)} m/s {name}"
        for name, value in (
            ("along the path", base.mean_speed_mps),
            ("forward", base.forward_speed_mps),
            ("to the left", base.lateral_speed_mps),
        )
        if value is not None
    ]
    return [
        _line(
            "path",
            f"{base.path_length_m:.3f} m, net {base.net_displacement_m:.3f} m, "
            f"turned {decimal(base.yaw_change_rad, 3)} rad",
        ),
        _line("speed", ", ".join(speeds)),
        _line("height", f"{_spread(base.height_m, 'm')}, Froude number {decimal(base.froude, 3)}"),
        _line(
            "attitude",
            f"roll {_spread(base.roll_rad, 'rad')}, pitch {_spread(base.pitch_rad, 'rad')}",
        ),
    ]


def _findings(said: Sequence[Finding], log: LogFacts, *, verbose: bool) -> list[RenderableType]:
    """Sentences by severity; what holds for several feet is said once."""
    lines: list[RenderableType] = []
    if log.lost_messages != 0 or log.lost_bytes:
        lost = "an unknown number of" if log.lost_messages is None else str(log.lost_messages)
        text = f"{lost} messages and {log.lost_bytes} bytes of the log could not be read"
        lines.append(_finding("W_LOST", text))
    ordered = sorted(said, key=lambda one: "EWN".index(one.code[:1]))
    alike = Counter(each.code for each in ordered)
    for each in ordered if verbose else _first_of_each(ordered):
        more = "" if verbose or alike[each.code] == 1 else f" (and {alike[each.code] - 1} more)"
        text = each.sentence if isinstance(each, Finding) else each.text
        lines.append(_finding(each.code, text + more))
    return lines or [Text("  nothing to complain about", style="green")]


def _first_of_each(said: Sequence[Finding]) -> list[Finding]:
    """Return the first sentence of each code."""
    return list({each.code: each for each in reversed(said)}.values())[::-1]


def _finding(code: str, text: str) -> RenderableType:
    word, style = _SEVERITIES.get(code[:1], _SEVERITIES["N"])
    label = f"  {word:<7} "
    sentence = Text.assemble((label, style), printable(text), (f"  {printable(code)}", "dim"))
    return Hanging(sentence, len(label))


def print_summary(console: Console, rows: Sequence[Sequence[str]]) -> None:
    """Print a `summary_row` a log; whether it is damaged only where some are."""
    is_damaged = [row[-1] != NOTHING for row in rows]
    count = len(_SUMMARY) if any(is_damaged) else len(_SUMMARY) - 1
    lines = [
        Row([row[0]], row[1:count], "yellow" if damaged else "")
        for row, damaged in zip(rows, is_damaged, strict=True)
    ]
    table = replace(_table(console, _SUMMARY[:count], lines), margin=0)
    console.print(table, crop=False)


def _median(value: Aggregate | None, decimals: int) -> str:
    return decimal(value.median if value else None, decimals)


def _force(value: Aggregate | None, weight_n: float | None) -> str:
    if value is None:
        return NOTHING
    return f"{value.median:.1f}" if weight_n is None else f"{value.median / weight_n:.2f}"


def _millimetres(value: Aggregate | None) -> str:
    return NOTHING if value is None else f"{value.median * 1e3:.1f}"


def _spread(value: Aggregate | None, unit: str) -> str:
    if value is None:
        return NOTHING
    std = "" if value.std is None else f" (sd {value.std:.3f})"
    return f"{decimal(value.mean, 3)} {unit}{std}"
