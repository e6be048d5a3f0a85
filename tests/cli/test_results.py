"""What commands make, and where: JSON, tables, figures, judgements, and whole files only."""

import json
import os
import shutil
from pathlib import Path
from xml.etree import ElementTree as ET

import pyarrow.feather
import pyarrow.parquet as pq
import pytest

from dogbot_logtool.report.page.assets import shared_name
from tests.forked_cli import run
from tests.measured import walk_of
from tests.oracles.annotated_file import read_written
from tests.oracles.small_logs import first_seconds, odometry_log
from tests.paths import TROT, TROUBLED, WALK
from tests.shell import Outcome, Shell

TROTS = '[[rule]]\nfigure = "gait.name"\nequals = "trot"\nname = "it trots"\n'


def short() -> Path:
    return first_seconds(TROT, 4.0)


def test_convert_says_what_it_wrote(shell: Shell) -> None:
    done = shell("convert", TROUBLED, "-v")
    assert (done.code, done.out) == (0, "")
    assert shell.files() == ["dogbot_troubled.annotated.mcap"]
    for said in ("3,659 recorded messages", "501  /load/front_left", "warning", "note"):
        assert said in done.err
    words = ("convert", TROUBLED, "-o", "x.mcap", "--style", "force", "-q")
    assert shell(*words) == Outcome(0, "", "")
    told = shell(*words, "--json", "--overwrite").json
    assert (told["input"], told["output"], told["style"]) == (str(TROUBLED), "x.mcap", "force")
    assert told["topics"]["odometry"] == ["/dogbot/odom"]
    assert told["messages"] == {"read": 3659, "copied": 3659}
    counts = read_written(shell.folder / "x.mcap").topics
    assert told["annotations"] == {topic: counts[topic] for topic in told["annotations"]}
    assert sum(counts.values()) == 3659 + sum(told["annotations"].values())
    assert told["skipped"].items() >= {"bad_poses": 1, "not_finite": 5}.items()
    assert "NOT_FINITE" in {each["code"] for each in told["findings"]}
    assert told["damage"] == {"text": None, "messages": 0, "bytes": 0, "places": []}


def test_the_input_is_never_the_output(shell: Shell) -> None:
    log = odometry_log(shell.folder / "log.mcap", "/odom")
    before = log.read_bytes()
    (shell.folder / "link.mcap").symlink_to(log)
    (shell.folder / "hard.mcap").hardlink_to(log)
    for name in ("link.mcap", "hard.mcap", "./log.mcap"):
        done = shell("convert", "log.mcap", "-o", name, "--overwrite")
        assert (done.code, log.read_bytes()) == (2, before)
        assert "is the input itself" in done.err


def test_check_ends_with_1_where_a_rule_is_broken_or_a_metric_unknown(shell: Shell) -> None:
    (shell.folder / "limits.toml").write_text(TROTS)
    check = ("check", "--limits", "limits.toml")
    good = shell(*check, short())
    assert good == Outcome(0, f"GOOD     {short()}: 1 GOOD\n", "")
    assert shell(*check, TROUBLED).code == 1
    (shell.folder / "lenient.toml").write_text(f'{TROTS}null = "pass"\n')
    assert shell("check", "--limits", "lenient.toml", TROUBLED).code == 0
    (shell.folder / "odd.bag").write_bytes(b"nothing")
    words = (short(), WALK, "odd.bag", "--json", "--junit", "checked.xml", "--jobs", 1)
    done = shell(*check, *words)
    assert done.code == 1
    assert [each.get("status") for each in done.json] == ["GOOD", "FAIL", None]
    suites = ET.parse(shell.folder / "checked.xml").getroot()  # noqa: S314 - our own
    told = [(suite.get("failures"), suite.get("errors")) for suite in suites]
    assert told == [("0", "0"), ("1", "0"), ("0", "1")]
    assert suites[1][0].get("name") == "it trots"


def test_a_baseline_is_another_run(shell: Shell) -> None:
    (shell.folder / "yesterday.json").write_text(shell("stats", "--json", short()).out)
    limits = '[[rule]]\nfigure = "feet.*.duty_factor.median"\nbaseline = { by_percent = 5 }'
    (shell.folder / "limits.toml").write_text(limits)
    words = ("check", "--limits", "limits.toml")
    assert shell(*words, short(), "--baseline", "yesterday.json").code == 0
    assert shell(*words, WALK, "--baseline", "yesterday.json").code == 1
    assert "need --baseline" in shell(*words, short()).err
    assert "stats LOG --json > FILE.json" in shell(*words, short(), "--baseline", TROT).err


def test_tables_are_those_of_python_to_the_bit(shell: Shell) -> None:
    walk = walk_of(WALK)
    for table in ("stances", "events", "base", "commands"):
        shell("export", WALK, "--table", table, "-o", f"{table}.feather")
        written = pyarrow.feather.read_table(shell.folder / f"{table}.feather")
        assert written.drop_columns(["log"]) == getattr(walk, table).to_arrow()
    shell("export", TROT, WALK, "--table", "samples", "-o", "s.parquet")
    written = pq.read_table(shell.folder / "s.parquet").to_pandas()
    assert written["log"].unique().tolist() == [str(TROT), str(WALK)]
    rows = written[(written["log"] == str(WALK)) & (written["foot"] == "back_left")]
    assert rows["force_n"].tolist() == walk.samples("back_left")["force_n"].tolist()


def test_a_bad_log_among_others_costs_its_own_rows_only(shell: Shell) -> None:
    (shell.folder / "bad.bag").write_text("no log")
    done = shell("export", "bad.bag", TROT, "-o", "out.csv")
    assert done.code == 1
    assert "bad.bag" in done.err
    assert (shell.folder / "out.csv").read_text() == shell("export", TROT).out
    assert shell("export", "bad.bag", "-o", "none.csv").code == 1
    assert "none.csv" not in shell.files()
    (shell.folder / "kept.csv").write_text("kept")
    assert "exists already" in shell("export", TROT, "-o", "kept.csv").err
    assert (shell.folder / "kept.csv").read_text() == "kept"


def test_a_layout_and_a_robot_s_file_are_files_too(shell: Shell) -> None:
    printed = shell("layout").json
    of_log = shell("layout", TROUBLED).json
    assert of_log["layout"] == printed["layout"]
    assert shell("layout", "-o", "x.json") == Outcome(0, "", "")
    assert json.loads((shell.folder / "x.json").read_text()) == printed
    assert shell("layout", "-o", "x.json").code == 2
    assert shell("layout", "-o", "x.json", "--overwrite").code == 0
    (shell.folder / "mine.toml").write_text(shell("robots", "dogbot").out)
    assert shell("convert", TROUBLED, "--robot", "mine.toml", "-q").code == 0


# --- Where they write -----------------------------------------------------------------------------


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    """Return a directory of two small logs, one of them a directory below."""
    folder = tmp_path / "logs"
    (folder / "far").mkdir(parents=True)
    odometry_log(folder / "one.mcap", "/odom")
    odometry_log(folder / "far" / "two.mcap", "/odom")
    return folder


def test_outputs_lie_as_the_logs_of_a_directory_do(shell: Shell, logs: Path) -> None:
    assert shell("convert", logs / "one.mcap", "-o", "out/deeper/").code == 0
    assert (shell.folder / "out" / "deeper" / "one.annotated.mcap").is_file()
    assert shell("convert", logs, "-o", "out", "--jobs", 1).code == 0
    assert (shell.folder / "out" / "one.annotated.mcap").is_file()
    assert (shell.folder / "out" / "far" / "two.annotated.mcap").is_file()


@pytest.mark.parametrize("kind", ["directory", "glob", "list"])
def test_what_may_hold_several_logs_makes_a_directory_also_for_one(
    shell: Shell, logs: Path, kind: str
) -> None:
    (shell.folder / "list").write_text(f"{logs}/far/two.mcap\n")
    word = {"directory": logs / "far", "glob": f"{logs}/far/*.mcap", "list": "@list"}[kind]
    assert shell("convert", word, "-o", "out").code == 0
    assert (shell.folder / "out" / "two.annotated.mcap").is_file()
    # One log and the name of one file: that is what is meant.
    assert shell("convert", word, "-o", "x.mcap").code == 0
    assert (shell.folder / "x.mcap").is_file()


def test_a_directory_is_not_made_for_nothing(shell: Shell, logs: Path) -> None:
    (logs / "one.mcap").write_bytes(b"no log")
    assert shell("convert", logs / "one.mcap", "-o", "out/").code == 1
    assert shell("convert", logs / "one.mcap", logs / "one.mcap", "-o", "out").code == 1
    assert shell.files() == []
    (shell.folder / "out").write_text("precious")
    done = shell("convert", logs / "far" / "two.mcap", "-o", "out/deeper/")
    assert (done.code, shell.files()) == (2, ["out"])
    assert "out: is a file, not a folder" in done.err


def test_the_index_leads_to_pages_of_any_name(tmp_path: Path) -> None:
    """Names may be any bytes; a log that cannot be used stands in the index with the reason."""
    shutil.copy(TROUBLED, Path(os.fsdecode(bytes(tmp_path) + b"/<\xff>.bag")))
    (tmp_path / "bad.bag").write_bytes(b"nothing of the kind")
    done = run("report", ".", "--no-replay", folder=tmp_path)
    assert done.returncode == 1
    index = (tmp_path / "index.html").read_text()
    page = (tmp_path / os.fsdecode(b"<\xff>.report.html")).read_text()
    assert f'<script src="{shared_name()}">' in page
    assert '<a href="index.html">' in page
    assert len(page) < 1_000_000
    assert "<canvas" not in page
    assert '<a href="%3C%FF%3E.report.html">&lt;\\xff&gt;.bag</a>' in index
    assert '<th scope="row">bad.bag</th>' in index
    assert "is neither a ROS 1 bag" in index


def test_overwriting_keeps_what_kind_of_file_there_was(shell: Shell, logs: Path) -> None:
    private, link = shell.folder / "private.mcap", shell.folder / "link.mcap"
    private.write_text("old")
    link.symlink_to("private.mcap")
    fifo = shell.folder / "fifo.mcap"
    os.mkfifo(fifo)
    assert shell("convert", logs / "one.mcap", "-o", link.name, "--overwrite").code == 0
    assert link.is_symlink()
    assert private.stat().st_size > len("old")
    done = shell("convert", logs / "one.mcap", "-o", fifo.name, "--overwrite")
    assert done.code == 2
    assert "fifo.mcap: is a pipe, a socket or a device" in done.err
    private.unlink()
    assert shell("convert", logs / "one.mcap", "-o", link.name, "--overwrite").code == 2
    assert fifo.is_fifo()
