"""A store, a cluster and a few dozen small logs, all of them real."""

import contextlib
import json
import os
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
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
    """Run Python in the background."""
    running = subprocess.Popen(  # noqa: S603
        [sys.executable, *map(str, words)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), **(environment or {})},
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
    with process("-m", "tests.run.s3_server", folder):
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
def dask(what: str, *words: object, first: str, environment: Mapping[str, str]) -> Iterator[int]:
    """Run a scheduler or a worker that does something first; yields its process id."""
    script = f"import sys; {first or 'pass'}\nfrom distributed.cli.dask_{what} import main; main()"
    options = ("--host", "127.0.0.1", "--no-dashboard")
    with process("-c", script, *words, *options, environment=environment) as running:
        yield running.pid


@contextlib.contextmanager
def dask_scheduler(folder: Path, first: str = "") -> Iterator[str]:
    """Run a scheduler that gives up what has killed two workers; yields its address."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    settings = {"ALLOWED_FAILURES": "1", "WORKER_SATURATION": "1.0"}
    environment = {f"DASK_DISTRIBUTED__SCHEDULER__{key}": each for key, each in settings.items()}
    words = ("--port", 0, "--no-show", "--scheduler-file", file)
    with dask("scheduler", *words, first=first, environment=environment):
        yield wait_for(lambda: json.loads(file.read_text())["address"], what="no scheduler")


@contextlib.contextmanager
def dask_workers(
    address: str,
    count: int,
    folder: Path,
    first: str = "",
    environment: Mapping[str, str] | None = None,
) -> Iterator[list[int]]:
    """Run workers of one thread each; yields their process ids."""
    from distributed import Client  # noqa: PLC0415 - takes long to load

    names = {uuid.uuid4().hex for _ in range(count)}
    words = (address, "--nthreads", 1, "--no-nanny", "--local-directory", folder)

    def wait_until(satisfied: Callable[[set[str]], bool], what: str) -> None:
        with Client(address, set_as_default=False) as client:

            def listed() -> bool:
                workers = client.scheduler_info(n_workers=-1)["workers"].values()
                return satisfied({each["name"] for each in workers})

            wait_for(listed, what=what)

    with contextlib.ExitStack() as stack:
        workers = [
            stack.enter_context(
                dask("worker", *words, "--name", name, first=first, environment=environment or {})
            )
            for name in names
        ]
        wait_until(names.issubset, "the workers do not come")
        yield workers
    wait_until(names.isdisjoint, "the workers do not leave")


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
