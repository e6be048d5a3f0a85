"""Sixty logs in an S3 store, on a cluster of two workers, one of which dies: all of it real."""

import json
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import pyarrow.dataset as ds
import pytest
from distributed import LocalCluster
from moto.server import ThreadedMotoServer
from upath import UPath

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.errors import CallError, LogtoolError
from dogbot_logtool.io.output import whole_file
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from tests import forked_cli
from tests.oracles.walks import START, Walk, write_mcap
from tests.run.test_cluster import cluster_of

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("lab")]
BUCKET: Final = "lab"
LOGS: Final = 60
DAMAGED: Final = 5


@dataclass(frozen=True, slots=True)
class Lab:
    """A store full of logs, and a cluster."""

    cluster: LocalCluster
    logs: Mapping[str, Path]
    """By name in the store, the file that it is a copy of."""
    figures: Path
    """Where figures are kept."""

    @property
    def scheduler(self) -> str:
        return str(self.cluster.scheduler_address)

    def table(self, name: str) -> list[dict[str, Any]]:
        rows: list[dict[str, Any]] = ds.dataset(self.figures / name).to_table().to_pylist()
        return rows


def in_store(name: str = "", bucket: str = BUCKET) -> UPath:
    return UPath(f"s3://{bucket}/{name}", use_listings_cache=False)


def unfinished_uploads() -> list[Any]:
    return list(in_store().fs.list_multipart_uploads(BUCKET))


def small_logs(folder: Path) -> list[Path]:
    """Write four walks of different lengths, and a damaged one."""
    walk = Walk(2)
    entries = list(walk.messages("gazebo_msgs/msg/ContactsState"))
    logs = [folder / f"walk{number}.mcap" for number in range(4)]
    for path, seconds in zip(logs, (1.8, 2.2, 2.6, 3.4), strict=True):
        write_mcap(path, walk, [e for e in entries if e.log_time < START + seconds * 1e9])
    whole = logs[3].read_bytes()
    (folder / "damaged.mcap").write_bytes(whole[: len(whole) // 2])
    return [*logs, folder / "damaged.mcap"]


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    files = small_logs(tmp_path_factory.mktemp("logs"))
    every = LOGS // DAMAGED
    logs = {
        f"day{number % 7}/walk{number:03}.mcap": files[4 if number % every == 11 else number % 4]
        for number in range(LOGS)
    }
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    _, port = server.get_host_and_port()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AWS_ENDPOINT_URL", f"http://127.0.0.1:{port}")
        for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
            patch.setenv(name, "x")
        patch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        in_store().fs.mkdir(BUCKET)
        content = {f"{BUCKET}/logs/{name}": path.read_bytes() for name, path in logs.items()}
        in_store().fs.pipe(content)
        with cluster_of(2) as cluster:
            yield Lab(cluster, logs, tmp_path_factory.mktemp("figures") / "figures")
    server.stop()


@pytest.fixture(scope="module")
def serial(lab: Lab) -> dict[Path, Any]:
    """Figures of each different log, measured here."""
    measure = partial(figures, options=MeasureOptions())
    return {path: measure(path) for path in set(lab.logs.values())}


run = partial(forked_cli.run, timeout=240)


def kill_a_worker(lab: Lab, *, when: int) -> threading.Thread:
    """Kill one as soon as some logs were measured."""

    def kill() -> None:
        while len(list(lab.figures.glob("logs/*.parquet"))) < when:
            time.sleep(0.05)
        os.kill(lab.cluster.workers[0].pid, signal.SIGKILL)

    thread = threading.Thread(target=kill, daemon=True)
    thread.start()
    return thread


def test_figures_are_those_of_a_serial_run_though_a_worker_dies(
    lab: Lab, serial: Mapping[Path, Any], tmp_path: Path
) -> None:
    killer = kill_a_worker(lab, when=5)
    done = run(
        *("export", f"s3://{BUCKET}/logs", "--dataset", lab.figures),
        *("--scheduler", lab.scheduler),
        folder=tmp_path,
    )
    killer.join()

    assert done.returncode == 3, done.stderr
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


def test_figures_are_kept_in_a_store_alike(tmp_path: Path) -> None:
    url = f"s3://{BUCKET}/figures"
    words = ["export", f"s3://{BUCKET}/logs/day1/walk00*.mcap", "--dataset", url, "--jobs", 1]
    assert run(*words, folder=tmp_path).returncode == 0
    assert "2 logs are there already, unchanged" in run(*words, folder=tmp_path).stderr
    table = ds.dataset(f"{BUCKET}/figures/logs", filesystem=in_store().fs).to_table()
    assert len(set(table.column("path").to_pylist())) == table.num_rows == 2


def test_annotated_logs_are_those_of_a_serial_run(lab: Lab, tmp_path: Path) -> None:
    names = [name for name in lab.logs if name.startswith("day4/")]
    assert len({lab.logs[name] for name in names}) == 5
    (tmp_path / "list.txt").write_text("".join(f"s3://{BUCKET}/logs/{name}\n" for name in names))

    done = run(
        *("convert", "@list.txt", "-o", f"s3://{BUCKET}/annotated/"),
        *("--scheduler", lab.scheduler, "--json", "-q"),
        folder=tmp_path,
    )

    assert done.returncode == 3, done.stderr
    assert [each["input"] for each in json.loads(done.stdout)] == [
        f"s3://{BUCKET}/logs/{n}" for n in names
    ]
    client = in_store().fs
    for name in names:
        source = tmp_path / Path(name).name
        source.write_bytes(lab.logs[name].read_bytes())
        target = tmp_path / f"{source.stem}.annotated.mcap"
        convert(source, target, ConvertOptions())
        assert client.cat_file(f"{BUCKET}/annotated/{target.name}") == target.read_bytes()
    assert len(client.find(f"{BUCKET}/annotated")) == len(names)
    assert unfinished_uploads() == []


def break_off(target: UPath, uploads: Callable[[], list[Any]]) -> None:
    with whole_file(target, overwrite=False) as file:
        file.write(bytes(60 << 20))
        assert uploads() != []
        raise KeyboardInterrupt


def test_an_upload_that_is_broken_off_leaves_nothing() -> None:
    target = in_store("half.mcap")
    with pytest.raises(KeyboardInterrupt):
        break_off(target, unfinished_uploads)
    assert unfinished_uploads() == []
    assert not target.exists()


def write(target: UPath, data: bytes, *, overwrite: bool) -> None:
    with whole_file(target, overwrite=overwrite) as file:
        file.write(data)


def test_an_object_is_not_overwritten_unasked() -> None:
    target = in_store("there.mcap")
    write(target, b"old", overwrite=False)
    with pytest.raises(CallError, match="exists already"):
        write(target, b"new", overwrite=False)
    assert target.read_bytes() == b"old"
    write(target, b"new", overwrite=True)
    assert target.read_bytes() == b"new"
    assert unfinished_uploads() == []
    with pytest.raises(LogtoolError, match="cannot be written"):
        write(in_store("x", "absent"), b"new", overwrite=True)
