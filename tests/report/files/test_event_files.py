"""Files of events: BIDS' table, EUROBENCH's lists; written, and read by other libraries."""

import csv
from typing import Any

import pytest
from ruamel.yaml import YAML

from dogbot_logtool.errors import LogError
from dogbot_logtool.report.figures.events import EVENT_COLUMNS
from dogbot_logtool.report.files.event_files import event_file


def document(feet: dict[str, Any]) -> dict[str, Any]:
    return {"events": EVENTS, "feet": {name: {"place": place} for name, place in feet.items()}}


def event(onset_s: float, kind: str, foot: str | None = None, **more: object) -> dict[str, Any]:
    return {**dict.fromkeys(EVENT_COLUMNS), "onset_s": onset_s, "type": kind, "foot": foot, **more}


EVENTS = [
    event(0.5, "touchdown", "left_foot", duration_s=0.0),
    event(1.0, "lift_off", "left_foot", duration_s=0.0),
    event(1.25, "touchdown", "right_foot", duration_s=0.0),
    event(1.5, "fall", None, duration_s=2.0, code="W_FALL"),
    event(2.5, "touchdown", "left_foot", duration_s=0.0),
]


def test_bids_has_its_columns_and_says_what_is_not_known() -> None:
    text = event_file(".tsv", document({"left_foot": None, "right_foot": None}))
    rows = list(csv.DictReader(text.splitlines(), delimiter="\t"))
    assert list(rows[0])[:3] == ["onset", "duration", "trial_type"]
    assert [float(row["onset"]) for row in rows] == [0.5, 1.0, 1.25, 1.5, 2.5]
    assert rows[3] == {
        "onset": "1.5",
        "duration": "2.0",
        "trial_type": "fall",
        "foot": "n/a",
        "value": "n/a",
        "unit": "n/a",
        "code": "W_FALL",
    }


@pytest.mark.parametrize("suffix", [".yaml", ".yml"])
@pytest.mark.parametrize(
    "feet",
    [
        {"left_foot": None, "right_foot": None},
        {"left_foot": ["middle", "left"], "right_foot": ["middle", "right"]},
    ],
)
def test_eurobench_has_lists_of_seconds(suffix: str, feet: dict[str, Any]) -> None:
    assert YAML(typ="safe").load(event_file(suffix, document(feet))) == {
        "l_heel_strike": [0.5, 2.5],
        "l_toe_off": [1.0],
        "r_heel_strike": [1.25],
        "r_toe_off": [],
    }


@pytest.mark.parametrize("feet", [{"a": None, "b": None}, {"left": None}, {}])
def test_eurobench_cannot_hold_other_feet(feet: dict[str, None]) -> None:
    with pytest.raises(LogError, match=r"a left and a right foot.*\.tsv or \.csv"):
        event_file(".yaml", document(feet))
