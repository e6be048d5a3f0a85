"""Results as plain data, JSON but for those of comparisons, with its schema; and JUnit XML."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import is_dataclass, replace
from typing import Any, Final, NamedTuple

from dogbot_logtool import __version__
from dogbot_logtool.core.definitions import definitions
from dogbot_logtool.core.events import with_steps
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.records import Field, fields_of, to_json, values
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.plain_json import only_finite
from dogbot_logtool.io.printable import listed, printable, printable_lines
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.verdict import headline, quality_of
from dogbot_logtool.results import Conversion, Measurement, Page

TOOL: Final = {"name": "dogbot-logtool", "version": __version__}


def damage_json(damage: Damage) -> dict[str, Any]:
    """Return damage as plain values.

    `messages` is null when their number cannot be known, `text` where the log is sound, and
    `start_s` and `end_s`, which count from the log's first message, where they are not known.
    """
    return {
        "text": damage.text or None,
        "messages": damage.messages,
        "bytes": damage.bytes,
        "places": [
            {
                "offset": loss.offset,
                "text": loss.what,
                "messages": loss.messages,
                "bytes": loss.bytes,
                "start_s": damage.seconds(loss.start_time),
                "end_s": damage.seconds(loss.end_time),
            }
            for loss in damage.losses
        ],
    }


def finding_json(finding: Finding) -> dict[str, Any]:
    """Return a finding as plain data."""
    return {
        "code": finding.code,
        "severity": finding.severity.word,
        "text": finding.text,
        "remedy": finding.remedy,
        "where": finding.where or None,
        "voids": list(finding.voids),
    }


Json = dict[str, Any]


def stats_json(measured: Measurement, *, detail: bool = True) -> Json:
    """Return all metrics of one log as plain data; what is not known is None.

    Args:
        measured: what was measured of it.
        detail: with curves, lists of times, and the events of every stride.
    """
    walk = measured.metrics
    walk = replace(walk, events=with_steps(walk)) if detail else _without_detail(walk)
    document: Json = to_json(walk, detail=detail)
    finite: Json = only_finite(document)
    # Comparing is far quicker than looking for paths, of which there are nearly never any.
    if finite != document and (overflowed := list(_not_finite(walk))):
        text = f"metrics that are too large for a number are null: {listed(overflowed)}"
        finding = Finding("NOT_FINITE", text, cases=("result",))
        finite["findings"].append(finding_json(finding))
        finite["null_because"] |= dict.fromkeys(overflowed, finding.code)
    return finite


def _not_finite(walk: WalkMetrics) -> Iterator[str]:
    """Yield the paths of metrics that are no finite numbers."""
    for path, value, _ in values(walk):
        if isinstance(value, float) and not math.isfinite(value):
            yield ".".join(path)


def _without_detail(walk: WalkMetrics) -> WalkMetrics:
    """Return metrics without reasons of detail."""
    detailed = {".".join(path) for path, _, field in values(walk) if field.is_detail}
    return replace(
        walk,
        null_because={
            path: reason for path, reason in walk.null_because.items() if path not in detailed
        },
    )


_SKIPPED: Final = ("not_finite", "no_position", "no_direction", "overflow", "bad_poses")
"""Why samples have no arrow, see `core/scene/arrows.py`."""


def conversion_json(done: Conversion) -> dict[str, Any]:
    """Return what was done as plain values."""
    return {
        "tool": TOOL,
        "input": name_of(done.source),
        "output": name_of(done.target),
        "container": done.container,
        "robot": done.robot.name,
        "style": done.style,
        "encoding": done.encoding,
        "topics": {
            "odometry": list(done.odometry_topics),
            "feet": {foot.name: foot.topic for foot in done.robot.feet},
        },
        "frames": {"world": done.world_frame, "base": done.base_frame},
        "messages": {"read": done.messages, "copied": done.copied},
        "annotations": dict(done.annotations),
        "skipped": {why: done.counts[why] for why in _SKIPPED},
        "findings": [finding_json(each) for each in done.findings],
        "damage": damage_json(done.damage),
    }


def page_json(done: Page) -> Json:
    """Return what was written of a page as plain values."""
    measured = done.measured
    return {
        "tool": TOOL,
        "input": name_of(done.source),
        "output": name_of(done.target),
        "bytes": done.size,
        "verdict": headline(measured.metrics),
        "quality": quality_of(measured).word,
        "damage": damage_json(measured.damage),
    }


_PRIMITIVES: Final[Mapping[Any, str]] = {
    float: "number",
    int: "integer",
    str: "string",
    bool: "boolean",
}


def schema(record: type) -> Json:
    """Return the JSON Schema of a record."""
    defs: dict[str, Json] = {}
    root = _reference(record, defs)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **root, "$defs": defs}


def _reference(kind: Any, defs: dict[str, Json]) -> Json:  # noqa: ANN401 - any record
    if kind.__name__ not in defs:
        defs[kind.__name__] = {}
        own, words = fields_of(kind), definitions(kind)
        defs[kind.__name__] = {
            "type": "object",
            "description": kind.__doc__,
            "additionalProperties": False,
            "properties": {
                field.name: _described(_field_schema(field, defs), field, words) for field in own
            },
            "required": [field.name for field in own if not field.is_detail],
        }
    return {"$ref": f"#/$defs/{kind.__name__}"}


def _described(made: Json, field: Field, words: Mapping[str, str]) -> Json:
    description = {"description": words[field.name]} if field.name in words else {}
    return made | description | ({"unit": field.of.unit} if field.of.unit else {})


def _field_schema(field: Field, defs: dict[str, Json]) -> Json:
    kind = field.inner
    made = _reference(kind, defs) if is_dataclass(kind) else {"type": _PRIMITIVES[kind]}
    if field.kind == "map":
        made = {"type": "object", "additionalProperties": made}
    elif field.kind in {"list", "records"}:
        made = {"type": "array", "items": made}
    return {"anyOf": [made, {"type": "null"}]} if field.nullable else made


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
    from xml.etree import ElementTree as ET  # noqa: PLC0415 - most commands need none

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
