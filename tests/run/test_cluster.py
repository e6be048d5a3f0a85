"""Clusters that cannot do it are told within seconds; all of them are real ones on loopback."""

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from distributed import Client

from dogbot_logtool.run import cluster
from dogbot_logtool.run.cluster import ClusterRunner
from tests.paths import ROOT
from tests.run.services import dask_scheduler as scheduler
from tests.run.services import dask_workers as workers
from tests.run.work import Progress, work

TROT = ROOT / "sample_logs" / "dogbot_trot.bag"
LACKS_PACKAGE = "sys.modules['dogbot_logtool'] = None"
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


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A scheduler that has no workers of its own, and lacks this package."""
    with scheduler(tmp_path_factory.mktemp("dask"), LACKS_PACKAGE) as found:
        yield found


def refused(address: str) -> str:
    """Run the program with a scheduler that cannot do it; return what it says."""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", IMPATIENT, "stats", str(TROT), "--scheduler", address],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=WITHIN_S,
    )
    assert (done.returncode, done.stdout) == (1, ""), done
    assert "Traceback" not in done.stderr
    said = " ".join(done.stderr.split())
    assert f"error: --scheduler {address}: " in said
    return said


def test_an_address_without_scheduler() -> None:
    assert "no scheduler answers there" in refused("tcp://127.0.0.1:9")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "what"),
    [(LACKS_PACKAGE, "No module named"), (OLD_PACKAGE, "the worker has")],
)
def test_a_worker_that_cannot_do_it(address: str, tmp_path: Path, first: str, what: str) -> None:
    """Items that it gets fail at once, and are not waited for."""
    with workers(address, 1, tmp_path), contextlib.closing(ClusterRunner[Any](address)) as runner:
        results = runner.run(work, [("slow", tmp_path)] * 200, Progress())
        assert next(results) == "SLOW"
        with workers(address, 1, tmp_path, first):
            rest = list(results)
    failures = [found for found in rest if found != "SLOW"]
    assert len(rest) == 199
    assert failures
    assert all(what in failure.sentence for failure in failures)


def test_the_killer_of_workers_is_named_and_nothing_else(address: str, tmp_path: Path) -> None:
    items = ["slow", "a", "wrong", "slow", "deadly", "b", "slow", "slow"]
    progress = Progress()
    with workers(address, 6, tmp_path), contextlib.closing(ClusterRunner[Any](address)) as runner:
        found = list(runner.run(work, [(item, tmp_path) for item in items], progress))
    assert found[4].sentence.startswith("every worker that worked on it died")
    assert found[2].sentence == "no such file"
    rest = [outcome for number, outcome in enumerate(found) if number not in {2, 4}]
    assert rest == [item.upper() for item in items if item not in {"wrong", "deadly"}]
    assert 4 in progress.done
    assert 0 not in progress.lost_items


@pytest.mark.slow
def test_a_scheduler_that_is_lost(tmp_path: Path) -> None:
    progress = Progress()
    items = [("slow", tmp_path)] * 100
    with contextlib.ExitStack() as stack:
        with scheduler(tmp_path) as address, workers(address, 1, tmp_path):
            runner = stack.enter_context(contextlib.closing(ClusterRunner[Any](address)))
            runner.capacity = 10  # some are handed out when it is lost already
            results = runner.run(work, items, progress)
            assert next(results) == "SLOW"
        rest = list(results)
    failures = [found for found in rest if found != "SLOW"]
    assert len(rest) == 99
    assert failures
    assert {failure.sentence for failure in failures} == {
        f"was not done: the scheduler {address} was lost"
    }


@pytest.mark.slow
def test_a_scheduler_without_workers(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_WORKER_S", 2)
    with contextlib.closing(ClusterRunner[Any](address)) as runner:
        found = list(runner.run(work, [("slow", tmp_path)] * 2, Progress()))
    assert len(found) == 2
    assert all(f"with: dask worker {address}" in failure.sentence for failure in found)


@pytest.mark.slow
def test_an_interruption_leaves_the_cluster(address: str, tmp_path: Path) -> None:
    with workers(address, 1, tmp_path):
        with contextlib.closing(ClusterRunner[Any](address)) as runner:
            next(runner.run(work, [("slow", tmp_path)] * 1000, Progress()))
        with Client(address, set_as_default=False) as client:
            end = time.monotonic() + WITHIN_S
            while any(client.processing().values()):
                assert time.monotonic() < end
                time.sleep(0.1)
