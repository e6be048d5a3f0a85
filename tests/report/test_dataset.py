"""`export --dataset`: a row a log whatever its name, and what is said of it."""

import json
import os
import re
import shutil
from pathlib import Path
from typing import Any

import duckdb
import pandas as pd
import polars as pl
import pyarrow.dataset as ds
import pytest
from upath import UPath

from dogbot_logtool.commands.tasks import measure_entry
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.dataset import Entry, dataset_at, hash_of
from dogbot_logtool.report.dataset_tables import TABLES
from dogbot_logtool.run.inputs import Found, LogSet
from tests.forked_cli import Ended, run
from tests.oracles.small_logs import first_seconds
from tests.paths import ROOT, TROT, TROUBLED


def short() -> Path:
    return first_seconds(TROUBLED)


def export(folder: Path, *words: object, jobs: int = 1) -> Ended:
    """Run `export --dataset walks`."""
    return run("export", *words, "--dataset", "walks", "--jobs", jobs, folder=folder)


def rows(folder: Path, table: str = "logs") -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = ds.dataset(folder / "walks" / table).to_table().to_pylist()
    return found


def files(folder: Path) -> list[Path]:
    return sorted((folder / "walks").rglob("*.*"))


def test_what_was_done_is_said_and_damaged_logs_are_named(tmp_path: Path) -> None:
    (tmp_path / "cut.bag").write_bytes(TROT.read_bytes()[:900_000])
    (tmp_path / "sound.bag").write_bytes(short().read_bytes())
    (tmp_path / "no.bag").write_bytes(b"nothing of the kind")
    first = export(tmp_path, ".")
    assert (first.returncode, first.stdout) == (1, "")
    assert first.stderr.startswith("damage: cut.bag: lost ")
    assert "walks: 2 measured, 1 failed; 1 damaged\n" in first.stderr
    (tmp_path / "no.bag").unlink()
    again = export(tmp_path, ".")
    assert (again.returncode, again.stdout) == (3, "")
    said = "damage: cut.bag: was damaged when it was measured, and is unchanged\n"
    assert again.stderr.startswith(said)
    assert "walks: 0 measured, 2 unchanged; 1 damaged\n" in again.stderr
    assert export(tmp_path, ".", "-q").stderr == said


def test_a_place_that_cannot_be_a_dataset_is_refused_at_once(tmp_path: Path) -> None:
    (tmp_path / "walks").write_text("mine")
    done = export(tmp_path, short())
    assert (done.returncode, done.stdout) == (2, "")
    assert "--dataset" in done.stderr
    assert "is no directory" in done.stderr
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff"))
    odd.mkdir()
    done = export(odd, short())
    assert done.returncode == 2
    assert "must be UTF-8" in done.stderr
    (tmp_path / "older" / "walks" / "logs" / "robot=dogbot").mkdir(parents=True)
    done = export(tmp_path / "older", short())
    assert done.returncode == 2
    assert "is of an older version of this program" in done.stderr


def test_rows_hold_what_the_json_says(tmp_path: Path) -> None:
    assert export(tmp_path, TROUBLED).returncode == 0
    (found,) = rows(tmp_path)
    walk = json.loads(run("stats", "--json", "-v", TROUBLED).stdout)
    for group in ("settings", "base", "gait", "stability"):
        told = {name: value for name, value in found[group].items() if not isinstance(value, dict)}
        # Lists and maps of records are tables of their own, or stand in the JSON only.
        assert told == {name: walk[group][name] for name in told}
    feet = {row["foot"]: row for row in rows(tmp_path, "feet")}
    assert feet.keys() == walk["feet"].keys()
    for name, foot in walk["feet"].items():
        assert feet[name]["duty_factor"] == foot["duty_factor"]
        assert feet[name]["vertical_over_stride_n"] == foot["vertical_over_stride_n"]
    events = rows(tmp_path, "events")
    assert [row["type"] for row in events] == [event["type"] for event in walk["events"]]
    assert [row["code"] for row in rows(tmp_path, "findings")] == [
        finding["code"] for finding in walk["findings"]
    ]


def test_a_log_that_changes_replaces_its_files(tmp_path: Path) -> None:
    (tmp_path / "walk.bag").write_bytes(b"nothing of the kind")
    for _ in range(2):
        assert "0 measured, 1 failed" in export(tmp_path, "walk.bag").stderr
        (row,) = rows(tmp_path)
        assert "walk.bag" in row["error"]
        assert row["base"] is None
    shutil.copy(short(), tmp_path / "walk.bag")
    assert export(tmp_path, "walk.bag").returncode == 0
    (row,) = rows(tmp_path)
    assert (row["error"], row["settings"]["robot"]) == (None, "dogbot")
    strides = len(rows(tmp_path, "strides"))
    assert strides > 0
    assert "1 measured" in export(tmp_path, "walk.bag", "--start", "1").stderr
    assert len(rows(tmp_path, "strides")) < strides
    robot = (ROOT / "dogbot_logtool/robot/known/dogbot.toml").read_text(encoding="utf-8")
    for note in ("# as it was", "# as it is"):
        (tmp_path / "dog.toml").write_text(f"{robot}\n{note}\n", encoding="utf-8")
        assert "1 measured" in export(tmp_path, "walk.bag", "--robot", "dog.toml").stderr
    (tmp_path / "walk.bag").write_bytes(b"broken again")
    assert export(tmp_path, "walk.bag").returncode == 1
    assert [row["base"] for row in rows(tmp_path)] == [None]
    assert {file.parent.name for file in files(tmp_path)} == {"logs"}


def test_logs_that_were_moved_or_deleted_are_pruned(tmp_path: Path) -> None:
    odd = os.fsencode(tmp_path) + b"/\xff.bag"
    for name in ("kept", "moved", "deleted"):
        shutil.copy(short(), tmp_path / f"{name}.bag")
    shutil.copy(short(), os.fsdecode(odd))
    assert export(tmp_path, ".").returncode == 0
    (tmp_path / "moved.bag").rename(tmp_path / "here.bag")
    (tmp_path / "deleted.bag").unlink()
    assert "pruned" not in export(tmp_path, ".").stderr
    assert len(rows(tmp_path)) == 5
    done = export(tmp_path, "here.bag", "--prune")
    assert "walks: 0 measured, 1 unchanged, 2 pruned; 0 damaged\n" in done.stderr
    assert f"{tmp_path}/deleted.bag: is gone" in done.stderr
    assert f"{tmp_path}/moved.bag: is gone" in done.stderr
    names = {row["path"].rpartition("/")[2] for row in rows(tmp_path)}
    assert names == {"kept.bag", "here.bag", "\\xff.bag"}
    assert len(files(tmp_path)) == 5 * len(names)


def test_a_dataset_in_a_store() -> None:
    root, log = UPath("memory://lab/walks"), UPath("memory://lab/walk.bag")
    log.write_bytes(short().read_bytes())
    dataset = dataset_at(root, MeasureOptions(), {})
    (entry,) = dataset.begin(LogSet((Found(log),), 0)).entries
    tables = measure_entry(entry, options=MeasureOptions()).tables
    dataset.write(entry, tables, damaged=False)
    log.unlink()
    assert dataset.begin(LogSet((), 0), prune=True).pruned == (str(log),)
    assert not list(root.rglob("*.parquet"))
    # The query of a URL tells logs apart, and is a secret.
    for query in ("first", "second"):
        url = UPath(f"https://host/log.bag?{query}=secret")
        dataset.write(Entry(url, hash_of(url), {}), tables, damaged=False)
    written = [each.read_bytes() for each in root.rglob("*.parquet")]
    assert len(written) == 2 * len(TABLES)
    assert not any(b"secret" in each for each in written)


def test_labels_stay_until_they_are_given_anew(tmp_path: Path) -> None:
    shutil.copy(short(), tmp_path / "a.bag")
    shutil.copy(short(), tmp_path / "b.bag")

    def labels() -> list[dict[str, str]]:
        found = {row["path"].rpartition("/")[2]: dict(row["labels"]) for row in rows(tmp_path)}
        return [found["a.bag"], found["b.bag"]]

    assert export(tmp_path, "a.bag", "--label", "spot=rex").returncode == 0
    assert export(tmp_path, "b.bag", "--label", "firmware=3=2").returncode == 0
    assert labels() == [{"spot": "rex"}, {"firmware": "3=2"}]
    done = export(tmp_path, ".", "--label", "spot=fido", "--label", "firmware=4")
    assert "0 measured, 2 unchanged" in done.stderr
    assert labels() == [{"firmware": "4", "spot": "fido"}] * 2
    assert "2 unchanged" in export(tmp_path, ".").stderr
    assert export(tmp_path, "a.bag", "--label", "spot=").returncode == 0
    assert labels() == [{"firmware": "4"}, {"firmware": "4", "spot": "fido"}]


def test_the_same_logs_make_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        shutil.copy(short(), tmp_path / f"{name}.bag")
    assert export(tmp_path, ".", jobs=1).returncode == 0
    first = {file: file.read_bytes() for file in files(tmp_path)}
    shutil.rmtree(tmp_path / "walks")
    for words in (["b.bag"], ["."]):
        assert export(tmp_path, *words, jobs=2).returncode == 0
    assert len(first) == 10
    assert first == {file: file.read_bytes() for file in files(tmp_path)}


def queries() -> list[str]:
    """The queries of the documentation."""
    page = (ROOT / "docs" / "many_logs.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```sql\n(.*?)```", page, re.DOTALL)
    return [each for each in block.split(";") if each.strip()]


def test_readers_take_it_and_the_documented_queries_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(short(), tmp_path / "troubled.bag")
    shutil.copy(TROT, tmp_path / "trot.bag")
    (tmp_path / "no.bag").write_bytes(b"nothing of the kind")
    assert export(tmp_path, ".", "--label", "firmware=3.2").returncode == 1
    for table in ("logs", "feet", "strides", "events"):
        expected = len(rows(tmp_path, table))
        glob = str(tmp_path / "walks" / table / "*.parquet")
        duck = duckdb.connect().execute(f"SELECT count(log_hash) FROM '{glob}'")  # noqa: S608
        assert duck.fetchall() == [(expected,)]
        assert pl.scan_parquet(glob).select(pl.len()).collect().item() == expected
        assert len(pd.read_parquet(tmp_path / "walks" / table)) == expected
    monkeypatch.chdir(tmp_path)
    means, feet = (duckdb.connect().execute(each).fetchall() for each in queries())
    assert {row[:2] for row in means} == {("dogbot", "trot"), ("dogbot", None)}
    assert {row[:2] for row in feet} == {("3.2", row["foot"]) for row in rows(tmp_path, "feet")}
