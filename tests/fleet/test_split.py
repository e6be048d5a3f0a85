"""One log in many parts, by two real workers: the same bytes and figures as by one core."""

import json
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.convert import Conversion, convert
from dogbot_logtool.fleet import parts
from dogbot_logtool.fleet.cluster import Cluster
from dogbot_logtool.fleet.engine import Failure
from dogbot_logtool.fleet.splitting import SPLIT_ABOVE, Splitting
from dogbot_logtool.fleet.tasks import Convert, Figures, Measure, Order
from dogbot_logtool.plan import ConvertOptions
from dogbot_logtool.stats import StatsOptions
from tests.fleet.services import dask_scheduler, dask_workers

SAMPLE_LOGS = Path(__file__).parents[2] / "sample_logs"
TROT, TROUBLED, WALK = (
    SAMPLE_LOGS / name for name in ("dogbot_trot.bag", "dogbot_troubled.bag", "dogbot_walk.mcap")
)
PART_SIZE = 50_000


class Watcher:
    def __init__(self, when_told: Callable[[], None] | None = None) -> None:
        self.sentences: list[str] = []
        self.done: list[int] = []
        self.progress: list[tuple[int, int, int]] = []
        self._when_told = when_told

    def told(self, number: int, done: int, total: int) -> None:
        self.progress.append((number, done, total))
        if self._when_told is not None:
            self._when_told()
            self._when_told = None

    def finished(self, number: int) -> None:
        self.done.append(number)

    def say(self, sentence: str) -> None:
        self.sentences.append(sentence)


class Counting(Cluster[Any]):
    """Remembers how many items each run had."""

    def __init__(self, scheduler: str) -> None:
        super().__init__(scheduler)
        self.runs: list[int] = []

    def run(self, work: Any, items: Sequence[Any], *rest: Any) -> Iterator[Any]:
        self.runs.append(len(items))
        return super().run(work, items, *rest)


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("dask")
    with dask_scheduler(folder=folder) as address, dask_workers(address, {}, folder=folder):
        yield address


@pytest.fixture(autouse=True)
def _small_batches(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of this process: workers are told which chunks make a batch."""
    monkeypatch.setattr("dogbot_logtool.reader.log.BATCH_SIZE", 1)


def damaged(folder: Path, log: Path) -> Path:
    """Cut a log, so that it has no index, and spoil a chunk."""
    data = bytearray(log.read_bytes())
    place = len(data) // 3
    data[place : place + 40] = b"x" * 40
    path = folder / f"damaged{log.suffix}"
    path.write_bytes(data[: len(data) * 4 // 5])
    return path


def both(
    scheduler: str, log: Path, folder: Path, options: ConvertOptions, watcher: Watcher
) -> tuple[Conversion, Conversion, list[int]]:
    """Convert a log on one core, and in parts; return both, and how many parts there were."""
    whole = convert(log, folder / "whole.mcap", options)
    order = Order(log, folder / "joined.mcap", was_free=True)
    with Counting(scheduler) as engine:
        (joined,) = Splitting[Any](engine, 0, PART_SIZE).run(Convert(options), [order], watcher)
        assert isinstance(joined, Conversion), joined
        return whole, joined, engine.runs


@pytest.mark.parametrize(
    ("log", "options"),
    [
        (TROT, ConvertOptions()),
        (TROT, ConvertOptions(style="force", encoding="ros2", copy=False, start_s=1.0, end_s=6.0)),
        (TROUBLED, ConvertOptions(style="force", tf_rate_hz=7.0)),
        (WALK, ConvertOptions(encoding="ros1")),
        (WALK, ConvertOptions(style="classic", compression="lz4")),
    ],
)
def test_bytes_are_those_of_one_core(
    log: Path, options: ConvertOptions, scheduler: str, tmp_path: Path
) -> None:
    watcher = Watcher()
    whole, joined, runs = both(scheduler, log, tmp_path, options, watcher)
    assert (tmp_path / "joined.mcap").read_bytes() == (tmp_path / "whole.mcap").read_bytes()
    assert replace(joined, target=whole.target, plan=whole.plan) == whole
    # One run reads what is carried over, and one converts.
    assert runs[0] == runs[1] > 2
    assert watcher.done == [0]
    assert watcher.progress != []


@pytest.mark.parametrize("log", [TROUBLED, WALK])
def test_damage_is_told_as_by_one_core(log: Path, scheduler: str, tmp_path: Path) -> None:
    path = damaged(tmp_path, log)
    whole, joined, runs = both(scheduler, path, tmp_path, ConvertOptions(), Watcher())
    assert (tmp_path / "joined.mcap").read_bytes() == (tmp_path / "whole.mcap").read_bytes()
    assert joined.losses == whole.losses != ()
    assert joined.exit_code == 3
    assert min(runs) > 2


def told(figures: Figures) -> str:
    return json.dumps([figures.summary, figures.json, figures.exit_code, repr(figures.strides)])


def test_figures_are_those_of_one_core(scheduler: str, tmp_path: Path) -> None:
    """Huge ones in parts and others whole: results come in the order of the logs."""
    logs = [TROUBLED, TROT, WALK, damaged(tmp_path, WALK), tmp_path / "absent.mcap"]
    measure = Measure(StatsOptions(wrench_frame="link"))
    watcher = Watcher()
    with Counting(scheduler) as engine:
        splitting = Splitting[Any](engine, TROUBLED.stat().st_size, PART_SIZE)
        *figures, failed = splitting.run(measure, logs, watcher)
        assert engine.runs[0] == engine.runs[-1] == 1
        assert len(engine.runs) == 5
        assert min(engine.runs[1:-1]) > 2
    for log, found in zip(logs[:-1], figures, strict=True):
        assert isinstance(found, Figures), found
        assert told(found) == told(measure(log, None))
    assert failed == Failure(f"{logs[-1]}: no such file", 2)
    assert watcher.done == list(range(len(logs)))


def test_a_lost_worker_s_parts_are_done_by_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts, "PARTS_AHEAD", 2)
    with (
        dask_scheduler(folder=tmp_path) as address,
        dask_workers(address, {}, folder=tmp_path) as workers,
    ):
        watcher = Watcher(lambda: os.kill(workers[0], signal.SIGKILL))
        _, joined, _ = both(address, TROT, tmp_path, ConvertOptions(), watcher)
    assert joined.exit_code == 0
    assert any("was lost; others do what it had in hand" in said for said in watcher.sentences)
    assert (tmp_path / "joined.mcap").read_bytes() == (tmp_path / "whole.mcap").read_bytes()


def test_a_part_that_fails_fails_its_log_only(
    scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Workers find another log than was sent to them."""
    target = tmp_path / "out" / "trot.mcap"
    target.parent.mkdir()
    orders = [Order(log, target.with_stem(log.stem), was_free=True) for log in (TROT, WALK)]
    first_is_wrong = iter(["no such index"])
    index_of = parts.index_of
    monkeypatch.setattr(parts, "index_of", lambda log: next(first_is_wrong, "") or index_of(log))
    with Cluster[Any](scheduler) as cluster:
        splitting = Splitting[Any](cluster, 0, PART_SIZE)
        failed, done = splitting.run(Convert(ConvertOptions()), orders, Watcher())
    assert isinstance(failed, Failure)
    assert "is another log to a worker" in failed.sentence
    assert done.exit_code == 0
    assert [file.name for file in target.parent.iterdir()] == ["dogbot_walk.mcap"]


def test_only_huge_logs_are_split(scheduler: str) -> None:
    assert SPLIT_ABOVE > 100 * parts.PART_SIZE / 2
    with Counting(scheduler) as engine:
        (_,) = Splitting[Any](engine).run(Measure(StatsOptions()), [TROUBLED], Watcher())
        assert engine.runs == [1]


def test_a_scheduler_that_stays_away_fails_every_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("dogbot_logtool.fleet.cluster._PATIENCE_S", 1)
    measure = Measure(StatsOptions())
    with Splitting[Any](_cluster_without_scheduler(tmp_path), TROUBLED.stat().st_size) as engine:
        outcomes = list(engine.run(measure, [TROUBLED, TROT, WALK, TROUBLED], Watcher()))
    assert [type(outcome) for outcome in outcomes] == [Failure] * 4
    assert all("the scheduler" in outcome.sentence for outcome in outcomes)
    assert all(outcome.sentence.endswith("was lost") for outcome in outcomes)


def _cluster_without_scheduler(folder: Path) -> Cluster[Any]:
    with dask_scheduler(folder=folder) as address:
        return Cluster(address)
