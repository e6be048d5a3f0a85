"""Each kind of log is measured right, or its figures are null and a finding names the cause."""

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.truth.cases import all_cases
from tests.truth.judging import Case, faults, judge
from tests.truth.outcome import outcome

VARIANT = re.compile(r", mirrored$| from mid-cycle$")
"""Ends of names of gaits that are also there as they are."""
NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")


def each_case() -> Iterator[Any]:
    """Yield all cases; of those that differ in numbers only, the first and the last are quick."""
    alike = defaultdict(list)
    for case in all_cases():
        alike[NUMBER.sub("0", case.name)].append(case)
    for kind, cases in alike.items():
        for case in cases:
            is_quick = case in {cases[0], cases[-1]} and not VARIANT.search(kind)
            yield pytest.param(case, id=case.name, marks=() if is_quick else pytest.mark.slow)


@pytest.mark.parametrize("case", list(each_case()))
def test_right_or_null_with_the_cause_named(case: Case, tmp_path: Path) -> None:
    recording = case.record()
    found = outcome(recording, tmp_path)
    wrong = faults(judge(case, recording, found))
    assert not wrong, "\n".join(
        f"{each.figure}: {each.status}; true {each.truth}, result {each.result} {each.why}"
        for each in wrong
    )


def test_the_json_has_every_figure_that_there_is_truth_for(tmp_path: Path) -> None:
    case = all_cases()[0]
    recording = case.record()
    judged = judge(case, recording, outcome(recording, tmp_path))
    assert len(judged) > 12
    assert [each.why for each in judged if each.status == "missing"] == []
