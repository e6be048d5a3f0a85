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
from tests.paths import SAMPLE_LOGS

TROT, TROUBLED = SAMPLE_LOGS / "dogbot_trot.bag", SAMPLE_LOGS / "dogbot_troubled.bag"


def names(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.iterdir())


def test_a_page_is_the_same_whatever_the_jobs(tmp_path: Path) -> None:
    pages = []
    for jobs in (1, 3):
        page = tmp_path / f"{jobs}.html"
        done = run("report", TROT, "-o", page, "--jobs", jobs, "--json")
        assert json.loads(done.stdout)["bytes"] == page.stat().st_size
        pages.append(page.read_bytes())
    assert pages[0] == pages[1]


def test_several_logs_have_an_index_even_if_one_fails(tmp_path: Path) -> None:
    (tmp_path / "bad.bag").write_bytes(b"#ROSBAG V2.0\n")
    out = tmp_path / "out"
    done = run("report", TROT, "bad.bag", "-o", "out/", "--no-replay", folder=tmp_path)
    assert done.returncode == 1
    script = shared_name()
    assert names(out) == [script, "dogbot_trot.report.html", "index.html"]
    page = (out / "dogbot_trot.report.html").read_text()
    assert f'<script src="{script}">' in page
    assert '<a href="index.html">' in page
    assert len(page) < 1_000_000
    assert "<canvas" not in page
    index = (out / "index.html").read_text()
    assert 'href="dogbot_trot.report.html"' in index
    assert '<th scope="row">bad.bag</th>' in index


def test_the_index_leads_to_pages_of_any_name(tmp_path: Path) -> None:
    """Names may be any bytes; a log that cannot be used stands in the index with the reason."""
    shutil.copy(TROUBLED, Path(os.fsdecode(bytes(tmp_path) + b"/<\xff>.bag")))
    (tmp_path / "bad.bag").write_bytes(b"nothing of the kind")
    done = run("report", ".", folder=tmp_path)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    index = (tmp_path / "index.html").read_text()
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
