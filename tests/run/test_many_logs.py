"""Sixty logs in an S3 store, on a cluster of two workers, one of which dies: all of it real."""

import os
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow.dataset as ds
import pytest
from upath import UPath

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from tests.run.services import (
    BUCKET,
    Store,
    dask_scheduler,
    dask_workers,
    named,
    small_logs,
    store,
    wait_for,
)

pytestmark = pytest.mark.slow
LOGS = 60
DAMAGED = 5


@dataclass(frozen=True, slots=True)
class Lab:
    """A store full of logs, and a cluster."""

    store: Store
    scheduler: str
    workers: list[int]
    """Process ids."""
    logs: Mapping[str, Path]
    """By name in the store, the file that it is a copy of."""
    figures: Path
    """Where figures are kept."""

    def table(self, name: str) -> list[dict[str, Any]]:
        rows: list[dict[str, Any]] = ds.dataset(self.figures / name).to_table().to_pylist()
        return rows

    def unfinished_uploads(self) -> list[Any]:
        return list(self.store.client.list_multipart_uploads(BUCKET))


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    folders = [tmp_path_factory.mktemp(name) for name in ("dask", "logs", "figures")]
    logs = named(small_logs(folders[1]), LOGS, DAMAGED)
    with (
        store() as running,
        dask_scheduler(folders[0]) as address,
        dask_workers(address, 2, folders[0], environment=running.environment) as workers,
    ):
        content = {f"{BUCKET}/logs/{name}": path.read_bytes() for name, path in logs.items()}
        running.client.pipe(content)
        yield Lab(running, address, workers, logs, folders[2] / "figures")


@pytest.fixture(scope="module")
def serial(lab: Lab) -> dict[Path, Any]:
    """Figures of each different log, measured here."""
    measure = partial(figures, options=MeasureOptions())
    return {path: measure(path) for path in set(lab.logs.values())}


def kill_a_worker(lab: Lab, *, when: int) -> threading.Thread:
    """Kill one as soon as some logs were read."""

    def kill() -> None:
        wait_for(lambda: len(lab.store.read) >= when, what="no log is read")
        os.kill(lab.workers[0], signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    return thread


def test_figures_are_those_of_a_serial_run_though_a_worker_dies(
    lab: Lab, serial: Mapping[Path, Any], tmp_path: Path
) -> None:
    killer = kill_a_worker(lab, when=5)
    done = lab.store.run(
        *("export", f"s3://{BUCKET}/logs", "--dataset", lab.figures),
        *("--scheduler", lab.scheduler),
        folder=tmp_path,
    )
    killer.join()

    assert done.code == 3, done.err
    logs, strides = lab.table("logs"), lab.table("strides")
    paths = {row["log_hash"]: row["path"] for row in logs}
    assert sorted(paths.values()) == sorted(f"s3://{BUCKET}/logs/{name}" for name in lab.logs)
    expected = {f"s3://{BUCKET}/logs/{name}": serial[path] for name, path in lab.logs.items()}
    for row in logs:
        figures = expected[row["path"]]
        assert row["base"] == figures.json["base"]
        assert row["settings"]["robot"] == figures.json["settings"]["robot"]
        assert row["log"]["lost_messages"] == figures.json["log"]["lost_messages"]
    assert sum(row["log"]["lost_bytes"] > 0 for row in logs) == DAMAGED
    for name, figures in expected.items():
        found = [row["duty_factor"] for row in strides if paths[row["log_hash"]] == name]
        assert found == figures.strides.columns["duty_factor"].tolist()


def test_figures_are_kept_in_a_store_alike(lab: Lab, tmp_path: Path) -> None:
    url = f"s3://{BUCKET}/figures"
    words = ["export", f"s3://{BUCKET}/logs/day1/walk00*.mcap", "--dataset", url, "--jobs", 1]
    assert lab.store.run(*words, folder=tmp_path).code == 0
    assert "2 logs are there already, unchanged" in lab.store.run(*words, folder=tmp_path).err
    table = ds.dataset(f"{BUCKET}/figures/logs", filesystem=lab.store.client).to_table()
    assert len(set(table.column("path").to_pylist())) == table.num_rows == 2


def test_annotated_logs_are_those_of_a_serial_run(lab: Lab, tmp_path: Path) -> None:
    names = [name for name in lab.logs if name.startswith("day4/")]
    assert len({lab.logs[name] for name in names}) == 5
    (tmp_path / "list.txt").write_text("".join(f"s3://{BUCKET}/logs/{name}\n" for name in names))

    done = lab.store.run(
        *("convert", "@list.txt", "-o", f"s3://{BUCKET}/annotated/"),
        *("--scheduler", lab.scheduler, "--json", "-q"),
        folder=tmp_path,
    )

    assert done.code == 3, done.err
    assert [each["input"] for each in done.json] == [f"s3://{BUCKET}/logs/{n}" for n in names]
    client = lab.store.client
    for name in names:
        source = tmp_path / Path(name).name
        source.write_bytes(lab.logs[name].read_bytes())
        target = tmp_path / f"{source.stem}.annotated.mcap"
        convert(source, target, ConvertOptions())
        assert client.cat_file(f"{BUCKET}/annotated/{target.name}") == target.read_bytes()
    assert len(client.find(f"{BUCKET}/annotated")) == len(names)
    assert lab.unfinished_uploads() == []


def place_in(lab: Lab, name: str, bucket: str = BUCKET) -> UPath:
    url = lab.store.environment["AWS_ENDPOINT_URL"]
    return UPath(f"s3://{bucket}/{name}", key="x", secret="x", endpoint_url=url)  # noqa: S106


def break_off(target: UPath, uploads: Callable[[], list[Any]]) -> None:
    with whole_file(target, overwrite=False) as file:
        file.write(bytes(60 << 20))
        assert uploads() != []
        raise KeyboardInterrupt


def test_an_upload_that_is_broken_off_leaves_nothing(lab: Lab) -> None:
    target = place_in(lab, "half.mcap")
    with pytest.raises(KeyboardInterrupt):
        break_off(target, lab.unfinished_uploads)
    assert lab.unfinished_uploads() == []
    assert not target.exists()


def write(target: UPath, data: bytes, *, overwrite: bool) -> None:
    with whole_file(target, overwrite=overwrite) as file:
        file.write(data)


def test_an_object_is_not_overwritten_unasked(lab: Lab) -> None:
    target = place_in(lab, "there.mcap")
    write(target, b"old", overwrite=False)
    with pytest.raises(CallError, match="exists already"):
        write(target, b"new", overwrite=False)
    assert target.read_bytes() == b"old"
    write(target, b"new", overwrite=True)
    assert target.read_bytes() == b"new"
    assert lab.unfinished_uploads() == []
    with pytest.raises(LogtoolError, match="cannot be written"):
        write(place_in(lab, "x", "absent"), b"new", overwrite=True)
