"""Clusters that cannot do it are told within seconds; all of them are real ones on loopback."""

import contextlib
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dask
import pytest
from distributed import Client, LocalCluster

from dogbot_logtool.run import cluster
from dogbot_logtool.run.cluster import ClusterRunner
from tests.paths import TROT
from tests.run.work import Progress, work
from tests.shell import python

LACKS_PACKAGE = "import sys; sys.modules['dogbot_logtool'] = None"
OLD_PACKAGE = "import dogbot_logtool; dogbot_logtool.__version__ = '0.0.1'"
IMPATIENT = """
from dogbot_logtool.run import cluster
from dogbot_logtool.__main__ import main
cluster._CONNECT_S = 2
main()
"""
"""The program, but for how long it waits."""
WITHIN_S = 60.0
"""Nothing here takes more than seconds, but machines may be slow."""


@contextlib.contextmanager
def cluster_of(count: int) -> Iterator[LocalCluster]:
    """Run workers of one thread each, and a scheduler that gives up what has killed two."""
    settings = {"allowed-failures": 1, "worker-saturation": 1.0}
    options = {"threads_per_worker": 1, "host": "127.0.0.1", "dashboard_address": ":0"}
    with (
        dask.config.set({f"distributed.scheduler.{key}": each for key, each in settings.items()}),
        LocalCluster(n_workers=count, **options) as running,
    ):
        yield running


def runner_of(running: LocalCluster) -> contextlib.closing[ClusterRunner[Any]]:
    return contextlib.closing(ClusterRunner[Any](running.scheduler_address))


def test_an_address_without_scheduler() -> None:
    address = "tcp://127.0.0.1:9"
    done = python("-c", IMPATIENT, "stats", TROT, "--scheduler", address)
    assert (done.code, done.out) == (1, "")
    said = " ".join(done.err.split())
    assert f"error: --scheduler {address}: no scheduler answers there" in said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "what"), [(LACKS_PACKAGE, "No module named"), (OLD_PACKAGE, "the worker has")]
)
def test_a_worker_that_cannot_do_it(tmp_path: Path, first: str, what: str) -> None:
    """Items that it gets fail at once, and are not waited for."""
    with cluster_of(1) as running, runner_of(running) as runner:
        results = runner.run(work, [("slow", tmp_path)] * 200, Progress())
        assert next(results) == "SLOW"
        running.new_spec["options"]["preload"] = [first]
        running.scale(2)
        rest = list(results)
    failures = [found for found in rest if found != "SLOW"]
    assert len(rest) == 199
    assert failures
    assert all(what in failure.sentence for failure in failures)


def test_the_killer_of_workers_is_named_and_nothing_else(tmp_path: Path) -> None:
    items = ["slow", "a", "wrong", "slow", "deadly", "b", "slow", "slow"]
    progress = Progress()
    with cluster_of(6) as running, runner_of(running) as runner:
        found = list(runner.run(work, [(item, tmp_path) for item in items], progress))
    assert found[4].sentence.startswith("every worker that worked on it died")
    assert found[2].sentence == "no such file"
    rest = [outcome for number, outcome in enumerate(found) if number not in {2, 4}]
    assert rest == [item.upper() for item in items if item not in {"wrong", "deadly"}]
    assert 4 in progress.done
    assert 0 not in progress.lost_items


@pytest.mark.slow
def test_a_scheduler_that_is_lost(tmp_path: Path) -> None:
    with contextlib.ExitStack() as stack:
        with cluster_of(1) as running:
            runner = stack.enter_context(runner_of(running))
            runner.capacity = 10  # some are handed out when it is lost already
            results = runner.run(work, [("slow", tmp_path)] * 100, Progress())
            assert next(results) == "SLOW"
        rest = list(results)
    failures = [found for found in rest if found != "SLOW"]
    assert len(rest) == 99
    assert failures
    lost = f"was not done: the scheduler {running.scheduler_address} was lost"
    assert {failure.sentence for failure in failures} == {lost}


@pytest.mark.slow
def test_a_scheduler_without_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_WORKER_S", 2)
    with cluster_of(0) as running, runner_of(running) as runner:
        found = list(runner.run(work, [("slow", tmp_path)] * 2, Progress()))
    start = f"with: dask worker {running.scheduler_address}"
    assert [start in failure.sentence for failure in found] == [True, True]


@pytest.mark.slow
def test_an_interruption_leaves_the_cluster(tmp_path: Path) -> None:
    with cluster_of(1) as running:
        with runner_of(running) as runner:
            next(runner.run(work, [("slow", tmp_path)] * 1000, Progress()))
        with Client(running.scheduler_address, set_as_default=False) as client:
            end = time.monotonic() + WITHIN_S
            while any(client.processing().values()):
                assert time.monotonic() < end
                time.sleep(0.1)
