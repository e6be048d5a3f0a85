"""JUnit XML, which servers of continuous integration show."""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple
from xml.etree import ElementTree as ET

from dogbot_logtool.io.printable import printable, printable_lines

FAILURE: Final = "failure"
ERROR: Final = "error"
REMARK: Final = "system-out"
"""What a case that did not just pass holds: a broken rule, what is not known, or a remark."""


class Case(NamedTuple):
    """One test."""

    name: str
    outcome: str = ""
    """`FAILURE`, `ERROR`, `REMARK`; empty: it passed."""
    message: str = ""
    text: str = ""


def junit_xml(name: str, suites: Mapping[str, tuple[str, Sequence[Case]]]) -> bytes:
    """Return the XML document, in UTF-8.

    Args:
        name: of the whole.
        suites: by name the class of their cases, and these.
    """
    every = [case for _, cases in suites.values() for case in cases]
    root = ET.Element("testsuites", {"name": name, **_counts(every)})
    for suite_name, (class_name, cases) in suites.items():
        suite = ET.SubElement(root, "testsuite", {"name": printable(suite_name), **_counts(cases)})
        for case in cases:
            names = {"classname": printable(class_name), "name": printable(case.name)}
            element = ET.SubElement(suite, "testcase", names)
            if case.outcome == REMARK:
                ET.SubElement(element, REMARK).text = printable(
                    f"{case.message} {case.text}".rstrip()
                )
            elif case.outcome:
                outcome = ET.SubElement(element, case.outcome, {"message": printable(case.message)})
                outcome.text = printable_lines(case.text)
    document: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return document + b"\n"


def _counts(cases: Sequence[Case]) -> dict[str, str]:
    outcomes = [case.outcome for case in cases]
    return {
        "tests": str(len(cases)),
        "failures": str(outcomes.count(FAILURE)),
        "errors": str(outcomes.count(ERROR)),
    }
