"""`stats --events`: a row for each event, in a file that is never replaced unasked."""

import csv
import io
from pathlib import Path

from dogbot_logtool.report.figures.events import EVENT_COLUMNS
from dogbot_logtool.report.files.stats_csv import write_events
from tests.forked_cli import run
from tests.paths import SAMPLE_LOGS

TROUBLED = SAMPLE_LOGS / "dogbot_troubled.bag"
COLUMNS = "onset_s,duration_s,type,foot,value,unit,code"


def test_the_file_has_the_rows_of_the_json(tmp_path: Path) -> None:
    done = run("stats", TROUBLED, "--events", "events.csv", "--json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "events.csv").read_text().splitlines()
    assert lines[0] == COLUMNS
    kinds = [row["type"] for row in csv.DictReader(lines)]
    assert kinds.count("sensor_fault") == kinds.count("gap") == 1
    assert f'"onset_s": {csv_number(lines, "gap")}' in done.stdout


def csv_number(lines: list[str], kind: str) -> str:
    return next(row["onset_s"] for row in csv.DictReader(lines) if row["type"] == kind)[:5]


def test_a_file_that_is_there_is_replaced_only_if_told_so(tmp_path: Path) -> None:
    target = tmp_path / "events.csv"
    target.write_text("mine")
    refused = run("stats", TROUBLED, "--events", target, folder=tmp_path)
    assert (refused.returncode, target.read_text()) == (2, "mine")
    done = run("stats", TROUBLED, "--events", target, "--overwrite", folder=tmp_path)
    assert done.returncode == 0
    assert target.read_text().startswith(COLUMNS)


def test_several_logs_and_a_dataset_are_refused(tmp_path: Path) -> None:
    for words in ((TROUBLED, TROUBLED.with_name("dogbot_trot.bag")), (TROUBLED, "--parquet", "d")):
        done = run("stats", *words, "--events", "events.csv", folder=tmp_path)
        assert done.returncode == 2
        assert not (tmp_path / "events.csv").exists()


def test_names_that_spreadsheets_take_for_formulas_are_quoted() -> None:
    event = dict.fromkeys(EVENT_COLUMNS) | {"onset_s": 1.5, "type": "slip", "foot": "=1+1"}
    text = io.StringIO()
    write_events(text, [event])
    assert text.getvalue().splitlines()[1] == "1.5,,slip,'=1+1,,,"
