"""Results of `check` as plain data."""

import math
from collections.abc import Sequence
from typing import Any

from dogbot_logtool.comparison.rules.judge import Judgement, worst


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
