"""Writes the pages that are made of the program's own tables: ``make docs``."""

from itertools import groupby
from pathlib import Path
from typing import Final

from dogbot_logtool.finding import finding_kinds

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
        parts.append(
            f"\n## {subject}\n\n| code | | what it means | what to do |\n|---|---|---|---|\n"
        )
        parts += [
            f"| `{kind.code}` | {_SEVERITIES[kind.code[0]]} | {kind.meaning} | {kind.remedy} |\n"
            for kind in kinds
        ]
    return "".join(parts)


def main() -> None:
    """Write all pages."""
    (HERE / "findings.md").write_text(findings_page(), encoding="utf-8")


if __name__ == "__main__":
    main()
