"""What is said of topics and fields that may be feet: which, why, and how to take them."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Final

from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined, shell_quoted
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.names import FootSet
from dogbot_logtool.robot.score import FootCandidates, word_of

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
    return replace(found("FEET_UNSURE", say="topics", which=which, call=command), command=command)


def alternatives(sets: Sequence[FootSet]) -> str:
    """Return the words for a shell that choose the first of some sets."""
    return " or ".join(
        " ".join(f"--foot {foot.name}={shell_quoted(foot.topic)}" for foot in one.feet)
        for one in sets[:_ALTERNATIVES]
    )


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
    words = " ".join(f"--foot {foot.name}={shell_quoted(word_of(foot))}" for foot in first.feet)
    say, command = ("draft", draft) if needs_file else ("fields", f"{call} {words}")
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
