"""Each kind of log is measured right, or its figures are null and a finding names the cause."""

import csv
import os
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.truth.case import Case
from tests.truth.cases import all_cases
from tests.truth.judging import faults, judge
from tests.truth.outcome import outcome
from tests.truth.pose_cases import WAYS
from tests.truth.pose_faults import silent
from tests.truth.recording import FORCE, disturbed
from tests.truth.sensor_faults import noise, rezeroed, user_gives
from tests.truth.validate import TABLE, labelled_rows
from tests.truth.walking import Walk

VARIANT = re.compile(r", mirrored$| from mid-cycle$")
"""Ends of names of gaits that are also there as they are."""
KINDS = r"\b(slow walk|walk|trot|two feet|pronk|circle|bumpers|force sensors|silent in swing)\b"
ALIKE = re.compile("|".join([r"[+-]?\d+(\.\d+)?", *(f", {way}" for way in reversed(WAYS)), KINDS]))
"""What may differ in names of cases that are alike: numbers, gaits, and what tells of the feet."""


def each_case() -> Iterator[Any]:
    """Yield all cases; of those that are alike one is quick, in turn the first and the last."""
    alike = defaultdict(list)
    for case in all_cases():
        alike[ALIKE.sub("0", case.name)].append(case)
    for number, (kind, cases) in enumerate(alike.items()):
        for case in cases:
            is_quick = case is cases[-(number % 2)] and not VARIANT.search(kind)
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


def test_the_table_has_every_kind() -> None:
    with TABLE.open(encoding="utf-8") as file:
        names = {row["log"] for row in csv.DictReader(file)}
    missing = [case.name for case in all_cases() if case.name not in names]
    assert missing == [], "run: make validate"


LABELLED = os.environ.get("LOGTOOL_LABELLED", "")


@pytest.mark.skipif(not LABELLED, reason="LOGTOOL_LABELLED names no folder with logs")
def test_all_labelled_events_of_a_real_humanoid_are_found() -> None:
    rows = list(labelled_rows(Path(LABELLED)))
    assert rows
    for *_, touchdowns, lift_offs in rows:
        for found in (touchdowns, lift_offs):
            assert re.match(r"(\d+) of \1,", found), rows


def test_a_gap_of_poses_counts_neither_as_path_nor_as_time(tmp_path: Path) -> None:
    recording = silent(3.0, 4.0)(Walk().recorded(200.0, 100.0))
    found = outcome(recording, tmp_path)
    assert found.figure("base.duration_s") == pytest.approx(7.0, abs=0.02)
    assert found.figure("base.path_length_m") == pytest.approx(3.5, abs=0.02)
    assert found.says("front_left is in contact for 0.5 s further than 0.1 s from odometry")
    foot = outcome(FORCE(recording), tmp_path).json["feet"]["front_left"]
    assert 5 < foot["stride_length_m"]["n"] < foot["strides"]


def test_a_sensor_that_steps_still_tells_its_loads_beside_a_given_offset(tmp_path: Path) -> None:
    zero = {f"tare.{foot}": "0,0,0" for foot in Walk().robot.feet}
    given = user_gives(mass=None, set=zero)
    faulty = (FORCE, noise(1.0), rezeroed(4.0, 12.0), given)
    found = outcome(disturbed(Walk().recorded(200.0, 100.0), *faulty), tmp_path)
    for foot in Walk().robot.feet:
        assert 10.0 < found.figure(f"settings.feet.{foot}.contact_on_n") < 20.0
