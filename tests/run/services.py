"""A store, a cluster and a few dozen small logs, all of them real."""

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from moto.moto_server.werkzeug_app import DomainDispatcherApplication, create_backend_app
from werkzeug.serving import make_server

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


class Store:
    """A real S3 API on loopback with one bucket."""

    def __init__(self, port: int) -> None:
        self.environment = {
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}",
            "AWS_ACCESS_KEY_ID": "x",
            "AWS_SECRET_ACCESS_KEY": "x",
            "AWS_DEFAULT_REGION": "us-east-1",
        }
        self.read: set[str] = set()
        """Paths of what was read by parts."""

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
def store() -> Iterator[Store]:
    """Run an S3 server with one bucket."""
    backend = DomainDispatcherApplication(create_backend_app)

    def application(environ: dict[str, Any], start_response: Any) -> Iterable[bytes]:
        if "HTTP_RANGE" in environ:
            running.read.add(environ["PATH_INFO"])
        answer: Iterable[bytes] = backend(environ, start_response)
        return answer

    server = make_server("127.0.0.1", 0, application, threaded=True)
    running = Store(server.server_port)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        running.client.mkdir(BUCKET)
        yield running
    finally:
        # The server keeps what it stores in this process, where the next store would find it.
        running.client.rm(BUCKET, recursive=True)
        server.shutdown()
        thread.join()


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
