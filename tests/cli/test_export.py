"""`export` writes the tables of a walk, whole or not at all."""

import csv
import io
from pathlib import Path

import numpy as np
import pyarrow.feather
import pyarrow.parquet as pq
import pytest

import dogbot_logtool as dl
from tests.forked_cli import run
from tests.measured import walk_of
from tests.paths import TROT, WALK


@pytest.fixture(scope="module")
def walk() -> dl.Walk:
    return walk_of(WALK)


def test_strides_go_to_stdout_with_all_their_digits(walk: dl.Walk) -> None:
    rows = list(csv.DictReader(io.StringIO(run("export", WALK).stdout)))
    assert [row["foot"] for row in rows] == walk.strides["foot"].tolist()
    assert {row["log"] for row in rows} == {str(WALK)}
    for name in set(walk.strides) - {"foot"}:
        exported = [float(row[name] or "nan") for row in rows]
        assert np.array(exported).tobytes() == walk.strides[name].tobytes()


def test_samples_of_several_logs_make_one_table(walk: dl.Walk, tmp_path: Path) -> None:
    done = run("export", TROT, WALK, "--table", "samples", "-o", tmp_path / "s.parquet")
    assert (done.returncode, done.stdout) == (0, "")
    table = pq.read_table(tmp_path / "s.parquet").to_pandas()
    assert table["log"].unique().tolist() == [str(TROT), str(WALK)]
    for foot in walk.feet:
        rows = table[(table["log"] == str(WALK)) & (table["foot"] == foot)]
        expected = walk.samples(foot)
        assert rows["time_s"].tolist() == expected["time_s"].tolist()
        assert rows["state"].tolist() == expected["state"].tolist()
        assert rows["force_n"].tolist() == expected["force_n"].tolist()


@pytest.mark.parametrize("table", ["stances", "events", "base", "commands"])
def test_other_tables_as_feather(walk: dl.Walk, tmp_path: Path, table: str) -> None:
    file = tmp_path / f"{table}.feather"
    run("export", WALK, "--table", table, "-o", file)
    written = pyarrow.feather.read_table(file)
    assert written.drop_columns(["log"]) == getattr(walk, table).to_arrow()


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (("-o", "out.xlsx"), 2, "out.xlsx: must end in .csv, .parquet, .arrow, .feather"),
        (("-o", "there.csv"), 2, "there.csv: exists already"),
        (("--overwrite",), 2, "--overwrite goes with -o FILE"),
        (("nothing.bag", "-o", "out.csv"), 2, "nothing.bag"),
    ],
)
def test_wrong_calls_leave_nothing(
    tmp_path: Path, words: tuple[str | Path, ...], code: int, sentence: str
) -> None:
    (tmp_path / "there.csv").write_text("kept")
    done = run("export", *(() if "nothing.bag" in words else (TROT,)), *words, folder=tmp_path)
    assert done.returncode == code
    assert sentence in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["there.csv"]
    assert (tmp_path / "there.csv").read_text() == "kept"


def test_a_bad_log_among_others_costs_its_own_rows_only(tmp_path: Path) -> None:
    (tmp_path / "bad.bag").write_text("no log")
    done = run("export", tmp_path / "bad.bag", TROT, "-o", tmp_path / "out.csv")
    assert done.returncode == 1
    assert "bad.bag" in done.stderr
    rows = list(csv.DictReader(io.StringIO((tmp_path / "out.csv").read_text())))
    assert len(rows) == 24
