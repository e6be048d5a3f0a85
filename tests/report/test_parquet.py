"""`stats --parquet`: a row a log whatever its name, and what is said of it."""

import functools
import http.server
import os
import shutil
import threading
import urllib.parse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow.dataset as ds
import pytest

from tests.forked_cli import Ended, run
from tests.paths import SAMPLE_LOGS

TROT, TROUBLED = SAMPLE_LOGS / "dogbot_trot.bag", SAMPLE_LOGS / "dogbot_troubled.bag"


def stats(folder: Path, *words: object, jobs: int = 1) -> Ended:
    """Run `stats --parquet figures`."""
    done = run("stats", *words, "--parquet", "figures", "--jobs", jobs, folder=folder)
    assert "Traceback" not in done.stderr, done.stderr
    return done


def rows(folder: Path, table: str = "logs") -> list[dict[str, Any]]:
    dataset = ds.dataset(folder / "figures" / table, partitioning="hive")
    found: list[dict[str, Any]] = dataset.to_table().to_pylist()
    return found


def test_what_was_done_is_said_and_damaged_logs_are_named(tmp_path: Path) -> None:
    (tmp_path / "cut.bag").write_bytes(TROT.read_bytes()[:900_000])
    (tmp_path / "sound.bag").write_bytes(TROUBLED.read_bytes())
    (tmp_path / "no.bag").write_bytes(b"nothing of the kind")
    first = stats(tmp_path, ".", jobs=2)
    assert (first.returncode, first.stdout) == (1, "")
    assert "figures: 2 written, 1 failed; 1 damaged\n damage  cut.bag: " in first.stderr
    assert " bytes lost\n" in first.stderr
    (tmp_path / "no.bag").unlink()
    again = stats(tmp_path, ".")
    assert (again.returncode, again.stdout) == (3, "")
    assert "figures: 0 written, 2 unchanged; 1 damaged\n damage  cut.bag: " in again.stderr
    assert stats(tmp_path, ".", "-q").stderr == ""


def test_names_of_any_bytes_are_rows(tmp_path: Path) -> None:
    for name in (b"\xff.bag", b"\xfe.bag", b"a=b.bag", "é.bag".encode()):
        shutil.copy(TROUBLED, Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name)))
    assert stats(tmp_path, ".", jobs=2).returncode == 0
    names = sorted(row["log"].rpartition("/")[2] for row in rows(tmp_path))
    assert names == ["\\xfe.bag", "\\xff.bag", "a=b.bag", "é.bag"]
    assert "4 unchanged" in stats(tmp_path, ".").stderr


def test_other_names_of_a_log_are_the_same_row(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    shutil.copy(TROUBLED, tmp_path / "data" / "walk.bag")
    (tmp_path / "link.bag").symlink_to("data/walk.bag")
    (tmp_path / "folder").symlink_to("data")
    assert stats(tmp_path, "data/walk.bag").returncode == 0
    for word in ("data/../data/walk.bag", "link.bag", "folder/walk.bag", "folder"):
        assert "0 written, 1 unchanged" in stats(tmp_path, word).stderr
    assert len(rows(tmp_path)) == 1


@pytest.mark.parametrize("name", ["a=b/c%2F..", "__HIVE_DEFAULT_PARTITION__", "Ünïcode #?", "."])
def test_a_robot_of_any_name_has_a_partition(tmp_path: Path, name: str) -> None:
    robot = (SAMPLE_LOGS.parent / "dogbot_logtool" / "robots" / "dogbot.toml").read_text()
    first, _, rest = robot.partition('name = "dogbot"')
    (tmp_path / "robot.toml").write_text(f'{first}name = "{name}"{rest}')
    words = (TROUBLED, "--robot", "robot.toml")
    assert stats(tmp_path, *words).returncode == 0
    assert "0 written, 1 unchanged" in stats(tmp_path, *words).stderr
    assert len(list((tmp_path / "figures" / "logs").glob("robot=*/month=*/*.parquet"))) == 1


def test_a_place_that_cannot_be_a_dataset_is_refused_at_once(tmp_path: Path) -> None:
    (tmp_path / "figures").write_text("mine")
    done = stats(tmp_path, TROUBLED)
    assert (done.returncode, done.stdout) == (2, "")
    assert "--parquet" in done.stderr
    assert "is no directory" in done.stderr
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff"))
    odd.mkdir()
    done = stats(odd, TROUBLED)
    assert done.returncode == 2
    assert "must be UTF-8" in done.stderr


class _Runs(http.server.SimpleHTTPRequestHandler):
    """Serves the file that a query names, whatever the path."""

    def translate_path(self, path: str) -> str:
        query = urllib.parse.parse_qs(urllib.parse.urlsplit(path).query)
        return str(Path(self.directory) / query["run"][0])

    def log_message(self, *_words: object) -> None:
        """Say nothing."""


@pytest.fixture
def server(tmp_path: Path) -> Iterator[str]:
    """Serve two logs under one path."""
    runs = tmp_path / "runs"
    runs.mkdir()
    shutil.copy(TROUBLED, runs / "1")
    (runs / "2").write_bytes(TROT.read_bytes()[:900_000])
    handler = functools.partial(_Runs, directory=str(runs))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as running:
        thread = threading.Thread(target=running.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{running.server_port}/log.bag"
        running.shutdown()
        thread.join()


def test_urls_that_differ_in_their_query_are_two_logs(tmp_path: Path, server: str) -> None:
    urls = [f"{server}?run={run}&token=secret" for run in (1, 2)]
    done = stats(tmp_path, *urls, jobs=2)
    assert done.returncode == 3, done.stderr
    assert [row["log"] for row in rows(tmp_path)] == [server, server]
    assert len({row["log_id"] for row in rows(tmp_path)}) == 2
    assert len({row["messages"] for row in rows(tmp_path)}) == 2
    assert {row["log_id"] for row in rows(tmp_path, "strides")} <= {
        row["log_id"] for row in rows(tmp_path)
    }
    written = b"".join(f.read_bytes() for f in (tmp_path / "figures").rglob("*.parquet"))
    assert b"secret" not in written
    assert "secret" not in done.stderr


def test_events_are_a_table_of_their_own(tmp_path: Path) -> None:
    shutil.copy(TROUBLED, tmp_path / "troubled.bag")
    assert stats(tmp_path, "troubled.bag").returncode == 0
    (log,) = rows(tmp_path)
    events = rows(tmp_path, "events")
    assert {each["log_id"] for each in events} == {log["log_id"]}
    (gap,) = [each for each in events if each["type"] == "gap"]
    assert (gap["foot"], gap["unit"], gap["code"]) == ("front_right", "s", "W_GAPS")
    assert gap["value"] == pytest.approx(1.01, abs=0.01)
