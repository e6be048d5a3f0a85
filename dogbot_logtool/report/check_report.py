"""Results of `check` as text, plain data and JUnit XML."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

from rich.console import Console

from dogbot_logtool.comparison.judge import DAMAGE, Judgement, Status, value_text, worst
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.documents import ERROR, FAILURE, REMARK, Case, junit_xml
from dogbot_logtool.report.text.console import print_sentence

_STYLES: Final = {
    Status.FAIL: "bold red",
    Status.UNKNOWN: "magenta",
    Status.WARN: "yellow",
    Status.GOOD: "green",
}
_LABEL: Final = 9


def print_check(
    console: Console, name: str, judgements: Sequence[Judgement], *, verbose: bool
) -> None:
    """Print what a log comes to.

    Args:
        console: where to.
        name: of the log.
        judgements: what its rules come to.
        verbose: print also what is good, rule by rule.
    """
    status = worst(judgements)
    counts = Counter(found.status for found in judgements)
    words = ", ".join(f"{counts[each]} {each}" for each in Status if counts[each])
    print_sentence(console, (f"{status:<7}  ", _STYLES[status]), f"{printable(name)}: {words}")
    order = list(Status)
    # Damage stands at the top.
    for found in sorted(
        judgements, key=lambda each: (each.rule is not DAMAGE, order.index(each.status))
    ):
        if verbose or found.status is not Status.GOOD:
            print_sentence(console, *_parts(found), indent=_LABEL + 2)


def _parts(found: Judgement) -> list[str | tuple[str, str]]:
    name = f"{found.rule.name}: " if found.rule.name else ""
    look = f" ({found.look})" if found.look else ""
    label = (f"  {found.status:<7}  ", _STYLES[found.status])
    return [label, printable(name + _sentence(found)), printable(look)]


def check_json(name: str, judgements: Sequence[Judgement]) -> dict[str, Any]:
    """Return what a log comes to."""
    return {
        "log": name,
        "status": str(worst(judgements)),
        "rules": [_judgement(found) for found in judgements],
    }


def _judgement(found: Judgement) -> dict[str, Any]:
    rule = found.rule
    return {
        "status": str(found.status),
        "name": rule.name or None,
        str(rule.subject): found.figure,
        "value": found.value,
        "demand": found.demand,
        "low": rule.low if math.isfinite(rule.low) else None,
        "high": rule.high if math.isfinite(rule.high) else None,
        "where": rule.where,
        "look": found.look or None,
    }


def check_junit(checked: Mapping[str, Sequence[Judgement]], failed: Mapping[str, str]) -> bytes:
    """Return JUnit XML.

    A broken rule is a failure; a metric that is not known, and a log that cannot be read, is an
    error. A warning is neither, but stands in the output of its case.

    Args:
        checked: judgements by log.
        failed: why the other logs could not be read, by log.
    """
    suites = {log: (log, [_case(each) for each in found]) for log, found in checked.items()}
    for log, sentence in failed.items():
        suites[log] = (log, [Case("is read", ERROR, sentence)])
    return junit_xml("dogbot-logtool check", suites)


_OUTCOMES: Final = {Status.FAIL: FAILURE, Status.UNKNOWN: ERROR, Status.WARN: REMARK}


def _case(found: Judgement) -> Case:
    name = found.rule.name or f"{found.figure} {found.demand}"
    return Case(name, _OUTCOMES.get(found.status, ""), _sentence(found), found.look)


def _sentence(found: Judgement) -> str:
    return f"{found.figure} is {value_text(found.value)}; wanted: {found.demand}"
