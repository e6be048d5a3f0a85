"""A store, a cluster and a few dozen small logs, all of them real."""

import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tests.oracles.walks import START, Walk, write_mcap
from tests.paths import ROOT
from tests.shell import Outcome

BUCKET: Final = "lab"
CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
_PATIENCE_S: Final = 60.0


def wait_for(found: Any, *, what: str) -> Any:
    """Ask until there is an answer."""
    end = time.monotonic() + _PATIENCE_S
    while time.monotonic() < end:
        with contextlib.suppress(FileNotFoundError, ValueError):
            if answer := found():
                return answer
        time.sleep(0.05)
    raise TimeoutError(what)


@contextlib.contextmanager
def process(
    *words: object, environment: Mapping[str, str] | None = None
) -> Iterator[subprocess.Popen[bytes]]:
    """Run a Python module in the background."""
    running = subprocess.Popen(  # noqa: S603
        [sys.executable, "-m", *map(str, words)],
        cwd=ROOT,
        env={**os.environ, **(environment or {})},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield running
    finally:
        running.kill()
        running.wait()


@dataclass(frozen=True, slots=True)
class Store:
    """The S3 server, as its clients see it."""

    folder: Path
    environment: Mapping[str, str]

    @property
    def client(self) -> Any:
        import s3fs  # noqa: PLC0415 - takes long to load

        return s3fs.S3FileSystem(
            key="x",
            secret="x",  # noqa: S106
            endpoint_url=self.environment["AWS_ENDPOINT_URL"],
            skip_instance_cache=True,
            use_listings_cache=False,
        )

    def requests(self) -> list[dict[str, Any]]:
        text = (self.folder / "requests.jsonl").read_text()
        return [json.loads(line) for line in text.splitlines()]

    @contextlib.contextmanager
    def failing(self, every: int) -> Iterator[None]:
        """Answer every n-th request with 503."""
        switch = self.folder / "fail_every"
        switch.write_text(str(every))
        try:
            yield
        finally:
            switch.unlink()

    def run(self, *words: object, folder: Path) -> Outcome:
        """Run the command as a process of its own."""
        done = subprocess.run(  # noqa: S603
            [sys.executable, "-m", "dogbot_logtool", *map(str, words)],
            cwd=folder,
            env={**os.environ, **self.environment, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=False,
            timeout=240,
        )
        assert "Traceback" not in done.stderr, done.stderr
        return Outcome(done.returncode, done.stdout, done.stderr)


@contextlib.contextmanager
def store(folder: Path) -> Iterator[Store]:
    """Run an S3 server with one bucket."""
    with process("tests.run.s3_server", folder):
        port = wait_for((folder / "port").read_text, what="the store does not start")
        environment = {
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}",
            "AWS_ACCESS_KEY_ID": "x",
            "AWS_SECRET_ACCESS_KEY": "x",
            "AWS_DEFAULT_REGION": "us-east-1",
        }
        running = Store(folder, environment)
        running.client.mkdir(BUCKET)
        yield running


@contextlib.contextmanager
def dask_scheduler(port: int = 0, *, folder: Path) -> Iterator[str]:
    """Run a scheduler that gives up what has killed two workers; yields its address."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    words = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", port]
    words += ["--no-dashboard", "--no-show", "--scheduler-file", file]
    settings = {"ALLOWED_FAILURES": "1", "WORKER_SATURATION": "1.0"}
    environment = {f"DASK_DISTRIBUTED__SCHEDULER__{key}": each for key, each in settings.items()}
    with process(*words, environment=environment):
        yield wait_for(lambda: json.loads(file.read_text())["address"], what="no scheduler")


@contextlib.contextmanager
def dask_workers(
    address: str, environment: Mapping[str, str], *, folder: Path, count: int = 2
) -> Iterator[list[int]]:
    """Run workers of one thread each; yields their process ids."""
    from distributed import Client  # noqa: PLC0415 - takes long to load

    words = ["distributed.cli.dask_worker", address, "--nthreads", 1, "--no-nanny"]
    words += ["--no-dashboard", "--local-directory", folder, "--host", "127.0.0.1"]
    environment = {**environment, "PYTHONPATH": str(ROOT)}
    with contextlib.ExitStack() as stack:
        workers = [
            stack.enter_context(process(*words, environment=environment)) for _ in range(count)
        ]
        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(count, timeout=_PATIENCE_S)
        yield [worker.pid for worker in workers]


def small_logs(folder: Path) -> list[Path]:
    """Write four walks of different lengths, one a month later, and a damaged one."""
    walk = Walk(2)
    entries = list(walk.messages(CONTACTS))
    logs: list[Path] = []
    for number, seconds in enumerate((1.8, 2.2, 2.6, 3.4)):
        path = folder / f"walk{number}.mcap"
        write_mcap(path, walk, [e for e in entries if e.log_time < START + seconds * 1e9])
        logs.append(path)
    damaged = folder / "damaged.mcap"
    whole = logs[3].read_bytes()
    damaged.write_bytes(whole[: len(whole) // 2])
    return [*logs, damaged]


def named(logs: Sequence[Path], count: int, damaged: int) -> dict[str, Path]:
    """Return names of many logs, some of them damaged, and the file that each is a copy of."""
    every = count // damaged
    return {
        f"day{number % 7}/walk{number:03}.mcap": logs[-1]
        if number % every == every - 1
        else logs[number % (len(logs) - 1)]
        for number in range(count)
    }
