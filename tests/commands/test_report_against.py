"""`report --against` as a user calls it, on the sample logs."""

import json
import shutil
from pathlib import Path

from tests.forked_cli import run
from tests.paths import SAMPLE_LOGS

TROT = SAMPLE_LOGS / "dogbot_trot.bag"
WALK = SAMPLE_LOGS / "dogbot_walk.mcap"


def test_a_page_of_two_groups(tmp_path: Path) -> None:
    for side in ("yesterday", "today"):
        (tmp_path / side).mkdir()
        for number in (1, 2):
            shutil.copy(TROT, tmp_path / side / f"{number}.bag")
    words = ("yesterday", "--against", "today", "-o", "both.html", "--json", "--jobs", 1)
    ended = run("report", *words, folder=tmp_path)

    assert ended.returncode == 0
    found = json.loads(ended.stdout)
    assert found["comparable"]
    assert [len(found[side]) for side in ("first", "second")] == [2, 2]
    assert not any(each["differs"] for each in found["differences"])
    assert "both.html: 0 of 56 metrics differ" in ended.stderr
    assert (tmp_path / "both.html").stat().st_size == found["bytes"]


def test_a_page_of_runs_that_cannot_be_compared_is_written_too(tmp_path: Path) -> None:
    ended = run("report", str(TROT), "--against", str(WALK), folder=tmp_path)
    assert ended.returncode == 0
    assert "not comparable: the gaits differ: trot against walk" in ended.stderr
    assert (tmp_path / "dogbot_trot.against.html").exists()


def test_a_page_is_not_overwritten_and_no_log_is(tmp_path: Path) -> None:
    shutil.copy(TROT, tmp_path / "a.bag")
    (tmp_path / "a.against.html").write_text("mine")
    ended = run("report", "a.bag", "--against", "a.bag", folder=tmp_path)
    assert ended.returncode == 2
    assert (tmp_path / "a.against.html").read_text() == "mine"


def test_nothing_on_one_side_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "bad.bag").write_bytes(b"#ROSBAG V2.0\n")
    ended = run("report", str(TROT), "--against", "bad.bag", folder=tmp_path)
    assert ended.returncode == 1
    assert "1 of 2 logs could not be done" in ended.stderr
    assert not list(tmp_path.glob("*.html"))
