"""All metrics of `stats` as plain data: the shape that `stats.schema.json` describes."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from dogbot_logtool.core.events.event import STEPS
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.records import to_json, values
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.plain_json import not_finite, only_finite
from dogbot_logtool.io.printable import listed
from dogbot_logtool.report.documents.finding_json import finding_json
from dogbot_logtool.results import Measurement

Json = dict[str, Any]


def stats_json(measured: Measurement, *, detail: bool = True) -> Json:
    """Return all metrics of one log as plain data; what is not known is None.

    Args:
        measured: what was measured of it.
        detail: with curves, lists of times, and the events of every stride.
    """
    walk = measured.metrics if detail else _without_detail(measured.metrics)
    document: Json = to_json(walk, detail=detail)
    finite: Json = only_finite(document)
    # Comparing is far quicker than looking for paths, of which there are nearly never any.
    if finite != document and (overflowed := list(not_finite(document))):
        text = f"metrics that are too large for a number are null: {listed(overflowed)}"
        finding = Finding("N_OVERFLOW", text)
        finite["findings"].append(finding_json(finding))
        finite["null_because"] |= dict.fromkeys(overflowed, finding.code)
    return finite


def _without_detail(walk: WalkMetrics) -> WalkMetrics:
    """Return metrics without the events of every stride, and without reasons of detail."""
    detailed = set(_detailed(walk))
    return replace(
        walk,
        events=tuple(each for each in walk.events if each.type not in STEPS),
        null_because={
            path: reason for path, reason in walk.null_because.items() if path not in detailed
        },
    )


def _detailed(walk: WalkMetrics) -> Iterator[str]:
    for path, _, field in values(walk):
        if field.is_detail:
            yield ".".join(path)
