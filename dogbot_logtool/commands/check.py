"""The story of `check`: is a log good, by rules that a person wrote?"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from dogbot_logtool.comparison.fields import load_json, looks_like_json
from dogbot_logtool.comparison.judge import Judgement, Status, judge, worst
from dogbot_logtool.comparison.limits import Rule, load_limits
from dogbot_logtool.core.metrics import SCHEMA_VERSION
from dogbot_logtool.errors import CallError


class Limits(NamedTuple):
    """The limits that logs are checked against."""

    rules: tuple[Rule, ...]
    baseline: Mapping[str, Any] | None = None
    """``stats --json`` of a run."""


def read_limits(limits: Path, baseline: Path | None) -> Limits:
    """Read the rules, and the run that they compare with.

    Raises:
        CallError: a file is not what it should be, or rules need a baseline and there is none.
    """
    rules = load_limits(limits)
    if baseline is None:
        if any(rule.baseline is not None for rule in rules):
            raise CallError(
                f"{limits}: some rules need --baseline FILE.json, which "
                "'dogbot-logtool stats LOG --json > FILE.json' writes"
            )
        return Limits(rules)
    document = load_json(baseline) if looks_like_json(baseline) else None
    if not isinstance(document, dict) or "schema_version" not in document:
        raise CallError(
            f"{baseline}: is not what `stats --json` prints for one log; "
            "'dogbot-logtool stats LOG --json > FILE.json' writes it"
        )
    if document["schema_version"] != SCHEMA_VERSION:
        raise CallError(
            f"{baseline}: has the keys of schema {document['schema_version']}, and this version "
            f"those of schema {SCHEMA_VERSION}: measure the run again with "
            "'dogbot-logtool stats LOG --json > FILE.json'"
        )
    return Limits(rules, document)


def check(document: Mapping[str, Any], limits: Limits) -> list[Judgement]:
    """Judge the figures, findings and events of a log; see `judge`."""
    return judge(document, limits.rules, limits.baseline)


def exit_code(judgements: list[Judgement]) -> int:
    """Return 1 where a rule is broken or a figure unknown, else 0."""
    return 1 if worst(judgements) in {Status.FAIL, Status.UNKNOWN} else 0
