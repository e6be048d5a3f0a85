"""A dataset whose writer is killed between any two files is readable, and is mended."""

from collections.abc import Sequence
from dataclasses import field
from pathlib import Path
from typing import Any

import pyarrow.dataset as ds
import pytest

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.dataset.changing import change
from dogbot_logtool.report.dataset.files import Files
from dogbot_logtool.report.dataset.parts import NewLog, Part
from dogbot_logtool.report.dataset.rows import LogRows
from dogbot_logtool.report.dataset.schema import tables


class Killed(BaseException):
    """Stands for the end of the process."""


@dataclass(frozen=True, slots=True)
class FewFiles(Files):
    """Files of which only so many are written or removed."""

    left: list[int] = field(default_factory=lambda: [0])

    def write(self, table: str, part: Part, rows: Any, others: int = 0) -> None:
        self._count()
        Files.write(self, table, part, rows, others)

    def remove(self, table: str, part: Part) -> None:
        self._count()
        Files.remove(self, table, part)

    def _count(self) -> None:
        if self.left[0] == 0:
            raise Killed
        self.left[0] -= 1


def log(name: str, version: int, partition: str, strides: int) -> NewLog:
    log_id = f"{name}-{version}"
    feet: dict[str, list[Any]] = {"foot": ["left"] * strides, "start_s": [float(version)] * strides}
    row = {"log": name, "log_key": name, "log_id": log_id, "damaged": False}
    return NewLog(name, name, log_id, LogRows(partition, {}, {"strides": feet}), row, {})


BEFORE = [log("a", 1, "robot=x/month=1", 2), log("b", 1, "robot=x/month=1", 3)]
AFTER = [log("a", 2, "robot=y/month=1", 4), log("c", 1, "robot=x/month=1", 1)]


def rows(root: Path, table: str) -> list[dict[str, Any]]:
    return ds.dataset(root / table).to_table(["log", "log_id"]).to_pylist()  # type: ignore[no-any-return]


def strides(root: Path) -> dict[str, int]:
    """How many strides each log has, joined as users do."""
    ids = {row["log_id"]: row["log"] for row in rows(root, "logs")}
    found: dict[str, int] = dict.fromkeys(ids, 0)
    for row in rows(root, "strides"):
        if row["log_id"] in ids:
            found[row["log_id"]] += 1
    return found


def do(files: Files, new: Sequence[NewLog]) -> None:
    change(files, new)


@pytest.mark.parametrize("allowed", range(13))
def test_a_kill_between_two_files_leaves_a_readable_dataset(tmp_path: Path, allowed: int) -> None:
    files = Files(tmp_path)
    do(files, BEFORE)
    try:
        do(FewFiles(tmp_path, [allowed]), AFTER)
    except Killed:
        assert allowed < 12
    else:
        assert allowed >= 8
    found = strides(tmp_path)
    # The rows of a log that gives way may go before its row of `logs` does.
    assert found.pop("a-1", 0) in {0, 2}
    assert found.items() <= {"b-1": 3, "a-2": 4, "c-1": 1}.items()
    assert "b-1" in found

    do(files, AFTER)
    assert strides(tmp_path) == {"a-2": 4, "b-1": 3, "c-1": 1}
    assert len(rows(tmp_path, "strides")) == 8
    assert files.contents().is_sound


def test_files_without_a_row_in_logs_are_removed(tmp_path: Path) -> None:
    files = Files(tmp_path)
    do(files, BEFORE)
    (tmp_path / "logs" / "robot=x" / "month=1" / "part-0000.parquet").unlink()
    assert not files.contents().is_sound
    change(files)
    assert list(tmp_path.rglob("*.parquet")) == []


def test_a_name_means_the_same_in_all_tables() -> None:
    meanings: dict[str, set[str]] = {}
    for columns in tables().values():
        assert len({each.name for each in columns}) == len(columns)
        for each in columns:
            meanings.setdefault(each.name, set()).add(each.definition)
    assert {name: each for name, each in meanings.items() if len(each) > 1} == {}
