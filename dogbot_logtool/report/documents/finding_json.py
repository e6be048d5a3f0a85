"""A finding as plain data."""

from typing import Any

from dogbot_logtool.finding import Finding


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
