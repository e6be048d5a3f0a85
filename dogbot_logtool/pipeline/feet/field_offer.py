"""What a user is told of fields that may be feet, with the command that uses them."""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Final

from dogbot_logtool.finding import Finding, warning
from dogbot_logtool.pipeline.feet.candidates import FootCandidates, word_of
from dogbot_logtool.reader.containers.log import Log

_ALTERNATIVES: Final = 2
"""Sets that are offered beside the most likely one."""


def candidates_finding(
    log: Log, found: Sequence[FootCandidates], call: str, base: str = ""
) -> Finding:
    """Return which fields may be feet, why, and the command that measures with them.

    Args:
        log: the log.
        found: what `find_candidates` finds, at least one.
        call: a call of `stats` without the feet.
        base: poses that may be the base's, as ``--odom-topic`` takes them; empty: none.
    """
    first, *others = found
    text = f"fields of {first.type_name} look like feet: {first.text}"
    for other in others[:_ALTERNATIVES]:
        text += f"; or {other.text}"
    if any(foot.leg_position is None for foot in first.feet):
        text += (
            "; which leg each is, they do not say: put front_left, back_right ... for "
            f"{first.feet[0].name} and the others, and gaits have names"
        )
    file = f"{PurePath(log.words[0]).stem}.toml"
    chosen = ["--odom-topic", base] if base else []
    draft = shlex.join(["dogbot-logtool", "robots", "new", *log.words, *chosen, "-o", file])
    if any(foot.field and foot.field.kind for foot in first.feet):
        # What the fields are can only be said in a robot's file.
        text += f"; they are not used unasked. This writes a robot's file with them: {draft}"
        return replace(warning("FEET_POSSIBLE", text), command=draft)
    words = " ".join(f"--foot {foot.name}={shlex.quote(word_of(foot))}" for foot in first.feet)
    command = f"{call} {words}"
    text += (
        f"; they are not used unasked. `{draft}` writes a robot's file with them; this measures "
        f"with them: {command}"
    )
    return replace(warning("FEET_POSSIBLE", text), command=command)
