"""Results of `check` as JUnit XML: a suite a log, a test case a rule."""

from collections.abc import Mapping, Sequence
from xml.etree import ElementTree as ET

from dogbot_logtool.comparison.rules.judge import Judgement, Status
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.text.check_text import shown_value


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
