"""Writes the pages that are made of the program's own tables: ``make docs``."""

from collections.abc import Callable, Iterator
from itertools import groupby
from pathlib import Path
from typing import Any, Final

from dogbot_logtool.finding import finding_kinds
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.report.dataset.schema import PARTITIONS, SCHEMA_VERSION, tables
from dogbot_logtool.report.figures.document import DOCUMENT, STRIDE_ROWS
from dogbot_logtool.report.figures.figure import STATISTICS, Figure, Kind, Scope, all_figures
from dogbot_logtool.report.figures.schema import schema

HERE: Final = Path(__file__).parent
_SEVERITIES: Final = {"E": "error", "W": "warning", "N": "note"}
_COLUMNS: Final = "| code | | what it means | what to do |\n|---|---|---|---|\n"
_HEAD: Final = """# Findings

What `info`, `convert`, `stats` and `report` say about a log, with a code that scripts can match.
**Errors** name something that cannot be had, **warnings** what makes numbers or pictures
misleading, **notes** what is good to know. This page is made of `dogbot_logtool/findings.toml` by
`make docs`.
"""


def findings_page() -> str:
    """Return the page of all findings."""
    parts = [_HEAD]
    for subject, kinds in groupby(finding_kinds().values(), key=lambda kind: kind.subject):
        parts.append(f"\n## {subject}\n\n{_COLUMNS}")
        parts += [
            f"| `{kind.code}` | {_SEVERITIES[kind.code[0]]} | {kind.meaning} | {kind.remedy} |\n"
            for kind in kinds
        ]
    return "".join(parts)


_FIGURES_HEAD: Final = """# Figures

Everything that `stats --json` reports, and every column of `export` and of its dataset. SI units;
the unit stands in the key. A figure that cannot be known is `null`, and a finding says why. `*`
stands for the name of a foot or topic, `[]` for the items of a list; the last column names the
tables that show the figure, too. This page is made of the table
in `dogbot_logtool/report/figures/` by `make docs`.

An **aggregate** is an object: {statistics}.

"""
_FIGURES_COLUMNS: Final = (
    "| key | unit | what it is | null when | tables |\n|---|---|---|---|---|\n"
)


def figures_page() -> str:
    """Return the page of all figures."""
    statistics = ", ".join(f"`{name}` ({words})" for name, words in STATISTICS.items())
    parts = [_FIGURES_HEAD.format(statistics=statistics)]
    for scope in DOCUMENT.members:
        if isinstance(scope, Scope):
            parts += _section(scope, scope.key)
    parts += _section(STRIDE_ROWS, "stride")
    return "".join(parts).replace("\n\n\n", "\n\n")


def _section(scope: Scope, key: str) -> Iterator[str]:
    null = f" `null`: {scope.null}." if scope.null else ""
    yield f"\n## {key}\n\n{scope.definition[0].upper()}{scope.definition[1:]}.{null}\n\n"
    yield _FIGURES_COLUMNS
    root = Scope("", (scope,), scope.of, "")
    for path, figure in all_figures(root):
        yield _figure_row(path, figure)


def _figure_row(path: str, figure: Figure[Any]) -> str:
    words = figure.definition
    if figure.choices:
        words += f" ({', '.join(f'`{choice}`' for choice in figure.choices)})"
    if figure.kind is Kind.AGGREGATE:
        words += " (aggregate)"
    tables = dict.fromkeys(column.table.value for column in figure.columns)
    cells = (f"`{path}`", figure.unit, words, figure.null, "; ".join(tables))
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def schema_file() -> str:
    """Return the JSON Schema of `stats --json`."""
    return to_json(schema(), indent=1) + "\n"


_DATASET_HEAD: Final = """# The dataset of `export --dataset`

The tables that `export --dataset DIR` keeps ([many logs](many_logs.md)), and their columns; a
name means the same in all of them. The directories have the columns {partitions}.
`--label NAME=VALUE` adds columns of text to `logs`.

A table is `<table>/robot=<robot>/month=<month>/part-<number>.parquet`; a part holds the rows of
up to 1,000 logs, those of one log under the same number in all tables. The files' metadata say
the version of this layout, which is {version}. This page is made of the table
in `dogbot_logtool/report/figures/` by `make docs`.
"""
_ROWS_OF: Final = {
    "logs": "a row a log, also of one that could not be measured",
    "feet": "a row a foot of a log that was measured; an aggregate of figures.md is six columns",
    "strides": "a row a whole stride of a foot",
    "events": "a row an event",
}


def dataset_page() -> str:
    """Return the page of the tables in Parquet."""
    partitions = " and ".join(f"`{name}` ({words})" for name, words in PARTITIONS.items())
    parts = [_DATASET_HEAD.format(partitions=partitions, version=SCHEMA_VERSION)]
    for table, words in _ROWS_OF.items():
        parts.append(f"\n## {table}\n\n{words[0].upper()}{words[1:]}.\n\n")
        parts.append("| column | type | unit | what it is | null when |\n|---|---|---|---|---|\n")
        for each in tables()[table]:
            cells = (f"`{each.name}`", each.type.value, each.unit, each.definition, each.null)
            parts.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n")
    return "".join(parts)


PAGES: Final[dict[Path, Callable[[], str]]] = {
    HERE / "findings.md": findings_page,
    HERE / "figures.md": figures_page,
    HERE / "dataset.md": dataset_page,
    HERE.parent / "dogbot_logtool" / "report" / "documents" / "stats.schema.json": schema_file,
}
"""What is made, and what makes it."""


def main() -> None:
    """Write all pages."""
    for path, made in PAGES.items():
        path.write_text(made(), encoding="utf-8")


if __name__ == "__main__":
    main()
