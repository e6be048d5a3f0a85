"""`stats` for people: one screen of one walk, a row each of several.

The order is that of the questions: what was read, which gait and how sure, can it be trusted and
what is wrong, how each foot walks, what the whole robot does, what happened. Numbers are those of
the metrics, which are null where a finding voids them.
"""

from collections.abc import Collection, Iterator, Sequence
from pathlib import PurePath
from typing import Any, Final

from rich.console import Console, RenderableType
from rich.text import Text

from dogbot_logtool.core.metrics import Segment, WalkMetrics
from dogbot_logtool.core.records import METRICS, MetricPath
from dogbot_logtool.core.scene.feet import foot_colour
from dogbot_logtool.finding import Finding, Severity, counted
from dogbot_logtool.io.printable import printable
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.tables import NOTHING, Column, FootRow, decimal, foot_rows, why_null
from dogbot_logtool.report.text.console import (
    HangingIndent,
    NameTable,
    Row,
    print_command,
    print_damage,
    print_sentence,
)
from dogbot_logtool.report.text.gait_diagram import ASCII, UNICODE, gait_diagram
from dogbot_logtool.report.text.subjects import SUBJECTS
from dogbot_logtool.report.verdict import (
    SUMMARY,
    Quality,
    confidence,
    contact_source,
    during,
    fall_headline,
    gait_headline,
    gait_name,
    in_words,
    main_part,
    quality_of,
)
from dogbot_logtool.results import Measurement

_MOST_WARNINGS: Final = 5
_MOST_SEGMENTS: Final = 6
_MOST_UNCHECKED: Final = 2
_WIDE: Final = 100
"""Columns of a console from which those of tables stand two apart."""
_SUBJECT: Final = 15
"""Columns of a subject's name and the blanks behind it."""
_COLOURS: Final = {"OK": "bold green", "USABLE": "bold yellow"}
_ESTIMATED: Final = "All of this table is estimated from the joints; see docs/validation.md."
_COLUMNS: Final[Sequence[Sequence[Column[FootRow]]]] = (
    (Column("contact\n%", lambda row: row.foot.contact_fraction, ".1f", 100.0),),
    (Column("stance\ns", lambda row: row.foot.stance_s, ".3f"),),
    (Column("swing\ns", lambda row: row.foot.swing_s, ".3f"),),
    (Column("duty\n", lambda row: row.foot.duty_factor, ".3f"),),
    (Column("phase\n", lambda row: row.phase.mean, ".3f"),),
    (Column("stride\nm", lambda row: row.foot.stride_length_m, ".3f"),),
    (Column("clearance\nmm", lambda row: row.foot.clearance_m, "z.0f", 1e3),),
    (Column("load\n%", lambda row: row.load_share, "z.1f", 100.0),),
    (
        Column("peak Fz\nBW", lambda row: row.foot.peak_vertical_force_bw, "z.2f"),
        Column("peak Fz\nN", lambda row: row.foot.peak_vertical_force_n, "z.0f"),
        Column("peak |F|\nBW", lambda row: row.foot.peak_force_bw, ".2f"),
        Column("peak |F|\nN", lambda row: row.foot.peak_force_n, ".0f"),
    ),
    (Column("slip\nmm", lambda row: row.foot.slip_m, ".1f", 1e3),),
)
"""The table of feet; of several choices the first that was measured is shown."""


def print_report(console: Console, measured: Measurement, *, verbose: bool = False) -> None:
    """Print the report of one log.

    Args:
        console: where to; its width decides the layout.
        measured: what was measured of it.
        verbose: print all findings, and why each null was not measured.
    """
    metrics, quality = measured.metrics, quality_of(measured)
    part = main_part(metrics)
    main = metrics if part is None else during(metrics, part)
    _print(console, _source(metrics), Text(), *_gait(console, metrics, main, part))
    colour = _COLOURS.get(quality.word, "bold red")
    _print(console, HangingIndent(Text(quality.line, style=colour), 2))
    print_damage(console, measured.damage)
    _print_warnings(console, quality, verbose=verbose)
    if metrics.feet:
        glyphs = ASCII if console.options.ascii_only else UNICODE
        diagram = gait_diagram(measured.walk, console.width - 4, glyphs=glyphs)
        _print(console, Text(), *(Text.assemble("  ", line) for line in diagram))
    _print(console, Text())
    if part is not None:
        when = f"{part.start_s:.1f} to {part.end_s:.1f} s"
        _print(console, Text(f"Longest segment: {when}, {gait_name(part.gait)}", style="bold"))
    if any(foot.contact_fraction is not None for foot in main.feet.values()):
        estimated = metrics.settings.contact_from in {"joint_torques", "kinematics"}
        note = [Text(_ESTIMATED, style="dim")] if estimated else []
        _print(console, _feet(console, main), *note, Text())
    subjects = {name: line(main) for name, line in SUBJECTS.items()}
    for name, words in (subjects | {"Not measured": _not_measured(main)}).items():
        if words:
            subject = f"{name:<{_SUBJECT}}", "bold"
            _print(console, HangingIndent(Text.assemble(subject, printable(words)), _SUBJECT))
    _print_notes(console, measured, verbose=verbose)


def _print(console: Console, *parts: RenderableType) -> None:
    # A report keeps its width where no terminal shows it.
    for each in parts:
        console.print(each, highlight=False, soft_wrap=False, crop=False)


def _source(metrics: WalkMetrics) -> HangingIndent:
    """Name the log and what it is."""
    log, robot = metrics.log, metrics.settings.robot
    duration = NOTHING if log.duration_s is None else f"{log.duration_s:.1f} s"
    facts = [log.container, duration, f"{log.messages:,} messages"]
    if robot == "generic":
        facts.append("robot not known (--robot)")
    elif robot:
        guessed = " (guessed; --robot)" if metrics.settings.robot_guessed else ""
        facts.append(f"robot {robot}{guessed}")
    words = printable(": " + ", ".join(facts))
    return HangingIndent(Text.assemble((printable(PurePath(log.path).name), "bold"), words), 2)


def _gait(
    console: Console, metrics: WalkMetrics, main: WalkMetrics, part: Segment | None
) -> Iterator[RenderableType]:
    """Yield the fall, the gait and how fast it is."""
    if fall := fall_headline(metrics):
        yield Text(fall, style="bold red")
    segments = metrics.gait.segments
    if len(segments) > 1:
        names = ", ".join(gait_name(each.gait) for each in segments[:_MOST_SEGMENTS])
        more = " ..." if len(segments) > _MOST_SEGMENTS else ""
        line = f"Gait: {names}{more}{contact_source(metrics)}"
        yield HangingIndent(Text(line, style="bold"), 2)
        yield _segments(console, segments)
        return
    yield HangingIndent(Text(printable(gait_headline(metrics)), style="bold"), 2)
    gait, speed = main.gait, main.base.forward_speed_mps
    flight, both = gait.flight_fraction or 0.0, gait.double_support_fraction
    parts = (
        "" if speed is None else f"{speed:z.3f} m/s forward",
        "" if gait.stride_frequency_hz is None else f"{gait.stride_frequency_hz:.2f} strides/s",
        "" if gait.duty_factor is None else f"duty factor {gait.duty_factor:.2f}",
        f"flight {flight:.0%}" if flight >= 0.005 else "",
        "" if both is None else f"double support {both:.0%}",
    )
    when = f" ({part.start_s:.1f} to {part.end_s:.1f} s)" if part else ""
    yield HangingIndent(Text((", ".join(filter(None, parts)) or "speed not known") + when), 2)


def _segments(console: Console, segments: Sequence[Segment]) -> NameTable:
    """Return a row for each of the first segments."""
    headings = ("time", "gait", "conf.", "m/s forward", "strides/s", "duty", "strides")
    rows = [
        Row(
            [f"{each.start_s:.1f} to {each.end_s:.1f} s"],
            [
                gait_name(each.gait),
                confidence(each.gait),
                decimal(each.base.forward_speed_mps, 3),
                decimal(each.gait.stride_frequency_hz, 2),
                decimal(each.gait.duty_factor, 2),
                str(each.gait.strides or NOTHING),
            ],
        )
        for each in segments[:_MOST_SEGMENTS]
    ]
    if len(segments) > _MOST_SEGMENTS:
        rows.append(Row([f"... {len(segments) - _MOST_SEGMENTS} more"], [""] * 6))
    return _table(console, headings, rows, left=(1, 2), margin=2)


def _table(
    console: Console, headings: Sequence[str], rows: Sequence[Row], **layout: Any  # noqa: ANN401
) -> NameTable:  # fmt: skip
    gap = 2 if console.width >= _WIDE else 1
    return NameTable(headings, rows, gap=gap, heading_style="dim", **layout)


def _print_warnings(console: Console, quality: Quality, *, verbose: bool) -> None:
    """Print each warning, what it voids and what to do about it; the worst first."""
    if verbose or quality.word == "OK":
        for check in quality.unchecked[: None if verbose else _MOST_UNCHECKED]:
            print_sentence(console, ("  not checked  ", "dim"), printable(check), indent=15)
    groups = quality.warnings
    for first, *others in groups[: None if verbose else _MOST_WARNINGS]:
        more = f" (and {len(others)} more)" if others and not verbose else ""
        for each in [first, *others] if verbose else [first]:
            _print_finding(console, each, more)
    if (hidden := len(groups) - _MOST_WARNINGS) > 0 and not verbose:
        _print(console, Text(f"  - {counted(hidden, 'more warning')} (-v)"))


def _print_finding(console: Console, finding: Finding, more: str) -> None:
    sentence = printable(finding.sentence + more), "yellow"
    print_sentence(console, "  - ", sentence, (f"  {finding.code}", "dim"), indent=4)
    voids = f"Not given: {in_words(finding.voids)}. " if finding.voids else ""
    print_sentence(console, f"    {printable(voids)}{finding.remedy}", indent=4)
    if finding.command:
        print_command(console, finding.command, 4)


def _feet(console: Console, metrics: WalkMetrics) -> NameTable:
    """Return the table of feet, without columns that no foot has."""
    sources = foot_rows(metrics)
    columns = [each for choices in _COLUMNS if (each := _measured(choices, sources.values()))]
    rows = [
        Row(
            [Text(printable(name), style=foot_colour(index))],
            [column.cell(source) for column in columns],
        )
        for index, (name, source) in enumerate(sources.items())
    ]
    return _table(console, ("foot", *(column.heading for column in columns)), rows)


def _measured(
    choices: Sequence[Column[FootRow]], feet: Collection[FootRow]
) -> Column[FootRow] | None:
    """Return the first choice for a column that was measured of some foot."""
    known = (each for each in choices if any(each.of(foot) is not None for foot in feet))
    return next(known, None)


def _not_measured(metrics: WalkMetrics) -> str:
    """Name the columns that the table of feet lacks, with the cause."""
    sources, absent = foot_rows(metrics), dict[str, list[str]]()
    for first, *others in _COLUMNS if sources else ():
        column = _measured([first, *others], sources.values())
        name = first.heading.split("\n")[0]
        if column is None or not column.heading.startswith(name):
            why = why_null(metrics, _path_of(first, next(iter(sources))))
            absent.setdefault(why, []).append(name)
    return "; ".join(f"{', '.join(names)} ({cause})" for cause, names in absent.items())


def _path_of(column: Column[FootRow], foot: str) -> MetricPath:
    """Return the path of what a column shows of a foot."""
    phase, share = METRICS.gait.phase[foot], METRICS.forces.load_share.feet
    paths: Any = METRICS.feet[foot], phase, share
    path: MetricPath = column.of(FootRow(*paths))
    return path


def _print_notes(console: Console, measured: Measurement, *, verbose: bool) -> None:
    """Print how many notes there are; if verbose all, and why each null was not measured."""
    notes = [each for each in measured.findings if each.severity is Severity.NOTE]
    if not verbose:
        if notes:
            _print(console, Text(f"{counted(len(notes), 'note')} (-v)", style="dim"))
        return
    for note in notes:
        text = printable(note.text)
        print_sentence(console, ("note  ", "dim"), text, (f"  {note.code}", "dim"), indent=6)
    metrics, causes = measured.metrics, dict[str, dict[str, None]]()
    names = [*metrics.feet, *metrics.quality.topics, *metrics.legs.joints]
    for path, cause in metrics.null_because.items():
        if not path.startswith("gait.segments."):
            name = next((each for each in names if f".{each}." in path), "*")
            causes.setdefault(cause, {})[path.replace(f".{name}.", ".*.")] = None
    if causes:
        _print(console, Text("Not measured because", style="bold"))
    for cause, paths in causes.items():
        print_sentence(console, (f"  {cause}: ", "dim"), printable(", ".join(paths)), indent=4)


def print_summary(
    console: Console, rows: Sequence[Sequence[str]], damage: Sequence[Damage] = ()
) -> None:
    """Print what was lost of which log, then a `summary_row` a log."""
    for each in damage:
        if each.losses:
            print_sentence(console, (" damage  ", "red"), printable(each.line))
    lines = [Row([row[0]], row[1:], "" if row[-2] == "OK" else "yellow") for row in rows]
    _print(console, _table(console, SUMMARY, lines, left=(1, 2, 7, 8)))
