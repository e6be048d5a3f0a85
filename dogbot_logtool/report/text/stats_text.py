"""`stats` for people: one screen of one walk, a row each of several.

The order is that of the questions: what was read, which gait and how sure, can it be trusted and
what is wrong, how each foot walks, what the whole robot does, what happened. Numbers are those of
the metrics, which are null where a finding voids them.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Final, NamedTuple

from rich.console import Console, RenderableType
from rich.text import Text

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.events.event import STEPS
from dogbot_logtool.core.metrics import Segment, WalkMetrics
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.finding import Finding, Severity, counted
from dogbot_logtool.io.printable import printable
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.numbers import NOTHING, decimal
from dogbot_logtool.report.text.console import print_command, print_damage, print_sentence
from dogbot_logtool.report.text.gait_diagram import ASCII, UNICODE, gait_diagram
from dogbot_logtool.report.text.text_layout import HangingIndent, NameTable, Row
from dogbot_logtool.report.verdict import (
    SUMMARY_HEADERS,
    Quality,
    confidence,
    contact_source,
    during,
    fall_headline,
    gait_headline,
    gait_name,
    how_sure,
    main_part,
    quality_of,
    why_null,
)
from dogbot_logtool.results import Measurement

_SHOWN_WARNINGS: Final = 5
_SHOWN_SEGMENTS: Final = 6
_SHOWN_UNCHECKED: Final = 2
_WIDE: Final = 100
"""Columns of a console from which those of tables stand two apart."""
_SUBJECT: Final = 15
"""Columns of a subject's name and the blanks behind it."""
_COLOURS: Final = {"OK": "bold green", "USABLE": "bold yellow"}
_GRAVITY: Final = 9.80665
"""m/s^2."""
_AXES: Final = ("m/s forward", "m/s to the left", "rad/s")


class _Column(NamedTuple):
    """A column of the table of feet; of several metrics the first that was measured is shown."""

    heading: str
    choices: tuple[tuple[str, str, float, int], ...]
    """(unit, metric, factor, decimals)."""


_COLUMNS: Final = (
    _Column("contact", (("%", "contact_fraction", 100.0, 1),)),
    _Column("stance", (("s", "stance_s", 1.0, 3),)),
    _Column("swing", (("s", "swing_s", 1.0, 3),)),
    _Column("duty", (("", "duty_factor", 1.0, 3),)),
    _Column("phase", (("", "phase", 1.0, 3),)),
    _Column("stride", (("m", "stride_length_m", 1.0, 3),)),
    _Column("clearance", (("mm", "clearance_m", 1e3, 0),)),
    _Column("load", (("%", "load_share", 100.0, 1),)),
    _Column(
        "peak Fz",
        (("BW", "peak_vertical_force_bw", 1.0, 2), ("N", "peak_vertical_force_n", 1.0, 0)),
    ),
    _Column("peak |F|", (("BW", "peak_force_bw", 1.0, 2), ("N", "peak_force_n", 1.0, 0))),
    _Column("slip", (("mm", "slip_m", 1e3, 1),)),
)
_ESTIMATED: Final = "All of this table is estimated from the joints; see docs/validation.md."
_INSTEAD: Final = {"peak |F|": "peak Fz"}
"""A column that is shown only where another cannot be."""


def print_report(console: Console, measured: Measurement, *, verbose: bool = False) -> None:
    """Print the report of one log.

    Args:
        console: where to; its width decides the layout.
        measured: what was measured of it.
        verbose: print all findings, and why each null was not measured.
    """
    walk, quality = measured.metrics, quality_of(measured)
    part = main_part(walk)
    shown = walk if part is None else during(walk, part)
    _print(console, _source(walk), Text(), *_gait(console, walk, shown, part))
    colour = _COLOURS.get(quality.word, "bold red")
    _print(console, HangingIndent(Text(quality.line, style=colour), 2))
    print_damage(console, measured.damage)
    _print_warnings(console, quality, verbose=verbose)
    glyphs = ASCII if console.options.ascii_only else UNICODE
    if walk.feet:
        diagram = gait_diagram(measured.walk, console.width - 4, glyphs=glyphs)
        _print(console, Text(), *(Text.assemble("  ", line) for line in diagram))
    _print(console, Text())
    if part is not None:
        when = f"{part.start_s:.1f} to {part.end_s:.1f} s"
        _print(console, Text(f"Longest segment: {when}, {gait_name(part.gait)}", style="bold"))
    if any(foot.contact_fraction is not None for foot in shown.feet.values()):
        _print(console, _feet(console, shown))
        estimated = walk.settings.contact_from in {"joint_torques", "kinematics"}
        _print(console, *([Text(_ESTIMATED, style="dim")] if estimated else []), Text())
    for name, line in _SUBJECTS.items():
        if words := line(shown):
            subject = f"{name:<{_SUBJECT}}", "bold"
            _print(console, HangingIndent(Text.assemble(subject, printable(words)), _SUBJECT))
    track = measured.walk.command_track
    for name, drift in track.drifts.items() if verbose and track else ():
        parts = zip(drift.tolist(), _AXES, strict=True)
        words = ", ".join(f"{round(value, 3) + 0.0:+.3f} {unit}" for value, unit in parts)
        _print(console, Text(f"{'Drift':<{_SUBJECT}}{name}: {words}"))
    _print_notes(console, measured, verbose=verbose)


def _print(console: Console, *parts: RenderableType) -> None:
    # A report keeps its width where no terminal shows it.
    for each in parts:
        console.print(each, highlight=False, soft_wrap=False, crop=False)


def _source(walk: WalkMetrics) -> HangingIndent:
    """Name the log and what it is."""
    log, robot = walk.log, walk.settings.robot
    duration = NOTHING if log.duration_s is None else f"{log.duration_s:.1f} s"
    facts = [log.container, duration, f"{log.messages:,} messages"]
    if robot and robot != "generic":
        guessed = " (guessed; --robot)" if walk.settings.robot_guessed else ""
        facts.append(f"robot {robot}{guessed}")
    elif robot:
        facts.append("robot not known (--robot)")
    words = printable(": " + ", ".join(facts))
    return HangingIndent(Text.assemble((printable(PurePath(log.path).name), "bold"), words), 2)


# The gait, and whether the log can be trusted


def _gait(
    console: Console, walk: WalkMetrics, shown: WalkMetrics, part: Segment | None
) -> Iterator[RenderableType]:
    """Yield the fall, the gait and how fast it is."""
    fall = fall_headline(walk)
    if fall:
        yield Text(fall, style="bold red")
    if len(walk.gait.segments) > 1:
        names = [gait_name(each.gait) for each in walk.gait.segments]
        more = " ..." if len(names) > _SHOWN_SEGMENTS else ""
        line = f"Gait: {', '.join(names[:_SHOWN_SEGMENTS])}{more}{contact_source(walk)}"
        yield HangingIndent(Text(line, style="bold"), 2)
        yield _segments(console, walk.gait.segments)
        return
    yield HangingIndent(Text(printable(gait_headline(walk)), style="bold"), 2)
    gait, base = shown.gait, shown.base
    flight, both = gait.flight_fraction, gait.double_support_fraction
    parts = [
        _with_unit(base.forward_speed_mps, 3, " m/s forward"),
        _with_unit(gait.stride_frequency_hz, 2, " strides/s"),
        "" if gait.duty_factor is None else f"duty factor {gait.duty_factor:.2f}",
        f"flight {flight:.0%}" if flight and flight >= 0.005 else "",
        "" if both is None else f"double support {both:.0%}",
    ]
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
                confidence(each.gait) if how_sure(each.gait) else NOTHING,
                decimal(each.base.forward_speed_mps, 3),
                decimal(each.gait.stride_frequency_hz, 2),
                decimal(each.gait.duty_factor, 2),
                str(each.gait.strides or NOTHING),
            ],
        )
        for each in segments[:_SHOWN_SEGMENTS]
    ]
    if len(segments) > _SHOWN_SEGMENTS:
        rows.append(Row([f"... {len(segments) - _SHOWN_SEGMENTS} more"], [""] * 6))
    return _table(console, headings, rows, left=(1, 2), margin=2)


def _table(
    console: Console,
    headings: Sequence[str],
    rows: Sequence[Row],
    left: Sequence[int] = (),
    margin: int = 0,
) -> NameTable:
    gap = 2 if console.width >= _WIDE else 1
    return NameTable(headings, rows, left, margin=margin, gap=gap, heading_style="dim")


def _print_warnings(console: Console, quality: Quality, *, verbose: bool) -> None:
    """Print each warning, what it voids and what to do about it; the worst first."""
    if verbose or quality.word == "OK":
        for check in quality.unchecked[: None if verbose else _SHOWN_UNCHECKED]:
            print_sentence(console, ("  not checked  ", "dim"), printable(check), indent=15)
    groups = quality.warnings
    for first, *others in groups[: None if verbose else _SHOWN_WARNINGS]:
        more = f" (and {len(others)} more)" if others and not verbose else ""
        for each in [first, *others] if verbose else [first]:
            _print_finding(console, each, more)
    if (hidden := len(groups) - _SHOWN_WARNINGS) > 0 and not verbose:
        _print(console, Text(f"  - {counted(hidden, 'more warning')} (-v)"))


def _print_finding(console: Console, finding: Finding, more: str) -> None:
    sentence = printable(finding.sentence + more), "yellow"
    print_sentence(console, "  - ", sentence, (f"  {finding.code}", "dim"), indent=4)
    voids = f"Not given: {in_words(finding.voids)}. " if finding.voids else ""
    print_sentence(console, f"    {printable(voids)}{finding.remedy}", indent=4)
    if finding.command:
        print_command(console, finding.command, 4)


def in_words(patterns: Sequence[str]) -> str:
    """Name the metrics that patterns stand for."""
    words = []
    for pattern in patterns:
        group, _, rest = pattern.partition(".")
        if group == "feet":
            foot, _, metric = rest.partition(".")
            what = _without_unit(metric)
            whose = "" if foot in {"*", ""} else f" of {foot}"
            words.append(f"{what or 'all'}{whose}" if whose or what else "feet")
        elif rest != "confidence":
            words.append(group if rest in {"*", "name"} else _without_unit(rest))
    return ", ".join(dict.fromkeys(words))


def _without_unit(key: str) -> str:
    for unit in ("_m", "_n", "_bw", "_s", "_mps", "_fraction"):
        key = key.strip("*").rstrip("._").removesuffix(unit)
    return key.replace("_", " ").replace(".*", "").replace(".", " ")


# How each foot walks


def _of_foot(walk: WalkMetrics, name: str, metric: str) -> float | None:
    """Return a metric of a foot: a number, or the median of an aggregate."""
    if metric == "phase":
        return walk.gait.phase[name].mean if name in walk.gait.phase else None
    if metric == "load_share":
        return (walk.forces.load_share.feet or {}).get(name)
    value: Aggregate | float | None = getattr(walk.feet[name], metric)
    return value.median if isinstance(value, Aggregate) else value


def _feet(console: Console, walk: WalkMetrics) -> NameTable:
    """Return the table of feet, without columns that no foot has."""
    columns: dict[str, list[str]] = {}
    for column in _COLUMNS:
        if any(each.startswith(_INSTEAD.get(column.heading, "\n")) for each in columns):
            continue
        for unit, metric, factor, decimals in column.choices:
            numbers = [_of_foot(walk, name, metric) for name in walk.feet]
            if any(number is not None for number in numbers):
                columns[f"{column.heading}\n{unit}"] = [
                    decimal(number and number * factor, decimals) for number in numbers
                ]
                break
    rows = [
        Row(
            [Text(printable(name), style=foot_colour(index))],
            [each[index] for each in columns.values()],
        )
        for index, name in enumerate(walk.feet)
    ]
    return _table(console, ("foot", *columns), rows)


# What the whole robot does


def _support(walk: WalkMetrics) -> str:
    shares = {int(number): share for number, share in (walk.gait.support or {}).items()}
    words = [
        f"{number} {'foot' if number == 1 else 'feet'} {share:.0%}"
        for number, share in shares.items()
        if share >= 0.005
    ]
    if words:
        return ", ".join(words) + " of the time"
    unknown = walk.feet and "gait.support" in walk.null_because
    return f"not known: {why_null(walk, 'gait.support')}" if unknown else ""


def _stability(walk: WalkMetrics) -> str:
    stability = walk.stability
    margin = stability.static_margin_m
    if margin is None:
        return ""
    known = 1.0 - (stability.unknown_fraction or 0.0)
    defined = known - (stability.undefined_fraction or 0.0)
    when = f"; defined {defined:.0%} of the time" if defined < 0.995 else ""
    median, least = (f"{value * 1e3:.0f} mm" for value in (margin.median, margin.min))
    return f"static margin {median} (median), min {least}{when}"


def _load_check(walk: WalkMetrics) -> str:
    ratio, weight = walk.forces.vertical_impulse_over_weight, walk.settings.body_weight_n
    if ratio is not None:
        mass = walk.settings.mass_kg
        of = "" if mass is None else f" ({mass:.1f} kg)"
        return f"the feet carry {ratio:.1%} of the body weight{of}"
    if all(foot.peak_force_n is None for foot in walk.feet.values()):
        return ""
    kg = "" if weight is None else f"{weight:.0f} N ({weight / _GRAVITY:.1f} kg)"
    carried = f"; the feet carry {kg} on average" if kg else ""
    return f"not made: {why_null(walk, 'forces.vertical_impulse_over_weight')}{carried}"


def _base(walk: WalkMetrics) -> str:
    base = walk.base
    if base.path_length_m is None:
        return f"not measured: {why_null(walk, 'base.path_length_m')}"
    turn = math.degrees(base.yaw_change_rad or 0.0)
    parts = [
        f"{base.path_length_m:.2f} m travelled",
        f"turned {turn:.0f} deg" if abs(turn) > 3.0 else "",
        f"height {base.height_m.median:.3f} m" if base.height_m else "",
        _angle("roll", base.roll_rad),
        _angle("pitch", base.pitch_rad),
    ]
    legs = " (estimated: by the legs)" if walk.settings.base_from == "legs" else ""
    return ", ".join(filter(None, parts)) + legs


def _angle(name: str, angle: Aggregate | None) -> str:
    if angle is None:
        return ""
    spread = "" if angle.std is None else f" (sd {decimal(math.degrees(angle.std), 1)})"
    return f"{name} {decimal(math.degrees(angle.median), 1)} deg{spread}"


def _energy(walk: WalkMetrics) -> str:
    work, cost = walk.legs.absolute_work_j, walk.legs.mechanical_cost_of_transport
    parts = [
        "" if work is None else f"{work.median:.1f} J of joint work a stride",
        "" if cost is None else f"mechanical cost of transport {cost:.2f}",
    ]
    return ", ".join(filter(None, parts))


def _commands(walk: WalkMetrics) -> str:
    commands = walk.commands
    errors = [
        _with_unit(commands.forward.rms_error_mps, 2, " m/s forward"),
        _with_unit(commands.lateral.rms_error_mps, 2, " m/s sideways"),
        _with_unit(commands.yaw.rms_error_radps, 2, " rad/s"),
    ]
    known = ", ".join(filter(None, errors))
    return f"{commands.topic}: RMS error {known}" if known else ""


def _accelerometer(walk: WalkMetrics) -> str:
    imu, ratio = walk.imu, walk.imu.forces_over_accelerometer
    parts = [
        _with_unit(imu.accelerometer_mps2, 2, " m/s^2 over strides"),
        "" if imu.tilt_rad is None else f"tilt {math.degrees(imu.tilt_rad):.1f} deg",
        "" if ratio is None else f"the forces are {ratio:.1%} of mass x acceleration",
    ]
    known = ", ".join(filter(None, parts))
    return f"{imu.topic}: {known}" if known else ""


def _events(walk: WalkMetrics) -> str:
    times: dict[str, list[float]] = {}
    for each in walk.events:
        if each.type not in STEPS:
            times.setdefault(each.type.replace("_", " "), []).append(each.onset_s)
    kinds = [
        f"{kind} at {at[0]:.1f} s"
        if len(at) == 1
        else f"{len(at)} x {kind}, first at {at[0]:.1f} s"
        for kind, at in times.items()
    ]
    what = ", ".join(kinds) or "none"
    steps = sum(each.type in STEPS for each in walk.events)
    return f"{what}; {steps} touchdowns and lift-offs (export --table events)" if steps else what


def _not_measured(walk: WalkMetrics) -> str:
    """Name the columns that the table of feet lacks, with the cause."""
    absent: dict[str, list[str]] = {}
    for column in _COLUMNS:
        metrics = [metric for _, metric, *_ in column.choices]
        found = [_of_foot(walk, name, metric) for name in walk.feet for metric in metrics]
        if found and column.heading not in _INSTEAD and set(found) == {None}:
            paths = {"phase": "gait.name", "load_share": "forces.load_share.feet"}
            path = paths.get(metrics[-1], f"feet.{next(iter(walk.feet))}.{metrics[-1]}")
            absent.setdefault(why_null(walk, path), []).append(column.heading)
    return "; ".join(f"{', '.join(names)} ({cause})" for cause, names in absent.items())


def _with_unit(number: float | None, decimals: int, unit: str) -> str:
    return "" if number is None else f"{decimal(number, decimals)}{unit}"


_SUBJECTS: Final[Mapping[str, Callable[[WalkMetrics], str]]] = {
    "Support": _support,
    "Stability": _stability,
    "Load check": _load_check,
    "Base": _base,
    "Energy": _energy,
    "Commands": _commands,
    "Accelerometer": _accelerometer,
    "Events": _events,
    "Not measured": _not_measured,
}


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
    causes: dict[str, dict[str, None]] = {}
    for path, cause in measured.metrics.null_because.items():
        if not path.startswith("gait.segments."):
            causes.setdefault(cause, {})[_folded(measured.metrics, path)] = None
    if causes:
        _print(console, Text("Not measured because", style="bold"))
    for cause, paths in causes.items():
        print_sentence(console, (f"  {cause}: ", "dim"), printable(", ".join(paths)), indent=4)


def _folded(walk: WalkMetrics, path: str) -> str:
    """Return a path with a star for the name of a foot, joint or topic."""
    groups: dict[str, Iterable[str]] = {
        "feet": walk.feet,
        "gait.phase": walk.feet,
        "quality.feet": walk.feet,
        "quality.topics": walk.quality.topics,
        "legs.joints": walk.legs.joints,
    }
    for group, names in groups.items():
        for name in names:
            if path.startswith(f"{group}.{name}."):
                return f"{group}.*{path.removeprefix(f'{group}.{name}')}"
    return path


# Several logs


def print_summary(
    console: Console, rows: Sequence[Sequence[str]], damage: Sequence[Damage] = ()
) -> None:
    """Print what was lost of which log, then a `summary_row` a log."""
    for each in damage:
        if each.losses:
            print_sentence(console, (" damage  ", "red"), printable(each.line))
    lines = [Row([row[0]], row[1:], "" if row[-2] == "OK" else "yellow") for row in rows]
    _print(console, _table(console, SUMMARY_HEADERS, lines, left=(1, 2, 7, 8)))
