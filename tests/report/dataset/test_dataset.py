"""`export --dataset`: a row a log whatever its name, and what is said of it."""

import functools
import http.server
import json
import os
import re
import shutil
import threading
import urllib.parse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import duckdb
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.dataset as ds
import pyarrow.parquet as pq
import pytest

from tests.forked_cli import Ended, run
from tests.oracles.small_logs import first_seconds
from tests.paths import ROOT, SAMPLE_LOGS

TROT, LONG = (SAMPLE_LOGS / f"dogbot_{name}.bag" for name in ("trot", "troubled"))
TROUBLED = first_seconds(LONG)


def export(folder: Path, *words: object, jobs: int = 1) -> Ended:
    """Run `export --dataset figures`."""
    done = run("export", *words, "--dataset", "figures", "--jobs", jobs, folder=folder)
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
    first = export(tmp_path, ".")
    assert (first.returncode, first.stdout) == (1, "")
    assert first.stderr.startswith("damage: cut.bag: lost ")
    assert "figures: 2 measured, 1 failed; 1 damaged\n" in first.stderr
    (tmp_path / "no.bag").unlink()
    again = export(tmp_path, ".")
    assert (again.returncode, again.stdout) == (3, "")
    said = "damage: cut.bag: was damaged when it was measured, and is unchanged\n"
    assert again.stderr.startswith(said)
    assert "figures: 0 measured, 2 unchanged; 1 damaged\n" in again.stderr
    assert export(tmp_path, ".", "-q").stderr == said


def test_names_of_any_bytes_are_rows(tmp_path: Path) -> None:
    for name in (b"\xff.bag", b"\xfe.bag", b"a=b.bag", "é.bag".encode()):
        shutil.copy(TROUBLED, Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name)))
    assert export(tmp_path, ".", jobs=2).returncode == 0
    names = sorted(row["log"].rpartition("/")[2] for row in rows(tmp_path))
    assert names == ["\\xfe.bag", "\\xff.bag", "a=b.bag", "é.bag"]
    assert "4 unchanged" in export(tmp_path, ".").stderr


def test_other_names_of_a_log_are_the_same_row(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    shutil.copy(TROUBLED, tmp_path / "data" / "walk.bag")
    (tmp_path / "link.bag").symlink_to("data/walk.bag")
    (tmp_path / "folder").symlink_to("data")
    assert export(tmp_path, "data/walk.bag").returncode == 0
    for word in ("data/../data/walk.bag", "link.bag", "folder/walk.bag", "folder"):
        assert "0 measured, 1 unchanged" in export(tmp_path, word).stderr
    assert len(rows(tmp_path)) == 1


@pytest.mark.parametrize("name", ["a=b/c%2F..", "__HIVE_DEFAULT_PARTITION__", "Ünïcode #?", "."])
def test_a_robot_of_any_name_has_a_partition(tmp_path: Path, name: str) -> None:
    robot = (SAMPLE_LOGS.parent / "dogbot_logtool" / "robots" / "dogbot.toml").read_text()
    first, _, rest = robot.partition('name = "dogbot"')
    (tmp_path / "robot.toml").write_text(f'{first}name = "{name}"{rest}')
    words = (TROUBLED, "--robot", "robot.toml")
    assert export(tmp_path, *words).returncode == 0
    assert "0 measured, 1 unchanged" in export(tmp_path, *words).stderr
    assert len(list((tmp_path / "figures" / "logs").glob("robot=*/month=*/*.parquet"))) == 1


def test_a_place_that_cannot_be_a_dataset_is_refused_at_once(tmp_path: Path) -> None:
    (tmp_path / "figures").write_text("mine")
    done = export(tmp_path, TROUBLED)
    assert (done.returncode, done.stdout) == (2, "")
    assert "--dataset" in done.stderr
    assert "is no directory" in done.stderr
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff"))
    odd.mkdir()
    done = export(odd, TROUBLED)
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
    shutil.copy(LONG, runs / "1")
    (runs / "2").write_bytes(TROT.read_bytes()[:900_000])
    handler = functools.partial(_Runs, directory=str(runs))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as running:
        thread = threading.Thread(target=running.serve_forever, args=(0.02,))
        thread.start()
        yield f"http://127.0.0.1:{running.server_port}/log.bag"
        running.shutdown()
        thread.join()


def test_urls_that_differ_in_their_query_are_two_logs(tmp_path: Path, server: str) -> None:
    urls = [f"{server}?run={run}&token=secret" for run in (1, 2)]
    done = export(tmp_path, *urls)
    assert done.returncode == 3, done.stderr
    assert [row["log"] for row in rows(tmp_path)] == [server, server]
    assert len({row["log_id"] for row in rows(tmp_path)}) == 2
    assert len({row["log_messages"] for row in rows(tmp_path)}) == 2
    assert {row["log_id"] for row in rows(tmp_path, "strides")} <= {
        row["log_id"] for row in rows(tmp_path)
    }
    written = b"".join(f.read_bytes() for f in (tmp_path / "figures").rglob("*.parquet"))
    assert b"secret" not in written
    assert "secret" not in done.stderr


def files(folder: Path, table: str = "logs") -> list[str]:
    root = folder / "figures"
    return sorted(file.relative_to(root).as_posix() for file in (root / table).rglob("*.*"))


def test_logs_of_a_robot_and_month_share_a_file_of_each_table(tmp_path: Path) -> None:
    for name in ("a", "b", "c"):
        shutil.copy(TROUBLED, tmp_path / f"{name}.bag")
    assert export(tmp_path, "b.bag").returncode == 0
    assert export(tmp_path, ".").returncode == 0
    for table in ("logs", "feet", "strides", "events"):
        assert files(tmp_path, table) == [f"{table}/robot=dogbot/month=unknown/part-0000.parquet"]
        names = [row["log"].rpartition("/")[2] for row in rows(tmp_path, table)]
        assert names == sorted(names)
        assert set(names) == {"a.bag", "b.bag", "c.bag"}


def test_a_row_of_a_foot_holds_what_the_json_says(tmp_path: Path) -> None:
    assert export(tmp_path, TROT).returncode == 0
    (log,) = rows(tmp_path)
    document = json.loads(log["metrics_json"])
    feet, settings = document["feet"], document["settings"]["feet"]
    found = {row["foot"]: row for row in rows(tmp_path, "feet")}
    assert found.keys() == feet.keys()
    for name, foot in feet.items():
        row = found[name]
        assert row["log_id"] == log["log_id"]
        assert [row["place_end"], row["place_side"]] == settings[name]["leg_position"]
        assert row["duty_factor_median"] == foot["duty_factor"]["median"]
        assert row["foot_vertical_impulse_ns"] == foot["vertical_impulse_ns"]
        assert (row["strides"], row["slip_from"]) == (foot["strides"], foot["slip_from"])


def test_a_log_that_fails_is_a_row_with_its_error_until_it_does_not(tmp_path: Path) -> None:
    (tmp_path / "walk.bag").write_bytes(b"nothing of the kind")
    for _ in range(2):
        assert "0 measured, 1 failed" in export(tmp_path, "walk.bag").stderr
        (row,) = rows(tmp_path)
        assert "walk.bag" in row["error"]
        assert (row["damaged"], row["metrics_json"], row["robot"]) == (None, None, "unknown")
    shutil.copy(TROUBLED, tmp_path / "walk.bag")
    assert export(tmp_path, "walk.bag").returncode == 0
    (row,) = rows(tmp_path)
    assert (row["error"], row["robot"]) == (None, "dogbot")
    assert files(tmp_path) == ["logs/robot=dogbot/month=unknown/part-0000.parquet"]
    (tmp_path / "walk.bag").write_bytes(b"broken again")
    assert export(tmp_path, "walk.bag").returncode == 1
    assert [row["robot"] for row in rows(tmp_path)] == ["unknown"]
    assert rows(tmp_path, "strides") == rows(tmp_path, "feet") == []


def test_a_name_of_nothing_leaves_no_row(tmp_path: Path) -> None:
    shutil.copy(TROUBLED, tmp_path / "walk.bag")
    assert export(tmp_path, "walk.bag", "gone.bag").returncode == 2
    assert [row["error"] for row in rows(tmp_path)] == [None]
    (tmp_path / "walk.bag").unlink()
    assert export(tmp_path, "walk.bag").returncode == 2
    assert [row["error"] for row in rows(tmp_path)] == [None]


def test_logs_that_were_moved_or_deleted_are_pruned(tmp_path: Path) -> None:
    odd = os.fsencode(tmp_path) + b"/\xff.bag"
    for name in ("kept", "moved", "deleted"):
        shutil.copy(TROUBLED, tmp_path / f"{name}.bag")
    shutil.copy(TROUBLED, os.fsdecode(odd))
    assert export(tmp_path, ".").returncode == 0
    (tmp_path / "moved.bag").rename(tmp_path / "here.bag")
    (tmp_path / "deleted.bag").unlink()
    assert "pruned" not in export(tmp_path, ".").stderr
    assert len(rows(tmp_path)) == 5
    done = export(tmp_path, "here.bag", "--prune")
    assert "figures: 0 measured, 1 unchanged, 2 pruned; 0 damaged\n pruned  " in done.stderr
    assert f"{tmp_path}/deleted.bag: is gone" in done.stderr
    assert f"{tmp_path}/moved.bag: is gone" in done.stderr
    for table in ("logs", "feet", "strides", "events"):
        names = {row["log"].rpartition("/")[2] for row in rows(tmp_path, table)}
        assert names == {"kept.bag", "here.bag", "\\xff.bag"}
    Path(os.fsdecode(odd)).unlink()
    assert "1 pruned" in export(tmp_path, "here.bag", "--prune").stderr


def test_labels_are_columns_that_stay_until_they_are_given_anew(tmp_path: Path) -> None:
    shutil.copy(TROUBLED, tmp_path / "a.bag")
    shutil.copy(TROUBLED, tmp_path / "b.bag")

    def labels(*names: str) -> list[tuple[str | None, ...]]:
        return [tuple(row[name] for name in names) for row in rows(tmp_path)]

    assert export(tmp_path, "a.bag", "--label", "spot=rex").returncode == 0
    assert export(tmp_path, "b.bag", "--label", "firmware=3=2").returncode == 0
    assert labels("spot", "firmware") == [("rex", None), (None, "3=2")]
    done = export(tmp_path, ".", "--label", "spot=fido", "--label", "firmware=4")
    assert "0 measured, 2 unchanged" in done.stderr
    assert labels("spot", "firmware") == [("fido", "4"), ("fido", "4")]
    assert "2 unchanged" in export(tmp_path, ".").stderr
    assert export(tmp_path, "a.bag", "--label", "spot=").returncode == 0
    assert labels("spot", "firmware") == [(None, "4"), ("fido", "4")]
    assert len(rows(tmp_path, "feet")) == 8


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("firmware",), "must be NAME=VALUE"),
        (("=3",), "small letters"),
        (("Spot=3",), "small letters"),
        (("a b=3",), "small letters"),
        (("gait_name=trot",), "has a column gait_name already"),
        (("duty_factor_mean=1",), "has a column duty_factor_mean already"),
        (("month=may",), "has a column month already"),
        (("a=1", "a=2"), "a is there twice"),
    ],
)
def test_a_label_that_can_be_no_column_is_refused(
    tmp_path: Path, words: tuple[str, ...], reason: str
) -> None:
    done = export(tmp_path, TROT, *(f"--label={word}" for word in words))
    assert (done.returncode, done.stdout) == (2, "")
    assert reason in " ".join(done.stderr.split())
    assert not (tmp_path / "figures").exists()


def test_labels_and_pruning_need_a_dataset(tmp_path: Path) -> None:
    for words in (("--label", "a=1"), ("--prune",), ("--scheduler", "tcp://x:1")):
        done = run("export", TROT, *words, folder=tmp_path)
        assert (done.returncode, done.stdout) == (2, "")
        assert "goes with --dataset" in done.stderr


def test_a_dataset_of_another_layout_is_named_and_left_alone(tmp_path: Path) -> None:
    old = tmp_path / "figures" / "logs" / "robot=dogbot" / "month=unknown"
    old.mkdir(parents=True)
    pq.write_table(pa.table({"log": ["a"]}), old / "0123456789abcdef01234567.parquet")
    done = export(tmp_path, TROT)
    assert done.returncode == 1
    said = " ".join(done.stderr.split())
    assert "figures: is a dataset of an older version" in said
    assert "Name another directory" in said
    (old / "0123456789abcdef01234567.parquet").rename(old / "part-0000.parquet")
    assert "of layout unknown" in " ".join(export(tmp_path, TROT).stderr.split())
    assert [row["log"] for row in rows(tmp_path)] == ["a"]


def test_the_same_logs_make_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b", "c"):
        shutil.copy(TROUBLED, tmp_path / f"{name}.bag")
    assert export(tmp_path, ".", jobs=1).returncode == 0
    first = {file: (tmp_path / "figures" / file).read_bytes() for file in files(tmp_path, ".")}
    shutil.rmtree(tmp_path / "figures")
    for words in (["c.bag"], ["."]):
        assert export(tmp_path, *words, jobs=2).returncode == 0
    assert len(first) == 4
    assert first == {f: (tmp_path / "figures" / f).read_bytes() for f in files(tmp_path, ".")}


def queries() -> list[str]:
    """The queries of the documentation."""
    page = (ROOT / "docs" / "many_logs.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```sql\n(.*?)```", page, re.DOTALL)
    return [each for each in block.split(";") if each.strip()]


def test_readers_take_it_and_the_documented_queries_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(TROUBLED, tmp_path / "troubled.bag")
    shutil.copy(TROT, tmp_path / "trot.bag")
    (tmp_path / "no.bag").write_bytes(b"nothing of the kind")
    assert export(tmp_path, ".", "--label", "firmware=3.2").returncode == 1
    for table in ("logs", "feet", "strides", "events"):
        expected = len(rows(tmp_path, table))
        glob = str(tmp_path / "figures" / table / "**" / "*.parquet")
        duck = duckdb.connect().execute(f"SELECT count(robot) FROM '{glob}'")  # noqa: S608
        assert duck.fetchall() == [(expected,)]
        lazy = pl.scan_parquet(glob, hive_partitioning=True)
        assert lazy.select(pl.col("robot").count()).collect().item() == expected
        assert pd.read_parquet(tmp_path / "figures" / table)["robot"].count() == expected
    monkeypatch.chdir(tmp_path)
    drift, doubtful, feet, slip = (duckdb.connect().execute(each).fetchall() for each in queries())
    assert drift == [("dogbot", None)]
    assert [row[0].rpartition("/")[2] for row in doubtful if row[1]] == ["no.bag"]
    assert {row[:2] for row in feet} == {("3.2", row["foot"]) for row in rows(tmp_path, "feet")}
    assert {row[:2] for row in slip} >= {("dogbot", "trot")}


def test_events_are_a_table_of_their_own(tmp_path: Path) -> None:
    shutil.copy(LONG, tmp_path / "troubled.bag")
    assert export(tmp_path, "troubled.bag").returncode == 0
    (log,) = rows(tmp_path)
    events = rows(tmp_path, "events")
    assert {each["log_id"] for each in events} == {log["log_id"]}
    (gap,) = [each for each in events if each["type"] == "gap"]
    assert (gap["foot"], gap["unit"], gap["code"]) == ("front_right", "s", "GAPS")
    assert gap["value"] == pytest.approx(1.01, abs=0.01)
