"""Labelled events against those that were found, for people and for programs."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from rich.console import Console

from dogbot_logtool.comparison.walks.labelled_events import EventMatch
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.numbers import NOTHING
from dogbot_logtool.report.text.console import print_sentence
from dogbot_logtool.report.text.text_layout import NameTable, Row

_HEADINGS: Final = ("events", "labelled", "found", "missed", "invented", "late by ms", "sd", "most")
_MOST_TIMES: Final = 8


def print_event_matches(console: Console, matches: Sequence[EventMatch], within_s: float) -> None:
    """Print a row for each type and foot, and when events were missed or invented."""
    wrong = sum(len(each.missed_s) + len(each.invented_s) for each in matches)
    words = f"{wrong} events are missed or invented" if wrong else "all labelled events are found"
    print_sentence(
        console, (words, "bold red" if wrong else "green"), f" (within {within_s * 1e3:g} ms)"
    )
    console.print(NameTable(_HEADINGS, [_row(each) for each in matches]), crop=False)
    for each in matches:
        for word, times in (("missed", each.missed_s), ("invented", each.invented_s)):
            if times:
                shown = ", ".join(f"{time:.3f}" for time in times[:_MOST_TIMES])
                more = f" and {len(times) - _MOST_TIMES} more" if len(times) > _MOST_TIMES else ""
                print_sentence(console, printable(f"  {_name(each)} {word} at {shown} s{more}"))


def _name(each: EventMatch) -> str:
    return f"{each.foot} {each.type}".strip()


def _row(each: EventMatch) -> Row:
    late_ms = np.array(each.late_s) * 1e3
    numbers = [late_ms.mean(), late_ms.std(), np.abs(late_ms).max()] if len(late_ms) else []
    spread = [f"{number:.0f}" for number in numbers] or [NOTHING] * 3
    counts = each.labelled, len(each.late_s), len(each.missed_s), len(each.invented_s)
    return Row([printable(_name(each))], [*map(str, counts), *spread], "")


def event_matches_json(matches: Sequence[EventMatch], within_s: float) -> dict[str, Any]:
    """Return the matches as plain data."""
    return {
        "within_s": within_s,
        "events": [
            {
                "foot": each.foot or None,
                "type": each.type,
                "labelled": each.labelled,
                "late_s": list(each.late_s),
                "missed_s": list(each.missed_s),
                "invented_s": list(each.invented_s),
            }
            for each in matches
        ],
    }
