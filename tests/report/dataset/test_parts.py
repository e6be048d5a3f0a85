"""Which logs share a part, however many are written at a time."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import pytest

from dogbot_logtool.report.dataset import parts
from dogbot_logtool.report.dataset.parts import (
    Contents,
    NewLog,
    Part,
    StoredLog,
    planned_changes,
)
from dogbot_logtool.report.dataset.rows import LogRows


@pytest.fixture(autouse=True)
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three logs, or ten rows, fill a part."""
    monkeypatch.setattr(parts, "MOST_LOGS", 3)
    monkeypatch.setattr(parts, "MOST_ROWS", 10)


def new(key: str, partition: str = "p", rows: int = 1, **labels: str) -> NewLog:
    others = {"strides": {"foot": ["left"] * rows}}
    return NewLog(key, key, f"{key}-id", LogRows(partition, {}, others), {}, labels)


def held(contents: Contents) -> dict[str, Part]:
    return {log.key: log.part for log in contents.logs}


def after(contents: Contents, new_logs: Sequence[NewLog] = (), **words: Any) -> Contents:
    """What a dataset holds once it is changed."""
    changed = dict(planned_changes(contents, new_logs, **words))
    logs = [log for log in contents.logs if log.part not in changed]
    rows = {part: count for part, count in contents.rows.items() if part not in changed}
    for part, change in changed.items():
        logs += change.kept.values()
        logs += (
            StoredLog(part, each.key, each.name, each.log_id, None, None, each.labels)
            for each in change.new.values()
        )
        if change.kept or change.new:
            rows[part] = contents.rows.get(part, 0)
            rows[part] += sum(each.rows.count for each in change.new.values())
    return Contents(tuple(sorted(logs, key=lambda log: log.part)), rows)


def test_full_parts_take_no_more_logs() -> None:
    contents = after(Contents(), [new(f"log{number}") for number in range(7)])
    assert Counter(held(contents).values()) == {Part("p", 0): 3, Part("p", 1): 3, Part("p", 2): 1}


def test_a_log_with_many_rows_fills_a_part() -> None:
    contents = after(
        Contents(), [new("a", rows=25), new("b"), new("c", rows=9), new("d"), new("e")]
    )
    assert held(contents) == {
        "a": Part("p", 0),
        "b": Part("p", 1),
        "c": Part("p", 1),
        "d": Part("p", 2),
        "e": Part("p", 2),
    }


def test_parts_do_not_depend_on_how_many_logs_are_written_at_a_time() -> None:
    logs = [new(f"log{number}", "pq"[number % 2], rows=1 + number % 4) for number in range(20)]
    at_once = after(Contents(), logs)
    for size in (1, 3, 7):
        contents = Contents()
        for start in range(0, len(logs), size):
            contents = after(contents, logs[start : start + size])
        assert held(contents) == held(at_once)


def test_a_log_stays_in_its_part_and_leaves_one_of_another_partition() -> None:
    contents = after(Contents(), [new(key) for key in "abcd"])
    assert held(after(contents, [new("a")])) == held(contents)
    moved = after(contents, [new("a", "q")])
    assert held(moved) == {**held(contents), "a": Part("q", 0)}
    assert held(after(moved, [new("e")]))["e"] == Part("p", 0)


def test_parts_that_get_logs_come_first() -> None:
    contents = after(Contents(), [new("a", "p")])
    changes = planned_changes(contents, [new("a", "q")])
    assert [part.partition for part, _ in changes] == ["q", "p"]
    assert [bool(change.new or change.kept) for _, change in changes] == [True, False]


def test_of_a_log_that_is_there_twice_one_goes() -> None:
    contents = after(Contents(), [new("a", "p"), new("b", "p"), new("c", "q")])
    twice = Contents((*contents.logs, StoredLog(Part("q", 0), "a", "a", "x", None, None, {})))
    assert not twice.is_sound
    assert held(after(twice)) == {"a": Part("q", 0), "b": Part("p", 0), "c": Part("q", 0)}


def test_nothing_changes_without_a_change() -> None:
    contents = after(Contents(), [new("a")])
    assert planned_changes(contents) == []
    assert held(after(contents, dropped=["b"])) == held(contents)
    assert held(after(contents, dropped=["a"])) == {}


def test_all_parts_have_columns_of_the_same_labels() -> None:
    contents = after(Contents(), [new("a", "p"), new("b", "q")])
    names = {Part("p", 0): frozenset[str](), Part("q", 0): frozenset[str]()}
    labelled = Contents(contents.logs, contents.rows, names)
    changes = dict(planned_changes(labelled, labels={"a": {"spot": "rex"}}))
    assert changes.keys() == {Part("p", 0), Part("q", 0)}
    assert not any(change.changes_rows for change in changes.values())
    assert changes[Part("p", 0)].kept["a"].labels == {"spot": "rex"}
