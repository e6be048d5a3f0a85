"""What is said of topics and fields that may be feet: which, why, and how to take them."""

from collections.abc import Sequence
from pathlib import PurePath
from typing import Final

from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed, shell_joined, shell_quoted
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.score import FootCandidates, word_of
from dogbot_logtool.robot.siblings import FootSet
from dogbot_logtool.robot.words import ON_A_FOOT, words_of

_ALTERNATIVES: Final = 3
"""Sets of topics that are offered beside the most likely one."""


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
    text = (
        f"feet may be among the topics, but their names do not tell surely: {which}; "
        f"no arrows, no gait, until --foot says which they are: {command}"
    )
    return Finding("FEET_UNSURE", text, command=command)


def alternatives(sets: Sequence[FootSet]) -> str:
    """Return the words for a shell that choose the first of some sets."""
    return " or ".join(
        " ".join(f"--foot {foot.name}={shell_quoted(foot.topic)}" for foot in one.feet)
        for one in sets[:_ALTERNATIVES]
    )


def split_cells(found: Sequence[FootCandidates]) -> tuple[list[FootCandidates], list[Finding]]:
    """Leave out fields of which each foot has several, alike but for their place in it.

    Returns:
        the other fields, and a finding for each group that was left out: no single sensor in a
        sole tells the foot's load.
    """
    groups: dict[object, list[FootCandidates]] = {}
    for one in found:
        feet = tuple((foot.name, foot.topic, _without_place(foot)) for foot in one.feet)
        groups.setdefault((one.type_name, feet), []).append(one)
    others = [group[0] for group in groups.values() if len(group) == 1]
    return others, [_cells_finding(group) for group in groups.values() if len(group) > 1]


def _without_place(foot: Foot) -> tuple[str, ...]:
    """Return the words of a foot's field that do not tell where in the foot it is."""
    words = [word.text for word in words_of(foot.field.path if foot.field else "")]
    return tuple(word for word in words if word not in ON_A_FOOT and not word.isdigit())


def _cells_finding(group: Sequence[FootCandidates]) -> Finding:
    feet = []
    for number, foot in enumerate(group[0].feet):
        fields = dict.fromkeys(word_of(each.feet[number]) for each in group)
        feet.append(f"{foot.name} = {' + '.join(fields)}")
    text = (
        f"fields of {group[0].type_name} look like several sensors in each foot: {listed(feet)}; a "
        "single one tells neither the load nor the contact of its foot, and fields cannot be added "
        "up here: record the sum of each foot's sensors on a topic of its own, such as "
        "/foot/left of geometry_msgs/WrenchStamped"
    )
    return Finding("FEET_UNSURE", text, cases=("possible",))


def candidates_finding(log: Log, found: Sequence[FootCandidates], call: str, base: str) -> Finding:
    """Return which fields may be feet, why, and the command that measures with them.

    Args:
        log: the log.
        found: what `find_candidates` finds, at least one.
        call: a call of `stats` without the feet.
        base: poses that may be the base's, as ``--odom-topic`` takes them; empty: none.
    """
    first = found[0]
    told = "; or ".join(f"{o.fields} ({o.points} points: {o.reasons})" for o in found[:3])
    text = f"fields of {first.type_name} look like feet: {told}"
    if any(foot.leg_position is None for foot in first.feet):
        text += (
            "; which leg each is, they do not say: put front_left, back_right ... for "
            f"{first.feet[0].name} and the others, and gaits have names"
        )
    file = f"{PurePath(log.words[0]).stem}.toml"
    chosen = ["--odom-topic", base] if base else []
    draft = shell_joined(["dogbot-logtool", "robots", "new", *log.words, *chosen, "-o", file])
    if any(foot.field and foot.field.kind for foot in first.feet):
        # What the fields are can only be said in a robot's file.
        text += f"; they are not used unasked. This writes a robot's file with them: {draft}"
        return Finding("FEET_UNSURE", text, command=draft, cases=("possible",))
    words = " ".join(f"--foot {foot.name}={shell_quoted(word_of(foot))}" for foot in first.feet)
    command = f"{call} {words}"
    text += (
        f"; they are not used unasked. `{draft}` writes a robot's file with them; this measures "
        f"with them: {command}"
    )
    return Finding("FEET_UNSURE", text, command=command, cases=("possible",))


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
