"""One score of fields that may be feet: their names, their rate and what they read; and offers.

Each thing that speaks for or against them is a mark: points, and a reason for people. What may be
feet is offered with the command that takes it.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, median_of, norms, percentiles_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined, shell_quoted
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.names import FootSet, Mark
from dogbot_logtool.robot.words import MERITS, Part, parts_of, texts_of, word_set

CONTACT_WORDS: Final = word_set("contact contacts grf stance touch touches ground")
FORCE_WORDS: Final = word_set(
    "cell effort force forces fsr ft fz load loadcell loadcells loads pressure torque weight "
    "wrench wrenches"
)
_OTHER_PART: Final = 4
"""Points that a name costs which speaks of something else beside a foot."""
_NEVER: Final = 20
"""Points of what cannot be feet: nothing can outweigh it."""
_SLOW_HZ, _FAST_HZ = 5.0, 20.0
_USUAL_FEET: Final = (2, 4, 6, 8)
_FEWEST: Final = 8
"""Samples of a foot from which its values mean something; some are sent on change only."""
_LARGEST_STATE: Final = 3.0
"""Whole numbers up to this are states of a contact: open, closed, slipping."""
_FEWEST_DOWN: Final = 0.8
"""Share of the time in which at least one foot of a walking robot is down."""
_SAME: Final = 0.98
"""Share of the time from which two feet that agree are one signal."""
_STEADY: Final = 0.25
"""Largest spread of the sum of all loads, as a share of its mean."""
_UNSTEADY: Final = 1.5
"""Each foot's spread is at least so many times that of the sum."""
_BOTH_DIRECTIONS: Final = 0.5
"""Share of the larger that the smaller of push and pull is, from which a number is no load."""
_NOT_UNLOADED: Final = 0.5
"""Share of what each foot reads with load that it reads without, from which numbers are no forces:
those of air pressure, or of a sensor that was never set to zero."""
_TENTH: Final = (10.0, 90.0)
"""Percentiles of what a foot reads without and with load."""
_ENDS: Final = (2.0, 98.0)
"""The same of feet that are hardly ever in the air."""
_ON: Final = 0.2
"""Share of the way between them from which it is on; with all feet down each bears little."""
_ALTERNATIVES: Final = 3
"""Sets of topics that are offered beside the most likely one."""


def name_marks(names: Collection[str], type_name: str, rate_hz: float | None) -> Iterator[Mark]:
    """Judge names of fields, with their topics, of the type of their messages, and their rate."""
    parts, texts = parts_of(names), texts_of(*names, type_name)
    if parts & {Part.FOOT, Part.LEG}:
        yield 2, "the names speak of feet or legs"
    if Part.NOT_A_FOOT in parts:
        # Hands, wheels, tools ...
        yield (-_OTHER_PART if parts & {Part.FOOT, Part.LEG} else -_NEVER), ""
    if texts & (CONTACT_WORDS | FORCE_WORDS):
        yield 1, "of contact or force"
    merit = min((MERITS.get(text, 0) for text in texts), default=0)
    if merit < -1:
        yield merit, "they are named as planned or set, not measured"
    if rate_hz is not None:
        points = 1 if rate_hz >= _FAST_HZ else -2 if rate_hz < _SLOW_HZ else 0
        yield points, f"{rate_hz:.0f} messages a second"


def with_content(named: FootSet, feet: Sequence[Samples]) -> FootSet | None:
    """Judge also by the values, which were read as forces; None: too few were seen.

    Args:
        named: fields, judged by their names.
        feet: samples of the first fields by log time; messages do not have the others.
    """
    if min((len(each.log_time) for each in feet), default=0) < _FEWEST:
        return None
    signed = _side_by_side(feet)
    values = np.abs(signed)
    are_states = bool((values <= _LARGEST_STATE).all() and (values == np.round(values)).all())
    low, high = percentiles_of(values, _TENTH, axis=0)
    down = values > 0.0 if are_states else values > low + _ON * (high - low)
    marks = [*_in_time(down), *(() if are_states else _of_loads(signed))]
    if sum(points for points, _ in marks) <= 0:
        marks.append((-_NEVER, "no foot reads so"))
    thresholds, is_contact = [0.0] * len(feet), are_states
    is_number = not are_states and not any(each.force[:, :2].any() for each in feet)
    low, high = percentiles_of(values, _ENDS, axis=0)
    if is_number and bool((signed > 0.0).all()) and bool((low > _NOT_UNLOADED * high).all()):
        thresholds, is_contact = (low + _ON * (high - low)).tolist(), True
        marks.append((0, "none reads near zero without load: they tell contact, not newtons"))
    marks.append((1 if len(feet) in _USUAL_FEET else -1, ""))
    kind = "contact" if is_contact else "force"
    told = []
    for foot, threshold in zip(named.feet, thresholds, strict=False):
        if foot.field:
            # It is said only where the type of the field would say something else.
            said = "" if kind == (foot.field.kind or "force") else kind
            told.append(replace(foot, field=replace(foot.field, kind=said, threshold=threshold)))
    return replace(named, feet=tuple(told), marks=(*named.marks, *marks))


def _side_by_side(feet: Sequence[Samples]) -> Floats:
    """Return (n, feet) at the samples of all feet: numbers with their sign, or magnitudes."""
    time = np.unique(np.concatenate([each.log_time for each in feet]))
    columns = []
    for each in feet:
        before = np.searchsorted(each.log_time, time, side="right") - 1
        column = norms(each.force) if each.force[:, :2].any() else each.force[:, 2]
        columns.append(column[np.maximum(before, 0)])
    return np.stack(columns, axis=1)


def _in_time(down: Flags) -> Iterator[Mark]:
    """Judge when feet are on, (n, feet): each on and off, and in turns."""
    feet = down.shape[1]
    changes = np.count_nonzero(np.diff(down, axis=0), axis=0)
    stepping = np.count_nonzero(changes > 1)
    if stepping == feet:
        yield 2, f"all {feet} go on and off, {changes.min()} times and more"
    else:
        yield (-1 if stepping else -3), f"only {stepping} of {feet} go on and off"
    alike = [(down[:, i] == down[:, k]).mean() for i in range(feet) for k in range(i)]
    some, every = float(down.any(axis=1).mean()), float(down.all(axis=1).mean())
    if not alike or min(alike) > _SAME:
        yield -2, "all are the same signal"
    elif some >= _FEWEST_DOWN and every < some:
        yield 2, f"in turns: at least one is on {some:.0%} of the time, all at once {every:.0%}"
    else:
        yield 0, f"at least one is on {some:.0%} of the time"


def _of_loads(signed: Floats) -> Iterator[Mark]:
    """Judge loads, (n, feet): together they are a weight, and the ground does not pull."""
    values = np.abs(signed)
    total = values.sum(axis=1)
    if (mean := float(total.mean())) > 0.0:
        spread = float(total.std()) / mean
        own = float(median_of(values.std(axis=0) / np.maximum(values.mean(axis=0), 1e-12)))
        if spread <= _STEADY and own >= _UNSTEADY * spread:
            yield 3, f"together they stay within {spread:.0%} of {mean:.4g}, as a weight does"
        else:
            yield 0, f"their sum varies by {spread:.0%}"
    low, high = percentiles_of(signed, _TENTH, axis=0)
    smaller, larger = np.minimum(-low, high), np.maximum(-low, high)
    if ((low < 0.0) & (high > 0.0) & (smaller > _BOTH_DIRECTIONS * larger)).any():
        yield -_NEVER, ""


# --- offers --------------------------------------------------------------------------------------


def topics_finding(sets: Sequence[FootSet], call: str) -> Finding:
    """Return which topics may be feet, and the command that chooses them.

    Args:
        sets: at least one, the most likely first.
        call: a call of `stats` without the feet.
    """
    first, *others = sets
    which = ", ".join(f"{foot.name} = {foot.topic}" for foot in first.feet)
    which += f"; or {alternatives(others)}" if others else ""
    if len(others) > _ALTERNATIVES:
        which += f" or {len(others) - _ALTERNATIVES} other sets of topics"
    command = f"{call} {alternatives([first])}"
    return replace(found("FEET_UNSURE", say="topics", which=which, call=command), command=command)


def alternatives(sets: Sequence[FootSet]) -> str:
    """Return the words for a shell that choose the first of some sets."""
    return " or ".join(foot_options(one.feet) for one in sets[:_ALTERNATIVES])


def foot_options(feet: Iterable[Foot]) -> str:
    """Return the words for a shell that name some feet."""
    return " ".join(f"--foot {foot.name}={shell_quoted(foot.word)}" for foot in feet)


def candidates_finding(log: Log, sets: Sequence[FootSet], call: str, base: str) -> Finding:
    """Return which fields may be feet, why, and the command that measures with them.

    Args:
        log: the log.
        sets: what `find_candidates` finds, at least one.
        call: a call of `stats` without the feet.
        base: poses that may be the base's, as ``--odom-topic`` takes them; empty: none.
    """
    told = "; or ".join(f"{o.fields} ({o.points} points: {o.reasons})" for o in sets[:3])
    feet = sets[0].feet
    if any(foot.leg_position is None for foot in feet):
        told += "; which leg each is, they do not say: put front_left, back_right ... for "
        told += f"{feet[0].name} and the others, and gaits have names"
    file = f"{PurePath(log.words[0]).stem}.toml"
    chosen = ["--odom-topic", base] if base else []
    draft = shell_joined(["dogbot-logtool", "robots", "new", *log.words, *chosen, "-o", file])
    # What fields are, and of which foot, can only be said in a robot's file.
    needs_file = any((foot.field and foot.field.kind) or foot.sensor_of for foot in feet)
    say, command = ("draft", draft) if needs_file else ("fields", f"{call} {foot_options(feet)}")
    values = {"type": sets[0].type_name, "told": told, "draft": draft, "call": command}
    return replace(found("FEET_UNSURE", "possible", say=say, **values), command=command)


def call_of(log: Log, options: RobotOptions, base: str) -> str:
    """Return a call of `stats` with the user's options, and with a base that is offered."""
    mass = None if options.mass is None else f"{options.mass:g}"
    words = ["dogbot-logtool", "stats", *log.words]
    for option, value in (
        ("--robot", options.robot),
        ("--odom-topic", options.odom_topic or base or None),
        ("--mass", mass),
        *(("--foot", f"{name}={text}") for name, text in (options.foot or {}).items()),
        *(("--set", f"{name}={text}") for name, text in (options.set or {}).items()),
    ):
        words += [option, value] if value is not None else []
    return shell_joined(words)
