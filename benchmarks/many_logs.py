"""Measures many short logs on this machine: ``python benchmarks/many_logs.py [LOGS]``.

Each is a second of a sample log, from another time of it. Processor time, of all processes, so that
a busy machine matters little: of `export --dataset` over all, of a second run, of `stats` without a
dataset, and of the same measurements in one process that has everything loaded.
"""

import os
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Final

import duckdb
from rosbags.rosbag1 import Reader, Writer

from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.options import MeasureOptions

SAMPLE: Final = Path(__file__).parents[1] / "sample_logs" / "dogbot_trot.bag"
JOBS: Final = 2
_SECOND: Final = 1_000_000_000
_SPAN: Final = 7 * _SECOND
"""ns, where the seconds begin."""
_QUERIES: Final = (
    "SELECT count(*), count(error), sum(messages) FROM '{}/logs/**/*.parquet'",
    "SELECT foot, avg(contact_fraction) FROM '{}/feet/**/*.parquet' GROUP BY foot ORDER BY foot",
    """SELECT type, container, count(*)
    FROM '{0}/events/**/*.parquet' JOIN '{0}/logs/**/*.parquet' USING (log_id)
    GROUP BY ALL ORDER BY ALL""",
)


def write_logs(folder: Path, count: int) -> list[Path]:
    """Write the logs."""
    with Reader(SAMPLE) as reader:
        channels = list(reader.connections)
        messages = [(each.id, at, bytes(data)) for each, at, data in reader.messages()]
    paths = [folder / f"log{number:04}.bag" for number in range(count)]
    for number, path in enumerate(paths):
        start = messages[0][1] + number * _SPAN // count
        writer = Writer(path)
        writer.set_compression(Writer.CompressionFormat.LZ4)
        with writer:
            own = {
                each.id: writer.add_connection(
                    each.topic, each.msgtype, msgdef=each.msgdef.data, md5sum=each.digest
                )
                for each in channels
            }
            for channel, at, data in messages:
                if start <= at < start + _SECOND:
                    writer.write(own[channel], at, data)
    return paths


def in_process(paths: list[Path]) -> float:
    """Measure the logs here, with everything loaded; s."""
    measure = partial(figures, options=MeasureOptions())
    measure(paths[0], None)
    start = time.process_time()
    for path in paths:
        measure(path, None)
    return time.process_time() - start


def run(*words: object) -> float:
    """Run a command; s, of it and of all processes that it has started."""
    before = os.times()
    command = [sys.executable, "-m", "dogbot_logtool", *map(str, words), "-q"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    return (
        after.children_user - before.children_user + after.children_system - before.children_system
    )


def main(count: int) -> None:
    """Print what each takes."""
    with tempfile.TemporaryDirectory() as folder:
        logs, figures = Path(folder) / "logs", Path(folder) / "figures"
        logs.mkdir()
        alone = in_process(write_logs(logs, count))
        plain = run("stats", logs, "--jobs", JOBS)
        first = run("export", logs, "--jobs", JOBS, "--dataset", figures)
        again = run("export", logs, "--jobs", JOBS, "--dataset", figures)
        print(f"{count} logs in one process        {alone:7.1f} s of a processor")
        print(f"stats --jobs {JOBS}                 {plain:7.1f} s, {plain / alone:.2f} of that")
        print(f"export --dataset --jobs {JOBS}      {first:7.1f} s, {first / alone:.2f} of that")
        print(f"the same once more             {again:7.1f} s")
        for query in _QUERIES:
            start = time.process_time()
            rows = duckdb.connect().execute(query.format(figures)).fetchall()
            print(f"{time.process_time() - start:.2f} s  {rows}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 500)
