"""`report`: pages on disk, the index, and what is refused."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from dogbot_logtool.report.page.assets import shared_name
from tests.forked_cli import run
from tests.paths import TROT, TROUBLED, WALK


def names(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.iterdir())


def test_the_index_leads_to_pages_of_any_name(tmp_path: Path) -> None:
    """Names may be any bytes; a log that cannot be used stands in the index with the reason."""
    shutil.copy(TROUBLED, Path(os.fsdecode(bytes(tmp_path) + b"/<\xff>.bag")))
    (tmp_path / "bad.bag").write_bytes(b"nothing of the kind")
    done = run("report", ".", "--no-replay", folder=tmp_path)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    index = (tmp_path / "index.html").read_text()
    page = (tmp_path / os.fsdecode(b"<\xff>.report.html")).read_text()
    assert f'<script src="{shared_name()}">' in page
    assert '<a href="index.html">' in page
    assert len(page) < 1_000_000
    assert "<canvas" not in page
    assert '<a href="%3C%FF%3E.report.html">&lt;\\xff&gt;.bag</a>' in index
    assert '<th scope="row">bad.bag</th>' in index
    assert "is neither a ROS 1 bag" in index


def test_without_the_extra_a_sentence_says_what_to_install(tmp_path: Path) -> None:
    blocked = (
        "import sys; sys.modules['jinja2'] = None; from dogbot_logtool.cli import main; main()"
    )
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", blocked, "report", str(TROT)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert re.search(r"pip install .*(jinja2|\[report\])", done.stderr)
    assert "Traceback" not in done.stderr
    assert names(tmp_path) == []


# --- Two sides ------------------------------------------------------------------------------------


def test_a_page_of_two_groups(tmp_path: Path) -> None:
    for log in ("yesterday/1.bag", "today/1.bag", "today/2.bag"):
        (tmp_path / log).parent.mkdir(exist_ok=True)
        shutil.copy(TROT, tmp_path / log)
    words = ("yesterday", "--against", "today", "-o", "both.html", "--json", "--jobs", 1)
    ended = run("report", *words, folder=tmp_path)

    assert ended.returncode == 0
    found = json.loads(ended.stdout)
    assert found["comparable"]
    assert [len(found[side]) for side in ("first", "second")] == [1, 2]
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
