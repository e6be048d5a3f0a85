"""Rows that were gathered are written in time, and whatever ends the run."""

from pathlib import Path

import pytest

from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.report.dataset import dataset as module
from dogbot_logtool.report.dataset.dataset import Dataset, Entry, dataset_at, state_of
from dogbot_logtool.report.dataset.files import Files
from dogbot_logtool.report.dataset.rows import failed_rows


@pytest.fixture
def dataset(tmp_path: Path) -> Dataset:
    return dataset_at(tmp_path / "figures", StatsOptions(), {"spot": "rex"})


def entry(dataset: Dataset, name: str) -> Entry:
    log = dataset.root.parent / name
    assert isinstance(log, Path)
    log.write_bytes(b"")
    return Entry(log, state_of(log, dataset.settings_sha256), dataset.labels)


def stored(dataset: Dataset) -> list[str]:
    return [log.name.rpartition("/")[2] for log in Files(dataset.root).contents().logs]


def test_an_interrupted_run_keeps_what_was_measured(dataset: Dataset) -> None:
    def interrupted() -> None:
        with dataset.writer() as writer:
            writer.add(entry(dataset, "a.bag"), failed_rows("it failed"))
            assert stored(dataset) == []
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    (log,) = Files(dataset.root).contents().logs
    assert (log.error, log.labels) == ("it failed", {"spot": "rex"})


def test_rows_do_not_wait_for_ever(dataset: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_MOST_WAITING", 2)
    with dataset.writer() as writer:
        for name in ("c.bag", "a.bag", "b.bag"):
            writer.add(entry(dataset, name), failed_rows(""))
        assert stored(dataset) == ["a.bag", "c.bag"]
        monkeypatch.setattr(module, "_WRITTEN_AFTER_S", -1.0)
        writer.add(entry(dataset, "d.bag"), failed_rows(""))
        assert stored(dataset) == ["a.bag", "b.bag", "c.bag", "d.bag"]


def test_a_run_without_logs_writes_nothing(dataset: Dataset) -> None:
    with dataset.writer():
        pass
    assert not Path(str(dataset.root)).exists()
