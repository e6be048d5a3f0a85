"""Writes the pages that are made of the program's own tables: ``make docs``."""

from collections.abc import Callable, Iterator
from itertools import groupby
from pathlib import Path
from typing import Final

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.definitions import definitions
from dogbot_logtool.core.events import EventType
from dogbot_logtool.core.metrics import Stride, WalkMetrics
from dogbot_logtool.core.records import Field, fields_of, is_record, metric_paths
from dogbot_logtool.finding import finding_kinds
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.report.documents import schema

HERE: Final = Path(__file__).parent
_COLUMNS: Final = "| code | | what it means | what to do |\n|---|---|---|---|\n"
_HEAD: Final = """# Findings

What `info`, `convert`, `stats` and `report` say about a log, with a code that scripts can match.
**Errors** name something that cannot be had, **warnings** what makes numbers or pictures
misleading, **notes** what is good to know. This page is made of `dogbot_logtool/findings.toml` by
`make docs`.
"""


def findings_page() -> str:
    """Return the page of all findings."""
    parts = [_HEAD, "\n", _COLUMNS]
    for subject, kinds in groupby(finding_kinds().values(), key=lambda kind: kind.subject):
        parts.append(f"| **{subject}** | | | |\n")
        parts += [
            f"| `{kind.code}` | {kind.severity.word} | {kind.meaning} | {kind.remedy} |\n"
            for kind in kinds
        ]
    return "".join(parts)


_METRICS_HEAD: Final = """# Metrics

Everything that `stats --json` reports, and the columns of `export --table strides`. SI units; the
unit stands in the key. A metric that cannot be known is `null`, and `null_because` says why: the
code of a finding, what of *needs* the log lacks, or that it does not apply. In keys `*` stands
for the name of a foot, pair, joint or topic, `[]` for the items of a list. Curves, lists of times
and the touchdowns and lift-offs among the events are printed with `--json -v` only. This page is
made of the records in `dogbot_logtool/core/metrics.py` by `make docs`.

An **aggregate** holds {statistics}; a **curve** quartiles over strides by percent of the gait
cycle: `percent`, `lower`, `median`, `upper`. All metrics of `base`, `gait`, `feet`, `forces` and
`stability` are those of each of `gait.segments[]`, too.

| key | unit | kind | definition | needs |
|---|---|---|---|---|
"""


def metrics_page() -> str:
    """Return the page of all metrics."""
    statistics = ", ".join(f"`{field.name}`" for field in fields_of(Aggregate))
    parts = [_METRICS_HEAD.format(statistics=statistics)]
    words = definitions(WalkMetrics)
    for field in fields_of(WalkMetrics):
        parts += _group(field, words.get(field.name, ""))
    parts.append(_group_row("stride", Stride.__doc__ or ""))
    parts += [_metric_row(*each) for each in metric_paths(Stride)]
    meanings = definitions(EventType)
    parts.append("\n## Events\n")
    parts += [f"- `{kind}`: {meanings[kind.name]}.\n" for kind in EventType]
    return "".join(parts)


def _group(field: Field, words: str) -> Iterator[str]:
    items = {"map": ".*", "records": "[]"}.get(field.kind, "")
    if not is_record(field.inner):
        yield _group_row(field.name, words)
        return
    yield _group_row(field.name, field.inner.__doc__)
    for path, each, definition in metric_paths(field.inner):
        if not path.startswith("segments[].") or path.count(".") == 1:
            yield _metric_row(f"{field.name}{items}.{path}", each, definition)


def _group_row(name: str, words: str) -> str:
    return f"| **{name}** | | | {' '.join(words.split())} | |\n"


def _metric_row(path: str, field: Field, definition: str) -> str:
    cells = (f"`{path}`", field.of.unit, field.kind, definition, ", ".join(field.of.needs))
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def schema_file() -> str:
    """Return the JSON Schema of `stats --json`."""
    return to_json(schema(WalkMetrics), indent=1) + "\n"


PAGES: Final[dict[Path, Callable[[], str]]] = {
    HERE / "findings.md": findings_page,
    HERE / "metrics.md": metrics_page,
    HERE.parent / "dogbot_logtool" / "report" / "stats.schema.json": schema_file,
}
"""What is made, and what makes it."""


def main() -> None:
    """Write all pages."""
    for path, made in PAGES.items():
        path.write_text(made(), encoding="utf-8")


if __name__ == "__main__":
    main()
