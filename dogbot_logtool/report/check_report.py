"""Results of `check` as text, plain data and JUnit XML."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final
from xml.etree import ElementTree as ET

from rich.console import Console

from dogbot_logtool.comparison.judge import DAMAGE, Judgement, Status, Value, worst
from dogbot_logtool.io.printable import printable
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
    figure = f"{name}{found.figure} is {shown_value(found.value)}; wanted: {found.demand}"
    look = f" ({found.look})" if found.look else ""
    label = (f"  {found.status:<7}  ", _STYLES[found.status])
    return [label, printable(figure), printable(look)]


def shown_value(value: Value) -> str:
    """Return a figure as a sentence shows it."""
    if value is None:
        return "not known"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


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
    """Return the XML document, in UTF-8.

    A broken rule is a failure; a figure that is not known, and a log that cannot be read, is an
    error. A warning is neither, but stands in the output of its case.

    Args:
        checked: judgements by log.
        failed: why the other logs could not be read, by log.
    """
    root = ET.Element("testsuites", {"name": "dogbot-logtool check"})
    for name, judgements in checked.items():
        statuses = [found.status for found in judgements]
        counts = {
            "tests": str(len(statuses)),
            "failures": str(statuses.count(Status.FAIL)),
            "errors": str(statuses.count(Status.UNKNOWN)),
        }
        suite = ET.SubElement(root, "testsuite", {"name": printable(name), **counts})
        for found in judgements:
            _add_case(suite, name, found)
    for name, sentence in failed.items():
        counts = {"tests": "1", "failures": "0", "errors": "1"}
        suite = ET.SubElement(root, "testsuite", {"name": printable(name), **counts})
        case = ET.SubElement(suite, "testcase", {"classname": printable(name), "name": "is read"})
        ET.SubElement(case, "error", {"message": printable(sentence)})
    document: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return document + b"\n"


def _add_case(suite: ET.Element, log: str, found: Judgement) -> None:
    name = found.rule.name or f"{found.figure} {found.demand}"
    attributes = {"classname": printable(log), "name": printable(name)}
    case = ET.SubElement(suite, "testcase", attributes)
    message = f"{found.figure} is {shown_value(found.value)}; wanted: {found.demand}"
    if found.status in {Status.FAIL, Status.UNKNOWN}:
        tag = "failure" if found.status is Status.FAIL else "error"
        ET.SubElement(case, tag, {"message": printable(message)}).text = printable(found.look)
    elif found.status is Status.WARN:
        ET.SubElement(case, "system-out").text = printable(f"{message} {found.look}".rstrip())
