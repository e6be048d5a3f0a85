"""One score of fields that may be feet: their names, their rate and what they read; and offers.

Each thing that speaks for or against them is a mark: points, and a reason for people. What may be
feet is offered with the command that takes it.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of, norms, percentiles_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined, shell_quoted
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.names import FootSet
from dogbot_logtool.robot.words import MERITS, Part, words_of

Mark = tuple[int, str]
"""Points, and the reason; empty: it need not be said."""
_CONTACT: Final = "contact contacts grf stance touch touches ground"
CONTACT_WORDS: Final = frozenset(_CONTACT.split())
_FORCE: Final = (
    "cell effort force forces fsr ft fz load loadcell loadcells loads pressure torque weight "
    "wrench wrenches"
)
FORCE_WORDS: Final = frozenset(_FORCE.split())
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


@dataclass(frozen=True, slots=True)
class FootCandidates:
    """Fields that may be the feet of a robot."""

    feet: tuple[Foot, ...]
    type_name: str
    marks: tuple[Mark, ...]
    is_integer: bool
    """Whether they are read as contacts, unless something else is said."""
    is_numbered: bool
    """Whether they are the elements of an array or bits, of which messages have fewer."""
    is_contact: bool = False
    """Whether the fields only tell contact, and no force."""

    @property
    def points(self) -> int:
        """The sum of all marks."""
        return sum(points for points, _ in self.marks)

    @property
    def reasons(self) -> str:
        """What speaks for them, and against."""
        return "; ".join(reason for _, reason in self.marks if reason)

    @property
    def fields(self) -> str:
        """The feet and their fields, for people."""
        return ", ".join(f"{foot.name} = {word_of(foot)}" for foot in self.feet)

    @property
    def words(self) -> tuple[str, ...]:
        """The fields as ``--foot`` takes them."""
        return tuple(map(word_of, self.feet))


def word_of(foot: Foot) -> str:
    """Return a foot's topic and field as ``--foot`` takes them."""
    return f"{foot.topic}:{foot.field.path}" if foot.field else foot.topic


def name_marks(names: Collection[str], type_name: str) -> Iterator[Mark]:
    """Judge names of fields, with their topics, and of the type of their messages."""
    words = [word for name in names for word in words_of(name)]
    texts = {word.text for word in (*words, *words_of(type_name))}
    if any(word.is_leg for word in words):
        yield 2, "the names speak of feet or legs"
    parts = {word.part for word in words}
    if Part.NOT_A_FOOT in parts:
        # Hands, wheels, tools ...
        yield (-_OTHER_PART if parts & {Part.FOOT, Part.LEG} else -_NEVER), ""
    if not texts.isdisjoint(CONTACT_WORDS | FORCE_WORDS):
        yield 1, "of contact or force"
    merit = min((MERITS.get(text, 0) for text in texts), default=0)
    if merit < -1:
        yield merit, "they are named as planned or set, not measured"


def rate_mark(rate_hz: float) -> Mark:
    """Judge the messages a second."""
    points = 1 if rate_hz >= _FAST_HZ else -2 if rate_hz < _SLOW_HZ else 0
    return points, f"{rate_hz:.0f} messages a second"


def with_content(named: FootCandidates, feet: Sequence[Samples]) -> FootCandidates | None:
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
    marks = [_on_and_off(np.count_nonzero(np.diff(down, axis=0), axis=0)), _in_turns(down)]
    if not are_states:
        marks += [_together(values), _in_one_direction(signed)]
    thresholds, is_contact = [0.0] * len(feet), are_states
    is_number = not are_states and not any(each.force[:, :2].any() for each in feet)
    low, high = percentiles_of(values, _ENDS, axis=0)
    if is_number and bool((signed > 0.0).all()) and bool((low > _NOT_UNLOADED * high).all()):
        thresholds, is_contact = (low + _ON * (high - low)).tolist(), True
        marks.append((0, "none reads near zero without load: they tell contact, not newtons"))
    if sum(points for points, _ in marks) <= 0:
        marks.append((-_NEVER, "no foot reads so"))
    marks.append((1 if len(feet) in _USUAL_FEET else -1, ""))
    # It is said only where the type of the field would say something else.
    kind = "" if is_contact == named.is_integer else "contact" if is_contact else "force"
    told = tuple(
        replace(foot, field=replace(foot.field, kind=kind, threshold=threshold))
        for foot, threshold in zip(named.feet, thresholds, strict=False)
        if foot.field
    )
    return replace(named, feet=told, marks=(*named.marks, *marks), is_contact=is_contact)


def _side_by_side(feet: Sequence[Samples]) -> Floats:
    """Return (n, feet) at the samples of all feet: numbers with their sign, or magnitudes."""
    time = np.unique(np.concatenate([each.log_time for each in feet]))
    columns = []
    for each in feet:
        before = np.searchsorted(each.log_time, time, side="right") - 1
        column = norms(each.force) if each.force[:, :2].any() else each.force[:, 2]
        columns.append(column[np.maximum(before, 0)])
    return np.stack(columns, axis=1)


def _on_and_off(changes: Ints) -> Mark:
    stepping, total = int(np.count_nonzero(changes > 1)), len(changes)
    if stepping == total:
        return 2, f"all {total} go on and off, {int(np.min(changes))} times and more"
    return (-1 if stepping else -3), f"only {stepping} of {total} go on and off"


def _in_turns(down: Flags) -> Mark:
    feet = down.shape[1]
    alike = [(down[:, i] == down[:, k]).mean() for i in range(feet) for k in range(i)]
    some, every = float(down.any(axis=1).mean()), float(down.all(axis=1).mean())
    if not alike or min(alike) > _SAME:
        return -2, "all are the same signal"
    if some >= _FEWEST_DOWN and every < some:
        return 2, f"in turns: at least one is on {some:.0%} of the time, all at once {every:.0%}"
    return 0, f"at least one is on {some:.0%} of the time"


def _together(values: Floats) -> Mark:
    total = values.sum(axis=1)
    mean = float(total.mean())
    if mean <= 0.0:
        return 0, ""
    spread = float(total.std()) / mean
    own = float(median_of(values.std(axis=0) / np.maximum(values.mean(axis=0), 1e-12)))
    if spread <= _STEADY and own >= _UNSTEADY * spread:
        return 3, f"together they stay within {spread:.0%} of {mean:.4g}, as a weight does"
    return 0, f"their sum varies by {spread:.0%}"


def _in_one_direction(signed: Floats) -> Mark:
    """The ground pushes and does not pull."""
    low, high = percentiles_of(signed, _TENTH, axis=0)
    smaller, larger = np.minimum(-low, high), np.maximum(-low, high)
    both = (low < 0.0) & (high > 0.0) & (smaller > _BOTH_DIRECTIONS * larger)
    return -_NEVER if both.any() else 0, ""


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
    return " ".join(f"--foot {foot.name}={shell_quoted(word_of(foot))}" for foot in feet)


def candidates_finding(log: Log, sets: Sequence[FootCandidates], call: str, base: str) -> Finding:
    """Return which fields may be feet, why, and the command that measures with them.

    Args:
        log: the log.
        sets: what `find_candidates` finds, at least one.
        call: a call of `stats` without the feet.
        base: poses that may be the base's, as ``--odom-topic`` takes them; empty: none.
    """
    first = sets[0]
    told = "; or ".join(f"{o.fields} ({o.points} points: {o.reasons})" for o in sets[:3])
    if any(foot.leg_position is None for foot in first.feet):
        told += "; which leg each is, they do not say: put front_left, back_right ... for "
        told += f"{first.feet[0].name} and the others, and gaits have names"
    file = f"{PurePath(log.words[0]).stem}.toml"
    chosen = ["--odom-topic", base] if base else []
    draft = shell_joined(["dogbot-logtool", "robots", "new", *log.words, *chosen, "-o", file])
    # What fields are, and of which foot, can only be said in a robot's file.
    needs_file = any((foot.field and foot.field.kind) or foot.sensor_of for foot in first.feet)
    fields = f"{call} {foot_options(first.feet)}"
    say, command = ("draft", draft) if needs_file else ("fields", fields)
    values = {"type": first.type_name, "told": told, "draft": draft, "call": command}
    return replace(found("FEET_UNSURE", "possible", say=say, **values), command=command)


def call_of(log: Log, options: RobotOptions, base: str) -> str:
    """Return a call of `stats` with the user's options, and with a base that is offered."""
    words = ["dogbot-logtool", "stats", *log.words]
    named = options.odom_topic or base
    words += ["--robot", options.robot] if options.robot is not None else []
    words += ["--odom-topic", named] if named else []
    words += ["--mass", f"{options.mass:g}"] if options.mass is not None else []
    for option, pairs in (("--foot", options.foot), ("--set", options.set)):
        for name, text in (pairs or {}).items():
            words += [option, f"{name}={text}"]
    return shell_joined(words)
