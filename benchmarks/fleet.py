"""Measures the parts that SCALING.md reckons with: ``python benchmarks/fleet.py [SECONDS]``.

Processor time, not wall time, so that a busy machine matters little; the least of three runs.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from distributed import LocalCluster
from make_log import write_bag, write_mcap
from upath import UPath

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.reader.containers.source import RemoteSource
from dogbot_logtool.run.cluster import ClusterRunner
from dogbot_logtool.run.runner import OnProgress

TASKS: Final = 10_000


class Silent:
    """Follows a run without a word."""

    def update(self, number: int, done: int, total: int) -> None:
        """See `Progress`."""

    def finished(self, number: int) -> None:
        """See `Progress`."""

    def lost(self, number: int) -> None:
        """See `Progress`."""

    def say(self, sentence: str) -> None:
        """See `Progress`."""


def nothing(item: object, on_progress: OnProgress | None) -> object:
    """Do nothing, on a worker."""
    del on_progress
    return item


def least_s(work: Callable[[], object]) -> float:
    """Return processor seconds."""
    times = []
    for _ in range(3):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def fetched(work: Callable[[UPath], object], log: Path) -> tuple[int, int]:
    """Return requests, and bytes, that a command makes of a log in a store."""
    sizes: list[int] = []
    fetch = RemoteSource._fetch  # noqa: SLF001 - where all bytes come through

    def counted(source: RemoteSource, ranges: Sequence[tuple[int, int]]) -> list[bytes]:
        sizes.extend(end - start for start, end in ranges)
        return fetch(source, ranges)

    place = UPath(f"memory://{log.name}")
    place.fs.pipe_file(place.path, log.read_bytes())
    RemoteSource._fetch = counted  # type: ignore[method-assign]  # noqa: SLF001
    try:
        work(place)
    finally:
        RemoteSource._fetch = fetch  # type: ignore[method-assign]  # noqa: SLF001
        place.fs.rm_file(place.path)
    return len(sizes), sum(sizes)


def main() -> None:
    """Print what is measured."""
    seconds = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    with tempfile.TemporaryDirectory() as folder:
        logs = Path(folder) / "walk.bag", Path(folder) / "walk.mcap"
        write_bag(logs[0], seconds, "lz4")
        write_mcap(logs[1], seconds, "ros1")
        out = Path(folder) / "out.mcap"
        part = ConvertOptions(start=seconds / 2, end=seconds / 2 + 5, overwrite=True)
        for log in logs:
            size = log.stat().st_size
            print(f"{log.name}: {size / 1e6:.0f} MB")
            for name, work in (
                ("stats", lambda p: measure(p, MeasureOptions())),
                ("convert", lambda p: convert(p, out, ConvertOptions(overwrite=True))),
            ):
                spent = least_s(lambda w=work, p=log: w(p))
                print(f"  {name}: {spent:.2f} s, {size / 1e6 / spent:.0f} MB a second")
            for name, work in (
                ("info", lambda p: describe(p, InfoOptions())),
                ("convert of 5 s", lambda p: convert(p, out, part)),
                ("stats", lambda p: measure(p, MeasureOptions())),
            ):
                requests, read = fetched(work, log)
                print(f"  {name}: {requests} requests, {read / 1e6:.1f} MB ({read / size:.1%})")
    with (
        LocalCluster(2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as local,
        ClusterRunner[object](local.scheduler_address) as runner,
    ):
        names = [f"s3://lab/2026/11/robot/log{number:05}.mcap" for number in range(TASKS)]
        start, wall = time.process_time(), time.perf_counter()
        for _ in runner.run(nothing, names, Silent()):
            pass
        spent, wall = time.process_time() - start, time.perf_counter() - wall
    print(f"{TASKS} tasks of nothing: {spent / TASKS * 1e3:.2f} ms each, in {wall:.0f} s")


if __name__ == "__main__":
    main()
