"""A comparison for continuous integration: JUnit XML, a test case a topic."""

from xml.etree import ElementTree as ET

from dogbot_logtool.comparison.outcome import Comparison, Tally
from dogbot_logtool.io.printable import printable


def junit_xml(comparison: Comparison) -> bytes:
    """Return the XML document, in UTF-8.

    A topic that differs is a failure, damage of a file an error.
    """
    failures = sum(not tally.same for tally in comparison.tallies)
    errors = bool(comparison.damage)
    counts = {
        "tests": str(len(comparison.tallies) + 1),
        "failures": str(failures),
        "errors": str(int(errors)),
    }
    root = ET.Element("testsuites", counts)
    name = printable(f"compare {comparison.expected} {comparison.actual}")
    suite = ET.SubElement(root, "testsuite", {"name": name, **counts})
    _add_files(suite, comparison)
    for tally in comparison.tallies:
        _add_topic(suite, comparison, tally)
    document: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return document + b"\n"


def _add_files(suite: ET.Element, comparison: Comparison) -> None:
    case = _add_case(suite, comparison, "files can be read")
    if comparison.damage:
        lines = [printable(damage.line) for damage in comparison.damage]
        error = ET.SubElement(case, "error", {"message": f"damage: {'; '.join(lines)}"})
        error.text = "\n".join(
            printable(loss.what) for damage in comparison.damage for loss in damage.losses
        )


def _add_topic(suite: ET.Element, comparison: Comparison, tally: Tally) -> None:
    case = _add_case(suite, comparison, printable(tally.name))
    if not tally.same:
        summary = tally.summary(comparison.unit)
        failure = ET.SubElement(case, "failure", {"message": summary})
        lines = [one.line for one in comparison.differences if one.topic == tally.name]
        failure.text = "\n".join(lines or [summary])


def _add_case(suite: ET.Element, comparison: Comparison, name: str) -> ET.Element:
    attributes = {"classname": printable(comparison.expected.name), "name": name}
    return ET.SubElement(suite, "testcase", attributes)
